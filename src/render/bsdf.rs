//! The BSDF of a surface point, after the metallic-roughness model of glTF 2.0 (appendix B).
//!
//! The model has a Lambertian layer below a GGX layer (the top layer). At a roughness below 1/1000, the top layer is a
//! perfect mirror. Of the light that passes the top layer, the share `transmission` continues in a straight line, as
//! through a thin pane (`KHR_materials_transmission` without volume). Appendix B blends the two layers by the Fresnel
//! factor of the half vector; the sum of both layers then reflects up to twice the incident light at grazing angles.
//! This module instead multiplies the diffuse layer by (1 - E(ωi)) (1 - E(ωo)) / (1 - Ē), so that it reflects only what
//! the top layer lets through (Kelemen and Szirmay-Kalos 2001). Here E(ω) is the albedo of the dielectric top layer for
//! the incoming (ωi) or outgoing (ωo) direction, and Ē its cosine-weighted mean. A dielectric with an index of
//! refraction of 1 has no top layer.
//!
//! Above the top layer may lie a clear coat ([`CoatLayer`]). For the diffuse layer, 1 - E(ω) is then the product of the
//! shares that the coat and the top layer let through.
//!
//! The surface of a solid transparent body is another BSDF: a boundary that reflects and refracts ([`Dielectric`]).
//!
//! Not modelled: frosted panes, anisotropy, multiple scattering between microfacets.

use super::clear_coat::{self, CoatLayer, CoatParams};
use super::dielectric::{Dielectric, DielectricSample};
use super::ggx::{self, AlbedoTable, MIRROR_ROUGHNESS};
use super::medium::{Boundary, Media};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Smallest perceptual roughness at which neighbouring pixels may share a path vertex. On smoother surfaces, their
/// slightly different view directions would see different highlights. At this roughness, the microfacets tilt by about
/// 0.1² = 0.01 rad. A block of 4 pixels, in a view of 60° across 1000 pixels, spans only 0.004 rad, so its pixels see
/// nearly the same highlight. Estimates with shared vertices are unbiased, so any value gives the same expected image.
/// [convention]
const SHAREABLE_ROUGHNESS: f32 = 0.1;

/// The BSDF parameters of a material at one surface point.
#[derive(Clone, Copy, Debug)]
pub struct BsdfParams {
    /// Albedo of the diffuse layer, already multiplied by 1 - metallic and by 1 - transmission.
    pub diffuse: Vec3,
    /// Reflectance of the top layer at normal incidence (`f0`) and at grazing incidence (`f90`).
    pub f0: Vec3,
    pub f90: f32,
    pub roughness: f32,
    /// Share of the light that continues in a straight line through the material, before the reflection loss at the
    /// top layer is subtracted; 0 for opaque materials.
    pub transmission: Vec3,
    /// Reflectance of the material's dielectric component at normal and at grazing incidence, without its metallic
    /// component, in the channel with the largest reflectance. The attenuation of the diffuse layer and of the
    /// transmitted light follows from it (`KHR_materials_specular`).
    pub dielectric_f0: f32,
    pub dielectric_f90: f32,
    pub coat: CoatParams,
}

impl BsdfParams {
    /// Returns the share of a ray's light that continues in a straight line; `cosine` is the cosine of the angle
    /// between the ray and the normal.
    pub fn through(&self, cosine: f32) -> Vec3 {
        if self.transmission == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let lost = ggx::schlick(Vec3::splat(self.dielectric_f0), self.dielectric_f90, cosine.abs()).x;
        self.transmission * ((1.0 - lost) * self.coat.through(cosine.abs()))
    }

    /// Whether there is a layer besides the diffuse one.
    pub fn is_layered(&self) -> bool {
        self.f90 > 0.0 || self.transmission != Vec3::ZERO || self.coat.share > 0.0
    }

