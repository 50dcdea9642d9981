//! Published results, stored as data with the experiment that reproduces them (G-69). Nothing is computed
//! from them here.

use serde::{Deserialize, Serialize};

/// One row of a published table: a method on a body, and what the paper says of the comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Published {
    /// As in `task.body`.
    pub body: String,
    /// As in `search.kind`.
    pub method: String,
    /// Mean of the runs' best fitness.
    pub mean: f64,
    /// Generations to the plateau, where printed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generations: Option<u32>,
    /// The method of the larger mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub better: Option<String>,
    /// Relative to the larger mean (G-66), as printed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference_percent: Option<f64>,
    /// The p-value as printed: `<0.005`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p: Option<String>,
    /// The method that is significantly better, or `none`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub verdict: Option<String>,
}
