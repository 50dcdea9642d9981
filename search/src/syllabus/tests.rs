//! The search against made-up outcomes: what a creature scores follows from its body and the skill's control, as
//! in a life. Nothing here steps a creature.

use super::*;
use crate::{Individual, PickError, PickedBy, Place, Stage};
use creatures::esp::genotype::Genotype;
use creatures::esp::syllabus::SkillId;
use creatures::{Outcome, Reason, Status, encoding};
use proptest::prelude::*;
use serde_json::{Map, json};
use std::collections::BTreeMap;

mod amending;
mod file;
mod general;
mod places;

/// The ten skills of the paper, small.
fn ten_skills(search: Value) -> Value {
    let mut table: Map<String, Value> =
        serde_json::from_str(include_str!("../../../creatures/src/esp/syllabus/ten_skills.json")).unwrap();
    table.extend(match search {
        Value::Object(search) => search,
        _ => unreachable!("settings are a table"),
    });
    for (key, value) in [
        ("populations", json!(2)),
        ("population", json!(6)),
        ("generations", json!(3)),
        ("elites", json!(2)),
        ("reconcile_generations", json!(2)),
        ("keep_candidates", json!(3)),
    ] {
        table.entry(key).or_insert(value);
    }
    Value::Object(table)
}

fn settings(search: Value) -> Settings {
    Settings::read(ten_skills(search)).unwrap()
}

/// What a creature scores in a skill, within [0, 1): of its body and the control, whatever its seal.
fn score(genotype: &Genotype, skill: &str, skills: &[String]) -> f64 {
    let id = SkillId(skills.iter().position(|name| name == skill).unwrap() as u16);
    let control = genotype.brain.control(id).unwrap();
    let known = encoding::encode(&(&genotype.body, &control.nodes, &control.outputs));
    let hash = u32::from_le_bytes(*blake3::hash(&known).as_bytes().first_chunk().unwrap());
    f64::from(hash) / 4_294_967_296.0
}

/// The outcome of an examination.
fn examine(genotype: &[u8], task: &Value) -> Outcome {
    let genotype = Genotype::decode(genotype).unwrap();
    let list = |key: &str| task[key].as_array().unwrap().clone();
    let skills: Vec<String> =
        list("skill").iter().map(|skill| skill["id"].as_str().unwrap().to_owned()).collect();
    let (mut measures, mut fitness, mut stopped, mut tests) = (Vec::new(), 0.0, -1.0, 0.0);
    for (index, test) in list("tests").iter().enumerate() {
        let name = test["skill"].as_str().unwrap();
        fitness = score(&genotype, name, &skills);
        tests += 1.0;
        measures.push((format!("score.{name}"), fitness));
        if name == "strike" {
            measures.push(("impact.strike".to_owned(), 1.0 + fitness));
        }
        if test["stop_below"].as_f64().is_some_and(|least| fitness < least) {
            (stopped, fitness) = (index as f64, 0.0);
            break;
        }
    }
    for (name, value) in [
        ("trial.0", fitness),
        ("trial.1", fitness),
        ("tests", tests),
        ("trials", 2.0 * tests),
        ("stopped_by", stopped),
    ] {
        measures.push((name.to_owned(), value));
    }
    let steps = 100 * tests as u32;
    Outcome { status: Status::Completed, fitness, steps, measures, interim: None, note: String::new() }
}

/// A search that is driven to its end, and what it did on the way.
struct Run {
    search: Box<dyn Search>,
    /// By place; stages by their number.
    individuals: BTreeMap<Place, Individual>,
    outcomes: BTreeMap<Place, Option<Outcome>>,
    stages: Vec<Stage>,
    notes: Vec<(Stage, Map<String, Value>)>,
    picks: Vec<Choice>,
}

use crate::{Choice, Parent};

impl Run {
    fn new(search: Box<dyn Search>) -> Run {
        let (individuals, outcomes) = (BTreeMap::new(), BTreeMap::new());
        Run { search, individuals, outcomes, stages: vec![], notes: vec![], picks: vec![] }
    }

