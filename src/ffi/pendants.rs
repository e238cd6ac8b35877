//! Pendants
//!
//! Finds the bodies of hanging lamps (pendants) in a photo. A lamp is taken as a body of revolution about a vertical
//! axis: a globe, a drum, a cone, or any other profile. The shape of the body is computed from the camera and the
//! outline of the lamp in a mask. Its size cannot be computed from them, because a lamp of twice the size at twice the
//! distance has the same outline. The size follows from a known diameter, or from the known distance between two lamps.
//! It also follows from the height of the ceiling together with the drop of a lamp below the ceiling, or with the point
//! of the photo where the suspension (the cable or rod on which the lamp hangs) meets the ceiling.

use super::context::luxfer_context;
use super::geometry::list;
use super::guard::enter;
use super::handle::{self, Owned};
use super::image::luxfer_image;
use super::params::{self, Report, Versioned, flag, versioned};
use super::pointer::{Out, set_optional};
use super::rectify::luxfer_rectify;
use super::scene::luxfer_scene;
use super::shared_context::Context;
use super::status::luxfer_status;
use crate::error::{Error, Result, check_range};
use crate::geometry::{FocalSource, Perspective};
use crate::image::Image;
use crate::maths;
use crate::pendant::{self, Body, Interval, Kind, Known, Lamp, Pendants, Placing};
use glam::{DMat3, DVec2, DVec3, Vec3};
use std::sync::Arc;

/// The kind of a lamp's body: a LUXFER_BODY_ value.
pub type luxfer_body = i32;
/// A sphere.
pub const LUXFER_BODY_GLOBE: luxfer_body = 0;
/// An ellipsoid of revolution.
pub const LUXFER_BODY_SPHEROID: luxfer_body = 1;
/// A cylinder.
pub const LUXFER_BODY_DRUM: luxfer_body = 2;
/// A cylinder lower than a quarter of its diameter.
pub const LUXFER_BODY_DISC: luxfer_body = 3;
/// A frustum of a cone.
pub const LUXFER_BODY_CONE: luxfer_body = 4;
/// A part of a sphere below a horizontal plane.
pub const LUXFER_BODY_BOWL: luxfer_body = 5;
/// A part of a sphere above a horizontal plane.
pub const LUXFER_BODY_DOME: luxfer_body = 6;
/// Any other body of revolution, such as a bell.
pub const LUXFER_BODY_OTHER: luxfer_body = 7;

/// The length that determines the size of the lamps: a LUXFER_KNOWN_ value.
pub type luxfer_known = i32;
/// No length is known. The points where suspensions meet the ceiling then determine the size, together with the height
/// of the ceiling. Without such points, each lamp has LUXFER_DOUBT_SIZE.
pub const LUXFER_KNOWN_NOTHING: luxfer_known = 0;
/// The distance of the first lamp's top below the ceiling; with alike = 0, of every lamp's top.
pub const LUXFER_KNOWN_DROP: luxfer_known = 1;
/// The largest diameter of the body. All lamps then have this diameter, also with alike = 0.
pub const LUXFER_KNOWN_DIAMETER: luxfer_known = 2;
/// The horizontal distance between the axes of the first two lamps; with alike = 0 it determines no size.
pub const LUXFER_KNOWN_SPACING: luxfer_known = 3;

/// The size is unknown: no length determines it, or its standard deviation exceeds half of it. The fields drop,
/// diameter and height then hold only bounds.
pub const LUXFER_DOUBT_SIZE: u32 = 1;
/// The probability of the kind is below 0.9.
pub const LUXFER_DOUBT_KIND: u32 = 2;
/// The photo clips more than a tenth of the lamp's pixels (see luxfer_pendant.clipped): the lamp may be brighter than
/// it appears, and its glare may enlarge the outline.
pub const LUXFER_DOUBT_CLIPPED: u32 = 4;
/// The border of the photo cuts off a part of the outline.
pub const LUXFER_DOUBT_CUT: u32 = 8;
/// The body hides a part of its own profile. At least one value of luxfer_pendant.profile_error exceeds 0.05.
pub const LUXFER_DOUBT_HIDDEN: u32 = 16;

