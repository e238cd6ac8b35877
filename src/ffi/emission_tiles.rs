//! Styles and tiles
//!
//! Several exemplars in one texture, and textures that are too large to be made as a whole: luxfer_emission_start_plan decides
//! where every lamp goes, and luxfer_emission_render_tile renders any part. Beside the exemplars a plan holds a place for each
//! lamp and the outlines of the patches, but no texel.

use super::emission::{
    Exemplar, Further, Made, Planned, luxfer_emission, luxfer_emission_params, photo_of, unwarped_of,
};
use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params;
use super::pointer::Out;
use super::status::luxfer_status;
use crate::emission::{Composition, LampList, Tile};
use crate::error::{Error, ErrorKind};
use crate::image::Image;
use crate::job::Monitor;

/// Adds an exemplar, whose lights take the place of the first one's as its weights say. unwarped, light and valid are as for
/// luxfer_emission_set_exemplar; photo, which may be NULL, and to_photo as for luxfer_emission_set_photo. scale is its unwarped
/// pixels per texel, in [1e-3, 1e3]. weights has 1 channel and values in [0, 1], and is stretched over the texture; where several
/// exemplars are added their weights are images of one size and add up to 1 at most. What they leave is the first exemplar's.
///
/// No lamp is a mixture: each is taken from an exemplar with the probability of its weight there, so that light per area blends
/// linearly. Lattices keep their own period and phase. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_add_style(
    emission: *mut luxfer_emission,
    unwarped: *mut luxfer_image,
    light: *mut luxfer_image,
    valid: *mut luxfer_image,
    photo: *mut luxfer_image,
    to_photo: *const f64,
    scale: f64,
    weights: *mut luxfer_image,
) -> luxfer_status {
    enter(emission, |stage| {
        let context = stage.context();
        let unwarped = unwarped_of(context, [unwarped, light, valid])?;
        let exemplar = Exemplar { unwarped, photo: photo_of(context, photo, to_photo)? };
        let weights = handle::borrow_in(context, weights, "weights")?;
        stage.change(|inputs| {
            inputs.styles.push(Further { exemplar, scale, weights });
            Ok(())
        })
    })
}

/// Takes all exemplars that were added away; the first stays. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_clear_styles(emission: *mut luxfer_emission) -> luxfer_status {
    enter(emission, |stage| {
        stage.change(|inputs| {
            inputs.styles.clear();
            Ok(())
        })
    })
}

/// Starts a job that plans the texture, in the place of luxfer_emission_start, whose results go. params and what the call and
/// the job return are the same. luxfer_emission_get_report and luxfer_emission_get_luminaire tell the lamps of the plan.
/// The caller releases *job. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_start_plan(
    emission: *mut luxfer_emission,
    params: *const luxfer_emission_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(emission, |stage| {
        let params = params::read(params)?.params()?;
        stage.inputs().with(|_, _| Ok(()))?;
        stage.start(job, move |inputs, _, job| {
            let (plan, lamps) = inputs.with(|input, styles| {
                let plan = Composition::new(input, styles, &params, job.part(0.0, 0.95))?;
                let lamps = LampList::new(&plan, input, styles, job.part(0.95, 1.0))?;
                Ok((plan, lamps))
            })?;
            Ok(Made { plan: Some(Planned { plan, lamps, inputs: inputs.clone() }), ..Made::default() })
        })
    })
}

/// Renders the part of a planned texture that begins x texels right of and y below its corner: 4 channels, linear RGB, and 1 on
/// lamps, else 0. The bits are those of the texture and mask that luxfer_emission_start makes, whatever the tiles and their
/// order. Takes up to a second for each megapixel. The caller releases *tile. Any thread, several at once.
/// LUXFER_NOT_READY before a job of luxfer_emission_start_plan has succeeded; LUXFER_INVALID_ARGUMENT for a part that is empty or
/// reaches beyond the texture; LUXFER_OUT_OF_MEMORY beyond the memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_render_tile(
    emission: *mut luxfer_emission,
    x: u32,
    y: u32,
    width: u32,
    height: u32,
    tile: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(emission, |stage| {
        let out = Out::new(tile, "tile")?;
        let made = stage.output()?;
        let Planned { plan, inputs, .. } = made.plan.as_ref().ok_or_else(|| {
            Error::new(ErrorKind::NotReady, "nothing is planned: call luxfer_emission_start_plan and wait for its job")
        })?;
        let part = Tile { x: x as usize, y: y as usize, width: width as usize, height: height as usize };
        plan.check(part)?;
        let context = stage.context();
        let image = Pixels::counted(context, part.width, part.height, 4, || {
            let job = Monitor::default();
            let render = || inputs.with(|input, styles| plan.tile(input, styles, part, job.job()));
            let (texture, mask) = context.pool.run(render)?;
            let mut image = Image::new(part.width, part.height, 4)?;
            let texels = texture.data.chunks_exact(3).zip(&mask.data);
            for (out, (rgb, mask)) in image.data.chunks_exact_mut(4).zip(texels) {
                out[..3].copy_from_slice(rgb);
                out[3] = *mask;
            }
            Ok(image)
        })?;
        out.set(handle::give(image));
        Ok(())
    })
}
