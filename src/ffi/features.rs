//! Features
//!
//! Computes ten values for each pixel of a photo, its features, by which segmentation compares pixels: colour, depth,
//! position and normal. The depth comes from the first source that is available: (1) a depth map of the caller; (2) a
//! network in an ONNX file; (3) a box-shaped room, which is fitted to the lines that a luxfer_rectify has found and to
//! strokes on one plane of the room; (4) a fixed default that does not depend on the photo.

use super::context::luxfer_context;
use super::depth::{depth_kind, luxfer_depth_kind};
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::{Out, text};
use super::rectify::luxfer_rectify;
use super::stage::{Stage, need};
use super::status::luxfer_status;
use super::strokes::{Painted, luxfer_strokes};
use crate::error::{Error, ErrorKind, Result};
#[cfg(feature = "onnx")]
use crate::features::DepthNetwork;
use crate::features::{self, DepthKind, DepthSource, Features, PlaneStroke};
use crate::image::Image;
#[cfg(feature = "onnx")]
use crate::image::io;
use crate::rectify::View;
use crate::segment::Stroke;
use std::ffi::c_char;
#[cfg(feature = "onnx")]
use std::path::Path;
use std::sync::Arc;

/// Stands in for the network in builds without the Cargo feature onnx; no value of this type exists.
#[cfg(not(feature = "onnx"))]
enum DepthNetwork {}

/// The features of a photo. See luxfer_features_create.
pub struct luxfer_features {
    _opaque: [u8; 0],
}

/// An image of the features: a LUXFER_FEATURES_ value.
pub type luxfer_features_image = i32;
/// The ten features, one channel each: L*, a*, b* (CIELAB, D65); depth; position x, y, z; unit normal x, y, z, towards
/// the camera. The depth is (1/near - 1/z) / (1/near - 1/far), where z is the distance along the viewing axis, near is
/// near_plane and far is far_plane. Positions are relative to the camera, in the unit of near_plane. The axes are x
/// right, y down, z forward: the axes of the camera or, after luxfer_features_set_view, of the room. luxfer_image_read
/// reads up to four channels at a time.
pub const LUXFER_FEATURES_CHANNELS: luxfer_features_image = 0;
/// Confidence of the depth of each pixel, in [0, 1]; 1 channel.
pub const LUXFER_FEATURES_DEPTH_CONFIDENCE: luxfer_features_image = 1;
/// The distance along the viewing axis that a network has estimated, in [near_plane, far_plane]; 1 channel. Set it as
/// the depth map of later jobs, or of a luxfer_transfer, to avoid running the network again.
pub const LUXFER_FEATURES_NETWORK_DEPTH: luxfer_features_image = 2;

/// Normalisation of the colours that a network expects as its input: a LUXFER_NORMALISATION_ value. The library first
/// clamps the linear photo to [0, 1] and encodes it as sRGB. An ONNX file does not state the normalisation, so the
/// caller must.
pub type luxfer_normalisation = i32;
/// Chosen by the size of the network's input: LUXFER_NORMALISATION_IMAGENET for 256 x 256, else
/// LUXFER_NORMALISATION_HALF.
pub const LUXFER_NORMALISATION_BY_SIZE: luxfer_normalisation = 0;
/// (sRGB - (0.485, 0.456, 0.406)) / (0.229, 0.224, 0.225), for MiDaS 2.1, large and small.
pub const LUXFER_NORMALISATION_IMAGENET: luxfer_normalisation = 1;
/// (sRGB - 0.5) / 0.5, for DPT.
pub const LUXFER_NORMALISATION_HALF: luxfer_normalisation = 2;
/// No normalisation: sRGB in [0, 1].
pub const LUXFER_NORMALISATION_NONE: luxfer_normalisation = 3;

/// The source of the depth: a LUXFER_DEPTH_FROM_ value.
pub type luxfer_depth_source = i32;
/// The caller's depth map.
pub const LUXFER_DEPTH_FROM_CALLER: luxfer_depth_source = 0;
/// A box-shaped room fitted to the lines of the photo and to strokes.
pub const LUXFER_DEPTH_FROM_LAYOUT: luxfer_depth_source = 1;
/// No source: a fixed depth that does not depend on the photo.
pub const LUXFER_DEPTH_FROM_NOTHING: luxfer_depth_source = 2;
/// The caller's network.
pub const LUXFER_DEPTH_FROM_NETWORK: luxfer_depth_source = 3;

