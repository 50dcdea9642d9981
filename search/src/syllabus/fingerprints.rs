//! A fingerprint of every skill and group, kept in each checkpoint, and what may differ when a search goes on with
//! a changed file: only what it has not come to yet (ESP E-86, EF-11). It changes no state.

use super::settings::Settings;
use crate::PickedBy;
use creatures::esp::syllabus::{Mode, SkillId};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt;

/// BLAKE3 of a row with every default filled in, its first eight bytes.
type Print = u64;

/// The syllabus with which a checkpoint was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Fingerprints {
    mode: Mode,
    import: Print,
    /// Names with their prints, in the file's order. Who picks at a skill's end is no part of its print.
    skills: Vec<(String, Print)>,
    /// Who picks at the end of each.
    picks: Vec<PickedBy>,
    /// Members with their prints, in the file's order.
    groups: Vec<(Vec<String>, Print)>,
}

/// How far a search has come.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Progress {
    pub(super) learned: BTreeSet<SkillId>,
    /// The skill that is being learned, unless nothing was done for it yet.
    pub(super) current: Option<SkillId>,
}

/// One difference between the syllabus of a checkpoint and another.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// What differs.
    pub subject: Subject,
    /// How.
    pub change: Change,
    /// Why the search cannot go on with it; none if it can.
    pub refused: Option<&'static str>,
}

/// What differs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Subject {
    /// A key of `[search]`.
    Key(&'static str),
    /// A skill, by its name.
    Skill(String),
    /// A group, by its members.
    Group(Vec<String>),
}

/// How it differs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// It is new.
    Added,
    /// It is gone.
    Removed,
    /// It says something else.
    Changed,
    /// Somebody else says who goes on from its end.
    PickedOtherwise,
    /// It stands elsewhere among the skills.
    Moved,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.subject {
            Subject::Key(key) => write!(f, "`search.{key}`")?,
            Subject::Skill(name) => write!(f, "skill `{name}`")?,
            Subject::Group(members) => write!(f, "group [{}]", members.join(", "))?,
        }
        f.write_str(match self.change {
            Change::Added => " is new",
            Change::Removed => " is gone",
            Change::Changed => " has changed",
            Change::PickedOtherwise => " has another `pick`",
            Change::Moved => " stands at another place",
        })?;
        self.refused.iter().try_for_each(|why| write!(f, ", and {why}"))
    }
}

impl Fingerprints {
    pub(super) fn of(settings: &Settings) -> Fingerprints {
        let [mut skills, groups] = settings.lists();
        for row in &mut skills {
            row.as_object_mut().expect("a skill is a table").remove("pick");
        }
        let names = settings.table.skill.iter().map(|skill| skill.id.clone());
        let members = settings.table.pandemonium.iter().map(|group| group.members.clone());
        Fingerprints {
            mode: settings.course.mode,
            import: print(&serde_json::to_value(&settings.course.import).expect("it is a string or none")),
            skills: names.zip(skills.iter().map(print)).collect(),
            picks: settings.lessons.iter().map(|lesson| lesson.regime.pick).collect(),
            groups: members.zip(groups.iter().map(print)).collect(),
        }
    }

    /// Every difference of `new`, the settings of another file, from this; each says whether a search that has
    /// come so far can go on with it.
    pub(super) fn differences(&self, new: &Settings, progress: &Progress) -> Vec<Difference> {
        let now = Fingerprints::of(new);
        let mut found = Vec::new();
        let begun = !progress.learned.is_empty() || progress.current.is_some();
        let stale = |refused: bool| refused.then_some("skills were evolved with it already");
        for (key, same) in [("mode", self.mode == now.mode), ("import", self.import == now.import)] {
            if !same {
                let (subject, change) = (Subject::Key(key), Change::Changed);
                found.push(Difference { subject, change, refused: stale(begun) });
            }
        }
        self.compare_skills(&now, progress, &mut found);
        self.compare_groups(&now, new, progress, &mut found);
        found
    }

    fn compare_skills(&self, now: &Fingerprints, progress: &Progress, found: &mut Vec<Difference>) {
        let touched = |index: usize| progress.touches(SkillId(index as u16));
        let mut note = |name: &str, change, refused: Option<&'static str>| {
            found.push(Difference { subject: Subject::Skill(name.to_owned()), change, refused });
        };
        for (index, (name, print)) in self.skills.iter().enumerate() {
            let learned = touched(index).then_some("it was evolved already");
            match now.skills.iter().position(|(other, _)| other == name) {
                None => note(name, Change::Removed, learned),
                Some(place) if place != index && learned.is_some() => note(name, Change::Moved, learned),
                Some(place) if now.skills[place].1 != *print => note(name, Change::Changed, learned),
                Some(place) if now.picks[place] != self.picks[index] => {
                    let picked = progress.learned.contains(&SkillId(index as u16));
                    note(name, Change::PickedOtherwise, picked.then_some("someone was picked already"));
                }
                Some(place) if place != index => note(name, Change::Moved, None),
                Some(_) => {}
            }
        }
        for (name, _) in now.skills.iter().filter(|(name, _)| !self.skills.iter().any(|(old, _)| old == name))
        {
            note(name, Change::Added, None);
        }
    }

    fn compare_groups(
        &self,
        now: &Fingerprints,
        new: &Settings,
        progress: &Progress,
        found: &mut Vec<Difference>,
    ) {
        let touched = |name: &String| {
            let place = self.skills.iter().position(|(old, _)| old == name);
            place.is_some_and(|place| progress.touches(SkillId(place as u16)))
        };
        for (members, _) in self.groups.iter().filter(|(_, print)| !now.has_group(*print)) {
            let refused = members.iter().any(touched).then_some("a member of it was evolved already");
            let change = Change::Removed;
            found.push(Difference { subject: Subject::Group(members.clone()), change, refused });
        }
        // A learned skill that no other learned one calls is always called at full strength: a group changes
        // nothing for what was learned (E-55).
        let called: BTreeSet<&str> = new
            .table
            .skill
            .iter()
            .filter(|skill| touched(&skill.id))
            .flat_map(|skill| skill.uses.iter().map(String::as_str))
            .collect();
        for (members, _) in now.groups.iter().filter(|(_, print)| !self.has_group(*print)) {
            let refused = members
                .iter()
                .any(|member| touched(member) && called.contains(member.as_str()))
                .then_some("a member of it is used by a skill that was evolved already");
            let change = Change::Added;
            found.push(Difference { subject: Subject::Group(members.clone()), change, refused });
        }
    }

    fn has_group(&self, print: Print) -> bool {
        self.groups.iter().any(|(_, other)| *other == print)
    }
}

impl Progress {
    fn touches(&self, skill: SkillId) -> bool {
        self.learned.contains(&skill) || self.current == Some(skill)
    }
}

fn print(row: &Value) -> Print {
    let hash = blake3::hash(row.to_string().as_bytes());
    u64::from_le_bytes(*hash.as_bytes().first_chunk().expect("a hash has 32 bytes"))
}
