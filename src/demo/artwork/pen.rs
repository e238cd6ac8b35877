//! A pen drawing by hatching: evenly spaced lines (after Jobard and Lefer 1997), in sets that cross as the tone
//! darkens (Winkenbach and Salesin 1994).

use super::canvas::{Canvas, tremor};
use super::subject::{Appearance, Subject};
use crate::error::Result;
use crate::image::try_vec;
use crate::maths;
use crate::rng::Rng;
use glam::{Vec2, Vec3};

const PAPER: Vec3 = Vec3::new(0.955, 0.935, 0.885);
const INK: Vec3 = Vec3::new(0.12, 0.10, 0.13);
const SANGUINE: Vec3 = Vec3::new(0.66, 0.21, 0.12);

/// A set of parallel hatching lines.
struct Set {
    /// Drawing weight at a place of the picture: lines appear above 0 and have full strength at 1.
    weight: fn(&Appearance) -> f32,
    /// Angle in radians between these lines and strokes that follow the form (`Appearance::along`).
    turn: f32,
    /// Distance between lines, and their maximum length, in pixels, for a picture 800 pixels wide.
    spacing: f32,
    length: f32,
    ink: Vec3,
}

/// Returns the drawing weight of a place: 0 if its tone equals `tone`, 1 if its tone is lower by 0.25, and negative if
/// its tone is lighter. The weight of a highlight is 0.
fn below(appearance: &Appearance, tone: f32) -> f32 {
    // Leave highlights blank, however dark they are.
    if appearance.shine > 0.6 { 0.0 } else { (tone - appearance.tone) * 4.0 }
}

const SETS: [Set; 7] = [
    // Table and wall: slanted lines, crossed in the shadow.
    Set {
        weight: |s| if s.is_object { 0.0 } else { below(s, 0.80) },
        turn: -0.55,
        spacing: 7.5,
        length: 70.0,
        ink: INK,
    },
    Set {
        weight: |s| if s.is_object { 0.0 } else { below(s, 0.66) },
        turn: 0.25,
        spacing: 6.0,
        length: 60.0,
        ink: INK,
    },
    Set {
        weight: |s| if s.is_object { 0.0 } else { below(s, 0.52) },
        turn: -1.2,
        spacing: 5.0,
        length: 36.0,
        ink: INK,
    },
    // The object: lines around its form, then, as the tone darkens, a second and a third set of lines that cross them.
    Set { weight: |s| if s.is_object { below(s, 0.93) } else { 0.0 }, turn: 0.0, spacing: 5.2, length: 80.0, ink: INK },
    Set { weight: |s| if s.is_object { below(s, 0.66) } else { 0.0 }, turn: 1.0, spacing: 5.2, length: 48.0, ink: INK },
    Set {
        weight: |s| if s.is_object { below(s, 0.49) } else { 0.0 },
        turn: -0.7,
        spacing: 4.4,
        length: 34.0,
        ink: INK,
    },
    // Red ink for the red light from the object, on the table and reflected back onto the object.
    Set {
        weight: |s| (s.bleed - 0.035) * if s.is_object { 5.0 } else { 18.0 },
        turn: 0.5,
        spacing: 5.6,
        length: 40.0,
        ink: SANGUINE,
    },
];

pub fn draw(subject: &Subject) -> Result<Canvas> {
    let mut canvas = Canvas::paper(subject.width, subject.height, PAPER, 101)?;
    for (k, set) in SETS.iter().enumerate().rev() {
        hatch(&mut canvas, subject, set, 200 + k as u64)?;
    }
    for pass in 0..2 {
        outline(&mut canvas, subject, 300 + pass);
    }
    Ok(canvas)
}

/// The points of the lines drawn so far, in a grid of cells, to keep lines apart.
struct Drawn {
    cell: f32,
    columns: usize,
    points: Vec<Vec<(Vec2, usize)>>,
}

impl Drawn {
    fn new(subject: &Subject, cell: f32) -> Result<Self> {
        let columns = (subject.width as f32 / cell) as usize + 1;
        let rows = (subject.height as f32 / cell) as usize + 1;
        Ok(Self { cell, columns, points: try_vec(columns * rows, Vec::new())? })
    }

    fn place(&self, at: Vec2) -> (usize, usize) {
        ((at.x.max(0.0) / self.cell) as usize, (at.y.max(0.0) / self.cell) as usize)
    }

    fn add(&mut self, at: Vec2, line: usize) {
        let (x, y) = self.place(at);
        if let Some(cell) = self.points.get_mut(y * self.columns + x.min(self.columns - 1)) {
            cell.push((at, line));
        }
    }

