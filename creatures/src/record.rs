//! Poses over time, for replay and export: what is in a trial, and where it is at each moment. It moves,
//! reads and writes nothing; `docs/recordings.md` documents the form in which it is written.

mod keep;
mod mind;
mod pose;
mod written;

pub use keep::{Keeper, Recording, Shot};
pub use mind::{Event, Happening, Mind};
pub use written::{FORMAT, Header, Subject};

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// What is in a trial, before its first step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Of every length: `m`; empty where the model has none.
    pub length_unit: String,
    /// Of every time: `s`; empty where the model has none.
    pub time_unit: String,
    /// Length of a physics step.
    pub step: f64,
    /// Against gravity, unit length.
    pub up: DVec3,
    /// Where the creatures face at the start, unit length, across `up`.
    pub forward: DVec3,
    /// Whose centres of mass the frames tell.
    pub creatures: Vec<String>,
    /// What moves; a frame has a pose of each.
    pub parts: Vec<Part>,
    /// What stands still.
    pub props: Vec<Prop>,
    /// Names of the muscles that each creature has, if frames tell what they do.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muscles: Vec<String>,
    /// Where these run, of one creature whose muscles pull between two parts; in the order of their names.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cords: Vec<Cord>,
}

/// Something that moves as one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Its name among the parts.
    pub name: String,
    /// Its place among the scene's creatures, of which it is part; none for what belongs to nobody.
    pub creature: Option<u32>,
    /// What it looks like, in its own axes.
    pub shapes: Vec<Shape>,
}

/// Something that stands still.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Prop {
    /// What it is.
    pub name: String,
    /// What it looks like, in its own axes.
    pub shape: Shape,
    /// Where it stands.
    pub pose: Pose,
}

/// A line along which a muscle pulls.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Cord {
    /// Places among the scene's parts.
    pub parts: [u32; 2],
    /// Where it is attached to each, in the part's own axes.
    pub ends: [DVec3; 2],
}

/// What is seen of something, in its own axes about its own origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case")]
pub enum Shape {
    /// A box.
    Box {
        /// From its middle to its faces.
        half: DVec3,
    },
    /// A ball.
    Sphere {
        /// Its radius.
        radius: f64,
    },
    /// A cylinder along z with round caps.
    Capsule {
        /// Of cylinder and caps.
        radius: f64,
        /// From the middle to the centre of a cap.
        half_length: f64,
    },
    /// A cylinder along z; discs are flat ones.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// From the middle to an end.
        half_length: f64,
    },
    /// A thin flat polygon.
    Plate {
        /// Its corners, going round.
        corners: Vec<DVec3>,
    },
    /// A closed skin between nodes that move by themselves: its pose is [`Pose::Nodes`].
    Skin {
        /// Nodes at the corners of each triangle, counter-clockwise from outside.
        triangles: Vec<[u32; 3]>,
    },
    /// The inside of a box, as a tank's.
    Room {
        /// From its middle to its walls.
        half: DVec3,
    },
    /// A speck that takes no room.
    Point,
    /// A light.
    Light {
        /// In the system's measure.
        strength: f64,
    },
    /// All below its origin, as the scene's `up` has it.
    Ground,
}

/// Where something is, world frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Pose {
    /// Not there now.
    Absent,
    /// At a place, with its own axes turned into the world's.
    Rigid {
        /// Of its origin.
        position: DVec3,
        /// Unit length.
        orientation: DQuat,
    },
    /// Where each of its nodes is.
    Nodes(Vec<DVec3>),
}

/// One moment.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Of the scene's creatures, in their order.
    pub centers: Vec<DVec3>,
    /// Of the scene's parts, in their order.
    pub poses: Vec<Pose>,
    /// Of the scene's creatures, how far each of the scene's muscles is contracted, in [0, 1].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub muscles: Vec<Vec<f64>>,
    /// Of the scene's creatures, if they have minds; none of one that is dead.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub minds: Vec<Option<Mind>>,
}

impl Pose {
    /// At a place, not turned.
    pub fn at(position: DVec3) -> Pose {
        Pose::Rigid { position, orientation: DQuat::IDENTITY }
    }
}
