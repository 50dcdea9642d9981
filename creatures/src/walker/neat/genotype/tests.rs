//! Refusals X-5..X-8 and the round trip.

use super::*;
use crate::random::stream;
use crate::walker::Genotype as Walker;
use crate::walker::neat::Settings;
use proptest::prelude::*;

/// A crawler's founder (13 sensors, bias 13, outputs 14 and 15) with hidden nodes 16 and 20.
fn genotype() -> Genotype {
    let mut stream = stream(1, [0, 0, 0], "genotype test");
    let mut genotype = Genotype::random(BodyKind::Crawler, &Settings::default(), &mut stream);
    genotype.hidden = vec![16, 20];
    for (innovation, from, to) in [(30, 0, 16), (31, 16, 20), (35, 20, 14)] {
        let link = Link { innovation, from, to, weight: 0.5, enabled: true, recurrent: false };
        genotype.links.push(link);
    }
    genotype
}

/// The refused field after a change.
fn refused(change: impl FnOnce(&mut Genotype)) -> String {
    let mut genotype = genotype();
    change(&mut genotype);
    match Walker::decode(&genotype.encode()).unwrap_err() {
        DecodeError::Illegal { field, .. } => field,
        error => panic!("{error:?} names no field"),
    }
}

#[test]
fn a_genotype_survives_its_encoding_bit_for_bit() {
    let mut genotype = genotype();
    genotype.links[0].weight = -0.0;
    genotype.links[1].weight = 0.1 + 0.2;
    let decoded = Walker::decode(&genotype.encode()).unwrap();
    assert_eq!(decoded.encode(), genotype.encode());
    let Walker::Neat(decoded) = decoded else { panic!("another controller") };
    assert!(decoded.links[0].weight.is_sign_negative());
    assert_eq!(decoded, genotype);
}

///
#[test]
fn malformed_structure_is_refused_by_gene() {
    assert_eq!(refused(|g| g.links[3].innovation = g.links[2].innovation), "links[3].innovation");
    assert_eq!(refused(|g| g.links.swap(3, 4)), "links[4].innovation");
    assert_eq!(refused(|g| (g.links[5].from, g.links[5].to) = (4, 14)), "links[5].to");
    assert_eq!(refused(|g| g.links[30].from = 17), "links[30].from");
    assert_eq!(refused(|g| g.links[30].to = u32::MAX), "links[30].to");
    assert_eq!(refused(|g| g.links[30].to = 3), "links[30].to");
    assert_eq!(refused(|g| g.links[30].to = 13), "links[30].to");
    assert_eq!(refused(|g| g.hidden = vec![20, 16]), "hidden[1]");
    assert_eq!(refused(|g| g.hidden = vec![15, 16, 20]), "hidden[0]");
    assert_eq!(refused(|g| g.hidden = vec![16, 20, u32::MAX, u32::MAX]), "hidden[3]");
}

///
#[test]
fn a_cycle_of_links_that_are_not_recurrent_is_refused() {
    let back = Link { innovation: 40, from: 20, to: 16, weight: 1.0, enabled: false, recurrent: false };
    assert_eq!(refused(|g| g.links.push(back)), "links");
    assert_eq!(refused(|g| g.links.push(Link { from: 16, ..back })), "links");
    let mut recurrent = genotype();
    recurrent.links.push(Link { recurrent: true, ..back });
    Walker::decode(&recurrent.encode()).unwrap();
}

/// as deep as a genotype can be, without recursion.
#[test]
fn the_longest_chain_is_ordered() {
    let mut genotype = genotype();
    genotype.hidden = (16..NODES_MAX as u32).collect();
    genotype.links.truncate(28);
    for node in 16..NODES_MAX as u32 - 1 {
        let link = Link { innovation: 100 + node, from: node, to: node + 1, ..genotype.links[0] };
        genotype.links.push(link);
    }
    Walker::decode(&genotype.encode()).unwrap();
    let last = NODES_MAX as u32 - 1;
    let back = Link { innovation: 9000, from: last, to: 16, ..genotype.links[0] };
    genotype.links.push(back);
    assert!(Walker::decode(&genotype.encode()).is_err());
}

///
#[test]
fn weights_out_of_range_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, -8.001, 1e300] {
        assert_eq!(refused(|g| g.links[7].weight = bad), "links[7].weight");
    }
}

///
#[test]
fn too_many_nodes_links_or_bytes_are_refused() {
    assert_eq!(refused(|g| g.hidden = (16..NODES_MAX as u32 + 1).collect()), "hidden");
    assert_eq!(refused(|g| g.hidden = (16..NODES_MAX as u32 + 100).collect()), "hidden");
    let links = |count: u32| {
        let mut genotype = genotype();
        let link = |innovation| Link { innovation, ..genotype.links[0] };
        genotype.links = (0..count).map(link).collect();
        Walker::decode(&genotype.encode()).unwrap_err()
    };
    let message = links(LINKS_MAX as u32 + 1).to_string();
    assert!(message.contains("`links`") && message.contains("10000"), "{message}");
    assert!(matches!(links(40_000), DecodeError::TooLarge { .. }));
}

///
#[test]
fn a_genotype_without_links_is_legal() {
    let mut genotype = genotype();
    genotype.links.clear();
    Walker::decode(&genotype.encode()).unwrap();
}

#[test]
fn traits_tell_what_people_ask_about() {
    let expected = serde_json::json!({"hidden": 2, "links": 31, "recurrent": 0});
    assert_eq!(genotype().traits(), expected);
}

proptest! {
    /// Bytes damaged in one place are refused or are another legal genotype, and never panic.
    #[test]
    fn damaged_bytes_never_panic(place: proptest::sample::Index, byte: u8) {
        let mut bytes = genotype().encode();
        let place = place.index(bytes.len());
        bytes[place] = byte;
        if let Ok(genotype) = Walker::decode(&bytes) {
            prop_assert_eq!(&Walker::decode(&genotype.encode()).unwrap(), &genotype);
        }
    }
}
