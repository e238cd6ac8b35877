//! Collects the warnings of all stages of a transfer.

use super::{Results, Stage};
use crate::segment::{self, StrokeSet};
use crate::warning::Warning;

impl Results {
    /// Returns the warnings about the existing results, in the order of the stages, each with its stage. `strokes` are
    /// the strokes from which the masks were made.
    pub fn warnings(&self, strokes: &StrokeSet) -> Vec<(Stage, Warning)> {
        let mut all = Vec::new();
        let mut add = |stage, list: Vec<Warning>| all.extend(list.into_iter().map(|warning| (stage, warning)));
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
        if let Some(emission) = &self.emission {
            add(Stage::Emission, emission.warnings());
        }
        if let Some(lit) = &self.unsolved {
            add(Stage::Emission, lit.scene.implausible_size().into_iter().collect());
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
    use crate::image::Image;
    use crate::segment::Segmentation;
    use crate::warning::Code;
    use std::sync::Arc;

    /// Returns the warnings about an image ten columns wide. The mask of the plane covers columns `0..plane`, that of
    /// the lights `0..lights`.
    fn codes(plane: usize, lights: usize) -> Vec<(Stage, Code)> {
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
        assert_eq!(codes(8, 7), [(Stage::Lights, Code::AlmostAllLit)]);
        assert_eq!(codes(0, 0), [(Stage::Plane, Code::EmptyMask), (Stage::Lights, Code::EmptyMask)]);
    }
}
