//! Contact of a point with the ground: a spring and a damper that never pull, and Coulomb friction that is
//! viscous below the slip speed. All of it acts on the velocities at the *end* of the step. It knows points
//! and twists, not which body they belong to.
//!
//! Normal: the impulse is `gain · max(0, release − v_n)`, with `gain = dt (k dt + c)`. A point in the ground
//! has `release = −k φ / (k dt + c)`, the backward-Euler spring and damper; a point that would enter the
//! ground within the step has `release = −φ / dt`, and only the rest of its motion is resisted.
//!
//! Friction: against the sliding direction, at most μ times the normal impulse, growing linearly up to it
//! while the speed is below the slip speed. Its bound is taken from the round before (see
//! [`super::rounds`]), so that every round is the minimum of a convex function; a round is accepted when the
//! bound lies between [`FRICTION_SHARE`] and 1 of the cone it belongs to.

use super::spatial::{Inertia, Six};
use glam::DVec3;

/// Friction of an accepted step lies between this share and the whole of Coulomb's cone.
const FRICTION_SHARE: f64 = 0.99;
/// A point that leaves the ground by less than this, m/s, need not switch.
const RATE_SLACK: f64 = 1e-10;

/// The ground: a plane, its compliance and its friction. World settings, not constants of nature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Unit length, out of the ground, world frame.
    pub normal: DVec3,
    /// Of the plane along the normal, m.
    pub offset: f64,
    /// Coulomb's coefficient; the lesser of this and the body's holds (G-48).
    pub friction: f64,
    /// Of one contact point, N/m.
    pub stiffness: f64,
    /// Of one contact point, N·s/m.
    pub damping: f64,
    /// Below this speed friction is viscous, m/s.
    pub slip_speed: f64,
}

impl Ground {
    /// Level ground at z = 0 for bodies of about 0.1 to 0.25 kg: they rest on four to eight points at 0.2 to 1 mm
    /// depth, critically damped, and creep below 2 mm/s where friction holds them.
    pub fn level(friction: f64) -> Ground {
        Ground {
            normal: DVec3::Z,
            offset: 0.0,
            friction,
            stiffness: 1000.0,
            damping: 12.0,
            slip_speed: 0.002,
        }
    }
}

/// The ground's constants of one step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Footing {
    pub(super) normal: DVec3,
    /// Two unit vectors along the ground.
    pub(super) tangents: [DVec3; 2],
    /// Normal impulse for a unit of speed, kg.
    gain: f64,
    /// Release speed for a unit of depth, 1/s.
    recovery: f64,
    slip_speed: f64,
    dt: f64,
}

impl Footing {
    pub(super) fn new(ground: &Ground, dt: f64) -> Footing {
        let impedance = ground.stiffness * dt + ground.damping;
        Footing {
            normal: ground.normal,
            tangents: ground.normal.any_orthonormal_pair().into(),
            gain: dt * impedance,
            recovery: ground.stiffness / impedance,
            slip_speed: ground.slip_speed,
            dt,
        }
    }
}

/// What a contact does in a round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Hold {
    /// Nothing.
    Open,
    /// Normal impulse, and friction of `drag` kg times the tangential velocity.
    Drag { drag: f64 },
    /// Normal impulse, and friction of `fixed + follow · normal impulse` against a sliding direction along the
    /// tangents: Newton's linearisation about that direction, which leaves the speed free and resists
    /// turning.
    Slide { direction: [f64; 2], turning: f64, fixed: f64, follow: f64 },
    /// The impulses that stand in the contact, whatever the velocity.
    Given,
}

impl Hold {
    /// Whether the ground presses.
    pub(super) fn touches(&self) -> bool {
        *self != Hold::Open
    }
}

/// How a contact that slides is linearised: from quadratic convergence to certain convergence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Patience {
    /// Friction follows the normal impulse within the round.
    Newton,
    /// Friction is that of the round before: a round is then the minimum of a convex function.
    Lagged,
    /// And its size at the speed of the round before, which cannot overshoot.
    Drag,
}

