//! Fishes' habits as the algorithm sees them (fishes A-91). Whose they are is the task's to say.

use super::Variation;
use crate::population::Heritable;
use creatures::fish::habits::variation::Settings;
use creatures::fish::habits::{GENES, Genotype};
use creatures::random::Stream;
use creatures::{DecodeError, SpecError};
use serde_json::{Map, Value, json};

impl Heritable for Genotype {
    fn encode(&self) -> Vec<u8> {
        Genotype::encode(self)
    }

    fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        Genotype::decode(bytes)
    }

    /// Every habit of the first vector, and of the second with its number, so that the lineage can be asked what
    /// evolves.
    fn traits(&self) -> Value {
        let mut traits = Map::new();
        for (vector, habits) in self.habits.iter().enumerate() {
            let name = |of: &str| if vector == 0 { of.to_owned() } else { format!("{of}_{vector}") };
            for gene in &GENES {
                traits.insert(name(gene.name), json!((gene.read)(habits)));
            }
            traits.insert(name("schooling"), json!(habits.schooling));
        }
        Value::Object(traits)
    }
}

impl Variation for Settings {
    type Genotype = Genotype;

    const RECORDS: &'static [&'static str] = &["meals", "matings"];

    fn check(&self) -> Result<(), SpecError> {
        Settings::check(self)
    }

    fn random(&self, stream: &mut Stream) -> Genotype {
        Genotype::random(self, stream)
    }

    fn crossover(&self, first: &Genotype, second: &Genotype, stream: &mut Stream) -> Genotype {
        Genotype::crossover(first, second, stream)
    }

    fn graft(&self, first: &Genotype, second: &Genotype, stream: &mut Stream) -> Genotype {
        Genotype::graft(first, second, stream)
    }

    fn mutate(&self, genotype: &mut Genotype, stream: &mut Stream) -> String {
        genotype.mutate(self, stream).join("+")
    }
}

#[cfg(test)]
mod tests {
    use crate::registry;
    use creatures::fish::Fish;
    use creatures::fish::habits::Genotype;
    use creatures::{Nobody, Outcome, System};
    use serde_json::json;

    /// habits of the scenario's fishes are bred, restored and lived.
    #[test]
    fn populations_of_habits_live_in_every_scenario() {
        for (scenario, vectors) in [("prey", 1), ("predator", 1), ("pacifist", 2)] {
            let task = Fish.resolve(json!({"scenario": scenario, "duration": 3.0, "trials": 1})).unwrap();
            let table = json!({"kind": "generational", "population": 6, "generations": 3});
            let plan = registry::kind(&table, "fish").unwrap().plan(table, &task).unwrap();
            assert_eq!(plan.table()["variation"]["focus"], scenario);
            let again = registry::kind(&plan.table(), "fish").unwrap().plan(plan.table(), &task).unwrap();
            assert_eq!(again.table(), plan.table());
            let other = json!({"kind": "generational", "variation": {"focus": if vectors == 2 { "prey" } else { "pacifist" }}});
            let error = registry::kind(&other, "fish").unwrap().plan(other, &task).unwrap_err();
            assert_eq!(error.path, "variation.focus");
            let task = Fish.task(&task.to_string()).unwrap();
            let mut search = plan.start(1, 0);
            for _ in 0..3 {
                let individuals = search.ask();
                assert_eq!(individuals.len(), 6);
                let live = |genotype: &[u8]| task.evaluate(genotype, 7, None, &mut Nobody).ok();
                let outcomes: Vec<Option<Outcome>> =
                    individuals.iter().map(|one| live(&one.genotype)).collect();
                assert!(outcomes.iter().all(Option::is_some), "{scenario}: every child is legal");
                assert_eq!(Genotype::decode(&individuals[0].genotype).unwrap().habits.len(), vectors);
                assert!(individuals[0].traits["appetite"].is_f64());
                search.tell(&outcomes);
                let restored = plan.restore(1, 0, &search.checkpoint()).unwrap().ask();
                assert_eq!(restored, search.ask());
                search = plan.restore(1, 0, &search.checkpoint()).unwrap();
            }
        }
    }
}
