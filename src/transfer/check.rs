//! Checks before a run that everything it needs exists and is valid: the settings of its stages, its inputs, and the
//! earlier results that it uses.

use super::{Params, Stage, Transfer};
use crate::error::{Error, ErrorKind, Result, check_range};
use crate::scene::Scene;
use crate::scene::surface::{self, Surface};
use glam::DVec4;

impl Transfer {
    /// Checks a run of the stages `from..=to`; takes negligible time.
    ///
    /// # Errors
    /// - `InvalidArgument`: `from` comes after `to`, or a setting is out of range.
    /// - `InvalidOperation`: an input or an earlier result is missing.
    pub fn check(&self, from: Stage, to: Stage) -> Result<()> {
        if from > to {
            return Err(Error::argument(format!("the run is from stage {from:?} to {to:?}; it must go forwards")));
        }
        let run = super::STAGES.into_iter().filter(|stage| (from..=to).contains(stage));
        let mut made = super::STAGES.map(|stage| self.has_made(stage));
        for stage in run {
            let in_stage = |e: Error| e.context(format_args!("stage {stage:?}"));
            self.params.check(stage).map_err(in_stage)?;
            self.check_inputs(stage).map_err(in_stage)?;
            if let Some(before) = self.stages_before(stage).iter().find(|before| !made[**before as usize]) {
                return Err(in_stage(missing(&format!("run stage {before:?}"))));
            }
            made[stage as usize] = true;
        }
        Ok(())
    }

    /// If the run includes [`Stage::Emission`], checks that the scene has the surface that receives the lights.
    pub(super) fn check_surface(&self, from: Stage, to: Stage) -> Result<()> {
        match &self.input.scene {
            Some(scene) if (from..=to).contains(&Stage::Emission) => self.find_surface(scene).map(drop),
            _ => Ok(()),
        }
    }

    /// Finds the plane of the scene that receives the lights. Parts of a ceiling that lie in one plane, such as the
    /// parts between beams, form one surface and share one pattern, even if they belong to different objects. Parts in
    /// other planes get no lights.
    pub(super) fn find_surface(&self, scene: &Scene) -> Result<Surface> {
        match self.input.triangles[..] {
            [] => surface::find(scene, &self.input.surface),
            ref triangles => surface::from_triangles(scene, triangles),
        }
    }

    fn has_made(&self, stage: Stage) -> bool {
        let results = &self.results;
        match stage {
            Stage::View => results.view.is_some(),
            Stage::Features => results.features.is_some(),
            Stage::Plane => results.plane.is_some(),
            Stage::Lights => results.lights.is_some(),
            Stage::Unwarp => results.unwarped.is_some(),
            Stage::Emission => results.unsolved.is_some(),
            Stage::Relight => results.lit.is_some(),
            Stage::Render => results.film.is_some(),
        }
    }

    fn check_inputs(&self, stage: Stage) -> Result<()> {
        let own_texture = self.input.texture.is_some();
        let reads_photo = !matches!(stage, Stage::Plane | Stage::Lights | Stage::Render);
        if reads_photo && !(stage == Stage::Emission && own_texture) && self.input.photo.is_none() {
            return Err(missing("set the photo"));
        }
        if stage == Stage::Emission {
            check_zones(&self.input.zones)?;
        }
        if stage == Stage::Emission && self.input.scene.is_none() {
            return Err(missing("set the scene"));
        }
        Ok(())
    }

    /// The stages whose results a stage needs. Features use a view if there is one, but do not need it.
    fn stages_before(&self, stage: Stage) -> &'static [Stage] {
        match stage {
            Stage::View | Stage::Features => &[],
            Stage::Plane => &[Stage::Features],
            Stage::Lights => &[Stage::Features, Stage::Plane],
            Stage::Unwarp => &[Stage::View, Stage::Plane],
            Stage::Emission if self.input.texture.is_some() => &[],
            Stage::Emission => &[Stage::Lights, Stage::Unwarp],
            Stage::Relight => &[Stage::Plane, Stage::Lights, Stage::Emission],
            Stage::Render => &[Stage::Relight],
        }
    }
}

impl Params {
    /// Checks the settings of one stage.
    pub(crate) fn check(&self, stage: Stage) -> Result<()> {
        match stage {
            Stage::View => self.rectify.check(),
            Stage::Features => self.features.check(),
            Stage::Plane => self.plane.check(),
            Stage::Lights => self.lights.check(),
            Stage::Unwarp => self.unwarp.check(),
            Stage::Emission => {
                if self.plane_distance != 0.0 {
                    check_range("plane_distance", self.plane_distance, 0.01, 1e4)?;
                }
                self.pattern.check()?;
                check_range("max_texels", self.max_texels, 1, 16_384)?;
                check_range("white_luminance", self.white_luminance, 1e-6, 1e9)?;
                self.emission.check()
            }
            Stage::Relight => {
                check_range("white_luminance", self.white_luminance, 1e-6, 1e9)?;
                self.relight.check()
            }
            Stage::Render => self.render.check(),
        }
    }
}

/// Checks the keep-out rectangles of [`super::Input::zones`].
pub fn check_zones(zones: &[DVec4]) -> Result<()> {
    match zones.iter().position(|z| !(z.is_finite() && z.x <= z.z && z.y <= z.w)) {
        Some(i) => {
            let zone = zones[i];
            let message = format!("zone {i} is {zone}; it must be finite, u0, v0, u1, v1 with u0 <= u1 and v0 <= v1");
            Err(Error::argument(message))
        }
        None => Ok(()),
    }
}

/// Makes the error for a missing input or result; `what` tells how to provide it.
pub(super) fn missing(what: &str) -> Error {
    Error::new(ErrorKind::InvalidOperation, format!("{what} first"))
}

/// Returns the value, or an error if it is missing; `what` tells how to provide it.
pub(super) fn need<'a, T>(value: &'a Option<T>, what: &str) -> Result<&'a T> {
    value.as_ref().ok_or_else(|| missing(what))
}
