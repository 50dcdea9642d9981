//! The state as a checkpoint has it (ESP E-84). Genotypes are taken apart into blocks, a body or one skill's
//! control, each written once: what is locked is the same in a whole population.

use super::archive::{Archive, Kept};
use super::crowd::{Crowd, Member};
use super::fingerprints::{Fingerprints, Progress};
use super::learned::Learned;
use super::ledger::Ledger;
use super::search::{Base, State};
use super::settings::{KIND, Settings};
use crate::Place;
use crate::checkpoint::{self, GenotypeBytes, RestoreError};
use crate::inheritance::{Ending, Scored};
use creatures::esp::body::Body;
use creatures::esp::brain::{Brain, Control};
use creatures::esp::genotype::Genotype;
use creatures::esp::syllabus::{SkillId, Syllabus};
use creatures::{DecodeError, encoding};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A genotype as the numbers of its blocks: the body's, then those of the controls in their order.
type Line = Vec<u32>;

/// A checkpoint, its genotypes still closed.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Written {
    /// Of the syllabus with which it was written.
    pub(super) fingerprints: Fingerprints,
    learned: Vec<Learned>,
    current: Option<SkillId>,
    base: Option<(Line, Option<Place>)>,
    part: u32,
    stage: u32,
    at: (u32, u32),
    members: Vec<(Line, f64, Ending, bool)>,
    archive: Vec<Vec<WrittenKept>>,
    awaiting: bool,
    stuck: Vec<u32>,
    ledger: Ledger,
    picks: Vec<(SkillId, Place, u32)>,
    failure: Option<String>,
    blocks: Vec<GenotypeBytes>,
}

#[derive(Debug, Serialize, Deserialize)]
struct WrittenKept {
    genotype: Line,
    place: Place,
    fitness: f64,
    trials: Vec<f64>,
    retests: Vec<(SkillId, f64)>,
}

/// The checkpoint of a state.
pub(super) fn write(settings: &Settings, state: &State) -> Vec<u8> {
    let mut blocks = Blocks::default();
    let base = state.base.as_ref().map(|base| (blocks.line(&base.genotype), base.place));
    let member = |member: &Member| {
        let Scored { fitness, ending, .. } = member.scored;
        (blocks.line(&member.genotype), fitness, ending, member.stopped)
    };
    let members = state.crowd.members.iter().map(member).collect();
    let mut kept = |kept: &Kept| WrittenKept {
        genotype: blocks.line(&kept.genotype),
        place: kept.place,
        fitness: kept.fitness,
        trials: kept.trials.clone(),
        retests: kept.retests.clone(),
    };
    let archive = state.archive.populations.iter().map(|all| all.iter().map(&mut kept).collect()).collect();
    checkpoint::write(
        KIND,
        &Written {
            fingerprints: Fingerprints::of(settings),
            learned: state.learned.clone(),
            current: state.current,
            base,
            part: state.part as u32,
            stage: state.stage,
            at: state.crowd.at,
            members,
            archive,
            awaiting: state.awaiting,
            stuck: state.stuck.clone(),
            ledger: state.ledger.clone(),
            picks: state.picks.clone(),
            failure: state.failure.clone(),
            blocks: blocks.blocks,
        },
    )
}

/// Reads a checkpoint, and opens none of its genotypes.
///
/// # Errors
/// Bytes that are no checkpoint of a syllabus.
pub(super) fn read(bytes: &[u8]) -> Result<Written, RestoreError> {
    checkpoint::read(KIND, bytes)
}

impl Written {
    /// How far the search has come.
    pub(super) fn progress(&self) -> Progress {
        Progress { learned: self.learned.iter().map(|one| one.skill).collect(), current: self.current }
    }