/// Largest number of lamps, and of suspensions, that luxfer_pendants_find accepts.
pub const LUXFER_MAX_PENDANTS: u32 = 16;

/// Settings with which luxfer_pendants_find fits bodies to lamps. Fill them with luxfer_pendants_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_pendants_params {
    /// sizeof(luxfer_pendants_params), set by luxfer_pendants_params_init.
    pub struct_size: u32,
    /// 1, the default: all lamps of the mask have bodies of one shape and size; 0: each lamp has a body of its own.
    pub alike: u32,
    /// 1: all lamps hang at one height, which requires alike = 1; 0, the default: each lamp hangs at its own height.
    pub level: u32,
    /// 1, the default: each point of the mask's outline is moved to where the photo's luminance is the mean of the
    /// luminances inside and outside the lamp. Points where the photo is clipped or has little contrast stay on the
    /// outline of the mask. 0: all points stay on the outline of the mask.
    pub refine: u32,
    /// Meaning of known_length: a LUXFER_KNOWN_ value; default LUXFER_KNOWN_NOTHING.
    pub known: luxfer_known,
    /// Must be 0.
    pub reserved: u32,
    /// The known length in metres: in [0, 1e4] for LUXFER_KNOWN_DROP, in [1e-4, 1e4] for a diameter or a spacing. Must
    /// be 0, the default, with LUXFER_KNOWN_NOTHING.
    pub known_length: f64,
    /// Height of the ceiling above the camera in metres, in [0.01, 1000]; default 1. If the height is unknown, keep the
    /// default: the library then takes and returns all lengths, known_length included, in units of the true height
    /// instead of metres.
    pub ceiling: f64,
    /// Standard deviation in pixels of the x and of the y of each point in the array suspensions of
    /// luxfer_pendants_find, in [0.05, 100]; default 1.
    pub suspension_error: f64,
    /// Focal length of the camera in pixels; required, and > 0, if no rectification is given; default 0. Not used with
    /// a rectification. Without a rectification, the photo and the mask must be free of lens distortion.
    pub focal: f64,
    /// Standard deviation of the focal length in pixels, in [0, focal / 2]; default 0. With a rectification, 0 stands
    /// for the standard deviation that the rectification has estimated, or focal / 2 if that is smaller. This estimate
    /// is 0 only if the caller gave the rectification the focal length.
    pub focal_error: f64,
    /// Standard deviation in radians of the tilt of the vertical axis about each horizontal axis, in [0, 0.5]; default
    /// 0. Not used with a rectification, which has its own value.
    pub axes_error: f64,
    /// Principal point in pixels; NaN, the default: the photo's centre. Not used with a rectification.
    pub principal: [f64; 2],
    /// Room axes as unit vectors in camera space, as in luxfer_rectify_report.axes: axis 1 points down. Default: a
    /// camera that looks horizontally, without roll. Not used with a rectification.
    pub axes: [[f64; 3]; 3],
}

versioned!(luxfer_pendants_params, [160], {
    let d = pendant::Params::default();
    Self {
        struct_size: 160,
        alike: u32::from(d.alike),
        level: u32::from(d.level),
        refine: u32::from(d.refine),
        known: LUXFER_KNOWN_NOTHING,
        reserved: 0,
        known_length: 0.0,
        ceiling: d.distance,
        suspension_error: d.suspension_error,
        focal: 0.0,
        focal_error: 0.0,
        axes_error: 0.0,
        principal: [f64::NAN; 2],
        axes: DMat3::IDENTITY.to_cols_array_2d(),
    }
});

impl luxfer_pendants_params {
    fn params(&self) -> Result<pendant::Params> {
        if self.reserved != 0 {
            return Err(Error::argument(format!("reserved is {}; it must be 0", self.reserved)));
        }
        let (alike, level) = (flag(self.alike, "alike")?, flag(self.level, "level")?);
        if level && !alike {
            return Err(Error::argument("level is 1 and alike is 0; lamps at one height must be alike"));
        }
        let refine = flag(self.refine, "refine")?;
        Ok(pendant::Params { alike, level, refine, distance: self.ceiling, suspension_error: self.suspension_error })
    }

