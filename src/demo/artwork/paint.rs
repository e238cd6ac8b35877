//! A painting by brush strokes along the form: broad ones first, then fine ones in detailed areas (after Hertzmann
//! 1998). Each stroke is a bundle of bristles.

use super::canvas::{Canvas, tremor};
use super::subject::{Appearance, Subject};
use crate::error::Result;
use crate::maths;
use crate::rng::Rng;
use glam::{Vec2, Vec3};

const GROUND: Vec3 = Vec3::new(0.80, 0.52, 0.34);

/// A brush size. One unit is a pixel in a picture 800 pixels wide.
struct Brush {
    /// Half the width of the brush, and the length of its strokes, in units.
    radius: f32,
    length: f32,
    /// The brush is used where the local detail of the picture ([`detail`]) is at least this value.
    detail: f32,
}

const BRUSHES: [Brush; 3] = [
    Brush { radius: 10.0, length: 120.0, detail: 0.0 },
    Brush { radius: 5.0, length: 60.0, detail: 0.09 },
    Brush { radius: 2.6, length: 30.0, detail: 0.22 },
];

/// Returns the colour that the painter mixes for a pixel. There are two palettes of four paints, each from dark to
/// light: one for objects, one for table and wall. The light of the scene selects the position in the palette; the
/// colours of the scene are not used. Red indirect light adds purple on objects, and red on table and wall. A highlight
/// adds white.
fn mixed(s: &Appearance) -> Vec3 {
    let ramp = |stops: &[Vec3; 4], t: f32| {
        let t = t.clamp(0.0, 1.0) * 2.999;
        stops[t as usize].lerp(stops[t as usize + 1], t.fract())
    };
    const SHAPE: [Vec3; 4] = [
        Vec3::new(0.11, 0.12, 0.30),
        Vec3::new(0.07, 0.29, 0.45),
        Vec3::new(0.16, 0.55, 0.58),
        Vec3::new(0.66, 0.86, 0.72),
    ];
    const TABLE: [Vec3; 4] = [
        Vec3::new(0.22, 0.13, 0.29),
        Vec3::new(0.46, 0.25, 0.36),
        Vec3::new(0.86, 0.55, 0.28),
        Vec3::new(0.97, 0.84, 0.56),
    ];
    const RED: Vec3 = Vec3::new(0.82, 0.16, 0.20);
    const LIGHT: Vec3 = Vec3::new(1.0, 0.97, 0.88);
    if s.is_object {
        let body = ramp(&SHAPE, s.lit * 1.05).lerp(Vec3::new(0.50, 0.28, 0.52), (s.bleed * 2.0).min(0.55));
        body.lerp(LIGHT, ((s.shine - 0.4) * 2.5).clamp(0.0, 1.0))
    } else {
        ramp(&TABLE, s.tone * 1.02).lerp(RED, ((s.bleed - 0.03) * 5.0).clamp(0.0, 0.6))
    }
}

pub fn draw(subject: &Subject) -> Result<Canvas> {
    let mut canvas = Canvas::linen(subject.width, subject.height, GROUND, 121)?;
    for (k, brush) in BRUSHES.iter().enumerate() {
        layer(&mut canvas, subject, brush, 500 + k as u64);
    }
    Ok(canvas)
}

fn layer(canvas: &mut Canvas, subject: &Subject, brush: &Brush, seed: u64) {
    let radius = brush.radius * subject.unit;
    let spacing = 0.85 * radius;
    let (columns, rows) = ((subject.width as f32 / spacing) as u64 + 1, (subject.height as f32 / spacing) as u64 + 1);
    // Place the strokes in random order.
    let mut places: Vec<u64> = (0..columns * rows).collect();
    places.sort_by_key(|&p| crate::rng::hash(seed, &[p]));
    for place in places {
        let mut rng = Rng::new(seed + 50, &[place]);
        let jitter = Vec2::new(rng.next_f32(), rng.next_f32());
        let at = (Vec2::new((place % columns) as f32, (place / columns) as f32) + jitter) * spacing;
        if !subject.contains(at) || detail(subject, at, radius) < brush.detail || rng.next_f32() < 0.25 {
            continue;
        }
        stroke(canvas, subject, brush, at, rng);
    }
}

/// Returns the local detail. Compares the colours of four points, two brush radii from `at` along x and y, with the
/// colour at `at`. The detail is the largest difference, or the edge strength if that is larger.
fn detail(subject: &Subject, at: Vec2, radius: f32) -> f32 {
    let around = [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y].map(|d| mixed(subject.at(at + d * 2.0 * radius)));
    let here = mixed(subject.at(at));
    around.iter().map(|c| (*c - here).length()).fold(subject.at(at).edge, f32::max)
}

fn stroke(canvas: &mut Canvas, subject: &Subject, brush: &Brush, start: Vec2, mut rng: Rng) {
    let (unit, radius) = (subject.unit, brush.radius * subject.unit);
    let here = *subject.at(start);
    // Vary the colour of each stroke at random.
    let shift = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) - 0.5;
    let colour = mixed(&here) * (0.93 + 0.14 * rng.next_f32()) + 0.07 * shift;

    // Run the stroke along the form of the object, or slanted on table and wall. End it where the object ends, or where
    // the colour differs too much from the colour at the start.
    let lean = if here.is_object { 0.25 } else { -0.75 } + 0.35 * (rng.next_f32() - 0.5);
    let length = brush.length * unit * (0.4 + 0.6 * rng.next_f32());
    let (bend, wobble) = (0.006 / unit * (rng.next_f32() - 0.5), rng.next_u32() as u64);
    let mut ends = [Vec::new(), Vec::new()];
    for (way, path) in [1.0, -1.0].into_iter().zip(&mut ends) {
        let (mut at, mut gone) = (start, 0.0);
        while gone < length / 2.0 {
            let direction = maths::direction_at(lean + bend * gone * way).rotate(subject.at(at).along) * way;
            at += direction * 0.8;
            gone += 0.8;
            let appearance = subject.at(at);
            if !subject.contains(at)
                || appearance.is_object != here.is_object
                || (mixed(appearance) - mixed(&here)).length() > 0.17
            {
                break;
            }
            path.push((at, direction * way));
        }
    }
    let along = maths::direction_at(lean).rotate(here.along);
    let path: Vec<(Vec2, Vec2)> = ends[1].iter().rev().chain([&(start, along)]).chain(&ends[0]).copied().collect();

    // Draw the bristles, each with a limited load of paint.
    let bristles = (2.0 * radius / 0.9).ceil().max(2.0) as usize;
    let last = path.len() as f32;
    for b in 0..bristles {
        let across = (2.0 * (b as f32 + 0.5) / bristles as f32 - 1.0) * radius;
        let (tint, load) = (1.0 + 0.16 * (rng.next_f32() - 0.5), 0.65 + 0.6 * rng.next_f32());
        let (late, thick) = (0.08 * rng.next_f32(), rng.next_f32());
        for (i, (at, direction)) in path.iter().enumerate() {
            let t = i as f32 / last;
            if t < late {
                continue;
            }
            let dry = ((load - t) / 0.25).clamp(0.0, 1.0);
            let sway = 0.6 * unit * tremor(i as f32 * 0.03 + b as f32 * 0.4, wobble);
            let place = *at + direction.perp() * (across + sway);
            canvas.touch(place, 0.62, colour * tint, 0.3 + 0.7 * dry, 0.3 + 0.7 * thick);
        }
    }
}
