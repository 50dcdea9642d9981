//! Recordings beside each other, as in a race: each in a lane of its own, all by one clock. It draws nothing.

use anyhow::anyhow;
use creatures::record::{Frame, Part, Pose, Prop, Recording, Scene, Shot};
use glam::DVec3;

use super::sheet::bodies;
use super::solid;

/// Between lanes, by the width of the widest.
const GAP: f64 = 0.1;

/// One recording of all, which are named by the numbers of those that lived them: the first is on the left, and who
/// stopped before the others stays where it stopped. Muscles are kept if all have the same.
///
/// # Errors
/// Recordings of different systems, or one of nothing.
pub(crate) fn beside(recordings: &[(u64, Recording)]) -> anyhow::Result<Recording> {
    let [(first, like), others @ ..] = recordings else { return Err(anyhow!("there is nothing to draw")) };
    let world = |scene: &Scene| (scene.up, scene.forward, scene.step.to_bits(), scene.length_unit.clone());
    if let Some((other, _)) = others.iter().find(|(_, other)| world(&other.scene) != world(&like.scene)) {
        return Err(anyhow!(
            "individuals {first} and {other} live in worlds that do not lie beside each other"
        ));
    }
    let left = like.scene.up.cross(like.scene.forward);
    let spans: Vec<[f64; 2]> = recordings.iter().map(|(_, recording)| span(recording, left)).collect();
    let gap = GAP * spans.iter().map(|[low, high]| high - low).fold(0.0, f64::max);

    let mut scene =
        Scene { creatures: vec![], parts: vec![], props: vec![], cords: vec![], ..like.scene.clone() };
    if others.iter().any(|(_, other)| other.scene.muscles != scene.muscles) {
        scene.muscles.clear(); // a name would mean another muscle in each
    }
    let mut ways = Vec::new();
    let mut edge = spans[0][1];
    for ((id, recording), [low, high]) in recordings.iter().zip(spans) {
        let way = left * (edge - high);
        edge -= high - low + gap;
        add(&mut scene, &recording.scene, *id, way);
        ways.push(way);
    }
    let longest = recordings.iter().map(|(_, recording)| &recording.shots).max_by_key(|shots| shots.len());
    let shots = longest.into_iter().flatten().enumerate().map(|(index, of)| {
        let mut shot = Shot { time: of.time, frame: Frame::default(), events: vec![] };
        for ((_, recording), &way) in recordings.iter().zip(&ways) {
            join(&mut shot.frame, recording, index, way);
        }
        shot
    });
    let shots = shots.collect();
    Ok(Recording { scene, shots })
}

/// From the rightmost to the leftmost that creatures and what stands there ever reach.
fn span(recording: &Recording, left: DVec3) -> [f64; 2] {
    let standing = recording.scene.props.iter().flat_map(|prop| solid::extremes(&prop.shape, &prop.pose));
    let moving = recording.shots.iter().flat_map(|shot| bodies(recording, shot));
    let reached = standing.chain(moving).map(|point| left.dot(point));
    let [low, high] =
        reached.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
    if low <= high { [low, high] } else { [0.0; 2] }
}

fn add(to: &mut Scene, scene: &Scene, id: u64, way: DVec3) {
    let before = to.creatures.len() as u32;
    let named = scene.creatures.iter().map(|name| match name.rsplit_once('_') {
        Some((kind, number)) => format!("{kind} {id}_{number}"),
        None => format!("{name} {id}"),
    });
    to.creatures.extend(named);
    let part = |part: &Part| Part { creature: part.creature.map(|of| of + before), ..part.clone() };
    to.parts.extend(scene.parts.iter().map(part));
    to.props.extend(scene.props.iter().map(|prop| Prop { pose: moved(&prop.pose, way), ..prop.clone() }));
}

/// Adds a recording's frame; beyond its end its last one, in which no muscle is told of any more.
fn join(frame: &mut Frame, recording: &Recording, index: usize, way: DVec3) {
    let is_over = index >= recording.shots.len();
    let Some(own) = recording.shots.get(index).or(recording.shots.last()).map(|shot| &shot.frame) else {
        return;
    };
    frame.centers.extend(own.centers.iter().map(|&center| center + way));
    frame.poses.extend(own.poses.iter().map(|pose| moved(pose, way)));
    let muscles = own.muscles.iter().map(|muscles| if is_over { vec![] } else { muscles.clone() });
    frame.muscles.extend(muscles);
}

fn moved(pose: &Pose, way: DVec3) -> Pose {
    match pose {
        Pose::Absent => Pose::Absent,
        Pose::Rigid { position, orientation } => {
            Pose::Rigid { position: *position + way, orientation: *orientation }
        }
        Pose::Nodes(nodes) => Pose::Nodes(nodes.iter().map(|&node| node + way).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::recorded;
    use super::*;

    #[test]
    fn lanes_keep_apart_and_who_stopped_stays_where_it_stopped() {
        let whole = recorded("fish", 0);
        let mut short = whole.clone();
        short.shots.truncate(3);
        let both = beside(&[(7, whole.clone()), (8, short.clone())]).unwrap();
        assert_eq!(both.scene.creatures, ["fish 7", "fish 8"]);
        assert_eq!(both.shots.len(), whole.shots.len());
        let left = |pose: &Pose| match pose {
            Pose::Nodes(nodes) => nodes.iter().map(|node| -node.x).collect::<Vec<_>>(),
            other => panic!("a fish has nodes, not {other:?}"),
        };
        let lanes = [0, 1].map(|lane| -> Vec<f64> {
            both.shots.iter().flat_map(|shot| left(&shot.frame.poses[lane])).collect()
        });
        let least = lanes[0].iter().copied().fold(f64::INFINITY, f64::min);
        assert!(lanes[1].iter().all(|&at| at < least), "the second swims to the right of the first");
        let last = both.shots.last().unwrap();
        assert_eq!(last.frame.poses[0], whole.shots.last().unwrap().frame.poses[0]);
        assert_eq!(last.frame.poses[1], both.shots[2].frame.poses[1]);
        assert_eq!((last.frame.muscles[0].len(), last.frame.muscles[1].len()), (12, 0));
    }

    #[test]
    fn creatures_of_different_systems_are_not_drawn_beside_each_other() {
        let error = beside(&[(7, recorded("fish", 0)), (9, recorded("walker", 0))]).unwrap_err().to_string();
        assert!(error.contains("individuals 7 and 9"), "{error}");
        assert!(beside(&[]).is_err());
    }
}
