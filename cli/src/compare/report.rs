//! The comparison itself (walkers G-64 to G-72): a row a cell, a test a body, what is missing and what does
//! not match. A plain value, printed by `text` and as JSON with the same names. It fills no gap: what cannot
//! be said is absent.

use std::collections::BTreeSet;

use search::experiment::Published;
use serde::Serialize;

use super::cells::Cell;
use super::curves::{Curve, curve};
use super::statistics::{Sample, difference_percent, student, welch};

/// The level of the tests (G-65).
const ALPHA: f64 = 0.05;
/// The profiles whose runs are too short and too few for a verdict (G-72).
const QUICK_PROFILES: [&str; 2] = ["quick", "smoke"];

/// The comparison of a table of cells.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Report {
    /// The system, and the methods in order of appearance.
    pub(crate) system: String,
    /// As above.
    pub(crate) methods: Vec<String>,
    /// Runs of every cell; none if cells differ.
    pub(crate) runs: Option<usize>,
    /// Generations of every cell; none if cells differ or nothing has begun.
    pub(crate) generations: Option<u64>,
    /// Individuals a generation; likewise.
    pub(crate) population: Option<u64>,
    /// The version of the system; likewise.
    pub(crate) world: Option<u64>,
    /// True if any cell was culled: the published results were not, and are left out of the verdicts.
    pub(crate) culling: bool,
    /// True for a profile made for tests: no verdict.
    pub(crate) quick: bool,
    /// True if nothing is missing, unfinished or unlike the rest.
    pub(crate) complete: bool,
    /// A row a cell.
    pub(crate) cells: Vec<CellRow>,
    /// A row a body that has two methods.
    pub(crate) tests: Vec<TestRow>,
    /// How many verdicts are those of the paper.
    pub(crate) agreement: Option<Agreement>,
    /// What is missing, unfinished or unlike the rest.
    pub(crate) notes: Vec<String>,
    /// What of the model is our choice, and so how to read the figures.
    pub(crate) model: Option<String>,
    /// The fitness curves (G-67).
    pub(crate) curves: Vec<Curve>,
}

/// One cell's results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct CellRow {
    /// What moves.
    pub(crate) body: String,
    /// How it was searched.
    pub(crate) method: String,
    /// Finished runs.
    pub(crate) runs: usize,
    /// Runs asked for; 0 for a cell that is missing.
    pub(crate) runs_planned: usize,
    /// Mean over runs of the best fitness of the last generation.
    pub(crate) mean_best: Option<f64>,
    /// Their standard deviation (n − 1).
    pub(crate) sd: Option<f64>,
    /// The least.
    pub(crate) min: Option<f64>,
    /// The largest.
    pub(crate) max: Option<f64>,
    /// The generation at which the averaged best reaches 99 % of its final value (G-68).
    pub(crate) plateau: Option<u64>,
    /// The skill, of a syllabus.
    pub(crate) skill: Option<String>,
    /// The generations that it was given, of a skill.
    pub(crate) generations: Option<u64>,
    /// That at which the averaged best reaches 90 % of its final value, of a skill (ESP R-2).
    pub(crate) reaches_90_percent: Option<u64>,
    /// The published mean.
    pub(crate) paper: Option<f64>,
    /// Our mean over the published one.
    pub(crate) ours_over_paper: Option<f64>,
}

/// One body's test of two methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct TestRow {
    /// What moves.
    pub(crate) body: String,
    /// The method with the larger mean.
    pub(crate) better: Option<String>,
    /// The difference in per cent of the larger mean (G-66).
    pub(crate) diff_percent: Option<f64>,
    /// Student's t of the first method less the second.
    pub(crate) t: Option<f64>,
    /// Its degrees of freedom.
    pub(crate) df: Option<f64>,
    /// Its p.
    pub(crate) p: Option<f64>,
    /// Welch's p.
    pub(crate) p_welch: Option<f64>,
    /// The method preferred at 0.05, or `none`.
    pub(crate) verdict: Option<String>,
    /// What was published.
    pub(crate) paper: Option<PaperTest>,
    /// True if the verdicts are the same (G-71).
    pub(crate) agrees: Option<bool>,
}

