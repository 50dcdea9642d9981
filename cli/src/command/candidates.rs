//! `hatchery candidates`: who may go on from the end of a stage, best first, and who did.

use proto::v1::{Candidate, CandidatesRequest, Choice};

use super::show::pairs;
use crate::arguments::Candidates;
use crate::connect::{Connection, PROMPT, Source, within};
use crate::exit::Failure;
use crate::render::table::{Column, table};
use crate::render::{Output, json, number};

pub(super) async fn candidates(arguments: Candidates, output: Output) -> Result<(), Failure> {
    let connection = Connection::open(&Source::of(&arguments.ask)?).await?;
    let named = arguments.stage.is_some();
    let (experiment, stage) = (arguments.experiment, arguments.stage.unwrap_or_default());
    let request = within(PROMPT, CandidatesRequest { experiment, stage });
    let mut choices = connection.experiments().candidates(request).await?.into_inner().choices;
    if !named && choices.iter().any(|choice| choice.picked == 0) {
        choices.retain(|choice| choice.picked == 0);
    }
    if output.json {
        return output.document(&choices.iter().map(json::choice).collect::<Vec<_>>());
    }
    if choices.is_empty() {
        return output.line("no stage has come to a choice yet");
    }
    output.line(choices.iter().map(text).collect::<Vec<_>>().join("\n\n"))
}

fn text(of: &Choice) -> String {
    let note = if of.note.is_empty() { String::new() } else { format!(": {}", of.note) };
    let outcome = match of.picked {
        0 => "a pick is awaited".to_owned(),
        picked => format!("individual {picked} was picked by {}{note}", who(&of.picked_by)),
    };
    let stage = if of.stage_name.is_empty() { of.stage.to_string() } else { of.stage_name.clone() };
    format!("run {}, stage {stage}: {outcome}\n{}", of.run, rows(of))
}

fn who(picked_by: &str) -> &str {
    if picked_by == "best" { "its fitness" } else { "a person" }
}

fn rows(of: &Choice) -> String {
    let columns = [
        Column::Right("rank"),
        Column::Right("individual"),
        Column::Right("population"),
        Column::Right("fitness"),
        Column::Left("notes"),
    ];
    let row = |one: &Candidate| {
        vec![
            one.rank.to_string(),
            one.individual.to_string(),
            one.population.map_or("-".to_owned(), |population| population.to_string()),
            number::figure(one.fitness),
            pairs(&one.notes),
        ]
    };
    table(&columns, of.candidates.iter().map(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_choice_names_its_stage_its_candidates_and_who_was_picked() {
        let candidate = |rank, individual, fitness| Candidate {
            rank,
            individual,
            population: Some(rank + 1),
            fitness,
            notes: r#"{"parts":7,"forward_locomotion":0.95}"#.into(),
        };
        let awaited = Choice {
            run: 1,
            stage: 3,
            stage_name: "left_turn".into(),
            candidates: vec![candidate(1, 4711, 0.51), candidate(2, 17, 0.25)],
            ..Default::default()
        };
        let picked = Choice {
            picked: 17,
            picked_by: "human".into(),
            note: "turns on the spot".into(),
            ..awaited.clone()
        };
        insta::assert_snapshot!(format!("{}\n\n{}", text(&awaited), text(&picked)));
    }
}
