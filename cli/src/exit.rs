//! How commands end: every failure of a command, and the one table from failures and gRPC codes to exit
//! codes. It prints nothing.

use std::path::PathBuf;
use std::process::ExitCode;

use coordinator::lineage::OpenError;
use prost::Message;
use proto::v1;
use tonic::Code;

/// Exit codes (design: the command line; tests and scripts rely on them).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Exit {
    /// Done.
    Done = 0,
    /// It was understood and did not work, or a comparison came out unequal.
    Failed = 1,
    /// Usage, or bad input.
    Usage = 2,
    /// The experiment, individual or file named is not there.
    NotFound = 3,
    /// No coordinator answers.
    Unreachable = 4,
    /// Somebody has to pick before the experiment goes on.
    Awaiting = 5,
    /// Ctrl-C, or nobody reads any more what a run prints.
    Interrupted = 130,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        ExitCode::from(exit as u8)
    }
}

/// Why a command did not do what it was asked, by what its caller can do about it.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// Ask differently.
    #[error("{0}")]
    Usage(String),
    /// Mend the experiment file.
    #[error("{}: {} problem{}", file.display(), problems.len(), if problems.len() == 1 { "" } else { "s" })]
    Problems {
        /// The file.
        file: PathBuf,
        /// What it holds.
        text: String,
        /// At least one.
        problems: Vec<v1::Problem>,
    },
    /// Name something that exists.
    #[error("{0}")]
    NotFound(String),
    /// Start a coordinator, or name the right one.
    #[error("{0}")]
    Unreachable(String),
    /// Pick who goes on; how is in the text.
    #[error("{0}")]
    Awaiting(String),
    /// Go on later; how is in the text.
    #[error("{0}")]
    Interrupted(String),
    /// Nothing that arguments could mend.
    #[error(transparent)]
    Failed(#[from] anyhow::Error),
}

impl Failure {
    /// The exit code of this failure.
    pub(crate) fn exit(&self) -> Exit {
        match self {
            Failure::Usage(_) | Failure::Problems { .. } => Exit::Usage,
            Failure::NotFound(_) => Exit::NotFound,
            Failure::Unreachable(_) => Exit::Unreachable,
            Failure::Awaiting(_) => Exit::Awaiting,
            Failure::Interrupted(_) => Exit::Interrupted,
            Failure::Failed(_) => Exit::Failed,
        }
    }

    /// Its word in JSON.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Failure::Usage(_) => "usage",
            Failure::Problems { .. } => "problems",
            Failure::NotFound(_) => "not_found",
            Failure::Unreachable(_) => "unreachable",
            Failure::Awaiting(_) => "awaiting",
            Failure::Interrupted(_) => "interrupted",
            Failure::Failed(_) => "failed",
        }
    }

    /// True if whoever reads our output has gone: there is nobody to tell, and nothing is wrong.
    pub(crate) fn is_broken_pipe(&self) -> bool {
        let Failure::Failed(error) = self else { return false };
        error.chain().any(|cause| {
            cause.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
        })
    }

    /// A submission's refusal: the problems of the file when the status carries them.
    pub(crate) fn of_submission(status: tonic::Status, file: PathBuf, text: String) -> Failure {
        match v1::Problems::decode(status.details()) {
            Ok(v1::Problems { problems })
                if status.code() == Code::InvalidArgument && !problems.is_empty() =>
            {
                Failure::Problems { file, text, problems }
            }
            _ => status.into(),
        }
    }
}

/// The table from gRPC codes to failures, and so to exit codes.
impl From<tonic::Status> for Failure {
    fn from(status: tonic::Status) -> Self {
        let text = status.message().to_owned();
        // What the other side says comes without a cause; a cause is the transport's own.
        let is_transport = std::error::Error::source(&status).is_some();
        match status.code() {
            _ if is_transport => {
                Failure::Unreachable(format!("the connection to the coordinator broke: {text}"))
            }
            Code::Unavailable => Failure::Unreachable(text),
            Code::DeadlineExceeded => Failure::Unreachable(format!("no answer in time: {text}")),
            Code::InvalidArgument | Code::PermissionDenied | Code::Unauthenticated => Failure::Usage(text),
            Code::NotFound => Failure::NotFound(text),
            Code::Unimplemented => Failure::Failed(anyhow::anyhow!(
                "{text}: the other side does not know this call; it may be of another release"
            )),
            _ => Failure::Failed(anyhow::Error::msg(text)),
        }
    }
}

/// Every command says the same of a file that is no lineage.
impl From<OpenError> for Failure {
    fn from(error: OpenError) -> Self {
        match error {
            OpenError::Missing { path } => Failure::NotFound(format!(
                "{}: no such file; name a lineage with --db FILE, or a coordinator with --coordinator URL",
                path.display()
            )),
            OpenError::Foreign { .. } => Failure::Usage(error.to_string()),
            _ => Failure::Failed(error.into()),
        }
    }
}

impl From<std::io::Error> for Failure {
    fn from(error: std::io::Error) -> Self {
        Failure::Failed(error.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_status_of_a_coordinator_has_its_exit_code() {
        let table = [
            (Code::InvalidArgument, 2),
            (Code::PermissionDenied, 2),
            (Code::Unauthenticated, 2),
            (Code::NotFound, 3),
            (Code::Unavailable, 4),
            (Code::DeadlineExceeded, 4),
            (Code::ResourceExhausted, 1),
            (Code::FailedPrecondition, 1),
            (Code::Internal, 1),
            (Code::Unimplemented, 1),
        ];
        for (code, exit) in table {
            let failure = Failure::from(tonic::Status::new(code, "why"));
            assert_eq!(failure.exit() as u8, exit, "{code:?}");
            assert!(failure.to_string().contains("why"), "{code:?} keeps the text");
        }
    }

    #[test]
    fn a_connection_that_breaks_is_an_unreachable_coordinator_whatever_its_code() {
        let broken = tonic::Status::from_error(Box::new(std::io::Error::other("reset")));
        assert_eq!(Failure::from(broken).exit(), Exit::Unreachable);
    }

    #[test]
    fn the_problems_of_a_submission_come_out_of_the_status_details() {
        let problem = v1::Problem { key: "search.kind".into(), line: 4, ..Default::default() };
        let details = v1::Problems { problems: vec![problem] }.encode_to_vec();
        let status = tonic::Status::with_details(Code::InvalidArgument, "1 problem", details.into());
        let failure = Failure::of_submission(status, "a.toml".into(), String::new());
        assert_eq!(failure.exit(), Exit::Usage);
        assert!(matches!(failure, Failure::Problems { problems, .. } if problems[0].line == 4));
        let plain = tonic::Status::invalid_argument("no such profile");
        let failure = Failure::of_submission(plain, "a.toml".into(), String::new());
        assert!(matches!(failure, Failure::Usage(text) if text == "no such profile"));
    }

    #[test]
    fn a_reader_that_goes_away_is_no_failure_of_ours() {
        let pipe = Failure::from(std::io::Error::from(std::io::ErrorKind::BrokenPipe));
        assert!(pipe.is_broken_pipe());
        assert!(!Failure::Usage("x".into()).is_broken_pipe());
    }
}
