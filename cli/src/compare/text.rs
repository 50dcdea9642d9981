//! The report as text, in the shape of walker G-70. It computes nothing: what is absent prints `n/a`.

use super::report::{CellRow, Report, TestRow};
use crate::render::table::{Column, table};

/// The whole report.
pub(crate) fn text(report: &Report) -> String {
    let mut parts = vec![heading(report), cells(report)];
    if !report.tests.is_empty() {
        parts.push(tests(report));
    }
    parts.extend(report.notes.iter().cloned());
    let agreement =
        report.agreement.map(|agreement| format!("agreement {} of {}.", agreement.agree, agreement.of));
    let last: Vec<_> = agreement.into_iter().chain(report.model.clone()).collect();
    if !last.is_empty() {
        parts.push(last.join("  "));
    }
    parts.join("\n")
}

fn heading(report: &Report) -> String {
    let number = |value: Option<String>| value.unwrap_or_else(|| "?".to_owned());
    let plural = match report.system.as_str() {
        "esp" => "esp creatures".to_owned(),
        "fish" => "fishes".to_owned(),
        system => format!("{system}s"),
    };
    let mut parts = vec![
        format!("{plural}: {}", report.methods.join(" against ")),
        format!(
            "{} x {} generations x {}",
            report.runs.map_or("? runs".to_owned(), |n| if n == 1 {
                "1 run".to_owned()
            } else {
                format!("{n} runs")
            }),
            number(report.generations.map(|n| n.to_string())),
            number(report.population.map(|n| n.to_string()))
        ),
        format!("world {}", number(report.world.map(|n| n.to_string()))),
        format!("culling {}", if report.culling { "on" } else { "off" }),
    ];
    if report.quick {
        parts.push("quick".to_owned());
    }
    parts.join("      ")
}

fn cells(report: &Report) -> String {
    let has_paper = report.cells.iter().any(|row| row.paper.is_some());
    let has_skills = report.cells.iter().any(|row| row.skill.is_some());
    let mut columns = vec![
        Column::Left(if has_skills { "skill" } else { "body" }),
        Column::Left("method"),
        Column::Right("runs"),
        Column::Right("mean best"),
        Column::Right("SD"),
        Column::Right("min"),
        Column::Right("max"),
        Column::Right("plateau"),
    ];
    if has_skills {
        columns.extend([Column::Right("90 %"), Column::Right("generations")]);
    }
    if has_paper {
        columns.extend([Column::Bar, Column::Right("paper"), Column::Right("ours/paper")]);
    }
    table(&columns, report.cells.iter().map(|row| cell(row, has_skills, has_paper)))
}

fn cell(row: &CellRow, has_skills: bool, has_paper: bool) -> Vec<String> {
    let runs = match row.runs {
        runs if runs == row.runs_planned => runs.to_string(),
        runs => format!("{runs} of {}", row.runs_planned),
    };
    // A skill's fitness is seldom more than 1.
    let figure = |value: Option<f64>| match row.skill {
        Some(_) => value.map_or_else(absent, |value| format!("{value:.3}")),
        None => hundredths(value),
    };
    let mut cells = vec![
        row.body.clone(),
        row.method.clone(),
        runs,
        figure(row.mean_best),
        figure(row.sd),
        figure(row.min),
        figure(row.max),
        row.plateau.map_or_else(absent, |generation| generation.to_string()),
    ];
    if has_skills {
        let count = |count: Option<u64>| count.map_or_else(absent, |count| count.to_string());
        cells.extend([count(row.reaches_90_percent), count(row.generations)]);
    }
    if has_paper {
        cells.extend(["|".to_owned(), hundredths(row.paper), hundredths(row.ours_over_paper)]);
    }
    cells
}

fn tests(report: &Report) -> String {
    let has_paper = report.tests.iter().any(|row| row.paper.is_some());
    let mut columns = vec![
        Column::Left("body"),
        Column::Left("better"),
        Column::Right("diff %"),
        Column::Right("t"),
        Column::Left("df"),
        Column::Left("p"),
        Column::Left("p (Welch)"),
    ];
    if !report.quick {
        columns.push(Column::Left("verdict"));
    }
    if has_paper {
        columns.extend([
            Column::Bar,
            Column::Left("paper: better"),
            Column::Right("diff %"),
            Column::Left("p"),
            Column::Left("verdict"),
            Column::Bar,
            Column::Left("agrees"),
        ]);
    }
    table(&columns, report.tests.iter().map(|row| test(row, report.quick, has_paper)))
}

