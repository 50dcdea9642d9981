//! Writes a lineage of a given size without physics, to measure questions and restarts on.

use std::path::PathBuf;

use clap::Parser;
use hatchery_benches::pedigree::{Size, make};

/// Write a large lineage: real searches and genotypes, drawn fitness
#[derive(Debug, Parser)]
struct Arguments {
    /// The file to make
    file: PathBuf,
    /// Repetitions; 42 of the default size are a million individuals
    #[arg(long, default_value_t = Size::MILLION.runs)]
    runs: u32,
    /// Generations of each run
    #[arg(long, default_value_t = Size::MILLION.generations)]
    generations: u32,
    /// Individuals of each generation
    #[arg(long, default_value_t = Size::MILLION.population)]
    population: u32,
}

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let Arguments { file, runs, generations, population } = Arguments::parse();
    let size = Size { runs, generations, population };
    let made = make(&file, size).await?;
    println!(
        "{} individuals; {:.1} s of writing; youngest {}",
        size.individuals(),
        made.seconds,
        made.youngest
    );
    Ok(())
}
