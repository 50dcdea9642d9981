//! The physics engines, each where it belongs.
