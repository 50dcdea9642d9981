//! The engine against closed forms, conservation laws, a dense reference and the specifications' figures.

use super::super::articulated;

mod bits;
mod bodies;
mod certificate;
mod conservation;
mod gaits;
mod ground;
mod models;
mod motors;
mod pendulums;
mod walking;
