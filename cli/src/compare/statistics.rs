//! Means, deviations and the two-sample t-tests (walkers G-64 to G-66). It knows numbers alone; what lacks
//! the numbers for it is `None`, never a guess.

use statrs::function::beta::beta_reg;

/// A sample: the results of one cell's finished runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    /// How many.
    pub(crate) count: usize,
    /// Their mean.
    pub(crate) mean: f64,
    /// Their standard deviation (n − 1); none for fewer than two.
    pub(crate) deviation: Option<f64>,
    /// The least.
    pub(crate) min: f64,
    /// The largest.
    pub(crate) max: f64,
}

impl Sample {
    /// Of at least one value, none of them NaN.
    pub(crate) fn of(values: &[f64]) -> Option<Sample> {
        let &first = values.first()?;
        if values.iter().any(|value| value.is_nan()) {
            return None;
        }
        let count = values.len() as f64;
        // Deviations from the first value: equal values have exactly their value as mean and no variance,
        // where a plain sum would leave some of its rounding and a t-test would make much of it.
        let mean = first + values.iter().map(|value| value - first).sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
        Some(Sample {
            count: values.len(),
            mean,
            deviation: (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt()),
            min: values.iter().copied().fold(f64::INFINITY, f64::min),
            max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        })
    }

    fn variance(&self) -> Option<f64> {
        self.deviation.map(|deviation| deviation * deviation)
    }
}

/// A two-sided test of two means.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Test {
    /// The statistic; positive if the first mean is larger.
    pub(crate) t: f64,
    /// Degrees of freedom.
    pub(crate) df: f64,
    /// The probability of a `t` at least as far from zero if the means are equal.
    pub(crate) p: f64,
}

/// Student's test with equal variances (G-65). None without two values a side or without any variance.
pub(crate) fn student(first: &Sample, second: &Sample) -> Option<Test> {
    let (n1, n2) = (first.count as f64, second.count as f64);
    let df = n1 + n2 - 2.0;
    let pooled = ((n1 - 1.0) * first.variance()? + (n2 - 1.0) * second.variance()?) / df;
    test(first.mean - second.mean, (pooled * (1.0 / n1 + 1.0 / n2)).sqrt(), df)
}

/// Welch's test, which lets the variances differ, with the degrees of freedom of Welch and Satterthwaite.
pub(crate) fn welch(first: &Sample, second: &Sample) -> Option<Test> {
    let (n1, n2) = (first.count as f64, second.count as f64);
    let (v1, v2) = (first.variance()? / n1, second.variance()? / n2);
    let df = (v1 + v2) * (v1 + v2) / (v1 * v1 / (n1 - 1.0) + v2 * v2 / (n2 - 1.0));
    test(first.mean - second.mean, (v1 + v2).sqrt(), df)
}

fn test(difference: f64, error: f64, df: f64) -> Option<Test> {
    let t = difference / error;
    // Without variance the quotient is infinite or none at all.
    (t.is_finite() && df.is_finite()).then(|| Test { t, df, p: two_sided(t, df) })
}

/// `I_{df/(df+t²)}(df/2, 1/2)`: the two tails of Student's distribution (G-65).
fn two_sided(t: f64, df: f64) -> f64 {
    beta_reg(df / 2.0, 0.5, df / (df + t * t))
}

/// The difference of two means in per cent of the larger one, as the paper computes it (G-66). None unless
/// the larger one is positive.
pub(crate) fn difference_percent(one: f64, other: f64) -> Option<f64> {
    let (larger, smaller) = (one.max(other), one.min(other));
    (larger > 0.0).then(|| 100.0 * (larger - smaller) / larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, expected: f64, within: f64) {
        assert!((found - expected).abs() <= within, "{found} is not {expected}");
    }

    fn t17() -> (Sample, Sample) {
        let first = Sample::of(&[80.0, 84.0, 78.0, 82.0, 79.0, 81.0]).unwrap();
        (first, Sample::of(&[77.0, 75.0, 81.0, 74.0, 78.0, 76.0]).unwrap())
    }

    #[test]
    fn student_gives_the_figures_of_walker_t_17() {
        let (first, second) = t17();
        near(first.mean, 80.666667, 5e-7);
        near(second.mean, 76.833333, 5e-7);
        near(first.deviation.unwrap(), 2.160247, 5e-7);
        near(second.deviation.unwrap(), 2.483277, 5e-7);
        let test = student(&first, &second).unwrap();
        near(test.t, 2.852798896, 5e-10);
        assert_eq!(test.df, 10.0);
        near(test.p, 0.017167517, 5e-10);
        near(two_sided(2.024394164, 38.0), 0.05, 1e-9);
    }

    #[test]
    fn a_test_is_two_sided_and_keeps_the_sign_of_the_difference() {
        let (first, second) = t17();
        let (forth, back) = (student(&first, &second).unwrap(), student(&second, &first).unwrap());
        assert_eq!((forth.t, forth.p), (-back.t, back.p));
    }

    #[test]
    fn welch_agrees_with_student_where_sizes_and_variances_are_equal_and_differs_elsewhere() {
        let first = Sample::of(&[1.0, 2.0, 3.0]).unwrap();
        let second = Sample::of(&[2.0, 3.0, 4.0]).unwrap();
        let (student_test, welch_test) = (student(&first, &second).unwrap(), welch(&first, &second).unwrap());
        near(welch_test.df, 4.0, 1e-12);
        near(welch_test.p, student_test.p, 1e-12);
        // {1,2,3} against {10,30,50,70}: v1/n1 = 1/3, v2/n2 = 500/3, df = (501/3)²/((1/3)²/2 + (500/3)²/3).
        let wide = Sample::of(&[10.0, 30.0, 50.0, 70.0]).unwrap();
        let test = welch(&first, &wide).unwrap();
        near(test.t, -38.0 / (501.0_f64 / 3.0).sqrt(), 1e-12);
        near(test.df, 27_889.0 / (1.0 / 18.0 + 250_000.0 / 27.0), 1e-9);
    }

    #[test]
    fn the_difference_is_relative_to_the_larger_mean_as_in_walker_g_66() {
        near(difference_percent(80.85, 63.20).unwrap(), 21.83, 0.005);
        near(difference_percent(303.69, 221.97).unwrap(), 26.91, 0.005);
        near(difference_percent(85.82, 146.59).unwrap(), 41.46, 0.005);
        assert_eq!(difference_percent(0.0, 0.0), None);
    }

    #[test]
    fn without_variance_there_is_no_test_as_in_walker_x_23() {
        let still = Sample::of(&[0.1, 0.1, 0.1]).unwrap();
        assert_eq!((still.mean, still.deviation), (0.1, Some(0.0)));
        let other = Sample::of(&[0.7, 0.7, 0.7]).unwrap();
        assert_eq!((student(&still, &other), welch(&still, &other)), (None, None));
        assert!(difference_percent(still.mean, other.mean).is_some());
    }

    #[test]
    fn one_value_has_a_mean_and_no_deviation_and_none_has_nothing() {
        let one = Sample::of(&[3.0]).unwrap();
        assert_eq!((one.mean, one.deviation, one.min, one.max), (3.0, None, 3.0, 3.0));
        assert_eq!(student(&one, &t17().0), None);
        assert_eq!(Sample::of(&[]), None);
        assert_eq!(Sample::of(&[1.0, f64::NAN]), None);
    }
}
