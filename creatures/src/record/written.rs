//! A recording as lines of JSON (`docs/recordings.md`): a header, which says all that is needed to read the
//! rest, then a line a frame. It writes no file.

use super::{Recording, Scene, Shot};
use serde::{Deserialize, Serialize};

/// Of the form of these lines; raised when what they say changes.
pub const FORMAT: u32 = 1;

/// The first line.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// [`FORMAT`].
    pub recording: u32,
    /// Who was recorded, at what.
    #[serde(flatten)]
    pub subject: Subject,
    /// How many lines follow.
    pub frames: usize,
    /// What is in the trial.
    #[serde(flatten)]
    pub scene: Scene,
}

/// Who was recorded, at what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Subject {
    /// Name of the system.
    pub system: String,
    /// Its version: another one may move otherwise.
    pub version: u32,
    /// Number in the lineage.
    pub individual: u64,
    /// The resolved task.
    pub task: serde_json::Value,
    /// Of the evaluation.
    pub seed: u64,
    /// Which trial of the evaluation, from 1.
    pub trial: u32,
    /// The skill and the script, if it lived under a light of a script instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub light: Option<serde_json::Value>,
}

impl Recording {
    /// The lines, without their ends. Every float reads back to the same bits.
    pub fn lines(&self, subject: &Subject) -> impl Iterator<Item = String> {
        let header = Header {
            recording: FORMAT,
            subject: subject.clone(),
            frames: self.shots.len(),
            scene: self.scene.clone(),
        };
        let frames = self.shots.iter().map(|shot: &Shot| written(shot));
        std::iter::once(written(&header)).chain(frames)
    }
}

fn written(line: &impl Serialize) -> String {
    serde_json::to_string(line).expect("plain structs with names for keys serialise")
}
