//! Emission: synthesises an emissive texture of any size from the unwarped lights of a photo ("Lighting Style
//! Transfer", §6).
//!
//! ```text
//! unwarped photo + light + valid ─▶ exemplar ─▶ lattice ─▶ quilt ─▶ lamps ─▶ compose ─▶ agreement
//! ```
//! 1. [`exemplar`] finds the usable part of the photo and the lights in it (connected components). It classifies each
//!    light, for example as a whole lamp or as a lamp that the border cuts, and reduces the image to the working size
//!    of the synthesis.
//! 2. [`lattice`] finds the lattice that the lamps lie on, from the autocorrelation of the light mask. [`analysis`]
//!    compares it with other laws by which the pattern may continue, such as a single row, and chooses one.
//! 3. [`quilt`] computes metadata of each pixel (confidence that it is light, signed x and y distance to the nearest
//!    light), and quilts colour and metadata with minimum-error seams. On a lattice, patches are shifted by whole
//!    periods only. Patches are chosen so that the lit share of the texture stays close to the lit share of the
//!    exemplar.
//! 4. [`lamps`] finds each lamp of the quilted texture and copies it as a whole, so that no seam cuts it. It also
//!    measures the outline, kind and colour of each lamp.
//! 5. [`compose`] plans the positions of lamps and patches, renders the texels from the photo at full resolution, and
//!    lists the lamps.
//! 6. [`agreement`] compares the texture's statistics with the exemplar's, and estimates the sampling error of the
//!    exemplar's statistics. [`other_laws`] makes textures by other laws if the texture differs more from the
//!    exemplar than a texture without light would.
//!
//! A texture that fits inside the exemplar is copied from it, unless it is to be tileable or is centred in any case.
//! Another exception is an exemplar whose lamps have ragged outlines and lie on a lattice: such lamps are placed and
//! drawn anew.
//!
//! Beyond the paper:
//!
//! - the lattice, and lamps copied as a whole, because image quilting alone lets regular patterns drift and cuts
//!   lamps;
//! - the colour of lamps that are clipped in the photo, read from their rims ([`lamps::rim_colour`]);
//! - zones that must stay free of lamps ([`compose::texel_zone`]);
//! - textures of any size, rendered in tiles of a [`Composition`];
//! - textures blended from several exemplars ([`compose::draw`]).
//!
//! Not modelled: lamps that mix the designs of two exemplars; and a pattern that continues across the edge between two
//! planes. In tileable textures, stretching the lattice may displace the edges of lines of light that cross each other.

mod agreement;
mod analysis;
mod assemble;
mod camera_distance;
mod compose;
mod exemplar;
mod lamps;
mod lattice;
mod measure;
mod other_laws;
mod output;
mod params;
mod quilt;
mod sizing;
#[cfg(test)]
mod tests;
mod warnings;

pub use agreement::{pairs, statistics};
pub use analysis::Choice;
pub use camera_distance::CameraDistance;
pub use compose::composition::Composition;
pub use compose::lamp_list::LampList;
pub use compose::texel_zone::TexelZone;
pub use compose::tile::Tile;
pub use compose::weights::Style;
pub use lamps::luminaire::Luminaire;
pub use lattice::law::Law;
pub use measure::{Measurements, measure};
pub use output::Emission;
pub use params::{Centring, Input, LawMode, Params, SCALES};
pub use sizing::{Scale, Sizing, TexelGrid};

use crate::error::{Error, Result};
use crate::geometry::PhotoMap;
use crate::image::Image;
use crate::job::Job;
use analysis::Analysis;
use assemble::{assemble, statistics_of};
use exemplar::{bars, joins, panes};
use lamps::{lines, luminaires};

