//! Tests of the boundary: Fresnel's equations against closed forms, whether samples follow the pdf of Walter et al.,
//! reciprocity, and the energy that single scattering loses.

use super::*;
use crate::render::tests::chi2::assert_follows;
use crate::rng::Rng;
use std::f32::consts::TAU;

/// From air into glass, from glass into air, and both for water.
const ETAS: [f32; 4] = [1.0 / 1.5, 1.5, 1.0 / 1.33, 1.33];

fn direction(cosine: f32, angle: f32) -> Vec3 {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    Vec3::new(sine * angle.cos(), sine * angle.sin(), cosine)
}

#[test]
fn reflectance_follows_the_equations_of_fresnel() {
    for eta in ETAS {
        let at_right_angles = ((eta - 1.0) / (eta + 1.0)).powi(2);
        assert!((fresnel(1.0, eta).0 - at_right_angles).abs() < 1e-7);
        assert!((fresnel(0.0, eta).0 - 1.0).abs() < 1e-6);
        // At Brewster's angle, tan θ = 1 / eta, no light of parallel polarisation is reflected. The other half of the
        // light is reflected by cos² 2θ.
        let angle = (1.0 / eta).atan();
        let expected = 0.5 * (2.0 * angle).cos().powi(2);
        assert!((fresnel(angle.cos(), eta).0 - expected).abs() < 1e-6, "{eta}");
        for step in 1..100 {
            let cosine = step as f32 / 100.0;
            let (reflected, refracted) = fresnel(cosine, eta);
            let sine = eta * (1.0 - cosine * cosine).sqrt();
            assert_eq!(reflected == 1.0, sine >= 1.0, "total internal reflection");
            if reflected < 1.0 {
                // Snell's law, and the same reflectance from the other side.
                assert!((refracted * refracted + sine * sine - 1.0).abs() < 1e-5);
                let (back, straight) = fresnel(refracted, 1.0 / eta);
                assert!((back - reflected).abs() < 1e-4 && (straight - cosine).abs() < 1e-3, "{eta} at {cosine}");
            }
        }
    }
    assert_eq!((fresnel(0.0, 1.0), fresnel(0.3, 1.0)), ((0.0, 0.0), (0.0, 0.3)));
}

#[test]
fn a_smooth_boundary_refracts_by_snell_and_scales_radiance() {
    for eta in ETAS {
        let glass = Dielectric::new(direction(0.8, 0.5), eta, Vec3::ONE, None);
        let Some(DielectricSample::Refracted { direction: wi, weight }) = glass.sample(Vec2::new(0.99, 0.5)) else {
            panic!("refracts");
        };
        assert!((wi.length() - 1.0).abs() < 1e-6 && wi.z < 0.0);
        assert!((wi.truncate() + direction(0.8, 0.5).truncate() * eta).length() < 1e-6);
        assert!((weight - Vec3::splat(eta * eta)).abs().max_element() < 1e-6, "{weight}");
        let mirrored = glass.sample(Vec2::new(0.0, 0.5));
        assert!(matches!(mirrored, Some(DielectricSample::Mirrored { weight: 1.0, direction }) if direction.z == 0.8));
    }
    // Equal media on both sides have no boundary, however rough.
    let none = Dielectric::new(direction(0.3, 0.5), 1.0, Vec3::ONE, Some(0.5));
    let straight = Some(DielectricSample::Refracted { direction: -direction(0.3, 0.5), weight: Vec3::ONE });
    assert_eq!((none.sample(Vec2::ZERO), none.is_rough()), (straight, false));
    // A black boundary that reflects nothing carries no light.
    assert_eq!(Dielectric::new(Vec3::Z, 1.0, Vec3::ZERO, None).sample(Vec2::splat(0.5)), None);
}

/// A rough boundary, with the quantities of Walter et al. 2007 in f64. Directions on the far side have z < 0.
struct Walter {
    wo: Vec3,
    eta: f32,
    alpha: f32,
}

impl Walter {
    fn dielectric(&self) -> Dielectric {
        Dielectric::new(self.wo, self.eta, Vec3::ONE, Some(self.alpha))
    }