    /// The state, every genotype checked.
    ///
    /// # Errors
    /// A genotype that is not legal for this syllabus.
    pub(super) fn state(self, settings: &Settings) -> Result<State, RestoreError> {
        let mut reader = Reader { written: &self.blocks, bodies: BTreeMap::new(), controls: BTreeMap::new() };
        let mut index = 0;
        let mut genotype = |line: &Line| {
            index += 1;
            reader.genotype(line, index - 1, &settings.syllabus)
        };
        let base = match &self.base {
            Some((line, place)) => Some(Base { genotype: genotype(line)?, place: *place }),
            None => None,
        };
        let mut members = Vec::with_capacity(self.members.len());
        for (line, fitness, ending, stopped) in &self.members {
            let genotype = genotype(line)?;
            let bytes = GenotypeBytes(genotype.encode());
            let scored = Scored { genotype: bytes, fitness: *fitness, ending: *ending };
            members.push(Member { genotype, scored, stopped: *stopped });
        }
        let mut populations = Vec::with_capacity(self.archive.len());
        for written in self.archive {
            let kept = written.into_iter().map(|kept| {
                let genotype = genotype(&kept.genotype)?;
                let WrittenKept { place, fitness, trials, retests, .. } = kept;
                Ok(Kept { genotype, place, fitness, trials, retests })
            });
            populations.push(kept.collect::<Result<_, RestoreError>>()?);
        }
        Ok(State {
            learned: self.learned,
            current: self.current,
            base,
            part: self.part as usize,
            stage: self.stage,
            crowd: Crowd::standing(self.at, members),
            archive: Archive { populations },
            awaiting: self.awaiting,
            stuck: self.stuck,
            ledger: self.ledger,
            picks: self.picks,
            failure: self.failure,
        })
    }
}

/// Blocks in the order in which they were first met.
#[derive(Default)]
struct Blocks {
    blocks: Vec<GenotypeBytes>,
    numbers: BTreeMap<Vec<u8>, u32>,
}

impl Blocks {
    fn line(&mut self, genotype: &Genotype) -> Line {
        let body = encoding::encode(&genotype.body);
        let controls = genotype.brain.controls.iter().map(encoding::encode);
        std::iter::once(body).chain(controls).map(|block| self.number(block)).collect()
    }

    fn number(&mut self, block: Vec<u8>) -> u32 {
        if let Some(&number) = self.numbers.get(&block) {
            return number;
        }
        let number = self.blocks.len() as u32;
        self.blocks.push(GenotypeBytes(block.clone()));
        self.numbers.insert(block, number);
        number
    }
}

/// Blocks that are read once each.
struct Reader<'a> {
    written: &'a [GenotypeBytes],
    bodies: BTreeMap<u32, Body>,
    controls: BTreeMap<u32, Control>,
}

impl Reader<'_> {
    /// The genotype of a line, checked.
    fn genotype(&mut self, line: &Line, index: usize, syllabus: &Syllabus) -> Result<Genotype, RestoreError> {
        let illegal = |source: DecodeError| RestoreError::Genotype { index, source };
        let Some((&body, controls)) = line.split_first() else {
            return Err(RestoreError::Unfit("it has a genotype without a body"));
        };
        let body = block(self.written, &mut self.bodies, body, index)?;
        let control = |&number| block(self.written, &mut self.controls, number, index);
        let controls = controls.iter().map(control).collect::<Result<_, _>>()?;
        let genotype = Genotype { body, brain: Brain { controls } };
        genotype.body.check().map_err(illegal)?;
        genotype.check(syllabus).map_err(illegal)?;
        Ok(genotype)
    }
}

fn block<T: Clone + serde::de::DeserializeOwned>(
    blocks: &[GenotypeBytes],
    known: &mut BTreeMap<u32, T>,
    number: u32,
    index: usize,
) -> Result<T, RestoreError> {
    if let Some(block) = known.get(&number) {
        return Ok(block.clone());
    }
    let Some(bytes) = blocks.get(number as usize) else {
        return Err(RestoreError::Unfit("it has a genotype with a block that is not there"));
    };
    let block: T = encoding::decode(&bytes.0).map_err(|source| RestoreError::Genotype { index, source })?;
    known.insert(number, block.clone());
    Ok(block)
}
