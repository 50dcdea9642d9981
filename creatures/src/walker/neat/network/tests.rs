//! T-13 and the network's degenerate cases.

use super::*;
use crate::walker::body::BodyKind;
use crate::walker::neat::Link;

/// T-13 on the crawler's numbers: sensors 0..12, bias 13, outputs 14 and 15, hidden 16 in the places of
/// 0..2, 3, 4 and 5, 6.
fn network(enabled: bool) -> Network {
    let links = [
        (0, 14, 0.5, true, false),
        (1, 14, -0.3, true, false),
        (2, 14, 0.8, false, false),
        (13, 14, 0.1, true, false),
        (0, 15, -0.6, true, false),
        (1, 15, 0.2, true, false),
        (2, 15, -0.9, true, false),
        (13, 15, 0.4, true, false),
        (2, 16, 1.0, true, false),
        (16, 14, 0.8, true, false),
        (15, 16, 0.7, true, true),
        (14, 14, -0.5, true, true),
    ];
    let link = |(innovation, (from, to, weight, on, recurrent))| Link {
        innovation,
        from,
        to,
        weight,
        enabled: on && enabled,
        recurrent,
    };
    let links = (0..).zip(links).map(link).collect();
    Network::new(&Genotype { body: BodyKind::Crawler, hidden: vec![16], links })
}

fn sensors() -> [f64; 13] {
    let mut sensors = [0.0; 13];
    sensors[..3].copy_from_slice(&[0.5, -1.0, 0.25]);
    sensors
}

/// T-13
#[test]
fn a_network_passes_values_forward_and_remembers_over_recurrent_links() {
    let mut network = network(true);
    let first = [0.358131813155, 0.256980030320, 0.280440533419, 0.275027840727, 0.276278193363];
    for (step, expected) in first.into_iter().enumerate() {
        network.step(&sensors());
        let hidden = if step == 0 { 0.124353001772 } else { 0.068512883518 };
        let found = [network.outputs()[0], network.outputs()[1], network.hidden()[0]];
        for (found, expected) in found.into_iter().zip([expected, -0.161084609641, hidden]) {
            assert!((found - expected).abs() < 1e-9, "step {step}: {found} is not {expected}");
        }
    }
}

/// T-13
#[test]
fn the_node_function_is_the_bipolar_sigmoid() {
    assert_eq!(activation(0.0), 0.0);
    assert!((activation(1.0) - 0.462117157260).abs() < 1e-9);
    assert!((activation(-1.0) + activation(1.0)).abs() < 1e-15);
    assert!((activation(4.0) - 0.964027580076).abs() < 1e-9);
    assert_eq!((activation(1e6), activation(-1e6)), (1.0, -1.0));
}

///
#[test]
fn an_output_without_enabled_links_stays_at_zero() {
    let mut network = network(false);
    network.step(&sensors());
    assert_eq!(network.outputs(), [0.0, 0.0]);
}
