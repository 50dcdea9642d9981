//! Audits: an evaluation that was chosen for one counts only once two workers found the same bits. A worker that two
//! others contradict is quarantined, and what rests on its word alone is found again. It chooses nobody: that comes
//! with the evaluation.
//!
//! A second opinion takes another worker. While there is none, and has been none for a while, the first one counts
//! unaudited, and says so. Two opinions that differ wait for a third, however long that takes.

use super::entry::Entry;
use super::queue::Rank;
use super::{AttemptId, Loss, Millis, QueueId, Scheduler, WorkerId};
use crate::lineage::{Audited, Fate, Ruling, SetAside};
use creatures::Outcome;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// So long must a worker have been without company before its word counts alone, milliseconds: another one may be
/// about to come back.
pub(super) const ALONE_MS: u64 = 5_000;

/// What one worker found.
#[derive(Debug, Clone)]
pub(super) struct Opinion {
    /// The attempt.
    pub(super) number: u32,
    pub(super) worker: Arc<str>,
    pub(super) finding: Result<Outcome, SetAside>,
    pub(super) ruling: Option<Ruling>,
}

impl Opinion {
    /// Bit for bit. Two refusals agree, however they are worded.
    fn agrees(&self, other: &Opinion) -> bool {
        match (&self.finding, &other.finding) {
            (Ok(one), Ok(other)) => one.digest() == other.digest(),
            (Err(_), Err(_)) => true,
            _ => false,
        }
    }
}

/// A worker that two others contradicted.
#[derive(Debug, Clone, PartialEq)]
pub struct Quarantine {
    /// Its name.
    pub worker: String,
    /// Over which evaluation.
    pub evaluation: u64,
    /// What it found.
    pub found: Result<Outcome, SetAside>,
    /// What the others found.
    pub against: Result<Outcome, SetAside>,
    /// Who they are.
    pub witnesses: Vec<String>,
}

/// Evaluations that wait for another opinion, by queue and by who has given one: all of a group can go to the same
/// workers.
#[derive(Debug, Default)]
pub(super) struct Awaiting {
    groups: BTreeMap<Group, BTreeSet<Rank>>,
}

type Group = (QueueId, Vec<Arc<str>>);

fn group(entry: &Entry) -> Group {
    let mut names: Vec<_> = entry.opinions.iter().map(|opinion| opinion.worker.clone()).collect();
    names.sort_unstable();
    (entry.queue, names)
}

impl Awaiting {
    fn insert(&mut self, entry: &Entry) {
        self.groups.entry(group(entry)).or_default().insert(entry.rank());
    }

    /// Whether it was there.
    pub(super) fn remove(&mut self, entry: &Entry) -> bool {
        let key = group(entry);
        let Some(ranks) = self.groups.get_mut(&key) else { return false };
        let was_there = ranks.remove(&entry.rank());
        if ranks.is_empty() {
            self.groups.remove(&key);
        }
        was_there
    }

    #[cfg(test)]
    pub(super) fn holds(&self, entry: &Entry) -> bool {
        self.groups.get(&group(entry)).is_some_and(|ranks| ranks.contains(&entry.rank()))
    }

    pub(super) fn len(&self) -> usize {
        self.groups.values().map(BTreeSet::len).sum()
    }

    /// How many wait for the decision between opinions that differ.
    pub(super) fn disputed(&self) -> usize {
        let disputed = self.groups.iter().filter(|((_, names), _)| names.len() > 1);
        disputed.map(|(_, ranks)| ranks.len()).sum()
    }
}

impl Scheduler {
    /// Takes down what a worker found, and decides if that is enough.
    pub(super) fn opine(
        &mut self,
        evaluation: u64,
        at: usize,
        finding: Result<Outcome, SetAside>,
        now: Millis,
    ) {
        self.withdraw(evaluation);
        let entry = self.evaluations.get_mut(&evaluation).expect("the caller has found it open");
        let tried = &mut entry.attempts[at];
        let (worker, name) = (tried.worker, tried.name.clone());
        let opinion = Opinion { number: tried.number, worker: name.clone(), finding, ruling: tried.ruling };
        entry.opinions.push(opinion);
        // Of the same worker a second opinion is not worth having.
        let mut ended = Vec::new();
        for (place, tried) in entry.attempts.iter_mut().enumerate() {
            if tried.fate.is_none() && (place == at || tried.worker == worker) {
                ended.push((tried.worker, tried.seat, tried.number));
                tried.fate = Some(Fate::Duplicate);
            }
        }
        let number = entry.attempts[at].number;
        // Until it is known whether others agree.
        entry.attempts[at].fate = Some(Fate::Confirmed);
        for (worker, seat, ended) in ended {
            self.release(worker, seat, evaluation, now);
            if ended != number {
                self.revoke(worker, AttemptId { evaluation, number: ended });
            }
        }
        self.decide(evaluation, now);
    }

    /// Settles an evaluation on which two agree, or sees to another opinion.
    fn decide(&mut self, evaluation: u64, now: Millis) {
        let entry = &self.evaluations[&evaluation];
        let opinions = &entry.opinions;
        let agreed = (0..opinions.len())
            .find(|&first| opinions[first + 1..].iter().any(|other| opinions[first].agrees(other)));
        match agreed {
            Some(first) => self.conclude(evaluation, first, Audited::Agreed, now),
            None => self.retry(evaluation, now),
        }
    }

    /// Puts an evaluation where it waits for somebody who has not given an opinion.
    pub(super) fn await_opinion(&mut self, evaluation: u64) {
        self.awaiting.insert(&self.evaluations[&evaluation]);
    }