    /// One generation, or a pick; false at the end.
    fn step(&mut self) -> bool {
        let asked = self.search.ask();
        if asked.is_empty() {
            let Some(choice) = self.search.choice() else { return false };
            self.search.pick(choice.candidates[0].place).unwrap();
            self.picks.push(choice);
            return true;
        }
        let stage = self.search.stage();
        if self.stages.last().map(|stage| stage.number) != Some(stage.number) {
            self.stages.push(stage.clone());
        }
        let generation =
            self.individuals.keys().filter(|place| place.stage == stage.number).map(|place| place.generation);
        let generation = generation.max().unwrap_or(0) + 1;
        let mut outcomes = Vec::new();
        for (index, individual) in (0..).zip(asked) {
            let place = Place { stage: stage.number, generation, index };
            let outcome = match individual.inherits {
                Some(from) => {
                    assert_eq!(from.stage, place.stage, "outcomes are inherited within a stage");
                    assert_eq!(self.individuals[&from].genotype, individual.genotype);
                    self.outcomes[&from].clone()
                }
                None => Some(examine(&individual.genotype, stage.task.as_ref().unwrap())),
            };
            for Parent { place: parent, .. } in &individual.parents {
                assert!(self.individuals.contains_key(parent), "{place:?} has a parent at {parent:?}");
            }
            self.individuals.insert(place, individual);
            self.outcomes.insert(place, outcome.clone());
            outcomes.push(outcome);
        }
        let record = self.search.tell(&outcomes);
        self.notes.push((stage, record.notes));
        true
    }

    fn finish(mut self) -> Run {
        while self.step() {}
        self
    }

    fn of(&self, stage: u32) -> impl Iterator<Item = (&Place, &Individual)> {
        self.individuals.iter().filter(move |(place, _)| place.stage == stage)
    }

    fn genotype(&self, place: Place) -> Genotype {
        Genotype::decode(&self.individuals[&place].genotype).unwrap()
    }

    /// The sum of a note over all generations.
    fn sum(&self, key: &str) -> u64 {
        self.notes.iter().filter_map(|(_, notes)| notes.get(key)?.as_u64()).sum()
    }
}

fn run(search: Value) -> Run {
    Run::new(settings(search).start(7, 0)).finish()
}

/// The skills that a stage tests, with the least that lets an individual go on.
fn tested(stage: &Stage) -> Vec<(&str, Option<f64>)> {
    let tests = stage.task.as_ref().unwrap()["tests"].as_array().unwrap();
    tests.iter().map(|test| (test["skill"].as_str().unwrap(), test["stop_below"].as_f64())).collect()
}

fn names(stages: &[Stage]) -> Vec<&str> {
    stages.iter().map(|stage| stage.name.as_str()).collect()
}

/// E-56, E-66: in Fast mode each skill is evolved and measured, in the file's order.
#[test]
fn fast_mode_learns_the_ten_skills_in_order() {
    let run = run(json!({}));
    let skills = [
        "forward_locomotion",
        "left_turn",
        "right_turn",
        "turn_to_light",
        "move_to_light",
        "strike",
        "attack",
        "turn_from_light",
        "retreat",
        "fight_or_flight",
    ];
    let expected: Vec<String> =
        skills.iter().flat_map(|skill| [(*skill).to_owned(), format!("{skill}: measure")]).collect();
    assert_eq!(names(&run.stages), expected);
    assert!(run.stages.iter().zip(0..).all(|(stage, number)| stage.number == number));
    assert_eq!(run.picks.len(), 10);
    assert!(run.search.failure().is_none());
    let plan = settings(json!({}));
    assert_eq!(plan.individuals(), run.individuals.len() as u64);
    assert_eq!(plan.generations() as usize, run.notes.len());
    // What attacks knows how hard its creature strikes.
    let attack = run.stages.iter().find(|stage| stage.name == "attack").unwrap();
    let measured = run.stages.iter().find(|stage| stage.name == "strike: measure").unwrap().number;
    let place = Place { stage: measured, generation: 1, index: 0 };
    let impact = learned::measure(run.outcomes[&place].as_ref().unwrap(), "impact.strike").unwrap();
    assert_eq!(attack.task.as_ref().unwrap()["impacts"], json!({ "strike": impact }));
}