    fn masking(&self, w: Vec3) -> f64 {
        let tangent2 = f64::from(w.truncate().length_squared()) / f64::from(w.z).powi(2);
        2.0 / (1.0 + (1.0 + f64::from(self.alpha).powi(2) * tangent2).sqrt())
    }

    /// The facet that refracts `wi` to `wo` (equation 16), the density D of its normal (equation 33), and the Jacobian
    /// (equation 17). `None` if no facet does.
    fn facet(&self, wi: Vec3) -> Option<(Vec3, f64, f64)> {
        // Divide the indices of both sides by the index of the far side.
        let sum = -(self.wo * self.eta + wi);
        let h = sum.normalize() * sum.z.signum();
        let (o, i) = (f64::from(self.wo.dot(h)), f64::from(wi.dot(h)));
        if !(o > 0.0 && i < 0.0) {
            return None;
        }
        let a2 = f64::from(self.alpha).powi(2);
        let tangent2 = f64::from(h.truncate().length_squared()) / f64::from(h.z).powi(2);
        let density = a2 / (std::f64::consts::PI * f64::from(h.z).powi(4) * (a2 + tangent2).powi(2));
        Some((h, density, i.abs() / (f64::from(self.eta) * o + i).powi(2)))
    }

    /// Solid-angle pdf of refracted directions: of the facet's normal among the visible ones, times the Jacobian, times
    /// the probability of refraction.
    fn pdf(&self, wi: Vec3) -> f64 {
        let Some((h, density, jacobian)) = self.facet(wi) else { return 0.0 };
        let cosine = self.wo.dot(h);
        let visible = self.masking(self.wo) * f64::from(cosine) * density / f64::from(self.wo.z);
        let probability = f64::from(self.dielectric().split(cosine).2);
        visible * jacobian * (1.0 - probability)
    }

    /// The BSDF of refracted light (equation 21), for radiance: times `eta`².
    fn value(&self, wi: Vec3) -> f64 {
        let Some((h, density, jacobian)) = self.facet(wi) else { return 0.0 };
        let cosine = self.wo.dot(h);
        let transmitted = 1.0 - f64::from(fresnel(cosine, self.eta).0);
        let masking = self.masking(self.wo) * self.masking(wi);
        let cosines = f64::from(self.wo.z) * f64::from(wi.z.abs());
        f64::from(self.eta).powi(2) * f64::from(cosine) / cosines * jacobian * transmitted * masking * density
    }
}

/// All combinations of directions of the viewer, sides of glass and roughnesses. The roughnesses are so large that the
/// bins of the chi-squared test resolve the lobes.
fn boundaries() -> Vec<Walter> {
    let mut all = Vec::new();
    for view in [0.95, 0.6, 0.15] {
        for eta in [ETAS[0], ETAS[1]] {
            all.extend([0.5f32, 0.75, 1.0].map(|r| Walter { wo: direction(view, 0.3), eta, alpha: r * r }));
        }
    }
    all
}

#[test]
fn sampled_directions_follow_the_pdf_of_walter_et_al() {
    const ROWS: usize = 12;
    const COLUMNS: usize = 12;
    const SUB: usize = 40;
    let boundaries = boundaries();
    let n = 15_000;
    for (number, walter) in boundaries.iter().enumerate() {
        let dielectric = walter.dielectric();
        // Compute the expected counts in bins of cosine and azimuth over the whole sphere. The last entry is the
        // expected number of lost samples.
        let mut expected = vec![0.0; ROWS * COLUMNS + 1];
        for i in 0..ROWS * SUB {
            for j in 0..COLUMNS * SUB {
                let cosine = 2.0 * (i as f32 + 0.5) / (ROWS * SUB) as f32 - 1.0;
                let w = direction(cosine, TAU * (j as f32 + 0.5) / (COLUMNS * SUB) as f32);
                let pdf = if cosine > 0.0 { f64::from(dielectric.eval(w).1) } else { walter.pdf(w) };
                let solid_angle = 2.0 * f64::from(TAU) / (ROWS * COLUMNS * SUB * SUB) as f64;
                expected[i / SUB * COLUMNS + j / SUB] += f64::from(n) * pdf * solid_angle;
            }
        }
        let inside: f64 = expected.iter().sum();
        assert!(inside < 1.004 * f64::from(n), "densities integrate to at most 1: {inside} of {n}");
        expected[ROWS * COLUMNS] = (f64::from(n) - inside).max(0.0);
        let mut observed = vec![0.0; ROWS * COLUMNS + 1];
        let mut rng = Rng::new(21, &[number as u64]);
        for _ in 0..n {
            let bin = match dielectric.sample(Vec2::new(rng.next_f32(), rng.next_f32())) {
                None => ROWS * COLUMNS,
                Some(DielectricSample::Reflected { direction }) if direction.z <= 0.0 => ROWS * COLUMNS,
                Some(DielectricSample::Mirrored { .. }) => panic!("the boundary is rough"),
                Some(
                    DielectricSample::Reflected { direction: w } | DielectricSample::Refracted { direction: w, .. },
                ) => {
                    let row = ((w.z * 0.5 + 0.5) * ROWS as f32) as usize;
                    let column = (w.y.atan2(w.x).rem_euclid(TAU) / TAU * COLUMNS as f32) as usize;
                    row.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
                }
            };
            observed[bin] += 1.0;
        }
        assert_follows(&expected, &observed, boundaries.len(), &format!("boundary {number}"));
    }
}

