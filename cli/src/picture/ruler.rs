//! Round lengths for scale bars and grids.

/// The largest of 1, 2 and 5 times a power of ten that is not above a length; 1 for what is no length.
pub(super) fn round_below(length: f64) -> f64 {
    if !(length.is_finite() && length > 0.0) {
        return 1.0;
    }
    let power = 10f64.powf(length.log10().floor());
    // A logarithm just below a whole number may be rounded to it.
    [5.0, 2.0, 1.0, 0.5]
        .into_iter()
        .map(|share| share * power)
        .find(|&round| round <= length)
        .unwrap_or(power)
}

/// A round length in words: no more digits than it has.
pub(super) fn words(length: f64, unit: &str) -> String {
    let figure = format!("{:.*}", (-length.log10().floor()).max(0.0) as usize, length);
    format!("{figure} {unit}").trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_rounded_down_to_one_two_or_five() {
        let rounds = [(0.07, 0.05), (0.2, 0.2), (3.7, 2.0), (5.0, 5.0), (999.0, 500.0), (1000.0, 1000.0)];
        for (length, round) in rounds {
            assert!((round_below(length) - round).abs() < 1e-12 * round, "{length}: {}", round_below(length));
        }
        assert_eq!([0.0, -1.0, f64::NAN, f64::INFINITY].map(round_below), [1.0; 4]);
    }

    #[test]
    fn words_have_the_digits_that_count() {
        assert_eq!(
            [words(0.05, "m"), words(20.0, "m"), words(0.5, ""), words(2.0, "")],
            ["0.05 m", "20 m", "0.5", "2"]
        );
    }
}
