//! The rounds of a step: which degrees of freedom and contacts hold and which give way. It decides; the
//! linear algebra of a round is in [`super::tree`].
//!
//! Every motor, stop and contact is a monotone law between velocity and impulse, and each round replaces
//! the laws by the straight pieces on which they are thought to be. If the solution lies on these pieces it
//! is *the* solution. If not, all that are wrong switch (block principal pivoting); when that makes no
//! progress only the last one does, which cannot go round in circles. The pieces of the last step are the
//! first guess, so that one round is usual.

use super::World;
use super::contact::Footing;
use super::staircase::Demand;
use super::tree::Singular;

/// Rounds before the last solution is taken as it is, all violated pieces switched (flyer F-38).
const ROUNDS_MAX: u32 = 200;
/// Rounds without progress before pieces switch one at a time (flyer F-38).
const STALL_MAX: u32 = 5;
/// Rounds before sliding contacts take the steps that cannot overshoot.
const NEWTON_ROUNDS: u32 = 8;

impl World {
    /// Finds the velocities at the step's end. Returns the rounds it took.
    pub(super) fn settle(&mut self, footing: Option<&Footing>) -> Result<u32, Singular> {
        let (mut fewest, mut stalled, mut patient) = (usize::MAX, 0, false);
        for round in 1..=ROUNDS_MAX {
            if let Err(fault) = self.solve(footing) {
                // Friction that follows the normal impulse can wedge a body, and then has no solution to
                // first order. Friction of the round before always has one.
                if !self.contacts.iter_mut().fold(false, |any, contact| any | contact.let_go()) {
                    return Err(fault);
                }
                patient = true;
                continue;
            }
            patient |= round > NEWTON_ROUNDS;
            let wrong = self.judge(footing, stalled >= STALL_MAX, patient);
            if wrong == 0 {
                return Ok(round);
            }
            if wrong < fewest {
                (fewest, stalled) = (wrong, 0);
            } else {
                stalled += 1;
            }
        }
        self.solve(footing)?;
        Ok(ROUNDS_MAX + 1)
    }

    /// One round: the velocities, if every piece is right.
    fn solve(&mut self, footing: Option<&Footing>) -> Result<(), Singular> {
        self.load(footing);
        self.eliminate()?;
        self.substitute()
    }

    /// Reads the impulses of a round and switches what was wrong, or only the last of it; returns how many
    /// were wrong.
    fn judge(&mut self, footing: Option<&Footing>, one: bool, patient: bool) -> usize {
        let mut wrong = 0;
        let mut last = None;
        for (index, link) in self.links.iter_mut().enumerate() {
            let mut wrench = None;
            let body = &self.bodies[index + 1];
            for (k, dof) in link.dofs_mut().iter_mut().enumerate() {
                match dof.staircase.demand(dof.tread) {
                    Demand::Free(impulse) => dof.impulse = impulse,
                    Demand::Locked(rate) => {
                        let wrench = wrench.get_or_insert_with(|| body.reaction());
                        (dof.rate, dof.impulse) = (rate, dof.direction.dot(wrench));
                    }
                }
                let tread = dof.staircase.judge(dof.tread, dof.rate, dof.impulse);
                if tread != dof.tread {
                    wrong += 1;
                    if one {
                        last = Some((index, k, tread));
                    } else {
                        dof.tread = tread;
                    }
                }
            }
        }
        if let Some((index, k, tread)) = last {
            self.links[index].dofs_mut()[k].tread = tread;
        }
        let Some(footing) = footing else { return wrong };
        for contact in &mut self.contacts {
            let hold = contact.judge(footing, &self.bodies[contact.body].twist, patient);
            if hold != contact.hold {
                wrong += 1;
                contact.hold = hold;
            }
        }
        wrong
    }
}
