//! A creature for `--import`: its genotype, from a lineage or from a file, as the assignment that puts it into an
//! experiment (ESP E-90). Whether it is one that the experiment can begin with, the experiment says.

use std::path::Path;

use serde_json::Value;

use super::show::fetch;
use crate::connect::{Connection, Source};
use crate::exit::Failure;
use crate::render::number;

/// The assignment for an individual of a lineage, or for a file.
///
/// # Errors
/// Neither is there; a file of JSON without a genotype.
pub(super) async fn assignment(named: &str, lineage: &Source) -> Result<String, Failure> {
    let hex = match named.parse() {
        Ok(individual) => {
            let individual = fetch(&Connection::open(lineage).await?, individual).await?;
            number::hex(&individual.genotype.unwrap_or_default().payload)
        }
        Err(_) => of_file(Path::new(named))?,
    };
    Ok(format!("search.import=\"{hex}\""))
}

fn of_file(path: &Path) -> Result<String, Failure> {
    let place = path.display();
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            Failure::NotFound(format!("{place}: no such file, and no number of an individual"))
        }
        _ => Failure::Failed(anyhow::Error::new(error).context(place.to_string())),
    })?;
    // Canonical bytes begin a CBOR map, which is no text.
    let Ok(shown) = serde_json::from_slice::<Value>(&bytes) else { return Ok(number::hex(&bytes)) };
    let payload = shown.pointer("/genotype/payload").and_then(Value::as_str);
    payload
        .map(str::to_owned)
        .ok_or_else(|| Failure::Usage(format!("{place}: JSON without genotype.payload")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_holds_a_genotype_as_bytes_or_as_it_is_shown() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).unwrap();
            path
        };
        assert_eq!(of_file(&file("bytes", &[0xa1, 0x61, 0x62, 0x01])).unwrap(), "a1616201");
        let shown = br#"{"id": 7, "genotype": {"system": "esp", "payload": "a1616201"}}"#;
        assert_eq!(of_file(&file("shown.json", shown)).unwrap(), "a1616201");
        assert_eq!(of_file(&file("other.json", b"{}")).unwrap_err().exit() as u8, 2);
        assert_eq!(of_file(&folder.path().join("absent")).unwrap_err().exit() as u8, 3);
    }
}
