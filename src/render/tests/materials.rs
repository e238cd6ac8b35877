//! Tests of the extensions of materials: without effect they change no bit, textures multiply their factors, and the
//! analysis of the scene finds what they require.

use super::requirements::difference;
use super::*;
use crate::scene::Specular;

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
    vec![(Material { specular: varied, ..plastic() }, Material { specular: plain, ..plastic() })]
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