/// E-59, E-60: once the first skill is learned, the body and all that is locked stay as they are, and only the new
/// skill is tested; R-3: as many tests at every stage.
#[test]
fn fast_mode_locks_what_was_learned_and_tests_the_new_skill_alone() {
    let run = run(json!({}));
    let body = run.genotype(Place { stage: 1, generation: 1, index: 0 });
    for (place, _) in run.individuals.iter().filter(|(place, _)| place.stage > 1) {
        let genotype = run.genotype(*place);
        assert_eq!(genotype.brain.controls[0], body.brain.controls[0]);
        assert_eq!(genotype.body.segments.len(), body.body.segments.len());
    }
    for stage in run.stages.iter().filter(|stage| !stage.name.ends_with("measure")) {
        assert_eq!(tested(stage), [(stage.name.as_str(), None)]);
    }
    let fresh = run.individuals.values().filter(|individual| individual.inherits.is_none()).count() as u64;
    let measured: u64 = (1..=10).sum();
    assert_eq!(run.sum("tests_new"), fresh - 10, "the creatures that were measured are counted apart");
    assert_eq!(run.sum("tests_measure"), measured);
    assert_eq!((run.sum("tests_retest"), run.sum("tests_reconcile")), (0, 0));
    assert_eq!(run.sum("trials"), 2 * (fresh - 10 + measured));
}

/// E-37: the best of each population pass unchanged with their outcome, and are parents of others.
#[test]
fn elites_pass_unchanged_and_are_not_evaluated_again() {
    let run = run(json!({ "elites": 2 }));
    for stage in run.stages.iter().filter(|stage| !stage.name.ends_with("measure")) {
        for generation in 2..=3 {
            for population in 0..2 {
                let at = |generation, offset| Place {
                    stage: stage.number,
                    generation,
                    index: 6 * population + offset,
                };
                let fitness = |place: &Place| run.outcomes[place].as_ref().unwrap().fitness;
                let mut before: Vec<f64> =
                    (0..6).map(|offset| fitness(&at(generation - 1, offset))).collect();
                before.sort_by(|a, b| b.total_cmp(a));
                for (elite, best) in before.iter().enumerate().take(2) {
                    let place = at(generation, elite as u32);
                    assert_eq!(fitness(&place), *best);
                    assert_eq!(run.individuals[&place].operator, "elite");
                    assert!(run.individuals[&place].inherits.is_some());
                }
                for offset in 0..6 {
                    let individual = &run.individuals[&at(generation, offset)];
                    let own = |parent: &Parent| parent.place.index / 6 == population;
                    assert!(individual.parents.iter().all(own), "populations do not mix");
                    assert_eq!(individual.traits["population"], json!(population + 1));
                }
            }
        }
    }
}

/// E-81, E-82: the candidates are the best of every population that differ, the best first; the picked one's
/// genotype is what every later creature carries.
#[test]
fn candidates_are_the_best_that_differ_and_the_picked_one_goes_on() {
    let run = run(json!({}));
    let first = &run.picks[0];
    assert_eq!(first.by, PickedBy::Best);
    assert_eq!(first.candidates.len(), 6, "three of each population");
    let best = run.of(0).map(|(place, _)| run.outcomes[place].as_ref().unwrap().fitness).fold(0.0, f64::max);
    assert_eq!(first.candidates[0].fitness, best);
    assert!(first.candidates.windows(2).all(|pair| pair[0].fitness >= pair[1].fitness));
    let mut genotypes: Vec<_> =
        first.candidates.iter().map(|candidate| &run.individuals[&candidate.place].genotype).collect();
    genotypes.sort();
    genotypes.dedup();
    assert_eq!(genotypes.len(), 6);
    let notes = &first.candidates[0].notes;
    for key in ["population", "trial.0", "trial.1", "parts", "muscles", "receptors", "nodes"] {
        assert!(notes.contains_key(key), "{notes:?}");
    }
    let measured = run.genotype(Place { stage: 1, generation: 1, index: 0 });
    let mut picked = run.genotype(first.candidates[0].place);
    picked.encapsulate(SkillId(0));
    assert_eq!(measured, picked);
}

/// E-82, EF-14
#[test]
fn a_person_may_pick_any_candidate_and_nobody_else() {
    let mut run = Run::new(settings(json!({ "pick": "human" })).start(7, 0));
    let nobody = Place { stage: 9, generation: 9, index: 9 };
    assert_eq!(run.search.pick(nobody), Err(PickError::NotAwaited));
    while run.search.choice().is_none() {
        assert!(run.step());
    }
    let choice = run.search.choice().unwrap();
    assert_eq!(choice.by, PickedBy::Human);
    assert!(run.search.ask().is_empty());
    let before = run.search.checkpoint();
    assert_eq!(run.search.pick(nobody), Err(PickError::NoCandidate(nobody)));
    assert_eq!(run.search.checkpoint(), before, "a refused pick changes nothing");
    let third = choice.candidates[2].place;
    run.search.pick(third).unwrap();
    let measured = run.search.ask().remove(0);
    assert_eq!(measured.parents, [Parent { place: third, role: "only".to_owned() }]);
    assert_eq!(run.search.pick(third), Err(PickError::NotAwaited));
}

