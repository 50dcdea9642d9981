//! `hatchery completions`: a completion script, made from the arguments themselves.

use clap::CommandFactory;

use crate::arguments::{Arguments, Completions};
use crate::exit::Failure;

pub(super) fn completions(arguments: &Completions) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "hatchery", &mut script);
    Ok(std::io::Write::write_all(&mut std::io::stdout(), &script)?)
}
