//! Converts specular-glossiness materials (`KHR_materials_pbrSpecularGlossiness`), which occur in older files, to
//! metallic-roughness.
//!
//! The conversion follows the example that Khronos published with the extension ("convert-between-workflows", Gary
//! Hsu). It solves a quadratic equation for the metalness at which the material keeps the brightness of its diffuse
//! colour and of its specular colour. The base colour is a mixture of two estimates, one from the diffuse colour and
//! one from the specular colour. Textures are converted texel by texel; the result has the larger width and the larger
//! height of the two textures.
//!
//! Not modelled: textures of one material with different texture coordinates. Such a material keeps its
//! metallic-roughness values and is listed as not rendered. If the two textures have different wrap modes, the wrap
//! mode of the diffuse texture is used for both.

use crate::error::Result;
use crate::image::Image;
use crate::scene::Texture;
use glam::{Vec2, Vec3};
use gltf::json::extensions::material::PbrSpecularGlossiness;
use gltf::json::texture;

/// Reflectance of dielectrics at normal incidence. [convention: glTF 2.0, appendix B]
const DIELECTRIC: f32 = 0.04;

/// Lower bound of divisors. [rounding]
const EPSILON: f32 = 1e-6;

/// Whether the diffuse and the specular-glossiness texture use the same texture coordinates, or one of them is absent.
pub fn is_convertible(settings: &PbrSpecularGlossiness) -> bool {
    match (&settings.diffuse_texture, &settings.specular_glossiness_texture) {
        (Some(a), Some(b)) => coordinates(a) == coordinates(b),
        _ => true,
    }
}

/// Returns the index of the set of texture coordinates that a texture uses, and the five numbers of its texture
/// transform: offset (x, y), rotation and scale (x, y).
fn coordinates(info: &texture::Info) -> (u32, Option<[f32; 5]>) {
    let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
    let set = transform.and_then(|t| t.tex_coord).unwrap_or(info.tex_coord);
    let numbers = transform.map(|t| {
        let ([x, y], [sx, sy]) = (t.offset.0, t.scale.0);
        [x, y, t.rotation.0, sx, sy]
    });
    (set, numbers)
}

/// Converts a diffuse and a specular colour to a base colour and a metalness.
pub fn convert(diffuse: Vec3, specular: Vec3) -> (Vec3, f32) {
    let rest = 1.0 - specular.max_element();
    let metallic = metalness(brightness(diffuse), brightness(specular), rest);
    let of_diffuse = diffuse * (rest / (1.0 - DIELECTRIC) / (1.0 - metallic).max(EPSILON));
    let of_specular = (specular - DIELECTRIC * (1.0 - metallic)) / metallic.max(EPSILON);
    (of_diffuse.lerp(of_specular, metallic * metallic).clamp(Vec3::ZERO, Vec3::ONE), metallic)
}

/// Perceived brightness of a colour, with the weights of Khronos' conversion.
fn brightness(colour: Vec3) -> f32 {
    // [convention: ITU-R BT.601, luma]
    (colour * colour).dot(Vec3::new(0.299, 0.587, 0.114)).sqrt()
}

/// Solves the quadratic equation for the metalness at which the material has the given diffuse and specular brightness.
/// The result is clamped to `[0, 1]`; it is 0 if `specular` is below [`DIELECTRIC`]. `rest` is 1 minus the largest
/// channel of the specular colour.
fn metalness(diffuse: f32, specular: f32, rest: f32) -> f32 {
    if specular < DIELECTRIC {
        return 0.0;
    }
    let b = diffuse * rest / (1.0 - DIELECTRIC) + specular - 2.0 * DIELECTRIC;
    let discriminant = (b * b - 4.0 * DIELECTRIC * (DIELECTRIC - specular)).max(0.0);
    ((discriminant.sqrt() - b) / (2.0 * DIELECTRIC)).clamp(0.0, 1.0)
}

/// The factors and textures of a specular-glossiness material before the conversion.
pub struct Colours<'a> {
    pub diffuse: Vec3,
    pub alpha: f32,
    pub specular: Vec3,
    pub glossiness: f32,
    pub diffuse_texture: Option<&'a Texture>,
    pub specular_texture: Option<&'a Texture>,
}

