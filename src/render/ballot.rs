//! Mergeable vote counts for the object and material indices of a pixel: up to [`CANDIDATES`] indices, each with its
//! number of votes (Misra and Gries 1982, "Finding repeated elements"; Agarwal et al. 2013, "Mergeable summaries").
//!
//! If a pixel shows at most [`CANDIDATES`] different indices, the counts are exact, whatever the order of counting and
//! merging. If it shows more, votes for rare candidates cancel votes for the others, but an index with a majority
//! still wins.

/// Largest number of different object or material indices (the candidates) whose votes one ballot can hold. A ballot
/// certainly keeps an index that gets more than 1 / (`CANDIDATES` + 1) of all votes. Any value ≥ 1 therefore keeps an
/// index with a majority. [convention]
const CANDIDATES: usize = 4;
/// Length of a ballot in f64 values: for each slot a candidate and its number of votes. A slot with 0 votes is empty.
pub const NUMBERS: usize = 2 * CANDIDATES;

/// Adds `votes` votes for `candidate` to a ballot, a list of candidates with their votes.
pub fn cast(ballot: &mut [f64], candidate: f64, votes: f64) {
    let (slots, _) = ballot.as_chunks_mut::<2>();
    let Some(place) =
        slots.iter().position(|s| s[1] > 0.0 && s[0] == candidate).or_else(|| slots.iter().position(|s| s[1] == 0.0))
    else {
        // No slot is free. Let m be the smallest number of votes among the new candidate and the candidates in the
        // ballot: subtract m from each of them, and cast the new candidate's remaining votes.
        let min_votes = slots.iter().fold(votes, |min_votes, s| min_votes.min(s[1]));
        slots.iter_mut().for_each(|s| s[1] -= min_votes);
        if votes > min_votes {
            cast(ballot, candidate, votes - min_votes);
        }
        return;
    };
    slots[place] = [candidate, slots[place][1] + votes];
}

/// Adds all votes of the ballot `other` to `ballot`.
pub fn join(ballot: &mut [f64], other: &[f64]) {
    let (slots, _) = other.as_chunks::<2>();
    slots.iter().filter(|s| s[1] > 0.0).for_each(|s| cast(ballot, s[0], s[1]));
}

/// Returns the candidate with the most votes, and its number of votes; two zeros for an empty ballot. Among candidates
/// with equal numbers of votes, the smallest index wins.
pub fn winner(ballot: &[f64]) -> [f64; 2] {
    let (slots, _) = ballot.as_chunks::<2>();
    let better = |a: [f64; 2], b: [f64; 2]| if (b[1], -b[0]) > (a[1], -a[0]) { b } else { a };
    slots.iter().filter(|s| s[1] > 0.0).copied().reduce(better).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// Distributes the votes over several ballots, merges the ballots in random order, and returns the winner.
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
