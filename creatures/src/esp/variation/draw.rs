//! Draws that more than one operator makes: scalars, directions, rotations, counts (E-41).

use crate::math::{exp, from_rotation_vector};
use crate::random::Stream;
use glam::{DQuat, DVec3};
use std::ops::RangeInclusive;

/// Standard deviation of a moved scalar, as a share of its range (E-41).
const DEVIATION: f64 = 0.1;
/// The share of moved scalars that are drawn anew instead (E-41).
const REDRAWN: f64 = 0.1;
/// Standard deviation of the angle by which a direction or orientation is turned, rad (E-41).
const TURN: f64 = 0.3;

/// Uniform in a range.
pub(super) fn uniform(range: RangeInclusive<f64>, stream: &mut Stream) -> f64 {
    stream.between(*range.start(), *range.end())
}

/// Moves a scalar within its range.
pub(super) fn stir(value: &mut f64, range: RangeInclusive<f64>, stream: &mut Stream) {
    if stream.chance(REDRAWN) {
        *value = uniform(range, stream);
    } else {
        let (low, high) = range.into_inner();
        *value = (*value + DEVIATION * (high - low) * stream.normal()).clamp(low, high);
    }
}

/// A direction, uniform on the sphere.
pub(super) fn direction(stream: &mut Stream) -> DVec3 {
    loop {
        let drawn = DVec3::new(stream.normal(), stream.normal(), stream.normal());
        if let Some(direction) = drawn.try_normalize() {
            return direction;
        }
    }
}

/// An orientation, uniform over all.
pub(super) fn orientation(stream: &mut Stream) -> DQuat {
    loop {
        let drawn = [(); 4].map(|()| stream.normal());
        let quaternion = DQuat::from_array(drawn);
        if quaternion.length_squared() > 1e-12 {
            return quaternion.normalize();
        }
    }
}

/// A rotation about any axis by a small angle.
pub(super) fn turn(stream: &mut Stream) -> DQuat {
    let angle = TURN * stream.normal();
    from_rotation_vector(direction(stream) * angle)
}

/// Turns a direction.
pub(super) fn turn_direction(way: &mut DVec3, stream: &mut Stream) {
    *way = (turn(stream) * *way).normalize();
}

/// One of some items, which are not empty.
pub(super) fn pick<T>(mut items: Vec<T>, stream: &mut Stream) -> T {
    items.swap_remove(stream.below(items.len()))
}

/// A number with Poisson's distribution.
pub(super) fn poisson(mean: f64, stream: &mut Stream) -> usize {
    let (least, mut product) = (exp(-mean), stream.unit());
    let mut count = 0;
    while product > least {
        product *= stream.unit();
        count += 1;
    }
    count
}

/// Where lists of two parents that are aligned by index are cut: one or two places, none behind the shorter list's
/// end, where it would come too late (E-39).
pub(super) fn cuts(shorter: usize, stream: &mut Stream) -> Vec<usize> {
    (0..stream.within(1, 2)).map(|_| stream.within(1, shorter.max(1))).collect()
}

/// Whether an item of a child comes from its second parent.
pub(super) fn is_of_second(index: usize, cuts: &[usize]) -> bool {
    cuts.iter().filter(|&&cut| cut <= index).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::stream;

    /// E-41
    #[test]
    fn counts_have_their_mean_and_scalars_their_range() {
        let mut draws = stream(1, [0, 0, 0], "draw");
        let mean = (0..20_000).map(|_| poisson(2.0, &mut draws)).sum::<usize>() as f64 / 20_000.0;
        assert!((mean - 2.0).abs() < 0.05, "{mean}");
        let (mut far, mut value) = (0, 0.3);
        for _ in 0..20_000 {
            let before = std::mem::replace(&mut value, 0.3);
            assert!((0.0..=1.0).contains(&before));
            stir(&mut value, 0.0..=1.0, &mut draws);
            far += usize::from(value > 0.75); // 4.5 deviations away: drawn anew
        }
        assert!((400..600).contains(&far), "{far} of 500: a quarter of a tenth");
    }

    #[test]
    fn directions_and_orientations_favour_no_side() {
        let mut draws = stream(2, [0, 0, 0], "draw");
        let mean = (0..10_000).map(|_| direction(&mut draws)).sum::<DVec3>() / 1e4;
        assert!(mean.length() < 0.03, "{mean}");
        let mean = (0..10_000).map(|_| orientation(&mut draws) * DVec3::X).sum::<DVec3>() / 1e4;
        assert!(mean.length() < 0.03, "{mean}");
        let angles =
            (0..10_000).map(|_| turn(&mut draws).w.abs().min(1.0)).map(|w| 2.0 * crate::math::acos(w));
        let square = angles.map(|angle| angle * angle).sum::<f64>() / 1e4;
        assert!((square.sqrt() - TURN).abs() < 0.01, "{square}");
    }
}
