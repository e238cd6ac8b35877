//! Tests of the BSDF: whether samples follow the pdf, whether the pdf integrates to at most 1, reciprocity, and energy
//! conservation.

use super::*;
use crate::render::compiled_material::{self, PointValues};
use crate::render::tests::chi2::assert_follows;
use crate::rng::Rng;
use crate::scene::{ClearCoat, Material, Specular};
use std::f32::consts::TAU;

/// Parameters for three roughnesses, each with a metallic share of 0, 0.4 and 1. The last entry is purely diffuse.
fn all_bsdf_params() -> Vec<BsdfParams> {
    let colour = Vec3::new(0.9, 0.5, 0.2);
    let mut all = Vec::new();
    for roughness in [0.3, 0.6, 1.0] {
        for metallic in [0.0f32, 0.4, 1.0] {
            all.push(BsdfParams {
                diffuse: colour * (1.0 - metallic),
                f0: Vec3::splat(0.04).lerp(colour, metallic),
                f90: 1.0,
                roughness,
                transmission: Vec3::ZERO,
                dielectric_f0: 0.04,
                dielectric_f90: 1.0,
                coat: CoatParams::NONE,
            });
        }
    }
    all.push(matt(colour));
    // A coloured reflection below full strength, with and without metal.
    for metallic in [0.0, 0.4] {
        let material = Material {
            specular: Specular { strength: 0.7, color: Vec3::new(4.0, 1.0, 9.0), ..Specular::default() },
            base_color: colour,
            metallic,
            roughness: 0.5,
            ..Material::default()
        };
        all.push(compiled(&material));
    }
    // Clear coats over a matt surface, over a dielectric, and over a metal.
    for (ior, metallic, strength, roughness) in [(1.0, 0.0, 1.0, 0.3), (1.5, 0.2, 0.6, 0.3), (1.5, 1.0, 1.0, 0.6)] {
        let coat = ClearCoat { strength, roughness, ..ClearCoat::default() };
        let material = Material { ior, metallic, base_color: colour, roughness: 0.5, coat, ..Material::default() };
        all.push(compiled(&material));
    }
    all
}

/// The parameters of a material without textures.
fn compiled(material: &Material) -> BsdfParams {
    compiled_material::bsdf_params(material, &PointValues::new(material))
}

/// A dielectric with the index of refraction 1.5 and a reflection of the given strength.
fn dielectric(strength: f32, base_color: Vec3) -> Material {
    Material {
        specular: Specular { strength, ..Specular::default() },
        base_color,
        metallic: 0.0,
        ..Material::default()
    }
}

fn matt(colour: Vec3) -> BsdfParams {
    BsdfParams {
        diffuse: colour,
        f0: Vec3::ZERO,
        f90: 0.0,
        roughness: 1.0,
        transmission: Vec3::ZERO,
        dielectric_f0: 0.0,
        dielectric_f90: 0.0,
        coat: CoatParams::NONE,
    }
}

/// The BSDF seen from `wo`; the normal is the z axis.
fn seen<'a>(bsdf_params: &BsdfParams, wo: Vec3, table: &'a AlbedoTable) -> Bsdf<'a> {
    Bsdf::new(bsdf_params, bsdf_params.is_layered(), [Vec3::Z; 2], wo, Some(table))
}

fn direction(cosine: f32, angle: f32) -> Vec3 {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    Vec3::new(sine * angle.cos(), sine * angle.sin(), cosine)
}

