//! One run from generation to generation: taken up where it stands, told, asked, and opened in the lineage
//! before anything is handed out. It waits for no outcome.

use std::sync::Arc;
use std::time::Instant;

use bytes::Bytes;
use creatures::Cull;
use search::{Place, Search};

use super::ahead::{Ahead, Next};
use super::conduct::{ConductError, Conductor, take_over};
use super::generation::{Generation, Inherited};
use super::progress::{Ended, Happening, Tally};
use crate::fleet::{Evaluation, TaskText};
use crate::lineage::{
    CloseGeneration, Culling, EndStage, InStage, NewChoice, NewStage, OpenGeneration, ResumePoint, StageId,
    Standing, StoredStage, evaluation_seed,
};

/// One run under way.
pub(super) struct Run {
    /// From 1.
    pub(super) number: u32,
    pub(super) stage: StageId,
    /// As the search names it.
    pub(super) named: search::Stage,
    task: Arc<TaskText>,
    search: Box<dyn Search>,
    pub(super) generation: Generation,
    inherited: u32,
    opened: Instant,
    /// To be handed out once the run waits for them: an outcome that came before would find nobody.
    pub(super) evaluations: Vec<Evaluation>,
    /// Of this generation.
    culling: Option<Culling>,
}

/// A run that waits for a pick at the end of a stage.
pub(super) struct Waiting {
    /// From 1.
    pub(super) number: u32,
    pub(super) stage: StageId,
    /// The stage's.
    pub(super) name: String,
    search: Box<dyn Search>,
}

/// Where a run stands after a turn.
pub(super) enum Step {
    /// In a generation.
    Goes(Box<Run>),
    /// At the end of a stage, for a pick.
    Waits(Waiting),
    /// At its end: its number.
    Over(u32),
}

/// What a run has behind it when its search is asked.
enum Behind {
    /// Nothing, but perhaps a stage that was opened.
    Nothing(Option<StageId>),
    /// A generation that the search was told of.
    Told(Told),
    /// A stage that had ended before; its name, and whether its candidates are on file.
    Ended(StageId, String, bool),
}

/// A generation that has ended, with its stage.
struct Told {
    stage: StageId,
    named: search::Stage,
    generation: Generation,
    close: CloseGeneration,
}

impl Conductor {
    /// Takes a run up where it stands.
    pub(super) async fn take_up(&self, number: u32) -> Result<Step, ConductError> {
        let reader = self.driver.shared.lineage.reader();
        let path = self.path(number);
        let Some(latest) = path.last() else {
            let search = self.experiment.start(number);
            return self.go_on(number, search, None, Behind::Nothing(None)).await;
        };
        if latest.over {
            return Ok(Step::Over(number));
        }
        if let Some(point) = self.resume_point(latest.id).await? {
            let run = self.resume(number, &path, point).await?;
            return Ok(Step::Goes(Box::new(run)));
        }
        if !latest.ended {
            let search = self.experiment.start(number);
            return self.go_on(number, search, None, Behind::Nothing(Some(latest.id))).await;
        }
        let search = self.restore(number, &path, latest.latest + 1).await?;
        let picked = reader.picked(self.id, latest.id).await?;
        let offered = reader.choices(self.id).await?.iter().any(|choice| choice.stage == latest.id);
        let behind = Behind::Ended(latest.id, latest.name.clone(), offered);
        self.go_on(number, search, picked, behind).await
    }

    /// The latest stages that a run went through; of a fork from the one where it forks, which was not the last.
    fn path(&self, number: u32) -> Vec<StoredStage> {
        let forked = self.origin.iter().zip(self.stored.origin).flat_map(|(origin, fork)| {
            let stages = origin.stages.iter().filter(move |stage| stage.stage == fork.stage);
            stages.cloned().map(|stage| StoredStage { over: false, ..stage })
        });
        let own = self.stored.stages.iter().cloned();
        forked.chain(own).filter(|stage| stage.run == number).collect()
    }

    /// Goes on with a generation that stands in the lineage.
    async fn resume(
        &self,
        number: u32,
        path: &[StoredStage],
        point: ResumePoint,
    ) -> Result<Run, ConductError> {
        let stage = path.last().expect("a run that stands in a generation has a stage");
        let mut search = self.restore(number, path, point.generation).await?;
        let individuals = tokio::task::block_in_place(|| search.ask());
        let named = search.stage();
        let task = named.task.as_ref().map(serde_json::Value::to_string);
        let stands = named.number == stage.stage && task == point.task_json;
        let (true, Some(first)) =
            (stands && same(&individuals, &point.individuals), point.individuals.first())
        else {
            let at = place(&stage.name, point.generation);
            return Err(ConductError::OtherHistory { run: number, at });
        };
        let known = |standing: &[Standing]| {
            standing.iter().map(|one| one.ending.clone().map(Result::ok)).collect::<Vec<_>>()
        };
        let previous = point.previous.first().map(|first| {
            let none = vec![None; point.previous.len()];
            Generation::new(point.generation - 1, first.id, &none, known(&point.previous), None).0
        });
        let inherits: Vec<_> = individuals.iter().map(|individual| individual.inherits).collect();
        let settled = known(&point.individuals);
        let on_disk = settled.iter().flatten().count();
        let (generation, inherited) =
            Generation::new(point.generation, first.id, &inherits, settled, previous.as_ref());
        let run = self.run(number, stage.id, named, search, generation, point.culling);
        self.begin(run, individuals, inherited, on_disk).await
    }

