//! Rectification
//!
//! Finds vanishing points and the camera from the straight lines of a photo. If a mask marks a plane, it also unwarps
//! that plane to a frontal view. Image points are in pixels, x to the right, y down; the centre of the top-left pixel
//! is (0.5, 0.5). The room axes are the three orthogonal directions of the room: axes 0 and 2 are horizontal, axis 1 is
//! vertical. Camera space is x to the right, y down, z forward. Some values name the paper "Lighting Style Transfer":
//! this is "Single-Exemplar Lighting Style Transfer via Emissive Texture Synthesis and Optimization".

use super::context::luxfer_context;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::error::{Error, ErrorKind, Result};
use crate::geometry::FocalSource;
use crate::image::Image;
use crate::rectify::{self, LineDetector, Metric, Search, UnwarpParams, Unwarped, View};
use glam::DVec2;
use std::sync::Arc;

/// Lines, vanishing points and the unwarped plane of a photo. See luxfer_rectify_create.
pub struct luxfer_rectify {
    _opaque: [u8; 0],
}

/// The detector of lines: a LUXFER_LINES_ value.
pub type luxfer_lines = i32;
/// Fits segments with sub-pixel end points to regions of similar gradient direction (LSD, Grompone von Gioi et al.
/// 2010).
pub const LUXFER_LINES_REGIONS: luxfer_lines = 0;
/// The method of Lighting Style Transfer (section 5.1): a Hough transform of Canny edges, in which an edge pixel votes
/// only for lines nearly perpendicular to its gradient.
pub const LUXFER_LINES_HOUGH: luxfer_lines = 1;

/// The search for vanishing points: a LUXFER_SEARCH_ value.
pub type luxfer_search = i32;
/// Finds three orthogonal directions and the focal length together, then refines each direction with the lines that run
/// along it.
pub const LUXFER_SEARCH_MANHATTAN: luxfer_search = 0;
/// The method of Lighting Style Transfer, RANSAC: finds one vanishing point after the other, each from the lines that
/// do not run to an earlier vanishing point.
pub const LUXFER_SEARCH_SUCCESSIVE: luxfer_search = 1;

/// The distance of a vanishing point from a line, for LUXFER_SEARCH_SUCCESSIVE: a LUXFER_METRIC_ value.
pub type luxfer_metric = i32;
/// The distance of the detected segment's end points from the line through its midpoint and the vanishing point;
/// finite for vanishing points at infinity.
pub const LUXFER_METRIC_SEGMENT: luxfer_metric = 0;
/// The distance by Eq. 2 of Lighting Style Transfer, which may be infinite: the smaller of d and d x / y. Here d is the
/// distance of the vanishing point from the line, x is half the length of the part of the line that the photo shows,
/// and y is the distance along the line from the middle of this part to the point nearest to the vanishing point.
pub const LUXFER_METRIC_VISIBLE_LINE: luxfer_metric = 1;

/// The source of a focal length: a LUXFER_FOCAL_ value.
pub type luxfer_focal_source = i32;
/// The caller has set the focal length.
pub const LUXFER_FOCAL_GIVEN: luxfer_focal_source = 0;
/// Estimated, mainly from the vanishing points of orthogonal directions.
pub const LUXFER_FOCAL_FROM_VANISHING_POINTS: luxfer_focal_source = 1;
/// Mainly assumed: a usual value, 0.85 times the width of the photo, has a greater weight than the estimate from
/// vanishing points.
pub const LUXFER_FOCAL_ASSUMED: luxfer_focal_source = 2;
/// Mainly from the metadata of the photo's file; see luxfer_image_get_metadata.
pub const LUXFER_FOCAL_FROM_METADATA: luxfer_focal_source = 3;
/// Estimated so that the lamps have equal sizes and shapes, or lie on a lattice, in the frontal view of their plane
/// (lighting transfer only).
pub const LUXFER_FOCAL_FROM_LAMPS: luxfer_focal_source = 4;

/// An image of a rectification: a LUXFER_RECTIFY_ value.
pub type luxfer_rectify_image = i32;
/// The plane in frontal view, linear RGB.
pub const LUXFER_RECTIFY_UNWARPED: luxfer_rectify_image = 0;
/// The mask of the plane in frontal view: 1 where the mask is set and the photo's values are finite, else 0; 1 channel.
pub const LUXFER_RECTIFY_VALID: luxfer_rectify_image = 1;

