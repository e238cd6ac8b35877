//! Types of lamps, and lamps that are blended from two photos.

use crate::harness::figure;
use glam::DVec2;
use luxfer::emission::{self, Input, Style};
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight::EmissionLamps;
use luxfer::rng::Rng;

/// Number of sets of lamps.
const SETS: u64 = 300;

/// Prints the share of sets of lamps that are divided into the right number of types. The lamps are discs of 1.5 to 8
/// texels radius at any place. In a third of the sets, all have one size; in the others, half of them have 1.5 or 2
/// times the area.
pub fn types() {
    let mut right = 0;
    for seed in 0..SETS {
        let mut rng = Rng::new(83, &[seed]);
        let radius = 1.5 + 6.5 * rng.next_f64();
        let ratio = [1.0, 1.5, 2.0][seed as usize % 3];
        let (cell, across) = (32.0, 5);
        let lamps: Vec<(DVec2, f64)> = (0..across * across)
            .map(|i| {
                let place = DVec2::new((i % across) as f64 + 0.5, (i / across) as f64 + 0.5) * cell;
                let at = place + DVec2::new(rng.next_f64(), rng.next_f64());
                (at, radius * if i % 2 == 0 { 1.0 } else { f64::sqrt(ratio) })
            })
            .collect();
        let side = across * cell as usize;
        let label = |i: usize| {
            let p = DVec2::new((i % side) as f64 + 0.5, (i / side) as f64 + 0.5);
            lamps.iter().position(|(at, r)| p.distance(*at) < *r).map_or(0, |k| k as u32 + 1)
        };
        let found = EmissionLamps::of_labels(side, side, (0..side * side).map(label).collect()).expect("lamps");
        right += u64::from(found.types().1 == if ratio > 1.0 { 2 } else { 1 });
    }
    figure("constants.types.right", 100.0 * right as f64 / SETS as f64, "%");
}

/// An exemplar: squares or discs on a lattice, and their light mask.
fn exemplar(period: DVec2, half: f64, is_round: bool) -> [Image; 3] {
    let side = 240;
    let is_lit = |x: usize, y: usize| {
        let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let q = (p / period - (p / period).floor() - 0.5) * period;
        if is_round { q.length() < half } else { q.abs().max_element() < half }
    };
    let lamp = if is_round { [0.9, 0.5, 0.2] } else { [0.4, 0.6, 0.9] };
    let image = |image: luxfer::error::Result<Image>| image.expect("a small image");
    [
        image(Image::from_fn(side, side, |x, y| if is_lit(x, y) { lamp } else { [0.1; 3] })),
        image(Image::from_fn(side, side, |x, y| [f32::from(u8::from(is_lit(x, y)))])),
        image(Image::from_fn(side, side, |_, _| [1.0])),
    ]
}

/// Blends two photos of lamps half and half, on equal lattices, on different ones, and dense lamps with sparse ones.
/// Prints the number of lamps relative to the mean of both photos, and the share of lamps whose nearest neighbour is of
/// the other photo: half of them at random, few where each photo rules a part of the texture.
pub fn blended() {
    // Periods and half sizes of the two exemplars.
    let pairs = [
        ("equal", [30.0, 30.0], [7.0, 7.0]),
        ("different", [30.0, 37.0], [7.0, 7.0]),
        ("dense", [26.0, 31.0], [10.0, 11.0]),
        ("sparse", [24.0, 60.0], [6.0, 8.0]),
    ];
    for (name, periods, halves) in pairs {
        let [a, b] = [0, 1].map(|k| exemplar(DVec2::splat(periods[k]), halves[k], k == 1));
        let input = |e: &'static [Image; 3]| Input { unwarped: &e[0], light: &e[1], valid: &e[2], photo: None };
        let [a, b] = [a, b].map(|e| input(Box::leak(Box::new(e))));
        let weights = Image::from_fn(2, 2, |_, _| [0.5]).expect("weights");
        let params = emission::Params { width: 600, height: 600, ..emission::Params::default() };
        let styles = [Style { input: b, scale: 1.0, weights: &weights }];
        let Ok(found) = emission::blend(&a, &styles, &params, Monitor::default().job()) else {
            println!("# {name}: no texture");
            continue;
        };
        let lamps: Vec<(DVec2, bool)> = found.luminaires.iter().map(|l| (l.centre, l.colour.x > l.colour.z)).collect();
        let expected: f64 = periods.iter().map(|p| 600.0 * 600.0 / (p * p) / 2.0).sum();
        let nearest = |i: usize| {
            let others = lamps.iter().enumerate().filter(|(j, _)| *j != i);
            others.min_by(|a, b| a.1.0.distance(lamps[i].0).total_cmp(&b.1.0.distance(lamps[i].0))).map(|o| o.1.1)
        };
        let mixed = (0..lamps.len()).filter(|&i| nearest(i) == Some(!lamps[i].1)).count();
        let first = lamps.iter().filter(|l| !l.1).count();
        figure(&format!("constants.lamps.{name}.count"), 100.0 * lamps.len() as f64 / expected, "%");
        figure(&format!("constants.lamps.{name}.first"), 100.0 * first as f64 / lamps.len().max(1) as f64, "%");
        figure(&format!("constants.lamps.{name}.mixed"), 100.0 * mixed as f64 / lamps.len().max(1) as f64, "%");
    }
}
