//! Tests of the extensions of materials: without effect they change no bit, textures multiply their factors, and the
//! analysis of the scene finds what they require.

use super::requirements::difference;
use super::*;
use crate::scene::{ClearCoat, Specular};

/// A sheet of a material below a lamp and a sky. All its texture coordinates are the middle of texel 0 of two texels.
fn sheet(material: &Material, texture: Option<Image>) -> Scene {
    let mut sheet = Mesh::parallelogram(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0, 0);
    sheet.uvs[0] = vec![Vec2::new(0.25, 0.5); 4];
    let lamp = Mesh::parallelogram(Vec3::new(-0.5, 1.5, -2.0), Vec3::X, Vec3::Z, 1);
    Scene {
        meshes: vec![sheet, lamp],
        materials: vec![material.clone(), matt(0.0, 30.0)],
        textures: texture.into_iter().map(|image| Texture::new("varied", image)).collect(),
        lights: vec![PunctualLight::Point { position: Vec3::new(0.5, 1.0, 0.5), intensity: Vec3::splat(5.0) }],
        environment: Some(Environment::Constant(Vec3::ONE)),
        ..Scene::default()
    }
}

fn over_the_sheet() -> Camera {
    Camera::look_at(Vec3::new(0.0, 0.7, 1.8), Vec3::ZERO, 0.8)
}

fn picture(scene: Scene) -> Vec<f32> {
    let params = Params { width: 24, height: 16, samples: 16, ..Params::default() };
    render(&world(scene), &over_the_sheet(), &params).beauty.data
}

/// Two texels: the values to multiply the factors by, and others.
fn two_texels(texel: [f32; 4]) -> Image {
    Image::from_fn(2, 1, |x, _| if x == 0 { texel } else { texel.map(|v| 0.5 * v + 0.125) }).unwrap()
}

fn plastic() -> Material {
    Material { base_color: Vec3::new(0.6, 0.3, 0.1), metallic: 0.0, roughness: 0.4, ..Material::default() }
}

/// The texel of the varied textures, and pairs of materials: one with textures, and one whose factors are multiplied by
/// the texel.
const TEXEL: [f32; 4] = [0.25, 0.5, 0.75, 0.5];

fn textured_and_plain() -> Vec<(Material, Material)> {
    let (texture, colour) = (Some(TextureRef::new(0)), Vec3::new(0.25, 0.5, 0.75));
    let varied = Specular { strength: 0.8, texture, color: Vec3::splat(4.0), color_texture: texture };
    let plain = Specular { strength: 0.4, color: colour * 4.0, ..Specular::default() };
    let specular = (Material { specular: varied, ..plastic() }, Material { specular: plain, ..plastic() });
    let varied = ClearCoat { strength: 1.0, texture, roughness: 0.4, roughness_texture: texture };
    let plain = ClearCoat { strength: 0.25, roughness: 0.2, ..ClearCoat::default() };
    let coat = (Material { coat: varied, ..plastic() }, Material { coat: plain, ..plastic() });
    vec![specular, coat]
}

/// Materials with a clear coat of each kind.
fn coated() -> Vec<Material> {
    let coat = |strength: f32, roughness: f32| ClearCoat { strength, roughness, ..ClearCoat::default() };
    let matt = Material::diffuse("Matt", Vec3::splat(0.7));
    vec![
        Material { coat: coat(1.0, 0.0), ..matt.clone() },
        Material { coat: coat(0.7, 0.3), ..matt },
        Material { coat: coat(1.0, 0.1), ..plastic() },
        Material { coat: coat(1.0, 0.0), metallic: 1.0, roughness: 0.5, ..plastic() },
        Material { coat: coat(1.0, 0.0), transmission: 0.8, roughness: 0.0, ..plastic() },
    ]
}

#[test]
fn a_coat_without_strength_changes_no_bit() {
    let none = ClearCoat { strength: 0.0, roughness: 0.3, ..ClearCoat::default() };
    for base in [plastic(), Material::diffuse("Matt", Vec3::splat(0.7)), Material { metallic: 1.0, ..plastic() }] {
        let plain = world(sheet(&base, None)).requirements().clone();
        let coated = Material { coat: none, ..base.clone() };
        assert_eq!(world(sheet(&coated, None)).requirements(), &plain);
        assert!(!plain.clear_coat && !plain.left_out().iter().any(|text| text.contains("lear coat")));
        assert_eq!(picture(sheet(&coated, None)), picture(sheet(&base, None)));
    }
}

