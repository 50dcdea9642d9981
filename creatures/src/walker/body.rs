//! The four bodies as data: parts, joints, their motors and stops (G-16..G-18, G-51..G-55). It builds no
//! world and steps no physics; `phenotype` does.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};

/// Which of the four published bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyKind {
    /// Two front arms on hinges.
    Crawler,
    /// Two three-link arms with paddle hands on top, all hinges.
    Arm,
    /// Two legs under the body, each a thigh on a hinge and a foot on a slider.
    Hopper,
    /// A pair of arms on ball joints, one to each side.
    Runner,
}

impl BodyKind {
    /// Every body, in the paper's order.
    pub const ALL: [BodyKind; 4] = [BodyKind::Crawler, BodyKind::Arm, BodyKind::Hopper, BodyKind::Runner];

    /// Its name in experiment files and genotypes.
    pub fn name(self) -> &'static str {
        match self {
            BodyKind::Crawler => "crawler",
            BodyKind::Arm => "arm",
            BodyKind::Hopper => "hopper",
            BodyKind::Runner => "runner",
        }
    }

    /// The body of a name.
    pub fn named(name: &str) -> Option<BodyKind> {
        BodyKind::ALL.into_iter().find(|body| body.name() == name)
    }

    /// How it is built.
    pub fn plan(self) -> &'static Plan {
        match self {
            BodyKind::Crawler => &CRAWLER,
            BodyKind::Arm => &ARM,
            BodyKind::Hopper => &HOPPER,
            BodyKind::Runner => &RUNNER,
        }
    }

    /// Degrees of freedom, hence speed commands: the sum over joints (G-17).
    pub fn degrees(self) -> usize {
        2 * self.plan().limb.iter().map(|link| link.drive.degrees()).sum::<usize>()
    }

    /// Sensor values: joint coordinates, eight of the torso, touches (G-17).
    pub fn inputs(self) -> usize {
        let plan = self.plan();
        let limb_touches = plan.limb.iter().filter(|link| link.part.touch).count();
        self.degrees() + TORSO_VALUES + usize::from(plan.torso.touch) + 2 * limb_touches
    }
}

/// Linear velocity 3, angular velocity 3, height, direction (G-17).
const TORSO_VALUES: usize = 8;

/// A torso and a limb that it carries twice, mirrored in x (G-51).
#[derive(Debug)]
pub struct Plan {
    /// The part whose motion is measured.
    pub torso: Part,
    /// One limb from the torso outwards, written for the side x > 0; the other side mirrors x.
    pub limb: &'static [Link],
}

/// A box.
#[derive(Debug)]
pub struct Part {
    /// Its name in recordings.
    pub name: &'static str,
    /// Full edge lengths, m.
    pub size: DVec3,
    /// kg/m³.
    pub density: f64,
    /// What it rubs the ground with.
    pub surface: Surface,
    /// Whether it carries a touch sensor.
    pub touch: bool,
}

/// What a part is covered with; the coefficients are the world's (G-48).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// The torso's smooth shell.
    Shell,
    /// The limbs' rubber.
    Rubber,
}

/// A part and the joint that holds it to the part before it.
#[derive(Debug)]
pub struct Link {
    /// The part at the far end of the joint.
    pub part: Part,
    /// Kind of joint with its motor.
    pub drive: Drive,
    /// Joint point in the parent's frame, m, side x > 0.
    pub parent_anchor: DVec3,
    /// Joint point in the part's own frame, m, side x > 0.
    pub child_anchor: DVec3,
    /// Lowest and highest coordinate, rad or m.
    pub stops: Option<(f64, f64)>,
}

/// Kind of joint, its axis and its motor (G-18, G-51).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drive {
    /// About the parent's +x.
    Hinge,
    /// Along the parent's −z, so that a positive command extends.
    Slider,
    /// Three independent motors about the parent's x, y and z.
    Ball,
}

/// Newton metres in a gram-force centimetre.
const GRAM_FORCE_CENTIMETRE: f64 = 9.80665e-5;
/// The slider's motor is printed as a torque; read as one on a pinion of this radius, m (G-18).
const PINION_RADIUS: f64 = 0.01;

impl Drive {
    /// Degrees of freedom.
    pub fn degrees(self) -> usize {
        match self {
            Drive::Hinge | Drive::Slider => 1,
            Drive::Ball => 3,
        }
    }

    /// The most its motor exerts, N·m or N, on each degree of freedom (G-18).
    pub fn effort(self) -> f64 {
        match self {
            Drive::Hinge => 800.0 * GRAM_FORCE_CENTIMETRE,
            Drive::Slider => 1200.0 * GRAM_FORCE_CENTIMETRE / PINION_RADIUS,
            Drive::Ball => 600.0 * GRAM_FORCE_CENTIMETRE,
        }
    }

    /// The relative speed of a command of 1, rad/s or m/s (G-18).
    pub fn speed(self) -> f64 {
        match self {
            Drive::Hinge | Drive::Ball => 10.0,
            Drive::Slider => 1.0,
        }
    }
}

