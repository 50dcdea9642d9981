//! What each operator does to a graph, and what it leaves alone (E-39..E-41).

use super::*;
use crate::esp::body::Shape;
use crate::esp::body::genotype::{Edge, Segment};
use crate::esp::body::tests::{body, edge, muscle, receptor, segment, side, swimmer};
use crate::esp::key::{InstanceKey, Step};
use crate::esp::syllabus::SkillId;
use crate::esp::variation::Scope;
use crate::random::stream;
use glam::DVec3;
use std::collections::BTreeMap;

const SKILL: SkillId = SkillId(0);

/// Mutants of the swimmer, in which every operator is legal, with the names of their operators.
fn mutants(count: usize) -> Vec<(&'static str, Body)> {
    let mut draws = stream(1, [0, 0, 0], "mutants");
    let mutant = |_| {
        let mut body = swimmer();
        let name = body.mutate(Scope::Everything, SKILL, &mut draws).unwrap();
        (name, body)
    };
    (0..count).map(mutant).collect()
}

/// E-41
#[test]
fn every_operator_is_drawn_by_its_weight() {
    let mut counts = BTreeMap::<&str, u32>::new();
    for (name, body) in mutants(20_000) {
        *counts.entry(name).or_default() += 1;
        body.check().unwrap();
    }
    let weights = Operator::WEIGHTS.map(|(operator, weight)| (operator.name(), weight));
    let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
    assert!((total - 40.5).abs() < 1e-9, "29.5 of the skeleton, 8 of muscles, 3 of receptors");
    for (name, weight) in weights {
        let (expected, found) = (20_000.0 * weight / total, f64::from(counts[name]));
        assert!((found - expected).abs() < 0.25 * expected, "{name}: {found} where {expected} are expected");
    }
}

/// E-41: an event changes what its name says, in one gene.
#[test]
fn an_event_changes_one_thing() {
    let before = swimmer();
    let mut seen = BTreeMap::<&str, u32>::new();
    for (name, after) in mutants(4000) {
        *seen.entry(name).or_default() += 1;
        let mut back = after.clone();
        let same_genes = after.segments.len() == 3 && after.edges.len() == 2;
        let pairs = |change: &dyn Fn(&mut Edge, &Edge)| {
            let mut edges = after.edges.clone();
            edges.iter_mut().zip(&before.edges).for_each(|(edge, old)| change(edge, old));
            edges
        };
        match name {
            "dimensions" | "shape_kind" => {
                let other =
                    after.segments.iter().zip(&before.segments).filter(|(new, old)| new.shape != old.shape);
                assert!(other.count() <= 1);
                back.segments.iter_mut().zip(&before.segments).for_each(|(new, old)| new.shape = old.shape);
            }
            "recursion_limit" => {
                let limits = after.segments.iter().map(|gene| gene.recursion_limit);
                assert_eq!(limits.sum::<u8>(), 4, "from 1 it can only grow");
                back.segments.iter_mut().for_each(|gene| gene.recursion_limit = 1);
            }
            "scale" => back.edges = pairs(&|edge, old| edge.scale = old.scale),
            "joint_kind" => back.edges = pairs(&|edge, old| edge.joint = old.joint),
            "joint_play" => {
                back.edges = pairs(&|edge, old| {
                    (edge.axis, edge.gap, edge.travel) = (old.axis, old.gap, old.travel);
                });
            }
            "attachment" => {
                back.edges = pairs(&|edge, old| {
                    (edge.parent_dir, edge.child_dir) = (old.parent_dir, old.child_dir);
                    edge.orientation = old.orientation;
                });
            }
            "terminal" => back.edges = pairs(&|edge, old| edge.terminal_only = old.terminal_only),
            "reflect" => back.edges = pairs(&|edge, old| edge.reflect = old.reflect),
            "symmetric" => back.edges = pairs(&|edge, old| edge.symmetric = old.symmetric),
            "add_muscle" | "remove_muscle" | "change_muscle" => {
                back.edges = pairs(&|edge, old| edge.muscles.clone_from(&old.muscles));
            }
            "add_receptor" | "remove_receptor" | "change_receptor" => {
                let pairs = back.segments.iter_mut().zip(&before.segments);
                pairs.for_each(|(new, old)| new.receptors.clone_from(&old.receptors));
            }
            "add_segment" => {
                assert_eq!((after.segments.len(), after.edges.len()), (4, 3));
                continue;
            }
            "add_edge" => {
                assert_eq!((after.segments.len(), after.edges.len()), (3, 3));
                continue;
            }
            "redirect_edge" | "remove_edge" => continue, // below
            other => panic!("unknown operator {other}"),
        }
        assert!(same_genes, "{name}");
        assert_ne!(after, before, "{name} did something");
        back.next_id = before.next_id;
        assert_eq!(back, before, "{name} did more than its name says");
    }
    assert_eq!(seen.len(), Operator::WEIGHTS.len());
}