    fn known(&self) -> Result<Known> {
        match self.known {
            LUXFER_KNOWN_NOTHING if self.known_length == 0.0 => Ok(Known::NoLength),
            LUXFER_KNOWN_NOTHING => Err(Error::argument(format!(
                "known_length is {} and known is LUXFER_KNOWN_NOTHING; set known to the meaning of the length",
                self.known_length
            ))),
            LUXFER_KNOWN_DROP => Ok(Known::Drop(self.known_length)),
            LUXFER_KNOWN_DIAMETER => Ok(Known::Diameter(self.known_length)),
            LUXFER_KNOWN_SPACING => Ok(Known::Spacing(self.known_length)),
            other => Err(Error::argument(format!("known is {other}; it must be a LUXFER_KNOWN_ value"))),
        }
    }

    /// Returns the camera of the rectification, or of these settings if `view` is NULL. Also returns cameras of which
    /// each differs from this camera by one standard deviation of one quantity: the direction of the vertical axis, or
    /// the focal length.
    fn cameras(
        &self,
        context: &Arc<Context>,
        view: *mut luxfer_rectify,
        photo: &Image,
    ) -> Result<(Perspective, Vec<Perspective>)> {
        let axes_error = check_range("axes_error", self.axes_error, 0.0, 0.5)?;
        let (camera, shifts, focal_error) = if view.is_null() {
            let camera = self.camera(photo)?;
            let (across, along) = (camera.axes.col(0), camera.axes.col(2));
            (camera, vec![axes_error * across, axes_error * along], 0.0)
        } else {
            let output = handle::borrow_in(context, view, "view")?.output()?;
            (output.view.perspective, output.view.vertical_shifts().to_vec(), output.view.focal_error())
        };
        let max_error = 0.5 * camera.focal;
        let given = check_range("focal_error", self.focal_error, 0.0, max_error)?;
        let focal_error = if given == 0.0 { focal_error.min(max_error) } else { given };
        let down = camera.axes.col(1);
        let turned = shifts.into_iter().map(|shift| {
            let turn = maths::rotation_by(down.cross(shift));
            Perspective { axes: DMat3::from_quat(turn) * camera.axes, ..camera }
        });
        let stretched = Perspective { focal: camera.focal + focal_error, ..camera };
        let differs = |shifted: &Perspective| *shifted != camera;
        Ok((camera, turned.chain([stretched]).filter(differs).collect()))
    }

    /// Returns the camera of these settings.
    fn camera(&self, photo: &Image) -> Result<Perspective> {
        if !(self.focal > 0.0) {
            return Err(Error::argument(format!(
                "view is NULL and focal is {}; give a rectification, or a positive focal length in pixels",
                self.focal
            )));
        }
        let [x, y] = self.principal;
        let centre = 0.5 * DVec2::new(photo.width as f64, photo.height as f64);
        Ok(Perspective {
            focal: self.focal,
            focal_source: FocalSource::Given,
            principal: if x.is_nan() && y.is_nan() { centre } else { DVec2::new(x, y) },
            bend: 0.0,
            axes: DMat3::from_cols_array_2d(&self.axes),
        })
    }
}

