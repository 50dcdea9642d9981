//! The engine against closed forms, conservation laws, a dense reference and the specifications' figures.

use super::super::articulated;

mod bodies;
mod gaits;
mod walking;
