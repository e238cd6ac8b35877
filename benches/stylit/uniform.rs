//! Uniform usage of the exemplar (Jamriška et al. 2015): each exemplar patch searches for its target patch, and no pass
//! uses an exemplar patch twice. It is the library's retrieval without the error budget.

use super::earlier::{Matcher, every_patch};
use luxfer::job::Job;
use luxfer::patch::{Domain, Field, NONE, Search, SearchIteration, pack, unpack};
use luxfer::stylize::Params;

/// Assigns the target patches anew. `field` holds the matches of the last iteration, with their distances.
pub fn rematch(matcher: &Matcher, field: &mut Field, k: u64, job: Job) {
    let (params, search) = (Params::default(), matcher.search());
    let mut free = every_patch(&matcher.target);
    let mut reverse = field.invert(&matcher.allowed).expect("memory");
    let mut matched = Field::new(field.width, field.height).expect("memory");
    for pass in 0..params.passes as u64 {
        if free.is_empty() {
            break;
        }
        let lost: Vec<bool> = reverse.error.iter().map(|&e| e == u32::MAX).collect();
        let back =
            Search { query: search.base, base: search.query, allowed: &free, seed: !search.seed, ..matcher.search() };
        let iteration = SearchIteration { index: 100 * k + pass, radius: 32, initial_samples: 2 };
        back.iterate(&mut reverse, iteration, job, |i| lost[i]).expect("nobody cancels");
        accept(&mut matched, &mut free, &mut reverse);
    }
    // The rest of the target takes its nearest exemplar patches, and all of it settles.
    for i in (0..field.at.len()).filter(|&i| free.contains_index(i)) {
        (matched.at[i], matched.error[i]) = (field.at[i], field.error[i]);
    }
    let iteration = SearchIteration { index: 100 * k + 99, radius: 64, initial_samples: 4 };
    search.iterate(&mut matched, iteration, job, |i| free.contains_index(i)).expect("nobody cancels");
    let seam = (f64::from(params.seam) * matched.energy() / matched.at.len() as f64) as u32;
    for _ in 0..params.settle {
        search.join(&mut matched, seam, job, |_| true).expect("nobody cancels");
    }
    *field = matched;
}

/// Assigns free target patches to exemplar patches, in order of rising error.
fn accept(matched: &mut Field, free: &mut Domain, reverse: &mut Field) {
    let found = reverse.error.iter().enumerate().filter(|(_, e)| **e != u32::MAX);
    let mut order: Vec<(u32, usize)> = found.map(|(i, &e)| (e, i)).collect();
    order.sort_unstable();
    for (error, source) in order {
        let (x, y) = unpack(reverse.at[source]);
        let target = y * matched.width + x;
        if free.contains_index(target) {
            matched.at[target] = pack(source % reverse.width, source / reverse.width);
            matched.error[target] = error;
            free.remove(target);
        }
    }
    free.compact();
    // Exemplar patches whose target is taken search on around it.
    for (at, error) in reverse.at.iter().zip(&mut reverse.error).filter(|(at, _)| **at != NONE) {
        let (x, y) = unpack(*at);
        if !free.contains(x, y) {
            *error = u32::MAX;
        }
    }
}
