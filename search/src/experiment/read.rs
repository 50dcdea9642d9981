//! From the tree to experiments: profile, assignments and matrix laid over it, then table by table into
//! types. It goes on after a problem as long as that makes sense, so that one reading finds them all.

use super::problem::{Problem, join};
use super::tree::{Content, Node};
use super::{Experiment, Overrides, Published, matrix, overrides};
use crate::culling::Culling;
use crate::registry;
use crate::settings::check;
use creatures::{SpecError, System, read_spec};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The largest seed: TOML's whole numbers end here.
const SEED_MAX: u64 = i64::MAX as u64;
/// The most repetitions.
const RUNS_MAX: u32 = 100_000;
/// The longest name, bytes.
const NAME_MAX: usize = 128;

/// The file without its profiles and matrix. Tables that have readers of their own stay values.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Top {
    name: String,
    system: String,
    #[serde(default)]
    group: Option<String>,
    #[serde(default = "first_seed")]
    seed: u64,
    #[serde(default)]
    runs: Option<u32>,
    #[serde(default)]
    audit: f64,
    #[serde(default)]
    cell: BTreeMap<String, Value>,
    #[serde(default)]
    published: Vec<Published>,
    // Known keys whose values are read elsewhere.
    #[serde(default, rename = "task")]
    _task: IgnoredAny,
    #[serde(default, rename = "search")]
    _search: IgnoredAny,
    #[serde(default, rename = "culling")]
    _culling: IgnoredAny,
    #[serde(default, rename = "profile")]
    _profile: IgnoredAny,
    #[serde(default, rename = "matrix")]
    _matrix: IgnoredAny,
    #[serde(default, rename = "skill")]
    _skill: IgnoredAny,
    #[serde(default, rename = "pandemonium")]
    _pandemonium: IgnoredAny,
}

fn first_seed() -> u64 {
    1
}

impl Top {
    fn check(self) -> Result<Top, SpecError> {
        if self.seed > SEED_MAX - u64::from(RUNS_MAX) {
            return Err(SpecError::new(
                "seed",
                format!("{} leaves no room for the seeds of runs", self.seed),
            ));
        }
        if let Some(runs) = self.runs {
            check("runs", runs, 1..=RUNS_MAX)?;
        }
        if !(0.0..=1.0).contains(&self.audit) {
            return Err(SpecError::new("audit", format!("{} is not within [0, 1]", self.audit)));
        }
        // Last: a file whose name is left out cannot be read on.
        let names = [("name", Some(&self.name)), ("group", self.group.as_ref())];
        for (key, name) in names.into_iter().filter_map(|(key, name)| Some((key, name?))) {
            let letters = |letter: char| letter.is_ascii_alphanumeric() || "-_./".contains(letter);
            let legal = name.starts_with(|first: char| first.is_ascii_alphabetic())
                && name.chars().all(letters)
                && name.len() <= NAME_MAX
                && name != "last"; // the word for the newest experiment
            if !legal {
                let problem = format!(
                    "`{name}` is no name: a letter, then letters, digits, `-`, `_`, `.` and `/`, at most \
                     {NAME_MAX}, and not `last`"
                );
                return Err(SpecError::new(key, problem));
            }
        }
        Ok(self)
    }
}

/// See [`Experiment::parse`].
pub(super) fn experiments(text: &str, over: &Overrides) -> Result<Vec<Experiment>, Vec<Problem>> {
    let mut tree = Node::parse(text)?;
    let profile =
        overrides::lay_profile(&mut tree, over.profile.as_deref(), text).map_err(|problem| vec![problem])?;
    let wrong: Vec<Problem> =
        over.set.iter().filter_map(|(key, value)| overrides::assign(&mut tree, key, value).err()).collect();
    if !wrong.is_empty() {
        return Err(wrong);
    }
    let matrix = tree.table_mut().and_then(|table| table.remove("matrix"));
    let mut reading = Reading { text, problems: Vec::new() };
    let experiments = match matrix {
        None => vec![reading.experiment(tree, profile)],
        Some(matrix) => {
            let cells = matrix::cells(&matrix, text)?;
            cells.iter().map(|cell| reading.cell(&tree, cell, &cells, profile.clone())).collect()
        }
    };
    if reading.problems.is_empty() {
        // None would have left a problem.
        return Ok(experiments.into_iter().flatten().collect());
    }
    Err(reading.sorted())
}

/// See [`super::read_table`].
pub(super) fn table<T>(text: &str, read: impl Fn(Value) -> Result<T, SpecError>) -> Result<T, Vec<Problem>> {
    let mut tree = Node::parse(text)?;
    let mut reading = Reading { text, problems: Vec::new() };
    reading.table("", &mut tree, read).ok_or_else(|| reading.sorted())
}

