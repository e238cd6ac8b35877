//! Emission
//!
//! Synthesises an emissive texture of any size and lists its luminaires. The texture continues the light pattern of an
//! exemplar: an unwarped photo of a plane with lamps, as luxfer_rectify makes it.

use super::context::{Context, luxfer_context};
use super::emission_law::{self, LUXFER_LAW_BEST, LUXFER_LAW_COPY, luxfer_emission_law};
use super::geometry::numbers;
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::image::{Pixels, luxfer_image};
use super::job::luxfer_job;
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::scene::missing;
use super::stage::{Stage, need};
use super::status::luxfer_status;
use crate::emission::{self, Centring, Choice, Emission, LampList, Law, Luminaire, Style};
use crate::error::{Error, ErrorKind, Result};
use crate::geometry::Homography;
use crate::image::Image;
use glam::{DMat3, DVec2};
use std::borrow::Cow;
use std::sync::Arc;

/// A synthesis of an emissive texture. See luxfer_emission_create.
pub struct luxfer_emission {
    _opaque: [u8; 0],
}

/// An image of the emission: a LUXFER_EMISSION_ value.
pub type luxfer_emission_image = i32;
/// The texture: linear RGB, where 1 is the photo's white; 0 outside lamps.
pub const LUXFER_EMISSION_TEXTURE: luxfer_emission_image = 0;
/// The mask of the texture: 1 on lamps, else 0; 1 channel.
pub const LUXFER_EMISSION_MASK: luxfer_emission_image = 1;
/// The guide channels of the exemplar, by which patches are compared in addition to colour; 3 channels, at the reduced
/// resolution that working_side gives. Channel 0 is the confidence, in [0, 1], that the pixel shows a light. Channels 1
/// and 2 are the x and y offsets from the pixel to the nearest lit pixel, positive to the right and down, divided by a
/// length L and clamped to [-1, 1]; both are 1 if no pixel is lit. L is the side of a patch, but at most half the
/// longer period if the lights repeat.
pub const LUXFER_EMISSION_EXEMPLAR_GUIDES: luxfer_emission_image = 2;
/// The guide channels of the texture, at the resolution of LUXFER_EMISSION_EXEMPLAR_GUIDES: pixels of that image,
/// copied with the patches that give the texture its colours.
pub const LUXFER_EMISSION_GUIDES: luxfer_emission_image = 3;

