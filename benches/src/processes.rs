//! What a process has used of the machine, as the kernel counts it.

/// Processor time of a running process, user and system, s.
///
/// # Panics
/// When there is no such process, or no `/proc`.
pub fn processor_seconds(id: u32) -> f64 {
    /// Ticks a second: the same on every Linux of the last twenty years.
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).expect("the process runs, on Linux");
    // The name, in parentheses, may hold anything; user and system time are fields 14 and 15.
    let fields = stat.rsplit_once(')').expect("a name in parentheses").1.split_whitespace();
    let ticks: f64 =
        fields.skip(11).take(2).map(|field| field.parse::<f64>().expect("a number of ticks")).sum();
    ticks / TICKS
}

/// Resident memory of a running process, bytes.
///
/// # Panics
/// When there is no such process, or no `/proc`.
pub fn resident_bytes(id: u32) -> u64 {
    memory_bytes(id, "VmRSS:")
}

/// The most that it ever was, bytes.
///
/// # Panics
/// When there is no such process, or no `/proc`.
pub fn resident_bytes_most(id: u32) -> u64 {
    memory_bytes(id, "VmHWM:")
}

fn memory_bytes(id: u32, field: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).expect("the process runs, on Linux");
    let line = status.lines().find(|line| line.starts_with(field)).expect("a process has resident memory");
    let kibibytes = line.split_whitespace().nth(1).expect("a number follows").parse::<u64>();
    kibibytes.expect("a number of KiB") * 1024
}