    /// Returns the reflectance plus the transmittance at normal incidence.
    fn colour(&self) -> Vec3 {
        let below = self.diffuse + (self.f0 + self.transmission);
        if self.coat.share == 0.0 {
            return below;
        }
        let coat = self.coat.share * clear_coat::F0;
        below * (1.0 - coat) + Vec3::splat(coat)
    }
}

/// The BSDF at a surface point for one viewing direction, with its shading frame.
pub struct Bsdf<'a> {
    /// Albedo of the diffuse layer.
    diffuse: Vec3,
    /// Shading normal (`normal`) and geometric normal (`geometric`), both facing the viewer.
    normal: Vec3,
    geometric: Vec3,
    layers: BsdfLayers<'a>,
}

/// The parts of a BSDF besides the diffuse layer.
enum BsdfLayers<'a> {
    Diffuse,
    /// Layers above the diffuse one.
    Specular(SpecularLayers<'a>),
    /// The boundary of a solid body; there is no diffuse layer.
    Boundary(BoundaryLayer),
}

/// The boundary of a solid body.
struct BoundaryLayer {
    dielectric: Dielectric,
    /// The two tangents of the shading frame.
    tangents: [Vec3; 2],
    /// The media on the far side.
    beyond: Media,
}

/// A point of a solid body's surface, as a path meets it.
#[derive(Clone, Copy)]
pub struct Interface {
    pub boundary: Boundary,
    /// Share of the refracted light that passes the surface, per channel.
    pub tint: Vec3,
    pub roughness: f32,
}

/// The top layer (GGX or mirror), the clear coat, and the light that passes through the material in a straight line.
struct SpecularLayers<'a> {
    bsdf_params: BsdfParams,
    /// The two tangents of the shading frame; its third axis is the shading normal.
    tangents: [Vec3; 2],
    wo: Vec3,
    /// Share of the light that passes through the material in a straight line towards the viewer.
    through: Vec3,
    /// Selection probabilities of the diffuse layer, of the top layer and of the clear coat. Transmission is selected
    /// with the remaining probability.
    shares: [f32; 3],
    /// The GGX lobe and its directional albedo; `None` if the top layer is a mirror or absent.
    lobe: Option<(ggx::Lobe, TopAlbedo<'a>)>,
    /// (1 - E(ωo)) / (1 - Ē): the share of light that the top layer lets through to the viewer, divided by the
    /// cosine-weighted mean of this share over all directions (see the module's documentation). With a clear coat,
    /// 1 - E includes its transmittance.
    relative_transmittance: f32,
    coat: Option<CoatLayer<'a>>,
}

/// The BSDF values of the diffuse and of the glossy lobe for one pair of directions. Each is multiplied by cos θi, the
/// cosine of the angle between the direction of the light and the shading normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobes {
    pub diffuse: Vec3,
    pub glossy: Vec3,
}

impl Lobes {
    pub const NONE: Self = Self { diffuse: Vec3::ZERO, glossy: Vec3::ZERO };

    #[inline]
    pub fn sum(&self) -> Vec3 {
        self.diffuse + self.glossy
    }
}

/// A direction sampled from a BSDF.
pub struct BsdfSample {
    pub direction: Vec3,
    /// BSDF × cosine / pdf.
    pub weight: Vec3,
    /// Values of both lobes for the sampled direction; [`Lobes::NONE`] if `kind` is specular.
    pub lobes: Lobes,
    pub kind: ScatterKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScatterKind {
    /// Scattering by the diffuse or the glossy lobe; the value is the pdf of the direction per solid angle.
    NonSpecular(f32),
    Mirror,
    /// Straight transmission through a thin pane.
    Pane,
    /// Refraction by the boundary of a solid body, which is rough or not. No light sample finds refracted light.
    Refraction {
        is_rough: bool,
    },
}

impl<'a> Bsdf<'a> {
    /// Builds the BSDF for a viewer in direction `wo`; both normals are flipped to face the viewer. Reflection is
    /// two-sided for all materials, because walls of rooms are often modelled with outward-facing normals. `layered`
    /// must be true if the material may have layers besides the diffuse one. `table` may be `None` if no material of
    /// the scene has a top layer.
    #[inline]
    pub fn new(
        bsdf_params: &BsdfParams,
        layered: bool,
        [shading, geometric]: [Vec3; 2],
        wo: Vec3,
        table: Option<&'a AlbedoTable>,
    ) -> Self {
        let side = 1f32.copysign(geometric.dot(wo));
        let geometric = geometric * side;
        let normal = face_viewer(shading * side, wo);
        let diffuse = bsdf_params.diffuse;
        // Return early for diffuse surfaces, so that the unused layers are not copied.
        if !layered {
            return Self { diffuse, normal, geometric, layers: BsdfLayers::Diffuse };
        }
        let layers = SpecularLayers::new(bsdf_params, normal, geometric.dot(wo), wo, table);
        Self { diffuse, normal, geometric, layers: BsdfLayers::Specular(layers) }
    }