/// E-41: what the root no longer reaches is deleted, and nothing else.
#[test]
fn what_hung_on_a_removed_edge_alone_goes_with_it() {
    let ids = |body: &Body| body.segments.iter().map(|gene| gene.id.0).collect::<Vec<_>>();
    let mut left = BTreeSet::new();
    for (name, body) in mutants(4000) {
        if name == "remove_edge" {
            left.insert(ids(&body));
            assert_eq!(body.edges.len(), body.segments.len() - 1);
        }
    }
    assert_eq!(left, BTreeSet::from([vec![0], vec![0, 1]]), "the shoulder with the whole arm, or the hand");
    let mut ring = body(vec![segment(0, 1), segment(1, 1)], vec![edge(2, 0, 1), edge(3, 1, 0)]);
    ring.segments.push(segment(4, 1));
    ring.edges.push(edge(5, 4, 0));
    ring.delete_unreachable();
    assert_eq!((ids(&ring), ring.edges.len()), (vec![0, 1], 2));
}

/// E-59: locked genes and the skeleton are closed where only additions are open.
#[test]
fn what_is_locked_is_closed_to_a_later_stage() {
    use crate::esp::syllabus::Growth;
    let mut base = swimmer();
    base.lock(SKILL);
    let grown = |grow: &[Growth]| {
        let (mut body, mut draws) = (base.clone(), stream(3, [0, 0, 0], "later"));
        let names: BTreeSet<_> =
            (0..200).filter_map(|_| body.mutate(Scope::Added { grow }, SkillId(1), &mut draws)).collect();
        let mut stripped = body.clone();
        stripped.segments.iter_mut().for_each(|gene| gene.receptors.retain(|gene| gene.locked));
        stripped.edges.iter_mut().for_each(|gene| gene.muscles.retain(|gene| gene.locked));
        stripped.next_id = base.next_id;
        assert_eq!(stripped, base);
        assert_eq!(body.skeleton(), base.skeleton());
        names
    };
    assert_eq!(grown(&[Growth::Muscles]), BTreeSet::from(["add_muscle", "change_muscle", "remove_muscle"]));
    assert_eq!(
        grown(&[Growth::Photoreceptors]),
        BTreeSet::from(["add_receptor", "change_receptor", "remove_receptor"])
    );
    assert_eq!(grown(&[]), BTreeSet::new());
}

/// A chain of balls of one radius; its edges have ids from 20 on.
fn chain(count: u32, radius: f64) -> Body {
    let ball = |id| Segment { shape: Shape::Sphere(radius), ..segment(id, 1) };
    body((0..count).map(ball).collect(), (1..count).map(|id| edge(20 + id, id - 1, id)).collect())
}

