//! Flyers as the algorithm sees them.

use super::Variation;
use creatures::SpecError;
use creatures::flyer::Genotype;
use creatures::flyer::variation::Settings;
use creatures::random::Stream;

impl Variation for Settings {
    type Genotype = Genotype;

    const RECORDS: &'static [&'static str] = &["hover_steps"];

    fn check(&self) -> Result<(), SpecError> {
        Settings::check(self)
    }

    fn random(&self, stream: &mut Stream) -> Genotype {
        Genotype::random(self, stream)
    }

    fn crossover(&self, first: &Genotype, second: &Genotype, stream: &mut Stream) -> Genotype {
        Genotype::crossover(first, second, self, stream)
    }

    fn graft(&self, first: &Genotype, second: &Genotype, stream: &mut Stream) -> Genotype {
        Genotype::graft(first, second, self, stream)
    }

    fn mutate(&self, genotype: &mut Genotype, stream: &mut Stream) -> String {
        genotype.mutate(self, stream).join("+")
    }
}
