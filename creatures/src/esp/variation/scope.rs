//! What a stage opens to variation (E-41, E-45, E-59..E-67).

use crate::esp::syllabus::{Growth, Stage, Syllabus};

/// How far variation may go. The control of the skill that is open varies in every scope.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope<'a> {
    /// The first skill: the whole body as well, which also mates (E-59).
    Everything,
    /// A later skill on a body that stays: muscles and receptors that were added for it, as far as it may grow
    /// them (E-59, E-61, E-68).
    Added {
        /// What may be added.
        grow: &'a [Growth],
    },
    /// A later leaf skill in General mode: the whole body, what is locked included, by mutation alone (E-63,
    /// E-65).
    Morphology,
    /// Reconciliation: nothing else (E-67).
    Control,
}

impl<'a> Scope<'a> {
    /// The scope in which a stage of the syllabus evolves its skill.
    pub fn of(stage: &Stage, syllabus: &'a Syllabus) -> Scope<'a> {
        match (stage.opens_body, stage.retests.is_empty()) {
            (true, true) => Scope::Everything, // nothing was learned before
            (true, false) => Scope::Morphology,
            (false, _) => {
                let skill = syllabus.skill(stage.skill).expect("a stage is of a skill of its syllabus");
                Scope::Added { grow: skill.grow() }
            }
        }
    }

    /// Whether creatures are grafted; elsewhere a graft is a mutation (E-61, E-65).
    pub fn grafts(self) -> bool {
        self == Scope::Everything
    }

    /// Whether a creature begins the skill with receptors of its own: one that may see, on a body that stays. A
    /// receptor that is added later is of no use until it is wired, and lost before that as often as not.
    pub(super) fn begins_with_eyes(self) -> bool {
        matches!(self, Scope::Added { grow } if grow.contains(&Growth::Photoreceptors))
    }

    /// The share of mutation events that are of the body (E-41).
    pub(super) fn body_share(self) -> f64 {
        match self {
            Scope::Everything | Scope::Morphology => 0.4,
            Scope::Added { grow } if !grow.is_empty() => 0.2,
            Scope::Added { .. } | Scope::Control => 0.0,
        }
    }

    /// Whether segments and joints are open, and with them all that is locked.
    pub(super) fn opens_skeleton(self) -> bool {
        matches!(self, Scope::Everything | Scope::Morphology)
    }

    /// Whether muscles, or receptors, are open.
    pub(super) fn opens(self, kind: Growth) -> bool {
        match self {
            Scope::Everything | Scope::Morphology => true,
            Scope::Added { grow } => grow.contains(&kind),
            Scope::Control => false,
        }
    }
}
