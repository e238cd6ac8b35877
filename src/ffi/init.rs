//! Settings
//!
//! Every struct of settings starts with its size, and luxfer_init fills it with the defaults. C and C++ programs call
//! the inline function that follows each struct, such as luxfer_render_params_init(&params, sizeof params), whose
//! argument the compiler checks; programs in other languages call luxfer_init.

use super::context::luxfer_context_params;
use super::daylight::{luxfer_sky_params, luxfer_sun_params};
use super::demo_photo::luxfer_demo_photo_params;
use super::emission::luxfer_emission_params;
use super::exposures::luxfer_merge_params;
use super::false_colour::luxfer_false_colour_params;
use super::features::luxfer_features_params;
use super::gonio::luxfer_gonio_params;
use super::guard::guard;
use super::guides::luxfer_guides_params;
use super::illuminance::{luxfer_illuminance_grid, luxfer_illuminance_params};
use super::image::luxfer_image_view;
use super::importance::luxfer_importance_params;
use super::lamps::luxfer_lamps_params;
use super::params;
use super::pattern::luxfer_pattern_params;
use super::pendants::luxfer_pendants_params;
use super::photometry::luxfer_glare_params;
use super::placement::luxfer_placement_params;
use super::plan::luxfer_plan_params;
use super::rectify::luxfer_rectify_params;
use super::relight::luxfer_relight_params;
use super::render::luxfer_render_params;
use super::render_parts::luxfer_render_part;
use super::scene_lights::{luxfer_light_params, luxfer_luminaire_params};
use super::scene_load::luxfer_scene_load_params;
use super::scene_materials::luxfer_material_params;
use super::scene_parts::{luxfer_camera_params, luxfer_mesh_params};
use super::segment::luxfer_segment_params;
use super::sheet::luxfer_sheet_params;
use super::status::luxfer_status;
#[cfg(feature = "stylize")]
use super::stylize_params::luxfer_stylize_params;
use super::transfer::luxfer_transfer_params;
use crate::error::Error;
use std::ffi::c_void;