    /// Settles an evaluation with one of its opinions. Whoever found something else is quarantined.
    pub(super) fn conclude(&mut self, evaluation: u64, first: usize, audit: Audited, now: Millis) {
        self.withdraw(evaluation);
        let entry = self.evaluations.get_mut(&evaluation).expect("the caller has found it open");
        let opinions = std::mem::take(&mut entry.opinions);
        let counted = &opinions[first];
        let (agreeing, dissenting): (Vec<_>, Vec<_>) =
            opinions.iter().partition(|opinion| opinion.agrees(counted));
        for opinion in &opinions {
            let Some(tried) = entry.attempts.iter_mut().find(|tried| tried.number == opinion.number) else {
                continue;
            };
            tried.fate = Some(match &opinion.finding {
                _ if !opinion.agrees(counted) => Fate::Refuted,
                Err(SetAside { reason }) => Fate::Failed(reason.clone()),
                Ok(_) if opinion.number == counted.number => Fate::Counted,
                Ok(_) => Fate::Confirmed,
            });
        }
        let queue = entry.queue;
        if let Some(tried) = entry.attempts.iter().find(|tried| tried.number == counted.number) {
            let queue = self.queues.get_mut(&queue).expect("queues outlive their evaluations");
            queue.durations.observe(tried.seconds);
        }
        self.settle(evaluation, counted.finding.clone(), counted.ruling, Some(audit), now);
        for opinion in dissenting {
            self.quarantine(
                opinion.worker.clone(),
                Quarantine {
                    worker: opinion.worker.to_string(),
                    evaluation,
                    found: opinion.finding.clone(),
                    against: counted.finding.clone(),
                    witnesses: agreeing.iter().map(|opinion| opinion.worker.to_string()).collect(),
                },
                now,
            );
        }
    }

    /// Hands out what waits for another opinion, before anything else: a generation ends with its audits.
    pub(super) fn hand_out_audits(&mut self, now: Millis) {
        self.give_up_audits(now);
        while let Some((group, worker)) = self.next_audit() {
            let ranks = self.awaiting.groups.get_mut(&group).expect("it was found there");
            let rank = ranks.pop_first().expect("groups are not empty");
            if ranks.is_empty() {
                self.awaiting.groups.remove(&group);
            }
            self.queues.get_mut(&group.0).expect("queues outlive their evaluations").charge();
            self.file_queue(group.0);
            self.lease(rank.evaluation, worker, false, now);
        }
    }

    /// The least loaded worker that may give an opinion, and on what.
    pub(super) fn next_audit(&self) -> Option<(Group, WorkerId)> {
        if self.awaiting.groups.is_empty() {
            return None;
        }
        self.free.iter().find_map(|&(_, worker)| {
            let name = &self.workers[&worker].name;
            let fits = |(queue, names): &&Group| !self.queues[queue].paused && !names.contains(name);
            self.awaiting.groups.keys().find(fits).map(|group| (group.clone(), worker))
        })
    }

    /// Lets single opinions count of which nobody is there to give a second one.
    fn give_up_audits(&mut self, now: Millis) {
        let mut takers = self.workers.values().filter(|worker| worker.takes());
        let (one, another) = (takers.next(), takers.next());
        if another.is_some() {
            self.company = now;
            return;
        }
        let Some(lone) = one.map(|worker| worker.name.clone()) else { return };
        if self.awaiting.groups.is_empty() || now.since(self.company) < ALONE_MS {
            return;
        }
        let alone = self.awaiting.groups.iter().filter(|((_, names), _)| names[..] == [lone.clone()]);
        let given_up: Vec<u64> = alone.flat_map(|(_, ranks)| ranks).map(|rank| rank.evaluation).collect();
        for evaluation in given_up {
            self.conclude(evaluation, 0, Audited::Skipped, now);
        }
    }

    /// Trusts a worker no more, under this name. It stays attached and gets nothing; its leases are void, and so are
    /// its opinions on what is open.
    fn quarantine(&mut self, name: Arc<str>, verdict: Quarantine, now: Millis) {
        if !self.quarantined.insert(name.clone()) {
            return;
        }
        self.verdicts.push(verdict);
        if let Some(&worker) = self.names.get(&name) {
            self.isolate(worker, now);
        }
        let doubtful = self.evaluations.iter().filter(|(_, entry)| entry.has_opined(&name));
        for evaluation in doubtful.map(|(&id, _)| id).collect::<Vec<_>>() {
            self.withdraw(evaluation);
            let entry = self.evaluations.get_mut(&evaluation).expect("it was found open");
            entry.opinions.retain(|opinion| opinion.worker != name);
            for tried in entry.attempts.iter_mut().filter(|tried| tried.name == name) {
                tried.fate = Some(Fate::Lost(Loss::QUARANTINED.to_owned()));
            }
            self.retry(evaluation, now);
        }
    }

    /// Takes everything from a worker that stays attached.
    fn isolate(&mut self, worker: WorkerId, now: Millis) {
        let state = self.workers.get_mut(&worker).expect("names are those of attached workers");
        state.quarantined = true;
        if let Some(awaited) = state.reserved.take().and_then(|suspect| self.suspects.get_mut(&suspect)) {
            *awaited = None;
        }
        let leases: Vec<_> = state.leases().map(|lease| lease.attempt).collect();
        for attempt in leases {
            let entry = self.evaluations.get_mut(&attempt.evaluation).expect("what is leased is open");
            let tried = entry.attempts.iter_mut().find(|tried| tried.number == attempt.number);
            let tried = tried.expect("attempts whose lease lasts are kept");
            tried.fate = Some(Fate::Lost(Loss::QUARANTINED.to_owned()));
            let seat = tried.seat;
            self.release(worker, seat, attempt.evaluation, now);
            self.revoke(worker, attempt);
            self.retry(attempt.evaluation, now);
        }
        self.file_worker(worker);
    }
}