/// Settings of a rectification. Fill them with luxfer_rectify_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_rectify_params {
    /// sizeof(luxfer_rectify_params), set by luxfer_rectify_params_init.
    pub struct_size: u32,
    /// Detector of lines: a LUXFER_LINES_ value; default LUXFER_LINES_REGIONS.
    pub detector: luxfer_lines,
    /// Search for vanishing points: a LUXFER_SEARCH_ value; default LUXFER_SEARCH_MANHATTAN.
    pub search: luxfer_search,
    /// Distance of a vanishing point from a line: a LUXFER_METRIC_ value; default LUXFER_METRIC_SEGMENT.
    pub metric: luxfer_metric,
    /// For LUXFER_LINES_HOUGH: largest angle in radians between a pixel's gradient and the normal of a line for which
    /// the pixel votes, in [1e-4, pi/2]; default 0.0436, which is 2.5 degrees.
    pub hough_band: f64,
    /// Focal length in pixels, in [1e-3, 1e9]; 0, the default: estimated from the lines, and from the photo's metadata
    /// if it has any.
    pub focal: f64,
    /// Principal point in pixels, x and y in [-1e9, 1e9]; NaN, the default: the image's centre.
    pub principal: [f64; 2],
    /// The two room axes that the plane spans, each 0, 1 or 2; -1, the default: estimated from the lines on the plane.
    pub plane_axes: [i32; 2],
    /// Maximum length of the longer side of the unwarped image in pixels, in [16, 16384]; default 2048. The image is
    /// smaller if the resolution of the photo does not support this size.
    pub max_side: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Limit of the magnification by unwarping, a ratio of lengths in (0, 1e6]; default 16. The farther a part of the
    /// plane is from the camera, the more its photo pixels are magnified. Parts that are magnified more than this
    /// factor times as much as the nearest part are cut off.
    pub max_magnification: f64,
    /// Seed of the search; default 1.
    pub seed: u64,
    /// Radial distortion of the lens to undo: the outward shift of the corners of the photo, as a share of their
    /// distance from its centre, in [-1, 0.2]; below 0 for barrel distortion, which wide-angle lenses have. NaN, the
    /// default: the distortion is measured. It is undone if it lies between -0.1 and -0.02, if its absolute value is at
    /// least two standard deviations, and if the lines meet better in vanishing points without it. 0: no distortion is
    /// undone.
    pub distortion: f64,
}

versioned!(luxfer_rectify_params, [88], {
    let (view, unwarp) = (rectify::Params::default(), UnwarpParams::default());
    Self {
        struct_size: 88,
        detector: LUXFER_LINES_REGIONS,
        search: LUXFER_SEARCH_MANHATTAN,
        metric: LUXFER_METRIC_SEGMENT,
        hough_band: view.hough_band,
        focal: 0.0,
        principal: [f64::NAN; 2],
        plane_axes: [-1; 2],
        max_side: unwarp.max_side as u32,
        reserved: 0,
        max_magnification: unwarp.max_magnification,
        seed: view.seed,
        distortion: f64::NAN,
    }
});

impl luxfer_rectify_params {
    pub(super) fn params(&self) -> Result<(rectify::Params, UnwarpParams)> {
        let detector = match self.detector {
            LUXFER_LINES_REGIONS => LineDetector::Regions,
            LUXFER_LINES_HOUGH => LineDetector::Hough,
            other => return Err(Error::argument(format!("detector is {other}; it must be a LUXFER_LINES_ value"))),
        };
        let search = match self.search {
            LUXFER_SEARCH_MANHATTAN => Search::Manhattan,
            LUXFER_SEARCH_SUCCESSIVE => Search::Successive,
            other => return Err(Error::argument(format!("search is {other}; it must be a LUXFER_SEARCH_ value"))),
        };
        let metric = match self.metric {
            LUXFER_METRIC_SEGMENT => Metric::Segment,
            LUXFER_METRIC_VISIBLE_LINE => Metric::VisibleLine,
            other => return Err(Error::argument(format!("metric is {other}; it must be a LUXFER_METRIC_ value"))),
        };
        let axes = match self.plane_axes {
            [-1, -1] => None,
            [a @ 0..=2, b @ 0..=2] if a != b => Some([a as usize, b as usize]),
            [a, b] => {
                return Err(Error::argument(format!(
                    "plane_axes is ({a}, {b}); it must be two different axes of 0, 1 and 2, or -1 twice"
                )));
            }
        };
        let [x, y] = self.principal;
        let view = rectify::Params {
            detector,
            search,
            metric,
            hough_band: self.hough_band,
            focal: (self.focal != 0.0).then_some(self.focal),
            expected_focal: None,
            principal: (!x.is_nan() || !y.is_nan()).then_some(DVec2::new(x, y)),
            distortion: (!self.distortion.is_nan()).then_some(self.distortion),
            seed: self.seed,
        };
        let unwarp = UnwarpParams { axes, max_side: self.max_side as usize, max_magnification: self.max_magnification };
        Ok((view, unwarp))
    }
}

