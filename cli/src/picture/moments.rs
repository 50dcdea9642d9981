//! Which moments of a trial are drawn: the whole of it, and a stretch of its middle near enough to see how
//! the creature moves.

use creatures::record::Shot;

/// Moments side by side.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Band<'a> {
    /// What they are of.
    pub(super) name: &'static str,
    /// In order of time.
    pub(super) shots: Vec<&'a Shot>,
}

/// The stretch is this share of the trial.
const STRETCH: usize = 8;

/// So many moments of the whole trial, its start and end among them.
pub(super) fn whole(shots: &[Shot], count: usize) -> Band<'_> {
    Band { name: "the whole trial", shots: spread(shots, count) }
}

/// So many moments of a stretch from the middle on; none of a trial that has no more frames than that.
pub(super) fn stretch(shots: &[Shot], count: usize) -> Option<Band<'_>> {
    let length = (shots.len() / STRETCH).max(count);
    let from = shots.len() / 2;
    let of = shots.get(from..from + length)?;
    Some(Band { name: "a stretch of it", shots: spread(of, count) })
}

/// So many moments of all, in lines of so many: a film.
pub(super) fn film(shots: &[Shot], lines: usize, count: usize) -> Vec<Band<'_>> {
    let moments = spread(shots, lines * count);
    let name = |line| if line == 0 { "film" } else { "" };
    moments
        .chunks(count)
        .enumerate()
        .map(|(line, of)| Band { name: name(line), shots: of.to_vec() })
        .collect()
}

/// Evenly spread over all, first and last included; all if they are fewer.
fn spread(shots: &[Shot], count: usize) -> Vec<&Shot> {
    if shots.len() <= count {
        return shots.iter().collect();
    }
    (0..count).map(|k| &shots[k * (shots.len() - 1) / (count - 1).max(1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use creatures::record::Frame;

    fn shots(count: u32) -> Vec<Shot> {
        let shot = |time| Shot { time: f64::from(time), frame: Frame::default(), events: vec![] };
        (0..count).map(shot).collect()
    }

    fn times(shots: &[&Shot]) -> Vec<f64> {
        shots.iter().map(|shot| shot.time).collect()
    }

    #[test]
    fn the_whole_runs_from_start_to_end_and_the_stretch_stays_near_the_middle() {
        let shots = shots(1601);
        assert_eq!(times(&whole(&shots, 5).shots), [0.0, 400.0, 800.0, 1200.0, 1600.0]);
        assert_eq!(times(&stretch(&shots, 5).unwrap().shots), [800.0, 849.0, 899.0, 949.0, 999.0]);
    }

    #[test]
    fn a_film_goes_on_in_the_next_line() {
        let shots = shots(71);
        let lines: Vec<_> = film(&shots, 2, 4).iter().map(|band| times(&band.shots)).collect();
        assert_eq!(lines, [[0.0, 10.0, 20.0, 30.0], [40.0, 50.0, 60.0, 70.0]]);
        assert_eq!(film(&shots[..5], 2, 4).iter().map(|band| band.shots.len()).collect::<Vec<_>>(), [4, 1]);
    }

    #[test]
    fn short_trials_show_what_they_have() {
        assert_eq!(times(&whole(&shots(3), 8).shots), [0.0, 1.0, 2.0]);
        assert_eq!(stretch(&shots(14), 8), None);
        assert_eq!(stretch(&shots(15), 8).map(|band| band.shots.len()), Some(8));
        assert_eq!(whole(&shots(0), 8).shots.len(), 0);
    }
}