/// Settings of an emissive texture. Fill them with luxfer_emission_params_init.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_emission_params {
    /// sizeof(luxfer_emission_params), set by luxfer_emission_params_init.
    pub struct_size: u32,
    /// Width of the texture in texels, in [1, 65536]; default 1024.
    pub width: u32,
    /// Height of the texture in texels, in [1, 65536]; default 1024.
    pub height: u32,
    /// Side of the square patches that are copied from the exemplar, in [0, 65536], in pixels of the exemplar after its
    /// reduction to working_side. 0, the default: with LUXFER_LAW_LATTICE, 1.5 times the longer period, but at most
    /// half of the exemplar's shorter side; with other laws, a quarter of the shorter side.
    pub block: u32,
    /// Number of unwarped pixels per texel, along one side, in [1e-3, 1e3]; default 1.
    pub scale: f64,
    /// Length in pixels to which the longest side of the exemplar is reduced for the synthesis, in [16, 2048]; default
    /// 256.
    pub working_side: u32,
    /// Weight of the guide channels (LUXFER_EMISSION_EXEMPLAR_GUIDES) relative to colour when patches are compared,
    /// in [0, 1e3]; default 1. 0: patches are compared by colour only, as in image quilting.
    pub guide_weight: f32,
    /// Seed of the synthesis; default 1.
    pub seed: u64,
    /// Threshold of LUXFER_LAW_CORRELATION, in [0, 1]; default 0.6. A shift counts as a period of the lights if their
    /// autocorrelation after this shift is at least this value. At 0, even a poor repetition counts. LUXFER_LAW_BEST
    /// also tries periods with a lower autocorrelation. At 1, both choose LUXFER_LAW_FREE.
    pub min_regularity: f32,
    /// 1, the default: every lamp of the texture stays in one piece; 0: seams between patches may cut lamps.
    pub whole_lamps: u32,
    /// Offset of the pattern from the texture's top-left corner, in texels to the right and down, each in [-1e6, 1e6];
    /// default 0. LUXFER_LAW_FREE has no lattice that an offset could shift: with this law, an offset other than 0 ends
    /// the job with LUXFER_INVALID_ARGUMENT. There are two exceptions. If the texture is tileable and no light is
    /// copied patch by patch (luxfer_emission_get_luminaire says which lights are), the offset shifts all lamps. With
    /// whole_lamps = 0, the offset has no effect.
    pub offset: [f64; 2],
    /// A channel of the photo counts as clipped if it is at least this value, in [0, 1]; default 0.95. The clipped
    /// core of a lamp gets the colour of the lamp's rim, at the lowest brightness that is consistent with the clipped
    /// channels. 0: no lamp counts as clipped.
    pub clip_level: f32,
    /// 1: every lamp has its mean colour over its whole area; 0, the default: lamps look as in the photo.
    pub even_lamps: u32,
    /// 1: the texture can be repeated without seams. Lamps that cross an edge of the texture continue at the opposite
    /// edge. Lights with periods are stretched so that a whole number of periods fits; the width and the height of the
    /// pattern change by less than half a period. Needs whole_lamps = 1, or else the job ends with
    /// LUXFER_INVALID_ARGUMENT. Default 0.
    pub tileable: u32,
    /// Whether the pattern is centred on the texture. A lamp, or the middle between two or four neighbouring lamps,
    /// then lies at the texture's centre, whichever lets the border cut the fewest lamps, and the field offset shifts
    /// the pattern from there. 0: not centred. 1: centred. 2, the default: centred if the texture is larger than what
    /// the photo shows of the plane; but not if it is tileable, or if the photo shows both ends of a row of lamps.
    /// No effect with LUXFER_LAW_FREE.
    pub centred: u32,
    /// For LUXFER_LAW_FREE: number of patches, drawn at random from the exemplar, that are compared for each patch of
    /// the texture; in [1, 65536]; default 192. Patches of the exemplar that continue the neighbours already placed in
    /// the texture are compared in addition.
    pub candidates: u32,
    /// Must be 0.
    pub reserved: u32,
    /// The law: the rule by which the texture continues the lights of the exemplar, a LUXFER_LAW_ value other than
    /// LUXFER_LAW_COPY; default LUXFER_LAW_BEST.
    pub law: luxfer_emission_law,
    /// 1, the default: all lamps of one kind (of about equal size and shape) that resemble rectangles or ellipses, or
    /// frames or rings, are drawn with one size and one outline, which stays sharp at any resolution. They lie exactly
    /// on their lattice. This needs the photo and whole_lamps. 0: each lamp has the outline that the mask gives.
    pub clean_lamps: u32,
    /// Maximum relative magnification of the exemplar's pixels, in [1, 1e6]; 0, the default: no limit. Unwarping
    /// magnifies distant parts of the plane more than near parts. The magnification of a pixel is its length in the
    /// unwarped photo divided by its length in the photo; the relative magnification is the magnification of the pixel
    /// divided by the magnification of the least magnified pixel of the exemplar. Pixels beyond the limit are left out,
    /// as if the photo did not show them.
    pub max_magnification: f64,
}

versioned!(luxfer_emission_params, [104], {
    let d = emission::Params::default();
    Self {
        struct_size: 104,
        width: d.width as u32,
        height: d.height as u32,
        block: d.block as u32,
        scale: d.scale,
        working_side: d.working_side as u32,
        guide_weight: d.guide_weight,
        seed: d.seed,
        min_regularity: d.min_regularity,
        whole_lamps: u32::from(d.whole_lamps),
        offset: d.offset.to_array(),
        clip_level: d.clip_level,
        even_lamps: u32::from(d.even_lamps),
        tileable: u32::from(d.tileable),
        centred: CENTRINGS.iter().position(|c| *c == d.centring).unwrap_or(0) as u32,
        candidates: d.candidates as u32,
        reserved: 0,
        law: LUXFER_LAW_BEST,
        clean_lamps: u32::from(d.clean_lamps),
        max_magnification: d.max_magnification,
    }
});