/// A published test of two methods on one body.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct PaperTest {
    /// The method with the larger mean.
    pub(crate) better: Option<String>,
    /// The difference as printed, per cent.
    pub(crate) diff_percent: Option<f64>,
    /// p as printed.
    pub(crate) p: Option<String>,
    /// The method that the test prefers, or `none`.
    pub(crate) verdict: Option<String>,
}

/// How many verdicts are those of the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(crate) struct Agreement {
    /// So many agree,
    pub(crate) agree: usize,
    /// of so many that both sides have.
    pub(crate) of: usize,
}

/// Compares cells, in order of appearance.
pub(crate) fn report(cells: &[Cell]) -> Report {
    let bodies = distinct(cells.iter().map(|cell| &cell.body));
    let methods = distinct(cells.iter().map(|cell| &cell.method));
    let mut notes = Vec::new();
    let mut rows = Vec::new();
    let mut tests = Vec::new();
    let mut curves = Vec::new();
    let culling = cells.iter().any(Cell::culling);
    let quick = cells.iter().any(|cell| QUICK_PROFILES.contains(&cell.profile.as_str()));
    for body in &bodies {
        for method in &methods {
            let of_place: Vec<_> =
                cells.iter().filter(|cell| &cell.body == body && &cell.method == method).collect();
            if of_place.is_empty() {
                notes.push(format!("{body} {method} is missing"));
                rows.push(CellRow::missing(body, method));
            }
            for cell in of_place {
                let curve = curve(cell);
                rows.push(CellRow::of(cell, &curve));
                notes.extend(lack(cell, methods.len() > 1));
                curves.push(curve);
            }
        }
        let of_body: Vec<_> = cells.iter().filter(|cell| &cell.body == body).collect();
        if methods.len() > 1 {
            let unlike = mismatch(&of_body);
            if let [first, second] = of_body[..] {
                tests.push(TestRow::of(first, second, unlike.is_none(), quick, culling));
            } else if of_body.len() > 2 {
                notes.push(format!("{body} has {} cells: a test takes two", of_body.len()));
            }
            notes.extend(unlike.map(|what| format!("{body}: cells differ in {what}, so there is no test")));
        }
    }
    let all: Vec<_> = cells.iter().collect();
    // What differs between skills is no fault of theirs.
    let mut unlike = Vec::new();
    for skill in cells.iter().map(|cell| &cell.skill).collect::<BTreeSet<_>>() {
        let of_skill: Vec<_> = all.iter().copied().filter(|cell| &cell.skill == skill).collect();
        for what in mismatches(&of_skill) {
            if !unlike.contains(&what) {
                unlike.push(what);
            }
        }
    }
    if !unlike.is_empty() && !notes.iter().any(|note| note.contains("cells differ")) {
        notes.push(format!("cells differ in {}", unlike.join(" and ")));
    }
    let complete = !cells.is_empty() && notes.is_empty();
    // Without tests there are no verdicts to leave out.
    if culling && !tests.is_empty() {
        notes.push("culling was on, and the paper has none: its verdicts are left out".to_owned());
    }
    let settled = tests.iter().filter_map(|test| test.agrees);
    let agreement =
        Agreement { agree: settled.clone().filter(|&agrees| agrees).count(), of: settled.count() };
    Report {
        system: cells.first().map(|cell| cell.system.clone()).unwrap_or_default(),
        methods,
        runs: common(&all, |cell| Some(cell.planned)),
        generations: common(&all, |cell| cell.generations()),
        population: common(&all, |cell| cell.population()),
        world: common(&all, |cell| Some(cell.world)),
        culling,
        quick,
        complete,
        cells: rows,
        tests,
        agreement: (agreement.of > 0).then_some(agreement),
        notes,
        model: model_note(cells),
        curves,
    }
}

impl CellRow {
    fn missing(body: &str, method: &str) -> CellRow {
        CellRow {
            body: body.to_owned(),
            method: method.to_owned(),
            runs: 0,
            runs_planned: 0,
            mean_best: None,
            sd: None,
            min: None,
            max: None,
            plateau: None,
            skill: None,
            generations: None,
            reaches_90_percent: None,
            paper: None,
            ours_over_paper: None,
        }
    }