/// Makes the result of emission from a texture that the caller supplies, without any synthesis. A texel counts as light
/// if any of its channels is above 0.
///
/// Errors: a value that is negative or not finite (`InvalidArgument`); a black texture (`Degenerate`).
pub fn from_texture(texture: &Image, job: Job) -> Result<Emission> {
    let texture = texture.to_rgb()?;
    if let Some(bad) = texture.data.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        return Err(Error::argument(format!("the emissive texture holds {bad}; its values must be finite and >= 0")));
    }
    let mut mask = Image::new(texture.width, texture.height, 1)?;
    for (m, pixel) in mask.data.iter_mut().zip(texture.data.chunks_exact(3)) {
        *m = f32::from(pixel.iter().any(|&v| v > 0.0));
    }
    if !mask.data.contains(&1.0) {
        return Err(Error::degenerate("the emissive texture is black everywhere: nothing in it gives light"));
    }
    let components = luminaires::components(&mask)?;
    let luminaires = luminaires::find(&texture, &components, &|i| mask.data[i], job)?;
    let statistics = statistics_of(&texture, &components, [Some(f64::INFINITY); 2]);
    let exemplar_lamps = statistics.whole;
    Ok(Emission {
        texture,
        mask,
        exemplar_metadata: Image::default(),
        metadata: Image::default(),
        luminaires,
        law: Law::Copy,
        regularity: 0.0,
        choice: Choice::only(Law::Copy),
        statistics: [statistics; 2],
        error: 0.0,
        first_error: None,
        sampling_error: 0.0,
        exemplar_lamps,
    })
}

/// Makes an emissive texture of `params.width` × `params.height` texels that continues the lights of the unwarped
/// photo.
///
/// Errors: a parameter out of range; images of different size; no valid pixel, or no light (`Degenerate`).
pub fn run(input: &Input, params: &Params, job: Job) -> Result<Emission> {
    blend(input, &[], params, job)
}

/// Like [`run`], but blends in the lights of further exemplars by their weight maps. In the result, `law`,
/// `regularity`, `choice` and the metadata describe the first exemplar only.
///
/// Errors: as for [`run`]; weights that are not in `[0, 1]`, or add up to more than 1.
pub fn blend(input: &Input, styles: &[Style], params: &Params, job: Job) -> Result<Emission> {
    blend_analysed(None, input, styles, params, job)
}

/// Like [`blend`], but reuses the analysis of the first exemplar that [`measure`] has made. Repeats the analysis if the
/// size of the input, or a setting that affects the analysis, differs from the size or setting of `measure`.
pub fn blend_measured(
    measured: Measurements,
    input: &Input,
    styles: &[Style],
    params: &Params,
    job: Job,
) -> Result<Emission> {
    blend_analysed(Some(measured.analysis), input, styles, params, job)
}

fn blend_analysed(
    analysis: Option<Analysis>,
    input: &Input,
    styles: &[Style],
    params: &Params,
    job: Job,
) -> Result<Emission> {
    let first_job = job.part(0.0, 0.95);
    let composition = Composition::of(analysis, input, styles, params, first_job.part(0.0, 0.85))?;
    let first = assemble(composition, input, styles, params, first_job)?;
    let emission = match styles {
        [] => other_laws::try_other_laws(first, input, params, job.part(0.95, 1.0))?,
        _ => first,
    };
    job.report(1.0);
    Ok(emission)
}

/// Makes each lamp of the unwarped light mask one piece. If the mask shows a luminous ceiling, removes the bars between
/// its panes, so that each pane becomes a lamp. Otherwise, joins the parts of lamps that the mask separates, and
/// straightens lines of light that the border cuts. Returns the mask unchanged if there is nothing of this to do.
pub fn complete_lights(unwarped: &Image, light: Image, valid: &Image, to_photo: PhotoMap, job: Job) -> Result<Image> {
    let plane = bars::LitPlane { unwarped, light: &light, valid, to_photo: Some(to_photo) };
    if let Some(parted) = panes::part(&plane, job)? {
        return Ok(parted);
    }
    let light = joins::join(&plane, job)?.unwrap_or(light);
    let plane = bars::LitPlane { unwarped, light: &light, valid, to_photo: Some(to_photo) };
    Ok(lines::straighten(&plane, job)?.unwrap_or(light))
}
