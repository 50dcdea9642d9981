//! Ratios, not times: each bench measures ours and its peer in one run on one machine. Peers in other languages
//! are in `benches/peers/`.

pub mod commands;
pub mod load;
pub mod pedigree;
pub mod processes;
pub mod rapier;
pub mod report;
