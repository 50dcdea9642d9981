//! What `compare` makes of experiments (walkers G-63 to G-72): cells, statistics, curves, a report and a
//! picture. Pure but for the picture's files: rows come in, values go out.

mod axes;
pub(crate) mod cells;
pub(crate) mod curves;
pub(crate) mod overlay;
pub(crate) mod plot;
pub(crate) mod report;
pub(crate) mod statistics;
pub(crate) mod text;