#[test]
fn sampled_directions_follow_the_stated_pdf() {
    const ROWS: usize = 10;
    const COLUMNS: usize = 16;
    const VIEWS: [f32; 3] = [0.95, 0.6, 0.15];
    let table = AlbedoTable::new();
    let n = 20_000;
    let all_bsdf_params = all_bsdf_params();
    let tests = all_bsdf_params.len() * VIEWS.len();
    for (number, bsdf_params) in all_bsdf_params.iter().enumerate() {
        for view in VIEWS {
            let bsdf = seen(bsdf_params, direction(view, 0.3), &table);
            // Compute the expected counts in bins of cosine and azimuth that have equal solid angles. The last entry is
            // the expected number of absorbed samples.
            let mut expected = vec![0.0; ROWS * COLUMNS + 1];
            const SUB: usize = 24;
            for i in 0..ROWS * SUB {
                for j in 0..COLUMNS * SUB {
                    let cosine = (i as f32 + 0.5) / (ROWS * SUB) as f32;
                    let angle = TAU * (j as f32 + 0.5) / (COLUMNS * SUB) as f32;
                    let pdf = f64::from(bsdf.eval(direction(cosine, angle)).1);
                    let solid_angle = f64::from(TAU) / (ROWS * COLUMNS * SUB * SUB) as f64;
                    expected[i / SUB * COLUMNS + j / SUB] += f64::from(n) * pdf * solid_angle;
                }
            }
            let inside: f64 = expected.iter().sum();
            assert!(inside < 1.002 * f64::from(n), "densities integrate to at most 1: {inside}");
            expected[ROWS * COLUMNS] = (f64::from(n) - inside).max(0.0);
            // Count the sampled directions per bin.
            let mut observed = vec![0.0; ROWS * COLUMNS + 1];
            let mut rng = Rng::new(11, &[number as u64, (view * 100.0) as u64]);
            for _ in 0..n {
                let sample = bsdf.sample(Vec2::new(rng.next_f32(), rng.next_f32()));
                let bin = sample.map_or(ROWS * COLUMNS, |s| {
                    let (lobes, pdf) = bsdf.eval(s.direction);
                    let ScatterKind::NonSpecular(stated) = s.kind else { panic!("{:?}", s.kind) };
                    assert!((stated / pdf - 1.0).abs() < 1e-4, "{stated} and {pdf}");
                    let weight = lobes.sum() / pdf;
                    assert!((s.weight - weight).abs().max_element() <= 1e-5, "{} and {weight}", s.weight);
                    let row = ((s.direction.z * ROWS as f32) as usize).min(ROWS - 1);
                    let angle = s.direction.y.atan2(s.direction.x).rem_euclid(TAU) / TAU;
                    row * COLUMNS + ((angle * COLUMNS as f32) as usize).min(COLUMNS - 1)
                });
                observed[bin] += 1.0;
            }
            assert_follows(&expected, &observed, tests, &format!("bsdf_params {number}, view {view}"));
        }
    }
}

#[test]
fn the_bsdf_is_reciprocal() {
    let table = AlbedoTable::new();
    let mut rng = Rng::new(12, &[]);
    for bsdf_params in all_bsdf_params() {
        for _ in 0..200 {
            let a = direction(rng.next_f32() * 0.98 + 0.01, TAU * rng.next_f32());
            let b = direction(rng.next_f32() * 0.98 + 0.01, TAU * rng.next_f32());
            let value = |o, i: Vec3| seen(&bsdf_params, o, &table).eval(i).0.sum() / i.z;
            let (there, back) = (value(a, b), value(b, a));
            assert!((there - back).abs().max_element() <= 1e-3 * there.max_element(), "{there} and {back}");
        }
    }
}

/// Returns the directional albedo, estimated as the mean of the sample weights, and its standard error.
fn albedo(bsdf_params: &BsdfParams, view: f32, table: &AlbedoTable) -> (f64, f64) {
    let bsdf = seen(bsdf_params, direction(view, 0.7), table);
    let n = 40_000;
    let mut rng = Rng::new(13, &[]);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..n {
        let sample = bsdf.sample(Vec2::new(rng.next_f32(), rng.next_f32()));
        let weight = sample.map_or(0.0, |s| f64::from(s.weight.x));
        (sum, squares) = (sum + weight, squares + weight * weight);
    }
    let mean = sum / f64::from(n);
    (mean, ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt())
}

/// Returns the directional albedo, integrated over the hemisphere by the midpoint rule.
fn integrated_albedo(bsdf_params: &BsdfParams, view: f32, table: &AlbedoTable) -> f64 {
    const STEPS: usize = 1000;
    let bsdf = seen(bsdf_params, direction(view, 0.7), table);
    let mut sum = 0.0;
    for i in 0..STEPS * STEPS / 2 {
        let cosine = ((i / STEPS) as f32 + 0.5) / (STEPS / 2) as f32;
        let angle = ((i % STEPS) as f32 + 0.5) / STEPS as f32 * TAU;
        sum += f64::from(bsdf.eval(direction(cosine, angle)).0.sum().x);
    }
    sum * f64::from(TAU) / (STEPS * STEPS / 2) as f64
}

