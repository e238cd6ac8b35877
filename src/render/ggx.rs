//! The GGX microfacet distribution (Walter et al. 2007) with height-correlated Smith masking (Heitz 2014), its
//! sampling by visible normals (Heitz 2018), and its directional albedo.
//!
//! Directions are given in a frame whose z axis is the normal; `alpha` is the square of the perceptual roughness.

use crate::maths;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_4, PI};

/// A surface below this perceptual roughness is a perfect mirror. [convention]
pub const MIRROR_ROUGHNESS: f32 = 1e-3;

/// Returns the Fresnel reflectance by Schlick's approximation, from the reflectance at normal (`f0`) and at grazing
/// (`f90`) incidence.
#[inline]
pub fn schlick(f0: Vec3, f90: f32, cosine: f32) -> Vec3 {
    let m = (1.0 - cosine).clamp(0.0, 1.0);
    f0 + (Vec3::splat(f90) - f0) * (m * m * m * m * m)
}

fn lambda(w: Vec3, alpha: f32) -> f32 {
    let tangent2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    ((1.0 + alpha * alpha * tangent2).sqrt() - 1.0) / 2.0
}

/// The GGX lobe for one viewing direction above the surface.
pub struct Lobe {
    wo: Vec3,
    alpha: f32,
    /// 1 + Λ(`wo`), with Smith's function Λ.
    masking: f32,
}

impl Lobe {
    pub fn new(wo: Vec3, alpha: f32) -> Self {
        Self { wo, alpha, masking: 1.0 + lambda(wo, alpha) }
    }

    /// Returns the BRDF times the cosine of `wi`, without the Fresnel factor, and the solid-angle pdf of `wi`. The pdf
    /// holds for a `wi` that is sampled by reflecting `wo` about the normal from [`Lobe::sample_normal`]. `wi` must lie
    /// above the surface; `h` is the half vector.
    pub fn eval(&self, wi: Vec3, h: Vec3) -> (f32, f32) {
        // Evaluate D(h) / (4 cos θo), the common factor of the BRDF and the pdf. D is the distribution of microfacet
        // normals, and θo is the angle between `wo` and the normal. In the pdf, `wo` · `h` cancels against the Jacobian
        // of reflection.
        let a2 = self.alpha * self.alpha;
        let d = (h.x * h.x + h.y * h.y) / a2 + h.z * h.z;
        let facets = 1.0 / (4.0 * PI * a2 * d * d * self.wo.z);
        (facets / (self.masking + lambda(wi, self.alpha)), facets / self.masking)
    }

    /// Returns the share of a visible microfacet's light in direction `w`, on either side of the surface, that other
    /// microfacets do not shadow (Smith's G1).
    pub fn visibility(&self, w: Vec3) -> f32 {
        1.0 / (1.0 + lambda(w, self.alpha))
    }

    /// Samples a microfacet normal from the distribution of normals visible from `wo`.
    pub fn sample_normal(&self, u: Vec2) -> Vec3 {
        let (wo, alpha) = (self.wo, self.alpha);
        // Stretch the frame so that the microfacets form a hemisphere, sample the hemisphere's projection along the
        // view direction, and transform back.
        let v = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
        let across = v.x * v.x + v.y * v.y;
        let t1 = if across > 0.0 { Vec3::new(-v.y, v.x, 0.0) / across.sqrt() } else { Vec3::X };
        let t2 = v.cross(t1);
        let p = disc(u).0;
        let s = 0.5 * (1.0 + v.z);
        let p2 = (1.0 - s) * (1.0 - p.x * p.x).max(0.0).sqrt() + s * p.y;
        let n = t1 * p.x + t2 * p2 + v * (1.0 - p.x * p.x - p2 * p2).max(0.0).sqrt();
        Vec3::new(alpha * n.x, alpha * n.y, n.z.max(1e-6)).normalize()
    }
}

/// Maps the unit square to the unit disc by the concentric map (Shirley and Chiu 1997), which preserves areas and
/// neighbourhoods. Returns the point and its squared distance from the centre. Taylor series suffice for the sine and
/// the cosine, because their angles are at most 45 degrees.
#[inline]
pub fn disc(u: Vec2) -> (Vec2, f32) {
    let p = u * 2.0 - 1.0;
    let wide = p.x.abs() > p.y.abs();
    let (radius, other) = if wide { (p.x, p.y) } else { (p.y, p.x) };
    let angle = if radius == 0.0 { 0.0 } else { other / radius * FRAC_PI_4 };
    let a2 = angle * angle;
    let sine = angle * (1.0 + a2 * (-1.0 / 6.0 + a2 * (1.0 / 120.0 + a2 * (-1.0 / 5040.0 + a2 * (1.0 / 362_880.0)))));
    let cosine = 1.0 + a2 * (-0.5 + a2 * (1.0 / 24.0 + a2 * (-1.0 / 720.0 + a2 * (1.0 / 40320.0))));
    let (along, across) = (radius * cosine, radius * sine);
    (if wide { Vec2::new(along, across) } else { Vec2::new(across, along) }, radius * radius)
}

