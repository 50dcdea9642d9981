//! Mating of two graphs: crossover and grafting (E-39, E-40), and the exchange of what was added in a stage (E-61).
//! Genes of the second parent keep their ids where these are free, and get new ones where not.

use crate::esp::body::genotype::{Edge, MUSCLES_MAX, Muscle, RECEPTORS_MAX, Receptor, SEGMENTS_MAX, Segment};
use crate::esp::body::{Body, Illegal, Phenotype};
use crate::esp::key::{GeneId, InstanceKey, Step};
use crate::esp::syllabus::SkillId;
use crate::esp::variation::draw::{cuts, is_of_second, pick};
use crate::random::Stream;
use std::collections::{BTreeMap, BTreeSet};

/// The ids that genes of the second parent have in the child.
#[derive(Debug, Clone, Default)]
pub(in crate::esp::variation) struct Renaming {
    names: BTreeMap<GeneId, GeneId>,
    taken: BTreeSet<GeneId>,
    next: u32,
}

impl Renaming {
    /// Where the genes of a body are taken; new ids start from one above all that either parent ever used (E-1).
    fn beside(body: &Body, next: u32) -> Renaming {
        Renaming { names: BTreeMap::new(), taken: body.ids().map(|(_, id)| id).collect(), next }
    }

    /// The id in the child of a gene that comes along.
    fn adopt(&mut self, id: GeneId) -> GeneId {
        let name = if self.taken.contains(&id) {
            self.next += 1;
            GeneId(self.next - 1)
        } else {
            id
        };
        self.taken.insert(name);
        self.names.insert(id, name);
        name
    }

    fn adopt_segment(&mut self, gene: &Segment) -> Segment {
        let id = self.adopt(gene.id);
        let receptors =
            gene.receptors.iter().map(|gene| Receptor { id: self.adopt(gene.id), ..gene.clone() }).collect();
        Segment { id, receptors, ..gene.clone() }
    }

    /// `from` and `to` are still the second parent's.
    fn adopt_edge(&mut self, gene: &Edge) -> Edge {
        let id = self.adopt(gene.id);
        let muscles =
            gene.muscles.iter().map(|gene| Muscle { id: self.adopt(gene.id), ..gene.clone() }).collect();
        Edge { id, muscles, ..gene.clone() }
    }

    /// The id in the child of a gene, its own if it did not come along.
    fn name(&self, id: GeneId) -> GeneId {
        self.names.get(&id).copied().unwrap_or(id)
    }

    /// The key in the child of an instance of the second parent's.
    pub(in crate::esp::variation) fn key(&self, key: &InstanceKey) -> InstanceKey {
        let part = key.part.iter().map(|&Step(edge, copy)| Step(self.name(edge), copy)).collect();
        InstanceKey { part, gene: self.name(key.gene) }
    }
}

impl Body {
    /// A graph of two parents whose lists of segment genes are aligned by index and cut at one or two places (E-39).
    /// A segment brings the edges that leave it; they lead to the same index as in their parent, or to a drawn one
    /// if there is none. The list ends where that of the parent at hand does.
    pub(in crate::esp::variation) fn crossover(&self, other: &Body, stream: &mut Stream) -> (Body, Renaming) {
        let cuts = cuts(self.segments.len().min(other.segments.len()), stream);
        let of_second = |index: usize| is_of_second(index, &cuts);
        let parent = |index: usize| if of_second(index) { other } else { self };
        let count = (0..).find(|&index| index >= parent(index).segments.len()).expect("both lists end");

        let mut head = Body { segments: Vec::new(), edges: Vec::new(), ..*self };
        for index in (0..count).filter(|&index| !of_second(index)) {
            head.segments.push(self.segments[index].clone());
            head.edges.extend(self.edges_from(self.segments[index].id).cloned());
        }
        let mut renaming = Renaming::beside(&head, self.next_id.max(other.next_id));
        let segments: Vec<Segment> = (0..count)
            .map(|index| match of_second(index) {
                true => renaming.adopt_segment(&other.segments[index]),
                false => self.segments[index].clone(),
            })
            .collect();

        let counterpart = |body: &Body, id: GeneId| {
            let place = body.segments.iter().position(|gene| gene.id == id);
            place.and_then(|place| segments.get(place)).map(|gene| gene.id)
        };
        let mut edges = Vec::new();
        for index in 0..count {
            let parent = parent(index);
            for gene in parent.edges_from(parent.segments[index].id) {
                let mut edge = if of_second(index) { renaming.adopt_edge(gene) } else { gene.clone() };
                edge.from = segments[index].id;
                let drawn = || segments[stream.below(count)].id;
                edge.to = counterpart(parent, gene.to).unwrap_or_else(drawn);
                edges.push(edge);
            }
        }
        let root = counterpart(self, self.root).unwrap_or(segments[0].id);
        let mut child = Body { root, next_id: renaming.next, segments, edges };
        child.settle();
        (child, renaming)
    }

