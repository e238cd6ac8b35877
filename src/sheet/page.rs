//! The arrangement of the page: positions of the picture and of the marks.

use super::params::Params;
use crate::error::{Error, Result};
use crate::geometry::Homography;
use crate::image::MAX_SIDE;
use glam::{DMat3, DVec2};

/// Radius of a mark, and minimum distance between its edge and the picture, in millimetres. [convention]
const RADIUS: f64 = 4.5;
const CLEARANCE: f64 = 2.5;

/// Positions of the marks on the border of a rectangle, as shares of its sides. First come the four corners and the
/// four midpoints of sides, each in cyclic order. The last two marks break the symmetry, so that no rotation or
/// reflection maps the marks onto themselves. [convention]
const MARKS: [[f64; 2]; 10] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [1.0, 1.0],
    [0.0, 1.0],
    [0.5, 0.0],
    [1.0, 0.5],
    [0.5, 1.0],
    [0.0, 0.5],
    [0.25, 0.0],
    [0.0, 0.32],
];

/// Radius of a dot, and minimum distance between its edge and that of a mark or another dot, in millimetres.
/// [convention]
const DOT_RADIUS: f64 = 1.0;
const DOT_CLEARANCE: f64 = 2.0;
/// The dots divide each side of the rectangle of the marks into this many equal parts.
const DOTS: usize = 12;

/// The arrangement of the page, in page pixels.
pub struct Page {
    pub width: usize,
    pub height: usize,
    /// Centres of the marks in the order of [`MARKS`] (`marks`), and their common `radius`.
    pub marks: [DVec2; 10],
    pub radius: f64,
    /// Centres of the dots between the marks (`dots`), and their common radius. Sheets printed by versions before 0.2
    /// have none.
    pub dots: Vec<DVec2>,
    pub dot_radius: f64,
    /// Top-left corner (`corner`) and size (`size`) of the picture, each x and y.
    pub corner: [f64; 2],
    pub size: [f64; 2],
}

impl Page {
    pub fn new(params: &Params, picture_width: usize, picture_height: usize) -> Result<Self> {
        let dot = params.dpi / 25.4;
        let extent = (params.paper * dot).round();
        if extent.max_element() > MAX_SIDE as f64 {
            return Err(Error::argument(format!(
                "the sheet would have {} x {} pixels; at most {MAX_SIDE} are possible: lower dpi",
                extent.x, extent.y
            )));
        }
        let low = DVec2::splat((params.margin + RADIUS) * dot);
        // Round to pixel corners, so that the quadrants are drawn exactly.
        let marks = MARKS.map(|m| (low + DVec2::from(m) * (extent - 2.0 * low)).round());
        let dots = dots(&marks, dot);
        let inner = DVec2::splat((params.margin + 2.0 * RADIUS + CLEARANCE) * dot);
        let available = extent - 2.0 * inner;
        if picture_width == 0 || picture_height == 0 || available.min_element() < 4.0 * RADIUS * dot {
            return Err(Error::argument(format!(
                "paper of {} x {} mm has no space for a picture of {picture_width} x {picture_height} pixels between \
                 its marks",
                params.paper.x, params.paper.y
            )));
        }
        // Place the picture in the centre, as large as possible, on whole pixels.
        let picture = DVec2::new(picture_width as f64, picture_height as f64);
        let size = (picture * (available / picture).min_element()).round().max(DVec2::ONE);
        let corner = ((extent - size) / 2.0).round();
        Ok(Self {
            width: extent.x as usize,
            height: extent.y as usize,
            marks,
            radius: RADIUS * dot,
            dots,
            dot_radius: DOT_RADIUS * dot,
            corner: corner.to_array(),
            size: size.to_array(),
        })
    }

    /// Returns the map from pixels of the picture to pixels of the page.
    pub fn from_picture(&self, width: usize, height: usize) -> Homography {
        let scale = DVec2::from(self.size) / DVec2::new(width as f64, height as f64);
        Homography(DMat3::from_translation(self.corner.into()) * DMat3::from_scale(scale))
    }

    /// Returns the brightness of a pixel of the page due to its marks and dots; 1 away from them.
    pub fn mark_shade(&self, x: usize, y: usize) -> f32 {
        let centre = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let nearest =
            |places: &[DVec2], radius: f64| places.iter().copied().find(|place| place.distance(centre) <= radius + 1.0);
        let share = |is_black: &dyn Fn(DVec2) -> bool| {
            // Estimate the share of the pixel that is black by supersampling.
            let sample =
                |i: usize| DVec2::new(x as f64 + (i % 4) as f64 / 4.0 + 0.125, y as f64 + (i / 4) as f64 / 4.0 + 0.125);
            1.0 - (0..16).filter(|&i| is_black(sample(i))).count() as f32 / 16.0
        };
        if let Some(mark) = nearest(&self.marks, self.radius) {
            share(&|p| mark.distance(p) < self.radius && (p.x - mark.x) * (p.y - mark.y) > 0.0)
        } else if let Some(dot) = nearest(&self.dots, self.dot_radius) {
            share(&|p| dot.distance(p) < self.dot_radius)
        } else {
            1.0
        }
    }
}

/// Returns the centres of the dots, which lie on the rectangle of the marks; `dot` is the number of page pixels per
/// millimetre. A place too near to a mark, or to the dot before it, has no dot.
fn dots(marks: &[DVec2], dot: f64) -> Vec<DVec2> {
    let [low, high] = [marks[0], marks[2]];
    let mut dots: Vec<DVec2> = Vec::new();
    for k in 0..4 * DOTS {
        let along = (k % DOTS) as f64 / DOTS as f64;
        let share = [
            DVec2::new(along, 0.0),
            DVec2::new(1.0, along),
            DVec2::new(1.0 - along, 1.0),
            DVec2::new(0.0, 1.0 - along),
        ];
        // Round to pixel corners, so that the disk is drawn symmetrically.
        let place = (low + share[k / DOTS] * (high - low)).round();
        let is_apart =
            |other: &DVec2, radius: f64| other.distance(place) >= (radius + DOT_RADIUS + DOT_CLEARANCE) * dot;
        if marks.iter().all(|m| is_apart(m, RADIUS)) && dots.iter().all(|d| is_apart(d, DOT_RADIUS)) {
            dots.push(place);
        }
    }
    dots
}
