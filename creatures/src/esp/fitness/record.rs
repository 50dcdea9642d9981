//! What is recorded of a trial: one moment a physics step, and the windows that fitness looks through.

use super::setup::steps;
use glam::DVec3;

/// Steps over which the force of an impact is averaged (E-74).
const IMPACT_STEPS: usize = 3;

/// A creature's state after one step. The start frame has its origin on the ground under the settled centre
/// of mass, x along the forward axis at the start, y to the left, z up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moment {
    /// Of the centre of mass, start frame, m.
    pub position: DVec3,
    /// Of the centre of mass, m/s.
    pub speed: f64,
    /// Left turn of the forward axis since the start, unwrapped, rad.
    pub yaw: f64,
    /// Vertical part of the root's up axis, −1 to 1.
    pub up: f64,
    /// Height of the body's highest point, m.
    pub top: f64,
    /// Sum of the normal forces of the ground, body weights.
    pub ground_force: f64,
    /// Horizontal distance from the centre of mass to the target, m; 0 without one.
    pub light_distance: f64,
    /// From the forward axis to the target, left positive, rad, within ±π; 0 without one.
    pub light_angle: f64,
    /// Mean activation of the muscles over the step, weighted by their strength; 0 without muscles.
    pub effort: f64,
    /// Whether any part touches a disc.
    pub touched: bool,
}

/// A trial as it was lived.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Record {
    /// The state at the start, then one after every step; never empty once the trial has begun.
    pub moments: Vec<Moment>,
    /// Whether the trial's end came before its time.
    pub ended: bool,
    /// Whether the creature has any muscle.
    pub has_muscles: bool,
}

impl Record {
    /// The state at the end.
    pub fn last(&self) -> Moment {
        self.moments.last().copied().unwrap_or_default()
    }

    /// The state at a time, s; that at the end if the time was not reached.
    pub fn at(&self, seconds: f64) -> Moment {
        self.moments.get(steps(seconds)).copied().unwrap_or_else(|| self.last())
    }

    /// Every moment later than a time, s.
    pub fn after(&self, seconds: f64) -> &[Moment] {
        self.moments.get(steps(seconds) + 1..).unwrap_or(&[])
    }

    /// The moments up to a time, s, the start included.
    pub fn until(&self, seconds: f64) -> &[Moment] {
        &self.moments[..self.moments.len().min(steps(seconds) + 1)]
    }

    /// Every moment after the start.
    pub fn lived(&self) -> &[Moment] {
        self.after(0.0)
    }

    /// The hardest impact on the ground, body weights: the force averaged over three steps (E-74).
    pub fn hardest_impact(&self) -> f64 {
        let lived = self.lived();
        let ends = 1..=lived.len();
        ends.map(|end| impact(&lived[..end])).fold(0.0, |most, next| if next > most { next } else { most })
    }
}

/// The force on the ground averaged over the last three moments, body weights; 0 while there are fewer.
pub(super) fn impact(moments: &[Moment]) -> f64 {
    match moments.len().checked_sub(IMPACT_STEPS) {
        Some(start) => mean_of(&moments[start..], |moment| moment.ground_force),
        None => 0.0,
    }
}

/// The mean of a quantity, 0 over no moments.
pub(super) fn mean_of(moments: &[Moment], quantity: impl Fn(&Moment) -> f64) -> f64 {
    if moments.is_empty() { 0.0 } else { moments.iter().map(quantity).sum::<f64>() / moments.len() as f64 }
}

/// The least of a quantity, infinite over no moments.
pub(super) fn least_of(moments: &[Moment], quantity: impl Fn(&Moment) -> f64) -> f64 {
    moments.iter().map(quantity).fold(f64::INFINITY, |least, next| if next < least { next } else { least })
}

/// The greatest of a quantity, −∞ over no moments.
pub(super) fn most_of(moments: &[Moment], quantity: impl Fn(&Moment) -> f64) -> f64 {
    -least_of(moments, |moment| -quantity(moment))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn forces(forces: &[f64]) -> Record {
        let moments = forces.iter().map(|&ground_force| Moment { ground_force, ..Moment::default() });
        Record { moments: moments.collect(), ..Record::default() }
    }

    /// E-74: a spike of one step counts a third, and the start not at all.
    #[test]
    fn an_impact_is_averaged_over_three_steps() {
        assert_eq!(forces(&[9.0, 0.0, 9.0, 0.0, 3.0, 0.0]).hardest_impact(), 4.0);
        assert_eq!(forces(&[9.0, 9.0, 9.0]).hardest_impact(), 0.0, "two steps are too few");
    }

    #[test]
    fn windows_are_open_at_their_start_and_closed_at_their_end() {
        let record = forces(&[0.0; 601]);
        assert_eq!((record.after(5.0).len(), record.until(2.0).len(), record.lived().len()), (300, 121, 600));
        assert_eq!((record.after(20.0).len(), record.until(20.0).len()), (0, 601));
    }
}
