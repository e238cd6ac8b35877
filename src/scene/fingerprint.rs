//! A hash that identifies a scene across machines and runs.

use super::{Environment, Mesh, Scene, Texture};
use crate::image::Image;
use crate::rng;
use glam::DVec3;
use std::fmt::{self, Debug, Write};

impl Scene {
    /// Returns a hash of everything in the scene except its cameras and the list of unrendered features. Two different
    /// scenes collide with probability 2^-64. The hash offers no protection against forgery, and it may change between
    /// versions of the library.
    pub fn fingerprint(&self) -> u64 {
        let Self {
            origin,
            meshes,
            materials,
            textures,
            lights,
            distributions,
            environment,
            sun: _,
            cameras: _,
            unrendered: _,
        } = self;
        let mut digest = Digest(0);
        for Mesh { name, material, positions, normals, uvs: [first, second], colours, triangles } in meshes {
            digest.text(&(name, material));
            digest.array(positions);
            digest.array(normals);
            digest.array(first);
            digest.array(second);
            digest.array(colours);
            digest.array(triangles);
        }
        for Texture { name, image, wrap } in textures {
            digest.text(&(name, wrap));
            digest.image(image);
        }
        digest.text(&(materials, lights, distributions));
        if *origin != DVec3::ZERO {
            digest.text(origin);
        }
        match environment {
            None => digest.text(&"dark"),
            Some(Environment::Constant(radiance)) => digest.text(radiance),
            Some(Environment::Image(image)) => digest.image(image),
        }
        digest.0
    }
}

struct Digest(u64);

impl Digest {
    fn word(&mut self, word: u64) {
        self.0 = (self.0 ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
    }

    fn bytes(&mut self, bytes: &[u8]) {
        let (words, rest) = bytes.as_chunks::<8>();
        words.iter().for_each(|&word| self.word(u64::from_le_bytes(word)));
        let mut last = [0; 8];
        last[..rest.len()].copy_from_slice(rest);
        self.word(u64::from_le_bytes(last));
        self.0 = rng::mix(self.0 ^ bytes.len() as u64);
    }

    fn array<T: bytemuck::NoUninit>(&mut self, values: &[T]) {
        self.bytes(bytemuck::cast_slice(values));
    }

    fn image(&mut self, Image { width, height, channels, data }: &Image) {
        self.text(&(width, height, channels));
        self.array(data);
    }

    /// Hashes a small value by its `Debug` text: this text has all digits of floats, and fields added later are hashed
    /// without a change here.
    fn text(&mut self, value: &dyn Debug) {
        // Ignore the result: `write_str` of the digest never fails.
        let _ = writeln!(self, "{value:?}");
    }
}

impl Write for Digest {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.bytes(text.as_bytes());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Material, PunctualLight};
    use glam::Vec3;

    #[test]
    fn every_part_of_a_scene_counts_but_its_cameras() {
        let image = Image::from_fn(3, 2, |x, y| [x as f32, y as f32, 0.5]).unwrap();
        let scene = Scene {
            meshes: vec![Mesh::parallelogram(Vec3::ZERO, Vec3::X, Vec3::Z, 0)],
            materials: vec![Material::default()],
            textures: vec![Texture::new("paper", image.clone())],
            lights: vec![PunctualLight::Point { position: Vec3::Y, intensity: Vec3::ONE }],
            environment: Some(Environment::Image(image)),
            ..Scene::default()
        };
        let changed = |change: &dyn Fn(&mut Scene)| {
            let mut scene = scene.clone();
            change(&mut scene);
            scene.fingerprint()
        };
        let original = changed(&|_| ());
        let look = |s: &mut Scene| s.cameras.push(Camera::look_at(Vec3::ZERO, Vec3::Z, 1.0));
        assert_eq!(original, changed(&look));
        let changes: [&dyn Fn(&mut Scene); 14] = [
            &|s| s.origin.x = 256.0,
            &|s| s.meshes[0].name.push('x'),
            &|s| s.meshes[0].material = 1,
            &|s| s.meshes[0].positions[3].z = 1.0f32.next_up(),
            &|s| s.meshes[0].normals = vec![Vec3::Y; 4],
            &|s| s.meshes[0].uvs.swap(0, 1),
            &|s| s.meshes[0].colours = vec![glam::Vec4::ONE; s.meshes[0].positions.len()],
            &|s| s.meshes[0].triangles.swap(0, 1),
            &|s| s.materials[0].roughness -= 1e-6,
            &|s| s.textures[0].image.data[17] = -0.0,
            &|s| s.textures[0].wrap[1] = crate::scene::Wrap::Clamp,
            &|s| s.lights.clear(),
            &|s| s.environment = None,
            &|s| s.meshes.push(Mesh::default()),
        ];
        let mut seen = vec![original];
        seen.extend(changes.map(changed));
        seen.sort_unstable();
        assert!(seen.windows(2).all(|pair| pair[0] != pair[1]), "{seen:x?}");
    }
}
