//! Why a worker may not attach: the one table from reason to status and, at the worker's end, from status
//! to what it should do. It decides nothing about who is refused.

use tonic::{Code, Status};

/// Why the coordinator refuses a worker.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// The two speak different protocols.
    #[error(
        "worker speaks protocol {worker}, coordinator {coordinator}: upgrade the {}",
        older(worker, coordinator)
    )]
    Protocol {
        /// The worker's.
        worker: u32,
        /// The coordinator's.
        coordinator: u32,
    },
    /// The two are of different releases.
    #[error("worker has version {worker}, coordinator {coordinator}: install the same release on both")]
    Version {
        /// The worker's.
        worker: String,
        /// The coordinator's.
        coordinator: String,
    },
    /// The worker's physics gives other bits.
    #[error(
        "worker has physics fingerprint {worker}, coordinator {coordinator}: \
         install the same release on both; if it is the same, this machine computes other bits and cannot take part"
    )]
    Fingerprint {
        /// The worker's, in hexadecimal.
        worker: String,
        /// The coordinator's, in hexadecimal.
        coordinator: String,
    },
    /// A worker of that name is still attached.
    #[error(
        "worker `{name}` is still attached: give this one another name, or try again when that one has gone"
    )]
    NameTaken {
        /// The name.
        name: String,
    },
    /// The hello is no hello, or one of its fields is out of range.
    #[error("hello: {0}")]
    Hello(String),
}

impl Refusal {
    /// Its kind in one word, for those who count.
    pub fn word(&self) -> &'static str {
        match self {
            Refusal::Protocol { .. } => "protocol",
            Refusal::Version { .. } => "version",
            Refusal::Fingerprint { .. } => "fingerprint",
            Refusal::NameTaken { .. } => "name_taken",
            Refusal::Hello(_) => "hello",
        }
    }
}

fn older(worker: &u32, coordinator: &u32) -> &'static str {
    if worker < coordinator { "worker" } else { "coordinator" }
}

/// FAILED_PRECONDITION: do not come back unchanged. ALREADY_EXISTS: come back later. INVALID_ARGUMENT: the
/// worker is broken.
impl From<Refusal> for Status {
    fn from(refusal: Refusal) -> Self {
        let code = match refusal {
            Refusal::Protocol { .. } | Refusal::Version { .. } | Refusal::Fingerprint { .. } => {
                Code::FailedPrecondition
            }
            Refusal::NameTaken { .. } => Code::AlreadyExists,
            Refusal::Hello(_) => Code::InvalidArgument,
        };
        Status::new(code, refusal.to_string())
    }
}

/// Whether a worker that got this status may hope for another answer to the same hello.
pub fn is_lasting(status: &Status) -> bool {
    matches!(
        status.code(),
        Code::FailedPrecondition
            | Code::InvalidArgument
            | Code::Unauthenticated
            | Code::PermissionDenied
            | Code::Unimplemented
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_shows_both_sides_and_which_to_upgrade() {
        let status = Status::from(Refusal::Protocol { worker: 1, coordinator: 2 });
        assert_eq!(status.code(), Code::FailedPrecondition);
        assert_eq!(status.message(), "worker speaks protocol 1, coordinator 2: upgrade the worker");
        assert!(is_lasting(&status));
    }

    #[test]
    fn a_taken_name_may_be_free_later() {
        assert!(!is_lasting(&Refusal::NameTaken { name: "a".to_owned() }.into()));
        assert!(!is_lasting(&Status::unavailable("going away")));
    }
}