    /// Builds the BSDF of a solid body's surface for a viewer in direction `wo`.
    pub fn boundary(interface: &Interface, [shading, geometric]: [Vec3; 2], wo: Vec3) -> Self {
        let side = 1f32.copysign(geometric.dot(wo));
        let normal = face_viewer(shading * side, wo);
        let (t, b) = normal.any_orthonormal_pair();
        let alpha = (interface.roughness >= MIRROR_ROUGHNESS).then_some(interface.roughness * interface.roughness);
        let wo = to_local(&[t, b, normal], wo);
        let dielectric = Dielectric::new(wo, interface.boundary.eta, interface.tint, alpha);
        let layers =
            BsdfLayers::Boundary(BoundaryLayer { dielectric, tangents: [t, b], beyond: interface.boundary.beyond });
        Self { diffuse: Vec3::ZERO, normal, geometric: geometric * side, layers }
    }

    /// Returns the diffuse BSDF of a light meter. Its albedo is π, so the radiance that it reflects equals the
    /// irradiance that it receives.
    pub fn receiver(normal: Vec3) -> Self {
        Self { diffuse: Vec3::splat(std::f32::consts::PI), normal, geometric: normal, layers: BsdfLayers::Diffuse }
    }

    /// The shading normal, facing the viewer.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    pub fn geometric_normal(&self) -> Vec3 {
        self.geometric
    }

    /// Returns the reflectance plus the transmittance at normal incidence.
    pub fn colour(&self) -> Vec3 {
        match &self.layers {
            BsdfLayers::Diffuse => self.diffuse,
            BsdfLayers::Specular(l) => l.bsdf_params.colour(),
            BsdfLayers::Boundary(l) => self.diffuse + l.dielectric.colour(),
        }
    }

    /// Returns the media behind the boundary of a solid body; `None` for all other surfaces.
    #[inline]
    pub fn beyond(&self) -> Option<Media> {
        match &self.layers {
            BsdfLayers::Boundary(l) => Some(l.beyond),
            _ => None,
        }
    }

    /// Whether neighbouring pixels may share a path vertex with this BSDF. True for a BSDF that reflects light,
    /// transmits none, and has no top layer smoother than `SHAREABLE_ROUGHNESS`. The result does not depend on the
    /// view direction.
    #[inline]
    pub fn is_shareable(&self) -> bool {
        match &self.layers {
            BsdfLayers::Diffuse => self.diffuse != Vec3::ZERO,
            BsdfLayers::Boundary(_) => false,
            BsdfLayers::Specular(SpecularLayers { bsdf_params: s, .. }) => {
                let is_rough = s.f90 == 0.0 || s.roughness >= SHAREABLE_ROUGHNESS;
                let has_coat = s.coat.share > 0.0;
                let is_coat_rough = !has_coat || s.coat.roughness >= SHAREABLE_ROUGHNESS;
                let reflects = has_coat || s.diffuse + s.f0 != Vec3::ZERO;
                is_rough && is_coat_rough && s.transmission == Vec3::ZERO && reflects
            }
        }
    }