#[test]
fn the_albedo_of_samples_is_the_integral_of_the_bsdf() {
    let table = AlbedoTable::new();
    for (number, bsdf_params) in all_bsdf_params().iter().enumerate() {
        for view in [0.95, 0.6, 0.15] {
            let (mean, error) = albedo(bsdf_params, view, &table);
            let expected = integrated_albedo(bsdf_params, view, &table);
            let what = format!("bsdf_params {number}, view {view}: {mean} ± {error}, integral {expected}");
            assert!((mean - expected).abs() < 4.5 * error + 1e-3 && expected < 1.01, "{what}");
        }
    }
}

#[test]
fn the_specular_strength_is_a_factor_and_the_colour_tints_normal_incidence() {
    let table = AlbedoTable::new();
    let base = Vec3::new(0.9, 0.5, 0.2);
    let mut rng = Rng::new(15, &[]);
    for roughness in [0.1, 0.5, 1.0] {
        let glossy = |specular: Specular, wo: Vec3, wi: Vec3| {
            let material = Material { roughness, specular, ..dielectric(1.0, base) };
            seen(&compiled(&material), wo, &table).eval(wi).0.glossy
        };
        let full = Specular::default();
        for _ in 0..100 {
            let wo = direction(rng.next_f32() * 0.98 + 0.01, TAU * rng.next_f32());
            let wi = direction(rng.next_f32() * 0.98 + 0.01, TAU * rng.next_f32());
            let (faint, whole) = (glossy(Specular { strength: 0.3, ..full }, wo, wi), glossy(full, wo, wi));
            assert!((faint - whole * 0.3).abs().max_element() <= 1e-5 * whole.max_element(), "{faint} and {whole}");
            // Light that returns to the viewer meets microfacets at normal incidence.
            let color = Vec3::new(4.0, 1.0, 0.0);
            let (tinted, whole) = (glossy(Specular { color, ..full }, wo, wo), glossy(full, wo, wo));
            assert!((tinted - whole * color).abs().max_element() <= 1e-4 * whole.max_element(), "{tinted}");
        }
    }
    // The reflectance is limited to 1.
    let bright = Specular { color: Vec3::new(100.0, 1.0, 1.0), ..Specular::default() };
    let bright = compiled(&Material { specular: bright, ..dielectric(1.0, base) });
    assert_eq!((bright.f0.x, bright.f90, bright.dielectric_f0), (1.0, 1.0, 1.0));
    // Without reflection, the material is matt, just like one with an index of refraction of 1.
    for metallic in [0.0, 0.4] {
        let none = compiled(&Material { metallic, ..dielectric(0.0, base) });
        let matt = compiled(&Material { metallic, ior: 1.0, ..dielectric(1.0, base) });
        assert_eq!((none.diffuse, none.f0, none.f90), (matt.diffuse, matt.f0, matt.f90));
        assert_eq!((none.f90, none.dielectric_f90), (metallic, 0.0));
    }
}

fn coat(strength: f32, roughness: f32) -> ClearCoat {
    ClearCoat { strength, roughness, ..ClearCoat::default() }
}

