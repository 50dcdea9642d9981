//! Fishes' controllers as the algorithm sees them (fishes A-91).

use super::Variation;
use crate::population::Heritable;
use creatures::fish::{Controller, Genotype, variation};
use creatures::random::Stream;
use creatures::{DecodeError, SpecError};
use serde_json::{Value, json};

/// Travels as the genotype of its kind.
impl Heritable for Controller {
    fn encode(&self) -> Vec<u8> {
        Genotype::Controller(self.clone()).encode()
    }

    fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        match Genotype::decode(bytes)? {
            Genotype::Controller(controller) => Ok(controller),
            other => Err(DecodeError::illegal("genotype", format!("`{}` is no `controller`", other.kind()))),
        }
    }

    fn traits(&self) -> Value {
        let sum: f64 = self.amplitude.iter().sum();
        json!({
            "oscillations": self.oscillations(),
            "frequency": self.frequency[0],
            "mean_amplitude": sum / self.amplitude.len() as f64,
        })
    }
}

impl Variation for variation::Variation {
    type Genotype = Controller;

    const RECORDS: &'static [&'static str] = &["progress"];

    fn check(&self) -> Result<(), SpecError> {
        variation::Variation::check(self)
    }

    fn random(&self, stream: &mut Stream) -> Controller {
        variation::Variation::random(self, stream)
    }

    fn crossover(&self, first: &Controller, second: &Controller, stream: &mut Stream) -> Controller {
        variation::crossover(first, second, stream)
    }

    fn graft(&self, first: &Controller, second: &Controller, stream: &mut Stream) -> Controller {
        variation::graft(first, second, stream)
    }

    fn mutate(&self, genotype: &mut Controller, stream: &mut Stream) -> String {
        if variation::Variation::mutate(self, genotype, stream) { "mutate" } else { "" }.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use crate::registry;
    use creatures::fish::Fish;
    use creatures::{Nobody, Outcome, System};
    use serde_json::json;

    /// a population of controllers learns to get on.
    #[test]
    fn a_population_of_controllers_races_farther_and_farther() {
        let task = Fish.resolve(json!({"scenario": "race", "course": {"steps": 364}})).unwrap();
        let table = json!({"kind": "generational", "population": 12, "generations": 6});
        let plan = registry::kind(&table, "fish").unwrap().plan(table, &task).unwrap();
        let task = Fish.task(&task.to_string()).unwrap();
        let mut search = plan.start(1, 0);
        let mut best = Vec::new();
        loop {
            let individuals = search.ask();
            if individuals.is_empty() {
                break;
            }
            let live = |genotype: &[u8]| task.evaluate(genotype, 0, None, &mut Nobody).ok();
            let outcomes: Vec<Option<Outcome>> = individuals.iter().map(|one| live(&one.genotype)).collect();
            best.push(search.tell(&outcomes).notes["max_progress"].as_f64().unwrap());
            let restored = plan.restore(1, 0, &search.checkpoint()).unwrap().ask();
            assert_eq!(restored, search.ask());
        }
        assert_eq!(best.len(), 6);
        assert!(best.windows(2).all(|pair| pair[1] >= pair[0]) && best[5] > best[0], "{best:?}");
    }

    #[test]
    fn what_takes_no_controllers_has_no_such_population() {
        let task = Fish.resolve(json!({"scenario": "buoys"})).unwrap();
        let table = json!({"kind": "generational"});
        let error = registry::kind(&table, "fish").unwrap().plan(table, &task).unwrap_err();
        assert_eq!(error.path, "kind");
    }
}
