//! How a point of a surface scatters light: glTF 2.0's metallic-roughness model (appendix B).
//!
//! Lambert below, GGX on top, or a mirror below a roughness of 1/1000; the share `transmission` of what the top lets
//! through goes on straight, as through a thin pane (`KHR_materials_transmission` without volume). Where appendix B mixes
//! the layers by the Fresnel factor of the half vector, which sends back up to twice what arrives at grazing angles, the
//! diffuse layer here takes what the top layer leaves over both ways. An index of refraction of 1 has no top layer.
//!
//! Not modelled: frosted transmission, refraction in solids, anisotropy, multiple scattering between facets.

use super::ggx::{self, AlbedoTable};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Below this perceptual roughness a surface is a perfect mirror.
pub const MIRROR_ROUGHNESS: f32 = 1e-3;

/// From this perceptual roughness on, light found for one viewer serves its neighbours: they look from nearly the same place.
const SHAREABLE_ROUGHNESS: f32 = 0.1;

/// What a material is at one point.
#[derive(Clone, Copy, Debug)]
pub struct Substance {
    /// Albedo of the diffuse layer, the share of the dielectric part included.
    pub diffuse: Vec3,
    /// Reflectance of the top layer at normal incidence and at grazing.
    pub f0: Vec3,
    pub f90: f32,
    pub roughness: f32,
    /// Colour of what passes straight through, before the top layer's loss; 0 where nothing does.
    pub transmission: Vec3,
    /// The dielectric part's own reflectance at normal incidence: it decides what reaches the diffuse layer.
    pub dielectric_f0: f32,
}

impl Substance {
    /// What passes straight through at an angle.
    pub fn through(&self, cosine: f32) -> Vec3 {
        if self.transmission == Vec3::ZERO {
            return Vec3::ZERO;
        }
        let lost = ggx::schlick(Vec3::splat(self.dielectric_f0), self.f90, cosine.abs()).x;
        self.transmission * (1.0 - lost)
    }
}

/// A substance with its frame, seen from one direction.
pub struct Bsdf<'a> {
    /// Albedo of the diffuse layer.
    diffuse: Vec3,
    /// Shading and geometric normal, both on the side of the viewer.
    normal: Vec3,
    geometric: Vec3,
    /// Everything else; none where the diffuse layer is all there is.
    layers: Option<Layers<'a>>,
}

/// What lies on the diffuse layer or lets light past it.
struct Layers<'a> {
    substance: Substance,
    /// Completed by the shading normal.
    tangents: [Vec3; 2],
    wo: Vec3,
    /// What passes straight through in the direction of the viewer.
    through: Vec3,
    /// Probabilities of choosing the diffuse layer and the top layer; the rest goes straight through.
    shares: [f32; 2],
    /// How much the top layer reflects, if it spreads light.
    lobe: Option<(ggx::Lobe, TopAlbedo<'a>)>,
    /// What the top layer leaves for the diffuse one on the way to the viewer, divided by the mean it leaves.
    left_over: f32,
}

/// What the diffuse and the top layer send back of light from one direction, each with the cosine.
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

/// Where a path goes on.
pub struct BsdfSample {
    pub direction: Vec3,
    /// Throughput: the BSDF times the cosine over the density.
    pub weight: Vec3,
    /// What the BSDF is made of where it spreads.
    pub lobes: Lobes,
    pub kind: ScatterKind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScatterKind {
    /// With this density per steradian.
    NonSpecular(f32),
    Mirror,
    Pane,
}

impl<'a> Bsdf<'a> {
    /// `wo` points to the viewer; both normals are flipped to its side. Reflection is two-sided whatever the material
    /// says: rooms are often modelled with their walls facing outwards. `layered` tells whether there may be more than a
    /// diffuse layer, `table` may be missing where nothing has a top layer.
    #[inline]
    pub fn new(
        substance: &Substance,
        layered: bool,
        [shading, geometric]: [Vec3; 2],
        wo: Vec3,
        table: Option<&'a AlbedoTable>,
    ) -> Self {
        let side = 1f32.copysign(geometric.dot(wo));
        let geometric = geometric * side;
        let normal = face_viewer(shading * side, wo);
        let diffuse = substance.diffuse;
        // Returned from two places, so that matt surfaces do not move the room for layers about.
        if !layered {
            return Self { diffuse, normal, geometric, layers: None };
        }
        let layers = Layers::new(substance, normal, geometric.dot(wo), wo, table);
        Self { diffuse, normal, geometric, layers: Some(layers) }
    }

