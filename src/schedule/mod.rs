//! The luminaire schedule: lists every lamp of an emissive texture as a fixture in the room, with its photometric data.

mod file;

pub use file::{to_csv, to_json};

use crate::emission::{Emission, Luminaire};
use crate::image::colour::luminance;
use crate::maths;
use crate::photometry::temperature;
use crate::scene::surface::Surface;
use glam::{DVec2, Vec3};
use std::f64::consts::PI;

/// One lamp on the surface, with its photometric data.
#[derive(Clone, Debug, PartialEq)]
pub struct Fixture {
    /// Centre in scene coordinates, in metres.
    pub position: Vec3,
    /// Unit vector in the main direction of the light.
    pub normal: Vec3,
    /// Unit vector along the lamp's long axis.
    pub axis: Vec3,
    /// Lengths along and across the axis in metres.
    pub size: DVec2,
    /// Area in m².
    pub area: f64,
    /// Mean emission: linear RGB whose luminance is in cd/m².
    pub radiance: Vec3,
    /// Luminous flux in lumens: π × luminance × area, because the lamp is Lambertian.
    pub flux: f64,
    /// Correlated colour temperature in kelvin, and Duv, the distance from the blackbody locus
    /// ([`crate::photometry::temperature::Temperature`]); both 0 for a lamp that is off.
    pub cct: f64,
    pub duv: f64,
    /// Number of the lamp's kind, as in [`Luminaire`].
    pub kind: u32,
    /// Corners of the outline in scene coordinates, in metres.
    pub outline: Vec<Vec3>,
}

/// Lists the lamps of an emissive texture on a surface of the scene. `strength` is the emission of the surface's
/// material: the luminance per channel, in cd/m², of a texel with the value 1.
pub fn fixtures(emission: &Emission, surface: &Surface, strength: Vec3) -> Vec<Fixture> {
    emission.luminaires.iter().map(|lamp| fixture(emission, surface, strength, lamp)).collect()
}

fn fixture(emission: &Emission, surface: &Surface, strength: Vec3, lamp: &Luminaire) -> Fixture {
    let (width, height) = (emission.texture.width as f64, emission.texture.height as f64);
    let texel = DVec2::new(f64::from(surface.size.x) / width, f64::from(surface.size.y) / height);
    let on_surface = |texels: DVec2| {
        let p = (texels * texel).as_vec2();
        surface.origin + surface.u_axis * p.x + surface.v_axis * p.y
    };
    let axis = maths::direction_at(lamp.orientation);
    let area = lamp.area * texel.x * texel.y;
    let radiance = lamp.colour * strength;
    let temperature = temperature::of_rgb(radiance.as_dvec3());
    Fixture {
        position: on_surface(lamp.centre),
        normal: surface.normal,
        axis: surface.u_axis * axis.x as f32 + surface.v_axis * axis.y as f32,
        size: DVec2::new(lamp.size.x * (axis * texel).length(), lamp.size.y * (axis.perp() * texel).length()),
        area,
        radiance,
        flux: PI * f64::from(luminance(radiance)) * area,
        cct: temperature.map_or(0.0, |t| t.kelvin),
        duv: temperature.map_or(0.0, |t| t.duv),
        kind: lamp.kind,
        outline: lamp.outline.iter().map(|&corner| on_surface(corner)).collect(),
    }
}
