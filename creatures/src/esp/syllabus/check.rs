//! Reading a syllabus: names become skills, and what cannot be learned or decided is refused (EF-1..EF-6).

use super::table::{BodyRule, GroupTable, SkillTable, SyllabusTable};
use super::{Group, Skill, SkillId, Syllabus, id};
use crate::SpecError;
use crate::esp::fitness::Fitness;
use std::collections::{BTreeMap, BTreeSet};

/// The most skills of a syllabus: far above any that will be learned, far below what an id can count.
const SKILLS_MAX: usize = 1000;

impl SyllabusTable {
    /// Looks up every name and checks that the skills can be learned in the order of the file.
    ///
    /// # Errors
    /// EF-1..EF-6: the key, what is wrong with it and what is allowed. Keys start with `skill[…]` or
    /// `pandemonium[…]`.
    pub fn check(&self) -> Result<Syllabus, SpecError> {
        let names = Names::of(&self.skill)?;
        let uses = self.skill.iter().enumerate().map(|(index, table)| names.uses(index, table));
        let uses: Vec<Vec<SkillId>> = uses.collect::<Result<_, _>>()?;
        check_order(&self.skill, &uses)?;
        if let Some(first) = uses[0].first() {
            let problem = format!("the first skill has to be a leaf, and uses `{}`", names.name(*first));
            return Err(SpecError::new("skill[0].uses", problem));
        }
        let groups = self.pandemonium.iter().enumerate().map(|(index, table)| names.group(index, table));
        let groups: Vec<Group> = groups.collect::<Result<_, _>>()?;
        let clusters = Contraction { names: &names, uses: &uses, groups: &groups }.order()?;
        let skills = self.skill.iter().zip(uses).enumerate();
        let skills = skills.map(|(index, (table, uses))| skill(index, table, uses));
        let syllabus = Syllabus { skills: skills.collect::<Result<_, _>>()?, groups, clusters };
        syllabus.check_references(&names)?;
        Ok(syllabus)
    }
}

impl Syllabus {
    /// Skills that a fitness refers to stand before it and are of the kind it needs.
    fn check_references(&self, names: &Names) -> Result<(), SpecError> {
        for (index, skill) in self.skills.iter().enumerate() {
            for reference in skill.fitness.references() {
                let path = format!("skill[{index}].fitness.{}", reference.key);
                let other = names.look_up(reference.name, &path)?;
                let kind = self.skills[other.index()].fitness.kind();
                if kind != reference.kind {
                    let problem =
                        format!("`{}` is of kind `{kind}`, not `{}`", reference.name, reference.kind);
                    return Err(SpecError::new(path, problem));
                }
                if other.index() >= index {
                    let problem = format!("`{}` is not learned before `{}`", reference.name, skill.name);
                    return Err(SpecError::new(path, problem));
                }
            }
        }
        Ok(())
    }
}

fn skill(index: usize, table: &SkillTable, uses: Vec<SkillId>) -> Result<Skill, SpecError> {
    let fitness =
        Fitness::read(&table.fitness).map_err(|error| error.below(&format!("skill[{index}].fitness")))?;
    Ok(Skill {
        name: table.id.clone(),
        uses,
        grow: table.grow.clone(),
        sensors: table.sensors.clone(),
        drive_body: table.drive_body,
        evolve_body: table.body == BodyRule::Evolve,
        fitness,
    })
}

/// The skills' names and places.
struct Names<'a>(BTreeMap<&'a str, SkillId>);

