//! Runs the transfers of several planes of one photo together, such as a ceiling and a wall with sconces.
//!
//! - The camera and the features are computed once for all planes whose settings for them are equal. If the room is
//!   laid out from the photo, one box agrees best with the strokes of all planes. If the lamps correct the camera,
//!   those of the plane with the most lit pixels decide.
//! - Each plane has its own masks, unwarped image and texture. A room that is enlarged for lamps beyond a plane is
//!   enlarged for this plane alone.
//! - All textures are placed in one scene. The stage Relight solves for the light of all planes together, because the
//!   lamps of each plane also light the others ([`relight::run_together`]).
//!
//! The results do not depend on the order of the transfers.

use super::check::{missing, need};
use super::stages::{ENLARGEMENTS, LAMP_ROUNDS, MadeTexture};
use super::{LitScene, Results, STAGES, Stage, Transfer, WEIGHTS};
use crate::error::{Error, Result};
use crate::image::Image;
use crate::job::Job;
use crate::render::World;
use crate::scene::surface;
use crate::{features, relight, render};
use glam::Vec3;
use std::cmp::Ordering;
use std::sync::Arc;
use std::time::Instant;

/// Maximum number of transfers that run together.
pub const MAX_PLANES: usize = relight::MAX_EMITTERS;

/// Checks a run of several transfers, as [`Transfer::check`] does for one.
///
/// # Errors
/// Those of [`Transfer::check`], with the index of the transfer; `InvalidArgument` if there are none or too many, if
/// the photos or the scenes differ, or, if the run includes the stage Relight, settings that are solved for together.
pub fn check_together(planes: &[Transfer], from: Stage, to: Stage) -> Result<()> {
    if planes.is_empty() || planes.len() > MAX_PLANES {
        let count = planes.len();
        return Err(Error::argument(format!("there are {count} transfers; there must be 1 to {MAX_PLANES}")));
    }
    for (k, plane) in planes.iter().enumerate() {
        plane.check(from, to).map_err(|e| named(k, e))?;
        plane.check_like(&planes[0], from, to).map_err(|e| named(k, e))?;
    }
    Ok(())
}

/// Runs the stages `from..=to` of several transfers, which must have one photo and one scene. A single transfer runs as
/// [`Transfer::run`] does.
///
/// Calls `publish` with the index and the results of a transfer whenever they change. After a cancellation or an error,
/// the results contain everything that was finished. The message of an error names the transfer, unless it concerns all
/// of them.
pub fn run_together(
    planes: &mut [Transfer],
    from: Stage,
    to: Stage,
    job: Job,
    publish: &mut dyn FnMut(usize, &Results),
) -> Result<()> {
    check_together(planes, from, to)?;
    if let [plane] = planes {
        return plane.run(from, to, job, |results| publish(0, results));
    }
    let mut run = Run { planes, publish };
    if (from..=to).contains(&Stage::Emission) {
        run.check_surfaces()?;
    }
    let (first, last) = (from as usize, to as usize);
    let total: f64 = WEIGHTS[first..=last].iter().sum();
    let mut done = 0.0;
    for stage in &STAGES[first..=last] {
        let weight = WEIGHTS[*stage as usize] / total;
        let part = job.part(done, (done + weight).min(1.0));
        part.check()?;
        let clock = Instant::now();
        run.stage(*stage, part)?;
        if *stage == Stage::Lights && from <= Stage::Features {
            run.look_again(part)?;
        }
        let seconds = clock.elapsed().as_secs_f64();
        for k in 0..run.planes.len() {
            run.planes[k].results.seconds[*stage as usize] = seconds;
            run.publish(k);
        }
        done = (done + weight).min(1.0);
        job.report(done);
    }
    job.report(1.0);
    Ok(())
}

/// Names the transfer in the message of an error.
fn named(index: usize, error: Error) -> Error {
    error.context(format_args!("transfers[{index}]"))
}

