//! What a hello may say. A worker holds its settings to it before it dials, a coordinator what it is told.

/// The most slots of a worker: evaluations that run at once.
pub const SLOTS_MAX: u32 = 4096;
/// The most evaluations that a worker may take at once, running ones included.
pub const WINDOW_MAX: u32 = 65_536;
/// The most attempts that a worker may hold, or give back at once.
pub const HOLDING_MAX: usize = (WINDOW_MAX + SLOTS_MAX) as usize;
/// The longest name of a worker or a host, bytes.
pub const NAME_SIZE_MAX: usize = 128;
/// The longest version, bytes.
pub const VERSION_SIZE_MAX: usize = 64;
/// The most labels of a worker.
pub const LABELS_MAX: usize = 16;
/// The longest key or value of a label, bytes.
pub const LABEL_SIZE_MAX: usize = 64;

/// Whether a label's key and value have a legal size and nothing that a terminal would obey.
pub fn is_label(key: &str, value: &str) -> bool {
    [key, value]
        .iter()
        .all(|text| (1..=LABEL_SIZE_MAX).contains(&text.len()) && !text.chars().any(char::is_control))
}
