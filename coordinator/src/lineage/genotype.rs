//! Genotypes at rest: a child as what differs from its parent. It opens none: they are bytes here.
//!
//! A genotype is stored as one zstd frame with its parent's bytes as raw content dictionary, in full at least
//! every [`CHAIN_MAX`] links, and as it is where compression does not pay.

use search::{Individual, Place};
use zstd::zstd_safe::{CCtx, CParameter, DCtx, get_error_name};

/// Links from a genotype to the full copy that it rests on, at most.
pub(crate) const CHAIN_MAX: u8 = 15;

/// Fast, and with a dictionary as small as the slow ones.
const LEVEL: i32 = 3;

/// Genotypes tried before a generation is taken for incompressible.
const TRIED_MIN: usize = 8;

/// Bytes of a genotype's digest.
pub(crate) const DIGEST: usize = 16;

/// What a genotype is known by at rest: the first half of its BLAKE3, enough against every accident.
pub(crate) fn digest(genotype: &[u8]) -> [u8; DIGEST] {
    let hash = blake3::hash(genotype);
    hash.as_bytes()[..DIGEST].try_into().expect("a BLAKE3 has 32 bytes")
}

/// A genotype ready to store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Packed {
    /// Of the genotype: see [`digest`].
    pub(crate) digest: [u8; DIGEST],
    /// Whose genotype is the dictionary.
    pub(crate) base: Option<Place>,
    /// Of the genotype, bytes.
    pub(crate) size: usize,
    /// A frame, or the genotype itself if `size` long.
    pub(crate) bytes: Vec<u8>,
}

/// The genotypes of one generation, kept to be dictionaries of the next.
#[derive(Debug, Default)]
pub(crate) struct Shelf {
    stage: u32,
    generation: u32,
    genotypes: Vec<(Vec<u8>, u8)>, // bytes, links to their full copy
}

impl Shelf {
    /// Its size in memory, about.
    pub(crate) fn bytes(&self) -> usize {
        self.genotypes.iter().map(|(bytes, _)| bytes.len()).sum()
    }

    fn find(&self, place: Place) -> Option<(&[u8], u8)> {
        if (place.stage, place.generation) != (self.stage, self.generation) {
            return None;
        }
        self.genotypes.get(place.index as usize).map(|(bytes, depth)| (bytes.as_slice(), *depth))
    }
}

/// Packs the genotypes of a generation, and shelves them for the next.
pub(crate) fn pack(
    shelf: &Shelf,
    stage: u32,
    generation: u32,
    individuals: &mut [Individual],
) -> (Vec<Packed>, Shelf) {
    let mut compressor = CCtx::create();
    let level = compressor.set_parameter(CParameter::CompressionLevel(LEVEL));
    level.expect("zstd has this level");
    let (mut tried, mut before, mut after) = (0, 0, 0);
    let mut packed = Vec::with_capacity(individuals.len());
    let mut next = Shelf { stage, generation, genotypes: Vec::with_capacity(individuals.len()) };
    for individual in individuals {
        let genotype = std::mem::take(&mut individual.genotype);
        let hopeless = tried >= TRIED_MIN && after * 20 > before * 19;
        let base = individual.parents.first().map(|parent| parent.place);
        let base = base.and_then(|place| shelf.find(place).map(|(bytes, depth)| (place, bytes, depth)));
        let base = base.filter(|(_, _, depth)| *depth < CHAIN_MAX);
        let frame = if hopeless { None } else { compress(&mut compressor, base.map(|b| b.1), &genotype) };
        if !hopeless {
            tried += 1;
            before += genotype.len();
            after += frame.as_ref().map_or(genotype.len(), Vec::len);
        }
        let digest = digest(&genotype);
        let size = genotype.len();
        let (base, depth, bytes) = match (frame, base) {
            (Some(frame), Some((place, _, depth))) => (Some(place), depth + 1, frame),
            (Some(frame), None) => (None, 0, frame),
            (None, _) => (None, 0, genotype.clone()),
        };
        packed.push(Packed { digest, base, size, bytes });
        next.genotypes.push((genotype, depth));
    }
    (packed, next)
}

