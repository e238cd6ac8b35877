//! The clear coat on top of a surface: a dielectric layer with an index of refraction of 1.5 that covers a share of the
//! surface (`KHR_materials_clearcoat`). It is a GGX layer, or a perfect mirror at a roughness below 1/1000.
//!
//! Let T(ω) be the share of light from direction ω that the coat does not reflect. The BSDF of the layers below is
//! multiplied by min(T(ωi), T(ωo)), as the extension for sheen does. The product stays reciprocal, and the layers below
//! reflect at most T(ωo) times their albedo, so that no surface reflects more light than it receives. For a mirror
//! below a coat, T(ωi) = T(ωo), so no energy is lost. For the diffuse layer, see the module `bsdf`.
//!
//! Not modelled: absorption in the coat, and light that the coat reflects back to the layers below.

use super::ggx::{self, AlbedoRow, AlbedoTable, MIRROR_ROUGHNESS};
use glam::{Vec2, Vec3};

/// Reflectance at normal incidence for an index of refraction of 1.5. [convention: KHR_materials_clearcoat]
pub const F0: f32 = 0.04;

/// The clear coat of a material at one surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoatParams {
    /// Share of the surface that the coat covers; 0 for surfaces without a coat.
    pub share: f32,
    pub roughness: f32,
}

impl CoatParams {
    pub const NONE: Self = Self { share: 0.0, roughness: 0.0 };

    /// Returns the share of light that continues in a straight line through the coat.
    pub fn through(&self, cosine: f32) -> f32 {
        1.0 - self.share * fresnel(cosine)
    }

    /// Returns the albedo of the coat for a direction; `cosine` is the cosine of its angle to the normal. `table` must
    /// be given unless the coat is a mirror or absent.
    pub fn albedo(&self, cosine: f32, table: Option<&AlbedoTable>) -> f32 {
        let row = table.filter(|_| !self.is_mirror()).map(|table| table.row(self.roughness));
        self.share * albedo(row.as_ref(), cosine)
    }

    pub fn is_mirror(&self) -> bool {
        self.roughness < MIRROR_ROUGHNESS
    }
}

/// The clear coat for one viewing direction above the surface.
pub struct CoatLayer<'a> {
    share: f32,
    wo: Vec3,
    /// Albedo for the direction of the viewer.
    pub albedo: f32,
    /// The GGX lobe and its directional albedo; `None` if the coat is a mirror.
    lobe: Option<(ggx::Lobe, AlbedoRow<'a>)>,
}

impl<'a> CoatLayer<'a> {
    /// Returns `None` for a surface without a coat. `wo` is the direction of the viewer in the shading frame.
    pub fn new(params: &CoatParams, wo: Vec3, table: Option<&'a AlbedoTable>) -> Option<Self> {
        if params.share == 0.0 {
            return None;
        }
        let table = table.filter(|_| !params.is_mirror());
        let alpha = params.roughness * params.roughness;
        let lobe = table.map(|table| (ggx::Lobe::new(wo, alpha), table.row(params.roughness)));
        let albedo = params.share * albedo(lobe.as_ref().map(|(_, row)| row), wo.z);
        Some(Self { share: params.share, wo, albedo, lobe })
    }

    pub fn is_mirror(&self) -> bool {
        self.lobe.is_none()
    }

    /// Returns the share of light that the coat does not reflect; `cosine` is the cosine of the angle between its
    /// direction and the normal.
    pub fn transmittance(&self, cosine: f32) -> f32 {
        1.0 - self.share * albedo(self.lobe.as_ref().map(|(_, row)| row), cosine)
    }

    /// Returns the factor of the BSDF of the layers below (see the module's documentation); `cosine` is the cosine of
    /// the angle between the direction of the light and the normal.
    pub fn attenuation(&self, cosine: f32) -> f32 {
        self.transmittance(cosine).min(1.0 - self.albedo)
    }

    /// Returns the BRDF times the cosine of `wi`, and the solid-angle pdf of `wi`; `None` if the coat is a mirror. `h`
    /// is the half vector.
    pub fn eval(&self, wi: Vec3, h: Vec3) -> Option<(f32, f32)> {
        let (value, pdf) = self.lobe.as_ref()?.0.eval(wi, h);
        Some((self.share * fresnel(self.wo.dot(h)) * value, pdf))
    }

    /// Samples a microfacet normal; `None` if the coat is a mirror.
    pub fn sample_normal(&self, u: Vec2) -> Option<Vec3> {
        self.lobe.as_ref().map(|(lobe, _)| lobe.sample_normal(u))
    }
}

/// Returns the directional albedo of a coat that covers the whole surface. `row` is `None` if the coat is a mirror.
fn albedo(row: Option<&AlbedoRow>, cosine: f32) -> f32 {
    row.map_or_else(|| fresnel(cosine), |row| row.directional(cosine).dot(Vec2::new(F0, 1.0)))
}

fn fresnel(cosine: f32) -> f32 {
    ggx::schlick(Vec3::splat(F0), 1.0, cosine).x
}