    /// Whether the BSDF has only a diffuse layer.
    #[inline]
    pub fn is_diffuse(&self) -> bool {
        matches!(self.layers, BsdfLayers::Diffuse)
    }

    /// Whether the BSDF is the same for all viewers on the same side of the surface.
    #[inline]
    pub fn is_view_independent(&self) -> bool {
        self.is_diffuse() && self.normal == self.geometric
    }

    /// Whether the BSDF has a non-specular lobe.
    #[inline]
    pub fn has_non_specular(&self) -> bool {
        match &self.layers {
            BsdfLayers::Diffuse => self.diffuse != Vec3::ZERO,
            BsdfLayers::Boundary(layer) => layer.dielectric.is_rough(),
            BsdfLayers::Specular(layers) => {
                let [diffuse, top, coat] = layers.shares;
                let is_coat_rough = || layers.coat.as_ref().is_some_and(|coat| !coat.is_mirror());
                diffuse > 0.0 || (top > 0.0 && layers.lobe.is_some()) || (coat > 0.0 && is_coat_rough())
            }
        }
    }

    /// Returns the values of the non-specular lobes for light from `direction`, times the cosine, and the solid-angle
    /// pdf with which [`Bsdf::sample`] draws `direction`.
    #[inline]
    pub fn eval(&self, direction: Vec3) -> (Lobes, f32) {
        let cosine = direction.dot(self.normal);
        if cosine <= 0.0 || direction.dot(self.geometric) <= 0.0 {
            return (Lobes::NONE, 0.0);
        }
        let projected = cosine * FRAC_1_PI;
        match &self.layers {
            BsdfLayers::Diffuse => (Lobes { diffuse: self.diffuse * projected, glossy: Vec3::ZERO }, projected),
            BsdfLayers::Specular(layers) => layers.eval(direction, cosine),
            BsdfLayers::Boundary(layer) => layer.eval(direction, cosine),
        }
    }

    /// Samples a direction from `u`, a point of the unit square. Returns `None` for a sample that carries no light,
    /// because the BSDF is black or the direction lies below the surface.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Option<BsdfSample> {
        match &self.layers {
            BsdfLayers::Diffuse => {}
            BsdfLayers::Specular(layers) => return layers.sample(self, u),
            BsdfLayers::Boundary(layer) => return layer.sample(self, u),
        }
        let local = cosine_hemisphere(u);
        let (t, b) = self.normal.any_orthonormal_pair();
        let direction = from_local(&[t, b, self.normal], local);
        if !(local.z > 0.0 && direction.dot(self.geometric) > 0.0) || self.diffuse == Vec3::ZERO {
            return None;
        }
        let pdf = local.z * FRAC_1_PI;
        let lobes = Lobes { diffuse: self.diffuse * pdf, glossy: Vec3::ZERO };
        Some(BsdfSample { direction, weight: self.diffuse, lobes, kind: ScatterKind::NonSpecular(pdf) })
    }

    /// Returns the sample of a direction that the non-specular lobes have drawn; `None` if it carries no light.
    fn non_specular(&self, direction: Vec3) -> Option<BsdfSample> {
        let (lobes, pdf) = self.eval(direction);
        if !(pdf > 0.0 && pdf.is_finite()) {
            return None;
        }
        Some(BsdfSample { direction, weight: lobes.sum() / pdf, lobes, kind: ScatterKind::NonSpecular(pdf) })
    }
}

impl BoundaryLayer {
    /// Returns the value and the pdf of reflected light.
    fn eval(&self, direction: Vec3, cosine: f32) -> (Lobes, f32) {
        let [t, b] = self.tangents;
        let (value, pdf) = self.dielectric.eval(Vec3::new(direction.dot(t), direction.dot(b), cosine));
        (Lobes { diffuse: Vec3::ZERO, glossy: Vec3::splat(value) }, pdf)
    }

