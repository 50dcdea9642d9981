//! A pose as it is written: `null`, seven numbers (position, then the quaternion's x, y, z, w), or a list of
//! places.

use super::Pose;
use glam::{DQuat, DVec3};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The three forms, told apart by their shape.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Written {
    Absent(()),
    Rigid([f64; 7]),
    Nodes(Vec<DVec3>),
}

impl Serialize for Pose {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Pose::Absent => serializer.serialize_unit(),
            Pose::Rigid { position: p, orientation: q } => {
                [p.x, p.y, p.z, q.x, q.y, q.z, q.w].serialize(serializer)
            }
            Pose::Nodes(nodes) => nodes.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Pose {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Pose, D::Error> {
        Ok(match Written::deserialize(deserializer)? {
            Written::Absent(()) => Pose::Absent,
            Written::Rigid([x, y, z, i, j, k, w]) => {
                Pose::Rigid { position: DVec3::new(x, y, z), orientation: DQuat::from_xyzw(i, j, k, w) }
            }
            Written::Nodes(nodes) => Pose::Nodes(nodes),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_is_null_or_seven_numbers_or_places_and_reads_back() {
        let rigid = Pose::Rigid {
            position: DVec3::new(1.0, -0.1, 3.0),
            orientation: DQuat::from_xyzw(0.0, 0.6, 0.0, 0.8),
        };
        let nodes = Pose::Nodes(vec![DVec3::X, DVec3::new(0.1, 0.2, 1e-300)]);
        for (pose, text) in [
            (Pose::Absent, "null"),
            (rigid, "[1.0,-0.1,3.0,0.0,0.6,0.0,0.8]"),
            (nodes, "[[1.0,0.0,0.0],[0.1,0.2,1e-300]]"),
        ] {
            assert_eq!(serde_json::to_string(&pose).unwrap(), text);
            assert_eq!(serde_json::from_str::<Pose>(text).unwrap(), pose);
        }
        assert!(serde_json::from_str::<Pose>("[1.0,2.0]").is_err());
    }
}