/// The camera found from the lines of a photo, and the unwarping of the plane.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_rectify_report {
    /// sizeof(luxfer_rectify_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of line segments found.
    pub segments: u32,
    /// Vanishing points of the room axes, in homogeneous pixel coordinates of unit length; the third coordinate is 0
    /// at infinity. If a distortion was undone, they lie in the photo that luxfer_rectify_undistort makes.
    pub vanishing_points: [[f64; 3]; 3],
    /// Standard deviation of the direction to each vanishing point in camera space, in radians.
    pub vanishing_errors: [f64; 3],
    /// Number of segments that run to each vanishing point; 0: no segment runs to the point, which is then derived from
    /// the other vanishing points, or from the assumption that the camera is upright.
    pub vanishing_support: [u32; 3],
    /// Source of the focal length: a LUXFER_FOCAL_ value.
    pub focal_source: luxfer_focal_source,
    /// Focal length in pixels.
    pub focal: f64,
    /// Principal point in pixels.
    pub principal: [f64; 2],
    /// Room axes as unit vectors in camera space: axis 0 points right, axis 1 down, axis 2 forward.
    pub axes: [[f64; 3]; 3],
    /// 1 if the plane has been unwarped; 0 if not: the fields from to_photo to aspect_confidence are then 0.
    pub is_unwarped: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Homography from unwarped pixels to photo pixels: a 3 x 3 matrix, row by row. With it, luxfer_image_warp unwarps
    /// other images of the photo's size, such as the confidence of the lights. If a distortion was undone, it leads to
    /// the pixels of the photo that luxfer_rectify_undistort makes; undistort the other images first.
    pub to_photo: [f64; 9],
    /// Corners of the unwarped rectangle in the photo, x and y in pixels: top left, then clockwise.
    pub corners: [[f64; 2]; 4],
    /// Expected error of each corner, in unwarped pixels.
    pub corner_errors: [f64; 4],
    /// Length of an unwarped pixel's side on the plane, divided by the camera's distance from the plane.
    pub pixel_size: f64,
    /// Confidence of the aspect ratio, 1 / (1 + (s / 0.1)²), where s is its relative standard deviation; in [0, 1]. It
    /// is low if the focal length was assumed.
    pub aspect_confidence: f64,
    /// Lens distortion: the outward shift of the corners of the photo, as a share of their distance from its centre;
    /// below 0 for barrel distortion, which wide-angle lenses have. It is estimated from the curvature of straight
    /// edges. NaN if the photo has too few lines.
    pub distortion: f64,
    /// Standard deviation of the field distortion; NaN if distortion is NaN.
    pub distortion_error: f64,
    /// For each axis, the angle between the two other axes minus 90 degrees, in radians. For this angle, each of the
    /// two axes is estimated only from the lines that run along that axis; the vectors of the field axes, in contrast,
    /// are always orthogonal. The value differs from 0 if walls are oblique, pixels are not square or the principal
    /// point is wrong. NaN if one of the two axes has no lines.
    pub squareness: [f64; 3],
    /// Standard deviations of the field squareness; NaN where squareness is NaN.
    pub squareness_errors: [f64; 3],
    /// The distortion that was undone, in the unit of the field distortion; 0 if no distortion was undone. It equals
    /// luxfer_rectify_params.distortion or, if that is NaN, the measured distortion.
    pub undone: f64,
}

const REPORT_SIZE: usize = 8 + 72 + 24 + 16 + 24 + 72 + 8 + 72 + 64 + 32 + 32 + 48 + 8;

