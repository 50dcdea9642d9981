//! How ESP creatures vary (E-38..E-42).

pub mod brain;