#[test]
fn a_coat_over_black_is_a_dielectric_over_black() {
    let table = AlbedoTable::new();
    let mut rng = Rng::new(16, &[]);
    for roughness in [0.1, 0.5, 1.0] {
        let black = Material { ior: 1.0, roughness, ..dielectric(1.0, Vec3::ZERO) };
        let coated = compiled(&Material { coat: coat(1.0, roughness), ..black.clone() });
        let half = compiled(&Material { coat: coat(0.5, roughness), ..black.clone() });
        let expected = compiled(&Material { ior: 1.5, ..black });
        for _ in 0..200 {
            let wo = direction(rng.next_f32() * 0.98 + 0.01, TAU * rng.next_f32());
            let wi = direction(rng.next_f32() * 0.98 + 0.01, TAU * rng.next_f32());
            let of = |params: &BsdfParams| seen(params, wo, &table).eval(wi);
            let ((coat, pdf), (half, _), (lobes, expected)) = (of(&coated), of(&half), of(&expected));
            assert!((coat.glossy - lobes.glossy).abs().max_element() <= 1e-5 * lobes.glossy.x, "{coat:?} {lobes:?}");
            assert!((half.glossy - lobes.glossy * 0.5).abs().max_element() <= 1e-5 * lobes.glossy.x, "{half:?}");
            assert!(coat.diffuse == Vec3::ZERO && pdf == expected, "{pdf} and {expected}");
        }
    }
    // Without roughness, the coat is a mirror.
    let mirror = compiled(&Material { ior: 1.0, coat: coat(0.5, 0.0), ..dielectric(1.0, Vec3::ZERO) });
    let sample = seen(&mirror, direction(0.3, 0.7), &table).sample(Vec2::splat(0.5)).unwrap();
    let expected = 0.5 * ggx::schlick(Vec3::splat(0.04), 1.0, 0.3);
    assert!(sample.kind == ScatterKind::Mirror && (sample.weight - expected).abs().max_element() < 1e-6);
}

#[test]
fn a_coat_without_share_changes_no_bit() {
    let table = AlbedoTable::new();
    let mut rng = Rng::new(17, &[]);
    for (number, bsdf_params) in all_bsdf_params().iter().enumerate() {
        if bsdf_params.coat != CoatParams::NONE || !bsdf_params.is_layered() {
            continue;
        }
        let absent = BsdfParams { coat: CoatParams { share: 0.0, roughness: 0.5 }, ..*bsdf_params };
        for _ in 0..50 {
            let wo = direction(rng.next_f32(), TAU * rng.next_f32());
            let u = Vec2::new(rng.next_f32(), rng.next_f32());
            let of = |params: &BsdfParams| {
                let bsdf = seen(params, wo, &table);
                let sample = bsdf.sample(u).map(|s| (s.direction, s.weight, s.lobes, s.kind));
                (sample, bsdf.colour(), bsdf.is_shareable(), bsdf.has_non_specular())
            };
            assert_eq!(of(&absent), of(bsdf_params), "bsdf_params {number}");
        }
    }
}

/// White furnace test: below a coat, a matt surface and a smooth mirror lose no light, and no surface makes light.
#[test]
fn a_white_surface_below_a_coat_makes_no_light() {
    let table = AlbedoTable::new();
    let white = Material { roughness: 0.0, metallic: 0.0, ..Material::diffuse("White", Vec3::ONE) };
    let bases = [
        ("matt", white.clone()),
        ("smooth dielectric", Material { ior: 1.5, ..white.clone() }),
        ("rough dielectric", Material { ior: 1.5, roughness: 0.5, ..white.clone() }),
        ("dense dielectric", Material { ior: 2.4, roughness: 0.3, ..white.clone() }),
        ("mirror", Material { metallic: 1.0, ..white.clone() }),
        ("rough metal", Material { metallic: 1.0, roughness: 0.5, ..white.clone() }),
        ("half metal", Material { ior: 1.5, metallic: 0.5, roughness: 0.4, ..white.clone() }),
        ("pane", Material { ior: 1.5, transmission: 1.0, ..white }),
    ];
    for (name, base) in bases {
        for (strength, roughness) in [(1.0, 0.0), (0.5, 0.0), (1.0, 0.1), (0.7, 0.3), (1.0, 0.6), (1.0, 1.0)] {
            let bsdf_params = compiled(&Material { coat: coat(strength, roughness), ..base.clone() });
            for view in [1.0, 0.7, 0.3, 0.05] {
                let (mean, error) = albedo(&bsdf_params, view, &table);
                let what = format!("{name} below {strength} of roughness {roughness}, view {view}: {mean} ± {error}");
                assert!(mean <= 1.0 + 4.5 * error + 0.003, "{what}");
                // The table of the albedo has an error of at most 0.5 %.
                let is_lossless = ["matt", "smooth dielectric", "mirror"].contains(&name);
                assert!(!is_lossless || mean > 1.0 - 4.5 * error - 0.01, "{what}");
                // The integral leaves out the light that the coat mirrors, so its closed form is added.
                if roughness == 0.0 && name == "matt" {
                    let mirrored = strength * ggx::schlick(Vec3::splat(0.04), 1.0, view).x;
                    let expected = f64::from(mirrored) + integrated_albedo(&bsdf_params, view, &table);
                    assert!((mean - expected).abs() < 4.5 * error + 1e-3, "{what}, expected {expected}");
                }
            }
        }
    }
}

