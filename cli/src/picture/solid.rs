//! Shapes as a view sees them: flat faces with their nearness and light, and outlines of what has none. It
//! knows no colour and no scale.

use creatures::record::{Pose, Shape};
use glam::{DQuat, DVec2, DVec3};

use super::view::View;

/// One face of a shape, in the plane of a view.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Face {
    /// Going round.
    pub(super) corners: Vec<DVec2>,
    /// Of its middle; larger is nearer.
    pub(super) nearness: f64,
    /// How much light falls on it, 0 to 1.
    pub(super) light: f64,
    /// How it is drawn.
    pub(super) look: Look,
}

/// How a face is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Look {
    /// With its edges.
    Flat,
    /// Without, as one of many of a round surface.
    Round,
    /// What is behind shows through.
    Film,
}

/// Corners of a circle.
const ROUND: usize = 24;
/// What light falls on faces that are turned away from it.
const SHADE: f64 = 0.45;
/// Where the light is, in the axes of a view: above, a little to the left, before the picture.
const LIGHT: DVec3 = DVec3::new(-0.35, 0.6, 0.72);

/// The faces of a shape that can be seen. Specks, lights, the ground and rooms have none.
pub(super) fn faces(shape: &Shape, pose: &Pose, view: &View) -> Vec<Face> {
    match (shape, pose) {
        (Shape::Skin { triangles }, Pose::Nodes(nodes)) => skin(triangles, nodes, view),
        (shape, Pose::Rigid { position, orientation }) => {
            Rigid { place: *position, turn: *orientation, view }.faces(shape)
        }
        _ => vec![],
    }
}

/// The points of a shape that matter to how much room it takes, world frame.
pub(super) fn extremes(shape: &Shape, pose: &Pose) -> Vec<DVec3> {
    match (shape, pose) {
        (Shape::Skin { .. }, Pose::Nodes(nodes)) => nodes.clone(),
        (shape, Pose::Rigid { position, orientation }) => {
            local_extremes(shape).into_iter().map(|point| *position + *orientation * point).collect()
        }
        _ => vec![],
    }
}

fn local_extremes(shape: &Shape) -> Vec<DVec3> {
    match shape {
        Shape::Box { half } | Shape::Room { half } => corners(*half).to_vec(),
        Shape::Sphere { radius } => corners(DVec3::splat(*radius)).to_vec(),
        Shape::Capsule { radius, half_length } => {
            corners(DVec3::new(*radius, *radius, half_length + radius)).to_vec()
        }
        Shape::Cylinder { radius, half_length } => {
            corners(DVec3::new(*radius, *radius, *half_length)).to_vec()
        }
        Shape::Plate { corners } => corners.clone(),
        Shape::Point | Shape::Light { .. } => vec![DVec3::ZERO],
        Shape::Skin { .. } | Shape::Ground => vec![],
    }
}

/// The eight corners of a box.
pub(super) fn corners(half: DVec3) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let sign = |bit: usize| if corner >> bit & 1 == 0 { -1.0 } else { 1.0 };
        half * DVec3::new(sign(0), sign(1), sign(2))
    })
}

/// A rigid shape in a view.
struct Rigid<'a> {
    place: DVec3,
    turn: DQuat,
    view: &'a View,
}

