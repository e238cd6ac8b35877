//! The results of many runs as a table, and headline figures from them.

use super::judge::{Judgement, Verdict};
use super::outcome::Outcome;
use super::truth::Photo;
use crate::harness::{Table, figure, median, quantile};

/// The results of one run that the table and the figures need.
pub struct Line {
    pub name: String,
    pub megapixels: f64,
    pub judgement: Judgement,
    /// Logarithm of the ratio between the estimated and the true distance of the camera from the plane, and the stated
    /// error of the estimate.
    pub distance: Option<[f64; 2]>,
    /// Error that the library states for the texture.
    pub error: Option<f64>,
    pub seconds: f64,
    pub cpu_seconds: f64,
    pub warnings: Vec<String>,
}

impl Line {
    pub fn of(photo: &Photo, outcome: &Outcome) -> Self {
        Self {
            name: photo.name.clone(),
            megapixels: photo.image.width as f64 * photo.image.height as f64 * 1e-6,
            judgement: Judgement::of(photo, outcome),
            distance: distance(photo, outcome),
            error: outcome.emission().map(|emission| emission.error),
            seconds: outcome.seconds,
            cpu_seconds: outcome.cpu_seconds,
            warnings: outcome.warnings(),
        }
    }

    /// Summary of the run in one line, for a contact sheet.
    pub fn caption(&self) -> String {
        let Judgement { precision, found, .. } = self.judgement;
        let stated = percent(self.error);
        let verdict = self.judgement.verdict.name();
        let masks = format!("precise {} found {}", percent(precision), percent(found));
        let warning = self.warnings.first().map_or(String::new(), |w| format!("  {w}"));
        format!("{}  {verdict}  {masks}  error {stated}{warning}", self.name)
    }

    fn cells(&self) -> Vec<String> {
        let j = &self.judgement;
        let agreement = j.agreement.unwrap_or_default();
        let factor = |v: Option<f64>| v.map_or("-".into(), |v| format!("{:.2}", v.exp()));
        vec![
            self.name.clone(),
            j.verdict.name().into(),
            percent(j.precision),
            percent(j.found),
            percent(j.lights_iou),
            percent(j.plane_iou),
            j.unwarp.map_or("-".into(), |v| format!("{:.1}", 100.0 * v)),
            factor(agreement.area),
            factor(agreement.aspect),
            factor(agreement.spacing),
            factor(agreement.lit),
            agreement.lattice.map_or("-".into(), |v| format!("{:.1}", 100.0 * v.exp_m1())),
            percent(self.error),
            format!("{:.2}", self.megapixels),
            format!("{:.2}", self.seconds),
            format!("{:.2}", self.cpu_seconds),
            self.warnings.len().to_string(),
        ]
    }
}

fn percent(value: Option<f64>) -> String {
    value.map_or("-".into(), |v| format!("{:.0}", 100.0 * v))
}

/// The runs of one section.
#[derive(Default)]
pub struct Tally {
    pub lines: Vec<Line>,
}

impl Tally {
    pub fn table(&self, title: &str) {
        let mut table = Table::new([
            "photo",
            "verdict",
            "precise %",
            "found %",
            "lights IoU",
            "plane IoU",
            "unwarp %",
            "× area",
            "× aspect",
            "× spacing",
            "× lit",
            "lattice %",
            "stated %",
            "MP",
            "s",
            "CPU s",
            "warnings",
        ]);
        self.lines.iter().for_each(|line| table.row(line.cells()));
        table.print(title);
    }

    /// Prints the number of verdicts for each pattern; the name of a generated photo ends with its pattern.
    pub fn by_pattern(&self) {
        let pattern = |line: &Line| line.name.split('_').nth(1).unwrap_or_default().to_string();
        let mut patterns: Vec<String> = self.lines.iter().map(pattern).collect();
        patterns.sort();
        patterns.dedup();
        let mut table = Table::new(["pattern", "photos", "right", "usable", "wrong"]);
        for name in patterns {
            let of = |verdict: Option<Verdict>| {
                let is = |line: &&Line| pattern(line) == name && verdict.is_none_or(|v| line.judgement.verdict == v);
                self.lines.iter().filter(is).count().to_string()
            };
            let verdicts = [Verdict::Right, Verdict::Usable, Verdict::Wrong].map(|v| of(Some(v)));
            table.row([name.clone(), of(None)].into_iter().chain(verdicts));
        }
        table.print("By pattern");
    }

    /// Values of the runs for which `of` returns a value.
    pub fn values<T>(&self, of: impl Fn(&Line) -> Option<T>) -> Vec<T> {
        self.lines.iter().filter_map(of).collect()
    }