/// Table of the lobe's directional albedo, `f0 * scale + f90 * bias`; an entry holds scale and bias for one cosine and
/// roughness. The diffuse layer reflects only light that the lobe does not reflect, so both layers together never
/// reflect more than they receive (Kelemen and Szirmay-Kalos 2001).
pub struct AlbedoTable {
    entries: Vec<Vec2>,
    averages: Vec<Vec2>,
}

/// Number of table entries along each axis. [convention: Cycles has tables of the same size for the albedo of GGX]
const SIDE: usize = 32;

impl AlbedoTable {
    pub fn new() -> Self {
        let mut entries = Vec::with_capacity(SIDE * SIDE);
        for i in 0..SIDE * SIDE {
            let roughness = (i / SIDE) as f32 / (SIDE - 1) as f32;
            let cosine = ((i % SIDE) as f32 / (SIDE - 1) as f32).max(1e-3);
            entries.push(directional_albedo(cosine, (roughness * roughness).max(1e-4)));
        }
        let averages = entries.chunks_exact(SIDE).map(cosine_average).collect();
        Self { entries, averages }
    }

    /// Returns the row of the table for a perceptual roughness.
    pub fn row(&self, roughness: f32) -> AlbedoRow<'_> {
        let (row, t) = cell(roughness);
        AlbedoRow { table: self, row, t }
    }
}

/// The albedo table at one roughness, interpolated between two of its rows.
pub struct AlbedoRow<'a> {
    table: &'a AlbedoTable,
    row: usize,
    t: f32,
}

impl AlbedoRow<'_> {
    /// Returns the scale and the bias of the directional albedo (see [`AlbedoTable`]) for a direction; `cosine` is the
    /// cosine of its angle to the normal.
    pub fn directional(&self, cosine: f32) -> Vec2 {
        let (column, s) = cell(cosine);
        let at = |row: usize| {
            let first = row * SIDE + column;
            self.table.entries[first].lerp(self.table.entries[first + 1], s)
        };
        at(self.row).lerp(at(self.row + 1), self.t)
    }

    /// Returns the cosine-weighted mean, over the hemisphere, of the scale and the bias.
    pub fn average(&self) -> Vec2 {
        self.table.averages[self.row].lerp(self.table.averages[self.row + 1], self.t)
    }
}

fn cell(x: f32) -> (usize, f32) {
    let x = x.clamp(0.0, 1.0) * (SIDE - 1) as f32;
    let i = (x as usize).min(SIDE - 2);
    (i, x - i as f32)
}

/// Returns the cosine-weighted mean of a row over the hemisphere: 2 ∫₀¹ row(c) c dc, where c is the cosine. Between
/// entries, the row is interpolated linearly, as in look-ups.
fn cosine_average(row: &[Vec2]) -> Vec2 {
    let step = 1.0 / (SIDE - 1) as f32;
    row.windows(2)
        .enumerate()
        .map(|(i, ends)| {
            let (a, b) = (i as f32 * step, (i + 1) as f32 * step);
            // Integrate by Simpson's rule, which is exact for the product of two linear functions.
            (ends[0] * a + (ends[0] + ends[1]) * (a + b) + ends[1] * b) * (step / 3.0)
        })
        .sum()
}