const fn shell(x: f64, y: f64, z: f64, density: f64) -> Part {
    Part { name: "torso", size: DVec3::new(x, y, z), density, surface: Surface::Shell, touch: true }
}

const fn limb(name: &'static str, x: f64, y: f64, z: f64, density: f64, touch: bool) -> Part {
    Part { name, size: DVec3::new(x, y, z), density, surface: Surface::Rubber, touch }
}

static CRAWLER: Plan = Plan {
    torso: shell(0.12, 0.20, 0.05, 100.0),
    limb: &[Link {
        part: limb("arm", 0.02, 0.15, 0.02, 300.0, true),
        drive: Drive::Hinge,
        parent_anchor: DVec3::new(0.045, -0.10, 0.0),
        child_anchor: DVec3::new(0.0, 0.075, 0.0),
        stops: None,
    }],
};

static ARM: Plan = Plan {
    torso: shell(0.12, 0.24, 0.04, 150.0),
    limb: &[
        Link {
            part: limb("upper_arm", 0.02, 0.09, 0.02, 200.0, false),
            drive: Drive::Hinge,
            parent_anchor: DVec3::new(0.04, -0.09, 0.03),
            child_anchor: DVec3::new(0.0, 0.045, 0.0),
            stops: None,
        },
        Link {
            part: limb("forearm", 0.02, 0.09, 0.02, 200.0, false),
            drive: Drive::Hinge,
            parent_anchor: DVec3::new(0.0, -0.045, 0.0),
            child_anchor: DVec3::new(0.0, 0.045, 0.0),
            stops: Some((-2.0 * PI / 3.0, 2.0 * PI / 3.0)),
        },
        Link {
            part: limb("hand", 0.06, 0.06, 0.01, 200.0, true),
            drive: Drive::Hinge,
            parent_anchor: DVec3::new(0.0, -0.045, 0.0),
            child_anchor: DVec3::new(0.0, 0.03, 0.0),
            stops: Some((-FRAC_PI_2, FRAC_PI_2)),
        },
    ],
};

static HOPPER: Plan = Plan {
    torso: shell(0.12, 0.12, 0.06, 150.0),
    limb: &[
        Link {
            part: limb("thigh", 0.03, 0.03, 0.08, 300.0, false),
            drive: Drive::Hinge,
            parent_anchor: DVec3::new(0.045, 0.0, -0.03),
            child_anchor: DVec3::new(0.0, 0.0, 0.04),
            stops: None,
        },
        Link {
            part: limb("foot", 0.024, 0.06, 0.08, 300.0, true),
            drive: Drive::Slider,
            parent_anchor: DVec3::new(0.0, 0.0, -0.04),
            child_anchor: DVec3::ZERO,
            stops: Some((0.0, 0.08)),
        },
    ],
};

static RUNNER: Plan = Plan {
    torso: shell(0.08, 0.16, 0.04, 100.0),
    limb: &[Link {
        part: limb("arm", 0.22, 0.02, 0.02, 200.0, true),
        drive: Drive::Ball,
        parent_anchor: DVec3::new(0.04, -0.04, 0.01),
        child_anchor: DVec3::new(-0.11, 0.0, 0.0),
        stops: None,
    }],
};

#[cfg(test)]
mod tests {
    use super::*;

    /// G-17's table: inputs, degrees of freedom.
    #[test]
    fn every_body_has_the_sensors_and_motors_of_the_table() {
        let counts = BodyKind::ALL.map(|body| (body.inputs(), body.degrees()));
        assert_eq!(counts, [(13, 2), (17, 6), (15, 4), (17, 6)]);
    }

    /// G-51's masses, kg, torso and limb parts; the hopper's foot is heavier than its thigh.
    #[test]
    fn every_part_weighs_what_the_table_says() {
        let masses = |body: BodyKind| {
            let plan = body.plan();
            let mass = |part: &Part| part.size.element_product() * part.density;
            std::iter::once(mass(&plan.torso)).chain(plan.limb.iter().map(|l| mass(&l.part))).collect()
        };
        let expected: [Vec<f64>; 4] = [
            vec![0.12, 0.018],
            vec![0.1728, 0.0072, 0.0072, 0.0072],
            vec![0.1296, 0.0216, 0.03456],
            vec![0.0512, 0.0176],
        ];
        for (body, expected) in BodyKind::ALL.into_iter().zip(expected) {
            let found: Vec<f64> = masses(body);
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-12, "{body:?}: {found} is not {expected}");
            }
        }
    }

    /// G-18's table in SI.
    #[test]
    fn motors_have_the_efforts_of_the_table() {
        let efforts = [Drive::Hinge, Drive::Slider, Drive::Ball].map(Drive::effort);
        for (found, expected) in efforts.into_iter().zip([0.0784532, 11.76798, 0.0588399]) {
            assert!((found - expected).abs() < 1e-9);
        }
    }

    #[test]
    fn names_lead_back_to_their_bodies() {
        for body in BodyKind::ALL {
            assert_eq!(BodyKind::named(body.name()), Some(body));
            assert_eq!(serde_json::to_value(body).unwrap(), body.name());
        }
        assert_eq!(BodyKind::named("snail"), None);
    }
}
