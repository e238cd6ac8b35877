//! Upper bounds on the emission, lights and environment of a scene, so that sums over pixels cannot overflow `f32`.

use super::light::{MAX_LIGHT, check_light};
use super::{Environment, Material, PunctualLight, Scene};
use crate::error::{Error, Result};
use crate::image::Image;
use glam::Vec3;

impl Scene {
    /// Checks the luminance of every emissive material and of the environment, at each texel of an emission texture or
    /// environment image. Checks the intensity or illuminance of every punctual light, and the luminance of the faces
    /// of every luminaire with faces. The error names the first light or material that is too bright, its value and
    /// the allowed range.
    pub fn check_brightness(&self) -> Result<()> {
        for (i, material) in self.materials.iter().enumerate() {
            self.check_emission(material).map_err(|e| e.context(format_args!("material {i} ({:?})", material.name)))?;
        }
        for (i, light) in self.lights.iter().enumerate() {
            self.check_punctual_light(light).map_err(|e| e.context(format_args!("light {i}")))?;
        }
        match &self.environment {
            Some(Environment::Constant(radiance)) => check_light("environment", *radiance),
            Some(Environment::Image(image)) => check_texels("environment", image, Vec3::ONE),
            None => Ok(()),
        }
    }

    /// Checks the emission of a material: the factor alone, and the factor times each texel of its emission texture. If
    /// the factor is 0, the texture has no effect and is not checked.
    fn check_emission(&self, material: &Material) -> Result<()> {
        check_light("emission", material.emission)?;
        let texture = material.emission_texture.and_then(|reference| self.textures.get(reference.texture));
        match texture {
            Some(texture) if material.emission != Vec3::ZERO => {
                check_texels("emission_texture times emission", &texture.image, material.emission)
            }
            _ => Ok(()),
        }
    }

    fn check_punctual_light(&self, light: &PunctualLight) -> Result<()> {
        match *light {
            PunctualLight::Point { intensity, .. } | PunctualLight::Spot { intensity, .. } => {
                check_light("intensity", intensity)
            }
            PunctualLight::Directional { illuminance, .. } => check_light("illuminance", illuminance),
            PunctualLight::Luminaire { colour, distribution, .. } => {
                let candela = self.distributions.get(distribution).map_or(&[][..], |d| &d.candela);
                let peak = candela.iter().copied().fold(0.0, f64::max);
                check_light("intensity (colour times the distribution)", colour * peak as f32)?;
                match light.opening(&self.distributions) {
                    None => Ok(()),
                    Some(opening) => {
                        let luminance = colour * (peak / opening.largest_area()) as f32;
                        check_light("luminance (intensity divided by the luminous area)", luminance)
                    }
                }
            }
        }
    }
}

/// Checks that each texel of an image times `factor` is at most [`MAX_LIGHT`]. Where a channel of `factor` is 0, that
/// channel of the image may have any finite value. `what` names the product in the error.
fn check_texels(what: &str, image: &Image, factor: Vec3) -> Result<()> {
    let limits: [f32; 3] = factor.to_array().map(|f| if f > 0.0 { MAX_LIGHT / f } else { f32::MAX });
    for i in 0..image.width * image.height {
        let (x, y) = (i % image.width, i / image.width);
        let value = image.rgb(x, y);
        if !value.to_array().iter().zip(limits).all(|(value, limit)| *value <= limit) {
            let value = value.max_element();
            return Err(Error::argument(format!(
                "{what} is {value:e} times {factor} at pixel ({x}, {y}); each channel must be at most {MAX_LIGHT:e}"
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_channel_of_a_product_has_the_limit_also_where_the_image_is_grey() {
        for channels in [1, 3] {
            let image = Image::from_fn(2, 2, |x, _| [if x == 0 { 1.0 } else { 10.0 }; 3]).unwrap();
            let image = if channels == 1 { image.channel(0).unwrap() } else { image };
            let check = |factor| check_texels("light", &image, factor);
            assert!(check(Vec3::splat(0.09 * MAX_LIGHT)).is_ok());
            assert!(check(Vec3::new(0.0, 0.0, 0.09 * MAX_LIGHT)).is_ok());
            for factor in [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| axis * (0.11 * MAX_LIGHT)) {
                assert!(check(factor).unwrap_err().message.contains("at pixel (1, 0)"), "{channels} {factor}");
            }
        }
    }
}
