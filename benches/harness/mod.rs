//! Common parts of all benches: headline figures, interleaved timing, tables, plots, and scenes.
//!
//! A bench is a program (`harness = false`). It prints tables for people, writes curves into `out/bench/`, and prints
//! one line per headline figure, `figure NAME VALUE UNIT`. Contenders are timed in turns within one process, and the
//! figure is the median over the rounds of the ratios of their times, so that other work on the machine affects all
//! contenders equally.

// Each bench is a separate crate, and uses only a part of this module.
#![allow(dead_code)]

mod clock;
pub mod embree;
#[cfg(feature = "stylize")]
pub mod judge;
pub mod peer;
pub mod plot;
pub mod scenes;

pub use clock::{Clock, time};

/// Prints one headline figure.
pub fn figure(name: &str, value: f64, unit: &str) {
    // Print four significant digits for any magnitude, and no digits for values that are zero up to rounding.
    let digits = if value.abs() < 1e-12 { 0 } else { (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize };
    println!("figure {name} {value:.digits$} {unit}");
}

/// Prints that a headline figure cannot be measured on this machine, and the reason.
pub fn absent(name: &str, reason: &str) {
    println!("figure {name} absent -");
    println!("# {name} is absent: {reason}");
}

/// Times of several contenders, measured in turns.
pub struct Timings {
    /// Seconds of each run: `seconds[contender][round]`.
    pub seconds: Vec<Vec<f64>>,
}

/// Runs every contender once per round and times it; the contender that comes first changes from round to round. One
/// more round beforehand is not timed.
pub fn interleaved(clock: Clock, rounds: usize, contenders: &mut [&mut dyn FnMut()]) -> Timings {
    let mut seconds = vec![Vec::with_capacity(rounds); contenders.len()];
    contenders.iter_mut().for_each(|contender| contender());
    for round in 0..rounds {
        for turn in 0..contenders.len() {
            let index = (round + turn) % contenders.len();
            let (taken, ()) = time(clock, &mut *contenders[index]);
            seconds[index].push(taken);
        }
    }
    Timings { seconds }
}

impl Timings {
    /// Median seconds of one contender.
    pub fn median(&self, contender: usize) -> f64 {
        median(&self.seconds[contender])
    }

    /// Median over the rounds of the ratio between the times of two contenders, `above` / `below`.
    pub fn ratio(&self, above: usize, below: usize) -> f64 {
        median(&self.ratios(above, below))
    }

    /// Lower and upper quartile over the rounds of the ratio `above` / `below`.
    pub fn quartiles(&self, above: usize, below: usize) -> [f64; 2] {
        let ratios = self.ratios(above, below);
        [quantile(&ratios, 0.25), quantile(&ratios, 0.75)]
    }

    fn ratios(&self, above: usize, below: usize) -> Vec<f64> {
        self.seconds[above].iter().zip(&self.seconds[below]).map(|(a, b)| a / b).collect()
    }
}

pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// The quantile `p` in `[0, 1]` of the values, interpolated linearly; NaN for an empty list.
pub fn quantile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = p * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64)
}

/// Resets the peak that [`peak_memory`] returns, if the system allows it.
pub fn forget_peak_memory() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Highest resident memory of this process since its start or the last reset, in bytes; `None` if the system does not
/// report it.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches("kB").trim().parse::<u64>().ok().map(|kib| kib << 10)
}

/// A table of text for the terminal: the first column is left-aligned, the others are right-aligned.
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    pub fn new<S: ToString>(head: impl IntoIterator<Item = S>) -> Self {
        Self { rows: vec![head.into_iter().map(|s| s.to_string()).collect()] }
    }

    pub fn row<S: ToString>(&mut self, cells: impl IntoIterator<Item = S>) {
        self.rows.push(cells.into_iter().map(|s| s.to_string()).collect());
    }

    /// Writes `out/bench/<name>.csv`.
    pub fn write(&self, name: &str) -> std::io::Result<()> {
        let line = |row: &Vec<String>| row.iter().map(|cell| plot::quoted(cell)).collect::<Vec<_>>().join(",") + "\n";
        plot::write_out(&format!("{name}.csv"), &self.rows.iter().map(line).collect::<String>())
    }

    pub fn print(&self, title: &str) {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let len = |column: usize| self.rows.iter().filter_map(|r| r.get(column)).map(|c| c.chars().count()).max();
        let widths: Vec<usize> = (0..columns).map(|c| len(c).unwrap_or(0)).collect();
        println!("\n{title}");
        for row in &self.rows {
            let cells = row.iter().zip(&widths).enumerate().map(|(i, (cell, &width))| match i {
                0 => format!("{cell:<width$}"),
                _ => format!("{cell:>width$}"),
            });
            println!("  {}", cells.collect::<Vec<_>>().join("  ").trim_end());
        }
    }
}
