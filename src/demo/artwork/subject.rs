//! The scene as an artist sees it: in tones instead of radiances.

use crate::error::Result;
use crate::guides::{self, Guides};
use crate::image::colour::{linear_to_srgb, luminance};
use crate::image::{Image, try_collect, try_with_capacity};
use glam::{Vec2, Vec3};

/// `AXIS`: strokes on objects run around this axis (camera space: x right, y up, z towards the viewer). `TABLE`:
/// strokes on table and wall run in this direction (in the picture: x right, y down).
const AXIS: Vec3 = Vec3::new(0.45, 0.75, 0.48);
const TABLE: Vec2 = Vec2::new(0.97, -0.24);

/// How the artist sees one pixel of the picture.
#[derive(Clone, Copy)]
pub struct Appearance {
    /// Lightness of all light together: its luminance after exposure, sRGB-encoded, in `[0, 1]`.
    pub tone: f32,
    /// Lightness of the direct light, in `[0, 1]`.
    pub lit: f32,
    /// Lightness of the highlight (specular light), in `[0, 1]`.
    pub shine: f32,
    /// Redness of the indirect light, which other objects have reflected onto this pixel's surface. After exposure, it
    /// is red minus the mean of green and blue, at least 0.
    pub bleed: f32,
    /// Whether the pixel shows an object, as opposed to table or wall.
    pub is_object: bool,
    /// Unit direction in the picture (y down) of strokes that follow the form.
    pub along: Vec2,
    /// Strength of the edge of a shape at this pixel: 1 on an edge, 0 away from edges.
    pub edge: f32,
}

pub struct Subject {
    pub width: usize,
    pub height: usize,
    /// Unit of stroke sizes, in pixels. It is 1 in a picture 800 pixels wide.
    pub unit: f32,
    appearances: Vec<Appearance>,
}

impl Subject {
    pub fn new(guides: &Guides) -> Result<Self> {
        let [full, direct, specular, indirect, ..] = &guides.light;
        let exposure = guides::exposure(full, full)?;
        let lightness = |image: &Image, x: usize, y: usize, factor: f32| {
            linear_to_srgb((luminance(image.rgb(x, y)) * exposure * factor).clamp(0.0, 1.0))
        };
        // Take the material in the top-left corner as the background.
        let background = guides.materials.pixel(0, 0);
        // Scale the object's tones so that the 98 % quantile of its direct luminance, after exposure, becomes 0.7. An
        // object of dark paint is then drawn no darker than an object of light paint.
        let objects =
            direct.data.chunks_exact(3).zip(guides.materials.data.chunks_exact(3)).filter(|(_, m)| *m != background);
        let mut brightest = try_collect(objects.map(|(light, _)| luminance(Vec3::from_slice(light))))?;
        brightest.sort_unstable_by(f32::total_cmp);
        let light = brightest.get(brightest.len() * 98 / 100).copied().unwrap_or(0.0);
        let own = if light > 0.0 { 0.7 / (light * exposure) } else { 1.0 };
        let mut appearances = try_with_capacity(full.width * full.height)?;
        for y in 0..full.height {
            for x in 0..full.width {
                let is_object = guides.materials.pixel(x, y) != background;
                let normal = Vec3::from_slice(guides.normals.pixel(x, y));
                // Strokes run around the form, like the grooves on an object that was turned on a lathe with a tilted
                // axis.
                let ring = normal.cross(AXIS);
                let along = if is_object { Vec2::new(ring.x, -ring.y).normalize_or(Vec2::X) } else { TABLE };
                let light = indirect.rgb(x, y) * exposure;
                let factor = if is_object { own } else { 1.0 };
                appearances.push(Appearance {
                    tone: lightness(full, x, y, factor),
                    lit: lightness(direct, x, y, factor),
                    shine: lightness(specular, x, y, 1.0),
                    bleed: (light.x - 0.5 * (light.y + light.z)).max(0.0),
                    is_object,
                    along,
                    edge: guides.edges.pixel(x, y)[0],
                });
            }
        }
        Ok(Self { width: full.width, height: full.height, unit: full.width as f32 / 800.0, appearances })
    }

    pub fn contains(&self, at: Vec2) -> bool {
        at.x >= 0.0 && at.y >= 0.0 && at.x < self.width as f32 && at.y < self.height as f32
    }

    /// Returns the appearance of the nearest pixel.
    pub fn at(&self, at: Vec2) -> &Appearance {
        let clamp = |v: f32, n: usize| (v.max(0.0) as usize).min(n - 1);
        &self.appearances[clamp(at.y, self.height) * self.width + clamp(at.x, self.width)]
    }
}