#[test]
fn sample_weights_are_the_bsdf_of_walter_et_al_which_is_reciprocal() {
    let mut rng = Rng::new(22, &[]);
    for walter in boundaries() {
        for _ in 0..100 {
            let u = Vec2::new(rng.next_f32(), rng.next_f32());
            let Some(DielectricSample::Refracted { direction: wi, weight }) = walter.dielectric().sample(u) else {
                continue;
            };
            // Skip grazing and nearly straight directions, at which the rounding of f32 spoils the facet's normal.
            if wi.z > -0.05 || (walter.wo * walter.eta + wi).length() < 0.05 {
                continue;
            }
            let value = walter.value(wi);
            let expected = value * f64::from(wi.z.abs()) / walter.pdf(wi);
            assert!((f64::from(weight.x) / expected - 1.0).abs() < 2e-2, "{} and {expected}", weight.x);
            // Reciprocity of refraction (Veach 1997, section 5.2.2): the BSDF divided by the squared index on the side
            // of the arriving light is the same both ways.
            let back = Walter { wo: -wi, eta: 1.0 / walter.eta, alpha: walter.alpha };
            let (there, back) = (value, back.value(-walter.wo) * f64::from(walter.eta).powi(2));
            assert!((there / back - 1.0).abs() < 2e-2, "{there} and {back}");
        }
    }
}

/// Returns the share of arriving energy that a white boundary reflects and refracts.
fn albedo(cosine: f32, eta: f32, roughness: f32) -> f64 {
    let dielectric = Dielectric::new(direction(cosine, 0.4), eta, Vec3::ONE, Some(roughness * roughness));
    let mut rng = Rng::new(23, &[]);
    let n = 4000;
    let mut sum = 0.0;
    for _ in 0..n {
        sum += match dielectric.sample(Vec2::new(rng.next_f32(), rng.next_f32())) {
            Some(DielectricSample::Reflected { direction }) if direction.z > 0.0 => {
                let (value, pdf) = dielectric.eval(direction);
                f64::from(value / pdf)
            }
            // Radiance grows by the squared index; energy does not.
            Some(DielectricSample::Refracted { weight, .. }) => f64::from(weight.x / (eta * eta)),
            _ => 0.0,
        };
    }
    sum / f64::from(n)
}

#[test]
fn a_rough_boundary_makes_no_light_and_loses_little() {
    // The largest losses at a cosine of at least 0.5: measured 0.0004 and 0.0062, and at a roughness of 0.5 below 0.2.
    for (roughness, loss) in [(0.1, 0.001), (0.2, 0.01), (0.5, 0.2)] {
        for eta in ETAS {
            for cosine in [1.0, 0.8, 0.5, 0.2] {
                let albedo = albedo(cosine, eta, roughness);
                let least = if cosine >= 0.5 { 1.0 - loss } else { 0.5 };
                let what = format!("roughness {roughness}, eta {eta}, cosine {cosine}: {albedo}");
                println!("{what}");
                assert!(albedo <= 1.0 + 1e-5 && albedo >= least, "{what}");
            }
        }
    }
}
