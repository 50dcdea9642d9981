//! The observer that keeps what it sees: one trial, every frame or every so many.

use super::{Event, Frame, Scene};
use crate::Observer;
use serde::{Deserialize, Serialize};

/// One trial as it was seen.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// What was in it.
    pub scene: Scene,
    /// In order of time; the first is that of the start.
    pub shots: Vec<Shot>,
}

/// A frame and its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Shot {
    /// Since the trial's start.
    pub time: f64,
    /// Where everything was.
    #[serde(flatten)]
    pub frame: Frame,
    /// What happened since the shot before; after the last one too, up to the end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<Event>,
}

/// Records one trial of an evaluation.
#[derive(Debug, Clone)]
pub struct Keeper {
    trial: u32,
    every: u32,
    /// Trials that have begun.
    trials: u32,
    /// Frames of the trial seen so far.
    seen: u32,
    /// Not yet told with a frame.
    events: Vec<Event>,
    recording: Option<Recording>,
}

impl Keeper {
    /// Of the trial of a number, from 0, one frame in `every`, which is at least 1.
    pub fn new(trial: u32, every: u32) -> Keeper {
        Keeper { trial, every: every.max(1), trials: 0, seen: 0, events: Vec::new(), recording: None }
    }

    /// How many trials have begun.
    pub fn trials(&self) -> u32 {
        self.trials
    }

    /// What was recorded; none if there was no such trial.
    pub fn recording(mut self) -> Option<Recording> {
        if let Some(last) = self.recording.as_mut().and_then(|recording| recording.shots.last_mut()) {
            last.events.append(&mut self.events);
        }
        self.recording
    }
}

impl Observer for Keeper {
    fn trial(&mut self, number: u32, scene: &dyn Fn() -> Scene) {
        self.trials = number + 1;
        if number == self.trial {
            self.recording = Some(Recording { scene: scene(), shots: Vec::new() });
        }
    }

    fn event(&mut self, event: &dyn Fn() -> Event) {
        if self.trials == self.trial + 1 {
            self.events.push(event());
        }
    }

    fn frame(&mut self, time: f64, frame: &dyn Fn() -> Frame) {
        if self.trials != self.trial + 1 {
            return; // another trial is under way
        }
        if let Some(recording) = self.recording.as_mut().filter(|_| self.seen.is_multiple_of(self.every)) {
            let events = std::mem::take(&mut self.events);
            recording.shots.push(Shot { time, frame: frame(), events });
        }
        self.seen += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Happening, Pose};
    use glam::DVec3;

    fn scene() -> Scene {
        Scene {
            length_unit: "m".to_owned(),
            time_unit: "s".to_owned(),
            step: 0.5,
            up: DVec3::Z,
            forward: DVec3::Y,
            creatures: vec!["ball".to_owned()],
            parts: vec![],
            props: vec![],
            muscles: vec![],
            cords: vec![],
        }
    }

    #[test]
    fn one_trial_is_kept_and_of_it_the_start_and_every_so_many_steps() {
        let mut keeper = Keeper::new(1, 3);
        for trial in 0..3 {
            keeper.trial(trial, &scene);
            for step in 0..8 {
                let place = DVec3::new(f64::from(trial), f64::from(step), 0.0);
                keeper.frame(0.5 * f64::from(step), &|| Frame { centers: vec![place], ..Frame::default() });
            }
        }
        assert_eq!(keeper.trials(), 3);
        let shots = keeper.recording().unwrap().shots;
        let seen: Vec<_> = shots.iter().map(|shot| (shot.time, shot.frame.centers[0])).collect();
        let expected = [0.0, 3.0, 6.0].map(|step| (0.5 * step, DVec3::new(1.0, step, 0.0)));
        assert_eq!(seen, expected);
    }

    #[test]
    fn events_are_told_with_the_next_frame_and_the_last_ones_with_the_last() {
        let mut keeper = Keeper::new(1, 2);
        keeper.event(&|| panic!("before any trial"));
        for trial in 0..2 {
            keeper.trial(trial, &scene);
            for step in 0..4 {
                let time = f64::from(step);
                let event = || Event { time, creature: 0, happening: Happening::Death { by: trial } };
                keeper.event(&event);
                keeper.frame(time, &Frame::default);
            }
        }
        let shots = keeper.recording().unwrap().shots;
        let told: Vec<Vec<f64>> =
            shots.iter().map(|shot| shot.events.iter().map(|event| event.time).collect()).collect();
        assert_eq!(told, [vec![0.0], vec![1.0, 2.0, 3.0]]);
        assert!(
            shots.iter().flat_map(|shot| &shot.events).all(|e| e.happening == Happening::Death { by: 1 })
        );
    }

    #[test]
    fn nothing_is_made_of_what_nobody_keeps() {
        let mut keeper = Keeper::new(1, 2);
        keeper.trial(0, &|| panic!("another trial's scene"));
        keeper.frame(0.0, &|| panic!("another trial's frame"));
        keeper.trial(1, &scene);
        keeper.frame(0.0, &|| Frame { poses: vec![Pose::Absent], ..Frame::default() });
        keeper.frame(0.5, &|| panic!("a frame between those that are kept"));
        assert_eq!(keeper.recording().unwrap().shots.len(), 1);
        let mut keeper = Keeper::new(5, 1);
        keeper.trial(0, &scene);
        assert_eq!(keeper.recording(), None);
    }
}