versioned!(luxfer_rectify_report, [REPORT_SIZE - 8, REPORT_SIZE], {
    Self {
        struct_size: REPORT_SIZE as u32,
        segments: 0,
        vanishing_points: [[0.0; 3]; 3],
        vanishing_errors: [0.0; 3],
        vanishing_support: [0; 3],
        focal_source: 0,
        focal: 0.0,
        principal: [0.0; 2],
        axes: [[0.0; 3]; 3],
        is_unwarped: 0,
        reserved: 0,
        to_photo: [0.0; 9],
        corners: [[0.0; 2]; 4],
        corner_errors: [0.0; 4],
        pixel_size: 0.0,
        aspect_confidence: 0.0,
        distortion: f64::NAN,
        distortion_error: f64::NAN,
        squareness: [f64::NAN; 3],
        squareness_errors: [f64::NAN; 3],
        undone: 0.0,
    }
});

impl luxfer_rectify_report {
    pub(super) fn new(view: &View, unwarped: Option<&Unwarped>) -> Self {
        let camera = &view.perspective;
        let point = |i: usize| &view.vanishing_points[i];
        let report = Self {
            segments: u32::try_from(view.segments.len()).unwrap_or(u32::MAX),
            vanishing_points: [0, 1, 2].map(|i| point(i).point.to_array()),
            vanishing_errors: [0, 1, 2].map(|i| point(i).error),
            vanishing_support: [0, 1, 2].map(|i| u32::try_from(point(i).support).unwrap_or(u32::MAX)),
            focal_source: match camera.focal_source {
                FocalSource::Given => LUXFER_FOCAL_GIVEN,
                FocalSource::VanishingPoints => LUXFER_FOCAL_FROM_VANISHING_POINTS,
                FocalSource::Assumed => LUXFER_FOCAL_ASSUMED,
                FocalSource::Metadata => LUXFER_FOCAL_FROM_METADATA,
                FocalSource::Lamps => LUXFER_FOCAL_FROM_LAMPS,
            },
            focal: camera.focal,
            principal: camera.principal.to_array(),
            axes: camera.axes.to_cols_array_2d(),
            distortion: view.distortion.map_or(f64::NAN, |d| d.corner),
            distortion_error: view.distortion.map_or(f64::NAN, |d| d.error),
            squareness: view.squareness.map(|s| s.map_or(f64::NAN, |s| s.angle)),
            squareness_errors: view.squareness.map(|s| s.map_or(f64::NAN, |s| s.error)),
            undone: view.undone,
            ..Self::defaults()
        };
        let Some(unwarped) = unwarped else { return report };
        Self {
            is_unwarped: 1,
            to_photo: unwarped.to_photo.homography.0.transpose().to_cols_array(),
            corners: unwarped.corners.map(|c| c.to_array()),
            corner_errors: unwarped.corner_error,
            pixel_size: unwarped.pixel_size,
            aspect_confidence: unwarped.aspect_confidence,
            ..report
        }
    }
}

#[derive(Clone, Default)]
pub(super) struct Inputs {
    photo: Option<Arc<Pixels>>,
    mask: Option<Arc<Pixels>>,
}

pub(super) struct Output {
    pub(super) view: Arc<View>,
    pub(super) unwarped: Option<Arc<Unwarped>>,
    /// The photo in which the view was found, and the settings with which it was found. A later job uses the view again
    /// if both are unchanged.
    found_in: Arc<Pixels>,
    found_with: rectify::Params,
}

impl Handle for luxfer_rectify {
    type Object = Stage<Inputs, Output>;
    const TAG: u64 = tag(b"lux.rect");
    const NAME: &'static str = "luxfer_rectify";
}

fn unwarped(output: &Output) -> Result<&Arc<Unwarped>> {
    output.unwarped.as_ref().ok_or_else(|| {
        Error::new(ErrorKind::NotReady, "no plane has been unwarped yet; set its mask and start the stage again")
    })
}

/// Creates a rectification. It has no inputs yet. The caller releases *rectify. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_rectify_create(
    context: *mut luxfer_context,
    rectify: *mut *mut luxfer_rectify,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(rectify, "rectify")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the photo: linear RGB. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_rectify_set_photo(
    rectify: *mut luxfer_rectify,
    photo: *mut luxfer_image,
) -> luxfer_status {
    enter(rectify, |stage| {
        let photo = handle::borrow_in(stage.context(), photo, "photo")?;
        stage.change(|inputs| {
            inputs.photo = Some(photo);
            Ok(())
        })
    })
}

