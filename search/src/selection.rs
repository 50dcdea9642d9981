//! Choosing among scored individuals, as every search does it: the best, ranks, tournaments, and whole
//! numbers from shares. Ties always go to the lower index, so that nothing depends on arrival. It breeds
//! nobody and draws from no stream of its own.

use creatures::{Outcome, random::Stream};

/// The fitness by which a search ranks an individual: its outcome's, or 0 if the service set it aside.
pub fn fitness(outcome: Option<&Outcome>) -> f64 {
    outcome.map_or(0.0, |outcome| outcome.fitness)
}

/// The indices of the given fitness values, the fittest first, equals by index.
pub fn ranks(fitness: &[f64]) -> Vec<usize> {
    let mut ranks: Vec<usize> = (0..fitness.len()).collect();
    ranks.sort_by(|&a, &b| fitness[b].total_cmp(&fitness[a])); // stable: equals stay by index
    ranks
}

/// The index of the largest fitness, the lowest among equals; none of an empty list.
pub fn best(fitness: &[f64]) -> Option<usize> {
    (0..fitness.len()).max_by(|&a, &b| fitness[a].total_cmp(&fitness[b]).then(b.cmp(&a)))
}

/// The winner of a tournament of `size` uniform draws with replacement: the fittest drawn, the lowest index
/// among equals (G-25). Neither `fitness` nor the tournament may be empty.
pub fn tournament(fitness: &[f64], size: u32, stream: &mut Stream) -> usize {
    (0..size)
        .map(|_| stream.below(fitness.len()))
        .max_by(|&a, &b| fitness[a].total_cmp(&fitness[b]).then(b.cmp(&a)))
        .expect("a tournament has at least one round; settings are checked")
}

/// The probabilities of linear ranking, worst first: rank r of N, the worst being 0, has
/// `(2 − s + 2 (s − 1) r / (N − 1)) / N` (ESP E-37). The pressure s is within 1 to 2.
pub fn linear_ranking(count: usize, pressure: f64) -> Vec<f64> {
    let steps = count.saturating_sub(1).max(1) as f64;
    let probability = |rank: usize| {
        let share = if count == 1 { 0.5 } else { rank as f64 / steps };
        (2.0 - pressure + 2.0 * (pressure - 1.0) * share) / count as f64
    };
    (0..count).map(probability).collect()
}

/// Probabilities in proportion to fitness; what is below 0 counts as 0, and if nobody has more, all are equal
/// (ESP E-37).
pub fn proportionate(fitness: &[f64]) -> Vec<f64> {
    let largest = fitness.iter().copied().fold(0.0, f64::max);
    // Scaled by the largest, so that the sum of any finite fitness stays finite.
    let scaled = |fitness: f64| if largest > 0.0 { fitness.max(0.0) / largest } else { 1.0 };
    let sum: f64 = fitness.iter().map(|&fitness| scaled(fitness)).sum();
    fitness.iter().map(|&fitness| scaled(fitness) / sum).collect()
}

/// An index drawn with the given probabilities, which add up to 1; there is at least one.
pub fn draw(probabilities: &[f64], stream: &mut Stream) -> usize {
    let mut left = stream.unit();
    for (index, probability) in probabilities.iter().enumerate() {
        left -= probability;
        if left < 0.0 {
            return index;
        }
    }
    // Rounding has left a last sliver.
    probabilities.iter().rposition(|&probability| probability > 0.0).unwrap_or_default()
}

