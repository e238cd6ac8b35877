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
use std::f32::consts::{FRAC_1_PI, TAU};

/// Below this perceptual roughness a surface is a perfect mirror.
pub const MIRROR_ROUGHNESS: f32 = 1e-3;

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
    substance: Substance,
    /// Tangents and shading normal, which is on the side of the viewer.
    frame: [Vec3; 3],
    /// Geometric normal on the side of the viewer.
    geometric: Vec3,
    wo: Vec3,
    /// Cosine of the viewer with the geometric normal.
    upright: f32,
    /// Probabilities of choosing the diffuse layer, the top layer and straight through.
    shares: [f32; 3],
    table: Option<&'a AlbedoTable>,
    /// What the top layer leaves for the diffuse one on the way to the viewer, divided by the mean it leaves.
    left_over: f32,
}

/// Where a path goes on.
pub struct Scattered {
    pub direction: Vec3,
    /// Throughput: the BSDF times the cosine over the density.
    pub weight: Vec3,
    pub kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// With this density per steradian.
    Spread(f32),
    Mirrored,
    Through,
}

impl<'a> Bsdf<'a> {
    /// `wo` points to the viewer; both normals are flipped to its side. Reflection is two-sided whatever the material
    /// says: rooms are often modelled with their walls facing outwards.
    pub fn new(substance: Substance, shading: Vec3, geometric: Vec3, wo: Vec3, table: Option<&'a AlbedoTable>) -> Self {
        let side = if geometric.dot(wo) < 0.0 { -1.0 } else { 1.0 };
        let geometric = geometric * side;
        let normal = face_viewer(shading * side, wo);
        let (t, b) = normal.any_orthonormal_pair();
        let frame = [t, b, normal];
        let local = to_local(&frame, wo);
        let upright = geometric.dot(wo);
        let shares = [1.0, 0.0, 0.0];
        let mut this = Self { substance, frame, geometric, wo: local, upright, shares, table, left_over: 1.0 };
        if this.has_top() || substance.transmission != Vec3::ZERO {
            this.weigh_layers();
        }
        this
    }

    /// What receives light from all of a hemisphere alike: its response to radiance is irradiance.
    pub fn receiver(normal: Vec3) -> Self {
        let substance = Substance {
            diffuse: Vec3::splat(std::f32::consts::PI),
            f0: Vec3::ZERO,
            f90: 0.0,
            roughness: 1.0,
            transmission: Vec3::ZERO,
            dielectric_f0: 0.0,
        };
        Self::new(substance, normal, normal, normal, None)
    }

    fn has_top(&self) -> bool {
        self.substance.f90 > 0.0
    }

    fn is_mirror(&self) -> bool {
        self.substance.roughness < MIRROR_ROUGHNESS
    }

    fn alpha(&self) -> f32 {
        self.substance.roughness * self.substance.roughness
    }

    fn weigh_layers(&mut self) {
        let s = &self.substance;
        let top = if !self.has_top() {
            0.0
        } else if let (Some(table), false) = (self.table, self.is_mirror()) {
            let albedo = table.directional(self.wo.z, s.roughness);
            s.f0.max_element() * albedo.x + s.f90 * albedo.y
        } else {
            ggx::schlick(s.f0, s.f90, self.wo.z).max_element()
        };
        if s.diffuse != Vec3::ZERO && self.has_top() {
            self.left_over = self.passes_top(self.wo.z) / self.mean_passing_top().max(1e-3);
        }
        let diffuse = s.diffuse.max_element() * (1.0 - self.top_albedo(self.wo.z));
        let through = s.through(self.upright).max_element();
        let sum = diffuse + top + through;
        self.shares = if sum > 0.0 { [diffuse / sum, top / sum, through / sum] } else { [1.0, 0.0, 0.0] };
    }

    /// Share of light the dielectric top layer sends back.
    fn top_albedo(&self, cosine: f32) -> f32 {
        let s = &self.substance;
        match self.table {
            _ if !self.has_top() => 0.0,
            Some(table) if !self.is_mirror() => {
                table.directional(cosine, s.roughness).dot(Vec2::new(s.dielectric_f0, s.f90))
            }
            _ => ggx::schlick(Vec3::splat(s.dielectric_f0), s.f90, cosine).x,
        }
    }

    fn passes_top(&self, cosine: f32) -> f32 {
        (1.0 - self.top_albedo(cosine)).max(0.0)
    }

