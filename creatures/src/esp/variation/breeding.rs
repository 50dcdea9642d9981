//! How whole creatures come to be: founders, the start of a later skill, mutation, crossover, grafting (E-38..E-42).
//! Body and brain vary together, and a child whose body is illegal is drawn again (E-19).

use super::Scope;
use super::body::{FOUNDER_SEGMENTS, Renaming, counterparts};
use super::draw::poisson;
use crate::esp::body::{Body, Illegal, Phenotype};
use crate::esp::brain::{Brain, Instances};
use crate::esp::genotype::Genotype;
use crate::esp::syllabus::{SkillId, Syllabus};
use crate::random::Stream;
use std::ops::RangeInclusive;

/// How often an illegal child is drawn again (E-19).
pub const REDRAWS: usize = 10;
/// Mutation events of a child above the first, on average (E-41).
const EVENTS_MEAN: f64 = 2.0;
/// Mutation events of a creature that starts a later skill (E-42).
const FIRST_EVENTS: RangeInclusive<usize> = 1..=3;

/// A legal creature, and how it was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Child {
    /// Legal for the syllabus that it was made for.
    pub genotype: Genotype,
    /// Names of the operators, in the order of application.
    pub operators: Vec<&'static str>,
    /// Why earlier draws were not legal, in their order.
    pub refused: Vec<Illegal>,
}

/// A creature and the operators that made it.
type Made = (Genotype, Vec<&'static str>);
/// What a draw comes to.
type Drawn = Result<Made, Illegal>;

/// What is varied: how far, for which skill, in which syllabus.
#[derive(Clone, Copy)]
struct Breeding<'a> {
    scope: Scope<'a>,
    skill: SkillId,
    syllabus: &'a Syllabus,
}

impl Genotype {
    /// A creature that starts the first skill: a random body that has a muscle, and a random control of it (E-42).
    /// How many segment genes it has is drawn once, so that those of many are not fewer for being illegal more often.
    pub fn founder(skill: SkillId, syllabus: &Syllabus, stream: &mut Stream) -> Child {
        let segments = stream.within(*FOUNDER_SEGMENTS.start(), *FOUNDER_SEGMENTS.end());
        let mut refused = Vec::new();
        loop {
            let body = Body::random(segments, skill, stream);
            match body.develop() {
                Ok(phenotype) if phenotype.muscles.is_empty() => {} // it would be scored, and never move
                Ok(phenotype) => {
                    let mut brain = Brain::default();
                    brain.begin(skill, &phenotype.instances(), syllabus, stream);
                    return Child { genotype: Genotype { body, brain }, operators: vec!["random"], refused };
                }
                Err(illegal) => refused.push(illegal),
            }
        }
    }

    /// This creature, all of whose skills are encapsulated, with a new control for one more: individual 0 of a
    /// later stage (E-42).
    pub fn begin_skill(&self, skill: SkillId, syllabus: &Syllabus, stream: &mut Stream) -> Child {
        let breeding = Breeding { scope: Scope::Control, skill, syllabus };
        let (genotype, operators) = breeding.begin(self, 0, stream).expect(LEGAL);
        Child { genotype, operators, refused: Vec::new() }
    }

    /// As [`Genotype::begin_skill`], after 1 to 3 mutation events: every other individual of a later stage (E-42).
    /// Where receptors alone may grow it has one or two more to begin with.
    pub fn begin_skill_varied(
        &self,
        skill: SkillId,
        scope: Scope,
        syllabus: &Syllabus,
        stream: &mut Stream,
    ) -> Child {
        let events = stream.within(*FIRST_EVENTS.start(), *FIRST_EVENTS.end());
        let breeding = Breeding { scope, skill, syllabus };
        let begin = |breeding: &Breeding, stream: &mut Stream| breeding.begin(self, events, stream);
        breeding.redraw(stream, |stream| begin(&breeding, stream), begin)
    }