#[test]
fn smooth_coats_are_mirrors_that_pixels_do_not_share() {
    let table = AlbedoTable::new();
    let of = |strength: f32, roughness: f32, base: Vec3| {
        let params = compiled(&Material { coat: coat(strength, roughness), ..Material::diffuse("", base) });
        let bsdf = seen(&params, direction(0.8, 0.1), &table);
        (bsdf.is_diffuse(), bsdf.is_shareable(), bsdf.has_non_specular())
    };
    assert_eq!(of(0.0, 0.0, Vec3::ONE), (true, true, true));
    assert_eq!(of(1.0, 0.0, Vec3::ONE), (false, false, true));
    assert_eq!(of(1.0, 0.0, Vec3::ZERO), (false, false, false));
    assert_eq!(of(1.0, 0.05, Vec3::ZERO), (false, false, true));
    assert_eq!(of(1.0, 0.2, Vec3::ZERO), (false, true, true));
    let params = compiled(&Material { coat: coat(0.5, 0.2), ..Material::diffuse("", Vec3::ONE) });
    assert_eq!(seen(&params, Vec3::Z, &table).colour(), Vec3::ONE);
}

#[test]
fn a_white_dielectric_loses_energy_only_between_its_facets() {
    // The diffuse layer reflects all light that the top layer does not reflect (Kelemen and Szirmay-Kalos 2001).
    let table = AlbedoTable::new();
    for roughness in [0.0, 0.0005, 0.05, 0.2, 0.6, 1.0] {
        for view in [1.0, 0.5, 0.1] {
            let bsdf_params = compiled(&Material { roughness, ..dielectric(1.0, Vec3::ONE) });
            let albedo = albedo(&bsdf_params, view, &table).0;
            assert!((albedo - 1.0).abs() < 0.01, "roughness {roughness}, view {view}: {albedo}");
        }
    }
    assert_eq!(albedo(&matt(Vec3::ONE), 0.3, &table), (1.0, 0.0), "white without a top layer");
}

/// White furnace test for metals. The albedo never exceeds 1 and is exactly 1 for a mirror. At roughness 1 the GGX
/// distribution is uniform, and the albedo has the closed form 1 - µ ln((1 + µ) / µ), with the cosine µ of the view
/// direction.
#[test]
fn a_white_metal_makes_no_light_at_any_roughness() {
    let table = AlbedoTable::new();
    for step in 0..=10 {
        let roughness = step as f32 / 10.0;
        for view in [1.0, 0.7, 0.3, 0.05] {
            let white = BsdfParams { f0: Vec3::ONE, f90: 1.0, roughness, ..matt(Vec3::ZERO) };
            let (mean, error) = albedo(&white, view, &table);
            let what = format!("roughness {roughness}, view {view}: {mean} ± {error}");
            assert!(mean <= 1.0 + 4.0 * error + 1e-5, "{what}");
            if roughness == 0.0 {
                assert!((mean - 1.0).abs() < 1e-5, "{what}");
            }
            if roughness == 1.0 {
                let cosine = f64::from(view);
                let expected = 1.0 - cosine * ((1.0 + cosine) / cosine).ln();
                assert!((mean - expected).abs() < 4.0 * error + 1e-4, "{what}, expected {expected}");
            }
            // Compare with the albedo table, from which the BSDF computes how the layers share the energy.
            let share = table.row(roughness).directional(view).element_sum();
            assert!((mean - f64::from(share)).abs() < 0.02, "{what}, table {share}");
        }
    }
}