/// Splits `total` in proportion to finite shares ≥ 0 by the method of the largest remainder; the parts add
/// up to `total` exactly, ties go to the lower index (G-35). Shares that are all 0 count as equal.
///
/// Without shares there are no parts.
pub fn largest_remainder(shares: &[f64], total: u32) -> Vec<u32> {
    let largest = shares.iter().copied().fold(0.0, f64::max);
    // Scaled by the largest share, so that the sum of any finite shares stays finite.
    let scaled = |share: f64| if largest > 0.0 { share / largest } else { 1.0 };
    let sum: f64 = shares.iter().map(|&share| scaled(share)).sum();
    let exact: Vec<f64> = shares.iter().map(|&share| f64::from(total) * (scaled(share) / sum)).collect();
    let mut parts: Vec<u32> = exact.iter().map(|&part| part as u32).collect(); // rounds down
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| exact[b].fract().total_cmp(&exact[a].fract()));
    let given: u32 = parts.iter().sum();
    let missing = total.saturating_sub(given) as usize;
    for &index in order.iter().cycle().take(if order.is_empty() { 0 } else { missing }) {
        parts[index] += 1;
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;
    use creatures::random::stream;
    use proptest::prelude::*;

    #[test]
    fn the_best_and_the_ranks_break_ties_by_index() {
        let fitness = [1.0, 3.0, 3.0, 0.0, 1.0];
        assert_eq!(best(&fitness), Some(1));
        assert_eq!(ranks(&fitness), [1, 2, 0, 4, 3]);
        assert_eq!(best(&[]), None);
    }

    #[test]
    fn a_tournament_of_three_prefers_the_fit_as_often_as_it_should() {
        // The fittest of 10 is among three draws with probability 1 − 0.9³ = 0.271; the worst wins alone
        // with 0.1³.
        let fitness: Vec<f64> = (0..10).map(f64::from).collect();
        let mut draws = stream(1, [0, 0, 0], "test");
        let mut wins = [0u32; 10];
        for _ in 0..100_000 {
            wins[tournament(&fitness, 3, &mut draws)] += 1;
        }
        assert!((f64::from(wins[9]) / 1e5 - 0.271).abs() < 0.01, "{wins:?}");
        assert!((1..300).contains(&wins[0]), "{wins:?}");
    }

    #[test]
    fn a_tournament_among_equals_goes_to_the_lowest_index_drawn() {
        // G-28: the lowest of three uniform draws from 4 is 0 with probability 1 − 0.75³ = 0.578.
        let mut draws = stream(2, [0, 0, 0], "test");
        let zeros = (0..10_000).filter(|_| tournament(&[0.0; 4], 3, &mut draws) == 0).count();
        assert!((5_600..5_960).contains(&zeros), "{zeros}");
    }

    /// ESP T-12
    #[test]
    fn ranks_and_shares_are_drawn_with_the_published_probabilities() {
        let near = |found: &[f64], expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
        };
        near(&linear_ranking(5, 1.8), &[0.04, 0.12, 0.20, 0.28, 0.36]);
        near(&linear_ranking(1, 1.8), &[1.0]);
        near(&proportionate(&[0.0, 0.1, 0.2, 0.3, 0.4]), &[0.0, 0.1, 0.2, 0.3, 0.4]);
        near(&proportionate(&[-1.0, 0.0]), &[0.5, 0.5]);
        near(&proportionate(&[-1.0, 1e308, 1e308]), &[0.0, 0.5, 0.5]);
        let mut draws = stream(3, [0, 0, 0], "test");
        let mut drawn = [0.0_f64; 5];
        for _ in 0..100_000 {
            drawn[draw(&linear_ranking(5, 1.8), &mut draws)] += 1e-5;
        }
        assert!((drawn[0] - 0.04).abs() < 0.003 && (drawn[4] - 0.36).abs() < 0.006, "{drawn:?}");
        assert!((0..1000).all(|_| draw(&[0.0, 1.0, 0.0], &mut draws) == 1));
    }

    #[test]
    fn remainders_decide_and_ties_go_to_the_lower_index() {
        assert_eq!(largest_remainder(&[25.0, 30.0, 5.0], 80), [33, 40, 7], "T-15");
        assert_eq!(largest_remainder(&[50.0, 20.0, 10.0], 80), [50, 20, 10], "T-15");
        assert_eq!(largest_remainder(&[1.0, 1.0, 1.0], 80), [27, 27, 26]);
        assert_eq!(largest_remainder(&[0.0, 0.0], 3), [2, 1]);
        assert_eq!(largest_remainder(&[1e308, 1e308, 1e308], 3), [1, 1, 1]);
        assert_eq!(largest_remainder(&[], 3), [0; 0]);
    }

    proptest! {
        #[test]
        fn parts_add_up_and_stay_within_one_of_their_share(
            shares in prop::collection::vec(0.0..1e6f64, 1..60), total in 0u32..2000,
        ) {
            let parts = largest_remainder(&shares, total);
            prop_assert_eq!(parts.iter().sum::<u32>(), total);
            let sum: f64 = shares.iter().sum();
            if sum > 0.0 {
                for (&part, share) in parts.iter().zip(&shares) {
                    let exact = share / sum * f64::from(total);
                    prop_assert!((f64::from(part) - exact).abs() < 1.0 + 1e-6, "{} for {}", part, exact);
                }
            }
        }
    }
}
