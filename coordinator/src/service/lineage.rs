//! Questions to the lineage, over gRPC: parses, calls a reader, renders. It never writes.
//! It needs no coordinator: `hatchery --db FILE` serves it in its own process.

use crate::lineage::Reader;

/// The `Lineage` service over a reader.
#[derive(Clone)]
pub struct LineageService {
    reader: Reader,
}

impl LineageService {
    /// The service over a reader.
    pub fn new(reader: Reader) -> Self {
        LineageService { reader }
    }

    /// What it reads.
    pub fn reader(&self) -> &Reader {
        &self.reader
    }
}