    fn mean_passing_top(&self) -> f32 {
        let s = &self.substance;
        match self.table {
            Some(table) if !self.is_mirror() => 1.0 - table.average(s.roughness).dot(Vec2::new(s.dielectric_f0, s.f90)),
            // The cosine-weighted mean of Schlick's fifth power is 1/21.
            _ => 1.0 - (s.dielectric_f0 + (s.f90 - s.dielectric_f0) / 21.0),
        }
    }

    /// Whether any light but that of single directions is scattered.
    pub fn spreads(&self) -> bool {
        self.shares[0] > 0.0 || (self.shares[1] > 0.0 && !self.is_mirror())
    }

    /// The spread part of the BSDF times the cosine, and the density with which [`Bsdf::sample`] chooses `direction`.
    pub fn eval(&self, direction: Vec3) -> (Vec3, f32) {
        let wi = to_local(&self.frame, direction);
        if wi.z <= 0.0 || self.wo.z <= 0.0 || direction.dot(self.geometric) <= 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let s = &self.substance;
        let mut value = Vec3::ZERO;
        let mut density = 0.0;
        if self.shares[0] > 0.0 {
            let left = if self.has_top() { self.left_over * self.passes_top(wi.z) } else { 1.0 };
            value += s.diffuse * (left * wi.z * FRAC_1_PI);
            density += self.shares[0] * wi.z * FRAC_1_PI;
        }
        if self.shares[1] > 0.0 && !self.is_mirror() {
            let h = (self.wo + wi).normalize_or(Vec3::Z);
            value += ggx::schlick(s.f0, s.f90, self.wo.dot(h)) * ggx::lobe(self.wo, wi, h, self.alpha());
            density += self.shares[1] * ggx::density(self.wo, h, self.alpha());
        }
        (value, density)
    }

    /// Chooses where a path goes on: `choice` the layer, `u` the direction. None where the light is absorbed.
    pub fn sample(&self, choice: f32, u: Vec2) -> Option<Scattered> {
        let [diffuse, top, _] = self.shares;
        let local = if choice < diffuse {
            cosine_hemisphere(u)
        } else if choice < diffuse + top {
            if self.is_mirror() {
                return self.reflect(top);
            }
            let h = ggx::sample_normal(self.wo, self.alpha(), u);
            h * (2.0 * self.wo.dot(h)) - self.wo
        } else {
            return self.pass_through();
        };
        let direction = from_local(&self.frame, local);
        let (value, density) = self.eval(direction);
        if !(density > 0.0 && density.is_finite()) {
            return None;
        }
        Some(Scattered { direction, weight: value / density, kind: Kind::Spread(density) })
    }

    fn reflect(&self, share: f32) -> Option<Scattered> {
        let direction = from_local(&self.frame, Vec3::new(-self.wo.x, -self.wo.y, self.wo.z));
        let weight = ggx::schlick(self.substance.f0, self.substance.f90, self.wo.z) / share;
        (direction.dot(self.geometric) > 0.0).then_some(Scattered { direction, weight, kind: Kind::Mirrored })
    }

    fn pass_through(&self) -> Option<Scattered> {
        let share = self.shares[2];
        let direction = -from_local(&self.frame, self.wo);
        let weight = self.substance.through(self.upright) / share;
        (share > 0.0).then_some(Scattered { direction, weight, kind: Kind::Through })
    }
}

/// A shading normal that the viewer would see from behind is tilted until it is seen from the side.
fn face_viewer(normal: Vec3, wo: Vec3) -> Vec3 {
    const LEAST: f32 = 1e-3;
    let cosine = normal.dot(wo);
    if cosine >= LEAST { normal } else { (normal + wo * (LEAST - cosine)).normalize_or(wo) }
}

fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let (radius, angle) = (u.x.sqrt(), TAU * u.y);
    Vec3::new(radius * angle.cos(), radius * angle.sin(), (1.0 - u.x).max(0.0).sqrt())
}

fn to_local(frame: &[Vec3; 3], w: Vec3) -> Vec3 {
    Vec3::new(w.dot(frame[0]), w.dot(frame[1]), w.dot(frame[2]))
}

fn from_local(frame: &[Vec3; 3], w: Vec3) -> Vec3 {
    frame[0] * w.x + frame[1] * w.y + frame[2] * w.z
}
