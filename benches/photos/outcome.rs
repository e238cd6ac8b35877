//! A whole transfer from a photo with its strokes, with default settings, and its time.

use super::shapes::{Lamps, Shape};
use super::truth::Photo;
use crate::harness::{Clock, time};
use glam::DVec2;
use luxfer::emission::Emission;
use luxfer::job::Monitor;
use luxfer::scene::Scene;
use luxfer::transfer::{Input, Params, Results, Stage, Transfer};
use luxfer::warning::{Code, Warning};
use std::sync::Arc;

/// Size in pixels of the picture of the lit hall, and its paths per pixel.
const PICTURE: ([usize; 2], u32) = ([320, 192], 8);

/// A transfer with its results, as far as it has come.
pub struct Outcome {
    pub transfer: Transfer,
    /// Reason for which the transfer ended early; `None` if it did not.
    pub failure: Option<String>,
    /// Wall-clock seconds from the photo to the emissive texture, and processor seconds of all threads.
    pub seconds: f64,
    pub cpu_seconds: f64,
}

impl Outcome {
    /// Runs all stages up to the emissive texture, on the ceiling of `scene`.
    pub fn of(photo: &Photo, scene: &Arc<Scene>) -> Self {
        Self::from(
            Transfer { input: input(photo, scene), params: Params::default(), results: Results::default() },
            Stage::View,
        )
    }

    /// Runs the stages from `first` up to the emissive texture.
    pub fn from(transfer: Transfer, first: Stage) -> Self {
        Self::between(transfer, first, Stage::Emission)
    }

    fn between(mut transfer: Transfer, first: Stage, last: Stage) -> Self {
        let mut seconds = 0.0;
        let (cpu_seconds, failure) = time(Clock::Process, || {
            let job = Monitor::default();
            let (wall, result) = time(Clock::Wall, || transfer.run(first, last, job.job(), |_| {}));
            seconds = wall;
            result.err().map(|e| e.to_string())
        });
        Self { transfer, failure, seconds, cpu_seconds }
    }

    /// Runs the stages up to the masks of the plane and the lights.
    pub fn masks(photo: &Photo) -> Self {
        let input = Input { photo: Some(photo.image.clone()), strokes: photo.strokes.clone(), ..Input::default() };
        Self::between(Transfer { input, ..Transfer::default() }, Stage::View, Stage::Lights)
    }

    /// Solves for the strength of the light and renders the hall, for the contact sheets.
    pub fn render(&mut self) {
        if self.failure.is_none() {
            let render = &mut self.transfer.params.render;
            ([render.width, render.height], render.samples) = PICTURE;
            let job = Monitor::default();
            self.failure =
                self.transfer.run(Stage::Relight, Stage::Render, job.job(), |_| {}).err().map(|e| e.to_string());
        }
    }

    pub fn results(&self) -> &Results {
        &self.transfer.results
    }

    pub fn emission(&self) -> Option<&Emission> {
        self.results().emission.as_deref()
    }

    fn raised(&self) -> Vec<(Option<Stage>, Warning)> {
        self.results().warnings(&self.transfer.input.strokes)
    }

    /// Whether the run reports that its texture should not be used: it ended early, the painted lamps do not shine, or
    /// a texture without light would be nearer to the photo.
    pub fn declines(&self) -> bool {
        self.failure.is_some()
            || self.raised().iter().any(|(_, w)| matches!(w.code, Code::DimLamps | Code::NoPattern | Code::OffPlane))
    }

    /// Reports of the run that its texture may be wrong: its error, and its warnings up to the texture.
    pub fn warnings(&self) -> Vec<String> {
        let of_texture = self.raised().into_iter().filter(|(stage, _)| *stage <= Some(Stage::Emission));
        let texts = of_texture.map(|(_, w)| format!("{:?} {:.3} (limit {:.3})", w.code, w.severity, w.limit));
        self.failure.iter().cloned().chain(texts).collect()
    }

    /// The lamps of the texture, in units of the distance of the photo's camera from its plane.
    pub fn lamps(&self) -> Option<Lamps> {
        let (emission, lit) = (self.emission()?, self.results().unsolved.as_ref()?);
        let unit = match (self.results().distance, self.transfer.params.plane_distance) {
            (Some(distance), _) => distance.metres,
            (None, given) => given,
        };
        Some(lamps(emission, lit.texel_size / unit))
    }
}

fn lamps(emission: &Emission, unit: f64) -> Lamps {
    let size = DVec2::new(emission.mask.width as f64, emission.mask.height as f64);
    let is_whole = |p: &DVec2| p.min_element() > 0.0 && (size - *p).min_element() > 0.0;
    let shape = |outline: &[DVec2], area: f64| {
        let outline: Vec<DVec2> = outline.iter().map(|p| *p * unit).collect();
        Shape::of(&outline, Some(area * unit * unit))
    };
    let of = |whole: bool| -> Vec<Shape> {
        let wanted = emission.luminaires.iter().filter(|lamp| lamp.outline.iter().all(is_whole) == whole);
        wanted.filter_map(|lamp| shape(&lamp.outline, lamp.area)).collect()
    };
    let lit = emission.mask.data.iter().map(|&m| f64::from(m)).sum::<f64>() / emission.mask.data.len() as f64;
    Lamps { whole: of(true), cut: of(false), lit: Some([lit; 2]), ..Lamps::default() }
}

/// The input of a transfer from a photo to the ceiling of a scene.
pub fn input(photo: &Photo, scene: &Arc<Scene>) -> Input {
    Input {
        photo: Some(photo.image.clone()),
        strokes: photo.strokes.clone(),
        scene: Some(scene.clone()),
        surface: "Ceiling".into(),
        ..Input::default()
    }
}
