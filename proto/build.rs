//! Compiles the .proto files without protoc, and keeps the descriptor set for reflection.

use prost::Message;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let files = ["genotype", "fleet", "experiments", "lineage", "evaluation"]
        .map(|name| format!("hatchery/v1/{name}.proto"));
    let descriptors = protox::compile(&files, ["."])?;
    let out = std::path::PathBuf::from(std::env::var("OUT_DIR")?);
    std::fs::write(out.join("hatchery.v1.bin"), descriptors.encode_to_vec())?;
    tonic_prost_build::configure().bytes(".").btree_map(".").compile_fds(descriptors)?;
    println!("cargo:rerun-if-changed=hatchery");
    Ok(())
}
