//! Refusals X-1..X-5, what is legal all the same, and the round trip.

use super::*;
use crate::flyer::variation::Settings;
use crate::random::stream;
use proptest::prelude::*;
use serde_json::{Value, json};

/// A founder of three wing segments or more.
fn founder() -> Genotype {
    let mut draws = stream(1, [0, 0, 0], "genotype test");
    let mut founders = std::iter::repeat_with(|| Genotype::random(&Settings::default(), &mut draws));
    founders.find(|founder| founder.segments() >= 3).unwrap()
}

/// The payload as JSON, for crafting bad ones.
fn payload(genotype: &Genotype) -> Value {
    encoding::decode(&genotype.encode()).unwrap()
}

fn refusal_of(bytes: &[u8]) -> (String, String) {
    match Genotype::decode(bytes).unwrap_err() {
        DecodeError::Illegal { field, problem } => (field, problem),
        error => panic!("{error:?} names no field"),
    }
}

/// The field and the problem with which a founder is refused when one place of its payload is another.
fn refusal(pointer: &str, value: Value) -> (String, String) {
    let mut payload = payload(&founder());
    *payload.pointer_mut(pointer).unwrap() = value;
    refusal_of(&encoding::encode(&payload))
}

#[test]
fn a_genotype_carries_its_version_in_front_and_survives_the_wire() {
    let genotype = founder();
    let payload = payload(&genotype);
    assert_eq!(payload["version"], json!(VERSION));
    let fields: Vec<_> = payload["nodes"][2].as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(fields, ["effectors", "length", "lpercent", "neurons", "psi", "radius", "theta"]);
    let neuron: Vec<_> = payload["nodes"][0]["neurons"][0].as_object().unwrap().keys().cloned().collect();
    assert_eq!(neuron, ["delay", "func", "inputs"]);
    let decoded = Genotype::decode(&genotype.encode()).unwrap();
    assert_eq!(decoded, genotype);
    assert_eq!(decoded.encode(), genotype.encode());
}

///
#[test]
fn a_gene_that_is_no_finite_number_is_refused_by_name() {
    type Gene = fn(&mut Genotype) -> &mut f64;
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let spoilt: [(&str, Gene); 5] = [
            ("nodes[0].length", |genotype| &mut genotype.nodes[0].length),
            ("nodes[0].radius", |genotype| &mut genotype.nodes[0].radius),
            ("nodes[1].psi", |genotype| &mut genotype.nodes[1].psi),
            ("nodes[2].theta", |genotype| &mut genotype.nodes[2].theta),
            ("nodes[3].psi", |genotype| &mut genotype.nodes[3].psi),
        ];
        for (field, gene) in spoilt {
            let mut genotype = founder();
            *gene(&mut genotype) = bad;
            assert_eq!(refusal_of(&genotype.encode()).0, field, "{bad}");
        }
    }
}

/// the numbers just beyond each bound.
#[test]
fn a_gene_out_of_range_is_refused_by_name_and_never_clamped() {
    let bad = [
        ("/nodes/0/length", json!(19.99)),
        ("/nodes/1/length", json!(80.01)),
        ("/nodes/2/length", json!(0.0)),
        ("/nodes/0/radius", json!(0.99)),
        ("/nodes/0/radius", json!(5.01)),
        ("/nodes/1/radius", json!(0.51)),
        ("/nodes/3/radius", json!(1.0)),
        ("/nodes/2/theta", json!(1.571)),
        ("/nodes/2/theta", json!(-1.571)),
        ("/nodes/2/psi", json!(-0.001)),
        ("/nodes/2/psi", json!(1.571)),
        ("/nodes/2/lpercent", json!(2)),
        ("/nodes/2/lpercent", json!(0.5)),
        ("/nodes/0/neurons/0/delay", json!(0)),
        ("/nodes/0/neurons/0/delay", json!(41)),
        ("/nodes/0/neurons/0/delay", json!(300)),
        ("/nodes/0/theta", json!(0.1)),
        ("/nodes/1/psi", json!(0.1)),
        ("/nodes/1/lpercent", json!(1)),
    ];
    for (pointer, value) in bad {
        let (field, problem) = refusal(pointer, value.clone());
        assert_eq!(field, path(pointer), "{value}: {problem}");
    }
    assert_eq!(refusal("/nodes/2/psi", json!(2.0)).1, "2 is not within 0 to 1.5707963267948966");
    assert_eq!(refusal("/nodes/1/radius", json!(0.6)).1, "0.6 is not 0.5");
}

///
#[test]
fn too_few_or_too_many_of_anything_are_refused_with_what_was_found() {
    let source = json!({"node": 1, "kind": "sensor", "index": 0, "cross": false});
    let effector = json!({"inputs": []});
    let neuron = json!({"func": "sin", "delay": 1, "inputs": []});
    let bad = [
        ("/nodes/0/neurons", json!(vec![neuron; 5])),
        ("/nodes/0/effectors", json!([effector])),
        ("/nodes/1/effectors", json!([effector, effector])),
        ("/nodes/2/effectors", json!([])),
        ("/nodes/2/effectors", json!([effector, effector])),
        ("/nodes/0/neurons/0/inputs", json!(vec![source.clone(); 4])),
        ("/nodes/1/effectors/2/inputs", json!(vec![source; 4])),
    ];
    for (pointer, value) in bad {
        let (field, problem) = refusal(pointer, value.clone());
        assert_eq!(field, path(pointer), "{problem}");
        let found = format!("{} ", value.as_array().unwrap().len());
        assert!(problem.starts_with(&found), "{problem}");
    }
}

