//! Why the fleet does nothing, in words for people. Pure: numbers go in, sentences come out.

use super::{PAROLE_MS, Summary};

/// A worker that was turned away.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Refused {
    pub(crate) name: String,
    pub(crate) host: String,
    pub(crate) reason: String,
}

impl Refused {
    fn words(&self) -> String {
        format!("worker `{}` on `{}` was refused: {}", self.name, self.host, self.reason)
    }
}

/// Why nothing can be handed out; empty if it can.
pub(super) fn words(summary: &Summary, refused: Option<&Refused>) -> String {
    match (summary.slots, summary.workers, refused) {
        // Whatever else there is to do is done: only a dispute holds things up.
        (1.., _, _)
            if summary.disputed > 0 && summary.disputed == summary.ready && summary.in_flight == 0 =>
        {
            format!(
                "workers differ on {} evaluations, and another one must decide: start one more",
                summary.disputed
            )
        }
        (1.., _, _) if summary.condemned > 0 && summary.ready == 0 && summary.in_flight == 0 => format!(
            "{} evaluations may have ended three workers each: they are set aside if none of those is back within {} s",
            summary.condemned,
            PAROLE_MS / 1000
        ),
        (1.., _, _) => String::new(),
        (0, 0, None) => {
            "no worker is attached: start one with `hatchery-worker` (--coordinator URL, or --join-file FILE behind TLS)"
                .to_owned()
        }
        (0, 0, Some(refused)) => format!("no worker is attached: {}", refused.words()),
        (0, 1, _) => "the one worker is draining or quarantined, and takes nothing new".to_owned(),
        (0, workers, _) => format!("all {workers} workers are draining or quarantined, and take nothing new"),
    }
}

/// What stands below a list of the workers.
pub(super) fn notes(summary: &Summary, refused: Option<&Refused>) -> Vec<String> {
    let mut notes = Vec::new();
    let obstacle = words(summary, refused);
    if let Some(refused) = refused.filter(|_| summary.workers > 0) {
        notes.push(refused.words());
    }
    if !obstacle.is_empty() {
        notes.push(obstacle);
    }
    match (summary.ready, summary.in_flight) {
        (0, 0) if summary.slots > 0 && summary.condemned == 0 => {
            notes.push("nothing waits to be evaluated".to_owned())
        }
        // Workers take what is ready at once; what stays belongs to queues that are paused.
        (ready @ 1.., 0) if summary.slots > 0 && ready > summary.disputed => {
            notes.push(format!("{ready} evaluations wait, of experiments that are paused"));
        }
        (ready @ 1.., _) if summary.slots == 0 => notes.push(format!("{ready} evaluations wait")),
        _ => {}
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused() -> Refused {
        Refused { name: "w1".to_owned(), host: "there".to_owned(), reason: "other bits".to_owned() }
    }

    #[test]
    fn an_idle_fleet_says_what_it_lacks() {
        let none = Summary::default();
        assert!(words(&none, None).starts_with("no worker is attached: start one"));
        let draining = Summary { workers: 2, ..none };
        assert_eq!(words(&draining, None), "all 2 workers are draining or quarantined, and take nothing new");
        let differing = Summary { workers: 2, slots: 2, ready: 3, disputed: 3, ..none };
        assert!(words(&differing, None).contains("another one must decide"));
        assert_eq!(words(&Summary { ready: 4, ..differing }, None), "");
        assert_eq!(words(&Summary { slots: 1, workers: 1, ..none }, Some(&refused())), "");
        let condemned = Summary { workers: 2, slots: 2, condemned: 1, ..none };
        assert!(words(&condemned, None).contains("three workers each"));
        assert_eq!(words(&Summary { in_flight: 1, ..condemned }, None), "");
        assert_eq!(notes(&condemned, None), [words(&condemned, None)]);
    }

    #[test]
    fn a_refusal_is_told_to_those_who_wait_for_the_worker() {
        let text = "worker `w1` on `there` was refused: other bits";
        let none = Summary { ready: 7, ..Summary::default() };
        assert_eq!(words(&none, Some(&refused())), format!("no worker is attached: {text}"));
        let all = [format!("no worker is attached: {text}"), "7 evaluations wait".to_owned()];
        assert_eq!(notes(&none, Some(&refused())), all);
        let another = Summary { workers: 1, slots: 1, in_flight: 1, ..none };
        assert_eq!(notes(&another, Some(&refused())), [text]);
    }

    #[test]
    fn workers_without_work_are_told_apart_from_work_that_is_held_back() {
        let idle = Summary { workers: 1, slots: 2, ..Summary::default() };
        assert_eq!(notes(&idle, None), ["nothing waits to be evaluated"]);
        let paused = Summary { ready: 3, ..idle };
        assert_eq!(notes(&paused, None), ["3 evaluations wait, of experiments that are paused"]);
    }
}