/// Settings of the features. Fill them with luxfer_features_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_features_params {
    /// sizeof(luxfer_features_params), set by luxfer_features_params_init.
    pub struct_size: u32,
    /// Distance of the near plane, where the depth channel is 0, in [1e-3, 1e3]; default 1. All depths are multiplied
    /// by one factor, so that the nearest part of the photo (the 2 % quantile of its depths) lies on this plane. The
    /// unit of length is therefore arbitrary.
    pub near_plane: f32,
    /// Distance of the far plane, where the depth channel is 1, in the unit of near_plane and in [1.001, 1e6] times
    /// near_plane; default 10.
    pub far_plane: f32,
    /// Half the width, in pixels, of the square window around a pixel in which a plane is fitted to find the normal of
    /// the pixel; in [0, 64]. 0, the default: 1 % of the photo's width, but at least 2 and at most 64.
    pub normal_radius: u32,
}

versioned!(luxfer_features_params, [16], {
    let features::Params { near, far, normal_radius } = features::Params::default();
    Self { struct_size: 16, near_plane: near, far_plane: far, normal_radius: normal_radius as u32 }
});

impl luxfer_features_params {
    pub(super) fn params(&self) -> features::Params {
        features::Params { near: self.near_plane, far: self.far_plane, normal_radius: self.normal_radius as usize }
    }
}

/// Quality of the features.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_features_report {
    /// sizeof(luxfer_features_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Source of the depth: a LUXFER_DEPTH_FROM_ value.
    pub depth_source: luxfer_depth_source,
    /// Mean confidence of the depth, in [0, 1].
    pub depth_confidence: f64,
    /// Number of pixels of the photo that were NaN, infinite or negative and were replaced by values of their
    /// neighbours.
    pub replaced_pixels: u64,
}

versioned!(luxfer_features_report, [24], {
    Self { struct_size: 24, depth_source: 0, depth_confidence: 0.0, replaced_pixels: 0 }
});

#[derive(Clone, Default)]
pub(super) struct Inputs {
    photo: Option<Arc<Pixels>>,
    depth: Option<(Arc<Pixels>, DepthKind)>,
    network: Option<Arc<DepthNetwork>>,
    view: Option<Arc<View>>,
    strokes: Painted<Vec<Stroke>>,
}

/// The features of a photo, and the depth map if a network has estimated one.
pub(super) struct Output {
    pub(super) features: Arc<Features>,
    network_depth: Option<Image>,
}

impl Handle for luxfer_features {
    type Object = Stage<Inputs, Output>;
    const TAG: u64 = tag(b"lux.feat");
    const NAME: &'static str = "luxfer_features";
}

/// Creates an object that computes features. It has no inputs yet. The caller releases *features. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_create(
    context: *mut luxfer_context,
    features: *mut *mut luxfer_features,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(features, "features")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the photo: linear RGB, 1 = display white. Strokes for a photo of another size are removed. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_set_photo(
    features: *mut luxfer_features,
    photo: *mut luxfer_image,
) -> luxfer_status {
    enter(features, |stage| {
        let photo = handle::borrow_in(stage.context(), photo, "photo")?;
        stage.change(|inputs| {
            inputs.strokes.keep_for(photo.size());
            inputs.photo = Some(photo);
            Ok(())
        })
    })
}

/// Sets a depth map of the photo; kind is a LUXFER_DEPTH_ value. depth may be NULL: no depth map. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_set_depth(
    features: *mut luxfer_features,
    depth: *mut luxfer_image,
    kind: luxfer_depth_kind,
) -> luxfer_status {
    enter(features, |stage| {
        let kind = depth_kind(kind)?;
        let depth = Pixels::optional(stage.context(), depth, "depth")?;
        stage.change(|inputs| {
            inputs.depth = depth.map(|depth| (depth, kind));
            Ok(())
        })
    })
}

