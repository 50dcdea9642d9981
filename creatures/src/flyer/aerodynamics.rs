//! The air's forces on one cylinder and its film, from how they move through still air (F-42..F-47). All is
//! in the axes of the cylinder, whose own axis is z, about its centre of mass. It moves nothing.

use super::film::Film;
use glam::DVec3;
use std::f64::consts::PI;

/// Density of air, kg/m³: normal forces at a scale factor of 1 (F-42).
const AIR_DENSITY: f64 = 1.2;
/// Viscosity of air, Pa·s: tangential forces at a scale factor of 1 (F-42).
const AIR_VISCOSITY: f64 = 1.81e-5;

/// Still air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Air {
    /// αn, of forces along a surface's normal.
    normal: f64,
    /// αt, of forces along a surface.
    tangential: f64,
}

impl Air {
    /// Air whose forces are scaled by the paper's factor α; 0 is a vacuum (F-42, X-12).
    pub fn scaled(alpha: f64) -> Air {
        Air { normal: AIR_DENSITY * alpha, tangential: AIR_VISCOSITY * alpha }
    }
}

/// A force, N, and a torque, N·m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wrench {
    /// At the centre of mass.
    pub force: DVec3,
    /// About the centre of mass.
    pub torque: DVec3,
}

/// What the air does to a capped cylinder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hull {
    /// Drag of the side and of the caps, each by its square of speed: N·s²/m².
    side: f64,
    caps: f64,
    /// Drag of turning about each axis by its square of angular speed: N·m·s².
    turning: DVec3,
}

impl Hull {
    /// Of a radius R and a length L without caps, m.
    pub fn new(air: Air, radius: f64, length: f64) -> Hull {
        let (r, h) = (radius, 0.5 * length + radius);
        let across = air.normal * r * (h * h) * (h * h);
        let along = 0.5 * air.normal * (2.0 * h) * (r * r) * (r * r);
        Hull {
            side: air.normal * 2.0 * r * length,
            caps: air.normal * PI * r * r,
            turning: DVec3::new(across, across, along),
        }
    }

    /// With tail feathers, which hold it harder about x alone (F-47).
    #[must_use]
    pub fn with_tail(mut self, weight: f64) -> Hull {
        self.turning.x *= weight;
        self
    }

    /// F-45: `F = −αn (2RL sinΘ + πR²) |v| v`, and F-46: `T = −c |ω| ω` about each axis, the paper's
    /// integrals of drag over the length and the radius in closed form.
    ///
    /// `velocity` is of the centre of mass, m/s, `spin` in rad/s. `|v| sinΘ` is the speed across the axis, so
    /// that rest needs no exception.
    pub fn drag(&self, velocity: DVec3, spin: DVec3) -> Wrench {
        let across = velocity.truncate().length();
        Wrench {
            force: velocity * -(self.side * across + self.caps * velocity.length()),
            torque: -self.turning * spin.abs() * spin,
        }
    }
}

/// What the air does to a film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sail {
    normal: DVec3,
    /// From the centre of mass of the cylinder that carries it, m.
    points: [DVec3; 4],
    /// Of one of the four pieces, by its normal speed squared and its tangential speed.
    pressure: f64,
    friction: f64,
    /// The stability number at a normal speed of 1 m/s.
    stability: f64,
    limited: bool,
}

impl Sail {
    /// Of a film in the axes of the cylinder that carries it, whose mass is in kg, under steps of `dt` s.
    ///
    /// A `limited` sail gives way so that one step never turns its motion back (F-40).
    pub fn new(air: Air, film: &Film, mass: f64, dt: f64, limited: bool) -> Sail {
        let piece = 0.25 * film.area();
        Sail {
            normal: film.normal(),
            points: film.centroids(),
            pressure: air.normal * piece,
            friction: air.tangential * piece,
            stability: dt * air.normal * film.area() / mass,
            limited,
        }
    }

    /// `N = dt αn A |vn| / m`, at a normal speed in m/s: below 1 a free film slows down, above 2 it speeds up
    /// by what should slow it (F-40).
    pub fn stability(&self, speed: f64) -> f64 {
        self.stability * speed
    }

    /// F-43: on each piece `F = −αn (A/4) |vn| vn n − αt (A/4) vt` at its centroid, of which F-44 takes the
    /// sum. `velocity` is of the centre of mass, m/s, `spin` in rad/s.
    pub fn drag(&self, velocity: DVec3, spin: DVec3) -> Wrench {
        let mut wrench = Wrench { force: DVec3::ZERO, torque: DVec3::ZERO };
        for point in self.points {
            let motion = velocity + spin.cross(point);
            let vn = motion.dot(self.normal);
            let mut k = self.pressure * vn.abs();
            if self.limited {
                k /= 1.0 + self.stability(vn.abs());
            }
            let along = motion - self.normal * vn;
            let force = self.normal * -(k * vn) - along * self.friction;
            wrench.force += force;
            wrench.torque += point.cross(force);
        }
        wrench
    }
}

#[cfg(test)]
mod tests;