/// A hanging lamp: its body, its place and the doubts about them. Fields called an interval hold three numbers: the
/// value, and the lower and the upper end of its 95 % confidence interval. If the photo does not determine the value,
/// the ends are the known bounds of the value, which may be 0 and infinity. A value without an estimate is NaN.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_pendant {
    /// sizeof(luxfer_pendant), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of vertices of the profile, in [2, 65].
    pub profile_count: u32,
    /// Kind of the body: a LUXFER_BODY_ value.
    pub kind: luxfer_body,
    /// Reasons to doubt the result: LUXFER_DOUBT_ flags.
    pub doubts: u32,
    /// Probability of the kind among all kinds, in [0, 1].
    pub probability: f64,
    /// Interval of height / largest diameter.
    pub aspect: [f64; 3],
    /// Interval of the largest diameter in metres.
    pub diameter: [f64; 3],
    /// Interval of the height of the body in metres.
    pub height: [f64; 3],
    /// Interval of the distance in metres of the body's top below the ceiling.
    pub drop: [f64; 3],
    /// Intervals of the position of the body's middle relative to the camera: along the horizontal room axes 0 and 2,
    /// and upwards. The unit is the metre; with LUXFER_DOUBT_SIZE it is the distance of the first lamp's middle from
    /// the camera.
    pub centre: [[f64; 3]; 3],
    /// Median distance in pixels between the outline of the lamp and the outline of the fitted body.
    pub residual: f64,
    /// Share of the outline that the photo's border cuts off, in [0, 0.3].
    pub cut: f64,
    /// Share of the lamp's pixels that the photo clips, in [0, 1]. A pixel counts as clipped if a channel is at least
    /// 98 % of the photo's largest value.
    pub clipped: f64,
    /// Vertices of the profile from bottom to top: radius, and height above the bottom, in multiples of the largest
    /// diameter. Elements from profile_count on are 0.
    pub profile: [[f32; 2]; 65],
    /// Half-width of the 95 % confidence interval of each radius of the profile, in multiples of the largest diameter.
    /// It is large where the body hides its own profile.
    pub profile_error: [f32; 65],
    /// Mean radiance of the lamp in 16 bands of equal height, from bottom to top: linear RGB in the units of the photo.
    /// Where the photo is clipped, it is only a lower bound.
    pub radiance: [[f32; 3]; 16],
    /// Outline of the fitted body in the photo, a closed polygon: x and y in pixels.
    pub contour: [[f32; 2]; 180],
    /// Reserved; always 0.
    pub reserved: u32,
}

const REPORT_SIZE: usize = 24 + 96 + 72 + 24 + 520 + 260 + 192 + 1440 + 4;

versioned!(luxfer_pendant, [REPORT_SIZE], {
    Self {
        struct_size: REPORT_SIZE as u32,
        profile_count: 0,
        kind: LUXFER_BODY_OTHER,
        doubts: 0,
        probability: 0.0,
        aspect: [0.0; 3],
        diameter: [0.0; 3],
        height: [0.0; 3],
        drop: [0.0; 3],
        centre: [[0.0; 3]; 3],
        residual: 0.0,
        cut: 0.0,
        clipped: 0.0,
        profile: [[0.0; 2]; 65],
        profile_error: [0.0; 65],
        radiance: [[0.0; 3]; 16],
        contour: [[0.0; 2]; 180],
        reserved: 0,
    }
});

const _: () = assert!(LUXFER_MAX_PENDANTS as usize == pendant::MAX_LAMPS);
/// Largest number of lamps that one call adds to a scene.
const MAX_PLACES: usize = 1024;
/// A kind with a lower probability gets LUXFER_DOUBT_KIND. [convention]
const SURE: f64 = 0.9;
/// A lamp with a larger share of clipped pixels gets LUXFER_DOUBT_CLIPPED. [convention]
const CLIPPED: f64 = 0.1;
/// If an element of `profile_error` exceeds this value (a multiple of the largest diameter), the lamp gets
/// LUXFER_DOUBT_HIDDEN. [convention]
const HIDDEN: f64 = 0.05;

impl luxfer_pendant {
    fn new(found: &Pendants, lamp: &Lamp) -> Self {
        let interval = |i: Interval| [i.value, i.low, i.high];
        let mut report = Self {
            profile_count: found.profile.len().min(65) as u32,
            kind: body(found.kind),
            doubts: doubts(found, lamp),
            probability: found.probability,
            aspect: interval(found.aspect),
            diameter: interval(found.diameter),
            height: interval(found.height),
            drop: interval(lamp.drop),
            centre: lamp.centre.map(interval),
            residual: lamp.residual,
            cut: lamp.cut,
            clipped: lamp.radiance.clipped_share(),
            ..Self::defaults()
        };
        let copy = |to: &mut [[f32; 2]], from: &[DVec2]| {
            to.iter_mut().zip(from).for_each(|(to, from)| *to = from.as_vec2().to_array());
        };
        copy(&mut report.profile, &found.profile);
        copy(&mut report.contour, &lamp.contour);
        report.radiance.iter_mut().zip(&lamp.radiance.bands).for_each(|(to, from)| *to = from.to_array());
        report.profile_error.iter_mut().zip(&found.profile_error).for_each(|(to, from)| *to = *from as f32);
        report
    }

