//! The rounds of a step: which degrees of freedom and contacts hold and which give way. It decides; the
//! linear algebra of a round is in [`super::tree`].
//!
//! Every motor, stop and contact is a monotone law between velocity and impulse, and each round replaces
//! the laws by the straight pieces on which they are thought to be. If the solution lies on these pieces it
//! is *the* solution. If not, all that are wrong switch (block principal pivoting); when that makes no
//! progress only the last motor or stop does, and among these that cannot go round in circles. The pieces of
//! the last step are the first guess, so that one round is usual.

use super::World;
use super::contact::{Footing, Patience};
use super::joint::Link;
use super::staircase::Demand;
use super::tree::Singular;

/// Rounds before impulses are cut to their laws and taken as they are (flyer F-38).
pub(super) const ROUNDS_MAX: u32 = 200;
/// Rounds without progress before pieces switch one at a time (flyer F-38).
const STALL_MAX: u32 = 5;
/// Rounds before sliding contacts are linearised more patiently, and once more.
const NEWTON_ROUNDS: u32 = 6;
const LAGGED_ROUNDS: u32 = 24;

impl World {
    /// Finds the velocities at the step's end. Returns the rounds it took.
    pub(super) fn settle(&mut self, footing: Option<&Footing>) -> Result<u32, Singular> {
        let (mut fewest, mut stalled, mut patience) = (usize::MAX, 0, Patience::Newton);
        for round in 1..=self.rounds_max {
            if let Err(fault) = self.solve(footing) {
                if !footing.is_some_and(|footing| self.wedge(footing)) {
                    return Err(fault);
                }
                patience = patience.max(Patience::Lagged);
                continue;
            }
            patience = patience.max(match round {
                LAGGED_ROUNDS.. => Patience::Drag,
                NEWTON_ROUNDS.. => Patience::Lagged,
                _ => Patience::Newton,
            });
            let wrong = self.judge(footing, stalled >= STALL_MAX, patience);
            if wrong == 0 {
                return Ok(round);
            }
            if wrong < fewest {
                (fewest, stalled) = (wrong, 0);
            } else {
                stalled += 1;
            }
        }
        self.clamp(footing);
        self.solve(footing)?;
        Ok(self.rounds_max + 1)
    }

    /// When the rounds have run out: takes the impulses of the last round, each cut to what its law allows at
    /// any velocity, as given. No motor exceeds its effort, no stop or contact pulls, no friction leaves its
    /// cone and no joint opens; what gives way are the wanted rates, in this one step.
    fn clamp(&mut self, footing: Option<&Footing>) {
        for dof in self.links.iter_mut().flat_map(Link::dofs_mut) {
            dof.impulse = dof.staircase.clamp(dof.impulse);
            dof.given = Some(dof.impulse);
        }
        if let Some(footing) = footing {
            for contact in &mut self.contacts {
                contact.clamp(footing, &self.bodies[contact.body].twist);
            }
        }
    }

    /// Makes every point stick whose friction may have made the round's system singular; none if there is
    /// no such point.
    fn wedge(&mut self, footing: &Footing) -> bool {
        let bodies = &self.bodies;
        self.contacts
            .iter_mut()
            .fold(false, |any, contact| any | contact.wedge(footing, &bodies[contact.body].twist))
    }

    /// One round: the velocities, if every piece is right.
    fn solve(&mut self, footing: Option<&Footing>) -> Result<(), Singular> {
        self.load(footing);
        self.eliminate()?;
        self.substitute()
    }

    /// Reads the impulses of a round and switches what was wrong, or only the last of it; returns how many
    /// were wrong.
    fn judge(&mut self, footing: Option<&Footing>, one: bool, patience: Patience) -> usize {
        let mut wrong = 0;
        let mut last = None;
        for (index, link) in self.links.iter_mut().enumerate() {
            let mut wrench = None;
            let body = &self.bodies[index + 1];
            for (k, dof) in link.dofs_mut().iter_mut().enumerate() {
                match dof.demand() {
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
            let hold = contact.judge(footing, &self.bodies[contact.body].twist, patience);
            if hold != contact.hold {
                wrong += 1;
                contact.hold = hold;
            }
        }
        wrong
    }
}
