//! The staircase of a driven degree of freedom: motor and stops as one monotone law from relative rate to
//! impulse. It knows one degree of freedom at a time, and neither bodies nor joints.
//!
//! ```text
//!   impulse   low stop
//!             │
//!   +effort·dt└────────┐ pushing
//!                      │ holding            rate →
//!   −effort·dt         └─────────┐ braking
//!                                │ high stop
//! ```
//!
//! On a tread the impulse is known and the rate is free; on a riser the rate is known (locked) and the
//! impulse is whatever holds it. The law never rises, so the impulses of a step are the slope of a convex
//! function of the velocities, and the step has exactly one solution.

/// Rates that differ by less are the same, rad/s or m/s; without it rounding could make a row that is
/// exactly at a corner switch for ever.
const RATE_SLACK: f64 = 1e-10;
/// The same for impulses, as a share of the motor's bound.
const IMPULSE_SLACK: f64 = 1e-9;

/// What a motor wants, and how hard it may try.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motor {
    /// The wanted relative rate, rad/s (hinge, ball) or m/s (slider), child against parent.
    pub rate: f64,
    /// The largest torque, N·m, or force, N. Anything that is not positive is a limp joint.
    pub effort: f64,
}

/// Where on its staircase a degree of freedom stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Tread {
    /// Locked by the low stop.
    Low,
    /// Free under the motor's whole effort upwards; a limp joint is here, with effort 0.
    #[default]
    Pushing,
    /// Locked at the motor's rate.
    Holding,
    /// Free under the motor's whole effort downwards.
    Braking,
    /// Locked by the high stop.
    High,
}

/// What a degree of freedom asks of a solve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Demand {
    /// A relative rate.
    Locked(f64),
    /// An impulse, N·m·s or N·s.
    Free(f64),
}

/// The staircase of one degree of freedom in one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Staircase {
    /// Rate of the low stop, −∞ if there is none.
    low: f64,
    /// The motor's rate, within low..=high.
    rate: f64,
    /// Rate of the high stop, ∞ if there is none.
    high: f64,
    /// The motor's bound, N·m·s or N·s.
    bound: f64,
}

impl Staircase {
    /// A motor between two stop rates, `low ≤ high`, in a step of `dt` seconds.
    pub(super) fn new(motor: Motor, low: f64, high: f64, dt: f64) -> Staircase {
        let bound = if motor.effort > 0.0 { motor.effort * dt } else { 0.0 };
        let rate = if bound == 0.0 || motor.rate > high {
            high // a limp joint has one tread, Pushing with impulse 0, all the way to its high stop
        } else if motor.rate < low {
            low
        } else {
            motor.rate
        };
        Staircase { low, rate, high, bound }
    }

    /// The closest legal place to that of the last step, whose staircase was another one.
    pub(super) fn warm(&self, last: Tread) -> Tread {
        match last {
            // Locked at no number: the step finds that out, and faults.
            _ if !self.rate.is_finite() && self.bound > 0.0 => Tread::Holding,
            Tread::Low if self.low == f64::NEG_INFINITY => Tread::Pushing,
            Tread::High if self.high == f64::INFINITY => self.warm(Tread::Braking),
            Tread::Holding | Tread::Braking if self.bound == 0.0 => Tread::Pushing,
            Tread::Pushing if self.rate <= self.low => Tread::Holding,
            Tread::Braking if self.rate >= self.high => Tread::Holding,
            tread => tread,
        }
    }

    pub(super) fn demand(&self, tread: Tread) -> Demand {
        match tread {
            Tread::Low => Demand::Locked(self.low),
            Tread::Pushing => Demand::Free(self.bound),
            Tread::Holding => Demand::Locked(self.rate),
            Tread::Braking => Demand::Free(-self.bound),
            Tread::High => Demand::Locked(self.high),
        }
    }

    /// The impulse nearest to a given one that the law allows at any rate at all.
    pub(super) fn clamp(&self, impulse: f64) -> f64 {
        let most = if self.low > f64::NEG_INFINITY { f64::INFINITY } else { self.bound };
        let least = if self.high < f64::INFINITY { f64::NEG_INFINITY } else { -self.bound };
        // Not `max` and `min`, whose zero may have either sign.
        if impulse < least {
            least
        } else if impulse > most {
            most
        } else {
            impulse
        }
    }

