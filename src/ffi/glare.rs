//! Glare of observers
//!
//! Computes the unified glare rating (CIE 117) for observers in a scene. The glare sources are the luminaires of the
//! scene and its emissive meshes. The luminance of a luminaire is its intensity towards the eye, divided by the area of
//! its luminous opening as seen from the eye. Luminaires whose file states no luminous opening, and luminaires whose
//! opening the eye sees edge-on, have no such area and are not rated.
//!
//! Each connected part of a mesh that emits is a source, as are the single lamps of an emission texture. The luminance
//! of such a source is the mean over its visible part. Points darker than a tenth of the largest luminance of their
//! material, such as the glow around lamps in a texture, are not rated.

use super::guard::enter;
use super::handle::Owned;
use super::pointer::{bytes, bytes_mut, floats, strided};
use super::scene::luxfer_scene;
use super::status::luxfer_status;
use crate::error::Result;
use crate::image::try_vec;
use crate::render::glare::{self, Eye, Rating};
use glam::Vec3;

/// An observer: an eye that looks in a direction. Callers pass arrays of this struct, so its size and fields never
/// change in later versions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_observer {
    /// Position of the eye, in metres.
    pub position: [f32; 3],
    /// Line of sight; any length but 0. It must not be vertical: its horizontal part must be at least 2 % of its
    /// length.
    pub direction: [f32; 3],
}

/// The glare that an observer experiences. Callers pass arrays of this struct, so its size and fields never change in
/// later versions.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_observer_glare {
    /// Unified glare rating: 8 log10(0.25 / background * sum of L² w / p²) over the sources in view, with their
    /// luminance L in cd/m², solid angle w in steradians and position index p. Below 10, glare is imperceptible; 19 is
    /// the limit for offices. -infinity if no source is in view; infinity if a source is in view and the background is
    /// black.
    pub ugr: f64,
    /// Luminance of the background in cd/m²: the indirect illuminance at the eye, divided by pi.
    pub background: f64,
    /// Standard error of the field background, in cd/m².
    pub background_error: f64,
    /// Direct illuminance at the eye, in lux, from all light that the rating leaves out: of luminaires without a
    /// luminous opening, of point, spot and directional lights, of the environment, and the glow of emissive meshes.
    pub unrated_lux: f64,
    /// Solid angle of the visible parts of all sources in view, in steradians.
    pub solid_angle: f64,
    /// Number of sources in view: rated luminaires, and luminous parts of emissive meshes.
    pub sources: u32,
    /// Number of sources in view whose solid angle is outside [0.0003, 0.1] steradians, the range for which CIE 117 is
    /// valid; they count in ugr too. Lamps in an emission texture that are narrower than 0.32 degrees may be missed.
    pub outside_range: u32,
}

/// Computes the glare ratings of count observers in a scene; the array ratings receives count elements. The parameter
/// samples is the number of paths per observer for the background, in [16, 16777216], rounded up to a multiple of 16;
/// 4096 paths suit most rooms. seed is the seed of the paths, and of the rays that find luminous meshes. The call is
/// synchronous; its time is proportional to count times samples, and longer in a scene with emissive meshes.
/// observer_stride and rating_stride are the distances between elements in bytes; 0: sizeof(luxfer_observer),
/// sizeof(luxfer_observer_glare). The first call after a scene is loaded or changed also prepares the scene for
/// tracing. Any thread.
/// LUXFER_INVALID_ARGUMENT if the scene is not valid, a value is out of range, or an observer is not finite, looks
/// straight up or down, or is inside a luminaire (the message names the observer). In these cases no rating is written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_get_glare(
    scene: *mut luxfer_scene,
    observers: *const luxfer_observer,
    count: usize,
    observer_stride: usize,
    samples: u32,
    seed: u64,
    ratings: *mut luxfer_observer_glare,
    rating_stride: usize,
) -> luxfer_status {
    enter(scene, |object| {
        if count == 0 {
            return Ok(());
        }
        let (observer_stride, size) = strided::<luxfer_observer>(count, observer_stride, "observers")?;
        let (rating_stride, ratings_size) = strided::<luxfer_observer_glare>(count, rating_stride, "ratings")?;
        bytes_mut(ratings.cast(), ratings_size, "ratings")?;
        let observers = bytes(observers.cast(), size, "observers")?;
        let mut eyes = try_vec(count, Eye { position: Vec3::ZERO, direction: Vec3::ZERO })?;
        for (place, raw) in eyes.iter_mut().zip(observers.chunks(observer_stride)) {
            *place = eye(&raw[..size_of::<luxfer_observer>()]);
        }
        let world = object.ready_world()?;
        let (params, monitor) = (glare::Params { samples, seed }, object.context().monitor());
        let rated: Result<Vec<Rating>> =
            object.context().quick.run(|| glare::rate(&world, &eyes, &params, monitor.job()));
        // Each rating is written alone, because observers may lie between the ratings.
        for (i, rating) in rated?.iter().enumerate() {
            let place = ratings.wrapping_byte_add(i * rating_stride);
            let place = bytes_mut(place.cast(), size_of::<luxfer_observer_glare>(), "ratings")?;
            place.copy_from_slice(bytemuck::cast_slice(&words(rating)));
        }
        Ok(())
    })
}

fn eye(raw: &[u8]) -> Eye {
    let [px, py, pz, dx, dy, dz] = floats(raw);
    Eye { position: Vec3::new(px, py, pz), direction: Vec3::new(dx, dy, dz) }
}

/// Returns the fields of a rating as 32-bit words, in the order of `luxfer_observer_glare`.
fn words(rating: &Rating) -> [u32; 12] {
    let solid_angle = rating.sources.iter().map(|s| s.solid_angle).sum();
    let numbers = [rating.ugr, rating.background, rating.background_error, rating.unrated_lux, solid_angle];
    let mut words = [0; 12];
    for (pair, number) in words.chunks_exact_mut(2).zip(numbers) {
        pair.copy_from_slice(&bytemuck::cast::<f64, [u32; 2]>(number));
    }
    words[10] = rating.sources.len() as u32;
    words[11] = rating.outside_range() as u32;
    words
}