impl Rigid<'_> {
    fn faces(&self, shape: &Shape) -> Vec<Face> {
        match shape {
            Shape::Box { half } => self.cuboid(*half),
            Shape::Sphere { radius } => vec![self.hull(&[(DVec3::ZERO, *radius)])],
            Shape::Capsule { radius, half_length } => {
                let end = DVec3::Z * *half_length;
                vec![self.hull(&[(end, *radius), (-end, *radius)])]
            }
            Shape::Cylinder { radius, half_length } => self.cylinder(*radius, *half_length),
            Shape::Plate { corners } => self.plate(corners).into_iter().collect(),
            Shape::Skin { .. } | Shape::Room { .. } | Shape::Point | Shape::Light { .. } | Shape::Ground => {
                vec![]
            }
        }
    }

    fn world(&self, local: DVec3) -> DVec3 {
        self.place + self.turn * local
    }

    fn cuboid(&self, half: DVec3) -> Vec<Face> {
        let axes =
            [(DVec3::X, DVec3::Y, DVec3::Z), (DVec3::Y, DVec3::Z, DVec3::X), (DVec3::Z, DVec3::X, DVec3::Y)];
        let sides = axes.into_iter().flat_map(|(out, a, b)| [(out, a, b), (-out, b, a)]);
        sides
            .filter_map(|(out, a, b)| {
                let ring = [a + b, b - a, -a - b, a - b].map(|at| self.world((out + at) * half));
                face(&ring, self.turn * out, self.view, Look::Flat)
            })
            .collect()
    }

    fn cylinder(&self, radius: f64, half_length: f64) -> Vec<Face> {
        let ring = |height: f64| -> Vec<DVec3> {
            let place = |k: usize| (std::f64::consts::TAU * k as f64 / ROUND as f64).sin_cos();
            (0..ROUND)
                .map(place)
                .map(|(y, x)| self.world(DVec3::new(radius * x, radius * y, height)))
                .collect()
        };
        let (top, mut bottom) = (ring(half_length), ring(-half_length));
        let wall = (0..ROUND).filter_map(|k| {
            let next = (k + 1) % ROUND;
            let quad = [bottom[k], bottom[next], top[next], top[k]];
            let out = (top[k] + top[next] + bottom[k] + bottom[next]) * 0.25 - self.place;
            face(&quad, out.normalize_or_zero(), self.view, Look::Round)
        });
        let mut faces: Vec<Face> = wall.collect();
        let axis = self.turn * DVec3::Z;
        faces.extend(face(&top, axis, self.view, Look::Flat));
        bottom.reverse();
        faces.extend(face(&bottom, -axis, self.view, Look::Flat));
        faces
    }

    /// A thin plate is seen from both sides.
    fn plate(&self, corners: &[DVec3]) -> Option<Face> {
        let ring: Vec<DVec3> = corners.iter().map(|&corner| self.world(corner)).collect();
        let [a, b, c, ..] = ring[..] else { return None };
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let normal = if self.view.nearness(normal) < 0.0 { -normal } else { normal };
        Some(Face {
            corners: ring.iter().map(|&corner| self.view.flat(corner)).collect(),
            nearness: nearness(&ring, self.view),
            light: light(normal, self.view),
            look: Look::Film,
        })
    }

    /// What two balls, or one, and all between them cover.
    fn hull(&self, balls: &[(DVec3, f64)]) -> Face {
        let mut rim = Vec::with_capacity(balls.len() * ROUND);
        let mut sum = 0.0;
        for &(centre, radius) in balls {
            let centre = self.world(centre);
            sum += self.view.nearness(centre);
            let flat = self.view.flat(centre);
            rim.extend(
                (0..ROUND).map(|k| {
                    flat + radius * DVec2::from_angle(std::f64::consts::TAU * k as f64 / ROUND as f64)
                }),
            );
        }
        Face { corners: convex(rim), nearness: sum / balls.len() as f64, light: 0.9, look: Look::Flat }
    }
}

/// A skin is solid: of its triangles those are seen that face who looks.
fn skin(triangles: &[[u32; 3]], nodes: &[DVec3], view: &View) -> Vec<Face> {
    let corner = |node: u32| nodes.get(node as usize).copied().unwrap_or_default();
    let seen = |corners: &[u32; 3]| {
        let ring = corners.map(corner);
        face(&ring, (ring[1] - ring[0]).cross(ring[2] - ring[0]).normalize_or_zero(), view, Look::Round)
    };
    triangles.iter().filter_map(seen).collect()
}

/// A face with an outward normal; none if it is turned away.
fn face(ring: &[DVec3], normal: DVec3, view: &View, look: Look) -> Option<Face> {
    (view.nearness(normal) > 1e-9).then(|| Face {
        corners: ring.iter().map(|&corner| view.flat(corner)).collect(),
        nearness: nearness(ring, view),
        light: light(normal, view),
        look,
    })
}

fn nearness(ring: &[DVec3], view: &View) -> f64 {
    ring.iter().map(|&corner| view.nearness(corner)).sum::<f64>() / ring.len().max(1) as f64
}

fn light(normal: DVec3, view: &View) -> f64 {
    let flat = view.flat(normal);
    let falls = LIGHT.normalize().dot(DVec3::new(flat.x, flat.y, view.nearness(normal))).max(0.0);
    SHADE + (1.0 - SHADE) * falls
}

/// The convex hull, going round (Andrew's monotone chain).
fn convex(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut hull: Vec<DVec2> = Vec::with_capacity(points.len() + 1);
    for there in [false, true] {
        let begin = hull.len();
        let way: Box<dyn Iterator<Item = &DVec2>> =
            if there { Box::new(points.iter().rev()) } else { Box::new(points.iter()) };
        for &point in way {
            while hull.len() >= begin + 2 {
                let (a, b) = (hull[hull.len() - 2], hull[hull.len() - 1]);
                if (b - a).perp_dot(point - b) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push(point);
        }
        hull.pop(); // the other chain begins with it
    }
    hull
}

#[cfg(test)]
mod tests;