    fn sample(&self, bsdf: &Bsdf, u: Vec2) -> Option<BsdfSample> {
        let frame = [self.tangents[0], self.tangents[1], bsdf.normal];
        let lobes = Lobes::NONE;
        let (scattered, side) = match self.dielectric.sample(u)? {
            DielectricSample::Reflected { direction } => return bsdf.non_specular(from_local(&frame, direction)),
            DielectricSample::Mirrored { direction, weight } => {
                let (direction, weight) = (from_local(&frame, direction), Vec3::splat(weight));
                (BsdfSample { direction, weight, lobes, kind: ScatterKind::Mirror }, 1.0)
            }
            DielectricSample::Refracted { direction, weight } => {
                let kind = ScatterKind::Refraction { is_rough: self.dielectric.is_rough() };
                (BsdfSample { direction: from_local(&frame, direction), weight, lobes, kind }, -1.0)
            }
        };
        (scattered.direction.dot(bsdf.geometric) * side > 0.0).then_some(scattered)
    }
}

impl<'a> SpecularLayers<'a> {
    fn new(bsdf_params: &BsdfParams, normal: Vec3, upright: f32, wo: Vec3, table: Option<&'a AlbedoTable>) -> Self {
        let s = bsdf_params;
        let (t, b) = normal.any_orthonormal_pair();
        let wo = to_local(&[t, b, normal], wo);
        // Compute two albedos for the direction of the viewer. `top` is the largest channel of the top layer's albedo.
        // `dielectric` is the albedo that the top layer would have without its metallic component.
        let has_top = s.f90 > 0.0;
        let lobe = match table {
            Some(table) if has_top && s.roughness >= MIRROR_ROUGHNESS => {
                Some((ggx::Lobe::new(wo, s.roughness * s.roughness), TopAlbedo::new(table, s)))
            }
            _ => None,
        };
        let (mut top, mut dielectric, mut mean_dielectric) = (0.0, 0.0, 0.0);
        if let Some((_, albedo)) = &lobe {
            let share = albedo.row.directional(wo.z);
            (top, dielectric) = (s.f0.max_element() * share.x + s.f90 * share.y, albedo.of(share));
            mean_dielectric = albedo.of(albedo.row.average());
        } else if has_top {
            top = ggx::schlick(s.f0, s.f90, wo.z).max_element();
            dielectric = ggx::schlick(Vec3::splat(s.dielectric_f0), s.dielectric_f90, wo.z).x;
            // The mean of Schlick's factor (1 - cos θ)⁵, weighted by the cosine over the hemisphere, is 1/21.
            mean_dielectric = s.dielectric_f0 + (s.dielectric_f90 - s.dielectric_f0) / 21.0;
        }
        let relative_transmittance = (1.0 - dielectric).max(0.0) / (1.0 - mean_dielectric).max(1e-3);
        // Set the probability of each layer in proportion to its albedo.
        let diffuse = s.diffuse.max_element() * (1.0 - dielectric);
        let through = s.through(upright);
        let mut layers = Self {
            bsdf_params: *s,
            tangents: [t, b],
            wo,
            through,
            shares: [0.0; 3],
            lobe,
            relative_transmittance,
            coat: None,
        };
        let mut albedos = [diffuse, top, 0.0];
        if let Some(coat) = CoatLayer::new(&s.coat, wo, table) {
            albedos = layers.cover(coat, albedos);
        }
        let sum = albedos[0] + albedos[1] + through.max_element() + albedos[2];
        if sum > 0.0 {
            layers.shares = albedos.map(|albedo| albedo / sum);
        }
        layers
    }

    /// Adds a clear coat. Takes the albedos of the diffuse and of the top layer without the coat; returns these below
    /// the coat, and that of the coat.
    #[inline(never)]
    fn cover(&mut self, coat: CoatLayer<'a>, [diffuse, top, _]: [f32; 3]) -> [f32; 3] {
        let (passed, albedo) = (1.0 - coat.albedo, coat.albedo);
        let transmittance = |cosine: f32| (1.0 - self.dielectric_albedo(cosine)).max(0.0) * coat.transmittance(cosine);
        self.relative_transmittance = transmittance(self.wo.z) / cosine_mean(transmittance).max(1e-3);
        self.coat = Some(coat);
        [diffuse * passed, top * passed, albedo]
    }

