//! Upper bounds on the emission, lights and environment of a scene, so that sums over pixels cannot overflow `f32`.

use super::light::{MAX_LIGHT, check_light};
use super::{Environment, Material, PunctualLight, Scene};
use crate::error::{Error, Result};
use crate::image::Image;
use glam::Vec3;

impl Scene {
    /// Checks the luminance of every emissive material and of the environment, with their textures, and the intensity
    /// or illuminance of every punctual light. The error names the first material or light that is too bright, its
    /// value and the allowed range.
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

    /// Checks the emission of a material: the factor alone, and the factor times each texel of its emission texture.
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
    let colours = image.channels.min(3);
    for (i, pixel) in image.data.chunks_exact(image.channels.max(1)).enumerate() {
        let is_allowed = |(value, limit): (&f32, f32)| *value <= limit;
        if !pixel[..colours].iter().zip(limits.iter().copied()).all(is_allowed) {
            let (x, y) = (i % image.width, i / image.width);
            let value = pixel[..colours].iter().copied().fold(0.0, f32::max);
            return Err(Error::argument(format!(
                "{what} is {value:e} times {factor} at pixel ({x}, {y}); each channel must be at most {MAX_LIGHT:e}"
            )));
        }
    }
    Ok(())
}