/// E-82
#[test]
fn a_stage_that_does_not_reach_what_is_required_ends_the_search() {
    let mut table = ten_skills(json!({}));
    table["skill"][1]["require"] = json!(1.5);
    let run = Run::new(Settings::read(table).unwrap().start(7, 0)).finish();
    assert_eq!(names(&run.stages), ["forward_locomotion", "forward_locomotion: measure", "left_turn"]);
    let failure = run.search.failure().unwrap();
    assert!(
        failure.starts_with("stage `left_turn`: the best fitness is 0.") && failure.contains("1.5"),
        "{failure}"
    );
    assert!(run.search.choice().is_none());
}

/// E-43, E-81: phases are stages of their own with their own fitness, survivors are scored anew, and only the last
/// stage has candidates.
#[test]
fn shaping_is_a_stage_with_parameters_of_its_own() {
    let mut table = ten_skills(json!({ "generations": 5 }));
    table["skill"][0]["phase"] = json!([{ "share": 0.4, "seconds": 5.0, "speed_step": 0.01 }]);
    let mut run = Run::new(Settings::read(table).unwrap().start(7, 0));
    while run.picks.is_empty() {
        run.step();
    }
    assert_eq!(names(&run.stages), ["forward_locomotion: phase 1", "forward_locomotion"]);
    assert_eq!(run.stages.iter().map(|stage| stage.generations).collect::<Vec<_>>(), [Some(2), Some(3)]);
    let test = |stage: usize| run.stages[stage].task.as_ref().unwrap()["tests"][0].clone();
    assert_eq!(test(0)["fitness"]["seconds"], 5.0);
    assert_eq!(test(0)["fitness"]["speed_max"], 3.0, "the rest is the skill's own");
    assert_eq!(test(1)["fitness"]["seconds"], 10.0);
    let survivor = &run.individuals[&Place { stage: 1, generation: 1, index: 0 }];
    assert_eq!((survivor.operator.as_str(), survivor.inherits), ("elite", None));
    assert_eq!(survivor.parents[0].place.stage, 0);
    assert!(run.picks[0].candidates.iter().all(|candidate| candidate.place.stage == 1));
}

/// EF-10: who blows up, or is set aside, is no parent and no candidate.
#[test]
fn the_aborted_are_no_parents_and_no_candidates() {
    let mut search = settings(json!({ "populations": 1 })).start(7, 0);
    let founders = search.ask();
    let task = search.stage().task.unwrap();
    let mut outcomes: Vec<Option<Outcome>> =
        founders.iter().map(|founder| Some(examine(&founder.genotype, &task))).collect();
    for outcome in outcomes.iter_mut().skip(1).flatten() {
        (outcome.status, outcome.fitness) = (Status::Aborted(Reason::BlowUp), 0.0);
    }
    outcomes[2] = None;
    outcomes[0].as_mut().unwrap().fitness = -1.0; // worse than theirs, and yet the only one
    search.tell(&outcomes);
    let children = search.ask();
    assert!(children.iter().flat_map(|child| &child.parents).all(|parent| parent.place.index == 0));
    assert_eq!(children.iter().filter(|child| child.operator == "elite").count(), 1);
    // Nobody fit at all: the stage says so.
    let mut search = settings(json!({ "populations": 1 })).start(7, 0);
    while search.failure().is_none() {
        let count = search.ask().len();
        search.tell(&vec![None; count]);
    }
    assert!(search.failure().unwrap().contains("no individual was fit"));
}