    fn run(
        &self,
        number: u32,
        stage: StageId,
        named: search::Stage,
        search: Box<dyn Search>,
        generation: Generation,
        culling: Option<Culling>,
    ) -> Run {
        let task = named.task.as_ref().map_or_else(
            || self.task.clone(),
            |task| {
                let stored = &self.stored;
                Arc::new(TaskText::new(&stored.system, stored.system_version, &task.to_string()))
            },
        );
        let (opened, evaluations) = (Instant::now(), Vec::new());
        Run { number, stage, named, task, search, generation, inherited: 0, opened, evaluations, culling }
    }

    /// Tells the search a whole generation and opens the next.
    pub(super) async fn turn(&self, mut run: Run) -> Result<Step, ConductError> {
        let outcomes = run.generation.outcomes();
        let record = tokio::task::block_in_place(|| run.search.tell(&outcomes));
        let seconds = run.opened.elapsed().as_secs_f64();
        let ended = Ended {
            run: run.number,
            stage: run.named.number,
            stage_name: run.named.name.clone(),
            generation: run.generation.number,
            generations: self.generations(&run.named),
            tally: Tally::of(&outcomes),
            inherited: run.inherited,
            best: run.generation.best().map(|(id, _)| id),
            seconds,
            notes: serde_json::Value::Object(record.notes.clone()).to_string(),
        };
        let close = CloseGeneration { record, wall_seconds: seconds };
        let Run { number, stage, named, search, generation, .. } = run;
        let told = Told { stage, named, generation, close };
        let next = self.go_on(number, search, None, Behind::Told(told)).await;
        if matches!(next, Ok(_) | Err(ConductError::GaveUp(_))) {
            // Nobody listening is no error.
            let _ = self.driver.shared.happenings.send(Happening::Generation(self.id, Box::new(ended)));
        }
        next
    }

    /// Goes on with whoever was picked.
    pub(super) async fn follow(&self, waiting: Waiting, picked: Place) -> Result<Step, ConductError> {
        let Waiting { number, stage, name, search } = waiting;
        self.go_on(number, search, Some(picked), Behind::Ended(stage, name, true)).await
    }