    fn eval(&self, direction: Vec3, cosine: f32) -> (Lobes, f32) {
        let (mut lobes, mut pdf) = (Lobes::NONE, 0.0);
        if self.wo.z <= 0.0 {
            return (lobes, pdf);
        }
        let s = &self.bsdf_params;
        let [diffuse, top, coat] = self.shares;
        if diffuse > 0.0 {
            let mut transmittance = self.relative_transmittance * (1.0 - self.dielectric_albedo(cosine)).max(0.0);
            if let Some(coat) = &self.coat {
                transmittance *= coat.transmittance(cosine);
            }
            lobes.diffuse = s.diffuse * (transmittance * cosine * FRAC_1_PI);
            pdf += diffuse * cosine * FRAC_1_PI;
        }
        if let Some((lobe, _)) = &self.lobe
            && top > 0.0
        {
            let [t, b] = self.tangents;
            let wi = Vec3::new(direction.dot(t), direction.dot(b), cosine);
            let h = (self.wo + wi).normalize_or(Vec3::Z);
            let (value, chosen) = lobe.eval(wi, h);
            lobes.glossy = ggx::schlick(s.f0, s.f90, self.wo.dot(h)) * value;
            pdf += top * chosen;
        }
        if let Some(layer) = &self.coat {
            lobes.glossy *= layer.attenuation(cosine);
            let [t, b] = self.tangents;
            let wi = Vec3::new(direction.dot(t), direction.dot(b), cosine);
            if let Some((value, chosen)) = layer.eval(wi, (self.wo + wi).normalize_or(Vec3::Z)) {
                lobes.glossy += Vec3::splat(value);
                pdf += coat * chosen;
            }
        }
        (lobes, pdf)
    }

    /// Returns the albedo of the dielectric top layer for a direction; `cosine` is the cosine of its angle to the
    /// normal.
    fn dielectric_albedo(&self, cosine: f32) -> f32 {
        let s = &self.bsdf_params;
        match &self.lobe {
            Some((_, albedo)) => albedo.of(albedo.row.directional(cosine)),
            None if s.f90 > 0.0 => ggx::schlick(Vec3::splat(s.dielectric_f0), s.dielectric_f90, cosine).x,
            None => 0.0,
        }
    }

    fn sample(&self, bsdf: &Bsdf, u: Vec2) -> Option<BsdfSample> {
        let [diffuse, top, coat] = self.shares;
        let frame = [self.tangents[0], self.tangents[1], bsdf.normal];
        // Rescale the interval of `u.x` that selected the layer to `[0, 1)`, and reuse the result to sample the
        // direction.
        let part = |from: f32, share: f32| Vec2::new(((u.x - from) / share).min(1.0 - f32::EPSILON), u.y);
        let local = if u.x < diffuse {
            cosine_hemisphere(part(0.0, diffuse))
        } else if u.x < diffuse + top {
            let Some((lobe, _)) = &self.lobe else {
                let below = self.coat.as_ref().map_or(1.0, |coat| 1.0 - coat.albedo);
                let reflectance = ggx::schlick(self.bsdf_params.f0, self.bsdf_params.f90, self.wo.z);
                return self.reflect(&frame, bsdf.geometric, reflectance * below / top);
            };
            let h = lobe.sample_normal(part(diffuse, top));
            h * (2.0 * self.wo.dot(h)) - self.wo
        } else if let Some(layer) = &self.coat
            && u.x < diffuse + top + coat
        {
            let Some(h) = layer.sample_normal(part(diffuse + top, coat)) else {
                return self.reflect(&frame, bsdf.geometric, Vec3::splat(layer.albedo / coat));
            };
            h * (2.0 * self.wo.dot(h)) - self.wo
        } else {
            return self.pass_through(&frame);
        };
        bsdf.non_specular(from_local(&frame, local))
    }