/// E-39
#[test]
fn a_child_has_segments_of_both_parents_at_their_places() {
    let (first, second) = (chain(4, 0.1), chain(9, 0.2));
    let mut shapes = BTreeSet::new();
    for seed in 0..400 {
        let (child, _) = first.crossover(&second, &mut stream(seed, [0, 0, 0], "cross"));
        child.check().unwrap();
        assert!(child.next_id >= second.next_id);
        let of_second: Vec<bool> =
            child.segments.iter().map(|gene| gene.shape == Shape::Sphere(0.2)).collect();
        assert!(!of_second[0] && child.root == GeneId(0), "the first parent begins");
        assert!(of_second.windows(2).filter(|pair| pair[0] != pair[1]).count() <= 2);
        assert!(of_second.len() == 4 || of_second.len() == 9, "it ends where a parent does");
        shapes.insert(of_second);
    }
    // Nothing of the first chain leads to what is cut in behind its end: that comes out as if uncut.
    assert_eq!(shapes.len(), 1 + 3 + 6, "uncut, cut once, cut twice");
}

/// E-39
#[test]
fn genes_of_the_second_parent_get_new_ids_only_where_theirs_are_taken() {
    let mut second = chain(4, 0.2);
    // An edge of the second parent has the id of a segment of the first, and leaves its segment 2.
    second.segments.iter_mut().for_each(|gene| gene.id.0 += 30);
    second.edges.iter_mut().for_each(|gene| (gene.from.0, gene.to.0) = (gene.from.0 + 30, gene.to.0 + 30));
    second.edges[2].id = GeneId(0);
    second.edges.sort_by_key(|gene| gene.id);
    (second.root, second.next_id) = (GeneId(30), 34);
    second.check().unwrap();
    let mut renamed = 0;
    for seed in 0..200 {
        let (child, renaming) = chain(4, 0.1).crossover(&second, &mut stream(seed, [0, 0, 0], "cross"));
        child.check().unwrap();
        let key = |edge| InstanceKey { part: vec![Step(GeneId(edge), 1)], gene: GeneId(7) };
        let new = renaming.key(&key(0));
        if child.segment(GeneId(32)).is_some() {
            assert_eq!(new, key(34), "taken by the root, which is always the first parent's");
            assert!(child.edges.iter().any(|gene| gene.id == GeneId(34) && gene.from == GeneId(32)));
            renamed += 1;
        } else {
            assert_eq!(new, key(0), "it did not come along");
        }
    }
    assert!(renamed > 20);
}

/// E-40
#[test]
fn a_graft_brings_what_is_reached_from_its_segment_and_the_names_of_its_muscles() {
    let first = body(vec![segment(0, 1), segment(1, 1)], vec![edge(2, 0, 1)]);
    let donor = swimmer();
    let donor_body = donor.develop().unwrap();
    let (mut redirected, mut added, mut sizes) = (0, 0, BTreeSet::new());
    for seed in 0..300 {
        let (child, renaming) = first.graft(&donor, SKILL, &mut stream(seed, [0, 0, 0], "graft")).unwrap();
        child.check().unwrap();
        let old = child.edges.iter().find(|gene| gene.id == GeneId(2)).expect("its child may be another");
        if old.to == GeneId(1) {
            added += 1
        } else {
            redirected += 1
        }
        sizes.insert(child.segments.len());
        let Ok(body) = child.develop() else { continue };
        let instances = body.instances();
        let counterparts = counterparts(&donor_body, &body, &renaming);
        let named: BTreeSet<_> = counterparts.values().collect();
        assert_eq!(named.len(), counterparts.len(), "each stands for one");
        assert!(
            counterparts
                .values()
                .all(|key| { instances.muscles.contains(key) || instances.photos.contains(key) })
        );
        for (old, new) in &counterparts {
            assert_eq!(renaming.key(old).gene, new.gene);
        }
    }
    assert!(redirected > 100 && added > 100);
    // On the edge instead of segment 1, or beside it: hand, arm with hand, torso with both.
    assert_eq!(sizes, BTreeSet::from([2, 3, 4, 5]));
}