    /// Asks the search what is next, writes that down with the end of what was before, and makes it ready to
    /// be handed out.
    async fn go_on(
        &self,
        number: u32,
        mut search: Box<dyn Search>,
        picked: Option<Place>,
        behind: Behind,
    ) -> Result<Step, ConductError> {
        let lineage = &self.driver.shared.lineage;
        let refuse = |problem| ConductError::Search { run: number, problem };
        let ahead = tokio::task::block_in_place(|| Ahead::of(&mut *search, picked)).map_err(refuse)?;
        let Ahead { told, chosen, next } = ahead;
        let last = match &behind {
            Behind::Nothing(_) => None,
            Behind::Told(of) => Some((of.stage, of.named.name.clone())),
            Behind::Ended(stage, name, _) => Some((*stage, name.clone())),
        };
        let choice = |(candidates, picked)| {
            let (stage, _) =
                last.clone().ok_or_else(|| refuse("lets pick before anybody lived".to_owned()))?;
            Ok::<_, ConductError>(NewChoice { experiment: self.id, stage, candidates, picked })
        };
        let chosen = chosen.map(|(candidates, place)| choice((candidates, Some(place)))).transpose()?;
        let (individuals, named, state) = match next {
            Next::Asks { individuals, stage, state } => (individuals, stage, state),
            Next::Waits(candidates) => {
                let choice = choice((candidates, None))?;
                match behind {
                    Behind::Told(Told { stage, close, .. }) => {
                        let ends = EndStage { stage, close, checkpoint: told, over: false };
                        lineage.end_stage(ends, Some(choice)).await?;
                    }
                    Behind::Ended(_, _, false) => lineage.choose(choice).await?,
                    Behind::Ended(_, _, true) | Behind::Nothing(_) => {}
                }
                let (stage, name) = last.expect("without it there is no choice");
                return Ok(Step::Waits(Waiting { number, stage, name, search }));
            }
            Next::Over | Next::GivesUp(_) => {
                match behind {
                    Behind::Told(Told { stage, close, .. }) => {
                        let ends = EndStage { stage, close, checkpoint: told, over: true };
                        lineage.end_stage(ends, chosen).await?;
                    }
                    Behind::Ended(..) => {}
                    Behind::Nothing(_) => return Err(refuse("asks for nobody".to_owned())),
                }
                return match next {
                    Next::GivesUp(reason) => Err(ConductError::GaveUp(reason)),
                    _ => Ok(Step::Over(number)),
                };
            }
        };
        let previous = match &behind {
            Behind::Told(of) if of.named.number == named.number => Some(&of.generation),
            _ => None,
        };
        let new = || {
            InStage::New(NewStage {
                experiment: self.id,
                run: number,
                stage: named.number,
                name: named.name.clone(),
                seed: self.experiment.seed_of(number),
                generations: self.generations(&named),
                task_json: named.task.as_ref().map(serde_json::Value::to_string),
            })
        };
        let generation = previous.map_or(1, |previous| previous.number + 1);
        let (stage, close, ends) = match &behind {
            Behind::Nothing(Some(stage)) => (InStage::Open(*stage, named.number), None, None),
            Behind::Nothing(None) | Behind::Ended(..) => (new(), None, None),
            Behind::Told(of) if previous.is_some() => {
                (InStage::Open(of.stage, named.number), Some(of.close.clone()), None)
            }
            Behind::Told(of) => {
                let (stage, close) = (of.stage, of.close.clone());
                (new(), None, Some(EndStage { stage, close, checkpoint: told, over: false }))
            }
        };
        let task = named.task.as_ref().unwrap_or_else(|| self.experiment.task());
        let culling = self.experiment.culling().map(|rule| Culling {
            at: rule.at,
            cutoff: previous.and_then(|previous| {
                rule.cutoff(&previous.outcomes(), self.experiment.interim_measure(task))
            }),
        });
        let opened = OpenGeneration {
            stage,
            generation,
            checkpoint: state,
            culling,
            individuals: individuals.clone(),
            close,
            ends,
            choice: chosen,
        };
        let (stage, ids) = lineage.open_generation(opened).await?;
        let inherits: Vec<_> = individuals.iter().map(|individual| individual.inherits).collect();
        let none = vec![None; individuals.len()];
        let (generation, inherited) = Generation::new(generation, ids[0], &inherits, none, previous);
        let run = self.run(number, stage, named, search, generation, culling);
        let run = self.begin(run, individuals, inherited, 0).await?;
        Ok(Step::Goes(Box::new(run)))
    }

    /// Records what needs no evaluation and makes the others ready to be handed out. So many outcomes were on disk
    /// before.
    async fn begin(
        &self,
        mut run: Run,
        individuals: Vec<search::Individual>,
        inherited: Vec<Inherited>,
        on_disk: usize,
    ) -> Result<Run, ConductError> {
        run.inherited = individuals.iter().filter(|individual| individual.inherits.is_some()).count() as u32;
        self.driver.shared.lineage.record(inherited.into_iter().map(take_over).collect()).await?;
        let unsettled = run.generation.unsettled();
        self.progress.settled(individuals.len() - unsettled.len() - on_disk, 0);
        self.progress.generation(&run);
        let mut individuals: Vec<_> = individuals.into_iter().map(Some).collect();
        for index in unsettled {
            let individual = individuals[index].take().expect("each index is unsettled once");
            run.evaluations.push(self.evaluation(&run, index, individual.genotype));
        }
        Ok(run)
    }

    /// What a run asks of the fleet for one of its individuals.
    pub(super) fn evaluation(&self, run: &Run, index: usize, genotype: Vec<u8>) -> Evaluation {
        let seed = self.experiment.seed_of(run.number);
        let (stage, generation) = (run.named.number, run.generation.number);
        let place = Place { stage, generation, index: index as u32 };
        Evaluation {
            id: run.generation.id(index).expect("the index is within the generation").0,
            order: (run.number, place.generation, place.index),
            task: run.task.clone(),
            genotype: Bytes::from(genotype),
            seed: evaluation_seed(seed, place),
            cull: run.culling.map(|culling| Cull {
                at: culling.at,
                cutoff: culling.cutoff,
                control: self.experiment.culling().is_some_and(|rule| rule.in_control(seed, place)),
            }),
            audit: self.experiment.audits(seed, place),
            attempts_before: 0,
        }
    }

    /// How many generations a stage takes, when known.
    fn generations(&self, stage: &search::Stage) -> Option<u32> {
        stage.generations.or_else(|| self.experiment.generations())
    }
}

/// Whether a search asks for just those that stand in the lineage.
pub(super) fn same(asked: &[search::Individual], standing: &[Standing]) -> bool {
    asked.len() == standing.len()
        && asked.iter().zip(standing).all(|(asked, standing)| standing.has(&asked.genotype))
}

/// For messages: `stage left_turn, generation 12`.
pub(super) fn place(stage: &str, generation: u32) -> String {
    match stage {
        "" => format!("generation {generation}"),
        stage => format!("stage `{stage}`, generation {generation}"),
    }
}