/// The meanings of `luxfer_emission_params::centred`, from 0 on.
const CENTRINGS: [Centring; 3] = [Centring::Never, Centring::Always, Centring::BeyondPhoto];

fn centring(centred: u32) -> Result<Centring> {
    let known = CENTRINGS.get(centred as usize);
    known.copied().ok_or_else(|| Error::argument(format!("emission.centred is {centred}; it must be 0, 1 or 2")))
}

impl luxfer_emission_params {
    pub(super) fn params(&self) -> Result<emission::Params> {
        if self.reserved != 0 {
            return Err(Error::argument(format!("emission.reserved is {}; it must be 0", self.reserved)));
        }
        Ok(emission::Params {
            width: self.width as usize,
            height: self.height as usize,
            scale: self.scale,
            block: self.block as usize,
            working_side: self.working_side as usize,
            guide_weight: self.guide_weight,
            offset: DVec2::from_array(self.offset),
            min_regularity: self.min_regularity,
            whole_lamps: params::flag(self.whole_lamps, "whole_lamps")?,
            even_lamps: params::flag(self.even_lamps, "even_lamps")?,
            tileable: params::flag(self.tileable, "tileable")?,
            centring: centring(self.centred)?,
            clip_level: self.clip_level,
            candidates: self.candidates as usize,
            law: emission_law::law(self.law)?,
            clean_lamps: params::flag(self.clean_lamps, "clean_lamps")?,
            max_magnification: self.max_magnification,
            seed: self.seed,
        })
    }
}

/// Description of a texture: its lamps, the law (rule) by which it continues the exemplar's lights, and its quality. A
/// composition (luxfer_emission_start_composition) has no texels yet, so its error is NaN and its sampling_error is 0.
/// If there are several exemplars, the fields regularity, law, runner_up, law_score and margin describe the first
/// exemplar.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_emission_report {
    /// sizeof(luxfer_emission_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of luminaires in the texture; see luxfer_emission_get_luminaire.
    pub luminaires: u32,
    /// Largest relative difference between texture and exemplar in three statistics: the share of lit area, the mean
    /// area of a whole lamp, and the mean distance from a whole lamp to its nearest neighbour. The value 0.1 stands for
    /// 10 %. It means little if exemplar_lamps is small. NaN for a composition.
    pub error: f64,
    /// Regularity of the lights, in [0, 1]: their autocorrelation after a shift by one period. If there are two
    /// periods, it is the lower of their two autocorrelations. 0 if the lights have no period, or if the period was
    /// found from the distances between lamps.
    pub regularity: f64,
    /// Number of whole lamps in the exemplars. If it is below six, the statistics in the field error are unreliable,
    /// because the border then cuts a large share of the lamps. If there is no whole lamp, the texture is made from the
    /// lamps that the border cuts; with clean_lamps, they are completed to rectangles unless the photo contradicts
    /// this.
    pub exemplar_lamps: u32,
    /// Estimate of the value that the field error takes by chance, because the exemplar shows only a part of its
    /// ceiling. It is the root mean square difference between the three statistics of the whole texture and the
    /// statistics of parts of the texture that are as large as the exemplar. If error is at most twice this value, it
    /// does not indicate a bad texture. 0 for LUXFER_LAW_WHOLE and LUXFER_LAW_COPY, for several exemplars, for a
    /// composition, and if the texture is too small to hold parts as large as the exemplar at clearly different places.
    pub sampling_error: f32,
    /// The law (rule) by which the texture continues the lights: a LUXFER_LAW_ value.
    pub law: luxfer_emission_law,
    /// The law with the best score among the laws that were not chosen: a LUXFER_LAW_ value. It equals the field law if
    /// the two laws differ only in their periods, or if no other law was compared.
    pub runner_up: luxfer_emission_law,
    /// Score of the chosen law, in [0, 1]: how well it predicts the position of each lamp of the photo from the other
    /// lamps. Lamps weigh in proportion to their pixels in the photo. LUXFER_LAW_WHOLE and LUXFER_LAW_FREE predict
    /// nothing and have a fixed score. NaN if no score was computed, for example because too few of the lights are
    /// whole lamps.
    pub law_score: f64,
    /// law_score minus the score of runner_up; law_score alone if no other law was compared; NaN if law_score is NaN.
    /// LUXFER_LAW_BEST prefers the law that LUXFER_LAW_CORRELATION would choose, and lattices along the axes of the
    /// room. If it has kept a preferred law although runner_up scores slightly better, the value is negative.
    pub margin: f64,
}

