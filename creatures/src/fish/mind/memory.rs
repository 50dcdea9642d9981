//! What a fish was about to do when something came between: one item, kept until it is resumed or its
//! target is gone. It does not judge whether a target is in sight.

use super::Intention;
use crate::fish::world::{FishId, ParticleId};

/// Out of sight for longer is out of mind, time units.
const FORGETS_AFTER: f64 = 20.0;

/// What is to be eaten or mated with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// A fish.
    Fish(FishId),
    /// Food or plankton.
    Particle(ParticleId),
}

/// An intention put off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// Eat, mate, school or leave.
    pub intention: Intention,
    /// What it was about.
    pub target: Option<Target>,
    /// When the target was last in sight, or the memory made.
    seen: f64,
}

impl Memory {
    /// Of an intention interrupted at a time.
    pub fn new(intention: Intention, target: Option<Target>, time: f64) -> Memory {
        Memory { intention, target, seen: time }
    }

    /// What is to be remembered when one intention gives way to the next, if anything: avoiding, escaping and
    /// schooling put off what is worth coming back to.
    pub fn of_change(from: Intention, to: Intention, target: Option<Target>, time: f64) -> Option<Memory> {
        use Intention::{Avoid, Eat, Escape, Leave, Mate, School};
        let interrupts = matches!(to, Avoid | Escape | School) && to != from;
        let worth = matches!(from, Eat | Mate | School | Leave);
        (interrupts && worth).then(|| Memory::new(from, target, time))
    }

    /// The memory a step later, unless its target is dead or has been out of sight for too long.
    pub fn kept(self, alive: bool, visible: bool, time: f64) -> Option<Memory> {
        let seen = if visible { time } else { self.seen };
        (alive && time - seen <= FORGETS_AFTER).then_some(Memory { seen, ..self })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Intention::{Avoid, Eat, Escape, Leave, Mate, School, Wander};

    ///
    #[test]
    fn avoiding_escaping_and_schooling_put_off_what_matters() {
        let target = Some(Target::Fish(FishId(3)));
        for to in [Avoid, Escape, School] {
            for from in [Eat, Mate, Leave] {
                assert_eq!(Memory::of_change(from, to, target, 2.0), Some(Memory::new(from, target, 2.0)));
            }
            assert_eq!(Memory::of_change(Wander, to, None, 2.0), None);
            assert_eq!(Memory::of_change(to, to, None, 2.0), None);
        }
        assert_eq!(Memory::of_change(Mate, Eat, target, 2.0), None, "desire interrupts nothing");
    }

    /// A-66, AF-12
    #[test]
    fn the_dead_and_the_long_lost_are_forgotten() {
        let memory = Memory::new(Eat, Some(Target::Fish(FishId(3))), 10.0);
        assert_eq!(memory.kept(false, true, 11.0), None);
        assert_eq!(memory.kept(true, false, 30.0), Some(memory));
        assert_eq!(memory.kept(true, false, 30.1), None);
        let seen = memory.kept(true, true, 25.0).unwrap();
        assert!(seen.kept(true, false, 45.0).is_some(), "counted from when it was last seen");
    }
}
