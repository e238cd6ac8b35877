//! Changes the emission of a material.

use super::Scene;
use crate::image::colour::luminance;
use glam::Vec3;

impl Scene {
    /// Makes the light of a material's emission texture white; each texel keeps its luminance. Without a texture,
    /// nothing changes.
    pub fn whiten_emission(&mut self, material: usize) {
        let material = &mut self.materials[material];
        let Some(map) = material.emission_texture else { return };
        for pixel in self.textures[map.texture].image.data.chunks_exact_mut(3) {
            pixel.fill(luminance(Vec3::from_slice(pixel) * material.emission));
        }
        material.emission = Vec3::ONE;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::scene::{Material, Texture, TextureRef};

    #[test]
    fn texels_become_white_and_keep_their_luminance() {
        let image = Image::from_fn(2, 1, |x, _| if x == 0 { [1.0, 0.5, 0.25] } else { [0.0; 3] }).unwrap();
        let lamp = Material {
            emission: Vec3::new(2.0, 4.0, 8.0),
            emission_texture: Some(TextureRef::new(0)),
            ..Material::diffuse("Lamp", Vec3::ONE)
        };
        let plain = Material { emission: Vec3::X, ..Material::diffuse("Plain", Vec3::ONE) };
        let textures = vec![Texture::new("Lamps", image)];
        let mut scene = Scene { materials: vec![lamp, plain.clone()], textures, ..Scene::default() };
        scene.whiten_emission(0);
        scene.whiten_emission(1);
        // Texture times factor was (2, 2, 2): its luminance is 2.
        let texels = &scene.textures[0].image.data;
        assert!(texels[..3].iter().all(|v| (v - 2.0).abs() < 1e-6) && texels[3..] == [0.0; 3], "{texels:?}");
        assert_eq!((scene.materials[0].emission, &scene.materials[1]), (Vec3::ONE, &plain));
    }
}
