//! Strokes
//!
//! Strokes that a user paints on a photo to show where the plane and the lights are. Add strokes point by point, as a
//! drawing or as a text, then hand them to a stage: luxfer_transfer_set_strokes, luxfer_segment_set_strokes or
//! luxfer_features_set_strokes. A stage copies the strokes; if you add strokes later, hand them to the stage again.

use super::context::{Context, luxfer_context};
use super::guard::{enter, lock};
use super::handle::{self, Handle, Owned, tag};
use super::image::luxfer_image;
use super::pointer::{Out, bytes, text};
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::segment::{Stroke, StrokeSet, strokes};
use glam::DVec2;
use std::ffi::{c_char, c_void};
use std::sync::{Arc, Mutex};

/// A set of strokes for images of one size. See luxfer_strokes_create.
pub struct luxfer_strokes {
    _opaque: [u8; 0],
}

/// The mask for which strokes are painted: a LUXFER_PHASE_ value.
pub type luxfer_phase = i32;
/// The mask of the plane that carries the lights: positive strokes lie on the plane; strokes on lights count as
/// positive strokes too.
pub const LUXFER_PHASE_PLANE: luxfer_phase = 0;
/// The mask of the lights on the plane: positive strokes lie on lights, negative strokes on the plane beside them.
pub const LUXFER_PHASE_LIGHTS: luxfer_phase = 1;

/// Largest width and height of the images that strokes are for.
const MAX_SIDE: u32 = 65_536;

/// The object behind a `luxfer_strokes` handle.
pub(super) struct Strokes {
    context: Arc<Context>,
    size: (usize, usize),
    set: Mutex<StrokeSet>,
}

impl Owned for Strokes {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl Handle for luxfer_strokes {
    type Object = Strokes;
    const TAG: u64 = tag(b"lux.strk");
    const NAME: &'static str = "luxfer_strokes";
}

impl Strokes {
    fn add(&self, more: StrokeSet) {
        let mut set = lock(&self.set);
        set.plane.extend(more.plane);
        set.lights.extend(more.lights);
    }
}

/// A stage's copy of the caller's strokes.
#[derive(Clone, Default)]
pub(super) struct Painted<T> {
    /// The part of the caller's strokes that the stage uses.
    pub(super) taken: T,
    /// Width and height of the image that the strokes are for; `None` if the caller has set no strokes.
    size: Option<(usize, usize)>,
}

impl<T: Default> Painted<T> {
    /// Copies the part of the caller's strokes that `select` returns; NULL stands for an empty set of strokes.
    pub(super) fn copy(
        context: &Arc<Context>,
        strokes: *mut luxfer_strokes,
        select: impl FnOnce(&StrokeSet) -> Result<T>,
    ) -> Result<Self> {
        if strokes.is_null() {
            return Ok(Self { taken: select(&StrokeSet::default())?, size: None });
        }
        let object = handle::borrow_in(context, strokes, "strokes")?;
        let taken = select(&lock(&object.set))?;
        Ok(Self { taken, size: Some(object.size) })
    }

    /// Checks that the strokes are for an image of `needed` width and height, if the stage has the image already.
    pub(super) fn check_size(&self, needed: Option<(usize, usize)>, name: &str) -> Result<()> {
        match (self.size, needed) {
            (Some((w, h)), Some((width, height))) if (w, h) != (width, height) => Err(Error::argument(format!(
                "strokes are for {w} x {h} pixels and {name} has {width} x {height}; create them with its size"
            ))),
            _ => Ok(()),
        }
    }

