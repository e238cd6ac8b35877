//! Loads photos with known cameras and labelled sets of segments, and computes the errors of estimated vanishing
//! points. `tests/real/rectify.rs` and `benches/vp.rs` share this module.
//!
//! Data are read from `LUXFER_TEST_DATA` (default `../shared/data`). Without data the tests are skipped; in CI they
//! fail.

// Each crate that includes this module uses only a part of it.
#![allow(dead_code)]

use glam::{DMat3, DVec2, DVec3};
use luxfer::geometry::Segment;
use luxfer::image::Image;
use luxfer::image::io::{self, Encoding};
use luxfer::job::Monitor;
use luxfer::rectify::metric::Line;
use luxfer::rectify::{Params, vanishing};
use serde_json::Value;
use std::path::PathBuf;

/// Returns the path of a part of the test data. If it is missing, prints a message and returns `None`; panics in CI.
pub fn data(part: &str) -> Option<PathBuf> {
    let root = std::env::var_os("LUXFER_TEST_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let path = root.join(part);
    if path.exists() {
        return Some(path);
    }
    assert!(std::env::var_os("CI").is_none(), "{} is missing", path.display());
    eprintln!("skipped: {} is missing", path.display());
    None
}

pub fn read_json(path: &std::path::Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

pub fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().map_or(Vec::new(), |a| a.iter().filter_map(Value::as_f64).collect())
}

/// A photo with the calibration matrix and the true directions of its room axes in camera space.
pub struct Labelled {
    pub name: String,
    pub photo: Image,
    pub intrinsics: DMat3,
    pub directions: Vec<DVec3>,
}

fn intrinsics(f: f64, cx: f64, cy: f64) -> DMat3 {
    DMat3::from_cols(DVec3::X * f, DVec3::Y * f, DVec3::new(cx, cy, 1.0))
}

pub fn labelled_photos() -> Vec<Labelled> {
    let mut out = Vec::new();
    for folder in ["photos", "photos/hdri"] {
        let Some(folder) = data(folder) else { continue };
        let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        files.sort();
        for json in files.iter().filter(|p| p.extension().is_some_and(|e| e == "json")) {
            let truth = read_json(json);
            let Some(points) = truth["vanishing_points"].as_object() else { continue };
            let Some(f) = truth["fx"].as_f64() else { continue };
            let k = intrinsics(f, truth["cx"].as_f64().unwrap(), truth["cy"].as_f64().unwrap());
            let directions = points
                .values()
                .map(|v| (k.inverse() * DVec3::from_slice(&numbers(&v["homogeneous"]))).normalize())
                .collect();
            let Some(file) = ["jpg", "hdr"].iter().map(|e| json.with_extension(e)).find(|p| p.exists()) else {
                continue;
            };
            let photo = io::load(&file, Encoding::Srgb).unwrap();
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            out.push(Labelled { name, photo, intrinsics: k, directions });
        }
    }
    out
}

/// For each true direction, the angle in degrees to the nearest of the estimated vanishing points.
pub fn errors(truth: &[DVec3], points: &[DVec3], k: DMat3) -> Vec<f64> {
    let found: Vec<DVec3> = points.iter().map(|&p| (k.inverse() * p).normalize()).collect();
    truth
        .iter()
        .map(|t| found.iter().map(|d| d.cross(*t).length().atan2(d.dot(*t).abs()).to_degrees()).fold(90.0, f64::min))
        .collect()
}

/// Finds the one-to-one assignment of rows to columns that has the minimum total cost, by trying all assignments (for
/// short lists only). An unassigned row costs 90. Starts at `row`, with the columns of the bit set
/// `free`. Returns the total cost and the cost of each row, last row first.
fn assigned(cost: &[Vec<f64>], row: usize, free: u32) -> (f64, Vec<f64>) {
    if row == cost.len() {
        return (0.0, Vec::new());
    }
    let (total, mut list) = assigned(cost, row + 1, free);
    list.push(90.0);
    let mut best = (total + 90.0, list);
    for c in (0..cost[row].len()).filter(|c| free & (1 << c) != 0) {
        let (total, mut list) = assigned(cost, row + 1, free & !(1 << c));
        if total + cost[row][c] < best.0 {
            list.push(cost[row][c]);
            best = (total + cost[row][c], list);
        }
    }
    best
}

/// A published data set: for each image, its detected segments and the true directions of some of its vanishing
/// points.
pub struct GivenSet {
    pub width: usize,
    pub height: usize,
    pub intrinsics: DMat3,
    pub images: Vec<(Vec<Segment>, Vec<DVec3>)>,
}

/// Reads `vp/<name>.json.gz`.
pub fn given_set(name: &str) -> Option<GivenSet> {
    let path = data(&format!("vp/{name}.json.gz"))?;
    let unpacked = std::process::Command::new("gzip").arg("-dc").arg(&path).output().unwrap();
    let set: Value = serde_json::from_slice(&unpacked.stdout).unwrap();
    let k: Vec<Vec<f64>> = set["K"].as_array().unwrap().iter().map(numbers).collect();
    let intrinsics = DMat3::from_cols_array_2d(&[0, 1, 2].map(|c| [0, 1, 2].map(|r| k[r][c])));
    let to_ray = intrinsics.inverse();
    let lists = |v: &Value| -> Vec<Vec<f64>> { v.as_array().unwrap().iter().map(numbers).collect() };
    let segment = |s: Vec<f64>| Segment { a: DVec2::new(s[0], s[1]), b: DVec2::new(s[2], s[3]) };
    let images = set["images"].as_array().unwrap().iter().map(|image| {
        let segments = lists(&image["segments"]).into_iter().map(segment).collect();
        (segments, lists(&image["vps"]).iter().map(|v| (to_ray * DVec3::from_slice(v)).normalize()).collect())
    });
    Some(GivenSet {
        width: set["width"].as_u64().unwrap() as usize,
        height: set["height"].as_u64().unwrap() as usize,
        intrinsics,
        images: images.collect(),
    })
}

impl GivenSet {
    /// Evaluates the set by the published protocol (Kluger et al. 2020): the method receives the number of directions;
    /// estimates are assigned to true directions one to one with the minimum total angle; a missing estimate counts as
    /// 90 degrees. Returns the angles of all images in degrees, sorted.
    pub fn angles(&self, params: &Params) -> Vec<f64> {
        let monitor = Monitor::default();
        let mut all = Vec::new();
        for (segments, truth) in &self.images {
            let found = vanishing::from_segments(segments, self.width, self.height, truth.len(), params, monitor.job());
            let points: Vec<DVec3> = found.map_or(Vec::new(), |f| f.points.iter().map(|p| p.point).collect());
            let cost: Vec<Vec<f64>> = truth
                .iter()
                .map(|t| points.iter().map(|&p| errors(&[*t], &[p], self.intrinsics)[0]).collect())
                .collect();
            all.extend(assigned(&cost, 0, u32::MAX).1);
        }
        all.sort_by(f64::total_cmp);
        all
    }

    /// Measures an upper bound of the accuracy that the segments allow: estimates each true direction from the
    /// segments that are nearest to it, with the camera known. Returns the angles of each image in degrees, in the
    /// order of its true directions.
    pub fn from_labelled_lines(&self) -> Vec<Vec<f64>> {
        let (monitor, k) = (Monitor::default(), self.intrinsics);
        let params = Params { focal: Some(k.x_axis.x), principal: Some(k.z_axis.truncate()), ..Params::default() };
        let of_image = |(segments, truth): &(Vec<Segment>, Vec<DVec3>)| {
            let points: Vec<DVec3> = truth.iter().map(|&d| k * d).collect();
            let own = |index: usize| {
                let is_own = |s: &&Segment| {
                    // A segment belongs to its nearest direction if it deviates by less than 3.5 degrees and, at its
                    // ends, by less than 2 pixels.
                    let Some(line) = Line::new(s) else { return false };
                    let sines = points.iter().map(|&p| line.sine(p));
                    let nearest = sines.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
                    nearest.is_some_and(|(i, sine)| i == index && sine < 0.06 && line.half * sine < 2.0)
                };
                segments.iter().filter(is_own).copied().collect::<Vec<_>>()
            };
            (0..truth.len())
                .map(|i| {
                    let found = vanishing::from_segments(&own(i), self.width, self.height, 1, &params, monitor.job());
                    found.map_or(90.0, |f| errors(&truth[i..=i], &[f.points[0].point], k)[0])
                })
                .collect()
        };
        self.images.iter().map(of_image).collect()
    }

    /// Keeps only the first three directions of each image; for York Urban, these are the published labels.
    pub fn first_three(mut self) -> Self {
        for (_, truth) in &mut self.images {
            truth.truncate(3);
        }
        self
    }
}

/// Area under the cumulative distribution of the angles up to `limit`, as a share of the full area (AUC): each angle
/// below the limit adds its distance from the limit.
pub fn area(angles: &[f64], limit: f64) -> f64 {
    angles.iter().map(|e| (limit - e).max(0.0)).sum::<f64>() / (limit * angles.len() as f64)
}