impl Colours<'_> {
    /// Width and height of the converted textures: the larger width and the larger height of the given textures. `None`
    /// if the material has no textures.
    pub fn size(&self) -> Option<[usize; 2]> {
        let sizes = [self.diffuse_texture, self.specular_texture].into_iter().flatten();
        sizes.map(|t| [t.image.width, t.image.height]).reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])])
    }

    /// Returns two images: the base colour with alpha, and the roughness (green) with the metalness (blue).
    pub fn images(&self, [width, height]: [usize; 2]) -> Result<[Image; 2]> {
        let (mut base, mut surface) = (Image::new(width, height, 4)?, Image::new(width, height, 3)?);
        let pixels = base.data.as_chunks_mut::<4>().0.iter_mut().zip(surface.data.as_chunks_mut::<3>().0);
        for (index, (base, surface)) in pixels.enumerate() {
            let texel = Vec2::new((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
            let look = |texture: Option<&Texture>| {
                texture.map_or(glam::Vec4::ONE, |t| t.sample(texel / Vec2::new(width as f32, height as f32)))
            };
            let (diffuse, specular) = (look(self.diffuse_texture), look(self.specular_texture));
            let (colour, metallic) = convert(self.diffuse * diffuse.truncate(), self.specular * specular.truncate());
            *base = colour.extend(self.alpha * diffuse.w).to_array();
            *surface = [0.0, 1.0 - self.glossiness * specular.w, metallic];
        }
        Ok([base, surface])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dielectrics_and_metals_are_distinguished() {
        let (paint, gold) = (Vec3::new(0.5, 0.2, 0.1), Vec3::new(1.0, 0.77, 0.34));
        let (base, metallic) = convert(paint, Vec3::splat(DIELECTRIC));
        assert!(metallic < 1e-3 && (base - paint).abs().max_element() < 1e-3, "{base} {metallic}");
        let (base, metallic) = convert(Vec3::ZERO, gold);
        assert!(metallic > 0.999 && (base - gold).abs().max_element() < 1e-3, "{base} {metallic}");
        // Between these two extremes, both colours are kept approximately. With the metalness m, the specular colour
        // is 0.04 (1 - m) + m · base. The diffuse colour, (1 - m) · base, is the given diffuse colour times (1 - 0.4)
        // / (1 - 0.04).
        let (base, metallic) = convert(Vec3::splat(0.3), Vec3::splat(0.4));
        let diffuse = base * (1.0 - metallic);
        let specular = Vec3::splat(DIELECTRIC * (1.0 - metallic)) + base * metallic;
        assert!((specular - 0.4).abs().max_element() < 0.05, "{specular}");
        assert!((diffuse - 0.3 * 0.6 / 0.96).abs().max_element() < 0.05, "{diffuse}");
        assert_eq!(convert(Vec3::ZERO, Vec3::ZERO), (Vec3::ZERO, 0.0));
    }

    #[test]
    fn textures_are_converted_texel_by_texel() {
        let diffuse =
            Texture::new("", Image::from_fn(2, 1, |x, _| [[0.5, 0.2, 0.1, 0.5], [0.0, 0.0, 0.0, 1.0]][x]).unwrap());
        let specular = Image::from_fn(4, 2, |x, _| if x < 2 { [0.04, 0.04, 0.04, 0.25] } else { [0.9, 0.6, 0.3, 1.0] });
        let specular = Texture::new("", specular.unwrap());
        let colours = Colours {
            diffuse: Vec3::ONE,
            alpha: 0.5,
            specular: Vec3::ONE,
            glossiness: 0.5,
            diffuse_texture: Some(&diffuse),
            specular_texture: Some(&specular),
        };
        assert_eq!(colours.size(), Some([4, 2]));
        let [base, surface] = colours.images([4, 2]).unwrap();
        assert_eq!((base.channels, surface.channels), (4, 3));
        for (x, roughness, metallic) in [(1, 0.875, 0.0), (2, 0.5, 1.0)] {
            let pixel = surface.pixel(x, 0);
            assert!((pixel[1] - roughness).abs() < 1e-6 && (pixel[2] - metallic).abs() < 0.5, "{pixel:?}");
        }
        assert!(base.pixel(0, 0)[0] > base.pixel(0, 0)[2]);
    }
}
