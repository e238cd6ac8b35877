//! Whether plans come true: seconds and errors that `plan` expects against those of the runs it plans.
//!
//! Of renderings, of the light of whole transfers and of stylisations, on scenes, sizes and photos of all kinds; nothing was fitted to any.
//! Times are of one thread, by its own clock, so that what else the machine does weighs on neither side; time budgets, which
//! are of the clock on the wall, are taken off for that, and the paths that they bound stay. The error of a picture is that
//! of two pictures of different seeds, which needs no reference: half the mean square of their difference; that of a stylisation
//! the root of its energy.
//!
//! `cargo bench --bench plan -- renderings`, `-- transfers` or `-- stylisations` makes one of them alone.

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

/// Expected and found, and their ratio.
fn columns([expected, found]: [f64; 2]) -> [String; 3] {
    [format!("{expected:.4}"), format!("{found:.4}"), format!("{:.2}", found / expected)]
}
