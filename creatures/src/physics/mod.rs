//! The physics engines, each where it belongs.

pub mod articulated;
pub mod contact;
