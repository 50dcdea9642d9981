//! Encapsulation: a learned skill is put behind one sigma and locked (E-46, E-48). The gates and sigmas are no
//! genes: they follow from the seal, so that no genotype can have half of them.

use super::brain::{Brain, Seal};
use super::syllabus::SkillId;

impl Brain {
    /// Encapsulates the skill under evolution: from now on each of its outputs passes a gate, all gates hang on
    /// the skill's sigma, and nothing in its control changes any more. With the sigma held at 1 every muscle does
    /// to the bit what it did before; with 0 the skill sends nothing, and its nodes run on.
    ///
    /// Does nothing to a skill that is encapsulated already, or that has no control.
    pub fn encapsulate(&mut self, skill: SkillId) {
        self.seal(skill, Seal::Locked);
    }

    /// Opens the control of one encapsulated skill for reconciliation: nodes, wires and gated outputs (E-67).
    pub fn reopen(&mut self, skill: SkillId) {
        self.seal(skill, Seal::Reopened);
    }

    fn seal(&mut self, skill: SkillId, seal: Seal) {
        if let Some(control) = self.control_mut(skill) {
            control.seal = seal;
        }
    }
}

#[cfg(test)]
mod tests;