/// A reading under way, with what it has found wrong so far.
struct Reading<'a> {
    text: &'a str,
    problems: Vec<Problem>,
}

impl Reading<'_> {
    /// All problems in the order of the text.
    fn sorted(mut self) -> Vec<Problem> {
        self.problems
            .sort_by_key(|problem| (problem.span.as_ref().map(|span| span.start), problem.key.clone()));
        self.problems.dedup(); // cells share most of their text
        self.problems
    }

    fn cell(
        &mut self,
        tree: &Node,
        cell: &matrix::Cell,
        all: &[matrix::Cell],
        profile: Option<String>,
    ) -> Option<Experiment> {
        let mut tree = tree.clone();
        cell.apply(&mut tree, self.text).map_err(|problem| self.problems.push(problem)).ok()?;
        drop_settings_of_other_cells(&mut tree, cell, all);
        let experiment = self.experiment(tree, profile)?;
        let group = experiment.name;
        let name = format!("{group}/{}", cell.name);
        if name.len() > NAME_MAX {
            self.problems.push(Problem::new("matrix", format!("cell `{name}` is over {NAME_MAX} bytes")));
        }
        Some(Experiment { name, group: Some(group), cell: cell.coordinates.clone(), ..experiment })
    }

    /// Reads a tree without matrix and profiles; none if that leaves problems.
    fn experiment(&mut self, tree: Node, profile: Option<String>) -> Option<Experiment> {
        let before = self.problems.len();
        let part = |key: &str| tree.table().and_then(|table| table.get(key)).cloned();
        let mut top_tree = tree.clone();
        let top = self.table("", &mut top_tree, |table| read_spec::<Top>(table)?.check());
        let name = top.as_ref().map(|top| top.system.as_str());
        if name.is_none() && part("system").is_none() {
            self.help_with_system();
        }
        let system = name.or_else(|| string(&tree, "system")).and_then(|name| self.system(&tree, name));

        let culling = part("culling").and_then(|mut table| {
            self.table("culling", &mut table, |table| {
                let culling: Culling = read_spec(table)?;
                culling.check().map(|()| culling)
            })
        });
        let mut search = part("search").unwrap_or_else(Node::empty);
        let kind = system.and_then(|system| {
            let kind = registry::kind(&search.value(), system.name());
            kind.map_err(|error| self.refuse("search", &search, &error)).ok()
        });
        let lists = kind.map_or(&[][..], |kind| kind.lists);
        self.refuse_other_lists(&tree, kind);
        let mut task_tree = part("task").unwrap_or_else(Node::empty);
        // Where the search says the task, it is read first; else a search is read for its task.
        let task = system
            .filter(|_| lists.is_empty())
            .and_then(|system| self.table("task", &mut task_tree, |task| system.resolve(task)));
        for list in lists {
            if let (Some(table), Some(rows)) = (search.table_mut(), part(list)) {
                table.insert((*list).to_owned(), rows);
            }
        }
        let known = if lists.is_empty() { task.as_ref() } else { Some(&Value::Null) };
        let plan = kind.zip(known).and_then(|(kind, task)| {
            let read = |table: Value| {
                if !table.is_object() {
                    return Err(SpecError::new("", "expected a table"));
                }
                kind.plan(table, task)
            };
            self.table("search", &mut search.clone(), read)
        });
        let says_task = lists.is_empty();
        let task = match plan.as_ref().and_then(|plan| plan.task()) {
            Some(task) => system.and_then(|system| {
                let resolved = system.resolve(task);
                resolved.map_err(|error| self.refuse("", &search, &error)).ok()
            }),
            None => task,
        };
        let (Some(top), Some(task), Some(kind), Some(plan)) = (top, task, kind, plan) else { return None };
        (self.problems.len() == before).then(|| Experiment {
            name: top.name,
            group: top.group,
            profile,
            cell: top.cell,
            system: top.system,
            seed: top.seed,
            runs: top.runs.unwrap_or(kind.runs),
            audit: top.audit,
            task,
            says_task,
            kind,
            plan: Arc::from(plan),
            culling,
            published: top.published,
        })
    }

    /// Notes tables at the top that belong to other kinds of search, and a `[task]` where the search says it.
    fn refuse_other_lists(&mut self, tree: &Node, kind: Option<&registry::Kind>) {
        let Some(kind) = kind else { return };
        let present = |key: &&str| tree.table().is_some_and(|table| table.contains_key(*key));
        let lists = registry::KINDS.iter().flat_map(|kind| kind.lists);
        for list in lists.filter(|list| present(list) && !kind.lists.contains(list)) {
            let problem = format!("is no part of a search of kind `{}`", kind.name);
            self.refuse("", tree, &SpecError::new(*list, problem));
        }
        if !kind.lists.is_empty() && present(&"task") {
            let lists = kind.lists.join("]] and [[");
            let problem = format!("is not written: the task of each stage follows from [[{lists}]]");
            self.refuse("", tree, &SpecError::new("task", problem));
        }
        if !kind.lists.is_empty() && present(&"culling") {
            let problem =
                "is not for creatures that are examined skill by skill: retests stop those that fail";
            self.refuse("", tree, &SpecError::new("culling", problem));
        }
    }

    fn system(&mut self, tree: &Node, name: &str) -> Option<&'static dyn System> {
        let system = creatures::system(name);
        if system.is_none() {
            let known = creatures::systems().map(|system| format!("`{}`", system.name())).join(", ");
            let problem = format!("unknown variant `{name}`, expected one of {known}");
            self.refuse("", tree, &SpecError::new("system", problem));
        }
        system
    }

    fn help_with_system(&mut self) {
        let missing = self.problems.iter_mut().find(|problem| problem.key == "system");
        if let Some(problem) = missing {
            let known = creatures::systems().map(System::name).join(", ");
            problem.help = Some(format!("it is one of {known}"));
        }
    }

    /// Reads a table into its type. A key that is wrong is noted and left out, and the rest is read on; a
    /// value comes back only if nothing was left out.
    fn table<T>(
        &mut self,
        prefix: &str,
        tree: &mut Node,
        read: impl Fn(Value) -> Result<T, SpecError>,
    ) -> Option<T> {
        let before = self.problems.len();
        loop {
            let error = match read(tree.value()) {
                Ok(value) => return (self.problems.len() == before).then_some(value),
                Err(error) => error,
            };
            // What is missing now may be what was left out before.
            let missing = is_missing(&error);
            if !missing || self.problems.len() == before {
                self.refuse(prefix, tree, &error);
                if missing {
                    self.help_with_missing(&read, &error);
                }
            }
            if missing || error.path.is_empty() || !tree.remove(&error.path) {
                return None;
            }
        }
    }

    /// Notes a table's error at its place in the text: an unknown key points at the key, all else at the
    /// value. What is missing from a table that is not written either points at the file's beginning; a key
    /// from outside has no place.
    fn refuse(&mut self, prefix: &str, tree: &Node, error: &SpecError) {
        let found = tree.find(&error.path);
        let span = match (&found.span, &found.key) {
            (Some(_), Some(key)) if error.problem.starts_with("unknown field") => Some(key.clone()),
            (None, _) if is_missing(error) => Some(0..0),
            (span, _) => span.clone(),
        };
        // Lists are read with a search's table, and stand beside it.
        let list = |list: &&str| {
            error.path.strip_prefix(*list).is_some_and(|rest| rest.is_empty() || rest.starts_with(['[', '.']))
        };
        let at_top = registry::KINDS.iter().flat_map(|kind| kind.lists).any(list);
        let prefix = if at_top { "" } else { prefix };
        self.problems.push(Problem::of_table(prefix, error).at(self.text, span));
    }

    /// Says what a missing key may hold: its reader is asked what it makes of a value that is surely wrong.
    fn help_with_missing<T>(&mut self, read: &impl Fn(Value) -> Result<T, SpecError>, error: &SpecError) {
        let key = error.problem.trim_start_matches("missing field ").trim_matches('`');
        let Err(answer) = read(serde_json::json!({ key: "?" })) else { return };
        let allowed = Problem::of_table("", &answer);
        if let Some(problem) = self.problems.last_mut()
            && answer.path == join(&error.path, key)
        {
            problem.help = allowed.help;
        }
    }
}

/// Whether a table lacks a key, in serde's words or in a reader's own.
fn is_missing(error: &SpecError) -> bool {
    error.problem.starts_with("missing field") || error.problem.starts_with("is missing")
}

fn string<'a>(tree: &'a Node, key: &str) -> Option<&'a str> {
    match &tree.table()?.get(key)?.content {
        Content::Scalar(Value::String(text)) => Some(text),
        _ => None,
    }
}

/// In a matrix over kinds of search each kind's settings stand side by side, and a cell takes its own. Those
/// of kinds that the matrix does not name stay, and are errors.
fn drop_settings_of_other_cells(tree: &mut Node, cell: &matrix::Cell, all: &[matrix::Cell]) {
    let kind_of =
        |cell: &matrix::Cell| cell.coordinates.get("search.kind").and_then(Value::as_str).map(str::to_owned);
    let own = kind_of(cell);
    let Some(search) = tree.table_mut().and_then(|table| table.get_mut("search")).and_then(Node::table_mut)
    else {
        return;
    };
    for kind in all.iter().filter_map(kind_of).filter(|kind| Some(kind) != own.as_ref()) {
        search.remove(&kind);
    }
}