    /// Removes the strokes if they are for an image of another size.
    pub(super) fn keep_for(&mut self, size: (usize, usize)) {
        if self.size.is_some_and(|before| before != size) {
            *self = Self::default();
        }
    }
}

/// Returns the strokes from which the mask of `phase`, a LUXFER_PHASE_ value, is made.
pub(super) fn of_phase(set: &StrokeSet, phase: luxfer_phase) -> Result<Vec<Stroke>> {
    match phase {
        LUXFER_PHASE_PLANE => Ok(set.plane_examples()),
        LUXFER_PHASE_LIGHTS => Ok(set.lights.clone()),
        _ => Err(unknown_phase(phase)),
    }
}

pub(super) fn unknown_phase(phase: luxfer_phase) -> Error {
    Error::argument(format!("phase is {phase}; it must be a LUXFER_PHASE_ value"))
}

/// Makes a stroke from the caller's points, for an image of the given size.
fn stroke(
    points: *const c_void,
    point_count: usize,
    radius: f32,
    positive: i32,
    (width, height): (usize, usize),
) -> Result<Stroke> {
    let size = point_count.checked_mul(8).ok_or_else(|| Error::argument(format!("point_count is {point_count}")))?;
    let float = |b: &[u8]| f64::from(f32::from_ne_bytes([b[0], b[1], b[2], b[3]]));
    let points: Vec<DVec2> = bytes(points.cast(), size, "points")?
        .chunks_exact(8)
        .map(|b| DVec2::new(float(&b[..4]), float(&b[4..])))
        .collect();
    match positive {
        0 | 1 => Stroke::polyline(&points, radius.into(), positive == 1, width, height),
        _ => Err(Error::argument(format!("positive is {positive}; it must be 0 or 1"))),
    }
}

/// Creates an empty set of strokes for a photo, or for features, of width x height pixels. The caller releases
/// *strokes. Any thread.
/// LUXFER_INVALID_ARGUMENT if width or height is not in [1, 65536].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_strokes_create(
    context: *mut luxfer_context,
    width: u32,
    height: u32,
    strokes: *mut *mut luxfer_strokes,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(strokes, "strokes")?;
        check_range("width", width, 1, MAX_SIDE)?;
        check_range("height", height, 1, MAX_SIDE)?;
        out.set(handle::give(Arc::new(Strokes {
            context: object.context().clone(),
            size: (width as usize, height as usize),
            set: Mutex::default(),
        })));
        Ok(())
    })
}

/// Adds a stroke along a polyline; one point makes a dot. phase is a LUXFER_PHASE_ value. The parameter positive is 1
/// for a stroke on the plane or on lights, 0 for a stroke beside them. The array points holds point_count pairs of
/// floats, x and y in pixels; the centre of the top-left pixel is (0.5, 0.5). radius is in pixels, in [0.001, 4096]. A
/// pixel that several strokes cover belongs to the last of these strokes. Any thread.
/// LUXFER_INVALID_ARGUMENT if there is no point, a coordinate is not finite, or radius or positive is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_strokes_add(
    strokes: *mut luxfer_strokes,
    phase: luxfer_phase,
    points: *const f32,
    point_count: usize,
    radius: f32,
    positive: i32,
) -> luxfer_status {
    enter(strokes, |object| {
        let mut more = StrokeSet::default();
        let list = match phase {
            LUXFER_PHASE_PLANE => &mut more.plane,
            LUXFER_PHASE_LIGHTS => &mut more.lights,
            _ => return Err(unknown_phase(phase)),
        };
        list.push(stroke(points.cast(), point_count, radius, positive, object.size)?);
        object.add(more);
        Ok(())
    })
}

/// Adds the strokes of a drawing, an image of the size given to luxfer_strokes_create. Green (0, 255, 0) is plane, red
/// (255, 0, 0) not plane, yellow (255, 255, 0) light, blue (0, 0, 255) not light; other colours and pixels with an
/// alpha below 0.5 are ignored. Each sRGB channel of a pixel may differ from the colour by 30 % of its range. Connected
/// regions of one colour with fewer than 4 pixels are ignored. Load drawings with LUXFER_COLOUR_SRGB. Any thread.
/// LUXFER_INVALID_ARGUMENT if the size differs or the drawing has fewer than 3 channels.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_strokes_add_image(
    strokes: *mut luxfer_strokes,
    drawing: *mut luxfer_image,
) -> luxfer_status {
    enter(strokes, |object| {
        let drawing = handle::borrow_in(object.context(), drawing, "drawing")?;
        let (width, height) = drawing.size();
        if (width, height) != object.size {
            let (w, h) = object.size;
            return Err(Error::argument(format!(
                "drawing has {width} x {height} pixels; the strokes are for {w} x {h}"
            )));
        }
        object.add(strokes::from_image(drawing.image())?);
        Ok(())
    })
}

/// Adds the strokes of a text in UTF-8. Each line has a class, a radius in pixels, and x and y of the points in
/// pixels, such as "light 3 310.5 30 320 31". The classes are plane, not-plane, light and not-light; # starts a
/// comment. Any thread.
/// LUXFER_FORMAT if the text is malformed, LUXFER_INVALID_ARGUMENT if a radius or a coordinate is out of range: the
/// message names the line.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_strokes_add_text(
    strokes: *mut luxfer_strokes,
    description: *const c_char,
) -> luxfer_status {
    enter(strokes, |object| {
        let description = text(description, "description")?;
        let (width, height) = object.size;
        object.add(strokes::parse(description, width, height)?);
        Ok(())
    })
}