    /// Share in percent of the judged runs for which `is` holds.
    fn share(&self, is: impl Fn(&Line) -> bool) -> f64 {
        let judged = || self.lines.iter().filter(|line| line.judgement.verdict != Verdict::Unjudged);
        100.0 * judged().filter(|line| is(line)).count() as f64 / judged().count() as f64
    }

    /// Prints the shares of the verdicts as figures.
    pub fn verdicts(&self, section: &str) {
        let of = |verdict: Verdict| self.share(|line| line.judgement.verdict == verdict);
        figure(&format!("photos.{section}.right"), of(Verdict::Right), "%");
        figure(&format!("photos.{section}.usable"), of(Verdict::Usable), "%");
        figure(&format!("photos.{section}.wrong"), of(Verdict::Wrong), "%");
        let unwarned = |line: &Line| line.judgement.verdict == Verdict::Wrong && line.warnings.is_empty();
        figure(&format!("photos.{section}.wrong_unwarned"), self.share(unwarned), "%");
    }

    /// Prints the precision and the share of found lamps of the masks of lights as figures.
    pub fn lights(&self, prefix: &str) {
        let precision = self.values(|line| line.judgement.precision);
        let precise = precision.iter().filter(|p| **p > 0.8).count() as f64 / precision.len() as f64;
        figure(&format!("photos.{prefix}.precision"), median(&precision), "of the lit area, median");
        figure(&format!("photos.{prefix}.precise_photos"), 100.0 * precise, "% of the photos");
        let found = self.values(|line| line.judgement.found);
        figure(
            &format!("photos.{prefix}.found"),
            100.0 * found.iter().sum::<f64>() / found.len() as f64,
            "% of the lamps, mean",
        );
    }

    /// Prints how well the masks of each run agree with the truth, and the means over all runs.
    pub fn masks(&self, section: &str) {
        let mut table = Table::new(["photo", "precise %", "found %", "lights IoU", "plane IoU", "CPU s"]);
        for line in &self.lines {
            let j = &line.judgement;
            let shares = [j.precision, j.found, j.lights_iou, j.plane_iou].map(percent);
            table.row([line.name.clone()].into_iter().chain(shares).chain([format!("{:.2}", line.cpu_seconds)]));
        }
        table.print(&format!("Masks: {section}"));
        let mean = |of: fn(&Judgement) -> Option<f64>| {
            let values = self.values(|line| of(&line.judgement));
            100.0 * values.iter().sum::<f64>() / values.len() as f64
        };
        let shares: [fn(&Judgement) -> Option<f64>; 4] =
            [|j| j.precision, |j| j.found, |j| j.lights_iou, |j| j.plane_iou];
        let [precision, found, lights, plane] = shares.map(mean);
        let good = |line: &Line| {
            let (precision, found) = (line.judgement.precision?, line.judgement.found?);
            (precision > 0.8 && found >= 0.9).then_some(())
        };
        let good = self.values(good).len();
        println!(
            "# {section}: precise {precision:.1} %, found {found:.1} %, IoU of lights {lights:.1} %, of the plane \
             {plane:.1} %; {good} of {} photos precise and complete",
            self.lines.len()
        );
    }

    /// Prints figures on the estimated distance of the camera from the plane. Only textures that are not wrong count,
    /// because a wrong lamp says nothing about the distance.
    pub fn distances(&self, section: &str) {
        let judged = |line: &Line| line.distance.filter(|_| line.judgement.verdict < Verdict::Wrong);
        let found = self.values(judged);
        let covered = found.iter().filter(|[off, stated]| off.abs() < 1.96 * stated).count();
        let off =
            |sure: f64| found.iter().filter(|d| d[1] <= sure).map(|d| 100.0 * d[0].abs().exp_m1()).collect::<Vec<_>>();
        figure(&format!("photos.{section}.distance"), median(&off(f64::INFINITY)), "% of error, median");
        figure(
            &format!("photos.{section}.distance_sure"),
            median(&off(0.3)),
            "% of error where at most 0.3 is stated, median",
        );
        figure(
            &format!("photos.{section}.distance_covered"),
            100.0 * covered as f64 / found.len() as f64,
            "% within 1.96 stated errors",
        );
    }

    /// Prints the errors that the textures state for themselves.
    pub fn stated_errors(&self, section: &str) {
        let errors = self.values(|line| line.error);
        let at = |p: f64| format!("{:.2}", quantile(&errors, p));
        println!(
            "# stated errors of {} textures, deciles: {}",
            errors.len(),
            (0..=10).map(|i| at(f64::from(i) / 10.0)).collect::<Vec<_>>().join(" ")
        );
        figure(&format!("photos.{section}.stated_error"), median(&errors), "median");
    }
}

fn distance(photo: &Photo, outcome: &Outcome) -> Option<[f64; 2]> {
    let found = outcome.results().distance?;
    Some([(found.metres / photo.truth.distance?).ln(), found.error])
}
