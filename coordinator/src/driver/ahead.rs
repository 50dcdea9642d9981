//! What a search wants next, once it was told a generation: more individuals, a pick, or nothing. A pick that
//! nobody has to make, or that was made already, is made here: one path, whoever picked.

use search::{Candidate, Individual, PickedBy, Place, Search, Stage};

/// What a run does next.
pub(super) struct Ahead {
    /// The search's state after it was told; the same as it asked from unless somebody was picked between.
    pub(super) told: Vec<u8>,
    /// Candidates of which the best was picked.
    pub(super) chosen: Option<(Vec<Candidate>, Place)>,
    pub(super) next: Next,
}

/// See [`Ahead`].
pub(super) enum Next {
    /// The individuals of a generation, never empty; the stage that they are of; the state that asks for them.
    Asks { individuals: Vec<Individual>, stage: Stage, state: Vec<u8> },
    /// A pick among these, by a person.
    Waits(Vec<Candidate>),
    /// Nothing more.
    Over,
    /// Nothing more, since it cannot go on.
    GivesUp(String),
}

impl Ahead {
    /// Asks a search; `picked` says who goes on if it waits for a pick that was made before.
    ///
    /// # Errors
    /// What the search contradicts itself in.
    pub(super) fn of(search: &mut dyn Search, picked: Option<Place>) -> Result<Ahead, String> {
        let told = search.checkpoint();
        let individuals = search.ask();
        if !individuals.is_empty() {
            let next = Next::Asks { individuals, stage: search.stage(), state: told.clone() };
            return Ok(Ahead { told, chosen: None, next });
        }
        if let Some(reason) = search.failure() {
            return Ok(Ahead { told, chosen: None, next: Next::GivesUp(reason) });
        }
        let Some(choice) = search.choice() else { return Ok(Ahead { told, chosen: None, next: Next::Over }) };
        let best = choice.candidates.first().map(|best| best.place).ok_or("lets pick among nobody")?;
        let chosen = match (picked, choice.by) {
            (None, PickedBy::Human) => {
                return Ok(Ahead { told, chosen: None, next: Next::Waits(choice.candidates) });
            }
            (None, PickedBy::Best) => Some((choice.candidates, best)),
            (Some(_), _) => None, // it stands in the lineage
        };
        search.pick(picked.unwrap_or(best)).map_err(|error| format!("refuses the pick: {error}"))?;
        let state = search.checkpoint();
        let individuals = search.ask();
        let next = match (individuals.is_empty(), search.failure(), search.choice()) {
            (false, ..) => Next::Asks { individuals, stage: search.stage(), state },
            (true, Some(reason), _) => Next::GivesUp(reason),
            (true, None, None) => Next::Over,
            (true, None, Some(_)) => return Err("lets pick twice at the end of one stage".to_owned()),
        };
        Ok(Ahead { told, chosen, next })
    }
}