    fn of(cell: &Cell, curve: &Curve) -> CellRow {
        let sample = Sample::of(&cell.results());
        let paper = cell.paper().map(|paper| paper.mean);
        CellRow {
            runs: cell.finished().count(),
            runs_planned: cell.planned,
            mean_best: sample.map(|sample| sample.mean),
            sd: sample.and_then(|sample| sample.deviation),
            min: sample.map(|sample| sample.min),
            max: sample.map(|sample| sample.max),
            plateau: curve.plateau(),
            skill: cell.skill.clone(),
            generations: cell.skill.as_ref().and_then(|_| cell.generations()),
            reaches_90_percent: cell.skill.as_ref().and_then(|_| curve.reaches(0.9)),
            paper,
            ours_over_paper: sample.zip(paper).map(|(sample, paper)| sample.mean / paper),
            ..CellRow::missing(&cell.body, &cell.method)
        }
    }
}

impl TestRow {
    fn of(first: &Cell, second: &Cell, alike: bool, quick: bool, culling: bool) -> TestRow {
        let samples = Sample::of(&first.results()).zip(Sample::of(&second.results()));
        let better = samples.and_then(|(one, other)| {
            (one.mean != other.mean)
                .then(|| if one.mean > other.mean { first.method.clone() } else { second.method.clone() })
        });
        let tested = samples.filter(|_| alike);
        let test = tested.and_then(|(one, other)| student(&one, &other));
        let verdict = test.filter(|_| !quick).map(|test| match &better {
            Some(method) if test.p < ALPHA => method.clone(),
            _ => "none".to_owned(),
        });
        let paper = [first, second].into_iter().find_map(Cell::paper).map(PaperTest::of);
        let paper = paper.filter(|_| !quick && !culling);
        let published = paper.as_ref().and_then(|paper| paper.verdict.as_ref());
        TestRow {
            body: first.body.clone(),
            diff_percent: samples.and_then(|(one, other)| difference_percent(one.mean, other.mean)),
            t: test.map(|test| test.t),
            df: test.map(|test| test.df),
            p: test.map(|test| test.p),
            p_welch: tested.and_then(|(one, other)| welch(&one, &other)).map(|test| test.p),
            agrees: verdict.as_ref().zip(published).map(|(ours, theirs)| ours == theirs),
            better,
            verdict,
            paper,
        }
    }
}

impl PaperTest {
    fn of(published: &Published) -> PaperTest {
        PaperTest {
            better: published.better.clone(),
            diff_percent: published.difference_percent,
            p: published.p.clone(),
            verdict: published.verdict.clone(),
        }
    }
}

/// What keeps the cell from its full number of runs, or from a test where there is one.
fn lack(cell: &Cell, is_tested: bool) -> Option<String> {
    let finished = cell.finished().count();
    let place = format!("{} {}", cell.body, cell.method);
    if finished == cell.planned && finished < 2 && is_tested {
        return Some(format!("{place}: a test takes two runs or more"));
    }
    (finished < cell.planned).then(|| {
        format!("{place}: {} of {} runs unfinished, left out", cell.planned - finished, cell.planned)
    })
}

/// What the two cells of a body may not differ in if they are to be tested against each other.
fn mismatch(cells: &[&Cell]) -> Option<String> {
    let mut unlike = mismatches(cells);
    if common(cells, |cell| Some(&cell.settings)).is_none() {
        unlike.push("task settings");
    }
    (!unlike.is_empty()).then(|| unlike.join(" and "))
}

fn mismatches(cells: &[&Cell]) -> Vec<&'static str> {
    // A cell that has not begun says nothing of its generations; it is named as unfinished.
    let begun: Vec<_> = cells.iter().copied().filter(|cell| cell.population().is_some()).collect();
    let mut unlike = Vec::new();
    if begun.is_empty() {
        return unlike;
    }
    for (is_common, what) in [
        (common(cells, |cell| Some(&cell.system)).is_some(), "system"),
        (common(cells, |cell| Some(cell.world)).is_some(), "world version"),
        (common(&begun, |cell| Some(cell.generations())).is_some(), "generations"),
        (common(&begun, |cell| Some(cell.population())).is_some(), "population"),
        (common(&begun, |cell| Some(cell.culling())).is_some(), "culling"),
    ] {
        if !is_common {
            unlike.push(what);
        }
    }
    unlike
}

