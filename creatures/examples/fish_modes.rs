//! How much of what practised muscles do is carried by how few modes: of muscle samples the frequencies, the
//! strongest first, each with its share of what swings and with what it makes up together with those before it.
//!
//! `hatchery --json show ID | cargo run --release -p creatures --example fish_modes`

use creatures::fish::{Genotype, abstraction};
use serde_json::Value;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let shown: Value = serde_json::from_reader(std::io::stdin())?;
    let payload = shown.pointer("/genotype/payload").and_then(Value::as_str).ok_or("it has no genotype")?;
    let Genotype::MuscleSamples(samples) = Genotype::decode(&bytes(payload)?)? else {
        return Err(format!("individual {} has no muscle samples", shown["id"]).into());
    };
    println!("individual {}", shown["id"]);
    let mut together = 0.0;
    for (frequency, share) in abstraction::shares(&samples) {
        together += share;
        println!("{frequency:6.3} by time  {:5.1} %  together {:5.1} %", 100.0 * share, 100.0 * together);
    }
    Ok(())
}

/// Bytes of their hexadecimal digits.
fn bytes(digits: &str) -> Result<Vec<u8>, Box<dyn Error>> {
    let pairs = (0..digits.len()).step_by(2).map(|at| digits.get(at..at + 2).ok_or("a digit too many"));
    pairs.map(|pair| Ok(u8::from_str_radix(pair?, 16)?)).collect()
}
