use super::*;
use proptest::prelude::*;

const WALKER: &str = r#"name = "crawler"
system = "walker"
[task]
body = "crawler"
[search]
kind = "grn"
[profile.smoke]
search.generations = 4
[profile.other.search]
kind = "neat"
"#;

const MATRIX: &str = r#"name = "both"
system = "walker"
runs = 3
[search]
generations = 7
[search.grn]
elite = 2
[search.neat]
threshold = 0.3
[matrix]
"task.body" = ["crawler", "hopper"]
"search.kind" = ["grn", "neat"]
[[published]]
body = "crawler"
method = "grn"
mean = 80.85
p = "<0.005"
"#;

fn parse(text: &str) -> Vec<Experiment> {
    parse_with(text, None, &[]).unwrap_or_else(|problems| panic!("{problems:#?}"))
}

fn parse_with(
    text: &str,
    profile: Option<&str>,
    set: &[(&str, &str)],
) -> Result<Vec<Experiment>, Vec<Problem>> {
    let set = set.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
    Experiment::parse(text, &Overrides { profile: profile.map(str::to_owned), set })
}

/// Every problem with the text that it points at.
fn problems(text: &str, profile: Option<&str>, set: &[(&str, &str)]) -> String {
    let problems = parse_with(text, profile, set).expect_err("a bad file is refused");
    let pointed = |problem: &Problem| match &problem.span {
        Some(span) => format!("{problem}\n    at {:?}\n", &text[span.clone()]),
        None => format!("{problem}\n"),
    };
    problems.iter().map(pointed).collect()
}

#[test]
fn a_file_is_resolved_with_every_default_filled_in() {
    insta::assert_snapshot!(parse(WALKER)[0].resolved());
}

#[test]
fn a_resolved_file_is_a_file_of_the_same_experiment() {
    let culling = format!("{WALKER}\n[culling]\ncontrol = 0.05\n");
    for (text, profile) in [(WALKER, None), (WALKER, Some("smoke")), (MATRIX, None), (&culling, None)] {
        for experiment in parse_with(text, profile, &[]).unwrap() {
            let resolved = experiment.resolved();
            let again = Experiment::parse_resolved(&resolved).unwrap();
            assert_eq!(again.resolved(), resolved);
            assert_eq!(again.digest(), experiment.digest());
            assert_eq!(
                (again.name, again.group, again.profile, again.cell, again.published, again.culling),
                (
                    experiment.name,
                    experiment.group,
                    experiment.profile,
                    experiment.cell,
                    experiment.published,
                    experiment.culling
                )
            );
        }
    }
}

