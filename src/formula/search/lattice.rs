//! From real coefficients to fractions of a given denominator.

use super::judge::Judge;

/// Free coefficients numerators/denominator and their merit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    pub(super) numerators: Vec<i64>,
    pub(super) denominator: u32,
    pub(super) merit: f64,
}

/// Up to so many coefficients, pairs are moved together too.
const PAIRED: usize = 6;
const MOST_ROUNDS: usize = 60;

/// Returns the fractions near `free` that no move of one numerator, or of two, by one improves.
pub(super) fn descend(
    judge: &Judge<'_>,
    free: &[f64],
    denominator: u32,
    stop: &dyn Fn() -> bool,
) -> Candidate {
    let merit = |numerators: &[i64]| {
        let free: Vec<f64> = numerators.iter().map(|n| *n as f64 / f64::from(denominator)).collect();
        judge.merit(&free)
    };
    let numerators: Vec<i64> = free.iter().map(|u| (u * f64::from(denominator)).round() as i64).collect();
    let mut best = Candidate { merit: merit(&numerators), numerators, denominator };
    let moves = moves(free.len());
    for _ in 0..MOST_ROUNDS {
        let before = best.merit;
        for step in &moves {
            if stop() {
                return best;
            }
            let numerators: Vec<i64> = best.numerators.iter().zip(step).map(|(n, d)| n + d).collect();
            let found = merit(&numerators);
            if found < best.merit {
                best = Candidate { numerators, denominator, merit: found };
            }
        }
        if best.merit >= before {
            break;
        }
    }
    best
}

/// One numerator by one up or down; where there are few, two at a time as well.
fn moves(dimension: usize) -> Vec<Vec<i64>> {
    let mut moves = Vec::new();
    let mut add = |changes: &[(usize, i64)]| {
        let mut step = vec![0; dimension];
        for &(k, d) in changes {
            step[k] = d;
        }
        moves.push(step);
    };
    for k in 0..dimension {
        add(&[(k, 1)]);
        add(&[(k, -1)]);
    }
    for k in (0..dimension).filter(|_| dimension <= PAIRED) {
        for l in k + 1..dimension {
            for (a, b) in [(1, 1), (1, -1), (-1, 1), (-1, -1)] {
                add(&[(k, a), (l, b)]);
            }
        }
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::search::objective::Objective;
    use crate::formula::search::space::{Family, Space};

    #[test]
    fn the_fractions_found_are_a_local_best() {
        let space = Space::new(Family::LookAhead, 5, 3).expect("a space");
        let judge = Judge { space: &space, objective: &Objective::Range, least_range: 0.0 };
        let found = descend(&judge, &[0.125, -0.0625], 48, &|| false);
        for step in moves(2) {
            let free: Vec<f64> =
                found.numerators.iter().zip(&step).map(|(n, d)| (n + d) as f64 / 48.0).collect();
            assert!(judge.merit(&free) >= found.merit);
        }
        assert!(found.merit < -(2.0_f64 / 3.0).ln());
    }
}