versioned!(luxfer_emission_report, [56], {
    Self {
        struct_size: 56,
        luminaires: 0,
        error: 0.0,
        regularity: 0.0,
        exemplar_lamps: 0,
        sampling_error: 0.0,
        law: LUXFER_LAW_COPY,
        runner_up: LUXFER_LAW_COPY,
        law_score: f64::NAN,
        margin: f64::NAN,
    }
});

/// A luminaire: one lamp of the texture.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_luminaire {
    /// sizeof(luxfer_luminaire), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of corners of the outer outline.
    pub corners: u32,
    /// Centre in texels, x to the right and y down; the texture's top-left corner is (0, 0).
    pub centre: [f64; 2],
    /// Extents of the lamp along its two principal axes, in texels, the longer one first.
    pub size: [f64; 2],
    /// Angle of the long axis, measured from x (right) towards y (down), in radians, in (-pi/2, pi/2].
    pub orientation: f64,
    /// Area in square texels, without the hole of a ring. A texel at the edge of the lamp counts with the share that
    /// the lamp covers.
    pub area: f64,
    /// This lamp's share of the luminous flux of all lamps of the texture, in [0, 1].
    pub flux_share: f64,
    /// Mean linear RGB colour, where 1 is the photo's white.
    pub colour: [f32; 3],
    /// Number of the lamp's kind, from 1. Lamps of about equal size and shape, whose areas and sides differ by at most
    /// 25 %, are of one kind; kind 1 has the most lamps. 0 if the border of the texture cuts the lamp.
    pub kind: u32,
}

versioned!(luxfer_luminaire, [80], {
    Self {
        struct_size: 80,
        corners: 0,
        centre: [0.0; 2],
        size: [0.0; 2],
        orientation: 0.0,
        area: 0.0,
        flux_share: 0.0,
        colour: [0.0; 3],
        kind: 0,
    }
});

/// An exemplar as the caller set it.
#[derive(Clone)]
pub(super) struct Exemplar {
    /// The unwarped photo, the unwarped confidence of its lights, and the mask of the pixels where both are valid.
    pub unwarped: [Arc<Pixels>; 3],
    /// The photo, and the homography from unwarped pixels to photo pixels.
    pub photo: Option<(Arc<Pixels>, Homography)>,
}

/// An exemplar that `luxfer_emission_add_style` has added.
#[derive(Clone)]
pub(super) struct AddedExemplar {
    pub exemplar: Exemplar,
    /// Number of unwarped pixels per texel, along one side.
    pub scale: f64,
    /// Weight of this exemplar at each place of the texture, in [0, 1].
    pub weights: Arc<Pixels>,
}

#[derive(Clone, Default)]
pub(super) struct Inputs {
    unwarped: Option<[Arc<Pixels>; 3]>,
    photo: Option<(Arc<Pixels>, Homography)>,
    pub styles: Vec<AddedExemplar>,
}

