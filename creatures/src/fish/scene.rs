//! What is seen of one fish in open water. It moves and measures nothing; a world's scene is in
//! `world/scene.rs`.

use super::lattice::Face;
use super::mechanics::TIME_STEP;
use super::{Body, Swimmer};
use crate::record::{Frame, Part, Pose, Scene, Shape};
use glam::DVec3;

/// Water with nothing in it. Lengths and times have no unit: a fish of size 1 is 20 long.
pub(super) fn water() -> Scene {
    Scene {
        length_unit: String::new(),
        time_unit: String::new(),
        step: TIME_STEP,
        up: DVec3::Z,
        forward: DVec3::Y,
        creatures: vec![],
        parts: vec![],
        props: vec![],
        muscles: muscles(),
        cords: vec![],
    }
}

/// u₁…u₁₂: three segments, the corners of each from the top left to the right and round.
fn muscles() -> Vec<String> {
    let corners = |segment| ["left", "right", "right", "left"].map(|side| (side, segment));
    let heights = ["top", "top", "bottom", "bottom"].into_iter().cycle();
    let all = ["front", "middle", "rear"].into_iter().flat_map(corners).zip(heights);
    all.map(|((side, segment), height)| format!("{side}_{segment}_{height}")).collect()
}

/// One fish, and nothing else.
pub(super) fn alone(fish: &Swimmer) -> Scene {
    let mut scene = water();
    add_fish(&mut scene, "fish".to_owned(), &fish.body);
    scene
}

/// Where the one fish is now.
pub(super) fn frame(fish: &Swimmer) -> Frame {
    Frame {
        centers: vec![fish.center_of_mass()],
        poses: vec![nodes(fish)],
        muscles: vec![fish.actuation().to_vec()],
        ..Frame::default()
    }
}

/// A fish's nodes.
pub(super) fn nodes(fish: &Swimmer) -> Pose {
    Pose::Nodes(fish.motion.positions.clone())
}

/// Puts a fish into a scene, as a creature and as its part.
pub(super) fn add_fish(scene: &mut Scene, name: String, body: &Body) {
    let creature = scene.creatures.len() as u32;
    let shapes = vec![Shape::Skin { triangles: triangles(&body.lattice.faces) }];
    scene.parts.push(Part { name: name.clone(), creature: Some(creature), shapes });
    scene.creatures.push(name);
}

/// The skin, each spot once: where a quadrilateral has both its diagonals at half weight, the first
/// two of its four triangles cover it.
fn triangles(faces: &[Face]) -> Vec<[u32; 3]> {
    let corners = |face: &Face| face.corners.map(|node| node as u32);
    let (single, double): (Vec<&Face>, Vec<&Face>) = faces.iter().partition(|face| face.weight == 1.0);
    let halves = double.chunks(4).flat_map(|four| four.iter().take(2));
    single.iter().chain(halves).map(|face| corners(face)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn the_skin_is_closed_and_covers_each_spot_once() {
        let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        for [a, b, c] in triangles(&Body::published(1.0).lattice.faces) {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&both| both == 0), "every edge is run through both ways: {edges:?}");
    }
}
