//! The energy balance: what a creature has more than before has to come from its muscles (E-23). Who finds a way
//! to gain energy from the solver loses the trial.

/// The surplus that is a fault, as a height to which it would lift the creature, m. Stops and contacts give back
/// a little of what they took, which is far below it; what an exploit gains has no bound.
pub const TOLERANCE: f64 = 0.25;

/// An account of a creature's mechanical energy.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Balance {
    energy: f64,
    surplus: f64,
}

impl Balance {
    /// Opened with an energy, J.
    pub fn open(energy: f64) -> Balance {
        Balance { energy, surplus: 0.0 }
    }

    /// Enters a step: the energy after it and the muscles' work during it, J.
    ///
    /// Gives the most by which the energy has risen above the work, over any stretch of time that ends now, J.
    /// What was dissipated before a stretch does not count for it, so that a creature cannot hide a gain behind
    /// an earlier loss.
    pub fn enter(&mut self, energy: f64, work: f64) -> f64 {
        let surplus = self.surplus + (energy - self.energy - work);
        self.surplus = if surplus > 0.0 { surplus } else { 0.0 };
        self.energy = energy;
        self.surplus
    }

    /// As after the last step, J.
    pub fn surplus(&self) -> f64 {
        self.surplus
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_no_surplus_and_a_loss_hides_no_gain() {
        let mut balance = Balance::open(10.0);
        assert_eq!(balance.enter(12.0, 2.0), 0.0);
        assert_eq!(balance.enter(5.0, 1.0), 0.0, "8 J are dissipated");
        assert_eq!(balance.enter(7.5, 0.5), 2.0);
        assert_eq!(balance.enter(8.0, -1.0), 3.5);
        assert_eq!(balance.enter(7.0, 0.0), 2.5);
    }
}