/// Sets the mask of the plane to unwarp: 1 on the plane, 0 elsewhere; 1 channel, the photo's size. mask may be NULL:
/// the job then finds only lines, vanishing points and the camera. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_rectify_set_mask(
    rectify: *mut luxfer_rectify,
    mask: *mut luxfer_image,
) -> luxfer_status {
    enter(rectify, |stage| {
        let mask = Pixels::optional(stage.context(), mask, "mask")?;
        stage.change(|inputs| {
            inputs.mask = mask;
            Ok(())
        })
    })
}

/// Starts a job that finds lines, vanishing points and the camera, and unwarps the plane if its mask is set. If an
/// earlier job with equal settings has found the camera of this photo, the job uses that camera. params may be NULL
/// for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the photo is missing or a job is already running. The job may end with LUXFER_DEGENERATE
/// if there are no lines, the mask is empty or the plane is seen edge-on, LUXFER_INVALID_ARGUMENT if sizes differ or a
/// setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_rectify_start(
    rectify: *mut luxfer_rectify,
    params: *const luxfer_rectify_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(rectify, |stage| {
        let (params, unwarp_params) = params::read(params)?.params()?;
        need(&stage.inputs().photo, "luxfer_rectify_set_photo")?;
        stage.start(job, move |inputs, stage, job| {
            let photo = need(&inputs.photo, "luxfer_rectify_set_photo")?;
            let params = rectify::Params { expected_focal: photo.metadata().expected_focal(), ..params };
            let known = stage.output().ok().filter(|o| Arc::ptr_eq(&o.found_in, photo) && o.found_with == params);
            let view = match known {
                Some(output) => output.view.clone(),
                None => Arc::new(rectify::find_view(photo.image(), &params, job.part(0.0, 0.5))?),
            };
            let unwarped = match &inputs.mask {
                Some(mask) => Some(Arc::new(rectify::unwarp(
                    photo.image(),
                    &view,
                    mask.image(),
                    &unwarp_params,
                    job.part(0.5, 1.0),
                )?)),
                None => None,
            };
            Ok(Output { view, unwarped, found_in: photo.clone(), found_with: params })
        })
    })
}

/// Gets the image that kind, a LUXFER_RECTIFY_ value, selects: the unwarped plane or its mask. The caller releases
/// *image. Any thread.
/// LUXFER_NOT_READY before a job with a mask has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_rectify_get_image(
    rectify: *mut luxfer_rectify,
    kind: luxfer_rectify_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(rectify, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Unwarped) -> &Image = match kind {
            LUXFER_RECTIFY_UNWARPED => |u| &u.image,
            LUXFER_RECTIFY_VALID => |u| &u.valid,
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_RECTIFY_ value"))),
        };
        let output = stage.output()?;
        out.set(handle::give(Pixels::part(stage.context(), unwarped(&output)?.clone(), pick)));
        Ok(())
    })
}

/// Undoes the distortion of the lens in an image of the photo's size, such as the photo or a mask: makes the image that
/// an ideal lens would have taken, with the same size and principal point. Pixels beyond the image are 0. If no
/// distortion was undone, the new image equals the given image. The caller releases *undistorted. Any thread.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_INVALID_ARGUMENT if the image has not the photo's size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_rectify_undistort(
    rectify: *mut luxfer_rectify,
    image: *mut luxfer_image,
    undistorted: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(rectify, |stage| {
        let out = Out::new(undistorted, "undistorted")?;
        let context = stage.context();
        let image = handle::borrow_in(context, image, "image")?;
        let output = stage.output()?;
        output.found_in.image().check_same_size("photo", image.image(), "image")?;
        let lens = output.view.perspective.lens();
        let source = image.image();
        let made = Pixels::counted(context, source.width, source.height, source.channels, || {
            context.quick.run(|| rectify::undistort(source, &lens, context.monitor().job()))
        })?;
        out.set(handle::give(made));
        Ok(())
    })
}

/// Gets the camera and the unwarping, with their errors. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_rectify_get_report(
    rectify: *mut luxfer_rectify,
    report: *mut luxfer_rectify_report,
    size: usize,
) -> luxfer_status {
    enter(rectify, |stage| {
        let out = Report::new(report, size)?;
        let output = stage.output()?;
        out.set(luxfer_rectify_report::new(&output.view, output.unwarped.as_deref()));
        Ok(())
    })
}
