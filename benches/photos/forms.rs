//! Shapes of lamps: their outlines, and the meshes that shine.

use glam::{Vec2, Vec3};
use luxfer::scene::Mesh;
use std::f32::consts::TAU;

/// Number of corners of the polygons that stand for circles.
const CIRCLE: usize = 32;

/// The shape of a lamp around its centre, in metres.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A rectangle, by its sides along x and z.
    Rectangle(Vec2),
    Disc(f32),
    Ring {
        outer: f32,
        inner: f32,
    },
    Hexagon(f32),
    /// A convex pane of glass, by its corners.
    Pane(Vec<Vec2>),
}

impl Form {
    /// Corners of the outline, rotated by `angle` in radians from x towards z.
    pub fn outline(&self, angle: f32) -> Vec<Vec2> {
        let turn = Vec2::from_angle(angle);
        let circle = |radius: f32, count: usize| -> Vec<Vec2> {
            (0..count).map(|i| Vec2::from_angle(TAU * i as f32 / count as f32) * radius).collect()
        };
        let corners = match self {
            Self::Rectangle(size) => {
                let h = *size / 2.0;
                vec![-h, Vec2::new(h.x, -h.y), h, Vec2::new(-h.x, h.y)]
            }
            Self::Disc(radius) | Self::Ring { outer: radius, .. } => circle(*radius, CIRCLE),
            Self::Hexagon(radius) => circle(*radius, 6),
            Self::Pane(corners) => corners.clone(),
        };
        corners.into_iter().map(|p| turn.rotate(p)).collect()
    }

    /// Share of the area inside the outline that shines.
    pub fn filled(&self) -> f32 {
        match self {
            Self::Ring { outer, inner } => 1.0 - (inner / outer).powi(2),
            _ => 1.0,
        }
    }

    /// Area that shines, in m².
    pub fn area(&self) -> f32 {
        match self {
            Self::Rectangle(size) => size.x * size.y,
            Self::Disc(radius) => circle_area(*radius),
            Self::Ring { outer, inner } => circle_area(*outer) - circle_area(*inner),
            Self::Hexagon(radius) => 1.5 * 3f32.sqrt() * radius * radius,
            Self::Pane(corners) => {
                let next = |i: usize| corners[(i + 1) % corners.len()];
                (0..corners.len()).map(|i| corners[i].perp_dot(next(i)) / 2.0).sum::<f32>().abs()
            }
        }
    }

    /// The mesh of the face that shines down, around `centre`. On rectangles the texture coordinates run from 0 to 1.
    pub fn mesh(&self, centre: Vec3, angle: f32) -> Mesh {
        let place = |p: Vec2| centre + Vec3::new(p.x, 0.0, p.y);
        let outline = self.outline(angle);
        let count = outline.len() as u32;
        let mut mesh = Mesh::default();
        match self {
            Self::Ring { outer, inner } => {
                mesh.positions = outline.iter().flat_map(|p| [place(*p), place(*p * (inner / outer))]).collect();
                for i in 0..count {
                    let (a, b) = (2 * i, 2 * ((i + 1) % count));
                    mesh.triangles.extend([[a, b, b + 1], [a, b + 1, a + 1]]);
                }
            }
            _ => {
                mesh.positions = outline.iter().map(|p| place(*p)).collect();
                mesh.triangles = (1..count - 1).map(|i| [0, i, i + 1]).collect();
            }
        }
        mesh.uvs[0] = match self {
            Self::Rectangle(_) => vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            _ => vec![Vec2::splat(0.5); mesh.positions.len()],
        };
        mesh
    }
}

/// Area of the polygon that stands for a circle.
fn circle_area(radius: f32) -> f32 {
    0.5 * CIRCLE as f32 * (TAU / CIRCLE as f32).sin() * radius * radius
}