/// Sets a network in an ONNX file, which estimates the depth if there is no depth map; path is UTF-8. The network has
/// one input: the photo as a float tensor [1, 3, rows, columns], with up to 4096 rows and columns. Its first output is
/// a map of relative inverse depth, as MiDaS and DPT compute it. The library converts the map to depths in
/// [near_plane, far_plane]: the nearest pixel gets near_plane, the farthest far_plane (LUXFER_FEATURES_NETWORK_DEPTH).
/// These depths then serve as a depth map, which the setting near_plane scales once more. normalisation is a
/// LUXFER_NORMALISATION_ value. path may be NULL: no network. The call reads the file, which is not needed afterwards.
/// Any thread.
/// LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is damaged; LUXFER_UNSUPPORTED if it needs an operator
/// that the library does not support, or if the library was built without the Cargo feature onnx.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_set_network(
    features: *mut luxfer_features,
    path: *const c_char,
    normalisation: luxfer_normalisation,
) -> luxfer_status {
    enter(features, |stage| {
        let network = if path.is_null() { None } else { Some(Arc::new(network(text(path, "path")?, normalisation)?)) };
        stage.change(|inputs| {
            inputs.network = network;
            Ok(())
        })
    })
}

#[cfg(feature = "onnx")]
fn network(path: &str, normalisation: luxfer_normalisation) -> Result<DepthNetwork> {
    use crate::features::Normalisation;
    let normalisation = match normalisation {
        LUXFER_NORMALISATION_BY_SIZE => Normalisation::BySize,
        LUXFER_NORMALISATION_IMAGENET => Normalisation::ImageNet,
        LUXFER_NORMALISATION_HALF => Normalisation::Half,
        LUXFER_NORMALISATION_NONE => Normalisation::None,
        other => {
            return Err(Error::argument(format!("normalisation is {other}; it must be a LUXFER_NORMALISATION_ value")));
        }
    };
    DepthNetwork::parse(&io::read_file(Path::new(path))?, normalisation).map_err(|error| error.context(path))
}

#[cfg(not(feature = "onnx"))]
fn network(path: &str, _: luxfer_normalisation) -> Result<DepthNetwork> {
    Err(Error::left_out("networks were", "onnx").context(path))
}

/// Computes the features. If the caller has set a network and no depth map, the network estimates the depth.
#[cfg(feature = "onnx")]
fn compute(
    input: &features::Input,
    network: Option<&DepthNetwork>,
    params: &features::Params,
    job: crate::job::Job,
) -> Result<Output> {
    let Some(network) = network.filter(|_| input.depth.is_none()) else {
        return Ok(Output { features: Arc::new(features::run(input, params, job)?), network_depth: None });
    };
    let (features, depth) = features::run_with_network(input, network, params, job)?;
    Ok(Output { features: Arc::new(features), network_depth: Some(depth) })
}

#[cfg(not(feature = "onnx"))]
fn compute(
    input: &features::Input,
    _: Option<&DepthNetwork>,
    params: &features::Params,
    job: crate::job::Job,
) -> Result<Output> {
    Ok(Output { features: Arc::new(features::run(input, params, job)?), network_depth: None })
}

/// Sets the lines and the camera that a luxfer_rectify has found in this photo; the call copies its latest result.
/// rectify may be NULL: no lines. Any thread.
/// LUXFER_NOT_READY if rectify has no result yet.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_set_view(
    features: *mut luxfer_features,
    rectify: *mut luxfer_rectify,
) -> luxfer_status {
    enter(features, |stage| {
        let view = if rectify.is_null() {
            None
        } else {
            Some(handle::borrow_in(stage.context(), rectify, "rectify")?.output()?.view.clone())
        };
        stage.change(|inputs| {
            inputs.view = view;
            Ok(())
        })
    })
}

