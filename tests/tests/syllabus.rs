//! The ten skills of `fight-or-flight.toml`, learned by real creatures under the smoke profile, in both modes: killed
//! in every kind of sub-stage, and what they cost (ESP E-60, E-69, E-85, E-92, T-12, T-13, R-3, R-4). The two skills of
//! `high-reach.toml`: begun with a creature that was brought along, and forked (E-86, E-90). A creature of the ten
//! under a light of a script (E-83, R-11).

use std::collections::BTreeSet;
use std::path::Path;

use hatchery_tests::programs::workspace;
use hatchery_tests::{Hatchery, command, local};
use search::{Experiment, Overrides};

/// The file, whose first skill keeps a phase of shaping under the smoke profile.
fn shaped() -> String {
    let file = workspace().join("experiments/fight-or-flight.toml");
    let text = std::fs::read_to_string(file).expect("committed with the sources");
    let shaped = text.replace("\nphase = []", "\nphase = [{ share = 0.5, speed_step = 0.01 }]");
    assert_ne!(shaped, text, "the smoke profile has no phase of its own");
    shaped
}

/// What is done in a stage, by its name and the skills that are learned before it.
fn kind(stage: &str, mode: &str) -> &'static str {
    let leaf = ["left_turn", "right_turn", "strike"].contains(&stage);
    match stage.split_once(": ").map(|(_, part)| part.split(' ').next()) {
        Some(Some("phase")) => "phase",
        Some(Some("reconcile")) => "reconciliation",
        Some(Some("measure")) => "measurement",
        None if leaf && mode == "general" => "retest",
        _ => "evolution",
    }
}

