//! A syllabus as an experiment file has it: `[search]`, `[[skill]]` and `[[pandemonium]]` (ESP E-88). What is
//! for a creature's task and what for the search stand in one row; here they are parted. It evolves nothing.

use super::import::Import;
use super::lesson::Lesson;
use super::regime::Regime;
use crate::settings::{object, read_joined, within, write};
use creatures::esp::syllabus::{Mode, SkillId, SkillTable, Stage, Syllabus, SyllabusTable};
use creatures::{SpecError, read_spec};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// Its name in experiment files.
pub const KIND: &str = "syllabus";
/// The lists of tables at the top of an experiment file that are a syllabus.
pub const LISTS: [&str; 2] = ["skill", "pandemonium"];

/// Keys of `[search]` that are of the whole syllabus.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Course {
    kind: String,
    /// Which way to go through the syllabus.
    pub mode: Mode,
    /// A creature that knows the first skill already (E-90).
    pub import: Import,
}

impl Default for Course {
    fn default() -> Self {
        Course { kind: KIND.to_owned(), mode: Mode::Fast, import: Import::default() }
    }
}

/// A syllabus and how each of its skills is evolved. Legal by construction.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    pub(super) course: Course,
    /// What skills that do not say otherwise go by.
    regime: Regime,
    pub(super) syllabus: Syllabus,
    /// The syllabus as every task has it.
    pub(super) table: SyllabusTable,
    /// One a skill, in the file's order.
    pub(super) lessons: Vec<Lesson>,
}

impl Settings {
    /// Reads `[search]`, with the lists of [`LISTS`] as keys beside its own.
    ///
    /// # Errors
    /// EF-1..EF-6, EF-16: the path of the key, what is wrong and what is allowed.
    pub fn read(table: Value) -> Result<Settings, SpecError> {
        let mut table = object(table)?;
        let [skills, groups] = LISTS.map(|list| table.remove(list).unwrap_or_else(|| Value::Array(vec![])));
        let (course, regime): (Course, Regime) = read_joined(table)?;
        regime.check()?;
        let Value::Array(skills) = skills else {
            return Err(SpecError::new(LISTS[0], "is no list of tables, as [[skill]] makes one"));
        };
        let defaults = write(&regime);
        let rows = skills.into_iter().enumerate().map(|(index, skill)| {
            Lesson::read(skill, &defaults).map_err(|error| within(&format!("skill[{index}]"), error))
        });
        let rows: Vec<(SkillTable, Lesson)> = rows.collect::<Result<_, _>>()?;
        let (skill, lessons): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
        let pandemonium = read_spec(groups).map_err(|error| list_within(LISTS[1], error))?;
        let table = SyllabusTable { skill, pandemonium };
        let syllabus = table.check()?;
        let table = syllabus.table();
        let mut settings = Settings { course, regime, syllabus, table, lessons };
        for (index, lesson) in settings.lessons.iter_mut().enumerate() {
            let fitness = settings.syllabus.skills()[index].fitness();
            lesson.settle(fitness).map_err(|error| within(&format!("skill[{index}]"), error))?;
        }
        settings.check_impacts()?;
        settings.course.import.check(&settings.syllabus).map_err(|error| within("import", error))?;
        Ok(settings)
    }

    /// What a test needs to know of another skill has been learned by then: General mode has an order of its own.
    fn check_impacts(&self) -> Result<(), SpecError> {
        let skills = self.syllabus.skills();
        let mut learned: Vec<SkillId> = Vec::new();
        for stage in self.stages(&[]) {
            for reference in skills[stage.skill.index()].fitness().references() {
                let other =
                    self.syllabus.find(reference.name).expect("a checked syllabus knows its references");
                if !learned.contains(&other) {
                    let name = skills[stage.skill.index()].name();
                    let path = format!("skill[{}].fitness.{}", stage.skill.index(), reference.key);
                    let problem = format!(
                        "general mode learns leaf skills first, and so `{name}` before `{}`, which it refers to",
                        reference.name
                    );
                    return Err(SpecError::new(path, problem));
                }
            }
            learned.push(stage.skill);
        }
        Ok(())
    }

    /// The stages that are left after some skills were learned.
    pub(super) fn stages(&self, learned: &[SkillId]) -> Vec<Stage> {
        self.syllabus.stages(self.course.mode, learned)
    }

    /// How a skill is evolved.
    pub(super) fn lesson(&self, skill: SkillId) -> &Lesson {
        &self.lessons[skill.index()]
    }

    /// A skill's name.
    pub(super) fn name(&self, skill: SkillId) -> &str {
        self.syllabus.skills()[skill.index()].name()
    }

    /// `[search]` with every default filled in.
    pub(super) fn search_table(&self) -> Map<String, Value> {
        crate::settings::write_joined(&self.course, &self.regime)
    }

    /// The rows of [`LISTS`] with every default filled in.
    pub(super) fn lists(&self) -> [Vec<Value>; 2] {
        let skill = |(table, lesson): (&SkillTable, &Lesson)| {
            let mut row = write(table);
            row.append(&mut lesson.row());
            Value::Object(row)
        };
        let skills = self.table.skill.iter().zip(&self.lessons).map(skill).collect();
        [skills, self.table.pandemonium.iter().map(|group| Value::Object(write(group))).collect()]
    }
}

/// An error within a list, whose path starts with an index.
fn list_within(list: &str, error: SpecError) -> SpecError {
    let path = if error.path.starts_with('[') { format!("{list}{}", error.path) } else { list.to_owned() };
    SpecError { path, ..error }
}
