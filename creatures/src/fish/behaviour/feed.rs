//! Eating: after it, and within a fifth of a body length the mouth opens and sucks. What is
//! swallowed is the world's to say.

use crate::fish::{Chase, Command, Posture};
use glam::DVec3;

/// Nearer than this by L the mouth opens.
const REACH: f64 = 0.2;
/// Time of a mouth that opens, and stays open.
const OPENS: f64 = 2.5;
/// Time of a mouth that closes.
const CLOSES: f64 = 0.5;

/// What a mouth is doing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Bite {
    /// Nothing.
    #[default]
    Closed,
    /// Opening or open, since a time.
    Open(f64),
    /// Closing, since a time.
    Closing(f64),
}

impl Bite {
    /// Whether the mouth is to be open, at a time, with something to suck in within reach or not.
    fn step(&mut self, within: bool, time: f64) -> bool {
        *self = match *self {
            Bite::Closed if within => Bite::Open(time),
            Bite::Open(since) if time - since >= OPENS => Bite::Closing(time),
            Bite::Closing(since) if time - since >= CLOSES => Bite::Closed,
            same => same,
        };
        matches!(self, Bite::Open(_))
    }
}

/// Makes for a place to eat at. `length` is L, `size` is S.
pub fn eat(
    chase: &mut Chase,
    bite: &mut Bite,
    food: DVec3,
    posture: &Posture<'_>,
    size: f64,
    time: f64,
) -> Command {
    let within = (food - posture.mouth()).length() <= REACH * 20.0 * size;
    let mouth_open = bite.step(within, time);
    Command { mouth_open, ..chase.toward(food, 1.0, posture, size) }
}

#[cfg(test)]
mod tests {
    use super::*;

    ///
    #[test]
    fn a_mouth_opens_stays_open_and_closes() {
        let mut bite = Bite::default();
        assert!(!bite.step(false, 0.0) && bite.step(true, 1.0) && bite.step(false, 3.4));
        assert!(!bite.step(true, 3.5) && !bite.step(true, 3.9) && !bite.step(true, 4.0));
        assert!(bite.step(true, 4.1), "and again");
    }
}