    /// The place where the solved rate and impulse belong; the same place if they obey the law there.
    pub(super) fn judge(&self, tread: Tread, rate: f64, impulse: f64) -> Tread {
        let Staircase { low, rate: wanted, high, bound } = *self;
        let slack = bound * IMPULSE_SLACK;
        match tread {
            Tread::Pushing if rate < low - RATE_SLACK => Tread::Low,
            Tread::Pushing if rate > wanted + RATE_SLACK => Tread::Holding,
            Tread::Braking if rate < wanted - RATE_SLACK => Tread::Holding,
            Tread::Braking if rate > high + RATE_SLACK => Tread::High,
            Tread::Pushing | Tread::Braking => tread,
            // Risers at the same rate are one riser: their impulses join.
            Tread::Low if wanted > low && impulse < bound - slack => Tread::Pushing,
            Tread::Low if wanted == low && high > low && impulse < -bound - slack => Tread::Braking,
            Tread::Holding if wanted > low && impulse > bound + slack => Tread::Pushing,
            Tread::Holding if wanted < high && impulse < -bound - slack => Tread::Braking,
            Tread::High if wanted < high && impulse > slack - bound => Tread::Braking,
            Tread::High if wanted == high && low < high && impulse > bound + slack => Tread::Pushing,
            Tread::Low | Tread::Holding | Tread::High => tread,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 0.5;
    const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

    fn motor(rate: f64, effort: f64) -> Motor {
        Motor { rate, effort }
    }

    #[test]
    fn a_motor_holds_its_rate_within_its_effort_and_saturates_beyond() {
        let stairs = Staircase::new(motor(2.0, 4.0), FREE.0, FREE.1, DT);
        assert_eq!(stairs.demand(Tread::Holding), Demand::Locked(2.0));
        assert_eq!(stairs.judge(Tread::Holding, 2.0, 1.9), Tread::Holding);
        assert_eq!(stairs.judge(Tread::Holding, 2.0, 2.1), Tread::Pushing);
        assert_eq!(stairs.judge(Tread::Holding, 2.0, -2.1), Tread::Braking);
        assert_eq!(stairs.demand(Tread::Pushing), Demand::Free(2.0));
        assert_eq!(stairs.judge(Tread::Pushing, 1.9, 2.0), Tread::Pushing);
        assert_eq!(stairs.judge(Tread::Pushing, 2.1, 2.0), Tread::Holding);
        assert_eq!(stairs.judge(Tread::Braking, 1.9, -2.0), Tread::Holding);
    }

    #[test]
    fn a_limp_joint_moves_freely_between_its_stops() {
        let stairs = Staircase::new(motor(3.0, 0.0), -1.0, 1.0, DT);
        assert_eq!(stairs.demand(Tread::Pushing), Demand::Free(0.0));
        assert_eq!(stairs.judge(Tread::Pushing, 0.9, 0.0), Tread::Pushing);
        assert_eq!(stairs.judge(Tread::Pushing, -1.1, 0.0), Tread::Low);
        let high = stairs.judge(Tread::Pushing, 1.1, 0.0);
        assert_eq!(stairs.demand(high), Demand::Locked(1.0));
        assert_eq!(stairs.judge(high, 1.0, -5.0), high);
        assert_eq!(stairs.judge(high, 1.0, 0.1), Tread::Pushing);
        assert_eq!(stairs.judge(Tread::Low, -1.0, -0.1), Tread::Pushing);
    }

    #[test]
    fn a_stop_holds_against_any_motor() {
        let stairs = Staircase::new(motor(10.0, 4.0), -1.0, 0.25, DT);
        assert_eq!(stairs.demand(Tread::Holding), Demand::Locked(0.25));
        assert_eq!(stairs.judge(Tread::Holding, 0.25, -1e6), Tread::Holding);
        assert_eq!(stairs.judge(Tread::Holding, 0.25, 2.1), Tread::Pushing);
        let down = Staircase::new(motor(-10.0, 4.0), -1.0, 0.25, DT);
        assert_eq!(down.judge(Tread::Low, -1.0, 1e6), Tread::Low);
        assert_eq!(down.judge(Tread::Low, -1.0, -1.9), Tread::Low);
        assert_eq!(down.judge(Tread::Low, -1.0, -2.1), Tread::Braking);
    }

    #[test]
    fn a_place_of_the_last_step_that_is_gone_gives_way_to_its_neighbour() {
        let bare = Staircase::new(motor(1.0, 1.0), FREE.0, FREE.1, DT);
        assert_eq!(bare.warm(Tread::Low), Tread::Pushing);
        assert_eq!(bare.warm(Tread::High), Tread::Braking);
        let limp = Staircase::new(motor(1.0, 0.0), FREE.0, FREE.1, DT);
        for last in [Tread::Low, Tread::Pushing, Tread::Holding, Tread::Braking, Tread::High] {
            assert_eq!(limp.warm(last), Tread::Pushing, "{last:?}");
        }
    }
}