    /// This graph with one of its edges leading to a drawn segment gene of another, or with one more edge that
    /// does, and all that is reached from there (E-40).
    ///
    /// # Errors
    /// It has more segment genes than are legal.
    pub(in crate::esp::variation) fn graft(
        &self,
        donor: &Body,
        skill: SkillId,
        stream: &mut Stream,
    ) -> Result<(Body, Renaming), Illegal> {
        let mut child = self.clone();
        let mut renaming = Renaming::beside(self, self.next_id.max(donor.next_id));
        let scion = donor.segments[stream.below(donor.segments.len())].id;
        let reached = donor.reachable(scion);
        for gene in donor.segments.iter().filter(|gene| reached.contains(&gene.id)) {
            let adopted = renaming.adopt_segment(gene);
            child.segments.push(adopted);
        }
        for gene in donor.edges.iter().filter(|gene| reached.contains(&gene.from)) {
            let mut adopted = renaming.adopt_edge(gene);
            (adopted.from, adopted.to) = (renaming.name(gene.from), renaming.name(gene.to));
            child.edges.push(adopted);
        }
        child.next_id = renaming.next;
        let (own, scion) = (self.edges.len(), renaming.name(scion));
        let stumps = self.segments_with_room();
        if own > 0 && (stumps.is_empty() || stream.chance(0.5)) {
            child.edges[stream.below(own)].to = scion;
        } else {
            child.add_edge(pick(stumps, stream), scion, skill, stream);
        }
        child.settle();
        match child.segments.len() {
            ..=SEGMENTS_MAX => Ok((child, renaming)),
            found => Err(Illegal::TooManySegments { found }),
        }
    }

    /// This graph with muscles and receptors that were added to two parents of the same skeleton: lists of what is
    /// not locked are aligned by index and cut at one or two places (E-39, E-61).
    pub(in crate::esp::variation) fn exchange(&self, other: &Body, stream: &mut Stream) -> (Body, Renaming) {
        let (first, second) = (self.added(), other.added());
        let cuts = cuts(first.len().min(second.len()), stream);
        let mut child = self.clone();
        for gene in &mut child.segments {
            gene.receptors.retain(|gene| gene.locked);
        }
        for gene in &mut child.edges {
            gene.muscles.retain(|gene| gene.locked);
        }
        let of_second = |index: &usize| is_of_second(*index, &cuts);
        let parent = |index: usize| if of_second(&index) { &second } else { &first };
        let count = (0..).find(|&index| index >= parent(index).len()).expect("both lists end");
        for index in (0..count).filter(|index| !of_second(index)) {
            child.grow(first[index].clone());
        }
        let mut renaming = Renaming::beside(&child, self.next_id.max(other.next_id));
        for index in (0..count).filter(of_second) {
            let mut gene = second[index].clone();
            if child.has_room_for(&gene) {
                *gene.id_mut() = renaming.adopt(gene.id());
                child.grow(gene);
            }
        }
        child.next_id = renaming.next;
        (child, renaming)
    }

    /// Puts genes in order and deletes those that the root does not reach.
    fn settle(&mut self) {
        self.segments.sort_by_key(|gene| gene.id);
        self.edges.sort_by_key(|gene| gene.id);
        self.delete_unreachable();
    }

    fn added(&self) -> Vec<Added> {
        let receptors = self.segments.iter().flat_map(|host| {
            let open = host.receptors.iter().filter(|gene| !gene.locked);
            open.map(|gene| Added::Receptor(host.id, gene.clone()))
        });
        let muscles = self.edges.iter().flat_map(|host| {
            let open = host.muscles.iter().filter(|gene| !gene.locked);
            open.map(|gene| Added::Muscle(host.id, gene.clone()))
        });
        let mut added: Vec<Added> = receptors.chain(muscles).collect();
        added.sort_by_key(Added::id);
        added
    }

    fn has_room_for(&self, gene: &Added) -> bool {
        match gene {
            Added::Receptor(host, _) => {
                self.segment(*host).is_some_and(|host| host.receptors.len() < RECEPTORS_MAX)
            }
            Added::Muscle(host, _) => {
                let mut edges = self.edges.iter().filter(|edge| edge.id == *host);
                edges.any(|edge| edge.muscles.len() < MUSCLES_MAX)
            }
        }
    }

    fn grow(&mut self, gene: Added) {
        match gene {
            Added::Receptor(host, gene) => {
                let host = self.segments.iter_mut().find(|segment| segment.id == host);
                host.expect("both parents have the same segments").receptors.push(gene);
            }
            Added::Muscle(host, gene) => {
                let host = self.edges.iter_mut().find(|edge| edge.id == host);
                host.expect("both parents have the same edges").muscles.push(gene);
            }
        }
    }
}

/// A gene that was added to a skeleton, and to what.
#[derive(Debug, Clone)]
enum Added {
    Receptor(GeneId, Receptor),
    Muscle(GeneId, Muscle),
}

impl Added {
    fn id(&self) -> GeneId {
        match self {
            Added::Receptor(_, gene) => gene.id,
            Added::Muscle(_, gene) => gene.id,
        }
    }

    fn id_mut(&mut self) -> &mut GeneId {
        match self {
            Added::Receptor(_, gene) => &mut gene.id,
            Added::Muscle(_, gene) => &mut gene.id,
        }
    }
}

/// Which instance of a grafted child stands for which of the donor's: of those of the same gene the one whose way
/// from the root ends most alike. Each stands for one at most.
pub(in crate::esp::variation) fn counterparts(
    donor: &Phenotype,
    child: &Phenotype,
    renaming: &Renaming,
) -> BTreeMap<InstanceKey, InstanceKey> {
    let (donor, child) = (donor.instances(), child.instances());
    let mut counterparts = BTreeMap::new();
    for (olds, news) in [(&donor.muscles, child.muscles), (&donor.photos, child.photos)] {
        let mut free = news;
        for old in olds.iter().filter(|old| renaming.names.contains_key(&old.gene)) {
            let named = renaming.key(old);
            let alike = |new: &InstanceKey| {
                let steps = new.part.iter().rev().zip(named.part.iter().rev());
                steps.take_while(|(new, named)| new == named).count()
            };
            // The first of those that are most alike.
            let same = free.iter().enumerate().rev().filter(|(_, new)| new.gene == named.gene);
            if let Some((place, _)) = same.max_by_key(|(_, new)| alike(new)) {
                counterparts.insert(old.clone(), free.remove(place));
            }
        }
    }
    counterparts
}