/// Where a point is at or near the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site {
    pub(super) body: usize,
    /// Its place among all contact points.
    pub(super) point: usize,
    /// Coulomb's coefficient.
    pub(super) coulomb: f64,
    /// From the reference point, m.
    pub(super) at: DVec3,
    /// To the ground, m; negative within it.
    pub(super) gap: f64,
}

/// A point at or near the ground, and what it does there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub(super) body: usize,
    /// Its place among all contact points.
    pub(super) point: usize,
    /// Coulomb's coefficient.
    coulomb: f64,
    /// The one that is used: a little less, so that a direction found to first order stays in the cone.
    friction: f64,
    /// Speed along the normal at which the ground lets go, m/s.
    release: f64,
    /// Rows of the normal and the two tangents: twist to velocity of the point.
    rows: [Six; 3],
    pub(super) hold: Hold,
    /// The normal impulse that friction is thought to belong to, N·s.
    load: f64,
    /// Solved normal impulse, N·s.
    pub(super) pressure: f64,
    /// Solved friction impulse along the tangents, N·s.
    pub(super) shear: [f64; 2],
}

impl Contact {
    /// A contact at a site. `twist` and `pressure` are those of the step before, and serve as a first guess.
    pub(super) fn new(footing: &Footing, site: &Site, twist: &Six, pressure: f64) -> Contact {
        let Site { body, point, coulomb, at, gap } = *site;
        let row = |d: DVec3| Six::new(d, at.cross(d));
        let release = if gap <= 0.0 { -gap * footing.recovery } else { -gap / footing.dt };
        let rows = [row(footing.normal), row(footing.tangents[0]), row(footing.tangents[1])];
        let mut contact = Contact {
            body,
            point,
            coulomb,
            friction: 0.5 * (1.0 + FRICTION_SHARE) * coulomb,
            release,
            rows,
            hold: Hold::Open,
            load: 0.0,
            pressure: 0.0,
            shear: [0.0; 2],
        };
        let expected = footing.gain * (release - rows[0].dot(twist));
        if expected > 0.0 {
            contact.load = if pressure > 0.0 { pressure } else { expected };
            contact.hold = contact.grip(footing, contact.slip(twist), Patience::Newton);
        }
        contact
    }

    /// Adds the contact to its body's inertia and momentum.
    pub(super) fn load(&self, footing: &Footing, inertia: &mut Inertia, momentum: &mut Six) {
        let [normal, first, second] = &self.rows;
        let mut push = *normal;
        match self.hold {
            Hold::Open => return,
            Hold::Given => {
                momentum.add_scaled(normal, self.pressure);
                momentum.add_scaled(first, self.shear[0]);
                momentum.add_scaled(second, self.shear[1]);
                return;
            }
            Hold::Drag { drag } => {
                inertia.add_outer(first, first, drag);
                inertia.add_outer(second, second, drag);
            }
            Hold::Slide { direction: [x, y], turning, fixed, follow } => {
                let mut across = Six::ZERO;
                across.add_scaled(first, -y);
                across.add_scaled(second, x);
                inertia.add_outer(&across, &across, turning);
                push.add_scaled(first, -follow * x);
                push.add_scaled(second, -follow * y);
                momentum.add_scaled(first, -fixed * x);
                momentum.add_scaled(second, -fixed * y);
            }
        }
        inertia.add_outer(&push, normal, footing.gain);
        momentum.add_scaled(&push, footing.gain * self.release);
    }