/// What all cells have in common.
fn common<'a, T: PartialEq>(cells: &[&'a Cell], of: impl Fn(&'a Cell) -> Option<T>) -> Option<T> {
    let mut values = cells.iter().map(|cell| of(cell));
    let first = values.next()??;
    values.all(|value| value.as_ref() == Some(&first)).then_some(first)
}

fn distinct<'a>(words: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut seen = Vec::new();
    for word in words {
        if !seen.contains(word) {
            seen.push(word.clone());
        }
    }
    seen
}

/// What the paper leaves open and this reproduction had to choose (walkers §6, §13).
fn model_note(cells: &[Cell]) -> Option<String> {
    let walker = cells.iter().find(|cell| cell.system == "walker" && !cell.published.is_empty())?;
    let setting = |key: &str| walker.settings.get(key).map(ToString::to_string);
    let number = |text: String| text.strip_suffix(".0").map(str::to_owned).unwrap_or(text);
    let (phi, theta) = (number(setting("phi")?), number(setting("theta")?));
    Some(format!(
        "phi {phi}, theta {theta}, bodies and contact model are ours: compare signs and significance, not scores."
    ))
}

#[cfg(test)]
mod tests {
    use super::super::cells::tests::finished;
    use super::*;

    const HIGH: [f64; 6] = [80.0, 84.0, 78.0, 82.0, 79.0, 81.0];
    const LOW: [f64; 6] = [77.0, 75.0, 81.0, 74.0, 78.0, 76.0];

    fn published(cell: Cell, mean: f64, verdict: &str) -> Cell {
        let row = Published {
            body: cell.body.clone(),
            method: cell.method.clone(),
            mean,
            generations: None,
            better: Some("grn".into()),
            difference_percent: Some(21.78),
            p: Some("<0.005".into()),
            verdict: Some(verdict.into()),
        };
        Cell { published: vec![row], ..cell }
    }

    #[test]
    fn a_body_with_two_methods_is_tested_and_agrees_by_verdict_alone() {
        let cells = [
            published(finished("crawler", "grn", &HIGH), 80.85, "grn"),
            published(finished("crawler", "neat", &LOW), 63.20, "grn"),
            published(finished("hopper", "grn", &HIGH), 303.69, "none"),
            published(finished("hopper", "neat", &LOW), 221.97, "none"),
        ];
        let report = report(&cells);
        assert!(report.complete, "{:?}", report.notes);
        assert_eq!(report.tests[0].verdict.as_deref(), Some("grn"));
        assert_eq!((report.tests[0].agrees, report.tests[1].agrees), (Some(true), Some(false)));
        assert_eq!(report.agreement, Some(Agreement { agree: 1, of: 2 }));
        assert!((report.tests[0].p.unwrap() - 0.017167517).abs() < 5e-10, "walker T-17");
    }

    #[test]
    fn a_larger_mean_without_significance_is_better_and_has_no_verdict() {
        let cells = [finished("arm", "grn", &[1.0, 9.0]), finished("arm", "neat", &[2.0, 9.0])];
        let test = &report(&cells).tests[0];
        assert_eq!((test.better.as_deref(), test.verdict.as_deref()), (Some("neat"), Some("none")));
        assert_eq!((test.agrees, &test.paper), (None, &None));
    }

    #[test]
    fn fewer_than_two_finished_runs_or_a_missing_cell_are_named_and_not_guessed() {
        let mut half = finished("arm", "neat", &LOW);
        half.runs.iter_mut().skip(1).for_each(|run| run.finished = false);
        let report = report(&[finished("arm", "grn", &HIGH), half, finished("hopper", "grn", &HIGH)]);
        assert!(!report.complete);
        let arm = &report.tests[0];
        assert_eq!((arm.t, arm.p, arm.p_welch, &arm.verdict), (None, None, None, &None));
        assert!(arm.diff_percent.is_some());
        assert_eq!((report.cells[1].runs, report.cells[1].sd), (1, None));
        assert_eq!(report.tests.len(), 1);
        assert_eq!(report.notes, ["arm neat: 5 of 6 runs unfinished, left out", "hopper neat is missing"]);
    }