/// The result of the stage: a texture, or the composition of a texture.
#[derive(Default)]
pub(super) struct Output {
    pub texture: Option<Arc<Emission>>,
    pub composed: Option<Composed>,
}

/// The composition of a texture, its lamps, and the inputs that it was made from.
pub(super) struct Composed {
    pub composition: emission::Composition,
    pub lamps: LampList,
    pub inputs: Inputs,
}

impl Output {
    fn luminaires(&self) -> usize {
        let composed = self.composed.as_ref().map(|p| p.lamps.count());
        composed.or(self.texture.as_ref().map(|t| t.luminaires.len())).unwrap_or(0)
    }

    fn luminaire(&self, index: u32) -> Result<Cow<'_, Luminaire>> {
        let lamp = match (&self.composed, &self.texture) {
            (Some(Composed { composition, lamps, .. }), _) => lamps.get(composition, index as usize).map(Cow::Owned),
            (_, Some(texture)) => texture.luminaires.get(index as usize).map(Cow::Borrowed),
            _ => None,
        };
        lamp.ok_or_else(|| missing("luminaire", index, self.luminaires()))
    }
}

impl Exemplar {
    fn input(&self) -> emission::Input<'_> {
        let [unwarped, light, valid] = &self.unwarped;
        emission::Input {
            unwarped: unwarped.image(),
            light: light.image(),
            valid: valid.image(),
            photo: self.photo.as_ref().map(|(photo, to_photo)| (photo.image(), (*to_photo).into())),
        }
    }
}

impl AddedExemplar {
    fn style(&self) -> Style<'_> {
        Style { input: self.exemplar.input(), scale: self.scale, weights: self.weights.image() }
    }
}

impl Inputs {
    /// Calls `work` with the first exemplar and the added exemplars, in the form that the synthesis takes.
    pub(super) fn with<T>(&self, work: impl FnOnce(&emission::Input, &[Style]) -> Result<T>) -> Result<T> {
        let unwarped = need(&self.unwarped, "luxfer_emission_set_exemplar")?.clone();
        let first = Exemplar { unwarped, photo: self.photo.clone() };
        let styles: Vec<Style> = self.styles.iter().map(AddedExemplar::style).collect();
        work(&first.input(), &styles)
    }
}

/// Returns the texture of a stage. Returns an error if the stage has no result, or has only a composition.
fn texture(stage: &Stage<Inputs, Output>) -> Result<Arc<Emission>> {
    stage.output()?.texture.clone().ok_or_else(|| {
        Error::new(ErrorKind::NotReady, "the stage has composed a texture; luxfer_emission_start makes one as a whole")
    })
}

/// Borrows the images of an exemplar from their handles: the unwarped photo, the confidence of its lights, and the
/// mask of the pixels where both are valid.
pub(super) fn unwarped_of(
    context: &Arc<Context>,
    [unwarped, light, valid]: [*mut luxfer_image; 3],
) -> Result<[Arc<Pixels>; 3]> {
    Ok([
        handle::borrow_in(context, unwarped, "unwarped")?,
        handle::borrow_in(context, light, "light")?,
        handle::borrow_in(context, valid, "valid")?,
    ])
}

/// Borrows a photo from its handle, and reads the homography from unwarped pixels to photo pixels; `None` if `photo`
/// is NULL.
pub(super) fn photo_of(
    context: &Arc<Context>,
    photo: *mut luxfer_image,
    to_photo: *const f64,
) -> Result<Option<(Arc<Pixels>, Homography)>> {
    let Some(photo) = Pixels::optional(context, photo, "photo")? else { return Ok(None) };
    Ok(Some((photo, Homography(DMat3::from_cols_array(&numbers(to_photo, "to_photo")?).transpose()))))
}

impl Handle for luxfer_emission {
    type Object = Stage<Inputs, Output>;
    const TAG: u64 = tag(b"lux.emis");
    const NAME: &'static str = "luxfer_emission";
}

