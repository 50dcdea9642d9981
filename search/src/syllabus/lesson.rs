//! How one skill is evolved: what its row of an experiment file says beside what a creature's task needs (ESP
//! E-43, E-82, E-88). It evolves nothing.

use super::regime::Regime;
use crate::settings::{check, object, within, write};
use creatures::esp::fitness::Fitness;
use creatures::esp::syllabus::SkillTable;
use creatures::{SpecError, read_spec};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Keys of a skill that are a task's.
const TASK_KEYS: [&str; 7] = ["id", "uses", "grow", "sensors", "drive_body", "body", "fitness"];
/// Keys of a skill that only the search knows, and that no default stands for.
const OWN_KEYS: [&str; 2] = ["phase", "require"];

/// How a skill is evolved.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Lesson {
    pub(super) regime: Regime,
    rows: Vec<PhaseRow>,
    /// The fitness that the best has to reach, or the search ends there.
    pub(super) require: Option<f64>,
    phases: Vec<Phase>,
}

/// One phase of shaping as written: its share, and parameters of fitness that it overrides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct PhaseRow {
    share: f64,
    #[serde(flatten)]
    parameters: Map<String, Value>,
}

/// One phase of shaping, settled.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Phase {
    pub(super) generations: u32,
    /// The whole table of the fitness that counts in it.
    pub(super) fitness: Value,
}

impl Lesson {
    /// Parts a skill's row. The phases are not yet settled: their fitness is read once the skill's is.
    pub(super) fn read(row: Value, defaults: &Map<String, Value>) -> Result<(SkillTable, Lesson), SpecError> {
        let (mut task, mut own, mut regime) = (Map::new(), Map::new(), defaults.clone());
        for (key, value) in object(row)? {
            let table = if TASK_KEYS.contains(&key.as_str()) {
                &mut task
            } else if OWN_KEYS.contains(&key.as_str()) {
                &mut own
            } else if defaults.contains_key(&key) {
                &mut regime
            } else {
                let keys = defaults.keys().map(String::as_str);
                let known: Vec<_> =
                    TASK_KEYS.into_iter().chain(OWN_KEYS).chain(keys).map(|key| format!("`{key}`")).collect();
                let problem = format!("unknown field `{key}`, expected one of {}", known.join(", "));
                return Err(SpecError::new(key, problem));
            };
            table.insert(key, value);
        }
        let skill: SkillTable = read_spec(Value::Object(task))?;
        let Own { phase: rows, require } = read_spec(Value::Object(own))?;
        let regime: Regime = read_spec(Value::Object(regime))?;
        regime.check()?;
        if let Some(require) = require {
            check("require", require, -1e9..=1e9)?;
        }
        Ok((skill, Lesson { regime, rows, require, phases: Vec::new() }))
    }

    /// Works out the phases: each takes its share of the generations, rounded down and at least 1, and what it
    /// does not override it has from the skill's own fitness (E-43).
    pub(super) fn settle(&mut self, fitness: &Fitness) -> Result<(), SpecError> {
        let generations = self.regime.generations;
        let mut left = generations;
        for (index, row) in self.rows.iter().enumerate() {
            let path = format!("phase[{index}]");
            if !(row.share > 0.0 && row.share < 1.0) {
                let problem = format!("{} is not between 0 and 1", row.share);
                return Err(SpecError::new(format!("{path}.share"), problem));
            }
            // A share such as 0.3 is no binary fraction: three tenths of 10 are 3 and not 2.
            let taken = ((row.share * f64::from(generations) + 1e-9) as u32).max(1);
            left = left.saturating_sub(taken);
            if left == 0 {
                let problem = format!(
                    "the phases leave none of the skill's {generations} generations to its own fitness"
                );
                return Err(SpecError::new(path, problem));
            }
            let mut table = write(fitness);
            for (key, value) in &row.parameters {
                table.insert(key.clone(), value.clone());
            }
            let fitness = Fitness::read(&Value::Object(table)).map_err(|error| within(&path, error))?;
            self.phases.push(Phase { generations: taken, fitness: Value::Object(write(&fitness)) });
        }
        Ok(())
    }

    /// In order.
    pub(super) fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// Generations under the skill's own fitness, after all phases; at least 1.
    pub(super) fn final_generations(&self) -> u32 {
        self.regime.generations - self.phases.iter().map(|phase| phase.generations).sum::<u32>()
    }

    /// The keys of the row that are the search's, with every default filled in.
    pub(super) fn row(&self) -> Map<String, Value> {
        let mut row = write(&self.regime);
        row.append(&mut write(&Own { phase: self.rows.clone(), require: self.require }));
        row
    }
}

/// The keys of [`OWN_KEYS`].
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Own {
    #[serde(skip_serializing_if = "Vec::is_empty")]
    phase: Vec<PhaseRow>,
    #[serde(skip_serializing_if = "Option::is_none")]
    require: Option<f64>,
}