    /// What receives light from all of a hemisphere alike: its response to radiance is irradiance.
    pub fn receiver(normal: Vec3) -> Self {
        Self { diffuse: Vec3::splat(std::f32::consts::PI), normal, geometric: normal, layers: None }
    }

    /// Shading normal and geometric normal on the side of the viewer.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    pub fn geometric_normal(&self) -> Vec3 {
        self.geometric
    }

    /// Colour at normal incidence: what is reflected by either layer or let through.
    pub fn colour(&self) -> Vec3 {
        let above = self.layers.as_ref().map(|l| l.substance.f0 + l.substance.transmission);
        self.diffuse + above.unwrap_or(Vec3::ZERO)
    }

    /// Whether it spreads all that it sends back, so that light found for one direction serves for those beside it. It
    /// depends on the place alone, not on the viewer.
    #[inline]
    pub fn is_shareable(&self) -> bool {
        match &self.layers {
            None => self.diffuse != Vec3::ZERO,
            Some(Layers { substance: s, .. }) => {
                let is_rough = s.f90 == 0.0 || s.roughness >= SHAREABLE_ROUGHNESS;
                is_rough && s.transmission == Vec3::ZERO && s.diffuse + s.f0 != Vec3::ZERO
            }
        }
    }

    /// Whether nothing lies on the diffuse layer.
    #[inline]
    pub fn is_diffuse(&self) -> bool {
        self.layers.is_none()
    }

    /// Whether it is the same for all viewers on its side.
    #[inline]
    pub fn is_view_independent(&self) -> bool {
        self.is_diffuse() && self.normal == self.geometric
    }

    /// Whether any light but that of single directions is scattered.
    #[inline]
    pub fn has_non_specular(&self) -> bool {
        match &self.layers {
            None => self.diffuse != Vec3::ZERO,
            Some(layers) => layers.shares[0] > 0.0 || (layers.shares[1] > 0.0 && layers.lobe.is_some()),
        }
    }

    /// The spread part of the BSDF times the cosine, and the density with which [`Bsdf::sample`] chooses `direction`.
    #[inline]
    pub fn eval(&self, direction: Vec3) -> (Lobes, f32) {
        let cosine = direction.dot(self.normal);
        if cosine <= 0.0 || direction.dot(self.geometric) <= 0.0 {
            return (Lobes::NONE, 0.0);
        }
        let projected = cosine * FRAC_1_PI;
        match &self.layers {
            None => (Lobes { diffuse: self.diffuse * projected, glossy: Vec3::ZERO }, projected),
            Some(layers) => layers.eval(direction, cosine),
        }
    }

    /// Chooses where a path goes on, by a point of the unit square. None where the light is absorbed.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Option<BsdfSample> {
        if let Some(layers) = &self.layers {
            return layers.sample(self, u);
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
}

impl<'a> Layers<'a> {
    fn new(substance: &Substance, normal: Vec3, upright: f32, wo: Vec3, table: Option<&'a AlbedoTable>) -> Self {
        let s = substance;
        let (t, b) = normal.any_orthonormal_pair();
        let wo = to_local(&[t, b, normal], wo);
        // What the top layer sends back of light to the viewer: in all, and of the dielectric part alone.
        let has_top = s.f90 > 0.0;
        let lobe = match table {
            Some(table) if has_top && s.roughness >= MIRROR_ROUGHNESS => {
                Some((ggx::Lobe::new(wo, s.roughness * s.roughness), TopAlbedo::new(table, s)))
            }
            _ => None,
        };
        let (mut top, mut coat_albedo, mut mean_coat_albedo) = (0.0, 0.0, 0.0);
        if let Some((_, albedo)) = &lobe {
            let share = albedo.row.directional(wo.z);
            (top, coat_albedo) = (s.f0.max_element() * share.x + s.f90 * share.y, albedo.of(share));
            mean_coat_albedo = albedo.of(albedo.row.average());
        } else if has_top {
            top = ggx::schlick(s.f0, s.f90, wo.z).max_element();
            coat_albedo = ggx::schlick(Vec3::splat(s.dielectric_f0), s.f90, wo.z).x;
            // The cosine-weighted mean of Schlick's fifth power is 1/21.
            mean_coat_albedo = s.dielectric_f0 + (s.f90 - s.dielectric_f0) / 21.0;
        }
        let left_over = (1.0 - coat_albedo).max(0.0) / (1.0 - mean_coat_albedo).max(1e-3);
        // Choose among the layers by what they send back.
        let diffuse = s.diffuse.max_element() * (1.0 - coat_albedo);
        let through = s.through(upright);
        let sum = diffuse + top + through.max_element();
        let shares = if sum > 0.0 { [diffuse / sum, top / sum] } else { [0.0; 2] };
        Self { substance: *s, tangents: [t, b], wo, through, shares, lobe, left_over }
    }