/// Kills coordinator and workers in one stage after the other, as many as it finds at work, and compares.
fn killed_everywhere(mode: &str, kinds: &[&'static str]) {
    let set = vec![("search.mode".to_owned(), mode.to_owned())];
    let overrides = Overrides { profile: Some("smoke".to_owned()), set };
    let experiments = Experiment::parse(&shaped(), &overrides).unwrap_or_else(|e| panic!("{e:?}"));
    let text = experiments[0].resolved();
    let mut hatchery = Hatchery::with_workers(2);
    hatchery.wait_attached(2);
    let id = hatchery.submit(&text);
    let mut seen = BTreeSet::new();
    let mut next = 0;
    loop {
        let waited = hatchery.client().wait_until(id, |e| {
            let run = &e.progress[..];
            e.state == "finished" || run.iter().any(|run| !run.finished && run.stage >= next)
        });
        if waited.state == "finished" {
            break;
        }
        hatchery.kill_coordinator();
        hatchery.kill("w1");
        hatchery.restart_coordinator();
        hatchery.join("w1");
        let run = &waited.progress[0];
        seen.insert(kind(&run.stage_name, mode));
        next = run.stage + 1;
    }
    hatchery.client().wait(id);
    assert_eq!(hatchery.client().hash(id), local::lineage(&text), "killed in {seen:?}");
    assert_eq!(seen, kinds.iter().copied().collect(), "every kind of sub-stage was killed");
}

#[test]
fn fast_mode_killed_in_every_sub_stage_comes_to_the_same_lineage() {
    killed_everywhere("fast", &["phase", "evolution", "measurement"]);
}

#[test]
fn general_mode_killed_in_every_sub_stage_comes_to_the_same_lineage() {
    killed_everywhere("general", &["phase", "evolution", "retest", "reconciliation", "measurement"]);
}

/// What one skill cost, and how many individuals were evaluated for it.
#[derive(Debug, PartialEq)]
struct Cost {
    skill: String,
    evaluated: u64,
    new: u64,
    retest: u64,
    trials: u64,
}

/// Learns the ten skills with all their headings, where no loss of an older skill ends a test, and reads from the
/// lineage what each has cost.
fn costs(mode: &str, folder: &Path) -> Vec<Cost> {
    let text = std::fs::read_to_string(workspace().join("experiments/fight-or-flight.toml"));
    let text = text.expect("committed with the sources");
    let all =
        text.replace("\nfitness.headings = [0, 30, -30]", "").replace("\nfitness.headings = [0, 180]", "");
    assert_eq!(text.lines().count() - all.lines().count(), 3, "the smoke profile leaves headings out");
    std::fs::write(folder.join("ten.toml"), all).expect("the folder is writable");
    let mode = format!("search.mode={mode}");
    let never = "search.retest_tolerance=1.0";
    let run = ["run", "ten.toml", "--profile", "smoke", "--workers", "2", "--set", &mode, "--set", never];
    command::succeed(folder, &run);
    let sql = "SELECT stage_name AS name, sum(individuals - inherited) AS evaluated, \
        sum(notes ->> 'tests_new') AS new, sum(notes ->> 'tests_retest') AS retest, sum(notes ->> 'trials') AS trials \
        FROM v_generations WHERE stage_name NOT LIKE '%: %' GROUP BY stage ORDER BY stage";
    let cost = |row: serde_json::Value| {
        let count = |key: &str| row[key].as_u64().unwrap_or_else(|| panic!("{key}: {row}"));
        Cost {
            skill: row["name"].as_str().expect("a stage has a name").to_owned(),
            evaluated: count("evaluated"),
            new: count("new"),
            retest: count("retest"),
            trials: count("trials"),
        }
    };
    command::json_lines(folder, &["sql", sql]).into_iter().map(cost).collect()
}

/// Trials of a test of each skill, in the order of the file (T-12).
const TRIALS: [(&str, u64); 10] = [
    ("forward_locomotion", 1),
    ("left_turn", 1),
    ("right_turn", 1),
    ("turn_to_light", 4),
    ("move_to_light", 5),
    ("strike", 1),
    ("attack", 5),
    ("turn_from_light", 13),
    ("retreat", 13),
    ("fight_or_flight", 8),
];

/// T-12, for as many individuals as were evaluated: what is learned in turn, by its place in the file, and the tests of
/// older skills, all leaves of one trial, that each individual has before.
fn expected(turns: [(usize, u64); 10], costs: &[Cost]) -> Vec<Cost> {
    let cost = |((place, retests), cost): ((usize, u64), &Cost)| Cost {
        skill: TRIALS[place].0.to_owned(),
        evaluated: cost.evaluated,
        new: cost.evaluated,
        retest: retests * cost.evaluated,
        trials: (retests + TRIALS[place].1) * cost.evaluated,
    };
    turns.into_iter().zip(costs).map(cost).collect()
}

/// Learns all in one mode, and compares.
fn cost_as_expected(mode: &str, turns: [(usize, u64); 10]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let costs = costs(mode, folder.path());
    assert_eq!(costs, expected(turns, &costs));
    assert_eq!(costs.len(), TRIALS.len());
    assert!(costs.iter().all(|cost| cost.evaluated >= 6), "{costs:?}");
}

/// each skill costs one test of each individual, however many were learned before it.
#[test]
fn fast_mode_tests_the_new_skill_alone() {
    cost_as_expected("fast", std::array::from_fn(|place| (place, 0)));
}

/// retests grow with the leaf skills, and end with them.
#[test]
fn general_mode_tests_older_skills_while_leaves_are_learned() {
    let leaves = [(0, 0), (1, 1), (2, 2), (5, 3)];
    let others = [3, 4, 6, 7, 8, 9].map(|place| (place, 0));
    let turns = [&leaves[..], &others[..]].concat().try_into().expect("ten skills");
    cost_as_expected("general", turns);
}

/// The file of the two skills, in one mode; with a change.
fn reach(mode: &str, changed: impl Fn(String) -> String) -> String {
    let file = workspace().join("experiments/high-reach.toml");
    let text = std::fs::read_to_string(file).expect("committed with the sources");
    let (before, after) = text.split_once("[matrix]").expect("it has both modes");
    let (_, profile) = after.split_once("[profile.smoke]").expect("it has a smoke profile");
    let search = before.replace("[search]\n", &format!("[search]\nmode = \"{mode}\"\n"));
    changed(format!("{search}[profile.smoke]{profile}"))
}

/// E-90: both modes begin with one creature that walks already, and it walks there as it did.
#[test]
fn an_exported_creature_is_the_first_skill_of_both_modes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("walk.toml"), reach("fast", |text| text))
        .expect("the folder is writable");
    command::succeed(folder.path(), &["run", "walk.toml", "--profile", "smoke", "--workers", "2"]);
    let best = "SELECT individual FROM v_best WHERE stage = 0";
    let walker = command::count(folder.path(), best).to_string();
    let shown = command::succeed(folder.path(), &["show", &walker, "--json"]);
    let bits = format!("SELECT fitness_bits FROM v_individuals WHERE id = {walker}");
    let walks = command::count(folder.path(), &bits);

    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("walker.json"), shown).expect("the folder is writable");
    let file = workspace().join("experiments/high-reach.toml").display().to_string();
    let run = ["run", &file, "--profile", "smoke", "--workers", "2", "--import", "walker.json"];
    command::succeed(folder.path(), &run);
    let stages = "SELECT experiment, name, individuals FROM v_stages ORDER BY experiment, stage";
    let stages = command::json_lines(folder.path(), &["sql", stages]);
    let of = |mode: u64| stages.iter().filter(move |stage| stage["experiment"] == mode);
    let names = |mode| of(mode).filter_map(|stage| stage["name"].as_str()).collect::<Vec<_>>();
    let [measure, reach] = ["forward_locomotion: measure", "high_reach"];
    assert_eq!(names(1), [measure, reach, "high_reach: measure"]);
    assert_eq!(names(2), [measure, reach, "high_reach: reconcile forward_locomotion", "high_reach: measure"]);
    let walk = "SELECT count(*) FROM v_individuals WHERE stage = 0 AND fitness_bits = ";
    assert_eq!(command::count(folder.path(), &format!("{walk}{walks}")), 2, "it walks in both as it did");
    let parts = "SELECT count(DISTINCT measures ->> 'mass') FROM v_individuals WHERE experiment = 1 \
        AND status = 'completed'";
    assert_eq!(command::count(folder.path(), parts), 1, "in Fast mode its body stays as it is");
    let parts = parts.replace("experiment = 1", "experiment = 2");
    assert!(command::count(folder.path(), &parts) > 1, "in General mode it evolves");
}