///
#[test]
fn a_wing_has_one_to_eight_segments() {
    let founder = founder();
    let with = |segments: usize| {
        let mut nodes = founder.nodes[..3].to_vec();
        nodes.iter_mut().for_each(|node| node.neurons.clear());
        for effector in nodes.iter_mut().flat_map(|node| &mut node.effectors) {
            effector.inputs.clear();
        }
        nodes.resize(FIRST_SEGMENT + segments, nodes[2].clone());
        nodes.truncate(FIRST_SEGMENT + segments);
        Genotype { nodes }.encode()
    };
    for segments in [0, 9, 5000] {
        let (field, problem) = refusal_of(&with(segments));
        assert_eq!(field, "nodes");
        assert!(problem.starts_with(&format!("{} nodes", segments + 2)), "{problem}");
    }
    for segments in [1, 8] {
        assert_eq!(Genotype::decode(&with(segments)).unwrap().segments(), segments);
    }
    assert_eq!(refusal("/nodes", json!([])).0, "nodes");
}

///
#[test]
fn an_input_from_nowhere_is_refused_by_name() {
    let last = founder().nodes.len() - 1;
    let neurons = founder().nodes[2].neurons.len();
    let source = |node, kind, index| json!([{"node": node, "kind": kind, "index": index, "cross": true}]);
    let bad = [
        ("node", source(last + 1, "neuron", 0)),
        ("node", source(255, "sensor", 0)),
        ("node", source(256, "sensor", 0)),
        ("index", source(0, "sensor", 0)),
        ("index", source(1, "sensor", 8)),
        ("index", source(2, "sensor", 2)),
        ("index", source(2, "neuron", neurons)),
        ("kind", source(1, "effector", 0)),
    ];
    for (field, inputs) in bad {
        for owner in ["nodes[0].neurons[0]", "nodes[1].effectors[2]"] {
            let pointer = format!("/{}/inputs", owner.replace(['[', '.'], "/").replace(']', ""));
            let found = refusal(&pointer, inputs.clone()).0;
            assert_eq!(found, format!("{owner}.inputs[0].{field}"), "{inputs}");
        }
    }
    let mut legal = founder();
    legal.nodes[0].neurons[0].inputs =
        vec![Source { node: last as u8, kind: Kind::Sensor, index: 1, cross: true }];
    Genotype::decode(&legal.encode()).unwrap();
}

///
#[test]
fn strangers_are_named_or_told_which_side_to_upgrade() {
    let (field, problem) = refusal("/nodes/0/neurons/0/func", json!("tanh"));
    assert_eq!(field, "nodes[0].neurons[0].func");
    assert!(problem.contains("`tanh`") && problem.contains("`saw-wave`"), "{problem}");
    for place in ["", "/nodes/2", "/nodes/0/neurons/0", "/nodes/1/effectors/0"] {
        let mut payload = payload(&founder());
        payload.pointer_mut(place).unwrap()["colour"] = json!(1);
        let (_, problem) = refusal_of(&encoding::encode(&payload));
        assert!(problem.contains("unknown field `colour`"), "{place}: {problem}");
    }
    let version = |version: u32| {
        let mut payload = payload(&founder());
        payload["version"] = json!(version);
        payload["colour"] = json!("whatever a newer program adds");
        Genotype::decode(&encoding::encode(&payload)).unwrap_err().to_string()
    };
    assert_eq!(version(2), "genotype version 2 is not 1: upgrade the receiver");
    assert_eq!(version(0), "genotype version 0 is not 1: upgrade the sender");
}

///
#[test]
fn bones_without_film_and_a_wing_root_longer_than_the_body_are_legal() {
    let mut genotype = founder();
    genotype.nodes[2].psi = 0.0;
    (genotype.nodes[BODY].length, genotype.nodes[WING_ROOT].length) = (30.0, 70.0);
    let decoded = Genotype::decode(&genotype.encode()).unwrap();
    assert_eq!(decoded.nodes[WING_ROOT].length, 70.0, "the gene is kept");
    assert_eq!(decoded.wing_root_length(), 30.0);
    genotype.nodes[WING_ROOT].length = 20.0;
    assert_eq!(genotype.wing_root_length(), 20.0);
}

#[test]
fn the_bounds_themselves_are_legal() {
    let mut genotype = founder();
    for (low, high) in [(true, false), (false, true)] {
        for (index, node) in genotype.nodes.iter_mut().enumerate() {
            let pick = |range: RangeInclusive<f64>| if low { *range.start() } else { *range.end() };
            node.length = pick(LENGTH);
            if index == BODY {
                node.radius = pick(BODY_RADIUS);
            }
            if index >= FIRST_SEGMENT {
                (node.theta, node.psi, node.lpercent) = (pick(THETA), pick(PSI), u8::from(high));
            }
            for neuron in &mut node.neurons {
                neuron.delay = if low { *DELAY.start() } else { *DELAY.end() };
            }
        }
        Genotype::decode(&genotype.encode()).unwrap();
    }
}

/// `/nodes/0/neurons/1` as `nodes[0].neurons[1]`.
fn path(pointer: &str) -> String {
    pointer[1..].split('/').fold(String::new(), |path, part| match part.parse::<usize>() {
        Ok(index) => format!("{path}[{index}]"),
        Err(_) if path.is_empty() => part.to_owned(),
        Err(_) => format!("{path}.{part}"),
    })
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = Genotype::decode(&bytes);
    }

    /// Bytes damaged in one place are refused or are another legal genotype, and never panic.
    #[test]
    fn damaged_bytes_never_panic(place: proptest::sample::Index, byte: u8) {
        let mut bytes = founder().encode();
        let place = place.index(bytes.len());
        bytes[place] = byte;
        if let Ok(genotype) = Genotype::decode(&bytes) {
            prop_assert_eq!(&Genotype::decode(&genotype.encode()).unwrap(), &genotype);
        }
    }
}