/// Whether two optional images are one image, or have equal values.
fn same_image(a: &Option<Arc<Image>>, b: &Option<Arc<Image>>) -> bool {
    let equal = |a: &Image, b: &Image| {
        (a.width, a.height, a.channels) == (b.width, b.height, b.channels)
            && a.data.iter().zip(&b.data).all(|(a, b)| a.to_bits() == b.to_bits())
    };
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b) || equal(a, b),
        (None, None) => true,
        _ => false,
    }
}

fn same_arc<T>(a: &Option<Arc<T>>, b: &Option<Arc<T>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    }
}

impl Transfer {
    /// Checks that the transfer can run together with another one.
    fn check_like(&self, other: &Self, from: Stage, to: Stage) -> Result<()> {
        if !same_image(&self.input.photo, &other.input.photo) {
            return Err(Error::argument(
                "the photo differs from that of transfers[0]; all planes must lie in one photo",
            ));
        }
        if !same_arc(&self.input.scene, &other.input.scene) {
            return Err(Error::argument(
                "the scene differs from that of transfers[0]; all planes must light one scene",
            ));
        }
        let places = from <= Stage::Relight && to >= Stage::Emission;
        if places && self.params.white_luminance != other.params.white_luminance {
            return Err(Error::argument(format!(
                "white_luminance is {}, but {} for transfers[0]; the photo has one white",
                self.params.white_luminance, other.params.white_luminance
            )));
        }
        let solves = (from..=to).contains(&Stage::Relight);
        if solves && self.params.relight.fit == relight::Fit::LeastSquares {
            return Err(Error::argument(
                "fit of relight is LUXFER_FIT_LEAST_SQUARES; several planes are fitted by their means, LUXFER_FIT_MEAN",
            ));
        }
        if solves && self.params.relight != other.params.relight {
            return Err(Error::argument("relight differs from that of transfers[0]; all planes are solved together"));
        }
        Ok(())
    }

    fn has_view_like(&self, other: &Self) -> bool {
        self.params.rectify == other.params.rectify && self.input.photo_focal == other.input.photo_focal
    }

    fn has_features_like(&self, other: &Self) -> bool {
        let depth = |transfer: &Self| transfer.input.depth.as_ref().map(|(image, _)| image.clone());
        let kind = |transfer: &Self| transfer.input.depth.as_ref().map(|(_, kind)| *kind);
        same_arc(&self.results.view, &other.results.view)
            && kind(self) == kind(other)
            && same_image(&depth(self), &depth(other))
            && self.params.features == other.params.features
    }

    fn has_picture_like(&self, other: &Self) -> bool {
        let scene = |transfer: &Self| transfer.results.lit.as_ref().map(|lit| lit.scene.clone());
        same_arc(&scene(self), &scene(other))
            && self.input.camera == other.input.camera
            && self.params.render == other.params.render
    }
}

/// A running job of several transfers.
struct Run<'a> {
    planes: &'a mut [Transfer],
    publish: &'a mut dyn FnMut(usize, &Results),
}

/// The part of a job that belongs to item `k` of `count`.
fn share(job: Job, k: usize, count: usize) -> Job {
    let at = |k: usize| (k as f64 / count as f64).min(1.0);
    job.part(at(k), at(k + 1))
}

