//! The samples that the replay shows.

/// Most samples at even distances.
const MOST: usize = 2000;

/// Returns samples at even distances, with the first, the last and the `notable` ones, in order.
pub(super) fn keyframes(samples: usize, notable: impl IntoIterator<Item = usize>) -> Vec<usize> {
    let Some(last) = samples.checked_sub(1) else { return Vec::new() };
    let count = samples.min(MOST);
    let even = (0..count).map(|frame| if count == 1 { 0 } else { frame * last / (count - 1) });
    let mut frames: Vec<usize> = even.chain(notable.into_iter().filter(|&n| n < samples)).collect();
    frames.sort_unstable();
    frames.dedup();
    frames
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_few_and_hold_both_ends_and_what_is_notable() {
        assert!(keyframes(0, [3]).is_empty());
        assert_eq!(keyframes(1, []), [0]);
        assert_eq!(keyframes(5, [9]), [0, 1, 2, 3, 4]);
        let many = keyframes(100_001, [777, 31_337]);
        assert!(many.len() <= MOST + 2 && many.is_sorted());
        assert_eq!((many[0], many.last()), (0, Some(&100_000)));
        assert!(many.contains(&777) && many.contains(&31_337));
    }
}