#[test]
fn a_profile_overrides_the_file_and_an_assignment_overrides_both() {
    let generations =
        |profile, set: &[(&str, &str)]| parse_with(WALKER, profile, set).unwrap()[0].generations().unwrap();
    assert_eq!(generations(None, &[]), 300);
    assert_eq!(generations(Some("smoke"), &[]), 4);
    assert_eq!(generations(Some("smoke"), &[("search.generations", "6")]), 6);
    let other = parse_with(WALKER, Some("other"), &[("task.world.friction_limb", "0.5")]).unwrap().remove(0);
    assert_eq!((other.search_kind(), other.profile.as_deref()), ("neat", Some("other")));
    assert!(other.task_json().contains(r#""friction_limb":0.5"#), "{}", other.task_json());
    assert_eq!(Experiment::profiles(WALKER).unwrap(), ["other", "smoke"]);
}

#[test]
fn a_matrix_gives_an_experiment_for_each_cell() {
    let cells = parse(MATRIX);
    let names: Vec<&str> = cells.iter().map(|cell| cell.name.as_str()).collect();
    assert_eq!(names, ["both/crawler-grn", "both/crawler-neat", "both/hopper-grn", "both/hopper-neat"]);
    let last = &cells[3];
    assert_eq!(last.group.as_deref(), Some("both"));
    assert_eq!(last.coordinates(), serde_json::json!({"task.body": "hopper", "search.kind": "neat"}));
    assert_eq!((last.runs, last.planned()), (3, Some(3 * 7 * 80)));
    assert!(last.resolved().contains("threshold = 0.3") && !last.resolved().contains("elite"));
    assert!(cells[0].resolved().contains("elite = 2") && !cells[0].resolved().contains("threshold"));
    assert_eq!(last.published()[0]["mean"], 80.85);
    let one = parse_with(MATRIX, None, &[("matrix.\"task.body\"", "[\"arm\"]")]).unwrap();
    assert_eq!(one.len(), 2, "an axis may be overridden");
}

#[test]
fn runs_are_experiments_of_their_own_with_seeds_that_follow() {
    let experiment = &parse(WALKER)[0];
    assert_eq!((experiment.seed_of(1), experiment.seed_of(20)), (1, 20));
    let first = |run| experiment.start(run).ask().remove(0).genotype;
    let other_seed = &parse_with(WALKER, None, &[("seed", "5")]).unwrap()[0];
    assert_eq!(first(5), other_seed.start(1).ask().remove(0).genotype);
    assert_ne!(first(1), first(2));
}

#[test]
fn every_bad_file_is_told_what_is_wrong_where_and_what_is_allowed() {
    let edit = |from: &str, to: &str| {
        assert!(WALKER.contains(from), "{from}");
        WALKER.replacen(from, to, 1)
    };
    let many = "name = \"last\"\nsystem = \"walker\"\nsead = 3\nruns = 0\naudit = 1.1\n\
                [task]\nbody = \"craler\"\nphi = \"ten\"\nwrld = 1\n[task.world]\nfriction_limb = -1\n\
                [search]\nkind = \"grn\"\npopulation = 1.5\n[search.grn]\nmat = 0.5\ntournament = 0\n\
                [culling]\nat = 1.0\nfracton = 0.2\n";
    let cases: Vec<(&str, String)> = vec![
        ("an empty file", String::new()),
        ("no toml", edit("[task]", "[task")),
        ("a key twice", edit("kind = \"grn\"", "kind = \"grn\"\nkind = \"neat\"")),
        ("an unknown key", edit("[task]", "sede = 3\n[task]")),
        ("an unknown table", edit("[task]", "[taks]")),
        ("an unknown key, nothing like a known one", edit("[search]", "wheels = 4\n[search]")),
        ("a wrong type", edit("[task]", "runs = \"many\"\n[task]")),
        ("a negative number", edit("[task]", "seed = -1\n[task]")),
        ("a number beyond 64 bits", edit("[task]", "seed = 99999999999999999999\n[task]")),
        ("a seed without room", edit("[task]", "seed = 9223372036854775807\n[task]")),
        ("no number", edit("[task]", "audit = nan\n[task]")),
        ("a date", edit("[task]", "seed = 2026-01-01\n[task]")),
        ("an audit of more than all", edit("[task]", "audit = 1.02\n[task]")),
        ("an unknown system", edit("\"walker\"", "\"walkers\"")),
        ("no system", edit("system = \"walker\"", "")),
        ("no body", edit("body = \"crawler\"", "")),
        ("no task", edit("[task]\nbody = \"crawler\"", "")),
        ("an unknown body", edit("\"crawler\"\n[search]", "\"crawlr\"\n[search]")),
        ("a task out of range", edit("[search]", "seconds = -1\n[search]")),
        ("no kind", edit("kind = \"grn\"", "")),
        ("no search", edit("[search]\nkind = \"grn\"", "")),
        ("an unknown kind", edit("\"grn\"", "\"gnr\"")),
        ("a kind of another system", edit("\"grn\"", "\"probe\"")),
        ("the keys of another kind", edit("kind = \"grn\"", "kind = \"grn\"\nneat.threshold = 0.3")),
        ("a share out of range", edit("kind = \"grn\"", "kind = \"grn\"\ngrn.mate = 1.5")),
        ("a range that is none", edit("kind = \"grn\"", "kind = \"grn\"\ngrn.beta = [2, 1]")),
        ("a table where a number belongs", edit("kind = \"grn\"", "kind = \"grn\"\npopulation = {}")),
        ("a number where a table belongs", edit("[task]\nbody = \"crawler\"", "task = 3")),
        (
            "a letter beyond ascii before the error",
            edit(
                "kind = \"grn\"",
                "kind = \"grn\"
grn = { \"ä\" = 1, mate = 3 }",
            ),
        ),
        ("many at once", many.to_owned()),
        ("a matrix of no list", format!("{WALKER}[matrix]\n\"task.body\" = \"arm\"\n")),
        ("a matrix of bare keys", format!("{WALKER}[matrix]\ntask.body = [\"arm\"]\n")),
        ("a matrix with a twin", format!("{WALKER}[matrix]\n\"task.body\" = [\"arm\", \"arm\"]\n")),
        ("a matrix with a bad cell", format!("{WALKER}[matrix]\n\"task.body\" = [\"arm\", \"leg\"]\n")),
        ("a matrix through a value", format!("{WALKER}[matrix]\n\"task.body.size\" = [1]\n")),
        ("a matrix of names", format!("{WALKER}[matrix]\nname = [\"a\", \"b\"]\n")),
        ("an empty matrix", format!("{WALKER}[matrix]\n")),
        (
            "a published row without its mean",
            format!("{WALKER}[[published]]\nbody = \"arm\"\nmethod = \"grn\"\n"),
        ),
    ];
    let mut told = String::new();
    for (what, text) in cases {
        told.push_str(&format!("# {what}\n{}\n", problems(&text, None, &[])));
    }
    insta::assert_snapshot!(told);
}

#[test]
fn every_bad_override_is_told_what_is_wrong() {
    let mut told = String::new();
    for profile in ["smoek", "nothing"] {
        told.push_str(&format!("# profile {profile}\n{}\n", problems(WALKER, Some(profile), &[])));
    }
    for (key, value) in [
        ("search.generatons", "5"),
        ("search.generations", "five"),
        ("search.generations", "1e99"),
        ("task.body.size", "3"),
        ("a..b", "1"),
        ("profile.smoke.runs", "1"),
        ("seed", "99999999999999999999"),
        ("runs", "[1, 2]"),
    ] {
        told.push_str(&format!("# set {key}={value}\n{}\n", problems(WALKER, None, &[(key, value)])));
    }
    let resolved = parse_with(WALKER, Some("smoke"), &[]).unwrap()[0].resolved();
    told.push_str(&format!("# a profile of a resolved file\n{}\n", problems(&resolved, Some("smoke"), &[])));
    insta::assert_snapshot!(told);
}

/// Every file of the project's own `experiments/`, as it is and with each of its profiles.
#[test]
fn every_ready_experiment_is_legal_with_every_profile_and_has_one_for_smoke() {
    // Reading files is this test's, not the crate's.
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../experiments");
    let mut read = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue; // what is asked of a lineage
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let profiles = Experiment::profiles(&text).unwrap();
        assert!(profiles.iter().any(|profile| profile == "smoke"), "{}", path.display());
        for profile in [None].into_iter().chain(profiles.iter().map(Some)) {
            let parsed = parse_with(&text, profile.map(String::as_str), &[]);
            let experiments = parsed.unwrap_or_else(|problems| panic!("{}: {problems:#?}", path.display()));
            for experiment in experiments {
                assert_eq!(
                    experiment.group.as_ref().unwrap_or(&experiment.name),
                    path.file_stem().unwrap().to_str().unwrap()
                );
                assert!(!experiment.start(1).ask().is_empty());
            }
        }
        read += 1;
    }
    assert!(read >= 11, "{read} files");
}

/// G-63, G-69, G-72.
#[test]
fn the_published_table_is_a_matrix_with_the_papers_results() {
    let text = include_str!("../../../experiments/grn-vs-neat.toml");
    let cells = parse(text);
    assert_eq!(cells.len(), 8);
    assert_eq!(cells.iter().map(|cell| cell.planned().unwrap()).sum::<u64>(), 3_840_000);
    assert_eq!(cells[0].published().as_array().unwrap().len(), 8);
    let quick = parse_with(text, Some("quick"), &[]).unwrap();
    let sizes: Vec<_> = quick.iter().map(|cell| (cell.runs, cell.generations(), cell.population())).collect();
    assert_eq!(sizes, [(2, Some(5), Some(20)); 2]);
    assert!(quick.iter().all(|cell| cell.cell["task.body"] == "crawler"));
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in "\\PC{0,200}") {
        let _ = Experiment::parse(&text, &Overrides::default());
    }

    /// Edits of a legal file: lines removed, doubled and swapped, bytes replaced.
    #[test]
    fn no_edit_of_a_file_makes_the_reader_panic(
        lines in prop::collection::vec(0usize..16, 0..24),
        at in any::<prop::sample::Index>(),
        letter in prop::sample::select(vec!['"', '[', ']', '=', '.', '-', '9', 'ä', '\n', '{', ' ']),
        key in "[a-z.\"]{0,12}",
        value in "\\PC{0,12}",
    ) {
        let source: Vec<&str> = MATRIX.lines().collect();
        let text: Vec<&str> = lines.iter().map(|&line| source[line % source.len()]).collect();
        for text in [text.join("\n"), MATRIX.to_owned()] {
            let mut letters: Vec<char> = text.chars().collect();
            let index = at.index(letters.len() + 1);
            letters.insert(index, letter);
            let text: String = letters.into_iter().collect();
            let overrides = Overrides { profile: None, set: vec![(key.clone(), value.clone())] };
            for overrides in [Overrides::default(), overrides] {
                if let Err(problems) = Experiment::parse(&text, &overrides) {
                    prop_assert!(!problems.is_empty());
                    for problem in problems {
                        if let Some(span) = problem.span {
                            prop_assert!(text.get(span).is_some(), "a span is of the text, between letters");
                        }
                    }
                }
            }
        }
    }
}
