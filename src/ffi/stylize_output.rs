//! The output of a stylisation, while it runs and after it has finished.

use crate::error::{Error, ErrorKind, Result};
use crate::guides::Surfaces;
use crate::image::Image;
use crate::maths;
use crate::patch::Field;
use crate::stylize::{GuideRecord, IntermediateResult, LevelReport, Output, Updater, Usage};
use crate::warning::Warning;
use std::sync::{Arc, Mutex};

/// The output of a run: the picture so far, and more results if the run has finished.
#[derive(Clone)]
pub(super) struct Stylised {
    pub picture: Arc<Image>,
    pub halvings: usize,
    pub levels: Arc<Vec<LevelReport>>,
    pub finished: Option<Finished>,
}

/// Results that only a finished run has.
#[derive(Clone)]
pub(super) struct Finished {
    pub guide_error: Arc<Image>,
    pub sources: Arc<Image>,
    /// Root mean square of the guide error.
    pub guide_rms: f64,
    pub usage: Usage,
    /// Share of the painted pixels that are whole exemplar pixels instead of blends, in `[0, 1]`.
    pub unblended_share: f64,
    /// Weight of the normals as a guide, given by the caller or chosen by the exemplar.
    pub normals_weight: f32,
    pub patch: usize,
    /// Number of non-finite pixels in the exemplar and in the target.
    pub broken: [usize; 2],
    /// Reasons to doubt the exemplar, the light and the motion.
    pub warnings: Vec<Warning>,
    frame: Arc<Frame>,
    updater: Option<Arc<Mutex<Updater>>>,
}

/// The parts of a result that the next frame of a sequence needs.
pub(super) struct Frame {
    pub field: Field,
    pub guide_record: GuideRecord,
    pub surfaces: Option<Arc<Surfaces>>,
}

impl Stylised {
    pub(super) fn unfinished(intermediate: IntermediateResult) -> Self {
        Self {
            picture: Arc::new(intermediate.picture),
            halvings: intermediate.halvings,
            levels: Arc::new(intermediate.levels.to_vec()),
            finished: None,
        }
    }

    pub(super) fn finished(
        output: Output,
        surfaces: Option<Arc<Surfaces>>,
        warnings: Vec<Warning>,
        normals_weight: f32,
        updater: Option<Updater>,
    ) -> Self {
        let report = output.report;
        let squares = report.guide_error.data.iter().map(|&v| maths::powi(f64::from(v), 2));
        let guide_rms = (squares.sum::<f64>() / report.guide_error.data.len() as f64).sqrt();
        Self {
            picture: Arc::new(output.image),
            halvings: report.halvings,
            levels: Arc::new(report.levels),
            finished: Some(Finished {
                guide_error: Arc::new(report.guide_error),
                sources: Arc::new(report.sources),
                guide_rms,
                usage: report.usage,
                unblended_share: report.unblended_share,
                normals_weight,
                patch: report.patch,
                broken: [report.broken_source, report.broken_target],
                warnings,
                frame: Arc::new(Frame { field: output.field, guide_record: output.guide_record, surfaces }),
                updater: updater.map(|s| Arc::new(Mutex::new(s))),
            }),
        }
    }

    /// Returns a copy of this output with the picture and the sources that an update has made.
    pub(super) fn updated(&self, picture: Image, sources: Image) -> Self {
        let finished = self.finished.clone().map(|f| Finished { sources: Arc::new(sources), ..f });
        Self { picture: Arc::new(picture), finished, ..self.clone() }
    }

    /// Returns the parts of a finished run that the next frame needs; an error if the run has not finished.
    pub(super) fn frame(&self) -> Result<Arc<Frame>> {
        Ok(self.need_finished()?.frame.clone())
    }

    pub(super) fn updater(&self) -> Option<Arc<Mutex<Updater>>> {
        self.finished.as_ref().and_then(|f| f.updater.clone())
    }

    /// Returns the results of a finished run; an error if the run has not finished.
    pub(super) fn need_finished(&self) -> Result<&Finished> {
        self.finished.as_ref().ok_or_else(|| {
            Error::new(ErrorKind::NotReady, "only the picture is there before the last level is done; wait for the job")
        })
    }
}