    fn eval(&self, direction: Vec3, cosine: f32) -> (Lobes, f32) {
        let (mut lobes, mut pdf) = (Lobes::NONE, 0.0);
        if self.wo.z <= 0.0 {
            return (lobes, pdf);
        }
        let s = &self.substance;
        let [diffuse, top] = self.shares;
        if diffuse > 0.0 {
            let left = self.left_over * (1.0 - self.coat_albedo(cosine)).max(0.0);
            lobes.diffuse = s.diffuse * (left * cosine * FRAC_1_PI);
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
        (lobes, pdf)
    }

    /// Share of light the dielectric top layer sends back.
    fn coat_albedo(&self, cosine: f32) -> f32 {
        let s = &self.substance;
        match &self.lobe {
            Some((_, albedo)) => albedo.of(albedo.row.directional(cosine)),
            None if s.f90 > 0.0 => ggx::schlick(Vec3::splat(s.dielectric_f0), s.f90, cosine).x,
            None => 0.0,
        }
    }

    fn sample(&self, bsdf: &Bsdf, u: Vec2) -> Option<BsdfSample> {
        let [diffuse, top] = self.shares;
        let frame = [self.tangents[0], self.tangents[1], bsdf.normal];
        // A part of the square for each layer, stretched to the whole.
        let part = |from: f32, share: f32| Vec2::new(((u.x - from) / share).min(1.0 - f32::EPSILON), u.y);
        let local = if u.x < diffuse {
            cosine_hemisphere(part(0.0, diffuse))
        } else if u.x < diffuse + top {
            let Some((lobe, _)) = &self.lobe else { return self.reflect(&frame, bsdf.geometric) };
            let h = lobe.sample_normal(part(diffuse, top));
            h * (2.0 * self.wo.dot(h)) - self.wo
        } else {
            return self.pass_through(&frame);
        };
        let direction = from_local(&frame, local);
        let (lobes, pdf) = bsdf.eval(direction);
        if !(pdf > 0.0 && pdf.is_finite()) {
            return None;
        }
        Some(BsdfSample { direction, weight: lobes.sum() / pdf, lobes, kind: ScatterKind::NonSpecular(pdf) })
    }

    fn reflect(&self, frame: &[Vec3; 3], geometric: Vec3) -> Option<BsdfSample> {
        let direction = from_local(frame, Vec3::new(-self.wo.x, -self.wo.y, self.wo.z));
        let weight = ggx::schlick(self.substance.f0, self.substance.f90, self.wo.z) / self.shares[1];
        let scattered = BsdfSample { direction, weight, lobes: Lobes::NONE, kind: ScatterKind::Mirror };
        (direction.dot(geometric) > 0.0).then_some(scattered)
    }

    fn pass_through(&self, frame: &[Vec3; 3]) -> Option<BsdfSample> {
        let share = 1.0 - self.shares[0] - self.shares[1];
        let direction = -from_local(frame, self.wo);
        let scattered =
            BsdfSample { direction, weight: self.through / share, lobes: Lobes::NONE, kind: ScatterKind::Pane };
        (share > 0.0 && self.through != Vec3::ZERO).then_some(scattered)
    }
}

/// Share of light that a rough dielectric top layer sends back.
struct TopAlbedo<'a> {
    row: ggx::AlbedoRow<'a>,
    /// Weights of the table's scale and bias.
    weights: Vec2,
}

impl<'a> TopAlbedo<'a> {
    fn new(table: &'a AlbedoTable, substance: &Substance) -> Self {
        Self { row: table.row(substance.roughness), weights: Vec2::new(substance.dielectric_f0, substance.f90) }
    }

    fn of(&self, scale_and_bias: Vec2) -> f32 {
        scale_and_bias.dot(self.weights)
    }
}

/// A shading normal that the viewer would see from behind is tilted until it is seen from the side.
fn face_viewer(normal: Vec3, wo: Vec3) -> Vec3 {
    const MIN_COSINE: f32 = 1e-3;
    let cosine = normal.dot(wo);
    if cosine >= MIN_COSINE { normal } else { (normal + wo * (MIN_COSINE - cosine)).normalize_or(wo) }
}

/// By the cosine: a point of the unit disc, raised to the hemisphere (Malley).
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