/// E-85, T-13: from every checkpoint the search goes on to the same individuals.
#[test]
fn from_every_checkpoint_the_search_goes_on_as_if_nothing_had_happened() {
    for mode in ["fast", "general"] {
        let plan = settings(json!({ "mode": mode, "generations": 2 }));
        let whole = Run::new(plan.start(7, 0)).finish();
        let mut kept = Run::new(plan.start(7, 0));
        let mut going = true;
        while going {
            going = kept.step();
            let checkpoint = kept.search.checkpoint();
            kept.search = plan.restore(7, 0, &checkpoint).unwrap();
            assert_eq!(kept.search.checkpoint(), checkpoint);
        }
        assert_eq!(kept.individuals, whole.individuals, "{mode}");
        assert_eq!((kept.picks, kept.notes), (whole.picks, whole.notes));
    }
}

/// E-84, EF-13: what is no checkpoint of this syllabus is refused.
#[test]
fn a_damaged_checkpoint_is_refused() {
    let plan = settings(json!({}));
    let mut run = Run::new(plan.start(7, 0));
    for _ in 0..6 {
        run.step();
    }
    let checkpoint = run.search.checkpoint();
    assert!(plan.restore(7, 0, &checkpoint).is_ok());
    for cut in [1, checkpoint.len() / 2, checkpoint.len() - 1] {
        assert!(plan.restore(7, 0, &checkpoint[..cut]).is_err());
    }
    let larger = settings(json!({ "population": 8 }));
    assert!(larger.restore(7, 0, &checkpoint).is_err());
}

/// E-84: a population of 200 at the tenth skill stays small, since what is locked is written once.
#[test]
fn a_checkpoint_writes_what_is_locked_once() {
    let plan = settings(json!({ "populations": 1, "population": 200, "generations": 1 }));
    let mut run = Run::new(plan.start(7, 0));
    while run.stages.last().is_none_or(|stage| stage.name != "fight_or_flight") {
        assert!(run.step());
    }
    let whole: usize = run.of(run.stages.last().unwrap().number).map(|(_, one)| one.genotype.len()).sum();
    let written = run.search.checkpoint().len();
    assert!(written < whole / 2 && written < 5 << 20, "{written} bytes of {whole}");
}

/// E-90
#[test]
fn a_creature_may_bring_the_first_skill_along() {
    let mut first = Run::new(settings(json!({})).start(7, 0));
    while first.stages.len() < 3 {
        first.step();
    }
    let learned = &first.individuals[&Place { stage: 1, generation: 1, index: 0 }].genotype;
    // Evolution of a second skill has begun in this one, which is left out.
    let later = &first.individuals[&Place { stage: 2, generation: 1, index: 0 }].genotype;
    for creature in [learned, later] {
        let run = run(json!({ "import": Import::of(creature) }));
        assert_eq!(names(&run.stages)[..2], ["forward_locomotion: measure", "left_turn"]);
        let brought = &run.individuals[&Place { stage: 0, generation: 1, index: 0 }];
        assert_eq!((&brought.genotype, brought.operator.as_str()), (learned, "import"));
        assert_eq!(run.stages.len(), 19);
    }
    let refused = |text: &str| Settings::read(ten_skills(json!({ "import": text }))).unwrap_err().to_string();
    assert_eq!(refused("xyz"), "`import`: is no genotype in hexadecimal");
    assert!(refused("00").starts_with("`import`: genotype"), "{}", refused("00"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// Whatever outcomes come, the search neither panics nor asks for illegal creatures.
    #[test]
    fn no_outcome_makes_the_search_panic(draws in prop::collection::vec(0u8..6, 200), general in any::<bool>()) {
        let mode = if general { "general" } else { "fast" };
        let plan = settings(json!({ "mode": mode, "population": 3, "generations": 2, "elites": 1 }));
        let mut search = plan.start(3, 0);
        let mut draws = draws.into_iter();
        loop {
            let asked = search.ask();
            if asked.is_empty() {
                let Some(choice) = search.choice() else { break };
                search.pick(choice.candidates.last().unwrap().place).unwrap();
                continue;
            }
            let task = search.stage().task.unwrap();
            let outcomes: Vec<Option<Outcome>> = asked.iter().map(|individual| {
                let mut outcome = examine(&individual.genotype, &task);
                match draws.next() {
                    None | Some(0..=2) => {}
                    Some(3) => return None,
                    Some(4) => outcome.measures.clear(),
                    Some(_) => outcome.fitness = f64::NAN,
                }
                Some(outcome)
            }).collect();
            search.tell(&outcomes);
            prop_assert!(plan.restore(3, 0, &search.checkpoint()).is_ok());
        }
    }
}