/// The type of a struct of settings: a LUXFER_STRUCT_ value.
pub type luxfer_struct_type = i32;
/// The struct luxfer_context_params.
pub const LUXFER_STRUCT_CONTEXT_PARAMS: luxfer_struct_type = 0;
/// The struct luxfer_image_view.
pub const LUXFER_STRUCT_IMAGE_VIEW: luxfer_struct_type = 1;
/// The struct luxfer_scene_load_params.
pub const LUXFER_STRUCT_SCENE_LOAD_PARAMS: luxfer_struct_type = 2;
/// The struct luxfer_material_params.
pub const LUXFER_STRUCT_MATERIAL_PARAMS: luxfer_struct_type = 3;
/// The struct luxfer_mesh_params.
pub const LUXFER_STRUCT_MESH_PARAMS: luxfer_struct_type = 4;
/// The struct luxfer_camera_params.
pub const LUXFER_STRUCT_CAMERA_PARAMS: luxfer_struct_type = 5;
/// The struct luxfer_light_params.
pub const LUXFER_STRUCT_LIGHT_PARAMS: luxfer_struct_type = 6;
/// The struct luxfer_luminaire_params.
pub const LUXFER_STRUCT_LUMINAIRE_PARAMS: luxfer_struct_type = 7;
/// The struct luxfer_render_params.
pub const LUXFER_STRUCT_RENDER_PARAMS: luxfer_struct_type = 8;
/// The struct luxfer_rectify_params.
pub const LUXFER_STRUCT_RECTIFY_PARAMS: luxfer_struct_type = 9;
/// The struct luxfer_features_params.
pub const LUXFER_STRUCT_FEATURES_PARAMS: luxfer_struct_type = 10;
/// The struct luxfer_segment_params.
pub const LUXFER_STRUCT_SEGMENT_PARAMS: luxfer_struct_type = 11;
/// The struct luxfer_emission_params.
pub const LUXFER_STRUCT_EMISSION_PARAMS: luxfer_struct_type = 12;
/// The struct luxfer_relight_params.
pub const LUXFER_STRUCT_RELIGHT_PARAMS: luxfer_struct_type = 13;
/// The struct luxfer_pattern_params.
pub const LUXFER_STRUCT_PATTERN_PARAMS: luxfer_struct_type = 14;
/// The struct luxfer_transfer_params.
pub const LUXFER_STRUCT_TRANSFER_PARAMS: luxfer_struct_type = 15;
/// The struct luxfer_illuminance_params.
pub const LUXFER_STRUCT_ILLUMINANCE_PARAMS: luxfer_struct_type = 16;
/// The struct luxfer_illuminance_grid.
pub const LUXFER_STRUCT_ILLUMINANCE_GRID: luxfer_struct_type = 17;
/// The struct luxfer_lamps_params.
pub const LUXFER_STRUCT_LAMPS_PARAMS: luxfer_struct_type = 18;
/// The struct luxfer_importance_params.
pub const LUXFER_STRUCT_IMPORTANCE_PARAMS: luxfer_struct_type = 19;
/// The struct luxfer_placement_params.
pub const LUXFER_STRUCT_PLACEMENT_PARAMS: luxfer_struct_type = 20;
/// The struct luxfer_false_colour_params.
pub const LUXFER_STRUCT_FALSE_COLOUR_PARAMS: luxfer_struct_type = 21;
/// The struct luxfer_guides_params.
pub const LUXFER_STRUCT_GUIDES_PARAMS: luxfer_struct_type = 22;
/// The struct luxfer_stylize_params.
pub const LUXFER_STRUCT_STYLIZE_PARAMS: luxfer_struct_type = 23;
/// The struct luxfer_sheet_params.
pub const LUXFER_STRUCT_SHEET_PARAMS: luxfer_struct_type = 24;
/// The struct luxfer_plan_params.
pub const LUXFER_STRUCT_PLAN_PARAMS: luxfer_struct_type = 25;
/// The struct luxfer_render_part.
pub const LUXFER_STRUCT_RENDER_PART: luxfer_struct_type = 26;
/// The struct luxfer_demo_photo_params.
pub const LUXFER_STRUCT_DEMO_PHOTO_PARAMS: luxfer_struct_type = 27;
/// The struct luxfer_pendants_params.
pub const LUXFER_STRUCT_PENDANTS_PARAMS: luxfer_struct_type = 28;
/// The struct luxfer_merge_params.
pub const LUXFER_STRUCT_MERGE_PARAMS: luxfer_struct_type = 29;
/// The struct luxfer_gonio_params.
pub const LUXFER_STRUCT_GONIO_PARAMS: luxfer_struct_type = 30;
/// The struct luxfer_glare_params.
pub const LUXFER_STRUCT_GLARE_PARAMS: luxfer_struct_type = 31;
/// The struct luxfer_sun_params.
pub const LUXFER_STRUCT_SUN_PARAMS: luxfer_struct_type = 32;
/// The struct luxfer_sky_params.
pub const LUXFER_STRUCT_SKY_PARAMS: luxfer_struct_type = 33;

