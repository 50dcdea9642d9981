//! Errors of the driver as gRPC statuses: what is wrong with the call, and what with the state of things.

use super::render::render_problem;
use crate::driver::{AmendError, ControlError, ForkError, PickError, SubmitError};
use crate::lineage::WriteError;
use crate::service::lineage::status;
use prost::Message;
use proto::v1;
use search::Problem;
use tonic::{Code, Status};

fn problems_status(problems: &[Problem]) -> Status {
    let text = problems.iter().map(Problem::to_string).collect::<Vec<_>>().join("\n");
    let details = v1::Problems { problems: problems.iter().map(render_problem).collect() };
    Status::with_details(Code::InvalidArgument, text, details.encode_to_vec().into())
}

/// The status of a changed file that was refused.
pub fn amend_status(error: AmendError) -> Status {
    match error {
        AmendError::Problems(problems) => problems_status(&problems),
        AmendError::Running(_) | AmendError::Ended(..) | AmendError::Refused(_) => {
            Status::failed_precondition(error.to_string())
        }
        AmendError::Control(error) => control_status(error),
        AmendError::Read(error) => status(error),
        AmendError::Write(error) => write_status(error),
    }
}

/// The status of a fork that was refused.
pub fn fork_status(error: ForkError) -> Status {
    match error {
        ForkError::NoStage { .. } => Status::not_found(error.to_string()),
        ForkError::NotEnded { .. } | ForkError::Over { .. } => Status::failed_precondition(error.to_string()),
        ForkError::Problems(problems) => problems_status(&problems),
        ForkError::Amend(error) => amend_status(error),
        ForkError::Control(error) => control_status(error),
        ForkError::Read(error) => status(error),
        ForkError::Write(error) => write_status(error),
    }
}

pub(super) fn submit_status(error: SubmitError) -> Status {
    match error {
        SubmitError::Problems(problems) => problems_status(&problems),
        SubmitError::Read(error) => status(error),
        SubmitError::Write(error) => write_status(error),
        SubmitError::Control(error) => control_status(error),
    }
}

/// The status of an order that was refused.
pub fn control_status(error: ControlError) -> Status {
    match error {
        ControlError::Ended(..) | ControlError::Incompatible(..) => {
            Status::failed_precondition(error.to_string())
        }
        ControlError::Read(error) => status(error),
        ControlError::Write(error) => write_status(error),
    }
}

/// The status of a pick that was refused.
pub fn pick_status(error: PickError) -> Status {
    match error {
        PickError::NotAwaited(_) | PickError::NoCandidate { .. } | PickError::Ended(..) => {
            Status::failed_precondition(error.to_string())
        }
        PickError::Read(error) => status(error),
        PickError::Write(error) => write_status(error),
        PickError::Control(error) => control_status(error),
    }
}

fn write_status(error: WriteError) -> Status {
    match error {
        WriteError::Closed { .. } => Status::unavailable(error.to_string()),
        WriteError::Contradiction { .. } => Status::internal(error.to_string()),
    }
}