impl Run<'_> {
    fn publish(&mut self, k: usize) {
        (self.publish)(k, &self.planes[k].results);
    }

    /// Runs a stage of all planes.
    fn stage(&mut self, stage: Stage, job: Job) -> Result<()> {
        match stage {
            Stage::View => self.find_views(job),
            Stage::Features => {
                self.planes.iter_mut().for_each(|plane| plane.results.forget_lamps());
                let all: Vec<usize> = (0..self.planes.len()).collect();
                self.compute_features(&all, job)
            }
            Stage::Plane => self.each(stage, job, Transfer::segment_plane),
            Stage::Lights => self.each(stage, job, Transfer::segment_lights),
            Stage::Unwarp => self.each(stage, job, Transfer::unwarp),
            Stage::Emission => self.synthesise(job),
            Stage::Relight => self.relight(job),
            Stage::Render => self.render(job),
        }
    }

    /// Adds the stage and the index of a plane to its error.
    fn at(&self, k: usize, stage: Stage, error: Error) -> Error {
        named(k, self.for_all(stage, error))
    }

    /// Adds the stage to an error that concerns all planes.
    fn for_all(&self, stage: Stage, error: Error) -> Error {
        self.planes[0].with_likely_unit(stage, error).context(format_args!("stage {stage:?}"))
    }

    /// Runs a stage that each plane has for itself.
    fn each(&mut self, stage: Stage, job: Job, work: fn(&mut Transfer, Job) -> Result<()>) -> Result<()> {
        let count = self.planes.len();
        for k in 0..count {
            work(&mut self.planes[k], share(job, k, count)).map_err(|e| self.at(k, stage, e))?;
            self.publish(k);
        }
        Ok(())
    }

    /// Divides planes into groups, such that all planes of a group are like its first.
    fn groups(&self, of: &[usize], are_alike: impl Fn(&Transfer, &Transfer) -> bool) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for &k in of {
            match groups.iter_mut().find(|group| are_alike(&self.planes[group[0]], &self.planes[k])) {
                Some(group) => group.push(k),
                None => groups.push(vec![k]),
            }
        }
        groups
    }

    fn all(&self) -> Vec<usize> {
        (0..self.planes.len()).collect()
    }

    fn find_views(&mut self, job: Job) -> Result<()> {
        let groups = self.groups(&self.all(), Transfer::has_view_like);
        for (g, group) in groups.iter().enumerate() {
            let first = group[0];
            let part = share(job, g, groups.len());
            self.planes[first].find_view(part).map_err(|e| self.at(first, Stage::View, e))?;
            for &k in &group[1..] {
                let view = self.planes[first].results.view.clone();
                let results = &mut self.planes[k].results;
                (results.view, results.view_by_lines, results.view_is_given) = (view, None, false);
            }
            group.iter().for_each(|&k| self.publish(k));
        }
        Ok(())
    }

    /// Computes the features of the given planes: once for all planes with equal views, depth maps and settings.
    fn compute_features(&mut self, of: &[usize], job: Job) -> Result<()> {
        let groups = self.groups(of, Transfer::has_features_like);
        for (g, group) in groups.iter().enumerate() {
            let part = share(job, g, groups.len());
            let first = group[0];
            let made = self.features_of(group, part).map_err(|e| self.at(first, Stage::Features, e))?;
            for (&k, features) in group.iter().zip(made) {
                self.planes[k].results.features = Some(Arc::new(features));
                self.publish(k);
            }
        }
        Ok(())
    }

    fn features_of(&self, group: &[usize], job: Job) -> Result<Vec<features::Features>> {
        let plane = &self.planes[group[0]];
        let strokes: Vec<_> = group.iter().map(|&k| self.planes[k].plane_evidence()).collect();
        let lists: Vec<&[features::PlaneStroke]> = strokes.iter().map(|list| &list[..]).collect();
        let photo = need(&plane.input.photo, "set the photo")?;
        let depth = plane.input.depth.as_ref().map(|(image, kind)| features::DepthMap { image, kind: *kind });
        let input = features::Input { photo, depth, room: plane.room(&[], None) };
        features::run_for_planes(&input, &lists, &plane.params.features, job)
    }

    /// Corrects the views by the lamps, and enlarges the rooms of planes with lamps beyond them, as
    /// [`Transfer::look_again`] does for one plane.
    fn look_again(&mut self, job: Job) -> Result<()> {
        for round in 0..LAMP_ROUNDS {
            let part = job.part(0.3 * f64::from(round), 0.3 * f64::from(round + 1));
            let changed = self.correct_views(part.part(0.0, 0.1))?;
            if changed.is_empty() {
                break;
            }
            self.compute_features(&changed, part.part(0.1, 0.5))?;
            for (i, &k) in changed.iter().enumerate() {
                self.segment(k, share(part.part(0.5, 1.0), i, changed.len()))?;
            }
        }
        let count = self.planes.len();
        for k in 0..count {
            for _ in 0..ENLARGEMENTS {
                let part = share(job.part(0.6, 1.0), k, count);
                if !self.planes[k].enlarge_room(part).map_err(|e| self.at(k, Stage::Lights, e))? {
                    break;
                }
            }
            self.publish(k);
        }
        Ok(())
    }

    fn segment(&mut self, k: usize, job: Job) -> Result<()> {
        self.planes[k].segment_plane(job.part(0.0, 0.5)).map_err(|e| self.at(k, Stage::Plane, e))?;
        self.planes[k].segment_lights(job.part(0.5, 1.0)).map_err(|e| self.at(k, Stage::Lights, e))
    }

    /// Replaces each view that the lamps of a plane contradict. If lamps of several planes contradict a view that they
    /// share, the plane with the most lit pixels decides. Returns the planes whose view was replaced.
    fn correct_views(&mut self, job: Job) -> Result<Vec<usize>> {
        let mut changed = Vec::new();
        for group in self.groups(&self.all(), |a, b| same_arc(&a.results.view, &b.results.view)) {
            let mut best: Option<(usize, crate::rectify::View)> = None;
            for &k in &group {
                let found = self.planes[k].corrected_view(job).map_err(|e| self.at(k, Stage::Lights, e))?;
                let lights = self.planes[k].results.lights.as_ref();
                let lit = lights.map_or(0, |lights| lights.mask.data.iter().filter(|v| **v > 0.5).count());
                let candidate = found.map(|view| (lit, view));
                let beats = |(lit, view): &(usize, crate::rectify::View)| match &best {
                    None => true,
                    Some((most, other)) => {
                        let focal = |view: &crate::rectify::View| view.perspective.focal;
                        lit.cmp(most).then(focal(view).total_cmp(&focal(other))) == Ordering::Greater
                    }
                };
                best = match candidate {
                    Some(candidate) if beats(&candidate) => Some(candidate),
                    _ => best,
                };
            }
            if let Some((_, view)) = best {
                let view = Arc::new(view);
                group.iter().for_each(|&k| self.planes[k].results.correct_view(view.clone()));
                changed.extend(group);
            }
        }
        Ok(changed)
    }

    /// Checks that the scene has the surface of each plane, and that no triangle belongs to two of them.
    fn check_surfaces(&self) -> Result<()> {
        let mut triangles = Vec::new();
        for (k, plane) in self.planes.iter().enumerate() {
            let scene = need(&plane.input.scene, "set the scene")?;
            let surface = plane.find_surface(scene).map_err(|e| named(k, e))?;
            triangles.extend(surface.triangles.into_iter().map(|triangle| (triangle, k)));
        }
        triangles.sort_unstable();
        match triangles.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            None => Ok(()),
            Some(pair) => {
                let (a, b) = (pair[0].1, pair[1].1);
                let message = format!("transfers[{a}] and transfers[{b}] light one surface; give each its own");
                Err(Error::argument(message))
            }
        }
    }

    /// Makes the texture of each plane, then places all of them in one scene.
    fn synthesise(&mut self, job: Job) -> Result<()> {
        let scene = need(&self.planes[0].input.scene, "set the scene")?.clone();
        let count = self.planes.len();
        let mut made: Vec<(usize, MadeTexture)> = Vec::with_capacity(count);
        for (k, plane) in self.planes.iter().enumerate() {
            let part = share(job, k, count);
            made.push((k, plane.make_texture(&scene, part).map_err(|e| self.at(k, Stage::Emission, e))?));
        }
        // Place the textures in the order of their triangles, so that the scene does not depend on the order of the
        // transfers.
        made.sort_by(|a, b| a.1.surface.triangles.cmp(&b.1.surface.triangles));
        let strength = Vec3::splat(self.planes[0].params.white_luminance);
        let lights = made.iter().map(|(_, made)| (&made.surface, made.emission.texture.clone(), strength)).collect();
        let mut lit = (*scene).clone();
        let placed = surface::place_all(&mut lit, lights).map_err(|e| self.for_all(Stage::Emission, e))?;
        let lit = Arc::new(lit);
        let materials: Vec<usize> = placed.iter().map(|placed| placed.material).collect();
        for ((k, made), placed) in made.into_iter().zip(placed) {
            let others = materials.iter().copied().filter(|m| *m != placed.material).collect();
            self.planes[k].results.keep(made, lit.clone(), placed, others);
            self.publish(k);
        }
        Ok(())
    }

    /// Solves for the light of all planes together.
    fn relight(&mut self, job: Job) -> Result<()> {
        let count = self.planes.len();
        let mut all: Vec<(usize, Arc<LitScene>, relight::PhotoColour)> = Vec::with_capacity(count);
        for (k, plane) in self.planes.iter().enumerate() {
            let target = plane.target(share(job.part(0.0, 0.02), k, count));
            let target = target.map_err(|e| self.at(k, Stage::Relight, e))?;
            let unsolved = need(&plane.results.unsolved, "run stage Emission").map_err(|e| named(k, e))?;
            let is_shared = all.first().is_none_or(|(_, first, _)| Arc::ptr_eq(&first.scene, &unsolved.scene));
            if !is_shared {
                return Err(named(k, missing("run stage Emission of all transfers in one job")));
            }
            all.push((k, unsolved.clone(), target));
        }
        if let Some((k, ..)) = all.iter().find(|(_, unsolved, _)| unsolved.others.len() + 1 != count) {
            return Err(named(*k, missing("run stage Relight of all transfers that stage Emission placed in one job")));
        }
        all.sort_by_key(|(_, unsolved, _)| unsolved.placed.material);
        let in_stage = |e: Error| self.for_all(Stage::Relight, e);
        let world = World::build(all[0].1.scene.clone(), job.part(0.02, 0.1)).map_err(in_stage)?;
        let triangles: Vec<_> = all.iter().map(|(_, unsolved, _)| unsolved.triangles()).collect();
        let params = &self.planes[0].params;
        let targets: Vec<relight::EmitterTarget> = all
            .iter()
            .zip(&triangles)
            .map(|((_, unsolved, target), triangles)| relight::EmitterTarget {
                emitter: unsolved.placed.material,
                target_triangles: triangles,
                target: target.colour * params.white_luminance,
                constraint: target.constraint,
            })
            .collect();
        let solutions = relight::run_together(&world, &targets, &params.relight, job.part(0.1, 1.0));
        let solutions = solutions.map_err(in_stage)?;

        // Multiply the strength of each texture by its solution, in one scene.
        let mut scene = (*all[0].1.scene).clone();
        for ((_, unsolved, _), solution) in all.iter().zip(&solutions) {
            scene.materials[unsolved.placed.material].emission *= solution.scale.as_vec3();
        }
        if scene.cameras.is_empty() {
            let widest =
                all.iter().map(|(_, unsolved, _)| &unsolved.surface).reduce(|a, b| if b.area > a.area { b } else { a });
            scene.cameras.extend(widest.map(|surface| render::overview_camera(&world, surface)));
        }
        let scene = Arc::new(scene);
        for ((k, unsolved, target), solution) in all.into_iter().zip(solutions) {
            let results = &mut self.planes[k].results;
            results.lit = Some(Arc::new(LitScene { scene: scene.clone(), ..(*unsolved).clone() }));
            (results.target, results.solution) = (Some(target.colour), Some(solution));
            self.publish(k);
        }
        Ok(())
    }

    /// Renders the pictures: once for all planes with equal cameras and settings.
    fn render(&mut self, job: Job) -> Result<()> {
        let groups = self.groups(&self.all(), Transfer::has_picture_like);
        for (g, group) in groups.iter().enumerate() {
            let (first, others) = (group[0], &group[1..]);
            let mut copies: Vec<(usize, Results)> =
                others.iter().map(|&k| (k, self.planes[k].results.clone())).collect();
            let publish = &mut *self.publish;
            let outcome = self.planes[first].render(share(job, g, groups.len()), &mut |results| {
                publish(first, results);
                for (k, copy) in &mut copies {
                    copy.film.clone_from(&results.film);
                    publish(*k, copy);
                }
            });
            // Keep the unfinished picture too if the rendering is cancelled or fails.
            let film = self.planes[first].results.film.clone();
            for &k in others {
                self.planes[k].results.film.clone_from(&film);
            }
            outcome.map_err(|e| self.at(first, Stage::Render, e))?;
        }
        Ok(())
    }
}