    /// Returns the body that the struct describes. The caller may have changed the struct, so its profile_count is
    /// checked.
    fn body(&self) -> Result<Body> {
        let count = check_range("profile_count", self.profile_count, 2, 65)? as usize;
        let vertex = |&[radius, height]: &[f32; 2]| DVec2::new(f64::from(radius), f64::from(height));
        let profile = self.profile[..count].iter().map(vertex).collect();
        Ok(Body { profile, bands: self.radiance.map(Vec3::from_array).to_vec() })
    }
}

fn body(kind: Kind) -> luxfer_body {
    match kind {
        Kind::Globe => LUXFER_BODY_GLOBE,
        Kind::Spheroid => LUXFER_BODY_SPHEROID,
        Kind::Drum => LUXFER_BODY_DRUM,
        Kind::Disc => LUXFER_BODY_DISC,
        Kind::Cone => LUXFER_BODY_CONE,
        Kind::Bowl => LUXFER_BODY_BOWL,
        Kind::Dome => LUXFER_BODY_DOME,
        Kind::Other => LUXFER_BODY_OTHER,
    }
}

/// Returns the LUXFER_DOUBT_ flags of a lamp.
fn doubts(found: &Pendants, lamp: &Lamp) -> u32 {
    let all = [
        (LUXFER_DOUBT_SIZE, !found.is_metric),
        (LUXFER_DOUBT_KIND, found.probability < SURE),
        (LUXFER_DOUBT_CLIPPED, lamp.radiance.clipped_share() > CLIPPED),
        (LUXFER_DOUBT_CUT, lamp.cut > 0.0),
        (LUXFER_DOUBT_HIDDEN, found.profile_error.iter().any(|error| *error > HIDDEN)),
    ];
    all.iter().filter(|(_, applies)| *applies).map(|(flag, _)| flag).sum()
}

/// Finds the bodies of hanging lamps. photo is linear RGB. mask has the photo's size and is above 0.5 on the bodies of
/// 1 to 16 lamps, without their suspensions. Each connected region of the mask is a lamp, except regions with less than
/// 2 % of the largest region's pixels, which are ignored. Lamps are numbered in the order of their topmost pixels. view
/// is a rectification of the photo whose job has succeeded; NULL: params gives the camera. params may be NULL for
/// the defaults.
///
/// suspensions holds x and y in pixels of each of suspension_count points where a suspension meets the ceiling; NULL if
/// no suspension is marked. A point belongs to the lamp whose axis passes nearest to it in the photo; a lamp has at
/// most one point. pendants is an array of capacity structs; size is sizeof(luxfer_pendant). *count receives the number
/// of lamps, even if it exceeds capacity; only the first capacity lamps are written. The call takes about 0.2 seconds
/// for a lamp, and more for many lamps that are alike; luxfer_job_start runs it as a job. Any thread.
/// LUXFER_DEGENERATE if the mask is empty, a lamp is too small, the photo's border cuts off more than 30 % of its
/// outline, or its outline is not the outline of a body of revolution: the message says what to paint. LUXFER_NOT_READY
/// before the job of view has succeeded; LUXFER_INVALID_ARGUMENT if sizes differ, there are more than 16 lamps, or a
/// setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_pendants_find(
    context: *mut luxfer_context,
    photo: *mut luxfer_image,
    mask: *mut luxfer_image,
    view: *mut luxfer_rectify,
    suspensions: *const f64,
    suspension_count: usize,
    params: *const luxfer_pendants_params,
    pendants: *mut luxfer_pendant,
    size: usize,
    capacity: usize,
    count: *mut usize,
) -> luxfer_status {
    enter(context, |object| {
        let context = object.context();
        let out = Out::new(count, "count")?;
        // The size is checked once, for all elements.
        Report::new(pendants, size)?;
        let settings = params::read(params)?;
        let (params, known) = (settings.params()?, settings.known()?);
        let photo = handle::borrow_in(context, photo, "photo")?;
        let mask = handle::borrow_in(context, mask, "mask")?;
        let (camera, shifted) = &settings.cameras(context, view, photo.image())?;
        let suspensions = points::<2>(suspensions, suspension_count, 0, LUXFER_MAX_PENDANTS as usize, "suspension")?;
        let suspensions = &suspensions.into_iter().map(DVec2::from_array).collect::<Vec<DVec2>>();
        let input = pendant::Input { camera, shifted, suspensions, known };
        let monitor = context.monitor();
        let groups = context.quick.run(|| pendant::run(photo.image(), mask.image(), &input, &params, monitor.job()))?;
        let lamps = || groups.iter().flat_map(|found| found.lamps.iter().map(move |lamp| (found, lamp)));
        for (index, (found, lamp)) in lamps().enumerate().take(capacity) {
            Report::new(pendants.wrapping_byte_add(index * size), size)?.set(luxfer_pendant::new(found, lamp));
        }
        out.set(lamps().count());
        Ok(())
    })
}