    /// Reads impulses off a solved twist and says what the contact should have done; the same as
    /// [`Contact::hold`] if it did that.
    pub(super) fn judge(&mut self, footing: &Footing, twist: &Six, patience: Patience) -> Hold {
        let normal = self.rows[0].dot(twist);
        let slip = self.slip(twist);
        let speed = length(slip);
        let pressure = footing.gain * (self.release - normal);
        let (pressure, shear) = match self.hold {
            Hold::Open if normal >= self.release - RATE_SLACK => (0.0, [0.0; 2]),
            Hold::Open => {
                (self.pressure, self.shear) = (0.0, [0.0; 2]);
                if patience == Patience::Newton {
                    self.load = pressure;
                }
                return self.grip(footing, slip, patience);
            }
            Hold::Given => return Hold::Given,
            Hold::Drag { drag } => (pressure, [-drag * slip[0], -drag * slip[1]]),
            Hold::Slide { direction: [x, y], turning, fixed, follow } => {
                let across = turning * (x * slip[1] - y * slip[0]);
                let along = fixed + follow * pressure;
                (pressure, [-along * x + across * y, -along * y - across * x])
            }
        };
        (self.pressure, self.shear) = (pressure, shear);
        let cone = self.coulomb * pressure;
        let against = -(shear[0] * slip[0] + shear[1] * slip[1]);
        let holds = match self.hold {
            Hold::Open | Hold::Given => true,
            _ if pressure < 0.0 => return Hold::Open,
            _ if length(shear) > cone => false,
            Hold::Slide { direction: [x, y], .. } if x * slip[0] + y * slip[1] < footing.slip_speed => false,
            // Below the slip speed the drag may be too small by half: the slip speed is a bound of what cannot
            // be seen, not a quantity.
            Hold::Drag { drag } if speed < footing.slip_speed => drag * footing.slip_speed >= 0.5 * cone,
            Hold::Slide { .. } | Hold::Drag { .. } => against >= FRICTION_SHARE * cone * speed,
        };
        if holds {
            return self.hold;
        }
        self.load = if patience == Patience::Newton { pressure } else { 0.5 * (self.load + pressure) };
        self.grip(footing, slip, patience)
    }

    /// Holds otherwise from the next round on.
    pub(super) fn switch(&mut self, hold: Hold) {
        if hold == Hold::Open {
            // Should it come back, then with less friction: too much of it may have lifted the point.
            self.load *= 0.5;
        }
        self.hold = hold;
    }

    /// How a contact under its load holds at a tangential velocity.
    fn grip(&self, footing: &Footing, slip: [f64; 2], patience: Patience) -> Hold {
        let friction = self.friction * self.load;
        let speed = length(slip);
        let backwards = match self.hold {
            Hold::Slide { direction: [x, y], .. } => x * slip[0] + y * slip[1] <= 0.0,
            Hold::Open | Hold::Drag { .. } | Hold::Given => false,
        };
        if speed <= footing.slip_speed || backwards {
            Hold::Drag { drag: friction / footing.slip_speed }
        } else {
            let direction = [slip[0] / speed, slip[1] / speed];
            let turning = friction / speed;
            match patience {
                Patience::Newton => Hold::Slide { direction, turning, fixed: 0.0, follow: self.friction },
                Patience::Lagged => Hold::Slide { direction, turning, fixed: friction, follow: 0.0 },
                Patience::Drag => Hold::Drag { drag: turning },
            }
        }
    }

    /// Cuts the impulses that its law gives at a twist to a push within the cone, and takes them as given.
    pub(super) fn clamp(&mut self, footing: &Footing, twist: &Six) {
        self.judge(footing, twist, Patience::Drag);
        self.pressure = if self.pressure > 0.0 { self.pressure } else { 0.0 };
        let (share, cone) = (length(self.shear), self.coulomb * self.pressure);
        if share > cone {
            self.shear = self.shear.map(|x| x * (cone / share));
        }
        self.hold = Hold::Given;
    }

    /// Friction that follows the normal impulse can wedge a point: the more it is held, the harder it is
    /// pressed, and the linearised system is not regular. Such a point sticks. Returns whether this one
    /// could have been it.
    pub(super) fn wedge(&mut self, footing: &Footing, twist: &Six) -> bool {
        let Hold::Slide { follow, .. } = self.hold else { return false };
        if follow > 0.0 {
            let pressure = footing.gain * (self.release - self.rows[0].dot(twist));
            let drag = if pressure > 0.0 { self.friction * pressure / footing.slip_speed } else { 0.0 };
            self.hold = Hold::Drag { drag };
        }
        follow > 0.0
    }

    /// Velocity along the tangents, m/s.
    fn slip(&self, twist: &Six) -> [f64; 2] {
        [self.rows[1].dot(twist), self.rows[2].dot(twist)]
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}
