//! The skeleton that a genotype develops: where every cylinder starts, on what it hangs, and the film between
//! the two (F-12..F-16, F-20, F-22). It has no mass, no brain and no motion.

use super::Genotype;
use super::film::Film;
use super::genotype::{BODY, FIRST_SEGMENT, Node, WING_ROOT};
use crate::math::{cos, sin};
use glam::{DMat3, DVec3};

/// One cylinder in the start pose. Its axis is its z; its start is at −L/2, its end at +L/2 (F-3).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bone {
    /// Without caps, m.
    pub length: f64,
    /// Of the cylinder and its caps, m.
    pub radius: f64,
    /// Its axes in the world's.
    pub axes: DMat3,
    /// World frame, m.
    pub centre: DVec3,
    /// How it hangs on another; nothing for the body.
    pub hold: Option<Hold>,
    /// In its own axes, about its centre.
    pub film: Option<Film>,
}

/// How a bone hangs on its parent: always by its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hold {
    /// The parent's place among the bones.
    pub parent: usize,
    /// Where on the parent's own axis, m from its centre.
    pub at: f64,
    /// The hinge's axis in the parent's axes; none for the ball joint of the wing-root.
    pub hinge: Option<DVec3>,
}

/// Which wing (F-13).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// Towards +X, `direction` 0.
    Left,
    /// Its mirror image, `direction` 1.
    Right,
}

impl Side {
    /// σ.
    fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

impl Bone {
    /// Where its axis begins, m, world frame.
    pub fn start(&self) -> DVec3 {
        self.centre - self.axes.z_axis * (0.5 * self.length)
    }

    /// Where its axis ends, m, world frame.
    pub fn end(&self) -> DVec3 {
        self.centre + self.axes.z_axis * (0.5 * self.length)
    }
}

/// The bones of a legal genotype at rest `height` m above the ground: body, wing-root, the left wing outwards,
/// the right wing outwards (F-22).
pub fn grow(genotype: &Genotype, height: f64) -> Vec<Bone> {
    let body = Bone {
        length: genotype.nodes[BODY].length,
        radius: genotype.nodes[BODY].radius,
        axes: DMat3::IDENTITY,
        centre: DVec3::new(0.0, height, 0.0),
        hold: None,
        film: None,
    };
    let length = genotype.wing_root_length();
    let wing_root = Bone {
        length,
        radius: genotype.nodes[WING_ROOT].radius,
        centre: body.start() + DVec3::Z * (0.5 * length),
        hold: Some(Hold { parent: BODY, at: -0.5 * body.length, hinge: None }),
        ..body
    };
    let mut bones = vec![body, wing_root];
    for side in [Side::Left, Side::Right] {
        let mut parent = WING_ROOT;
        let mut axes = wing_root.axes;
        if side == Side::Right {
            axes = DMat3::from_cols(-axes.x_axis, -axes.y_axis, axes.z_axis);
        }
        for node in &genotype.nodes[FIRST_SEGMENT..] {
            let bone = segment(node, &Bone { axes, ..bones[parent] }, parent, side);
            axes = bone.axes;
            parent = bones.len();
            bones.push(bone);
        }
    }
    bones
}

/// F-14: a wing segment on its parent, and the film between them (F-20).
fn segment(node: &Node, base: &Bone, parent: usize, side: Side) -> Bone {
    let (x, y, z) = (base.axes.x_axis, base.axes.y_axis, base.axes.z_axis);
    let (away, at, anchor, far) = match node.lpercent {
        0 => (z, -0.5, base.start(), base.end()),
        _ => (-z, 0.5, base.end(), base.start()),
    };
    let out = x * cos(node.theta) + y * (side.sign() * sin(node.theta));
    let (sine, cosine) = (sin(node.psi), cos(node.psi));
    let along = away * cosine + out * sine;
    let across = out * cosine - away * sine;
    let axes = DMat3::from_cols(across, along.cross(across), along);
    let half = 0.5 * node.length;
    let centre = anchor + along * half;
    let corners =
        [DVec3::new(0.0, 0.0, -half), DVec3::new(0.0, 0.0, half), axes.transpose() * (far - centre)];
    Bone {
        length: node.length,
        radius: node.radius,
        axes,
        centre,
        hold: Some(Hold { parent, at: at * base.length, hinge: Some(DVec3::Z * side.sign()) }),
        film: Film::between(corners),
    }
}

/// The films of bones in the start pose, world frame.
pub fn films(bones: &[Bone]) -> impl Iterator<Item = Film> + Clone + '_ {
    bones.iter().filter_map(|bone| Some(bone.film?.seen(bone.axes, bone.centre)))
}

/// Whether any two films of a start pose cross (F-23). Such a creature is not simulated.
pub fn intersects_itself(bones: &[Bone]) -> bool {
    let films: Vec<Film> = films(bones).collect();
    films.iter().enumerate().any(|(k, film)| films[..k].iter().any(|other| film.crosses(other)))
}

/// The wings' span: twice the largest distance of a film's corner from the plane of symmetry in the start
/// pose, m; 0 without films (F-70).
pub fn span(bones: &[Bone]) -> f64 {
    films(bones).flat_map(|film| film.corners).fold(0.0, |span, corner| {
        let reach = 2.0 * corner.x.abs();
        if reach > span { reach } else { span }
    })
}

/// `k (m_p + m_c) L_p L_c`: the torque that a joint's motor has at most, N·m (F-32). Masses in kg, lengths in
/// m, `k` in 1/s².
pub fn motor_torque(k: f64, masses: (f64, f64), lengths: (f64, f64)) -> f64 {
    k * (masses.0 + masses.1) * lengths.0 * lengths.1
}

#[cfg(test)]
pub(super) mod tests;
