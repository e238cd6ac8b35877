//! A stipple drawing, with denser dots where the subject is darker (Poisson disks of varying radius, by dart
//! throwing).

use super::canvas::Canvas;
use super::subject::{Appearance, Subject};
use crate::error::Result;
use crate::image::try_vec;
use crate::maths;
use crate::rng::Rng;
use glam::{Vec2, Vec3};

const PAPER: Vec3 = Vec3::new(0.96, 0.95, 0.92);
const BLUE: Vec3 = Vec3::new(0.09, 0.13, 0.33);
const RED: Vec3 = Vec3::new(0.80, 0.16, 0.18);

/// A kind of dots: their ink, size and distribution.
struct Ink {
    /// Wanted darkness at a place of the picture: from 0 (no dots) to 1 (dots as dense as possible). Values outside
    /// this range count as 0 or 1.
    darkness: fn(&Appearance) -> f32,
    colour: Vec3,
    /// Radius of a dot in pixels, for a picture 800 pixels wide.
    radius: f32,
}

const INKS: [Ink; 2] = [
    Ink {
        darkness: |s| match () {
            () if s.shine > 0.6 => 0.0,
            () if s.is_object => 1.1 * (0.9 - s.tone) + 0.25 * s.edge - 0.3 * s.bleed,
            () => 1.3 * (0.84 - s.tone),
        },
        colour: BLUE,
        radius: 1.25,
    },
    Ink {
        darkness: |s| match () {
            () if s.shine > 0.6 => 0.0,
            () if s.is_object => 0.24 + 0.9 * s.bleed + 0.4 * s.edge - 0.12 * s.lit,
            () => 3.2 * (s.bleed - 0.03),
        },
        colour: RED,
        radius: 1.15,
    },
];

pub fn draw(subject: &Subject) -> Result<Canvas> {
    let mut canvas = Canvas::paper(subject.width, subject.height, PAPER, 111)?;
    for (k, ink) in INKS.iter().enumerate().rev() {
        dots(&mut canvas, subject, ink, 400 + k as u64)?;
    }
    Ok(canvas)
}

/// Upper limit of the distance that a dot keeps from other dots, in radii of a dot. Dots farther apart look like single
/// spots and not like a tone. [convention]
const MAX_SPACING: f32 = 9.0;

fn dots(canvas: &mut Canvas, subject: &Subject, ink: &Ink, seed: u64) -> Result<()> {
    let radius = ink.radius * subject.unit;
    // Store the dots in a grid whose cells hold at most one dot each.
    let cell = (1.45 * radius).max(1.0) / std::f32::consts::SQRT_2;
    let (columns, rows) = ((subject.width as f32 / cell) as usize + 1, (subject.height as f32 / cell) as usize + 1);
    let mut taken = try_vec(columns * rows, Vec2::NAN)?;
    let size = Vec2::new(subject.width as f32, subject.height as f32);
    for dart in 0..4 * columns * rows {
        let mut rng = Rng::new(seed, &[dart as u64]);
        let at = Vec2::new(rng.next_f32(), rng.next_f32()) * size;
        let darkness = (ink.darkness)(subject.at(at)).min(1.0);
        if darkness < 0.03 {
            continue;
        }
        // Space the dots such that the share of the paper that they cover roughly equals the darkness.
        let apart = radius * (1.75 / darkness.sqrt()).clamp(1.45, MAX_SPACING);
        let (x, y, span) = ((at.x / cell) as usize, (at.y / cell) as usize, (apart / cell).ceil() as usize);
        let mut near = (y.saturating_sub(span)..(y + span + 1).min(rows))
            .flat_map(|row| {
                (x.saturating_sub(span)..(x + span + 1).min(columns)).map(move |column| row * columns + column)
            })
            .map(|i| taken[i]);
        if near.any(|other| other.distance_squared(at) < apart * apart) {
            continue;
        }
        taken[y * columns + x] = at;
        // Draw two touches of the nib side by side, so that no dot is a perfect disk.
        let size = radius * (0.72 + 0.4 * rng.next_f32() + 0.15 * darkness);
        let aside = maths::direction_at(rng.next_f32() * std::f32::consts::TAU) * 0.45 * size;
        canvas.spot(at, size * 0.85, ink.colour, 0.95);
        canvas.spot(at + aside, size * 0.7, ink.colour, 0.9);
    }
    Ok(())
}