impl<'a> Names<'a> {
    fn of(skills: &'a [SkillTable]) -> Result<Names<'a>, SpecError> {
        if skills.is_empty() || skills.len() > SKILLS_MAX {
            let problem = format!("{} skills where 1 to {SKILLS_MAX} are legal", skills.len());
            return Err(SpecError::new("skill", problem));
        }
        let mut names = BTreeMap::new();
        for (index, SkillTable { id: name, .. }) in skills.iter().enumerate() {
            let path = format!("skill[{index}].id");
            let legal = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
            if name.is_empty() || !name.chars().all(legal) {
                let problem = format!("`{name}` is not made of letters, digits, `_` and `-`");
                return Err(SpecError::new(path, problem));
            }
            if names.insert(name.as_str(), id(index)).is_some() {
                return Err(SpecError::new(path, format!("`{name}` is the id of an earlier skill")));
            }
        }
        Ok(Names(names))
    }

    /// EF-3
    fn look_up(&self, name: &str, path: &str) -> Result<SkillId, SpecError> {
        self.0.get(name).copied().ok_or_else(|| {
            let nearest = self.0.keys().min_by_key(|known| strsim::damerau_levenshtein(known, name));
            let nearest = nearest.expect("a syllabus has a skill");
            SpecError::new(path, format!("there is no skill `{name}`, did you mean `{nearest}`?"))
        })
    }

    fn name(&self, of: SkillId) -> &str {
        self.0.iter().find(|&(_, &id)| id == of).map_or("", |(name, _)| name)
    }

    fn all(&self, path: &str, list: &[String]) -> Result<Vec<SkillId>, SpecError> {
        let mut skills = Vec::new();
        for (place, name) in list.iter().enumerate() {
            let path = format!("{path}[{place}]");
            let skill = self.look_up(name, &path)?;
            if skills.contains(&skill) {
                return Err(SpecError::new(path, format!("`{name}` is there already")));
            }
            skills.push(skill);
        }
        Ok(skills)
    }

    fn uses(&self, index: usize, table: &SkillTable) -> Result<Vec<SkillId>, SpecError> {
        self.all(&format!("skill[{index}].uses"), &table.uses)
    }

    fn group(&self, index: usize, table: &GroupTable) -> Result<Group, SpecError> {
        let path = format!("pandemonium[{index}]");
        if !(0.0..1.0).contains(&table.floor) {
            let problem = format!("{} is not within [0, 1)", table.floor);
            return Err(SpecError::new(format!("{path}.floor"), problem));
        }
        let members = self.all(&format!("{path}.members"), &table.members)?;
        if members.len() < 2 {
            let problem = format!("{} members where at least 2 can compete", members.len());
            return Err(SpecError::new(format!("{path}.members"), problem));
        }
        Ok(Group { members, winner: table.winner, floor: table.floor })
    }
}

/// No cycle (EF-1), and every skill after those that it uses (EF-2).
fn check_order(skills: &[SkillTable], uses: &[Vec<SkillId>]) -> Result<(), SpecError> {
    let steps = |vertex: usize| uses[vertex].iter().map(|used| used.index()).collect();
    if let Err(cycle) = sort(uses.len(), steps) {
        let names: Vec<&str> = cycle.iter().map(|&index| skills[index].id.as_str()).collect();
        let problem = format!("skills use each other in a cycle: {} → {}", names.join(" → "), names[0]);
        return Err(SpecError::new(format!("skill[{}].uses", cycle[0]), problem));
    }
    for (index, used) in uses.iter().enumerate() {
        if let Some(late) = used.iter().find(|used| used.index() >= index) {
            let (name, late) = (&skills[index].id, &skills[late.index()].id);
            let problem = format!("`{name}` uses `{late}`, which is learned after it");
            return Err(SpecError::new(format!("skill[{index}].uses"), problem));
        }
    }
    Ok(())
}

/// The graph of users and used in which each group is one vertex (E-54).
struct Contraction<'a> {
    names: &'a Names<'a>,
    uses: &'a [Vec<SkillId>],
    groups: &'a [Group],
}

