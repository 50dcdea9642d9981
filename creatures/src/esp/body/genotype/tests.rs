//! Graphs that are refused by what they show without being expressed (EF-8).

use super::*;
use crate::esp::body::tests::{body, edge, muscle, receptor, segment, swimmer};

/// Changes a legal graph; the check has to name the field and say some words.
#[track_caller]
fn refused(change: impl FnOnce(&mut Body), field: &str, words: &str) {
    let mut graph = swimmer();
    graph.check().unwrap();
    change(&mut graph);
    let DecodeError::Illegal { field: found, problem } = graph.check().unwrap_err() else {
        panic!("no field is named")
    };
    assert_eq!(found, field, "{problem}");
    assert!(problem.contains(words), "{problem} does not say {words}");
}

/// EF-8
#[test]
fn what_is_not_there_is_named() {
    refused(|body| body.root = GeneId(9), "root", "no segment 9");
    refused(|body| body.segments.clear(), "root", "no segment 0");
    refused(|body| body.edges[1].to = GeneId(9), "edges[1].to", "no segment 9");
    refused(|body| body.edges[0].from = GeneId(3), "edges[0].from", "no segment 3"); // an edge
}

/// E-1
#[test]
fn an_id_is_used_once_in_order_and_below_the_next() {
    refused(|body| body.segments[2].receptors[0].id = GeneId(5), "edges[0].muscles[0].id", "5 is taken");
    refused(|body| body.edges[1].id = GeneId(1), "edges[1].id", "1 is taken");
    refused(|body| body.next_id = 7, "segments[2].receptors[0].id", "7 is not below next_id, 7");
    refused(|body| body.segments.swap(1, 2), "segments", "ascending");
    refused(|body| body.edges.swap(0, 1), "edges", "ascending");
}

/// E-2, E-3, E-6, E-7, E-10
#[test]
fn what_is_out_of_range_is_named() {
    refused(|body| body.segments[0].shape = Shape::Sphere(0.6), "segments[0].shape.sphere", "0.03 to 0.5");
    let bent = Shape::Capsule { radius: 0.1, half_length: f64::NAN };
    refused(|body| body.segments[1].shape = bent, "segments[1].shape.capsule.half_length", "NaN");
    refused(|body| body.segments[0].recursion_limit = 0, "segments[0].recursion_limit", "1 to 6");
    refused(|body| body.segments[0].recursion_limit = 7, "segments[0].recursion_limit", "1 to 6");
    refused(|body| body.edges[0].gap = 0.004, "edges[0].gap", "0.005 to 0.1");
    refused(|body| body.edges[0].scale = 1.6, "edges[0].scale", "0.5 to 1.5");
    refused(|body| body.edges[0].travel = f64::INFINITY, "edges[0].travel", "0.02 to 0.3");
    refused(|body| body.edges[0].axis *= 1.1, "edges[0].axis", "is not 1");
    refused(|body| body.edges[0].parent_dir = DVec3::ZERO, "edges[0].parent_dir", "is not 1");
    refused(|body| body.edges[0].child_dir.x = f64::NAN, "edges[0].child_dir", "is not 1");
    refused(
        |body| body.edges[0].orientation = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.5),
        "edges[0].orientation",
        "0.5",
    );
    refused(|body| body.edges[0].muscles[0].strength = 0.0, "edges[0].muscles[0].strength", "above 0");
    refused(|body| body.edges[0].muscles[0].child_dir.y = 2.0, "edges[0].muscles[0].child_dir", "is not 1");
    let blind = DVec3::splat(0.1);
    let field = "segments[2].receptors[0].direction";
    refused(|body| body.segments[2].receptors[0].direction = blind, field, "is not 1");
}

/// E-17
#[test]
fn more_genes_than_are_legal_are_refused() {
    let first = 20;
    refused(
        |body| {
            body.segments.extend((first..first + 10).map(|id| segment(id, 1)));
            body.next_id = first + 10;
        },
        "segments",
        "13 where 12",
    );
    refused(
        |body| {
            body.edges.extend((first..first + 6).map(|id| edge(id, 0, 1)));
            body.next_id = first + 6;
        },
        "segments[0]: edges from it",
        "7 where 6",
    );
    refused(
        |body| {
            body.edges[1].muscles.extend((first..first + 4).map(muscle));
            body.next_id = first + 4;
        },
        "edges[1].muscles",
        "5 where 4",
    );
    refused(
        |body| {
            body.segments[0].receptors = (first..first + 4).map(receptor).collect();
            body.next_id = first + 4;
        },
        "segments[0].receptors",
        "4 where 3",
    );
}

/// E-1: edges to the parent's own gene, and several between the same two.
#[test]
fn loops_and_parallel_edges_are_legal() {
    body(vec![segment(0, 2), segment(1, 1)], vec![edge(2, 0, 0), edge(3, 0, 1), edge(4, 0, 1)])
        .check()
        .unwrap();
}