/// E-86: a fork with a changed file goes on as if that had been the file from the start.
#[test]
fn a_fork_with_a_changed_file_comes_to_the_lineage_of_that_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).expect("the folder is writable");
    };
    let run =
        |name: &str| command::run(folder.path(), &["run", name, "--profile", "smoke", "--workers", "2"]);
    let changed = reach("general", |text| text.replace("target_height = 10.0", "target_height = 5.0"));
    write("reach.toml", &reach("general", |text| text));
    write("changed.toml", &changed);
    write(
        "walked.toml",
        &reach("general", |text| text.replace("fitness.seconds = 3.0", "fitness.seconds = 2.5")),
    );
    assert_eq!(run("reach.toml").status.code(), Some(0));
    let fork = |name: &str| {
        let fork = ["fork", "1", "--after", "forward_locomotion: measure", name, "--profile", "smoke"];
        command::run(folder.path(), &fork)
    };
    let refused = fork("walked.toml");
    assert_eq!(refused.status.code(), Some(1), "{}", command::printed(&refused));
    let words = command::printed(&refused);
    assert!(words.contains("skill `forward_locomotion` has changed"), "{words}");
    let forked = fork("changed.toml");
    assert_eq!(forked.status.code(), Some(0), "{}", command::printed(&forked));
    let finished = run("changed.toml");
    assert_eq!(finished.status.code(), Some(0), "{}", command::printed(&finished));
    let overrides = Overrides { profile: Some("smoke".to_owned()), set: vec![] };
    let experiment = Experiment::parse(&changed, &overrides).unwrap_or_else(|e| panic!("{e:?}")).remove(0);
    assert_eq!(command::hash(folder.path(), "2"), local::lineage(&experiment.resolved()));
    assert_ne!(command::hash(folder.path(), "1"), command::hash(folder.path(), "2"));
    let own = "SELECT min(stage) FROM v_individuals WHERE experiment = 2";
    assert_eq!(command::count(folder.path(), own), 2, "what is shared is not copied");
}

