//! Mergeable vote counts for indices: a few candidates with their votes (Misra and Gries 1982, "Finding repeated
//! elements"; Agarwal et al. 2013, "Mergeable summaries").
//!
//! With up to [`CANDIDATES`] surfaces in a pixel the counts are exact, in any order of counting and merging. With more
//! surfaces, votes for rare candidates cancel each other; a majority still wins.

/// Largest number of candidates. [origin not recorded]
const CANDIDATES: usize = 4;
/// Numbers per ballot: pairs of a candidate and its votes. A pair without votes is empty.
pub const NUMBERS: usize = 2 * CANDIDATES;

/// Adds votes for a candidate.
pub fn cast(ballot: &mut [f64], candidate: f64, votes: f64) {
    let (slots, _) = ballot.as_chunks_mut::<2>();
    let Some(place) =
        slots.iter().position(|s| s[1] > 0.0 && s[0] == candidate).or_else(|| slots.iter().position(|s| s[1] == 0.0))
    else {
        // Cancel votes: each cancelled vote cancels one vote of every candidate.
        let min_votes = slots.iter().fold(votes, |min_votes, s| min_votes.min(s[1]));
        slots.iter_mut().for_each(|s| s[1] -= min_votes);
        if votes > min_votes {
            cast(ballot, candidate, votes - min_votes);
        }
        return;
    };
    slots[place] = [candidate, slots[place][1] + votes];
}

/// Adds the votes of another ballot.
pub fn join(ballot: &mut [f64], other: &[f64]) {
    let (slots, _) = other.as_chunks::<2>();
    slots.iter().filter(|s| s[1] > 0.0).for_each(|s| cast(ballot, s[0], s[1]));
}

/// The candidate with the most votes (of equals the smallest index), and its votes.
pub fn winner(ballot: &[f64]) -> [f64; 2] {
    let (slots, _) = ballot.as_chunks::<2>();
    let better = |a: [f64; 2], b: [f64; 2]| if (b[1], -b[0]) > (a[1], -a[0]) { b } else { a };
    slots.iter().filter(|s| s[1] > 0.0).copied().reduce(better).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// Counts votes in several ballots and merges them in random order.
    fn counted(votes: &[u32], rng: &mut Rng) -> [f64; 2] {
        let mut ballots = vec![[0.0; NUMBERS]; 1 + rng.below(5)];
        for &vote in votes {
            let place = rng.below(ballots.len());
            cast(&mut ballots[place], f64::from(vote), 1.0);
        }
        let mut all = [0.0; NUMBERS];
        while !ballots.is_empty() {
            join(&mut all, &ballots.swap_remove(rng.below(ballots.len())));
        }
        winner(&all)
    }

    #[test]
    fn few_candidates_are_counted_exactly_and_a_majority_wins_among_many() {
        let mut rng = Rng::new(5, &[]);
        for _ in 0..200 {
            let votes: Vec<u32> = (0..64).map(|_| 1 + rng.below(CANDIDATES) as u32).collect();
            let count = |candidate: u32| votes.iter().filter(|&&v| v == candidate).count();
            let best = (1..=CANDIDATES as u32).rev().max_by_key(|&c| count(c)).unwrap();
            assert_eq!(counted(&votes, &mut rng), [f64::from(best), count(best) as f64]);

            let mut votes: Vec<u32> = (0..101).map(|i| if i < 51 { 7 } else { 100 + rng.below(40) as u32 }).collect();
            for i in (1..votes.len()).rev() {
                votes.swap(i, rng.below(i + 1));
            }
            assert_eq!(counted(&votes, &mut rng)[0], 7.0);
        }
        assert_eq!(winner(&[0.0; NUMBERS]), [0.0; 2]);
    }
}