    /// A child of one parent, which has an open skill, by 1 or more mutation events (E-41).
    pub fn mutate(&self, scope: Scope, syllabus: &Syllabus, stream: &mut Stream) -> Child {
        self.breed(scope, syllabus, stream, |breeding, stream| breeding.mutate(self, stream))
    }

    /// A child of two parents in the same stage, then mutated (E-38, E-39): both bodies cross where all is open, what
    /// was added to both is exchanged where the rest stays, and elsewhere the body is this one's (E-61, E-65).
    pub fn crossover(
        &self,
        mate: &Genotype,
        scope: Scope,
        syllabus: &Syllabus,
        stream: &mut Stream,
    ) -> Child {
        self.breed(scope, syllabus, stream, |breeding, stream| breeding.crossover(self, mate, stream))
    }

    /// A child of this creature with a part of another's body and of its control, then mutated (E-38, E-40); mutated
    /// alone where the scope does not graft (E-61, E-65).
    pub fn graft(&self, donor: &Genotype, scope: Scope, syllabus: &Syllabus, stream: &mut Stream) -> Child {
        if !scope.grafts() {
            return self.mutate(scope, syllabus, stream);
        }
        self.breed(scope, syllabus, stream, |breeding, stream| breeding.graft(self, donor, stream))
    }

    /// A child by some draw, or by mutation of the control alone.
    fn breed(
        &self,
        scope: Scope,
        syllabus: &Syllabus,
        stream: &mut Stream,
        draw: impl Fn(&Breeding, &mut Stream) -> Drawn,
    ) -> Child {
        let skill = self.brain.open().expect("a creature under evolution has an open skill").skill;
        let breeding = Breeding { scope, skill, syllabus };
        let mutate = |breeding: &Breeding, stream: &mut Stream| breeding.mutate(self, stream);
        breeding.redraw(stream, |stream| draw(&breeding, stream), mutate)
    }
}

const LEGAL: &str = "a creature under evolution is legal, and so is its body in every child that keeps it";

/// A legal body, varied, for which a brain is still to be made.
struct Grown {
    body: Body,
    phenotype: Phenotype,
    instances: Instances,
    /// Of the body's mutations.
    operators: Vec<&'static str>,
    /// Mutation events that are left for the brain.
    events: usize,
}