/// A frame that is shorter than the genotype, or none.
fn compress<'d>(context: &mut CCtx<'d>, base: Option<&'d [u8]>, genotype: &[u8]) -> Option<Vec<u8>> {
    if let Some(base) = base {
        context.ref_prefix(base).ok()?; // for the next frame alone
    }
    let mut frame = Vec::with_capacity(zstd::zstd_safe::compress_bound(genotype.len()));
    context.compress2(&mut frame, genotype).ok()?;
    (frame.len() < genotype.len()).then_some(frame)
}

/// The genotype in a row, given the genotype of its base.
///
/// # Errors
/// What is wrong with it; the row is then not what was written.
pub(crate) fn unpack(bytes: Vec<u8>, size: usize, base: Option<&[u8]>) -> Result<Vec<u8>, String> {
    if bytes.len() == size {
        return Ok(bytes);
    }
    if size > creatures::encoding::SIZE_MAX {
        return Err(format!("a genotype of {size} bytes is over the limit"));
    }
    let mut context = DCtx::create();
    let mut genotype = Vec::with_capacity(size);
    base.map_or(Ok(0), |base| context.ref_prefix(base))
        .and_then(|_| context.decompress(&mut genotype, &bytes))
        .map_err(|code| format!("a genotype does not decompress: {}", get_error_name(code)))?;
    if genotype.len() != size {
        return Err(format!("a genotype has {} bytes where {size} were stored", genotype.len()));
    }
    Ok(genotype)
}

#[cfg(test)]
mod tests {
    use super::*;
    use search::Parent;

    fn individual(genotype: Vec<u8>, parent: Option<Place>) -> Individual {
        let parents = parent.map(|place| Parent { place, role: "only".to_owned() }).into_iter().collect();
        let traits = serde_json::json!({});
        Individual { genotype, parents, operator: "mutate".to_owned(), traits, inherits: None }
    }

    fn noise(seed: u64, size: usize) -> Vec<u8> {
        let mut bytes = vec![0; size];
        creatures::random::stream(seed, [0; 3], "noise").fill(&mut bytes);
        bytes
    }

    #[test]
    fn a_child_is_stored_as_what_differs_from_its_parent_and_in_full_every_sixteen_generations() {
        let mut genotype = noise(1, 2000);
        let mut shelf = Shelf::default();
        let mut decoded: Vec<Vec<u8>> = vec![];
        let mut full = vec![];
        for generation in 1..=40 {
            genotype[generation as usize * 7] ^= 0x55;
            let parent = (generation > 1).then(|| Place { stage: 0, generation: generation - 1, index: 0 });
            let mut individuals = [individual(genotype.clone(), parent)];
            let (packed, next) = pack(&shelf, 0, generation, &mut individuals);
            shelf = next;
            let [packed] = packed.try_into().expect("one in, one out");
            if packed.base.is_none() {
                full.push(generation);
            } else {
                assert!(packed.bytes.len() < 100, "{} bytes for one that differs in one", packed.bytes.len());
            }
            let base = packed.base.map(|place| decoded[place.generation as usize - 1].as_slice());
            decoded.push(unpack(packed.bytes, packed.size, base).unwrap());
            assert_eq!(decoded.last(), Some(&genotype));
            assert_eq!(packed.digest, digest(&genotype));
        }
        assert_eq!(full, [1, 17, 33]);
    }

    #[test]
    fn what_does_not_compress_is_stored_as_it_is() {
        let mut individuals: Vec<_> = (0..40).map(|i| individual(noise(i, 300), None)).collect();
        let (packed, _) = pack(&Shelf::default(), 0, 1, &mut individuals);
        for (i, packed) in packed.into_iter().enumerate() {
            assert_eq!(packed.bytes, noise(i as u64, 300));
            assert_eq!(unpack(packed.bytes, 300, None).unwrap(), noise(i as u64, 300));
        }
    }

    #[test]
    fn a_damaged_genotype_is_an_error_and_not_a_panic() {
        let mut individuals = [individual(vec![7; 900], None)];
        let (packed, _) = pack(&Shelf::default(), 0, 1, &mut individuals);
        let frame = packed[0].bytes.clone();
        assert!(frame.len() < 100);
        assert!(unpack(frame[..frame.len() - 3].to_vec(), 900, None).is_err());
        assert!(unpack(frame.clone(), 901, None).is_err());
        assert!(unpack(frame, usize::MAX, None).is_err());
    }
}