impl Contraction<'_> {
    /// The clusters, users before used.
    fn order(&self) -> Result<Vec<Vec<SkillId>>, SpecError> {
        self.check_members()?;
        let clusters = self.clusters();
        let cluster_of = |skill: SkillId| {
            clusters.iter().position(|cluster| cluster.contains(&skill)).expect("every skill is in one")
        };
        let steps = |vertex: usize| {
            let used = clusters[vertex].iter().flat_map(|user| &self.uses[user.index()]);
            used.map(|&used| cluster_of(used)).collect()
        };
        let order = sort(clusters.len(), steps).map_err(|cycle| {
            let within = |group: &Group| cycle.iter().any(|&at| clusters[at].contains(&group.members[0]));
            let groups: Vec<usize> = (0..self.groups.len()).filter(|&at| within(&self.groups[at])).collect();
            let texts: Vec<String> = groups.iter().map(|&at| self.text(&self.groups[at])).collect();
            let problem =
                format!("members depend on each other across groups, in a cycle: {}", texts.join(", "));
            SpecError::new(format!("pandemonium[{}].members", groups[0]), problem)
        })?;
        // The order has the used first.
        Ok(order.into_iter().rev().map(|vertex| clusters[vertex].clone()).collect())
    }

    /// No member of a group depends on another (EF-5).
    fn check_members(&self) -> Result<(), SpecError> {
        for (index, group) in self.groups.iter().enumerate() {
            for &member in &group.members {
                let needs = self.reach(member);
                if let Some(&other) = group.members.iter().find(|other| needs.contains(other)) {
                    let problem = format!(
                        "in the group {} `{}` depends on `{}`",
                        self.text(group),
                        self.names.name(member),
                        self.names.name(other)
                    );
                    return Err(SpecError::new(format!("pandemonium[{index}].members"), problem));
                }
            }
        }
        Ok(())
    }

    /// What a skill uses, directly or in a chain.
    fn reach(&self, skill: SkillId) -> BTreeSet<SkillId> {
        let mut reached = BTreeSet::new();
        let mut open = vec![skill];
        while let Some(user) = open.pop() {
            open.extend(self.uses[user.index()].iter().filter(|&&used| reached.insert(used)));
        }
        reached
    }

    /// Skills joined by shared groups, each cluster and all of them in the file's order.
    fn clusters(&self) -> Vec<Vec<SkillId>> {
        let mut label: Vec<usize> = (0..self.uses.len()).collect();
        for group in self.groups {
            let joined: Vec<usize> = group.members.iter().map(|member| label[member.index()]).collect();
            let least = joined.iter().copied().min().expect("a group has members");
            label.iter_mut().filter(|at| joined.contains(at)).for_each(|at| *at = least);
        }
        let mut clusters = BTreeMap::<usize, Vec<SkillId>>::new();
        for (skill, &label) in label.iter().enumerate() {
            clusters.entry(label).or_default().push(id(skill));
        }
        clusters.into_values().collect()
    }

    fn text(&self, group: &Group) -> String {
        let names: Vec<&str> = group.members.iter().map(|&member| self.names.name(member)).collect();
        format!("[{}]", names.join(", "))
    }
}

/// Vertices so that each comes after all that its edges lead to, else a cycle. Depth-first in ascending order.
fn sort(vertices: usize, edges: impl Fn(usize) -> Vec<usize>) -> Result<Vec<usize>, Vec<usize>> {
    let mut order = Vec::with_capacity(vertices);
    let mut done = vec![false; vertices];
    for root in 0..vertices {
        // The way from the root, each vertex with the edges that are still to follow.
        let mut way = if done[root] { Vec::new() } else { vec![(root, edges(root))] };
        while let Some((vertex, rest)) = way.last_mut() {
            match rest.pop() {
                Some(next) if done[next] => {}
                Some(next) => {
                    if let Some(start) = way.iter().position(|&(passed, _)| passed == next) {
                        return Err(way[start..].iter().map(|&(passed, _)| passed).collect());
                    }
                    way.push((next, edges(next)));
                }
                None => {
                    done[*vertex] = true;
                    order.push(*vertex);
                    way.pop();
                }
            }
        }
    }
    Ok(order)
}