impl Breeding<'_> {
    /// Draws until the body is legal; after so many redraws draws with the body of the first parent (E-19).
    fn redraw(
        &self,
        stream: &mut Stream,
        draw: impl Fn(&mut Stream) -> Drawn,
        instead: impl Fn(&Breeding, &mut Stream) -> Drawn,
    ) -> Child {
        let mut refused = Vec::new();
        for _ in 0..=REDRAWS {
            match draw(stream) {
                Ok((genotype, operators)) => return Child { genotype, operators, refused },
                Err(illegal) => refused.push(illegal),
            }
        }
        let closed = Breeding { scope: Scope::Control, ..*self };
        let (genotype, operators) = instead(&closed, stream).expect(LEGAL);
        Child { genotype, operators, refused }
    }

    fn begin(&self, parent: &Genotype, events: usize, stream: &mut Stream) -> Drawn {
        let mut body = parent.body.clone();
        let mut operators = Vec::new();
        if self.scope.begins_with_eyes() {
            operators = body.add_eyes(self.scope, self.skill, stream);
        }
        let mut grown = self.grow(body, events, stream)?;
        grown.operators.splice(0..0, operators);
        let mut begun = parent.brain.clone();
        begun.begin(self.skill, &grown.instances, self.syllabus, stream);
        loop {
            let (child, operators) = self.learn(&grown, begun.clone(), "begin", stream);
            // A mutation may take the only output, with which a skill has to start.
            let drives = |brain: &Brain| brain.control(self.skill).is_some_and(|own| !own.outputs.is_empty());
            if drives(&child.brain) || !drives(&begun) {
                return Ok((child, operators));
            }
        }
    }

    fn mutate(&self, parent: &Genotype, stream: &mut Stream) -> Drawn {
        let grown = self.grow(parent.body.clone(), events(stream), stream)?;
        let mut brain = parent.brain.clone();
        brain.prune(&grown.instances);
        Ok(self.learn(&grown, brain, "", stream))
    }

    fn crossover(&self, first: &Genotype, second: &Genotype, stream: &mut Stream) -> Drawn {
        let (body, renaming) = match self.scope {
            Scope::Everything => first.body.crossover(&second.body, stream),
            Scope::Added { .. } => first.body.exchange(&second.body, stream),
            Scope::Morphology | Scope::Control => (first.body.clone(), Renaming::default()),
        };
        let grown = self.grow(body, events(stream), stream)?;
        let mut mate = second.brain.clone();
        if let Some(control) = mate.control_mut(self.skill) {
            control.keys_mut().for_each(|key| *key = renaming.key(key));
        }
        let brain = first.brain.crossover(&mate, &grown.instances, self.syllabus, stream);
        Ok(self.learn(&grown, brain, "crossover", stream))
    }

    fn graft(&self, first: &Genotype, donor: &Genotype, stream: &mut Stream) -> Drawn {
        let (body, renaming) = first.body.graft(&donor.body, self.skill, stream)?;
        let grown = self.grow(body, events(stream), stream)?;
        let mut brain = first.brain.clone();
        brain.prune(&grown.instances);
        let counterparts = counterparts(&donor.body.develop()?, &grown.phenotype, &renaming);
        brain.graft(&donor.brain, |key| counterparts.get(key).cloned());
        Ok(self.learn(&grown, brain, "graft", stream))
    }

    /// Mutates a body by the body's share of some events, and expresses it (E-41).
    fn grow(&self, mut body: Body, mut events: usize, stream: &mut Stream) -> Result<Grown, Illegal> {
        let share = self.scope.body_share();
        let drawn = (0..events).filter(|_| stream.chance(share)).count();
        let mut operators = Vec::with_capacity(events + 1);
        operators.extend((0..drawn).filter_map(|_| body.mutate(self.scope, self.skill, stream)));
        events -= operators.len();
        let phenotype = body.develop()?;
        let instances = phenotype.instances();
        Ok(Grown { body, phenotype, instances, operators, events })
    }

    /// Mutates a brain by the events that are left. The operator that made it comes first among the names.
    fn learn(&self, grown: &Grown, mut brain: Brain, made_by: &'static str, stream: &mut Stream) -> Made {
        let mutate = |_| brain.mutate(&grown.instances, self.syllabus, stream);
        let learned: Vec<&str> = (0..grown.events).filter_map(mutate).collect();
        let made_by = (!made_by.is_empty()).then_some(made_by);
        let operators = made_by.into_iter().chain(grown.operators.iter().copied()).chain(learned).collect();
        (Genotype { body: grown.body.clone(), brain }, operators)
    }
}

/// E-41
fn events(stream: &mut Stream) -> usize {
    1 + poisson(EVENTS_MEAN, stream)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::esp::syllabus::tests::ten_skills;
    use crate::random::stream;

    /// E-19
    #[test]
    fn a_child_that_stays_illegal_keeps_its_first_parents_body() {
        let syllabus = ten_skills().check().unwrap();
        let mut draws = stream(1, [0, 0, 0], "breeding test");
        let parent = Genotype::founder(SkillId(0), &syllabus, &mut draws).genotype;
        let breeding = Breeding { scope: Scope::Everything, skill: SkillId(0), syllabus: &syllabus };
        let mutate = |breeding: &Breeding, stream: &mut Stream| breeding.mutate(&parent, stream);
        let child = breeding.redraw(&mut draws, |_| Err(Illegal::TooManyParts), mutate);
        assert_eq!(child.refused, vec![Illegal::TooManyParts; 1 + REDRAWS]);
        assert_eq!(child.genotype.body, parent.body);
        assert_ne!(child.genotype.brain, parent.brain);
    }
}
