//! Experiments as they go onto the wire. Values in, values out.

use crate::driver::{Ended, RunProgress as Live};
use crate::lineage::{RunProgress, StoredChoice, Summary};
use proto::v1;
use search::Problem;

pub(super) fn render_choice(choice: StoredChoice) -> v1::Choice {
    let candidates = choice.candidates.into_iter().map(|one| v1::Candidate {
        rank: one.rank,
        individual: one.individual.0,
        population: one.population,
        fitness: one.fitness,
        notes: one.notes,
    });
    let picked = choice.picked;
    v1::Choice {
        run: choice.run,
        stage: choice.number,
        stage_name: choice.name,
        candidates: candidates.collect(),
        picked: picked.as_ref().map_or(0, |picked| picked.individual.0),
        picked_by: picked.as_ref().map(|picked| picked.by.clone()).unwrap_or_default(),
        note: picked.map(|picked| picked.note).unwrap_or_default(),
    }
}

/// An experiment as the lineage has it, for the wire; without its resolved file.
pub fn render_summary(summary: Summary) -> v1::Experiment {
    v1::Experiment {
        id: summary.id.0,
        name: summary.name,
        group: summary.group.unwrap_or_default(),
        system: summary.system,
        search: summary.search_kind,
        state: summary.state,
        reason: summary.reason,
        seed: summary.seed,
        runs: summary.runs,
        cell: summary.cell,
        created_ms: summary.created_ms,
        ended_ms: summary.ended_ms,
        individuals: summary.individuals,
        planned: summary.planned.unwrap_or(0),
        evaluated: summary.evaluated,
        culled: summary.culled,
        aborted: summary.aborted,
        failed: summary.failed,
        progress: summary.progress.into_iter().map(render_run).collect(),
        resolved: String::new(),
    }
}

fn render_run(run: RunProgress) -> v1::Run {
    v1::Run {
        run: run.run,
        stage: run.stage,
        stage_name: run.stage_name,
        generation: run.generation,
        generations: run.generations.unwrap_or(0),
        done: run.done,
        size: run.size,
        best: run.best.map(|(fitness, _)| fitness),
        best_individual: run.best.map_or(0, |(_, id)| id.0),
        finished: run.ended,
    }
}

/// Outcomes reach the lineage a moment after the driver.
pub(super) fn bring_up_to_date(rendered: &mut v1::Experiment, live: &[Live]) {
    for run in &mut rendered.progress {
        let Some(live) = live.get(run.run as usize - 1) else { continue };
        if live.stage > run.stage {
            // Nothing of the stage was written yet when the lineage was read: what it said is of another one.
            let (stage, stage_name) = (live.stage, live.stage_name.clone());
            let generations = live.generations.unwrap_or(0);
            *run = v1::Run { run: run.run, stage, stage_name, generations, ..Default::default() };
        }
        if (live.stage, live.generation) >= (run.stage, run.generation) {
            (run.generation, run.size, run.done) = (live.generation, live.size as u32, live.done as u32);
        }
        if let Some((best, fitness)) = live.best
            && live.stage == run.stage
            && run.best.is_none_or(|known| fitness > known)
        {
            (run.best, run.best_individual) = (Some(fitness), best.0);
        }
    }
}

pub(super) fn render_generation(ended: Ended) -> v1::Generation {
    v1::Generation {
        run: ended.run,
        stage: ended.stage,
        stage_name: ended.stage_name,
        generation: ended.generation,
        generations: ended.generations.unwrap_or(0),
        individuals: ended.tally.individuals,
        completed: ended.tally.completed,
        culled: ended.tally.culled,
        aborted: ended.tally.aborted,
        failed: ended.tally.failed,
        inherited: ended.inherited,
        best: ended.tally.best,
        mean: ended.tally.mean,
        worst: ended.tally.worst,
        best_individual: ended.best.map_or(0, |id| id.0),
        steps: ended.tally.steps,
        seconds: ended.seconds,
        notes: ended.notes,
    }
}

pub(super) fn render_problem(problem: &Problem) -> v1::Problem {
    v1::Problem {
        key: problem.key.clone(),
        message: problem.message.clone(),
        help: problem.help.clone().unwrap_or_default(),
        start: problem.span.as_ref().map(|span| span.start as u64),
        end: problem.span.as_ref().map(|span| span.end as u64),
        line: problem.line,
        column: problem.column,
    }
}

#[cfg(test)]
mod tests;