/// Creates a synthesis of an emissive texture. It has no inputs yet. The caller releases *emission. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_create(
    context: *mut luxfer_context,
    emission: *mut *mut luxfer_emission,
) -> luxfer_status {
    enter(context, |object| {
        Out::new(emission, "emission")?.set(handle::give(Stage::new(object.context(), Inputs::default())));
        Ok(())
    })
}

/// Sets the exemplar: three images of one size. unwarped is the unwarped photo (linear RGB). light is the unwarped mask
/// of the lights: the confidence that a pixel shows a light (1 channel, in [0, 1]). valid is 1 at the pixels where both
/// other images are valid, else 0 (1 channel). luxfer_emission_add_style adds more exemplars. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_set_exemplar(
    emission: *mut luxfer_emission,
    unwarped: *mut luxfer_image,
    light: *mut luxfer_image,
    valid: *mut luxfer_image,
) -> luxfer_status {
    enter(emission, |stage| {
        let exemplar = unwarped_of(stage.context(), [unwarped, light, valid])?;
        stage.change(|inputs| {
            inputs.unwarped = Some(exemplar);
            Ok(())
        })
    })
}

/// Sets the photo, from which the texture takes its full detail, and the homography from unwarped pixels to photo
/// pixels: 9 doubles row by row (luxfer_rectify_report.to_photo). If the rectification has undone a distortion, photo
/// must be the image that luxfer_rectify_undistort makes from your photo. photo may be NULL: the detail then comes from
/// the unwarped image only. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_set_photo(
    emission: *mut luxfer_emission,
    photo: *mut luxfer_image,
    to_photo: *const f64,
) -> luxfer_status {
    enter(emission, |stage| {
        let photo = photo_of(stage.context(), photo, to_photo)?;
        stage.change(|inputs| {
            inputs.photo = photo;
            Ok(())
        })
    })
}

/// Starts a job that makes the whole texture in memory. For textures that are too large for the memory, use
/// luxfer_emission_start_composition. params may be NULL for the defaults. The caller releases *job. Any thread.
/// LUXFER_INVALID_OPERATION if the exemplar is missing or a job is already running. The job may end with
/// LUXFER_DEGENERATE if the exemplar has no lights, or if the setting law asks for a lattice or a row that the lights
/// do not form; LUXFER_INVALID_ARGUMENT if sizes differ or a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_start(
    emission: *mut luxfer_emission,
    params: *const luxfer_emission_params,
    job: *mut *mut luxfer_job,
) -> luxfer_status {
    enter(emission, |stage| {
        let params = params::read(params)?.params()?;
        need(&stage.inputs().unwarped, "luxfer_emission_set_exemplar")?;
        stage.start(job, move |inputs, _, job| {
            let made = inputs.with(|input, styles| emission::blend(input, styles, &params, job))?;
            Ok(Output { texture: Some(Arc::new(made)), composed: None })
        })
    })
}

/// Gets the image that a LUXFER_EMISSION_ value selects. The caller releases *image. Any thread.
/// LUXFER_NOT_READY before a job of luxfer_emission_start has succeeded, or if a later composition has replaced its
/// texture.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_get_image(
    emission: *mut luxfer_emission,
    kind: luxfer_emission_image,
    image: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(emission, |stage| {
        let out = Out::new(image, "image")?;
        let pick: fn(&Emission) -> &Image = match kind {
            LUXFER_EMISSION_TEXTURE => |e| &e.texture,
            LUXFER_EMISSION_MASK => |e| &e.mask,
            LUXFER_EMISSION_EXEMPLAR_GUIDES => |e| &e.exemplar_metadata,
            LUXFER_EMISSION_GUIDES => |e| &e.metadata,
            _ => return Err(Error::argument(format!("kind is {kind}; it must be a LUXFER_EMISSION_ value"))),
        };
        out.set(handle::give(Pixels::part(stage.context(), texture(stage)?, pick)));
        Ok(())
    })
}