#[test]
fn the_analysis_finds_clear_coats() {
    for material in coated() {
        let requirements = world(sheet(&material, None)).requirements().clone();
        let is_rough = material.roughness > 0.0 && material.ior > 1.0;
        let is_mirror = material.coat.roughness == 0.0;
        assert!(requirements.clear_coat && requirements.mirror == is_mirror);
        assert_eq!(requirements.glossy, !is_mirror || is_rough, "{material:?}");
        assert!(requirements.left_out().iter().any(|text| text.starts_with("Clear coats reflect")));
        assert!(requirements.albedo.max_element() > material.base_color.max_element());
        let error = difference(sheet(&material, None), &over_the_sheet(), 16);
        assert!(error < 1e-5, "{error}: {material:?}");
    }
}

/// A sheet below a uniform sky reflects at most the bound of its albedo; the light of a lamp in the diffuse and in the
/// glossy layers adds up to the picture.
#[test]
fn coated_sheets_reflect_no_more_than_their_bound() {
    for material in coated() {
        let mut scene = sheet(&material, None);
        scene.meshes.truncate(1);
        scene.lights.clear();
        let bound = world(scene.clone()).requirements().albedo;
        let params = Params { width: 8, height: 8, samples: 256, ..Params::default() };
        for height in [3.0, 0.5] {
            let camera = Camera::look_at(Vec3::new(0.0, height, 1.0), Vec3::ZERO, 0.05);
            let film = render(&world(scene.clone()), &camera, &params);
            for (channel, bound) in bound.to_array().into_iter().enumerate() {
                let mean = film.beauty.data.iter().skip(channel).step_by(3).map(|&v| f64::from(v)).sum::<f64>() / 64.0;
                // A pane also shows the sky behind it, which the bound includes.
                assert!(mean < f64::from(bound) + 0.01, "{mean} above {bound}: {material:?}");
            }
        }
    }
}

#[test]
fn light_from_a_coat_is_glossy_or_mirrored() {
    let layers = |coat: ClearCoat| {
        let material = Material { coat, ..Material::diffuse("Black", Vec3::ZERO) };
        let mut outputs = Outputs::default();
        for (name, expression) in [("diffuse", "CD.*"), ("glossy", "CG.*"), ("mirror", "CS.*")] {
            outputs.add(name, expression).unwrap();
        }
        let params = Params { width: 24, height: 16, samples: 16, outputs, ..Params::default() };
        let film = render(&world(sheet(&material, None)), &over_the_sheet(), &params);
        film.layers.iter().map(|layer| layer.image.data.iter().sum::<f32>()).collect::<Vec<_>>()
    };
    let rough = layers(ClearCoat { strength: 1.0, roughness: 0.3, ..ClearCoat::default() });
    assert!(rough[0] == 0.0 && rough[1] > 0.0 && rough[2] == 0.0, "{rough:?}");
    let smooth = layers(ClearCoat { strength: 1.0, ..ClearCoat::default() });
    assert!(smooth[0] == 0.0 && smooth[1] == 0.0 && smooth[2] > 0.0, "{smooth:?}");
}

#[test]
fn textures_multiply_the_factors_of_the_layers() {
    for (textured, plain) in textured_and_plain() {
        let scene = sheet(&textured, Some(two_texels(TEXEL)));
        let requirements = world(scene.clone()).requirements().clone();
        assert_eq!(requirements.textures, 1);
        let plain_albedo = world(sheet(&plain, None)).requirements().albedo;
        assert!(requirements.albedo.cmpge(plain_albedo).all(), "{} and {plain_albedo}", requirements.albedo);
        let [varied, expected] = [picture(scene.clone()), picture(sheet(&plain, None))];
        let mean = expected.iter().sum::<f32>() / expected.len() as f32;
        let error = varied.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(error < 1e-4 * mean, "{error} of {mean}");
        let error = difference(scene, &over_the_sheet(), 16);
        assert!(error < 1e-5, "{error}");
        // A texture of a single colour is a constant factor.
        let uniform = Image::from_fn(2, 1, |_, _| TEXEL).unwrap();
        assert_eq!(world(sheet(&textured, Some(uniform))).requirements().textures, 0);
    }
}

#[test]
fn a_reflection_without_strength_is_no_reflection() {
    let none = Specular { strength: 0.0, ..Specular::default() };
    let [faint, matt] = [Material { specular: none, ..plastic() }, Material { ior: 1.0, ..plastic() }];
    assert_eq!(picture(sheet(&faint, None)), picture(sheet(&matt, None)));
    let requirements = world(sheet(&faint, None)).requirements().clone();
    assert!(requirements.diffuse && !requirements.glossy && requirements.albedo == Vec3::new(0.6, 0.3, 0.1));
}