/// E-83, R-11: a creature that has learned all ten lives anew under a light that a script moves, to the same bits each
/// time, and what is recorded of its light is what the script says.
#[test]
fn a_creature_shows_a_skill_under_a_light_of_ones_own() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.join(name), text).expect("the folder is writable");
    };
    let file = workspace().join("experiments/fight-or-flight.toml").display().to_string();
    command::succeed(folder, &["run", &file, "--profile", "smoke", "--workers", "2"]);
    let last = "SELECT individual FROM v_best ORDER BY stage DESC LIMIT 1";
    let one = command::count(folder, last).to_string();
    let hash = command::hash(folder, "1");
    write(
        "light.toml",
        "height = 0.4\npoint = [{ at = 0, ahead = 3, left = 0 }, { at = 1, ahead = 3, left = 2 }]",
    );
    let lived = |skill: &str, recording: &str| {
        let light = ["replay", &one, "--light", "light.toml", "--skill", skill, "--recording", recording];
        let seen = command::json_lines(folder, &[&light[..], &["--picture", "light.png"]].concat());
        let text = std::fs::read_to_string(folder.join(recording)).expect("it was written");
        (seen, text)
    };
    let (seen, recording) = lived("turn_to_light", "one.jsonl");
    assert_eq!(lived("turn_to_light", "two.jsonl"), (seen.clone(), recording.clone()), "to the same bits");
    assert_eq!(seen.len(), 61);
    let light = |step: usize| seen[step]["light"].as_array().expect("ahead and left").clone();
    for (step, left) in [(0, 0.0), (30, 1.0), (60, 2.0)] {
        let found: Vec<f64> = light(step).iter().filter_map(serde_json::Value::as_f64).collect();
        assert!((found[0] - 3.0).abs() < 1e-9 && (found[1] - left).abs() < 1e-9, "{found:?} at {step}");
    }
    let mut lines =
        recording.lines().map(|line| serde_json::from_str::<serde_json::Value>(line).expect("JSON"));
    let header = lines.next().expect("a header");
    assert_eq!(header["light"]["skill"], "turn_to_light");
    let muscles = header["muscles"].as_array().expect("it has muscles").len();
    assert_eq!(header["cords"].as_array().map(Vec::len), Some(muscles));
    let active = |frame: &serde_json::Value| {
        let all = frame["muscles"][0].as_array().expect("of the one creature").clone();
        assert_eq!(all.len(), muscles);
        all.iter().any(|one| one.as_f64().is_some_and(|one| one > 0.0))
    };
    let frames: Vec<_> = lines.collect();
    assert_eq!(frames.len(), seen.len());
    assert!(frames.iter().filter(|frame| active(frame)).count() > 0, "its skill drives muscles");
    assert!(folder.join("light.png").metadata().is_ok_and(|picture| picture.len() > 1000));

    write("bad.toml", "point = [\n{ at = 0, ahead = 3, left = 0 },\n{ at = 0, ahead = 3, left = 2 }]");
    let refused = |rest: &[&str], code: i32, words: &str| {
        let output = command::run(folder, &[&["replay", &one, "--light"], rest].concat());
        let said = command::printed(&output);
        assert_eq!((output.status.code(), said.contains(words)), (Some(code), true), "{rest:?}: {said}");
    };
    refused(&["bad.toml"], 2, "bad.toml:3:8: error: `point[1].at`");
    refused(&["none.toml"], 3, "none.toml");
    refused(&["light.toml", "--skill", "turn_to_lihgt"], 3, "did you mean `turn_to_light`?");
    refused(&["light.toml", "--trial", "1"], 2, "--trial");
    command::succeed(folder, &["replay", &one]);
    assert!(command::succeed(folder, &["show", &one]).contains(&one));
    assert_eq!(command::hash(folder, "1"), hash, "nothing was written into the lineage");
}