/// Adds count meshes, 1 to 1024, to a scene. All have the body of pendant, which luxfer_pendants_find has found. places
/// holds x, y and z in metres of count points; each point becomes the centre of the upper end of one body. diameter is
/// the largest diameter in metres, in [0.001, 1e4], or 0 for the diameter that pendant states. The meshes share a new
/// material. Its emission follows the colours of the photo along the height of the body. Where the photo clips the
/// lamp, this emission is too dark. luminance is the luminance in cd/m² of a surface that has the value 1 in the photo,
/// in [0, 1e9]. *first_mesh and *material receive the index of the first new mesh and the index of the material; each
/// pointer may be NULL. Any thread.
/// LUXFER_INVALID_ARGUMENT if diameter is 0 and the lamp has LUXFER_DOUBT_SIZE, or a value is out of range;
/// LUXFER_OUT_OF_MEMORY if the memory budget would be exceeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_scene_add_pendants(
    scene: *mut luxfer_scene,
    pendant: *const luxfer_pendant,
    places: *const f64,
    count: usize,
    diameter: f32,
    luminance: f32,
    first_mesh: *mut u32,
    material: *mut u32,
) -> luxfer_status {
    enter(scene, |scene| {
        let pendant = params::read_required(pendant)?;
        if diameter == 0.0 && !(pendant.diameter[0] > 0.0) {
            return Err(Error::argument(
                "diameter is 0 and no length determines the size of the lamp; give a diameter in metres",
            ));
        }
        let diameter = if diameter == 0.0 { pendant.diameter[0] as f32 } else { diameter };
        let places = points::<3>(places, count, 1, MAX_PLACES, "place")?;
        let places: Vec<_> = places.into_iter().map(|place| DVec3::from_array(place).as_vec3()).collect();
        let body = pendant.body()?;
        let bytes = body.mesh().bytes() as u64 * count as u64;
        let (mesh, added) = scene.change(bytes, |scene| {
            let mesh = body.add_to_scene(scene, &places, &Placing { diameter, luminance })?;
            Ok((mesh, scene.materials.len() - 1))
        })?;
        set_optional(first_mesh, mesh as u32);
        set_optional(material, added as u32);
        Ok(())
    })
}

/// Reads `count` points of `N` coordinates from the caller's memory; an error unless `count` is in `[least, most]`.
/// `place` may be NULL if `count` is 0.
fn points<const N: usize>(
    place: *const f64,
    count: usize,
    least: usize,
    most: usize,
    name: &str,
) -> Result<Vec<[f64; N]>> {
    check_range(&format!("number of {name}s"), count, least, most)?;
    if count == 0 {
        return Ok(Vec::new());
    }
    let numbers = list(place, N * count, &format!("{name}s"))?;
    Ok(numbers.chunks_exact(N).map(|point| std::array::from_fn(|k| point[k])).collect())
}