fn directional_albedo(cosine: f32, alpha: f32) -> Vec2 {
    // Number of Hammersley points from which the directional albedo is estimated. The error of a table entry is at most
    // 1.3 / `N` of the incident light, which is 0.5 %. Any value from 128 to 512 keeps the error at 1 % or less.
    // [convention]
    const N: u32 = 256;
    let wo = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let lobe = Lobe::new(wo, alpha);
    let mut sum = Vec2::ZERO;
    for i in 0..N {
        let u = Vec2::new((i as f32 + 0.5) / N as f32, i.reverse_bits() as f32 * (1.0 / 4_294_967_296.0));
        let h = lobe.sample_normal(u);
        let wi = h * (2.0 * wo.dot(h)) - wo;
        if wi.z > 0.0 {
            let weight = lobe.masking / (lobe.masking + lambda(wi, alpha));
            let grazing = maths::powi((1.0 - wo.dot(h)).clamp(0.0, 1.0), 5);
            sum += Vec2::new(1.0 - grazing, grazing) * weight;
        }
    }
    sum / N as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::chi2::assert_follows;

    /// The inverse of the concentric map (Shirley and Chiu 1997), in f64.
    fn square(p: Vec2) -> Vec2 {
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        let radius = x.hypot(y);
        let quarter = std::f64::consts::FRAC_PI_4;
        let (a, b) = if x.abs() > y.abs() {
            (radius * x.signum(), radius * x.signum() * (y / x).atan() / quarter)
        } else if y != 0.0 {
            (radius * y.signum() * (x / y).atan() / quarter, radius * y.signum())
        } else {
            (0.0, 0.0)
        };
        Vec2::new(((a + 1.0) / 2.0) as f32, ((b + 1.0) / 2.0) as f32)
    }

    #[test]
    fn the_concentric_map_and_its_inverse_are_the_identity() {
        let n = 257;
        for i in 0..n * n {
            let u = Vec2::new((i % n) as f32, (i / n) as f32) / n as f32;
            let (p, squared) = disc(u);
            assert!((p.length_squared() - squared).abs() < 1e-6 && squared <= 1.0, "{u}: {p}");
            assert!((square(p) - u).abs().max_element() < 1e-6, "{u}: {p}, back {}", square(p));
        }
        assert_eq!(disc(Vec2::splat(0.5)), (Vec2::ZERO, 0.0));
    }

    #[test]
    fn the_concentric_map_preserves_areas() {
        // Compare the determinant of the Jacobian, computed by central differences, with pi, the ratio of the areas of
        // the disc and the unit square.
        let h = 1.0 / 1024.0;
        for i in 0..64 * 64 {
            // Avoid the diagonals of the square, where the map is not smooth.
            let u = (Vec2::new((i % 64) as f32, (i / 64) as f32) + Vec2::new(0.5, 0.25)) / 64.0;
            let slope = |step: Vec2| (disc(u + step).0 - disc(u - step).0) / (2.0 * h);
            let determinant = slope(Vec2::X * h).perp_dot(slope(Vec2::Y * h));
            assert!((determinant - PI).abs() < 5e-3, "{u}: {determinant}");
        }
    }

    fn view(cosine: f32) -> Vec3 {
        let sine = (1.0 - cosine * cosine).sqrt();
        Vec3::new(0.8 * sine, 0.6 * sine, cosine)
    }

    /// Divides x and y by `alpha`, which undoes the last step of `sample_normal`: at any roughness, microfacet normals
    /// become points of a hemisphere.
    fn stretched(w: Vec3, alpha: f32) -> Vec3 {
        Vec3::new(w.x / alpha, w.y / alpha, w.z).normalize()
    }

    #[test]
    fn sampled_facets_follow_the_visible_normal_pdf_at_any_roughness() {
        let (side, n, fine) = (10usize, 20_000, 16);
        let mut rng = crate::rng::Rng::new(14, &[]);
        let cases: Vec<(f32, f32)> =
            [1e-3f32, 0.03, 0.1, 0.5, 1.0].into_iter().flat_map(|r| [1.0, 0.7, 0.2, 0.02].map(|c| (r, c))).collect();
        for &(roughness, cosine) in &cases {
            let alpha = roughness * roughness;
            let wo = view(cosine);
            let lobe = Lobe::new(wo, alpha);
            let v = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
            // On the hemisphere, the microfacet normals h visible from v have the pdf 2 max(v · h, 0) / (pi (1 +
            // v.z)). Integrate it over bins of equal solid angle.
            let mut expected = vec![0.0; side * side];
            let cells = side * fine;
            for i in 0..cells * cells {
                let z = (i / cells) as f32 + 0.5;
                let (z, angle) = (z / cells as f32, ((i % cells) as f32 + 0.5) / cells as f32 * 2.0 * PI);
                let r = (1.0 - z * z).sqrt();
                let seen = v.dot(Vec3::new(r * angle.cos(), r * angle.sin(), z)).max(0.0);
                let pdf = f64::from(2.0 * seen / (PI * (1.0 + v.z)));
                expected[i / cells / fine * side + i % cells / fine] +=
                    pdf * f64::from(2.0 * PI) / (cells * cells) as f64 * f64::from(n);
            }
            let mut counts = vec![0.0; side * side];
            for _ in 0..n {
                let h = stretched(lobe.sample_normal(Vec2::new(rng.next_f32(), rng.next_f32())), alpha);
                let row = ((h.z * side as f32) as usize).min(side - 1);
                let column = (h.y.atan2(h.x).rem_euclid(2.0 * PI) / (2.0 * PI) * side as f32) as usize;
                counts[row * side + column.min(side - 1)] += 1.0;
            }
            assert_follows(&expected, &counts, cases.len(), &format!("roughness {roughness}, cosine {cosine}"));
        }
    }

    #[test]
    fn sampling_a_facet_can_be_inverted() {
        for roughness in [0.03f32, 0.3, 1.0] {
            for cosine in [0.9, 0.3] {
                let (alpha, wo) = (roughness * roughness, view(cosine));
                let lobe = Lobe::new(wo, alpha);
                let v = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
                let t1 = Vec3::new(-v.y, v.x, 0.0).normalize();
                let t2 = v.cross(t1);
                for i in 0..64 * 64 {
                    let u = (Vec2::new((i % 64) as f32, (i / 64) as f32) + 0.5) / 64.0;
                    let n = stretched(lobe.sample_normal(u), alpha);
                    // Project the normal along the view direction to the unit disc. Then undo the step of
                    // `sample_normal` that squeezes the disc into the projection of the visible hemisphere.
                    let (p1, p2) = (n.dot(t1), n.dot(t2));
                    let s = 0.5 * (1.0 + v.z);
                    let p = Vec2::new(p1, (p2 - (1.0 - s) * (1.0 - p1 * p1).max(0.0).sqrt()) / s);
                    assert!((square(p) - u).abs().max_element() < 2e-3, "roughness {roughness}: {u} became {n}");
                }
            }
        }
    }
}
