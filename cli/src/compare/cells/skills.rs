//! An experiment with a syllabus as one cell a skill: the fitness of different skills does not compare, and each has
//! a curve of its own (ESP R-2). It reads rows and computes nothing.

use std::collections::BTreeMap;

use super::{Cell, Run, generation};
use crate::connect::Cells as Row;
use crate::exit::Failure;

/// The cells of one experiment's skills in the order in which they are learned, as far as they have begun. What only
/// leads to a pick, or follows it, has a colon in its name and is left out.
pub(super) fn skills(cell: &Cell, stages: &[Row], generations: &[Row]) -> Result<Vec<Cell>, Failure> {
    let mut names = BTreeMap::<u64, String>::new();
    let mut runs = BTreeMap::<(u64, u64), Run>::new();
    for row in stages {
        let name = row.text("name")?;
        if row.count("experiment")? == cell.experiment && !name.contains(": ") {
            let stage = row.count("stage")?;
            let planned = row.integer("generations")?.and_then(|planned| u64::try_from(planned).ok());
            let finished = row.integer("ended_ms")?.is_some();
            names.insert(stage, name.to_owned());
            runs.insert((stage, row.count("run")?), Run { finished, planned, ..Run::default() });
        }
    }
    for row in generations {
        if row.count("experiment")? == cell.experiment
            && let Some(run) = runs.get_mut(&(row.count("stage")?, row.count("run")?))
            && let Some(generation) = generation(row)?
        {
            run.generations.push(generation);
        }
    }
    let skill = |(stage, name): (u64, String)| {
        let of_stage = runs.iter().filter(|((other, _), _)| *other == stage);
        let mut runs: Vec<Run> = of_stage.map(|(_, run)| run.clone()).collect();
        runs.iter_mut().for_each(|run| run.generations.sort_by_key(|generation| generation.number));
        let body = if cell.body == cell.system { name.clone() } else { format!("{} {name}", cell.body) };
        Cell { body, skill: Some(name), runs, ..cell.clone() }
    };
    Ok(names.into_iter().map(skill).collect())
}
