//! Styles and tiles
//!
//! luxfer_emission_add_style adds exemplars, whose lights are then mixed in one texture. Textures that are too large to
//! make as a whole are made in tiles: luxfer_emission_start_composition decides where every lamp lies, and
//! luxfer_emission_render_tile renders any rectangle of the texture. A composition holds the exemplars, the place of
//! each lamp and the outlines of the patches, but no texels.

use super::emission::{
    AddedExemplar, Composed, Exemplar, Output, luxfer_emission, luxfer_emission_params, photo_of, unwarped_of,
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

/// Adds an exemplar. The texture then mixes the lights of all exemplars: for each place of the texture, the image
/// weights states the share of the lamps that come from the added exemplar. The arguments unwarped, light and valid
/// have the meanings that they have for luxfer_emission_set_exemplar; photo, which may be NULL, and to_photo have the
/// meanings that they have for luxfer_emission_set_photo. scale is the number of unwarped pixels of this exemplar per
/// texel, in [1e-3, 1e3]. Any thread.
///
/// The image weights has 1 channel with values in [0, 1] and is stretched over the texture. If several exemplars are
/// added, their weights are images of one size, and the sum of the weights of a pixel is at most 1; the first exemplar
/// gets the remaining weight.
///
/// Each lamp of the texture comes from one exemplar, chosen at random with the weights at the lamp's centre as
/// probabilities. On average, the light per area is therefore the weighted mean of the exemplars. Lights that run
/// beyond the border of their exemplar are not chosen at random; they are dimmed by their exemplar's weight instead.
/// The lattice of each exemplar keeps its own period and phase.
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
            inputs.styles.push(AddedExemplar { exemplar, scale, weights });
            Ok(())
        })
    })
}

/// Removes all exemplars added by luxfer_emission_add_style; the first exemplar stays. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_clear_styles(emission: *mut luxfer_emission) -> luxfer_status {
    enter(emission, |stage| {
        stage.change(|inputs| {
            inputs.styles.clear();
            Ok(())
        })
    })
}

/// Starts a job that composes the texture: it decides where every lamp lies, but makes no texels. The composition
/// replaces a texture that luxfer_emission_start has made. params and all errors are as for luxfer_emission_start.
/// With LUXFER_LAW_BEST, a composition never tries other laws, because that needs the texels.
/// luxfer_emission_get_report and luxfer_emission_get_luminaire describe the composition and its lamps. The caller
/// releases *job. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_start_composition(
    emission: *mut luxfer_emission,
    params: *const luxfer_emission_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(emission, |stage| {
        let params = params::read(params)?.params()?;
        stage.inputs().with(|_, _| Ok(()))?;
        stage.start(job, move |inputs, _, job| {
            let (composition, lamps) = inputs.with(|input, styles| {
                let composition = Composition::new(input, styles, &params, job.part(0.0, 0.95))?;
                let lamps = LampList::new(&composition, input, styles, job.part(0.95, 1.0))?;
                Ok((composition, lamps))
            })?;
            Ok(Output { composed: Some(Composed { composition, lamps, inputs: inputs.clone() }), ..Output::default() })
        })
    })
}

/// Renders a rectangle (a tile) of a composed texture: width x height texels, whose top-left texel is texel (x, y) of
/// the texture. The tile has 4 channels: linear RGB, and a mask that is 1 on lamps, else 0. Tiles of any sizes,
/// rendered in any order, equal to the bit the texture and the mask that luxfer_emission_start makes with these
/// settings, unless LUXFER_LAW_BEST makes luxfer_emission_start try other laws, which a composition never does. The
/// call takes up to a second per megapixel. The caller releases *tile. Any thread; several threads may render tiles at
/// the same time.
/// LUXFER_NOT_READY before a job of luxfer_emission_start_composition has succeeded; LUXFER_INVALID_ARGUMENT if the
/// rectangle is empty or exceeds the texture; LUXFER_OUT_OF_MEMORY beyond the memory budget.
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
        let Composed { composition, inputs, .. } = made.composed.as_ref().ok_or_else(|| {
            Error::new(
                ErrorKind::NotReady,
                "nothing is composed: call luxfer_emission_start_composition and wait for its job",
            )
        })?;
        let part = Tile { x: x as usize, y: y as usize, width: width as usize, height: height as usize };
        composition.check(part)?;
        let context = stage.context();
        let image = Pixels::counted(context, part.width, part.height, 4, || {
            let monitor = context.monitor();
            let render = || inputs.with(|input, styles| composition.tile(input, styles, part, monitor.job()));
            let (texture, mask) = context.quick.run(render)?;
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
