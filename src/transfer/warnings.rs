//! Collects the warnings of all stages of a transfer.

use super::{Results, Stage};
use crate::rectify;
use crate::segment::{self, StrokeSet};
use crate::warning::Warning;

impl Results {
    /// Returns the warnings about the results that exist, each with the stage of the result, in the order of the
    /// stages. If the stage Emission has run, the warnings of the scene precede them, with `None` instead of a stage.
    /// `strokes` are the strokes from which the masks were made.
    pub fn warnings(&self, strokes: &StrokeSet) -> Vec<(Option<Stage>, Warning)> {
        let mut all = Vec::new();
        if let Some(lit) = &self.unsolved {
            all.extend(lit.scene.warnings().into_iter().map(|warning| (None, warning)));
        }
        let mut add = |stage, list: Vec<Warning>| all.extend(list.into_iter().map(|warning| (Some(stage), warning)));
        if let Some(view) = &self.view {
            add(Stage::View, view.warnings());
        }
        if let Some(features) = &self.features {
            add(Stage::Features, features.warnings());
        }
        if let Some(plane) = &self.plane {
            add(Stage::Plane, plane.warnings());
            add(Stage::Plane, plane.missed(strokes.plane_strokes()).into_iter().collect());
        }
        if let Some(lights) = &self.lights {
            add(Stage::Lights, lights.warnings());
            add(Stage::Lights, lights.missed(strokes.lights.iter()).into_iter().collect());
        }
        if let (Some(features), Some(_)) = (&self.features, &self.lights) {
            let dim = segment::dim_lamps(&features.image, &strokes.plane, &strokes.lights);
            add(Stage::Lights, dim.into_iter().collect());
        }
        if let (Some(plane), Some(lights)) = (&self.plane, &self.lights) {
            add(Stage::Lights, segment::almost_all_lit(&lights.mask, &plane.mask).into_iter().collect());
        }
        if let Some(unwarped) = &self.unwarped {
            add(Stage::Unwarp, unwarped.warnings());
        }
        if let (Some(lights), Some(unwarped)) = (&self.lights, &self.unwarped) {
            add(Stage::Unwarp, rectify::off_plane(&lights.mask, unwarped).into_iter().collect());
        }
        if let Some(emission) = &self.emission {
            add(Stage::Emission, emission.warnings());
        }
        if let Some(solution) = &self.solution {
            add(Stage::Relight, solution.warnings());
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Homography;
    use crate::image::Image;
    use crate::rectify::Unwarped;
    use crate::scene::surface::{self, Placed};
    use crate::scene::{Mesh, Scene};
    use crate::segment::Segmentation;
    use crate::transfer::LitScene;
    use crate::warning::Code;
    use glam::{DMat3, DVec2, DVec3, Vec3};
    use std::sync::Arc;

    /// Returns the warnings about an image ten columns wide. The mask of the plane covers columns `0..plane`, and the
    /// mask of the lights covers columns `0..lights`.
    fn codes(plane: usize, lights: usize) -> Vec<(Option<Stage>, Code)> {
        let mask = |columns: usize| {
            let mask = Image::from_fn(10, 4, |x, _| [f32::from(x < columns)]).unwrap();
            Some(Arc::new(Segmentation::from_confidence(&mask).unwrap()))
        };
        let results = Results { plane: mask(plane), lights: mask(lights), ..Results::default() };
        results.warnings(&StrokeSet::default()).into_iter().map(|(stage, warning)| (stage, warning.code)).collect()
    }

    #[test]
    fn each_warning_has_its_stage_in_the_order_of_the_stages() {
        assert_eq!(Results::default().warnings(&StrokeSet::default()), []);
        assert_eq!(codes(8, 2), []);
        assert_eq!(codes(8, 7), [(Some(Stage::Lights), Code::AlmostAllLit)]);
        assert_eq!(codes(0, 0), [(Some(Stage::Plane), Code::EmptyMask), (Some(Stage::Lights), Code::EmptyMask)]);
    }

    #[test]
    fn lamps_off_the_plane_are_a_warning_of_the_unwarping() {
        // The plane recedes towards the right, but a row of lamps keeps its size in the photo.
        let row = Image::from_fn(400, 20, |x, y| [f32::from(x % 40 < 20 && (5..15).contains(&y))]).unwrap();
        let to_plane = Homography(DMat3::from_cols(DVec3::new(1.0, 0.0, -0.002), DVec3::Y, DVec3::Z));
        let unwarped = Unwarped {
            image: Image::new(4, 4, 3).unwrap(),
            valid: Image::from_fn(4, 4, |_, _| [1.0]).unwrap(),
            to_photo: to_plane.inverse().into(),
            pixel_size: 0.01,
            corners: [DVec2::ZERO; 4],
            aspect_confidence: 1.0,
            corner_error: [0.0; 4],
        };
        let results = Results {
            lights: Some(Arc::new(Segmentation::from_confidence(&row).unwrap())),
            unwarped: Some(Arc::new(unwarped)),
            ..Results::default()
        };
        let list = results.warnings(&StrokeSet::default());
        assert!(list.iter().any(|(stage, warning)| (*stage, warning.code) == (Some(Stage::Unwarp), Code::OffPlane)));
    }

    #[test]
    fn warnings_of_the_scene_belong_to_no_stage_and_come_first() {
        let results = |height: f32, origin: DVec3| {
            let wall = Mesh::parallelogram(Vec3::ZERO, Vec3::X * height, Vec3::Y * height, 0);
            let scene = Scene { meshes: vec![wall], origin, ..Scene::default() };
            let surface = surface::from_triangles(&scene, &[(0, 0), (0, 1)]).unwrap();
            let placed = Placed { mesh: 0, material: 0 };
            let mask = Image::new(10, 4, 1).unwrap();
            Results {
                unsolved: Some(Arc::new(LitScene {
                    scene: Arc::new(scene),
                    surface,
                    placed,
                    others: vec![],
                    texel_size: 0.01,
                })),
                plane: Some(Arc::new(Segmentation::from_confidence(&mask).unwrap())),
                ..Results::default()
            }
        };
        let codes = |height, origin| -> Vec<_> {
            let warnings = results(height, origin).warnings(&StrokeSet::default());
            warnings.into_iter().map(|(stage, warning)| (stage, warning.code)).collect()
        };
        let empty = (Some(Stage::Plane), Code::EmptyMask);
        assert_eq!(codes(2.7, DVec3::ZERO), [empty]);
        assert_eq!(codes(2700.0, DVec3::ZERO), [(None, Code::ImplausibleSize), empty]);
        assert_eq!(codes(2.7, DVec3::splat(1e6)), [(None, Code::FarFromOrigin), empty]);
    }
}