/// Sets strokes that guide the fit of a box-shaped room to the lines that luxfer_features_set_view has set. The fit
/// prefers rooms in which one surface, such as the ceiling, contains all positive strokes (of both phases,
/// LUXFER_PHASE_PLANE and LUXFER_PHASE_LIGHTS) and no negative stroke of LUXFER_PHASE_PLANE. The strokes have no effect
/// if the depth comes from another source. The call copies the strokes, which replace earlier strokes; NULL removes
/// them. Any thread.
/// LUXFER_INVALID_ARGUMENT if the strokes are for images of another size than the photo.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_set_strokes(
    features: *mut luxfer_features,
    strokes: *mut luxfer_strokes,
) -> luxfer_status {
    enter(features, |stage| {
        let strokes = Painted::copy(stage.context(), strokes, |set| Ok(set.plane_examples()))?;
        stage.change(|inputs| {
            strokes.check_size(inputs.photo.as_ref().map(|photo| photo.size()), "the photo")?;
            inputs.strokes = strokes;
            Ok(())
        })
    })
}

/// Starts a job that computes the features. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the photo is missing or a job is already running. The job may end with
/// LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of range, LUXFER_DEGENERATE if the depth map is all
/// holes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_start(
    features: *mut luxfer_features,
    params: *const luxfer_features_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(features, |stage| {
        let params = params::read(params)?.params();
        need(&stage.inputs().photo, "luxfer_features_set_photo")?;
        stage.start(job, move |inputs, _, job| {
            let photo = need(&inputs.photo, "luxfer_features_set_photo")?.image();
            let depth = inputs.depth.as_ref();
            let painted = inputs.strokes.taken.iter();
            let strokes: Vec<_> = painted.map(|s| PlaneStroke { pixels: &s.pixels, positive: s.positive }).collect();
            let input = features::Input {
                photo,
                depth: depth.map(|(image, kind)| features::DepthMap { image: image.image(), kind: *kind }),
                room: inputs.view.as_ref().map(|view| features::RoomView {
                    perspective: &view.perspective,
                    segments: &view.segments,
                    strokes: &strokes,
                    layout: None,
                }),
            };
            compute(&input, inputs.network.as_deref(), &params, job)
        })
    })
}

/// Gets the image of the result that a LUXFER_FEATURES_ value selects. The caller releases *image. Any thread.
/// LUXFER_NOT_READY before a job has succeeded, and for LUXFER_FEATURES_NETWORK_DEPTH if the job has not run a
/// network.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_get_image(
    features: *mut luxfer_features,
    kind: luxfer_features_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(features, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Output) -> &Image = match kind {
            LUXFER_FEATURES_CHANNELS => |f| &f.features.image,
            LUXFER_FEATURES_DEPTH_CONFIDENCE => |f| &f.features.depth_confidence,
            LUXFER_FEATURES_NETWORK_DEPTH => |f| f.network_depth.as_ref().unwrap_or(&f.features.depth_confidence),
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_FEATURES_ value"))),
        };
        let output = stage.output()?;
        if kind == LUXFER_FEATURES_NETWORK_DEPTH && output.network_depth.is_none() {
            return Err(Error::new(
                ErrorKind::NotReady,
                "no network has estimated the depth; call luxfer_features_set_network, without a depth map, and start the stage",
            ));
        }
        out.set(handle::give(Pixels::part(stage.context(), output, pick)));
        Ok(())
    })
}

/// Gets the quality of the features. size is sizeof *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_features_get_report(
    features: *mut luxfer_features,
    report: *mut luxfer_features_report,
    size: usize,
) -> luxfer_status {
    enter(features, |stage| {
        let out = Report::new(report, size)?;
        let output = stage.output()?.features.clone();
        let confidence = &output.depth_confidence.data;
        out.set(luxfer_features_report {
            depth_source: match output.depth_source {
                DepthSource::Caller => LUXFER_DEPTH_FROM_CALLER,
                DepthSource::Network => LUXFER_DEPTH_FROM_NETWORK,
                DepthSource::Layout => LUXFER_DEPTH_FROM_LAYOUT,
                DepthSource::Neutral => LUXFER_DEPTH_FROM_NOTHING,
            },
            depth_confidence: confidence.iter().map(|&c| f64::from(c)).sum::<f64>() / confidence.len() as f64,
            replaced_pixels: output.non_finite as u64,
            ..luxfer_features_report::defaults()
        });
        Ok(())
    })
}
