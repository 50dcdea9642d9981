//! Who watches an evaluation, and what is shown. Watching changes no bit of an outcome, and nothing is made
//! to be shown before somebody asks for it.

use crate::Interim;
use crate::record::{Event, Frame, Scene};

/// Somebody who watches one evaluation. Every method looks away unless it is written otherwise.
///
/// A closure over an [`Interim`] is an observer that hears the interim report alone; [`Nobody`] watches
/// nothing.
pub trait Observer {
    /// Hears the interim report, once at most.
    fn interim(&mut self, interim: Interim) {
        let _ = interim;
    }

    /// A trial of a number, from 0, is about to begin. Calling `scene` gives what is in it.
    fn trial(&mut self, number: u32, scene: &dyn Fn() -> Scene) {
        let _ = (number, scene);
    }

    /// Something happened to a creature in the step whose frame comes next. Calling `event` gives what.
    fn event(&mut self, event: &dyn Fn() -> Event) {
        let _ = event;
    }

    /// The trial stands at a time since its start, in the scene's unit: at 0, and after every physics step.
    /// Calling `frame` gives where everything is.
    fn frame(&mut self, time: f64, frame: &dyn Fn() -> Frame) {
        let _ = (time, frame);
    }
}

/// The observer of what nobody watches.
#[derive(Debug, Clone, Copy)]
pub struct Nobody;

impl Observer for Nobody {}

impl<F: FnMut(Interim)> Observer for F {
    fn interim(&mut self, interim: Interim) {
        self(interim);
    }
}
