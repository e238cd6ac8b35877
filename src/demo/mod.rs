//! Self-contained demonstration data. For the lighting transfer: two generated rooms, and a photo of one of them. For
//! the stylisation: a sphere on a table, artworks of this scene, and a still life.
//!
//! [`target_room`] is the furnished room to be lit; it has no lights. [`exemplar_room`] is a different room, an office
//! under a grid of luminaires whose positions and colour are known. A rendering of the office can serve as the
//! exemplar photo, and results can be compared with the known truth.
//!
//! [`sphere_on_table`] is the exemplar scene of a stylisation, [`artwork`] draws it in three techniques, and
//! [`still_life`] is the target scene.
//!
//! Coordinates are in metres, with Y up and floors at y = 0. Nothing is loaded from files: shapes are boxes, sheets
//! and bodies of revolution, and textures are noise. The result is the same to the bit every time.

pub mod artwork;
mod furniture;
mod office;
mod pattern;
pub mod photo;
mod room;
mod shapes;
mod still_life;
mod strokes;

pub use office::{Exemplar, LuminaireGrid, exemplar_room};
pub use room::target_room;
pub use still_life::{sphere_on_table, still_life};
pub use strokes::{drawing, strokes};

use crate::error::Result;
use crate::image::Image;
use crate::scene::{Material, Mesh, Scene, Texture, TextureRef};
use glam::{Mat3, Vec2, Vec3};

/// A scene under construction.
#[derive(Default)]
struct Builder {
    scene: Scene,
}

impl Builder {
    /// Adds a material of one colour and returns its index.
    fn paint(&mut self, name: &str, colour: Vec3, roughness: f32) -> usize {
        self.scene.materials.push(Material { roughness, ..Material::diffuse(name, colour) });
        self.scene.materials.len() - 1
    }

    /// Adds a material with a pattern that repeats every `period` metres, and returns its index.
    fn pattern(&mut self, name: &str, image: Image, period: Vec2, roughness: f32) -> usize {
        self.scene.textures.push(Texture::new(name, image));
        let transform = Mat3::from_scale(period.recip());
        let texture = TextureRef { transform, ..TextureRef::new(self.scene.textures.len() - 1) };
        let material = self.paint(name, Vec3::ONE, roughness);
        self.scene.materials[material].base_color_texture = Some(texture);
        material
    }

    fn add(&mut self, name: &str, material: usize, mesh: Mesh) {
        self.scene.meshes.push(Mesh { name: name.into(), material, ..mesh });
    }

    /// Validates the scene and returns it.
    fn build(self) -> Result<Scene> {
        self.scene.validate()?;
        Ok(self.scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{gltf, surface};

    fn triangles(scene: &Scene) -> usize {
        scene.meshes.iter().map(|m| m.triangles.len()).sum()
    }

    fn assert_inside(scene: &Scene, size: Vec3) {
        for mesh in &scene.meshes {
            for p in &mesh.positions {
                let inside = p.cmpge(Vec3::splat(-0.2)).all() && p.cmple(size + 0.2).all();
                assert!(inside, "{} reaches {p}", mesh.name);
            }
        }
        for camera in &scene.cameras {
            assert!(camera.position.cmpgt(Vec3::splat(0.05)).all() && camera.position.cmplt(size - 0.05).all());
        }
    }

    #[test]
    fn the_target_room_is_furnished_and_dark() {
        let scene = target_room().unwrap();
        let count = triangles(&scene);
        assert!((5_000..40_000).contains(&count), "{count} triangles");
        assert_inside(&scene, Vec3::new(6.0, 2.8, 4.0));
        assert!(scene.lights.is_empty() && scene.environment.is_none());
        assert!(scene.materials.iter().all(|m| m.emission == Vec3::ZERO));
        assert!(scene.cameras[0].name == "Camera");
        let ceiling = surface::find(&scene, "Ceiling").unwrap();
        assert!(ceiling.normal == Vec3::NEG_Y && (ceiling.area - 24.0).abs() < 1e-3, "{ceiling:?}");
        let glb = gltf::export(&scene).unwrap();
        let again = gltf::import(&glb, None, gltf::Options::default()).unwrap();
        for (a, b) in again.meshes.iter().zip(&scene.meshes) {
            assert!((&a.name, &a.positions, &a.triangles, &a.uvs) == (&b.name, &b.positions, &b.triangles, &b.uvs));
        }
        assert_eq!(again.meshes.len(), scene.meshes.len());
    }

    #[test]
    fn the_exemplar_room_has_its_luminaires_where_the_truth_says() {
        let exemplar = exemplar_room().unwrap();
        let (scene, grid) = (&exemplar.scene, &exemplar.grid);
        assert_inside(scene, Vec3::new(5.4, 2.7, 9.0));
        let lamps = scene.meshes.iter().find(|m| m.name == "Luminaires").unwrap();
        let lamp = &scene.materials[lamps.material];
        assert_eq!(lamp.emission, grid.emission);
        // Every centre that the grid states lies in an emitting triangle, and the areas of the emitting triangles sum
        // to the areas of the grid's luminaires.
        let mut area = 0.0;
        for t in 0..lamps.triangles.len() {
            let [a, b, c] = lamps.corners(t);
            let across = (b - a).cross(c - a);
            assert!(across.y < 0.0 && across.x == 0.0 && across.z == 0.0, "luminaires face down");
            assert_eq!(a.y, exemplar.ceiling_height);
            area += across.length() / 2.0;
        }
        let centres: Vec<Vec2> = grid.centres().collect();
        assert_eq!(centres.len(), grid.columns * grid.rows);
        assert!((area - centres.len() as f32 * grid.size.element_product()).abs() < 1e-3);
        for centre in centres {
            let covered = (0..lamps.triangles.len()).any(|t| {
                let middle = lamps.corners(t).iter().map(|p| Vec2::new(p.x, p.z)).sum::<Vec2>() / 3.0;
                (middle - centre).abs().cmplt(grid.size / 2.0).all()
            });
            assert!(covered, "nothing at {centre}");
        }
        let luminance = crate::image::colour::luminance(grid.emission);
        assert!((luminance - 3000.0).abs() < 30.0, "{luminance}");
        assert!(scene.cameras[exemplar.camera].forward.y > 0.3, "pitched up");
    }
}