/// Fills the struct at place with the defaults of struct_type, a LUXFER_STRUCT_ value. The argument size is sizeof the
/// struct. If the program was built with an older header, in which the struct is smaller, only the fields of that
/// version are filled. Any thread.
/// LUXFER_INVALID_ARGUMENT if struct_type is another value, if place is NULL, or if no version of the struct has this
/// size; LUXFER_UNSUPPORTED for luxfer_stylize_params in a library without stylisation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_init(
    struct_type: luxfer_struct_type,
    place: *mut c_void,
    size: usize,
) -> luxfer_status {
    guard(|| match struct_type {
        LUXFER_STRUCT_CONTEXT_PARAMS => params::init::<luxfer_context_params>(place.cast(), size),
        LUXFER_STRUCT_IMAGE_VIEW => params::init::<luxfer_image_view>(place.cast(), size),
        LUXFER_STRUCT_SCENE_LOAD_PARAMS => params::init::<luxfer_scene_load_params>(place.cast(), size),
        LUXFER_STRUCT_MATERIAL_PARAMS => params::init::<luxfer_material_params>(place.cast(), size),
        LUXFER_STRUCT_MESH_PARAMS => params::init::<luxfer_mesh_params>(place.cast(), size),
        LUXFER_STRUCT_CAMERA_PARAMS => params::init::<luxfer_camera_params>(place.cast(), size),
        LUXFER_STRUCT_LIGHT_PARAMS => params::init::<luxfer_light_params>(place.cast(), size),
        LUXFER_STRUCT_LUMINAIRE_PARAMS => params::init::<luxfer_luminaire_params>(place.cast(), size),
        LUXFER_STRUCT_RENDER_PARAMS => params::init::<luxfer_render_params>(place.cast(), size),
        LUXFER_STRUCT_RECTIFY_PARAMS => params::init::<luxfer_rectify_params>(place.cast(), size),
        LUXFER_STRUCT_FEATURES_PARAMS => params::init::<luxfer_features_params>(place.cast(), size),
        LUXFER_STRUCT_SEGMENT_PARAMS => params::init::<luxfer_segment_params>(place.cast(), size),
        LUXFER_STRUCT_EMISSION_PARAMS => params::init::<luxfer_emission_params>(place.cast(), size),
        LUXFER_STRUCT_RELIGHT_PARAMS => params::init::<luxfer_relight_params>(place.cast(), size),
        LUXFER_STRUCT_PATTERN_PARAMS => params::init::<luxfer_pattern_params>(place.cast(), size),
        LUXFER_STRUCT_TRANSFER_PARAMS => params::init::<luxfer_transfer_params>(place.cast(), size),
        LUXFER_STRUCT_ILLUMINANCE_PARAMS => params::init::<luxfer_illuminance_params>(place.cast(), size),
        LUXFER_STRUCT_ILLUMINANCE_GRID => params::init::<luxfer_illuminance_grid>(place.cast(), size),
        LUXFER_STRUCT_LAMPS_PARAMS => params::init::<luxfer_lamps_params>(place.cast(), size),
        LUXFER_STRUCT_IMPORTANCE_PARAMS => params::init::<luxfer_importance_params>(place.cast(), size),
        LUXFER_STRUCT_PLACEMENT_PARAMS => params::init::<luxfer_placement_params>(place.cast(), size),
        LUXFER_STRUCT_FALSE_COLOUR_PARAMS => params::init::<luxfer_false_colour_params>(place.cast(), size),
        LUXFER_STRUCT_GUIDES_PARAMS => params::init::<luxfer_guides_params>(place.cast(), size),
        #[cfg(feature = "stylize")]
        LUXFER_STRUCT_STYLIZE_PARAMS => params::init::<luxfer_stylize_params>(place.cast(), size),
        #[cfg(not(feature = "stylize"))]
        LUXFER_STRUCT_STYLIZE_PARAMS => super::stylize_absent::left_out(),
        LUXFER_STRUCT_SHEET_PARAMS => params::init::<luxfer_sheet_params>(place.cast(), size),
        LUXFER_STRUCT_PLAN_PARAMS => params::init::<luxfer_plan_params>(place.cast(), size),
        LUXFER_STRUCT_RENDER_PART => params::init::<luxfer_render_part>(place.cast(), size),
        LUXFER_STRUCT_DEMO_PHOTO_PARAMS => params::init::<luxfer_demo_photo_params>(place.cast(), size),
        LUXFER_STRUCT_PENDANTS_PARAMS => params::init::<luxfer_pendants_params>(place.cast(), size),
        LUXFER_STRUCT_MERGE_PARAMS => params::init::<luxfer_merge_params>(place.cast(), size),
        LUXFER_STRUCT_GONIO_PARAMS => params::init::<luxfer_gonio_params>(place.cast(), size),
        LUXFER_STRUCT_GLARE_PARAMS => params::init::<luxfer_glare_params>(place.cast(), size),
        LUXFER_STRUCT_SUN_PARAMS => params::init::<luxfer_sun_params>(place.cast(), size),
        LUXFER_STRUCT_SKY_PARAMS => params::init::<luxfer_sky_params>(place.cast(), size),
        other => Err(Error::argument(format!("the type of the struct is {other}; it must be a LUXFER_STRUCT_ value"))),
    })
}