    /// Whether a point of another line is nearer than `distance`, which must be at most the side of a cell.
    fn is_near(&self, at: Vec2, distance: f32, line: usize) -> bool {
        let (x, y) = self.place(at);
        (y.saturating_sub(1)..=y + 1).any(|row| {
            let columns = x.saturating_sub(1)..=(x + 1).min(self.columns - 1);
            columns
                .filter_map(|column| self.points.get(row * self.columns + column))
                .flatten()
                .any(|(p, other)| *other != line && p.distance_squared(at) < distance * distance)
        })
    }
}

fn hatch(canvas: &mut Canvas, subject: &Subject, set: &Set, seed: u64) -> Result<()> {
    let unit = subject.unit;
    let spacing = set.spacing * unit;
    let mut drawn = Drawn::new(subject, spacing)?;
    let count = (3.0 * (subject.width * subject.height) as f32 / (spacing * spacing)) as usize;
    let size = Vec2::new(subject.width as f32, subject.height as f32);
    for line in 0..count {
        let mut rng = Rng::new(seed, &[line as u64]);
        let start = Vec2::new(rng.next_f32(), rng.next_f32()) * size;
        let keep = spacing * (0.8 + 0.35 * rng.next_f32());
        if (set.weight)(subject.at(start)) <= 0.05 || drawn.is_near(start, keep, line) {
            continue;
        }
        // Trace the line from its start in both directions. Stop each way at the edge of the object, at a place whose
        // drawing weight is 0, near another line, or after half the line's length.
        let lean = set.turn + 0.10 * (rng.next_f32() - 0.5);
        let half_length = set.length * unit * (0.35 + 0.65 * rng.next_f32()) / 2.0;
        let mut ends = [Vec::new(), Vec::new()];
        for (way, path) in [1.0, -1.0].into_iter().zip(&mut ends) {
            let (mut at, mut gone) = (start, 0.0);
            let inside = subject.at(start).is_object;
            while gone < half_length {
                let appearance = subject.at(at);
                let along = maths::direction_at(lean + 0.06 * tremor(gone / (14.0 * unit), seed + 7 * line as u64))
                    .rotate(appearance.along);
                at += along * way * 0.6;
                gone += 0.6;
                let here = subject.at(at);
                let stop = !subject.contains(at) || here.is_object != inside || (set.weight)(here) <= 0.0;
                if stop || drawn.is_near(at, 0.6 * keep, line) {
                    break;
                }
                path.push(at);
            }
        }
        let path: Vec<Vec2> = ends[1].iter().rev().chain([&start]).chain(&ends[0]).copied().collect();
        if (path.len() as f32) < 6.0 * unit {
            continue;
        }
        let last = (path.len() - 1).max(1) as f32;
        for (i, at) in path.iter().enumerate() {
            drawn.add(*at, line);
            // Press the pen on and lift it off gradually.
            let t = i as f32 / last;
            let swell = (t / 0.12).min((1.0 - t) / 0.35).min(1.0);
            let firm =
                (set.weight)(subject.at(*at)).clamp(0.25, 1.0) * (0.75 + 0.25 * tremor(t * 5.0, seed + line as u64));
            let press = (0.25 + 0.75 * swell) * firm;
            canvas.spot(*at, unit * (0.45 + 0.75 * press), set.ink, 0.45 + 0.5 * press);
        }
    }
    Ok(())
}

/// Draws the outline of the object with an unsteady hand.
fn outline(canvas: &mut Canvas, subject: &Subject, seed: u64) {
    let unit = subject.unit;
    for y in 0..subject.height {
        for x in 0..subject.width {
            let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            let here = subject.at(at);
            let is_rim = here.is_object
                && [Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y].iter().any(|d| !subject.at(at + *d).is_object);
            if !is_rim {
                continue;
            }
            let (a, b) = (at.x / (38.0 * unit), at.y / (38.0 * unit));
            let sway = Vec2::new(tremor(a + 2.0 * b, seed), tremor(2.0 * a - b + 90.0, seed + 1)) * 1.8 * unit;
            // The outline is thin or absent on the lit side.
            let press = (1.15 - 0.8 * here.tone + 0.4 * tremor(a - b + 50.0, seed + 2)).clamp(0.0, 1.0);
            if press > 0.12 {
                canvas.spot(at + sway, unit * (0.4 + 0.9 * press), INK, 0.35 + 0.6 * press);
            }
        }
    }
}