    fn reflect(&self, frame: &[Vec3; 3], geometric: Vec3, weight: Vec3) -> Option<BsdfSample> {
        let direction = from_local(frame, Vec3::new(-self.wo.x, -self.wo.y, self.wo.z));
        let scattered = BsdfSample { direction, weight, lobes: Lobes::NONE, kind: ScatterKind::Mirror };
        (direction.dot(geometric) > 0.0).then_some(scattered)
    }

    fn pass_through(&self, frame: &[Vec3; 3]) -> Option<BsdfSample> {
        // The shares of the layers may add up to just below 1 although nothing passes through.
        if self.through == Vec3::ZERO {
            return None;
        }
        let share = 1.0 - self.shares[0] - self.shares[1] - self.shares[2];
        let direction = -from_local(frame, self.wo);
        let scattered =
            BsdfSample { direction, weight: self.through / share, lobes: Lobes::NONE, kind: ScatterKind::Pane };
        (share > 0.0 && self.through != Vec3::ZERO).then_some(scattered)
    }
}

/// Returns the cosine-weighted mean of a function of the cosine over the hemisphere: 2 ∫₀¹ f(c) c dc, by Simpson's
/// rule.
fn cosine_mean(f: impl Fn(f32) -> f32) -> f32 {
    // Number of intervals. For the transmittance of a smooth coat over a smooth dielectric, the error is below 1e-5.
    // [rounding]
    const STEPS: usize = 16;
    let value = |i: usize| {
        let cosine = i as f32 / (2 * STEPS) as f32;
        f(cosine) * cosine
    };
    let sum: f32 = (0..STEPS).map(|i| value(2 * i) + 4.0 * value(2 * i + 1) + value(2 * i + 2)).sum();
    sum / (3 * STEPS) as f32
}

/// The directional albedo of a rough dielectric top layer, looked up in the albedo table.
struct TopAlbedo<'a> {
    row: ggx::AlbedoRow<'a>,
    /// Factors for the two values of a table entry: `dielectric_f0` for the scale, `dielectric_f90` for the bias.
    weights: Vec2,
}

impl<'a> TopAlbedo<'a> {
    fn new(table: &'a AlbedoTable, bsdf_params: &BsdfParams) -> Self {
        let weights = Vec2::new(bsdf_params.dielectric_f0, bsdf_params.dielectric_f90);
        Self { row: table.row(bsdf_params.roughness), weights }
    }

    fn of(&self, scale_and_bias: Vec2) -> f32 {
        scale_and_bias.dot(self.weights)
    }
}

/// If the shading normal faces away from the viewer, tilts it until it is almost perpendicular to the view direction,
/// so that the viewer sees the surface at a grazing angle.
fn face_viewer(normal: Vec3, wo: Vec3) -> Vec3 {
    // Smallest cosine between the tilted normal and the direction of the viewer. Any value from 1e-4 to 1e-2 is a
    // grazing angle, and far above the rounding of a cosine in f32 (3e-7). [rounding]
    const MIN_COSINE: f32 = 1e-3;
    let cosine = normal.dot(wo);
    if cosine >= MIN_COSINE { normal } else { (normal + wo * (MIN_COSINE - cosine)).normalize_or(wo) }
}

/// Samples a cosine-weighted direction: projects a point of the unit disc to the hemisphere (Malley's method).
#[inline]
fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let (p, r2) = ggx::disc(u);
    Vec3::new(p.x, p.y, (1.0 - r2).max(0.0).sqrt())
}

#[inline]
fn to_local(frame: &[Vec3; 3], w: Vec3) -> Vec3 {
    Vec3::new(w.dot(frame[0]), w.dot(frame[1]), w.dot(frame[2]))
}

#[inline]
fn from_local(frame: &[Vec3; 3], w: Vec3) -> Vec3 {
    frame[0] * w.x + frame[1] * w.y + frame[2] * w.z
}

#[cfg(test)]
mod tests;
