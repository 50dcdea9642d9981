//! Genotypes: their bytes, what is refused (EF-7, EF-8), and what encapsulation locks (E-46).

use super::*;
use crate::esp::body::tests::{body, edge, muscle, receptor, segment, swimmer};
use crate::esp::brain::{Node, NodeKind, Output, Seal, Source, Target};
use crate::esp::key::{GeneId, InstanceKey, Step};
use crate::esp::syllabus::tests::ten_skills;
use glam::DVec3;

/// The swimmer, one shoulder of which beats.
fn creature() -> Genotype {
    let shoulder = InstanceKey { part: vec![Step(GeneId(3), 1)], gene: GeneId(5) };
    let mut control = Control::new(SkillId(0));
    control.nodes = vec![
        Node { kind: NodeKind::Sinusoidal { frequency: 1.0, phase: 0.0 }, inputs: vec![] },
        Node { kind: NodeKind::Complement, inputs: vec![Some(Source::Node(0))] },
    ];
    control.outputs = vec![Output { node: 1, target: Target::Muscle(shoulder) }];
    Genotype { body: swimmer(), brain: Brain { controls: vec![control] } }
}

#[track_caller]
fn refused(genotype: &Genotype, field: &str, words: &str) {
    let syllabus = ten_skills().check().unwrap();
    let error =
        Genotype::decode(&genotype.encode()).and_then(|genotype| genotype.check(&syllabus)).unwrap_err();
    let DecodeError::Illegal { field: found, problem } = &error else { panic!("{error}") };
    assert_eq!(found, field, "{error}");
    assert!(problem.contains(words), "{error} does not say {words}");
}

#[test]
fn a_genotype_survives_its_bytes() {
    let genotype = creature();
    let bytes = genotype.encode();
    let read = Genotype::decode(&bytes).unwrap();
    assert_eq!(read, genotype);
    assert_eq!(read.encode(), bytes);
    let body = read.check(&ten_skills().check().unwrap()).unwrap();
    assert_eq!(body, genotype.body.develop().unwrap());
}

/// EF-8
#[test]
fn bytes_of_no_genotype_are_refused() {
    let bytes = creature().encode();
    assert!(matches!(Genotype::decode(&bytes[..40]), Err(DecodeError::Malformed(_))));
    let mut later: ciborium::Value = encoding::decode(&bytes).unwrap();
    later.as_map_mut().unwrap()[0].1 = 2.into();
    let error = Genotype::decode(&encoding::encode(&later)).unwrap_err();
    assert!(matches!(error, DecodeError::Version { found: 2, side: "receiver", .. }), "{error}");
    later.as_map_mut().unwrap()[0].1 = 1.into();
    later.as_map_mut().unwrap().push(("soul".into(), 0.into()));
    let error = Genotype::decode(&encoding::encode(&later)).unwrap_err();
    assert!(error.to_string().contains("soul"), "{error}");
}

/// EF-7, EF-8
#[test]
fn the_place_of_a_fault_is_named() {
    let mut lame = creature();
    lame.body.edges[0].to = GeneId(9);
    refused(&lame, "body.edges[0].to", "no segment 9");

    let mut astray = creature();
    astray.brain.controls[0].nodes[1].inputs = vec![Some(Source::Node(7))];
    refused(&astray, "brain.controls[0].nodes[1].inputs[0]", "no node 7");

    let mut gifted = creature();
    gifted.body.edges[1].muscles[0].owner = SkillId(10);
    refused(&gifted, "body.edges[1].muscles[0].owner", "10 where there are 10 skills");
    let mut gifted = creature();
    gifted.body.segments[2].receptors[0].owner = SkillId(11);
    refused(&gifted, "body.segments[2].receptors[0].owner", "11 where");

    let mut endless = creature();
    endless.body = body(vec![segment(0, 6)], vec![edge(1, 0, 0), edge(2, 0, 0), edge(3, 0, 0)]);
    refused(&endless, "body", "more than 24 parts");
}

/// E-46
#[test]
fn encapsulation_locks_what_was_grown_for_the_skill() {
    let mut genotype = creature();
    genotype.body.edges[0].muscles.push(muscle(8));
    genotype.body.edges[0].muscles[1].owner = SkillId(1);
    genotype.body.segments[0].receptors = vec![receptor(9)];
    genotype.body.segments[0].receptors[0].owner = SkillId(1);
    genotype.encapsulate(SkillId(0));
    assert_eq!(genotype.brain.controls[0].seal, Seal::Locked);
    let locked = |genotype: &Genotype| {
        let muscles = genotype.body.edges.iter().flat_map(|gene| &gene.muscles).map(|gene| gene.locked);
        let receptors = genotype.body.segments.iter().flat_map(|gene| &gene.receptors);
        muscles.chain(receptors.map(|gene| gene.locked)).collect::<Vec<_>>()
    };
    assert_eq!(locked(&genotype), [true, false, true, false, true]);
    genotype.encapsulate(SkillId(1));
    assert_eq!(locked(&genotype), [true; 5]);
}

#[test]
fn traits_are_of_the_expressed_body_and_the_whole_brain() {
    let genotype = creature();
    let traits = genotype.traits();
    for (name, expected) in [
        ("parts", 5),
        ("joints", 4),
        ("muscles", 4),
        ("receptors", 2),
        ("mass", 40),
        ("nodes", 2),
        ("wires", 2),
    ] {
        let found = traits[name].as_f64().unwrap();
        assert!((found - f64::from(expected)).abs() < 1e-9, "{name}: {found}");
    }
    let skeleton = |change: fn(&mut Body)| {
        let mut genotype = creature();
        change(&mut genotype.body);
        genotype.traits()["skeleton"].clone()
    };
    assert_eq!(skeleton(|body| body.edges[0].muscles.clear()), traits["skeleton"]);
    assert_eq!(skeleton(|body| body.segments[2].receptors[0].direction = DVec3::Z), traits["skeleton"]);
    assert_eq!(skeleton(|body| body.next_id = 99), traits["skeleton"]);
    assert_ne!(skeleton(|body| body.edges[0].gap = 0.06), traits["skeleton"]);
}
