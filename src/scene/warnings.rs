//! Reasons to doubt that a scene is rendered as its author intended.

use super::Scene;
use crate::warning::{Code, Warning};
use glam::Vec3;

/// Maximum height in metres of a plausible scene. [convention]: few interiors are higher, and rooms of 2 to 4 m would
/// be 79 to 157 in inches, and more in smaller units.
pub const MAX_HEIGHT: f64 = 50.0;

/// Height of a usual room in metres, from which the likely unit is derived. [convention]
const USUAL_HEIGHT: f64 = 3.0;

/// Units of modelling programs, in metres. [convention]
const UNITS: [(&str, f64); 3] = [("millimetre", 0.001), ("centimetre", 0.01), ("inch", 0.0254)];

impl Scene {
    pub fn warnings(&self) -> Vec<Warning> {
        let unrendered = self.unrendered.iter().map(|feature| {
            let advice =
                "compare a rendering with the program that wrote the file; bake the feature into meshes and textures";
            Warning::new(Code::NotRendered, feature.count as f64, 0.0, feature.to_string(), advice)
        });
        self.implausible_size().into_iter().chain(unrendered).collect()
    }

    /// A warning if the height suggests a unit other than the metre.
    fn implausible_size(&self) -> Option<Warning> {
        let (low, high) = self.bounds()?;
        let height = f64::from((high - low).y);
        let distance = |unit: f64| (height * unit / USUAL_HEIGHT).ln().abs();
        let (name, unit) = UNITS.into_iter().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
        let message = || {
            let likely = height * unit;
            format!("the scene is {height:.0} m high; its unit may be the {name}, with a height of {likely:.2} m")
        };
        let advice = format!("load it with unit = {unit} (luxfer_scene_load_params), or scale it where it was made");
        Warning::above(Code::ImplausibleSize, height, MAX_HEIGHT, message, &advice)
    }

    /// The corners of the bounding box of all triangles.
    fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let positions = self
            .meshes
            .iter()
            .flat_map(|mesh| mesh.triangles.iter().flatten().filter_map(|&i| mesh.positions.get(i as usize).copied()));
        let finite = positions.filter(|p| p.is_finite());
        finite.fold(None, |bounds, p| {
            let (low, high) = bounds.unwrap_or((p, p));
            Some((low.min(p), high.max(p)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use crate::scene::unrendered::note;

    /// A wall of the given height.
    fn room(height: f32) -> Scene {
        let wall = Mesh::parallelogram(Vec3::ZERO, Vec3::X * height, Vec3::Y * height, 0);
        Scene { meshes: vec![wall], ..Scene::default() }
    }

    #[test]
    fn a_room_in_another_unit_is_noticed_with_the_unit() {
        assert!(room(2.7).warnings().is_empty() && room(48.0).warnings().is_empty());
        assert!(Scene::default().warnings().is_empty());
        for (height, unit) in [(2700.0, "0.001"), (4000.0, "0.001"), (250.0, "0.01"), (400.0, "0.01"), (96.0, "0.0254")]
        {
            let warnings = room(height).warnings();
            assert_eq!(warnings.len(), 1, "{height}");
            let warning = &warnings[0];
            assert_eq!((warning.code, warning.severity), (Code::ImplausibleSize, f64::from(height)));
            assert!(warning.advice.contains(&format!("unit = {unit} ")), "{height}: {warning}");
        }
    }

    #[test]
    fn each_feature_that_is_not_rendered_is_a_warning() {
        let mut scene = room(3.0);
        note(&mut scene.unrendered, "skins", "no pose", || "node 1".into());
        note(&mut scene.unrendered, "skins", "no pose", || "node 2".into());
        note(&mut scene.unrendered, "COLOR_0", "one colour", || "mesh 1".into());
        let warnings = scene.warnings();
        assert_eq!(
            warnings.iter().map(|w| (w.code, w.severity)).collect::<Vec<_>>(),
            [(Code::NotRendered, 2.0), (Code::NotRendered, 1.0)]
        );
        assert!(warnings[0].message.contains("node 1, node 2"));
    }
}