/// Gets the description of the texture, or of the composition after luxfer_emission_start_composition. size is sizeof
/// *report. Any thread.
/// LUXFER_NOT_READY before a job has succeeded.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_get_report(
    emission: *mut luxfer_emission,
    report: *mut luxfer_emission_report,
    size: usize,
) -> luxfer_status {
    enter(emission, |stage| {
        let out = Report::new(report, size)?;
        let made = stage.output()?;
        let count = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        let (error, sampling_error, regularity, exemplar_lamps) = match (&made.composed, &made.texture) {
            (Some(composed), _) => {
                (f64::NAN, 0.0, composed.composition.regularity(), composed.composition.exemplar_lamps())
            }
            (_, Some(texture)) => (texture.error, texture.sampling_error, texture.regularity, texture.exemplar_lamps),
            _ => (f64::NAN, 0.0, 0.0, 0),
        };
        let (law, choice) = match (&made.composed, &made.texture) {
            (Some(composed), _) => composed.composition.law(),
            (_, Some(texture)) => (texture.law, texture.choice),
            _ => (Law::Copy, Choice::only(Law::Copy)),
        };
        out.set(luxfer_emission_report {
            law: emission_law::number(law),
            runner_up: emission_law::number(choice.runner_up),
            law_score: choice.score,
            margin: choice.margin(),
            luminaires: count(made.luminaires()),
            error,
            regularity,
            exemplar_lamps: count(exemplar_lamps),
            sampling_error: sampling_error as f32,
            ..luxfer_emission_report::defaults()
        });
        Ok(())
    })
}

/// Describes a luminaire of the texture; index starts at 0. size is sizeof *luminaire. Any thread.
///
/// A composition (luxfer_emission_start_composition) has no texels yet. Its luminaires are measured in the exemplar,
/// and cut at the edges of the texture. Lights that are copied patch by patch are the exception: they are measured as
/// the texture will show them. These are lights that run through the whole exemplar, such as light bands, and all
/// lights if whole_lamps is 0.
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such luminaire.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_get_luminaire(
    emission: *mut luxfer_emission,
    index: u32,
    luminaire: *mut luxfer_luminaire,
    size: usize,
) -> luxfer_status {
    enter(emission, |stage| {
        let out = Report::new(luminaire, size)?;
        let output = stage.output()?;
        let lamp = output.luminaire(index)?;
        out.set(luxfer_luminaire {
            corners: lamp.outline.len() as u32,
            centre: lamp.centre.to_array(),
            size: lamp.size.to_array(),
            orientation: lamp.orientation,
            area: lamp.area,
            flux_share: lamp.flux_share,
            colour: lamp.colour.to_array(),
            kind: lamp.kind,
            ..luxfer_luminaire::defaults()
        });
        Ok(())
    })
}

/// Gets a corner of a luminaire's outline, x and y in texels as in luxfer_luminaire.centre; index and corner start at
/// 0. Any thread.
///
/// The outline runs where the lamp covers half of a texel. If the confidence of the lights has values between 0 and 1,
/// the sides of the outline are accurate to a quarter of a texel, and its corners to 0.71 texels. If unwarped pixels
/// are larger than texels, both limits are in unwarped pixels.
///
/// In three cases the outline follows the sides of texels instead: for lamps up to two texels wide, for masks of only 0
/// and 1, and for lights of a composition that are copied patch by patch (see luxfer_emission_get_luminaire).
/// LUXFER_NOT_READY before a job has succeeded; LUXFER_NOT_FOUND if there is no such luminaire or corner.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_emission_get_corner(
    emission: *mut luxfer_emission,
    index: u32,
    corner: u32,
    x: *mut f64,
    y: *mut f64,
) -> luxfer_status {
    enter(emission, |stage| {
        let (out_x, out_y) = (Out::new(x, "x")?, Out::new(y, "y")?);
        let output = stage.output()?;
        let lamp = output.luminaire(index)?;
        let point = lamp.outline.get(corner as usize).ok_or_else(|| missing("corner", corner, lamp.outline.len()))?;
        out_x.set(point.x);
        out_y.set(point.y);
        Ok(())
    })
}
