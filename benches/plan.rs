//! Benchmark of plans: compares the seconds and errors that `plan` predicts with those of the planned runs.
//!
//! It plans renderings, the light of whole transfers, and stylisations, on scenes, sizes and photos to which nothing
//! in `plan` was fitted. Times are processor times of one thread, so other work on the machine does not count. Time
//! budgets use the wall clock and are therefore removed; the numbers of paths that they imply remain. The error of a
//! picture needs no reference: it is half the mean square of the difference between two pictures with different seeds.
//! The error of a stylisation is the square root of its energy.
//!
//! `cargo bench --bench plan -- renderings`, `-- transfers` or `-- stylisations` runs one section.

mod harness;
#[path = "plan/outcomes.rs"]
mod outcomes;
#[path = "plan/photos.rs"]
mod photos;
#[path = "plan/renderings.rs"]
mod renderings;
#[cfg(feature = "stylize")]
#[path = "plan/stylisations.rs"]
mod stylisations;
#[path = "plan/transfers.rs"]
mod transfers;

use harness::{Table, figure, quantile};
use luxfer::exec::Pool;
use outcomes::{Outcomes, within};

fn main() {
    let pool = Pool::new(1).expect("a thread");
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wants = |what: &str| asked.is_empty() || asked.iter().any(|a| a == what);
    pool.run(|| {
        let mut all = Outcomes::default();
        if wants("renderings") {
            renderings::measure(&mut all);
        }
        if wants("transfers") {
            transfers::measure(&mut all);
        }
        #[cfg(feature = "stylize")]
        if wants("stylisations") {
            stylisations::measure(&mut all);
        }
        for (name, ratios) in [("time", &all.times), ("error", &all.errors)] {
            figure(&format!("plan.{name}.within_25"), 100.0 * within(ratios), "%");
            figure(&format!("plan.{name}.median"), quantile(ratios, 0.5), "x");
        }
    });
}

/// Cells of a table: predicted value, actual value, and their ratio.
fn columns([expected, found]: [f64; 2]) -> [String; 3] {
    [format!("{expected:.4}"), format!("{found:.4}"), format!("{:.2}", found / expected)]
}