/// E-40: a mirrored pair of the donor's keeps its sides where the child has both.
#[test]
fn counterparts_end_alike() {
    let donor = swimmer();
    let grafted = |seed| swimmer().graft(&donor, SKILL, &mut stream(seed, [0, 0, 0], "graft")).unwrap();
    let mut children = (0..1000).map(grafted);
    let (child, renaming) =
        children.find(|(child, _)| child.segments.len() == 6 && child.develop().is_ok()).unwrap();
    let map = counterparts(&donor.develop().unwrap(), &child.develop().unwrap(), &renaming);
    let sides = |key: &InstanceKey| key.part.iter().map(|step| step.1).collect::<Vec<_>>();
    let muscles = donor.develop().unwrap().instances().muscles;
    for old in &muscles {
        let new = sides(&map[old]);
        assert_eq!(new[new.len() - old.part.len()..], sides(old)[..]);
    }
}

/// E-61
#[test]
fn what_was_added_to_one_skeleton_is_exchanged() {
    let mut base = swimmer();
    base.lock(SKILL);
    let with = |muscles: &[u32], receptors: &[u32]| {
        let mut body = base.clone();
        body.edges[1].muscles.extend(muscles.iter().map(|&id| muscle(id)));
        body.segments[0].receptors.extend(receptors.iter().map(|&id| receptor(id)));
        body.next_id = 40;
        body.check().unwrap();
        body
    };
    // Aligned: 10 with 10, a muscle with a receptor; 11 with 12; the first parent has no third.
    let (first, mut second) = (with(&[10, 11], &[]), with(&[12, 13], &[10]));
    second.edges[1].muscles[1].parent_dir = DVec3::Y;
    let mut seen = BTreeSet::new();
    for seed in 0..200 {
        let (child, renaming) = first.exchange(&second, &mut stream(seed, [0, 0, 0], "exchange"));
        child.check().unwrap();
        assert_eq!(child.skeleton(), base.skeleton());
        let mut stripped = child.clone();
        stripped.segments.iter_mut().for_each(|gene| gene.receptors.retain(|gene| gene.locked));
        stripped.edges.iter_mut().for_each(|gene| gene.muscles.retain(|gene| gene.locked));
        stripped.next_id = base.next_id;
        assert_eq!(stripped, base);
        assert_eq!(renaming.key(&InstanceKey { part: vec![], gene: GeneId(13) }).gene, GeneId(13));
        let added: Vec<u32> = child.added_ids();
        assert_eq!(added[0], 10, "the first parent begins");
        seen.insert(added);
    }
    let expected = [vec![10, 11], vec![10, 12, 13], vec![10, 11, 13]];
    assert!(seen.contains(&expected[0]) && seen.contains(&expected[1]), "{seen:?}");
}

impl Body {
    fn added_ids(&self) -> Vec<u32> {
        let receptors = self.segments.iter().flat_map(|gene| &gene.receptors).filter(|gene| !gene.locked);
        let muscles = self.edges.iter().flat_map(|gene| &gene.muscles).filter(|gene| !gene.locked);
        let mut ids: Vec<u32> =
            receptors.map(|gene| gene.id.0).chain(muscles.map(|gene| gene.id.0)).collect();
        ids.sort_unstable();
        ids
    }
}

/// E-42: the drawn child stands on the far side of its joint.
#[test]
fn a_drawn_child_points_away_from_its_parent() {
    let mut draws = stream(5, [0, 0, 0], "edge");
    for _ in 0..200 {
        let mut graph = body(vec![segment(0, 1), segment(1, 1)], vec![side(2, 0, 1, DVec3::Y)]);
        graph.edges.clear();
        graph.add_edge(GeneId(0), GeneId(1), SKILL, &mut draws);
        graph.check().unwrap();
        let edge = &graph.edges[0];
        assert!((edge.orientation * edge.child_dir).dot(edge.parent_dir) <= 0.0);
    }
}