    #[test]
    fn cells_of_different_populations_or_worlds_are_not_tested_against_each_other() {
        let mut other = finished("arm", "neat", &LOW);
        other.runs.iter_mut().flat_map(|run| &mut run.generations).for_each(|g| g.size = 20);
        let made = report(&[finished("arm", "grn", &HIGH), other]);
        assert_eq!((made.tests[0].p, made.population, made.complete), (None, None, false));
        assert_eq!(made.notes[0], "arm: cells differ in population, so there is no test");
        let other = Cell { world: 2, ..finished("arm", "neat", &LOW) };
        let made = report(&[finished("arm", "grn", &HIGH), other]);
        assert_eq!((made.tests[0].p, made.world), (None, None));
    }

    #[test]
    fn a_different_task_is_not_tested_either() {
        let other = Cell { settings: serde_json::json!({"seconds": 1}), ..finished("arm", "neat", &LOW) };
        let made = report(&[finished("arm", "grn", &HIGH), other]);
        assert_eq!(made.tests[0].p, None);
        assert!(made.notes[0].contains("task settings"), "{:?}", made.notes);
    }

    #[test]
    fn no_variance_on_both_sides_leaves_the_difference_as_in_walker_x_23() {
        let report = report(&[finished("arm", "grn", &[1.0, 1.0]), finished("arm", "neat", &[2.0, 2.0])]);
        let test = &report.tests[0];
        assert_eq!((test.t, test.p, &test.verdict, test.diff_percent), (None, None, &None, Some(50.0)));
    }

    #[test]
    fn a_quick_profile_has_no_verdict_and_culling_leaves_the_paper_out() {
        let pair = || {
            [published(finished("crawler", "grn", &HIGH), 80.85, "grn"), finished("crawler", "neat", &LOW)]
        };
        let quick = report(&pair().map(|cell| Cell { profile: "quick".into(), ..cell }));
        assert!(quick.quick);
        assert_eq!((&quick.tests[0].verdict, quick.tests[0].agrees), (&None, None));
        let mut culled = pair();
        culled
            .iter_mut()
            .flat_map(|cell| &mut cell.runs)
            .flat_map(|run| &mut run.generations)
            .for_each(|g| g.culling = true);
        let culled = report(&culled);
        assert_eq!((culled.tests[0].verdict.as_deref(), &culled.tests[0].paper), (Some("grn"), &None));
        assert_eq!(culled.agreement, None);
    }

    #[test]
    fn a_matrix_of_single_runs_is_finished_and_yet_not_complete() {
        let report = report(&[finished("arm", "grn", &[1.0]), finished("arm", "neat", &[2.0])]);
        assert!(!report.complete);
        assert_eq!(report.notes[0], "arm grn: a test takes two runs or more");
    }

    #[test]
    fn skills_may_differ_in_generations_and_tell_when_they_reach_90_per_cent() {
        let skill = |name: &str| Cell { skill: Some(name.into()), ..finished(name, "syllabus", &[3.0, 5.0]) };
        let mut turn = skill("turn");
        turn.runs.iter_mut().for_each(|run| run.planned = Some(7));
        let report = report(&[skill("walk"), turn]);
        assert!(report.complete, "{:?}", report.notes);
        let rows: Vec<_> = report.cells.iter().map(|row| (row.generations, row.reaches_90_percent)).collect();
        assert_eq!(rows, [(Some(2), Some(2)), (Some(7), Some(2))]);
    }

    #[test]
    fn one_experiment_is_a_table_without_tests() {
        let report = report(&[finished("crawler", "grn", &[3.0])]);
        assert!(report.complete && report.tests.is_empty());
        assert_eq!((report.cells[0].mean_best, report.cells[0].sd), (Some(3.0), None));
    }
}
