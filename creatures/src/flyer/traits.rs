//! What people ask about a flyer without living it. Mass depends on the task's density, so that it is a measure
//! of the outcome and not here.

use super::Genotype;
use super::genotype::{BODY, FIRST_SEGMENT, Node, WING_ROOT};
use super::skeleton::{grow, span};
use std::f64::consts::PI;

impl Genotype {
    /// A flat JSON object: `segments` (of one side), `neurons` and `inputs` (before they are copied onto both
    /// sides), `span` (at rest, m), `volume` (of all cylinders, m³) and `body_share` (of the volume, and so of
    /// the mass).
    pub fn traits(&self) -> serde_json::Value {
        let neurons: usize = self.nodes.iter().map(|node| node.neurons.len()).sum();
        let inputs: usize = self.nodes.iter().map(|node| node.sources().count()).sum();
        let body = self.nodes[BODY].volume(self.nodes[BODY].length);
        let wing_root = self.nodes[WING_ROOT].volume(self.wing_root_length());
        let wing: f64 = self.nodes[FIRST_SEGMENT..].iter().map(|node| node.volume(node.length)).sum();
        let volume = body + wing_root + 2.0 * wing;
        serde_json::json!({
            "segments": self.segments(),
            "neurons": neurons,
            "inputs": inputs,
            "span": span(&grow(self, 0.0)),
            "volume": volume,
            "body_share": body / volume,
        })
    }
}

impl Node {
    /// Of the capped cylinder, built with some length, m³ (F-19).
    fn volume(&self, length: f64) -> f64 {
        let square = self.radius * self.radius;
        PI * square * length + 4.0 / 3.0 * PI * square * self.radius
    }
}

#[cfg(test)]
mod tests {
    use crate::flyer::skeleton::tests::worked_example;
    use crate::flyer::{Function, Kind, Neuron, Source};

    /// T-2, with a density of 0.01 kg/m³.
    #[test]
    fn traits_of_the_worked_example() {
        let traits = worked_example().traits();
        assert_eq!(
            (&traits["segments"], &traits["neurons"], &traits["inputs"]),
            (&2.into(), &0.into(), &0.into())
        );
        let close = |name: &str, expected: f64| {
            let found = traits[name].as_f64().unwrap();
            assert!((found - expected).abs() < 1e-4, "{name}: {found}");
        };
        close("span", 60.0);
        close("volume", 530.9292);
        close("body_share", 4.105014 / 5.309292);
    }

    #[test]
    fn neurons_and_inputs_are_counted_once_for_both_sides() {
        let mut genotype = worked_example();
        let source = Source { node: 1, kind: Kind::Sensor, index: 0, cross: false };
        genotype.nodes[1].effectors[0].inputs = vec![source; 2];
        genotype.nodes[2].effectors[0].inputs = vec![source; 3];
        genotype.nodes[3].neurons = vec![Neuron { function: Function::Sin, delay: 1, inputs: vec![source] }];
        let traits = genotype.traits();
        assert_eq!((&traits["neurons"], &traits["inputs"]), (&1.into(), &6.into()));
    }
}
