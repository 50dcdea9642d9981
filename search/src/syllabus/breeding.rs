//! How the next generation of a stage comes about: starters, elites and children (ESP E-37, E-38, E-42, E-61,
//! E-65, E-67). How a genotype varies is `creatures`' business; who breeds is decided here.

use super::crowd::Crowd;
use super::regime::{Regime, Selection};
use super::search::Base;
use super::settings::Settings;
use super::stage::Part;
use crate::population::Child;
use crate::selection::{draw, linear_ranking, proportionate};
use crate::{Parent, Place};
use creatures::esp::genotype::Genotype;
use creatures::esp::syllabus::Stage;
use creatures::esp::variation::Scope;

/// A stage between two generations.
pub(super) struct Breeding<'a> {
    pub(super) settings: &'a Settings,
    pub(super) seed: u64,
    /// The number of the stage.
    pub(super) number: u32,
    pub(super) stage: &'a Stage,
    pub(super) part: Part,
    /// The creature from which the stage starts; none where it starts from nothing.
    pub(super) base: Option<&'a Base>,
    pub(super) crowd: &'a Crowd,
}

/// Who may be a parent in one population, the best first, and how likely each is drawn.
struct Parents {
    indices: Vec<usize>,
    probabilities: Vec<f64>,
}

impl Breeding<'_> {
    /// The children of the next generation, population by population.
    pub(super) fn next(&self) -> Vec<Child<Genotype>> {
        let (populations, size) = self.part.populations(self.settings, self.stage.skill);
        (0..populations).flat_map(|population| self.population(population, size)).collect()
    }

    fn population(&self, population: u32, size: u32) -> Vec<Child<Genotype>> {
        let generation = self.crowd.generation(self.number) + 1;
        let range = Crowd::range(population, size);
        let place = |index: usize| Place { stage: self.number, generation, index: index as u32 };
        if self.crowd.members.is_empty() {
            let first = range.start;
            return range.map(|index| self.starter(place(index), index == first)).collect();
        }
        let ranks = self.crowd.ranks(range.clone());
        let fit = ranks.iter().filter(|&&index| self.crowd.members[index].fit()).count();
        let elites = (self.regime().elites as usize).min(fit);
        let parents = self.parents(&ranks, fit);
        let next = |(offset, index)| match ranks.get(offset).filter(|_| offset < elites) {
            Some(&elite) => self.copy(elite),
            None => self.breed(place(index), &parents),
        };
        range.enumerate().map(next).collect()
    }

    /// An individual of the first generation (E-42, E-67). The first of each population is the creature from which
    /// the stage starts, with nothing but its control for the new skill added.
    fn starter(&self, place: Place, unchanged: bool) -> Child<Genotype> {
        let (syllabus, skill, scope) = (&self.settings.syllabus, self.stage.skill, self.scope());
        let Some(base) = self.base else { return self.founder(place) };
        let parents = base.place.map(|place| Parent { place, role: "only".to_owned() });
        let parents = parents.into_iter().collect();
        let stream = |purpose| place.stream(self.seed, purpose);
        let made = match self.part {
            Part::Phase(_) | Part::Skill if unchanged => {
                base.genotype.begin_skill(skill, syllabus, &mut stream("begin"))
            }
            Part::Phase(_) | Part::Skill => {
                base.genotype.begin_skill_varied(skill, scope, syllabus, &mut stream("begin"))
            }
            Part::Reconcile(older) => {
                let mut genotype = base.genotype.clone();
                genotype.brain.reopen(older);
                if unchanged {
                    return Child { genotype, parents, operator: "reopened".to_owned() };
                }
                genotype.mutate(scope, syllabus, &mut stream("mutate"))
            }
            Part::Measure => {
                let genotype = base.genotype.clone();
                return Child { genotype, parents, operator: "encapsulated".to_owned() };
            }
        };
        child(made, parents)
    }

    /// One of the first skill, or the creature that brings that along (E-90).
    fn founder(&self, place: Place) -> Child<Genotype> {
        let Settings { syllabus, course, .. } = self.settings;
        let imported = course.import.creature(syllabus).expect("it was checked when the settings were read");
        match imported {
            Some(genotype) => Child { genotype, parents: Vec::new(), operator: "import".to_owned() },
            None => {
                let mut stream = place.stream(self.seed, "founder");
                child(Genotype::founder(self.stage.skill, syllabus, &mut stream), Vec::new())
            }
        }
    }

    fn copy(&self, index: usize) -> Child<Genotype> {
        Child {
            genotype: self.crowd.members[index].genotype.clone(),
            parents: vec![self.crowd.parent(index, "only")],
            operator: "elite".to_owned(),
        }
    }

    /// A child of drawn parents.
    fn breed(&self, place: Place, parents: &Parents) -> Child<Genotype> {
        let (syllabus, scope) = (&self.settings.syllabus, self.scope());
        let mut select = place.stream(self.seed, "select");
        let mut parent = || parents.indices[draw(&parents.probabilities, &mut select)];
        let (first, second) = (parent(), parent());
        let way = select.unit();
        let [one, other] = [first, second].map(|index| &self.crowd.members[index].genotype);
        let stream = &mut place.stream(self.seed, "breed");
        let both = || vec![self.crowd.parent(first, "first"), self.crowd.parent(second, "second")];
        let shares = self.regime().reproduction;
        if way < shares.crossover {
            child(one.crossover(other, scope, syllabus, stream), both())
        } else if way < shares.crossover + shares.graft && scope.grafts() {
            child(one.graft(other, scope, syllabus, stream), both())
        } else {
            child(one.mutate(scope, syllabus, stream), vec![self.crowd.parent(first, "only")])
        }
    }

    /// The probabilities of the ranked: only the `fit` first, as long as there are any (E-37).
    fn parents(&self, ranks: &[usize], fit: usize) -> Parents {
        let indices = ranks[..if fit > 0 { fit } else { ranks.len() }].to_vec();
        let fitness: Vec<f64> =
            indices.iter().map(|&index| self.crowd.members[index].scored.fitness).collect();
        let regime = self.regime();
        let probabilities = match regime.selection {
            Selection::Rank if fit > 0 => {
                let mut worst_first = linear_ranking(indices.len(), regime.rank_pressure);
                worst_first.reverse();
                worst_first
            }
            // Nobody fit has no ranks: all are alike.
            Selection::Rank | Selection::FitnessProportionate => proportionate(&fitness),
        };
        Parents { indices, probabilities }
    }

    fn regime(&self) -> &Regime {
        let skill = match self.part {
            Part::Reconcile(older) => older,
            Part::Phase(_) | Part::Skill | Part::Measure => self.stage.skill,
        };
        &self.settings.lesson(skill).regime
    }

    /// What may vary (E-59, E-63, E-67).
    fn scope(&self) -> Scope<'_> {
        match self.part {
            Part::Phase(_) | Part::Skill => Scope::of(self.stage, &self.settings.syllabus),
            Part::Reconcile(_) | Part::Measure => Scope::Control,
        }
    }
}

/// A child as it stands in the lineage.
fn child(made: creatures::esp::variation::Child, parents: Vec<Parent>) -> Child<Genotype> {
    let operator = if made.operators.is_empty() { "copy".to_owned() } else { made.operators.join("+") };
    Child { genotype: made.genotype, parents, operator }
}