fn test(row: &TestRow, quick: bool, has_paper: bool) -> Vec<String> {
    let mut cells = vec![
        row.body.clone(),
        word(row.better.as_ref()),
        hundredths(row.diff_percent),
        row.t.map_or_else(absent, |t| format!("{t:.3}")),
        row.df.map_or_else(absent, |df| format!("{df:.0}")),
        probability(row.p),
        probability(row.p_welch),
    ];
    if !quick {
        cells.push(word(row.verdict.as_ref()));
    }
    if has_paper {
        let paper = row.paper.as_ref();
        let agrees = row.agrees.map(|agrees| if agrees { "yes" } else { "no" }.to_owned());
        cells.extend([
            "|".to_owned(),
            word(paper.and_then(|paper| paper.better.as_ref())),
            hundredths(paper.and_then(|paper| paper.diff_percent)),
            word(paper.and_then(|paper| paper.p.as_ref())),
            word(paper.and_then(|paper| paper.verdict.as_ref())),
            "|".to_owned(),
            word(agrees.as_ref()),
        ]);
    }
    cells
}

fn absent() -> String {
    "n/a".to_owned()
}

fn hundredths(value: Option<f64>) -> String {
    value.map_or_else(absent, |value| format!("{value:.2}"))
}

/// p with five decimals; below a ten-thousandth it says so and no more (G-71).
fn probability(p: Option<f64>) -> String {
    match p {
        Some(p) if p < 1e-4 => "<0.0001".to_owned(),
        Some(p) => format!("{p:.5}"),
        None => absent(),
    }
}

fn word(word: Option<&String>) -> String {
    word.cloned().unwrap_or_else(absent)
}

#[cfg(test)]
mod tests {
    use super::super::cells::{Cell, tests::finished};
    use super::super::report::report;
    use super::*;
    use search::experiment::Published;

    fn published(cell: Cell, mean: f64, (better, percent, p, verdict): (&str, f64, &str, &str)) -> Cell {
        let row = Published {
            body: cell.body.clone(),
            method: cell.method.clone(),
            mean,
            generations: None,
            better: Some(better.into()),
            difference_percent: Some(percent),
            p: Some(p.into()),
            verdict: Some(verdict.into()),
        };
        Cell { published: vec![row], ..cell }
    }

    fn cells() -> Vec<Cell> {
        let crawler = ("grn", 21.78, "<0.005", "grn");
        let arm = ("neat", 27.09, "<0.0001", "neat");
        vec![
            published(finished("crawler", "grn", &[80.0, 84.0, 78.0, 82.0, 79.0, 81.0]), 80.85, crawler),
            published(finished("crawler", "neat", &[77.0, 75.0, 81.0, 74.0, 78.0, 76.0]), 63.20, crawler),
            published(finished("arm", "grn", &[147.0, 149.0, 148.0, 150.0, 146.0, 145.0]), 147.42, arm),
            published(finished("arm", "neat", &[200.0, 204.0, 203.0, 201.0, 199.0, 202.0]), 202.20, arm),
        ]
    }

    #[test]
    fn a_whole_report_has_the_shape_of_walker_g_70() {
        insta::assert_snapshot!(text(&report(&cells())));
    }

    #[test]
    fn a_broken_report_prints_what_exists_as_in_walker_x_22() {
        let mut cells = cells();
        cells.remove(3);
        cells[1].runs.iter_mut().skip(1).for_each(|run| run.finished = false);
        insta::assert_snapshot!(text(&report(&cells)));
    }

    #[test]
    fn a_quick_report_says_quick_and_prints_no_verdict() {
        let cells: Vec<_> =
            cells().into_iter().take(2).map(|cell| Cell { profile: "quick".into(), ..cell }).collect();
        let text = text(&report(&cells));
        assert!(text.lines().next().unwrap().ends_with("quick"), "{text}");
        assert!(!text.contains("verdict") && !text.contains("agree"), "{text}");
    }

    #[test]
    fn the_same_names_stand_in_the_json() {
        let json = serde_json::to_value(report(&cells())).unwrap();
        assert_eq!(json["tests"][0]["paper"]["p"], "<0.005");
        assert_eq!(json["cells"][3]["paper"], 202.2);
        for name in [
            "runs",
            "generations",
            "population",
            "world",
            "culling",
            "quick",
            "complete",
            "agreement",
            "curves",
        ] {
            assert!(!json[name].is_null(), "{name}");
        }
    }

    #[test]
    fn small_probabilities_are_not_spelled_out() {
        assert_eq!(probability(Some(0.99e-4)), "<0.0001");
        assert_eq!(probability(Some(0.0171675)), "0.01717");
        assert_eq!(probability(None), "n/a");
    }
}
