//! What a stranger's bytes meet first: one body for each decoder. A body takes any bytes; it panics if the
//! decoder does, or if what was decoded does not keep its promises. Nothing is fuzzed here: libFuzzer
//! (`libfuzzer/`) and the bounded run (`tests/bounded.rs`) bring the bytes.

mod experiment;
mod genotype;
mod syllabus;
mod token;
mod wire;

pub use experiment::{experiment, task};
pub use genotype::{genotype, life, tasks};
pub use syllabus::{expression, syllabus};
pub use token::token;
pub use wire::{coordinator_message, worker_message};

/// A body.
pub type Target = fn(&[u8]);

/// Every body, by the name of its corpus.
pub const TARGETS: [(&str, Target); 9] = [
    ("coordinator_message", coordinator_message),
    ("experiment", experiment),
    ("expression", expression),
    ("genotype", genotype),
    ("life", life),
    ("syllabus", syllabus),
    ("task", task),
    ("token", token),
    ("worker_message", worker_message),
];

/// Bytes as text, when they are.
fn text(bytes: &[u8]) -> Option<&str> {
    std::str::from_utf8(bytes).ok()
}
