//! The flyers' fitness: time in the air, and speed along a smooth path (F-57..F-59). It sees velocities only.

use glam::{DVec2, DVec3};

/// Horizontal speeds below this have no heading, m/s (F-57).
const STANDSTILL: f64 = 1e-6;

/// What a flight has earned so far; it starts at rest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Flight {
    /// Steps in the air, `n_hover` (F-58).
    pub steps: u32,
    /// The sum over steps of `s_t (ĥ_t · ĥ_(t−1)) / (1 + |δ(v_y)|)`, m/s.
    pub speed_sum: f64,
    /// Of the last step, unit length or zero.
    heading: DVec2,
}

impl Flight {
    /// Adds a step at whose end the centre of mass moves at `velocity`, m/s, y up.
    ///
    /// Speed counts by how far it keeps to the heading of the step before, so that a reversal costs; sinking
    /// takes its share off, climbing does not.
    pub fn add(&mut self, velocity: DVec3) {
        let horizontal = DVec2::new(velocity.x, velocity.z);
        let speed = horizontal.length();
        let heading = if speed > STANDSTILL { horizontal / speed } else { DVec2::ZERO };
        let sinking = if velocity.y < 0.0 { -velocity.y } else { 0.0 };
        self.speed_sum += speed * heading.dot(self.heading) / (1.0 + sinking);
        self.heading = heading;
        self.steps += 1;
    }

    /// The weighted sum of both. It may be negative, and does not ask how far the creature got (F-59).
    pub fn fitness(&self, w_hover: f64, w_speed: f64) -> f64 {
        w_hover * f64::from(self.steps) + w_speed * self.speed_sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T-18
    #[test]
    fn fitness_pays_for_hovering_and_for_speed_along_a_smooth_path() {
        let path = [
            (DVec3::new(3.0, 0.0, 4.0), 0.0),
            (DVec3::new(3.0, -1.0, 4.0), 2.5),
            (DVec3::new(-4.0, 2.0, 3.0), 0.0),
            (DVec3::new(-4.0, 0.0, 3.0), 5.0),
            (DVec3::new(4.0, 0.0, -3.0), -5.0),
            (DVec3::new(8.0, -3.0, -6.0), 2.5),
        ];
        let mut flight = Flight::default();
        for (velocity, term) in path {
            let before = flight.speed_sum;
            flight.add(velocity);
            assert!((flight.speed_sum - before - term).abs() < 1e-12, "{velocity}");
        }
        assert_eq!(flight.steps, 6);
        assert!((flight.speed_sum - 5.0).abs() < 1e-12);
        assert!((flight.fitness(1.0, 1.0) - 11.0).abs() < 1e-12);
        assert!((flight.fitness(2.0, -3.0) + 3.0).abs() < 1e-12);
    }

    /// F-58
    #[test]
    fn sinking_costs_and_climbing_earns_nothing() {
        let term = |climb: f64| {
            let mut flight = Flight::default();
            flight.add(DVec3::X);
            flight.add(DVec3::new(1.0, climb, 0.0));
            flight.speed_sum
        };
        assert_eq!([term(0.0), term(5.0), term(-4.0)], [1.0, 1.0, 0.2]);
    }

    #[test]
    fn a_standstill_has_no_heading() {
        let mut flight = Flight::default();
        for velocity in [DVec3::X, DVec3::new(1e-7, -5.0, 0.0), DVec3::X] {
            flight.add(velocity);
        }
        assert_eq!(flight.speed_sum, 0.0);
    }
}
