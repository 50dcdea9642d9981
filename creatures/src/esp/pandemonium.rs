//! Pandemonium: of the skills of a group the one that is called loudest speaks, and no other (E-50..E-53).
//! It decides from numbers alone; in which order groups are decided is the syllabus's matter.

use serde::{Deserialize, Serialize};

/// Calls that differ by no more than this are equally loud (E-52).
const TIE: f64 = 1e-9;

/// How loud the winner speaks (E-51).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Winner {
    /// With an effective sigma of 1.
    #[default]
    Full,
    /// With its own raw sigma.
    Own,
}

impl Winner {
    /// The winner's effective sigma, from its raw one.
    pub fn effective(self, raw: f64) -> f64 {
        match self {
            Winner::Full => 1.0,
            Winner::Own => raw,
        }
    }
}

/// Who wins: the index of the largest raw sigma above the floor, of equal ones the previous winner or else
/// the first. None if no call is above the floor.
///
/// `raw` are the members' raw sigmas in the group's order, within [0, 1].
pub fn decide(raw: impl Iterator<Item = f64> + Clone, floor: f64, previous: Option<usize>) -> Option<usize> {
    let loudest = raw.clone().fold(0.0, |most, call| if call > most { call } else { most });
    if loudest <= floor {
        return None;
    }
    let among = |call: f64| loudest - call <= TIE && call > floor;
    let holder = previous.filter(|&index| raw.clone().nth(index).is_some_and(among));
    holder.or_else(|| raw.clone().position(among))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// T-3, the first table: raw sigmas and previous winner, then effective sigmas of both readings.
    #[test]
    fn the_loudest_above_the_floor_speaks_and_ties_stay_where_they_are() {
        let table = [
            ([0.3, 0.2], None, [1.0, 0.0], [0.3, 0.0]),
            ([0.2, 0.3], None, [0.0, 1.0], [0.0, 0.3]),
            ([0.3, 0.3], None, [1.0, 0.0], [0.3, 0.0]),
            ([0.3, 0.3], Some(1), [0.0, 1.0], [0.0, 0.3]),
            ([0.005, 0.002], None, [0.0, 0.0], [0.0, 0.0]),
            ([0.02, 0.0], None, [1.0, 0.0], [0.02, 0.0]),
        ];
        for (raw, previous, full, own) in table {
            let winner = decide(raw.into_iter(), 0.01, previous);
            for (reading, expected) in [(Winner::Full, full), (Winner::Own, own)] {
                let effective = [0, 1]
                    .map(|index| if winner == Some(index) { reading.effective(raw[index]) } else { 0.0 });
                assert_eq!(effective, expected, "{raw:?} after {previous:?}, {reading:?}");
            }
        }
    }

    #[test]
    fn a_previous_winner_that_fell_behind_loses() {
        assert_eq!(decide([0.3, 0.31].into_iter(), 0.01, Some(0)), Some(1));
        assert_eq!(decide([0.3, 0.3 + 5e-10].into_iter(), 0.01, Some(0)), Some(0), "a tie within rounding");
    }

    #[test]
    fn a_call_at_the_floor_is_not_above_it() {
        assert_eq!(decide([0.01, 0.0].into_iter(), 0.01, Some(0)), None);
        assert_eq!(decide([].into_iter(), 0.0, None), None);
    }
}
