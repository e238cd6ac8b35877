# Generated from include/luxfer.h by generate.py: do not edit.
"""The C functions, structs and constants of luxfer.h, for ctypes."""

from __future__ import annotations

from ctypes import CFUNCTYPE, Structure, c_char_p, c_double, c_float, c_int32, c_size_t, c_uint32, c_uint64, c_void_p
from typing import Any

from . import types
from ._pointers import POINTER

LUXFER_VERSION_MAJOR = 0
LUXFER_VERSION_MINOR = 2
LUXFER_VERSION_PATCH = 0
LUXFER_OK = 0
LUXFER_UNKNOWN = 1
LUXFER_INVALID_ARGUMENT = 2
LUXFER_INVALID_OPERATION = 3
LUXFER_OUT_OF_MEMORY = 4
LUXFER_UNSUPPORTED = 5
LUXFER_CANCELLED = 6
LUXFER_IO = 7
LUXFER_FORMAT = 8
LUXFER_NOT_READY = 9
LUXFER_INTERNAL = 10
LUXFER_DEGENERATE = 11
LUXFER_NOT_FOUND = 12
LUXFER_UNREACHABLE = 13
LUXFER_STRUCT_CONTEXT_PARAMS = 0
LUXFER_STRUCT_IMAGE_VIEW = 1
LUXFER_STRUCT_SCENE_LOAD_PARAMS = 2
LUXFER_STRUCT_MATERIAL_PARAMS = 3
LUXFER_STRUCT_MESH_PARAMS = 4
LUXFER_STRUCT_CAMERA_PARAMS = 5
LUXFER_STRUCT_LIGHT_PARAMS = 6
LUXFER_STRUCT_LUMINAIRE_PARAMS = 7
LUXFER_STRUCT_RENDER_PARAMS = 8
LUXFER_STRUCT_RECTIFY_PARAMS = 9
LUXFER_STRUCT_FEATURES_PARAMS = 10
LUXFER_STRUCT_SEGMENT_PARAMS = 11
LUXFER_STRUCT_EMISSION_PARAMS = 12
LUXFER_STRUCT_RELIGHT_PARAMS = 13
LUXFER_STRUCT_PATTERN_PARAMS = 14
LUXFER_STRUCT_TRANSFER_PARAMS = 15
LUXFER_STRUCT_ILLUMINANCE_PARAMS = 16
LUXFER_STRUCT_ILLUMINANCE_GRID = 17
LUXFER_STRUCT_LAMPS_PARAMS = 18
LUXFER_STRUCT_IMPORTANCE_PARAMS = 19
LUXFER_STRUCT_PLACEMENT_PARAMS = 20
LUXFER_STRUCT_FALSE_COLOUR_PARAMS = 21
LUXFER_STRUCT_GUIDES_PARAMS = 22
LUXFER_STRUCT_STYLIZE_PARAMS = 23
LUXFER_STRUCT_SHEET_PARAMS = 24
LUXFER_STRUCT_PLAN_PARAMS = 25
LUXFER_STRUCT_RENDER_PART = 26
LUXFER_STRUCT_DEMO_PHOTO_PARAMS = 27
LUXFER_STRUCT_PENDANTS_PARAMS = 28
LUXFER_STRUCT_MERGE_PARAMS = 29
LUXFER_STRUCT_GONIO_PARAMS = 30
LUXFER_STRUCT_GLARE_PARAMS = 31
LUXFER_STRUCT_SUN_PARAMS = 32
LUXFER_STRUCT_SKY_PARAMS = 33
LUXFER_VIEW_BOTTOM_UP = 1
LUXFER_SAMPLE_U8 = 0
LUXFER_SAMPLE_U16 = 1
LUXFER_SAMPLE_F16 = 2
LUXFER_SAMPLE_F32 = 3
LUXFER_COLOUR_LINEAR = 0
LUXFER_COLOUR_SRGB = 1
LUXFER_FILE_COLOUR_NONE = 0
LUXFER_FILE_COLOUR_ASSUMED = 1
LUXFER_FILE_COLOUR_STATED = 2
LUXFER_FILE_COLOUR_CONVERTED = 3
LUXFER_FILE_COLOUR_UNCONVERTED = 4
LUXFER_FILE_COLOUR_DATA = 5
LUXFER_EXPOSURE_SOURCE_BOTH = 0
LUXFER_EXPOSURE_SOURCE_METADATA = 1
LUXFER_EXPOSURE_SOURCE_PIXELS = 2
LUXFER_TONE_CURVE_RECOVERED = 0
LUXFER_TONE_CURVE_SRGB = 1
LUXFER_DEPTH_ALONG_Z = 0
LUXFER_DEPTH_ALONG_RAY = 1
LUXFER_PHASE_PLANE = 0
LUXFER_PHASE_LIGHTS = 1
LUXFER_LUMINAIRE_FACES = 0
LUXFER_LUMINAIRE_POINT = 1
LUXFER_ALPHA_OPAQUE = 0
LUXFER_ALPHA_MASK = 1
LUXFER_ALPHA_BLEND = 2
LUXFER_TEXTURE_BASE_COLOR = 0
LUXFER_TEXTURE_METALLIC_ROUGHNESS = 1
LUXFER_TEXTURE_NORMAL = 2
LUXFER_TEXTURE_EMISSION = 3
LUXFER_WRAP_REPEAT = 0
LUXFER_WRAP_CLAMP = 1
LUXFER_WRAP_MIRROR = 2
LUXFER_DISTRIBUTION_IES = 0
LUXFER_DISTRIBUTION_LDT = 1
LUXFER_DISTRIBUTION_TM33 = 2
LUXFER_DISTRIBUTION_GLDF = 3
LUXFER_DISTRIBUTION_ANY = 4
LUXFER_LIGHT_POINT = 0
LUXFER_LIGHT_SPOT = 1
LUXFER_LIGHT_DIRECTIONAL = 2
LUXFER_NONE = 4294967295
LUXFER_SCATTERING_DIFFUSE = 1
LUXFER_SCATTERING_GLOSSY = 2
LUXFER_SCATTERING_MIRROR = 4
LUXFER_SCATTERING_GLASS = 8
LUXFER_SCATTERING_ALPHA = 16
LUXFER_SCATTERING_REFRACTION = 32
LUXFER_SCATTERING_CLEAR_COAT = 64
LUXFER_LIGHTS_SURFACE = 1
LUXFER_LIGHTS_TEXTURE = 2
LUXFER_LIGHTS_POINT = 4
LUXFER_LIGHTS_SPOT = 8
LUXFER_LIGHTS_DIRECTIONAL = 16
LUXFER_LIGHTS_ENVIRONMENT = 32
LUXFER_VERTEX_POSITION = 0
LUXFER_VERTEX_NORMAL = 1
LUXFER_VERTEX_UV_0 = 2
LUXFER_VERTEX_UV_1 = 3
LUXFER_VERTEX_COLOUR = 4
LUXFER_CANDIDATE_OBJECT = 0
LUXFER_CANDIDATE_MATERIAL = 1
LUXFER_RENDER_BEAUTY = 0
LUXFER_RENDER_VARIANCE = 1
LUXFER_RENDER_PATHS = 2
LUXFER_RENDER_INTERVAL = 3
LUXFER_RENDER_PREVIEW = 4
LUXFER_RENDER_PREVIEW_INTERVAL = 5
LUXFER_AOV_DEPTH = 1
LUXFER_AOV_DISTANCE = 2
LUXFER_AOV_POSITION = 4
LUXFER_AOV_NORMAL = 8
LUXFER_AOV_GEOMETRIC_NORMAL = 16
LUXFER_AOV_ALBEDO = 32
LUXFER_AOV_OBJECT = 64
LUXFER_AOV_MATERIAL = 128
LUXFER_AOV_ALPHA = 256
LUXFER_AOV_LUMINANCE = 512
LUXFER_EMITTER_AS_BOTH = 0
LUXFER_EMITTER_AS_LIGHT = 1
LUXFER_EMITTER_AS_OBJECT = 2
LUXFER_LINES_REGIONS = 0
LUXFER_LINES_HOUGH = 1
LUXFER_SEARCH_MANHATTAN = 0
LUXFER_SEARCH_SUCCESSIVE = 1
LUXFER_METRIC_SEGMENT = 0
LUXFER_METRIC_VISIBLE_LINE = 1
LUXFER_FOCAL_GIVEN = 0
LUXFER_FOCAL_FROM_VANISHING_POINTS = 1
LUXFER_FOCAL_ASSUMED = 2
LUXFER_FOCAL_FROM_METADATA = 3
LUXFER_FOCAL_FROM_LAMPS = 4
LUXFER_RECTIFY_UNWARPED = 0
LUXFER_RECTIFY_VALID = 1
LUXFER_FEATURES_CHANNELS = 0
LUXFER_FEATURES_DEPTH_CONFIDENCE = 1
LUXFER_FEATURES_NETWORK_DEPTH = 2
LUXFER_NORMALISATION_BY_SIZE = 0
LUXFER_NORMALISATION_IMAGENET = 1
LUXFER_NORMALISATION_HALF = 2
LUXFER_NORMALISATION_NONE = 3
LUXFER_DEPTH_FROM_CALLER = 0
LUXFER_DEPTH_FROM_LAYOUT = 1
LUXFER_DEPTH_FROM_NOTHING = 2
LUXFER_DEPTH_FROM_NETWORK = 3
LUXFER_SEGMENT_MASK = 0
LUXFER_SEGMENT_CONFIDENCE = 1
LUXFER_SEGMENT_UNSEEN = 2
LUXFER_SUBJECT_AUTO = 0
LUXFER_SUBJECT_SURFACE = 1
LUXFER_SUBJECT_LAMPS = 2
LUXFER_LAW_BEST = 0
LUXFER_LAW_CORRELATION = 1
LUXFER_LAW_LATTICE = 2
LUXFER_LAW_ROW = 3
LUXFER_LAW_WHOLE = 4
LUXFER_LAW_FREE = 5
LUXFER_LAW_COPY = 6
LUXFER_EMISSION_TEXTURE = 0
LUXFER_EMISSION_MASK = 1
LUXFER_EMISSION_EXEMPLAR_GUIDES = 2
LUXFER_EMISSION_GUIDES = 3
LUXFER_QUANTITY_OUTGOING = 0
LUXFER_QUANTITY_INCIDENT = 1
LUXFER_FIT_MEAN = 0
LUXFER_FIT_LEAST_SQUARES = 1
LUXFER_CONSTRAINT_EQUAL = 0
LUXFER_CONSTRAINT_AT_LEAST = 1
LUXFER_CONSTRAINT_AT_MOST = 2
LUXFER_OUTCOME_SATISFIED = 0
LUXFER_OUTCOME_TOO_BRIGHT = 1
LUXFER_OUTCOME_DARK = 2
LUXFER_OUTCOME_TOO_DIM = 3
LUXFER_PATTERN_DISTANCE = 0
LUXFER_PATTERN_LAMP = 1
LUXFER_PATTERN_SPACING = 2
LUXFER_PATTERN_ACROSS = 3
LUXFER_STAGE_STYLIZE = -2
LUXFER_STAGE_SCENE = -1
LUXFER_STAGE_VIEW = 0
LUXFER_STAGE_FEATURES = 1
LUXFER_STAGE_PLANE = 2
LUXFER_STAGE_LIGHTS = 3
LUXFER_STAGE_UNWARP = 4
LUXFER_STAGE_EMISSION = 5
LUXFER_STAGE_RELIGHT = 6
LUXFER_STAGE_RENDER = 7
LUXFER_TARGET_SURFACE = 0
LUXFER_TARGET_WHOLE_IMAGE = 1
LUXFER_TRANSFER_FEATURES = 0
LUXFER_TRANSFER_PLANE_MASK = 1
LUXFER_TRANSFER_PLANE_CONFIDENCE = 2
LUXFER_TRANSFER_LIGHTS_MASK = 3
LUXFER_TRANSFER_LIGHTS_CONFIDENCE = 4
LUXFER_TRANSFER_UNWARPED = 5
LUXFER_TRANSFER_UNWARPED_VALID = 6
LUXFER_TRANSFER_EMISSION = 7
LUXFER_TRANSFER_EMISSION_MASK = 8
LUXFER_TRANSFER_RENDER = 9
LUXFER_TRANSFER_RENDER_VARIANCE = 10
LUXFER_TRANSFER_RENDER_PREVIEW = 11
LUXFER_SCENE_UNSOLVED = 0
LUXFER_SCENE_LIT = 1
LUXFER_SCENE_WHITE = 2
LUXFER_WARNING_FOCAL_ASSUMED = 1
LUXFER_WARNING_VIEW_UNCERTAIN = 2
LUXFER_WARNING_LENS_DISTORTION = 3
LUXFER_WARNING_NOT_SQUARE = 4
LUXFER_WARNING_LAYOUT_UNCERTAIN = 5
LUXFER_WARNING_UNSEEN = 6
LUXFER_WARNING_CONTRADICTORY_STROKES = 7
LUXFER_WARNING_OFF_IMAGE_STROKES = 8
LUXFER_WARNING_UNCERTAIN_MASK = 9
LUXFER_WARNING_EMPTY_MASK = 10
LUXFER_WARNING_MISSED_STROKES = 11
LUXFER_WARNING_ALMOST_ALL_LIT = 12
LUXFER_WARNING_MAGNIFIED = 13
LUXFER_WARNING_PLANE_NEAR_HORIZON = 14
LUXFER_WARNING_PATTERN_UNCERTAIN = 15
LUXFER_WARNING_FEW_LAMPS = 16
LUXFER_WARNING_NO_LATTICE = 17
LUXFER_WARNING_UNREACHABLE = 18
LUXFER_WARNING_TARGET_CLIPPED = 19
LUXFER_WARNING_IMPLAUSIBLE_SIZE = 20
LUXFER_WARNING_NOT_RENDERED = 21
LUXFER_WARNING_DIM_LAMPS = 22
LUXFER_WARNING_NO_PATTERN = 23
LUXFER_WARNING_PROPOSED = 24
LUXFER_WARNING_FAR_FROM_ORIGIN = 25
LUXFER_WARNING_NOT_IN_PICTURE = 26
LUXFER_WARNING_NO_COUNTERPART = 27
LUXFER_WARNING_MOTION_DISAGREES = 28
LUXFER_WARNING_LIGHT_NOT_PAINTED = 29
LUXFER_WARNING_AMBIGUOUS_PAINT = 30
LUXFER_WARNING_BLEMISH = 31
LUXFER_WARNING_OFF_PLANE = 32
LUXFER_ILLUMINANCE_LUX = 0
LUXFER_ILLUMINANCE_ERROR = 1
LUXFER_GROUP_ALL = 0
LUXFER_GROUP_EACH = 1
LUXFER_GROUP_BY_X = 2
LUXFER_GROUP_BY_Y = 3
LUXFER_GROUP_BY_Z = 4
LUXFER_GROUP_BY_TYPE = 5
LUXFER_AIM_MAX_LUMINANCE = 0
LUXFER_AIM_MIN_LUMINANCE = 1
LUXFER_AIM_RADIANCE = 2
LUXFER_PROJECTION_PERSPECTIVE = 0
LUXFER_PROJECTION_ANGULAR = 1
LUXFER_SCALE_LINEAR = 0
LUXFER_SCALE_LOGARITHMIC = 1
LUXFER_UNIT_LUMINANCE = 0
LUXFER_UNIT_ILLUMINANCE = 1
LUXFER_SKY_CIE = 0
LUXFER_SKY_PEREZ = 1
LUXFER_DAYLIGHT_LUX = 0
LUXFER_DAYLIGHT_WATTS = 1
LUXFER_DOUBT_SIZE = 1
LUXFER_DOUBT_KIND = 2
LUXFER_DOUBT_CLIPPED = 4
LUXFER_DOUBT_CUT = 8
LUXFER_DOUBT_HIDDEN = 16
LUXFER_MAX_PENDANTS = 16
LUXFER_BODY_GLOBE = 0
LUXFER_BODY_SPHEROID = 1
LUXFER_BODY_DRUM = 2
LUXFER_BODY_DISC = 3
LUXFER_BODY_CONE = 4
LUXFER_BODY_BOWL = 5
LUXFER_BODY_DOME = 6
LUXFER_BODY_OTHER = 7
LUXFER_KNOWN_NOTHING = 0
LUXFER_KNOWN_DROP = 1
LUXFER_KNOWN_DIAMETER = 2
LUXFER_KNOWN_SPACING = 3
LUXFER_GUIDES_FULL = 0
LUXFER_GUIDES_DIRECT = 1
LUXFER_GUIDES_SPECULAR = 2
LUXFER_GUIDES_INDIRECT = 3
LUXFER_GUIDES_TWO_BOUNCES = 4
LUXFER_GUIDES_NORMALS = 5
LUXFER_GUIDES_EDGES = 6
LUXFER_GUIDES_MATERIALS = 7
LUXFER_GUIDES_CAUSTICS = 8
LUXFER_STYLIZE_FULL = 0
LUXFER_STYLIZE_FAST = 1
LUXFER_STYLIZE_PREVIEW = 2
LUXFER_STYLIZE_PAPER = 3
LUXFER_STYLIZE_SEARCH_PATCHMATCH = 0
LUXFER_STYLIZE_SEARCH_KD_TREE = 1
LUXFER_STYLIZE_VOTE_PLAIN = 0
LUXFER_STYLIZE_VOTE_WEIGHTED = 1
LUXFER_STYLIZE_VOTE_NEAREST = 2
LUXFER_STYLIZE_VOTE_MAJORITY = 3
LUXFER_STYLIZE_VOTE_ADAPTIVE = 4
LUXFER_GUIDES_WITH_NORMALS = 1
LUXFER_GUIDES_WITH_EDGES = 2
LUXFER_GUIDES_WITH_MATERIALS = 4
LUXFER_GUIDES_WITH_CAUSTICS = 8
LUXFER_GUIDE_LIGHT = 0
LUXFER_GUIDE_DATA = 1
LUXFER_STYLIZE_IMAGE_PICTURE = 0
LUXFER_STYLIZE_IMAGE_GUIDE_ERROR = 1
LUXFER_STYLIZE_IMAGE_SOURCES = 2
LUXFER_DEMO_TARGET_ROOM = 0
LUXFER_DEMO_EXEMPLAR_ROOM = 1
LUXFER_DEMO_SPHERE_ON_TABLE = 2
LUXFER_DEMO_STILL_LIFE = 3
LUXFER_ARTWORK_PEN = 0
LUXFER_ARTWORK_STIPPLE = 1
LUXFER_ARTWORK_PAINT = 2
LUXFER_DEMO_PHOTO_PICTURE = 0
LUXFER_DEMO_PHOTO_STROKES = 1


class luxfer_context(Structure):
    """A context: threads, memory budget and error messages. See luxfer_context_create."""


class luxfer_image(Structure):
    """An image in the library's memory. See luxfer_image_create."""


class luxfer_strokes(Structure):
    """A set of strokes for images of one size. See luxfer_strokes_create."""


class luxfer_job(Structure):
    """A job: work in progress. See luxfer_job_wait."""


class luxfer_scene(Structure):
    """A scene. See luxfer_scene_load and luxfer_scene_create."""


class luxfer_distribution(Structure):
    """A luminous intensity distribution. See luxfer_distribution_load."""


class luxfer_candidates(Structure):
    """A list of candidates for the ceiling. See luxfer_scene_get_candidates."""


class luxfer_render(Structure):
    """A rendering of a scene. See luxfer_render_create."""


class luxfer_rectify(Structure):
    """Lines, vanishing points and the unwarped plane of a photo. See luxfer_rectify_create."""


class luxfer_features(Structure):
    """The features of a photo. See luxfer_features_create."""


class luxfer_segment(Structure):
    """A segmentation by strokes. See luxfer_segment_create."""


class luxfer_emission(Structure):
    """A synthesis of an emissive texture. See luxfer_emission_create."""


class luxfer_relight(Structure):
    """A relighting: a solver for the emission of one material. See luxfer_relight_create."""


class luxfer_transfer(Structure):
    """A lighting transfer. See luxfer_transfer_create."""


class luxfer_warnings(Structure):
    """A list of warnings. See luxfer_get_warnings."""


class luxfer_illuminance(Structure):
    """A calculation of illuminance. See luxfer_illuminance_create."""


class luxfer_lamps(Structure):
    """A solver for the powers of lamps. See luxfer_lamps_create."""


class luxfer_importance(Structure):
    """An importance map of an emitting surface. See luxfer_importance_create."""


class luxfer_guides(Structure):
    """The guides of a scene. See luxfer_guides_create."""


class luxfer_stylize(Structure):
    """A stylisation. See luxfer_stylize_create."""


class luxfer_plan(Structure):
    """A plan: the settings with which work reaches a given error, or ends within a given time. See
    luxfer_plan_create."""


class luxfer_demo_photo(Structure):
    """A generator of the demonstration photo. See luxfer_demo_photo_create."""


luxfer_progress_fn = CFUNCTYPE(c_int32, c_void_p, c_double)

luxfer_work_fn = CFUNCTYPE(c_int32, c_void_p)

luxfer_write_fn = CFUNCTYPE(c_int32, c_void_p, c_void_p, c_size_t)


class luxfer_context_params(Structure):
    """Settings of a context."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("num_threads", c_uint32),
        ("memory_budget_mib", c_uint64),
    ]
    struct_type = LUXFER_STRUCT_CONTEXT_PARAMS


class luxfer_image_view(Structure):
    """An image in the caller's memory."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("channels", c_uint32),
        ("sample", c_int32),
        ("colour_space", c_int32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("flags", c_uint32),
        ("reserved", c_uint32),
        ("pixel_stride", c_size_t),
        ("row_stride", c_size_t),
        ("byte_size", c_size_t),
        ("data", c_void_p),
    ]
    enumerations: dict[str, type] = {"sample": types.Sample, "colour_space": types.ColourSpace, "flags": types.View}
    struct_type = LUXFER_STRUCT_IMAGE_VIEW


class luxfer_photo_metadata(Structure):
    """Metadata of the file of a loaded photo."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("orientation", c_uint32),
        ("focal", c_double),
        ("focal_error", c_double),
        ("f_number", c_double),
        ("exposure_time", c_double),
        ("iso", c_double),
        ("white_luminance", c_double),
        ("white_luminance_low", c_double),
        ("white_luminance_high", c_double),
        ("colour", c_int32),
        ("reserved", c_uint32),
    ]
    enumerations: dict[str, type] = {"colour": types.FileColour}
    result = types.PhotoMetadata


class luxfer_merge_params(Structure):
    """Settings for merging exposures."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("source", c_int32),
        ("reference", c_int32),
        ("keep_moving", c_uint32),
        ("max_shift", c_double),
        ("saturation", c_double),
        ("exposures", c_double * 16),
        ("tone_curve", c_int32),
        ("reserved", c_uint32),
    ]
    enumerations: dict[str, type] = {"source": types.ExposureSource, "tone_curve": types.ToneCurve}
    struct_type = LUXFER_STRUCT_MERGE_PARAMS


class luxfer_merge_report(Structure):
    """The exposures and shifts that luxfer_image_merge_exposures found. Arrays have an element for each photo,
    in the order of the photos; further elements are 0."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("count", c_uint32),
        ("reference", c_uint32),
        ("reserved", c_uint32),
        ("clipped", c_double),
        ("moved", c_double),
        ("exposures", c_double * 16),
        ("errors", c_double * 16),
        ("stated", c_double * 16),
        ("shift_x", c_int32 * 16),
        ("shift_y", c_int32 * 16),
        ("tone_curve", c_int32),
        ("contradicts_srgb", c_uint32),
        ("tone_curve_error", c_double),
        ("tone_curve_light", c_double * 17),
    ]
    enumerations: dict[str, type] = {"tone_curve": types.ToneCurve}
    result = types.MergeReport


class luxfer_scene_counts(Structure):
    """Number of objects of each kind in a scene."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("meshes", c_uint32),
        ("materials", c_uint32),
        ("textures", c_uint32),
        ("lights", c_uint32),
        ("cameras", c_uint32),
        ("triangles", c_uint64),
    ]
    result = types.SceneCounts


class luxfer_surface(Structure):
    """A planar surface of a scene: triangles in one plane, and their bounding rectangle. Seen from the room, u
    runs to the right and v runs down, as in an image."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("triangles", c_uint64),
        ("origin", c_float * 3),
        ("u_axis", c_float * 3),
        ("v_axis", c_float * 3),
        ("normal", c_float * 3),
        ("size", c_float * 2),
        ("area", c_float),
        ("sloped_area", c_float),
    ]
    result = types.Surface


class luxfer_scene_load_params(Structure):
    """Settings for loading a scene file."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("allow_external_files", c_uint32),
        ("unit", c_double),
        ("keep_origin", c_uint32),
        ("luminaire_shape", c_int32),
    ]
    enumerations: dict[str, type] = {"luminaire_shape": types.LuminaireShape}
    struct_type = LUXFER_STRUCT_SCENE_LOAD_PARAMS


class luxfer_material_params(Structure):
    """A metallic-roughness material, as in glTF 2.0."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("double_sided", c_uint32),
        ("name", c_char_p),
        ("base_color", c_float * 3),
        ("metallic", c_float),
        ("roughness", c_float),
        ("emission", c_float * 3),
        ("transmission", c_float),
        ("ior", c_float),
        ("alpha", c_float),
        ("alpha_mode", c_int32),
        ("alpha_cutoff", c_float),
        ("normal_scale", c_float),
        ("thickness", c_float),
        ("attenuation_color", c_float * 3),
        ("attenuation_distance", c_float),
        ("reserved", c_uint32),
    ]
    enumerations: dict[str, type] = {"alpha_mode": types.AlphaMode}
    struct_type = LUXFER_STRUCT_MATERIAL_PARAMS


class luxfer_texture_use(Structure):
    """The texture that a material uses for one purpose."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("texture", c_uint32),
        ("uv_set", c_uint32),
        ("wrap_u", c_int32),
        ("wrap_v", c_int32),
        ("transform", c_float * 6),
    ]
    enumerations: dict[str, type] = {"wrap_u": types.Wrap, "wrap_v": types.Wrap}
    result = types.TextureUse


class luxfer_mesh_params(Structure):
    """A triangle mesh in world space."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("material", c_uint32),
        ("name", c_char_p),
        ("vertex_count", c_size_t),
        ("positions", c_void_p),
        ("position_stride", c_size_t),
        ("normals", c_void_p),
        ("normal_stride", c_size_t),
        ("uvs", c_void_p),
        ("uv_stride", c_size_t),
        ("triangle_count", c_size_t),
        ("indices", c_void_p),
        ("index_stride", c_size_t),
        ("colours", c_void_p),
        ("colour_stride", c_size_t),
    ]
    struct_type = LUXFER_STRUCT_MESH_PARAMS


class luxfer_camera_params(Structure):
    """A pinhole camera."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("fov_y", c_float),
        ("position", c_float * 3),
        ("target", c_float * 3),
        ("up", c_float * 3),
        ("reserved", c_uint32),
    ]
    struct_type = LUXFER_STRUCT_CAMERA_PARAMS


class luxfer_distribution_report(Structure):
    """Summary of a luminous intensity distribution."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("planes", c_uint32),
        ("angles", c_uint32),
        ("reserved", c_uint32),
        ("flux", c_double),
        ("lamp_flux", c_double),
        ("watts", c_double),
        ("size", c_double * 3),
        ("temperature", c_double),
        ("rendering", c_double),
        ("variants", c_uint32),
        ("emitters", c_uint32),
    ]
    result = types.DistributionReport


class luxfer_light_params(Structure):
    """A punctual light."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("position", c_float * 3),
        ("direction", c_float * 3),
        ("intensity", c_float * 3),
        ("inner_angle", c_float),
        ("outer_angle", c_float),
        ("reserved", c_uint32),
        ("angular_diameter", c_float),
    ]
    enumerations: dict[str, type] = {"kind": types.LightKind}
    struct_type = LUXFER_STRUCT_LIGHT_PARAMS


class luxfer_luminaire_params(Structure):
    """Flux, position, orientation, colour and shape of a luminaire."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("shape", c_int32),
        ("flux", c_double),
        ("position", c_float * 3),
        ("axis", c_float * 3),
        ("c0", c_float * 3),
        ("colour", c_float * 3),
    ]
    enumerations: dict[str, type] = {"shape": types.LuminaireShape}
    struct_type = LUXFER_STRUCT_LUMINAIRE_PARAMS


class luxfer_ray(Structure):
    """A ray. Callers pass arrays of this struct, so its size and fields never change in later versions."""

    _fields_ = [
        ("origin", c_float * 3),
        ("direction", c_float * 3),
        ("t_max", c_float),
    ]
    result = types.Ray


class luxfer_hit(Structure):
    """The nearest hit of a ray. Callers pass arrays of this struct, so its size and fields never change in
    later versions."""

    _fields_ = [
        ("t", c_float),
        ("mesh", c_uint32),
        ("triangle", c_uint32),
        ("u", c_float),
        ("v", c_float),
    ]
    result = types.Hit


class luxfer_requirements(Structure):
    """Features that a scene requires of the renderer."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("scattering", c_uint32),
        ("lights", c_uint32),
        ("textures", c_uint32),
        ("bounces", c_uint32),
        ("brightest_material", c_uint32),
        ("albedo", c_float * 3),
        ("flat_triangles", c_uint32),
    ]
    enumerations: dict[str, type] = {"scattering": types.Scattering, "lights": types.Lights}
    result = types.Requirements


class luxfer_mesh_info(Structure):
    """Sizes and attributes of a mesh."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("material", c_uint32),
        ("vertex_count", c_uint64),
        ("triangle_count", c_uint64),
        ("has_normals", c_uint32),
        ("uv_sets", c_uint32),
        ("has_colours", c_uint32),
        ("reserved", c_uint32),
    ]
    result = types.MeshInfo


class luxfer_candidate(Structure):
    """A candidate for the ceiling: an object or a material of a scene."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("index", c_uint32),
        ("area", c_float),
        ("level_area", c_float),
        ("height", c_float),
        ("low", c_float),
        ("high", c_float),
        ("normal", c_float * 3),
        ("score", c_float),
        ("triangles", c_uint64),
        ("name", c_char_p),
        ("reason", c_char_p),
    ]
    enumerations: dict[str, type] = {"kind": types.CandidateKind}
    result = types.Candidate


class luxfer_render_params(Structure):
    """Settings of a rendering."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("samples", c_uint32),
        ("target_error", c_float),
        ("time_budget_ms", c_uint32),
        ("seed", c_uint64),
        ("pixel_error", c_float),
        ("reserved", c_uint32),
        ("preview", c_float),
        ("relative_error", c_float),
    ]
    struct_type = LUXFER_STRUCT_RENDER_PARAMS


class luxfer_render_report(Structure):
    """Quality of a rendering."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("samples", c_uint32),
        ("error", c_double),
        ("discarded", c_uint64),
        ("preview_bias", c_double),
        ("relative_error", c_double),
        ("preview_error", c_double),
    ]
    result = types.RenderReport


class luxfer_rectify_params(Structure):
    """Settings of a rectification."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("detector", c_int32),
        ("search", c_int32),
        ("metric", c_int32),
        ("hough_band", c_double),
        ("focal", c_double),
        ("principal", c_double * 2),
        ("plane_axes", c_int32 * 2),
        ("max_side", c_uint32),
        ("reserved", c_uint32),
        ("max_magnification", c_double),
        ("seed", c_uint64),
        ("distortion", c_double),
    ]
    enumerations: dict[str, type] = {"detector": types.Lines, "search": types.Search, "metric": types.Metric}
    struct_type = LUXFER_STRUCT_RECTIFY_PARAMS


class luxfer_rectify_report(Structure):
    """The camera found from the lines of a photo, and the unwarping of the plane."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("segments", c_uint32),
        ("vanishing_points", (c_double * 3) * 3),
        ("vanishing_errors", c_double * 3),
        ("vanishing_support", c_uint32 * 3),
        ("focal_source", c_int32),
        ("focal", c_double),
        ("principal", c_double * 2),
        ("axes", (c_double * 3) * 3),
        ("is_unwarped", c_uint32),
        ("reserved", c_uint32),
        ("to_photo", c_double * 9),
        ("corners", (c_double * 2) * 4),
        ("corner_errors", c_double * 4),
        ("pixel_size", c_double),
        ("aspect_confidence", c_double),
        ("distortion", c_double),
        ("distortion_error", c_double),
        ("squareness", c_double * 3),
        ("squareness_errors", c_double * 3),
        ("undone", c_double),
    ]
    enumerations: dict[str, type] = {"focal_source": types.FocalSource}
    result = types.RectifyReport


class luxfer_features_params(Structure):
    """Settings of the features."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("near_plane", c_float),
        ("far_plane", c_float),
        ("normal_radius", c_uint32),
    ]
    struct_type = LUXFER_STRUCT_FEATURES_PARAMS


class luxfer_features_report(Structure):
    """Quality of the features."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("depth_source", c_int32),
        ("depth_confidence", c_double),
        ("replaced_pixels", c_uint64),
    ]
    enumerations: dict[str, type] = {"depth_source": types.DepthSource}
    result = types.FeaturesReport


class luxfer_segment_params(Structure):
    """Settings of a segmentation."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("samples_per_class", c_uint32),
        ("channels", c_uint32),
        ("refine_radius", c_uint32),
        ("ridge", c_double),
        ("seed", c_uint64),
        ("refine_tolerance", c_double),
        ("subject", c_int32),
        ("reserved", c_uint32),
    ]
    enumerations: dict[str, type] = {"subject": types.Subject}
    struct_type = LUXFER_STRUCT_SEGMENT_PARAMS


class luxfer_segment_report(Structure):
    """Quality of a segmentation."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("channels", c_uint32),
        ("error", c_double),
        ("negative_samples", c_uint64),
        ("positive_samples", c_uint64),
        ("contradictory_pixels", c_uint64),
    ]
    result = types.SegmentReport


class luxfer_emission_params(Structure):
    """Settings of an emissive texture."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("block", c_uint32),
        ("scale", c_double),
        ("working_side", c_uint32),
        ("guide_weight", c_float),
        ("seed", c_uint64),
        ("min_regularity", c_float),
        ("whole_lamps", c_uint32),
        ("offset", c_double * 2),
        ("clip_level", c_float),
        ("even_lamps", c_uint32),
        ("tileable", c_uint32),
        ("centred", c_uint32),
        ("candidates", c_uint32),
        ("reserved", c_uint32),
        ("law", c_int32),
        ("clean_lamps", c_uint32),
        ("max_magnification", c_double),
    ]
    enumerations: dict[str, type] = {"law": types.EmissionLaw}
    struct_type = LUXFER_STRUCT_EMISSION_PARAMS


class luxfer_emission_report(Structure):
    """Description of a texture: its lamps, the law (rule) by which it continues the exemplar's lights, and its
    quality. A composition (luxfer_emission_start_composition) has no texels yet, so its error is NaN and its
    sampling_error is 0. If there are several exemplars, the fields regularity, law, runner_up, law_score and
    margin describe the first exemplar."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("luminaires", c_uint32),
        ("error", c_double),
        ("regularity", c_double),
        ("exemplar_lamps", c_uint32),
        ("sampling_error", c_float),
        ("law", c_int32),
        ("runner_up", c_int32),
        ("law_score", c_double),
        ("margin", c_double),
    ]
    enumerations: dict[str, type] = {"law": types.EmissionLaw, "runner_up": types.EmissionLaw}
    result = types.EmissionReport


class luxfer_luminaire(Structure):
    """A luminaire: one lamp of the texture."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("corners", c_uint32),
        ("centre", c_double * 2),
        ("size", c_double * 2),
        ("orientation", c_double),
        ("area", c_double),
        ("flux_share", c_double),
        ("colour", c_float * 3),
        ("kind", c_uint32),
    ]
    result = types.Luminaire


class luxfer_relight_params(Structure):
    """Settings of a relighting."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("quantity", c_int32),
        ("paths", c_uint32),
        ("target_error", c_float),
        ("time_budget_ms", c_uint32),
        ("fit", c_int32),
        ("seed", c_uint64),
    ]
    enumerations: dict[str, type] = {"quantity": types.Quantity, "fit": types.Fit}
    struct_type = LUXFER_STRUCT_RELIGHT_PARAMS


class luxfer_relight_report(Structure):
    """The solution of a relighting and its confidence."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("paths", c_uint32),
        ("scale", c_double * 3),
        ("half_width", c_double * 3),
        ("response", c_double * 3),
        ("background", c_double * 3),
        ("outcome", c_int32 * 3),
        ("reserved", c_uint32),
        ("error", c_double),
        ("delta_e", c_double),
    ]
    enumerations: dict[str, type] = {"outcome": types.Outcome}
    result = types.RelightReport


class luxfer_pattern_params(Structure):
    """Layout of the light pattern on a surface; Surface gives the corner and the axes u and v of the
    surface."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("scale", c_int32),
        ("length", c_double),
        ("texel_size", c_double),
        ("rotation", c_double),
        ("offset", c_double * 2),
        ("margin", c_double),
    ]
    enumerations: dict[str, type] = {"scale": types.PatternScale}
    struct_type = LUXFER_STRUCT_PATTERN_PARAMS


class luxfer_transfer_params(Structure):
    """Settings of a transfer. The library reads the structs to which the pointers lead only during the call
    that gets the settings."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("max_texels", c_uint32),
        ("plane_distance", c_double),
        ("white_luminance", c_float),
        ("target", c_int32),
        ("rectify", POINTER(luxfer_rectify_params)),
        ("features", POINTER(luxfer_features_params)),
        ("plane", POINTER(luxfer_segment_params)),
        ("lights", POINTER(luxfer_segment_params)),
        ("emission", POINTER(luxfer_emission_params)),
        ("relight", POINTER(luxfer_relight_params)),
        ("render", POINTER(luxfer_render_params)),
        ("pattern", POINTER(luxfer_pattern_params)),
    ]
    enumerations: dict[str, type] = {"target": types.Target}
    struct_type = LUXFER_STRUCT_TRANSFER_PARAMS


class luxfer_transfer_report(Structure):
    """Time and error of each stage. The error of a stage without a result is NaN."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("fixtures", c_uint32),
        ("seconds", c_double * 8),
        ("view_error", c_double),
        ("depth_confidence", c_double),
        ("plane_error", c_double),
        ("lights_error", c_double),
        ("unwarp_error", c_double),
        ("emission_error", c_double),
        ("relight_error", c_double),
        ("render_error", c_double),
        ("texel_size", c_double),
        ("target", c_float * 3),
        ("reserved", c_uint32),
        ("plane_distance", c_double),
        ("plane_distance_error", c_double),
        ("proposed_white", c_double),
        ("proposed_white_low", c_double),
        ("proposed_white_high", c_double),
        ("preview_error", c_double),
    ]
    result = types.TransferReport


class luxfer_fixture(Structure):
    """One lamp of the lit scene."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("position", c_float * 3),
        ("normal", c_float * 3),
        ("axis", c_float * 3),
        ("radiance", c_float * 3),
        ("kind", c_uint32),
        ("size", c_double * 2),
        ("area", c_double),
        ("flux", c_double),
        ("cct", c_double),
        ("duv", c_double),
    ]
    result = types.Fixture


class luxfer_warning(Structure):
    """A warning: a reason to doubt a result."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("code", c_int32),
        ("stage", c_int32),
        ("has_place", c_uint32),
        ("severity", c_double),
        ("limit", c_double),
        ("place", c_double * 2),
        ("message", c_char_p),
        ("advice", c_char_p),
    ]
    enumerations: dict[str, type] = {"code": types.WarningCode, "stage": types.Stage}
    result = types.Warning


class luxfer_illuminance_grid(Structure):
    """A calculation grid: a parallelogram of columns x rows cells, with a point at the centre of each cell. The
    default is a square metre at the origin that faces up."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("origin", c_float * 3),
        ("across", c_float * 3),
        ("down", c_float * 3),
        ("normal", c_float * 3),
        ("reserved", c_uint32),
    ]
    struct_type = LUXFER_STRUCT_ILLUMINANCE_GRID


class luxfer_illuminance_params(Structure):
    """Settings of an illuminance calculation."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("columns", c_uint32),
        ("rows", c_uint32),
        ("samples", c_uint32),
        ("seed", c_uint64),
    ]
    struct_type = LUXFER_STRUCT_ILLUMINANCE_PARAMS


class luxfer_illuminance_report(Structure):
    """Summary of the illuminance, in lux."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("points", c_uint32),
        ("minimum", c_double),
        ("mean", c_double),
        ("maximum", c_double),
        ("mean_error", c_double),
    ]
    result = types.IlluminanceReport


class luxfer_lamps_params(Structure):
    """Settings of the solver for lamps."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("group", c_int32),
        ("row_tolerance", c_float),
        ("free_colour", c_uint32),
        ("max_scale", c_double),
        ("regularisation", c_double),
        ("tolerance", c_double),
        ("paths", c_uint32),
        ("target_error", c_float),
        ("time_budget_ms", c_uint32),
        ("reserved", c_uint32),
        ("seed", c_uint64),
    ]
    enumerations: dict[str, type] = {"group": types.Group}
    struct_type = LUXFER_STRUCT_LAMPS_PARAMS


class luxfer_lamps_report(Structure):
    """Summary of the solution for lamps."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("lamps", c_uint32),
        ("groups", c_uint32),
        ("goals", c_uint32),
        ("paths", c_uint32),
        ("all_goals_satisfied", c_uint32),
    ]
    result = types.LampsReport


class luxfer_lamp(Structure):
    """The solution for one lamp."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("group", c_uint32),
        ("centre", c_double * 3),
        ("scale", c_double * 3),
        ("half_width", c_double * 3),
    ]
    result = types.Lamp


class luxfer_lamps_goal(Structure):
    """The light that the surface or grid of one goal receives with the powers found."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("outcome", c_int32 * 3),
        ("target", c_double * 3),
        ("achieved", c_double * 3),
        ("half_width", c_double * 3),
        ("background", c_double * 3),
        ("target_lux", c_double),
        ("achieved_lux", c_double),
        ("half_width_lux", c_double),
        ("background_lux", c_double),
    ]
    enumerations: dict[str, type] = {"outcome": types.Outcome}
    result = types.LampsGoal


class luxfer_lamps_response(Structure):
    """The light that the surface or grid of one goal receives from one lamp."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("mean", c_double * 3),
        ("half_width", c_double * 3),
    ]
    result = types.LampsResponse


class luxfer_importance_params(Structure):
    """Settings of an importance map."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("quantity", c_int32),
        ("paths", c_uint32),
        ("target_error", c_float),
        ("time_budget_ms", c_uint32),
        ("reserved", c_uint32),
        ("seed", c_uint64),
    ]
    enumerations: dict[str, type] = {"quantity": types.Quantity}
    struct_type = LUXFER_STRUCT_IMPORTANCE_PARAMS


class luxfer_importance_report(Structure):
    """The light that the target receives from a texture: the result of luxfer_importance_respond."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("paths", c_uint32),
        ("response", c_double * 3),
        ("half_width", c_double * 3),
        ("resolution_difference", c_double * 3),
    ]
    result = types.ImportanceReport


class luxfer_placement_params(Structure):
    """Objective and bounds of a placement. A placement scales the texture coordinates of the surface about
    their centre (0.5, 0.5), then rotates them about this centre, and then shifts them."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("aim", c_int32),
        ("radiance", c_float * 3),
        ("starts", c_uint32),
        ("min_offset", c_double * 2),
        ("max_offset", c_double * 2),
        ("min_scale", c_double * 2),
        ("max_scale", c_double * 2),
        ("min_rotation", c_double),
        ("max_rotation", c_double),
        ("seed", c_uint64),
    ]
    enumerations: dict[str, type] = {"aim": types.Aim}
    struct_type = LUXFER_STRUCT_PLACEMENT_PARAMS


class luxfer_placement(Structure):
    """The best placement, and the light that the target then receives."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("placement", c_double * 9),
        ("offset", c_double * 2),
        ("scale", c_double * 2),
        ("rotation", c_double),
        ("response", c_double * 3),
        ("half_width", c_double * 3),
        ("resolution_difference", c_double * 3),
    ]
    result = types.Placement


class luxfer_glare_report(Structure):
    """The glare of a view: the result of luxfer_image_get_glare."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("sources", c_uint32),
        ("ugr", c_double),
        ("background", c_double),
        ("threshold", c_double),
        ("solid_angle", c_double),
        ("unseen_lights", c_uint32),
        ("reserved", c_uint32),
        ("dgp", c_double),
        ("vertical_illuminance", c_double),
        ("dgp_low_light", c_double),
    ]
    result = types.GlareReport


class luxfer_glare_params(Structure):
    """Settings of the glare rating of an image."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("projection", c_int32),
        ("fov_y", c_double),
        ("threshold", c_double),
        ("vertical_illuminance", c_double),
    ]
    enumerations: dict[str, type] = {"projection": types.Projection}
    struct_type = LUXFER_STRUCT_GLARE_PARAMS


class luxfer_observer(Structure):
    """An observer: an eye that looks in a direction. Callers pass arrays of this struct, so its size and fields
    never change in later versions."""

    _fields_ = [
        ("position", c_float * 3),
        ("direction", c_float * 3),
    ]
    result = types.Observer


class luxfer_observer_glare(Structure):
    """The glare that an observer experiences. Callers pass arrays of this struct, so its size and fields never
    change in later versions."""

    _fields_ = [
        ("ugr", c_double),
        ("background", c_double),
        ("background_error", c_double),
        ("unrated_lux", c_double),
        ("solid_angle", c_double),
        ("sources", c_uint32),
        ("outside_range", c_uint32),
    ]
    result = types.ObserverGlare


class luxfer_gonio_params(Structure):
    """Settings of luxfer_scene_get_distribution: the directions, the paths and the axes of the luminaire."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("planes", c_uint32),
        ("angles", c_uint32),
        ("samples", c_uint32),
        ("seed", c_uint64),
        ("axis", c_float * 3),
        ("c0", c_float * 3),
    ]
    struct_type = LUXFER_STRUCT_GONIO_PARAMS


class luxfer_gonio_report(Structure):
    """Errors of a distribution that luxfer_scene_get_distribution has measured, and the place of its
    luminaire."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("position", c_float * 3),
        ("flux", c_double),
        ("flux_error", c_double),
        ("intensity_error", c_double),
    ]
    result = types.GonioReport


class luxfer_false_colour_params(Structure):
    """Settings of a false colour image."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("scale", c_int32),
        ("unit", c_int32),
        ("bar", c_uint32),
        ("minimum", c_double),
        ("maximum", c_double),
    ]
    enumerations: dict[str, type] = {"scale": types.Scale, "unit": types.Unit}
    struct_type = LUXFER_STRUCT_FALSE_COLOUR_PARAMS


class luxfer_sun_params(Structure):
    """A place on the Earth and a time."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("year", c_int32),
        ("month", c_uint32),
        ("day", c_uint32),
        ("hour", c_double),
        ("latitude", c_double),
        ("longitude", c_double),
    ]
    struct_type = LUXFER_STRUCT_SUN_PARAMS


class luxfer_sun_position(Structure):
    """The position of the sun."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("altitude", c_double),
        ("azimuth", c_double),
        ("distance", c_double),
    ]
    result = types.SunPosition


class luxfer_sky_params(Structure):
    """A state of sun and sky. The default is the overcast sky of type 1 with 10,000 lx: 100 lx indoors are then
    a daylight factor of 1 %."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("model", c_int32),
        ("cie_type", c_uint32),
        ("unit", c_int32),
        ("sun_altitude", c_double),
        ("sun_azimuth", c_double),
        ("sun_distance", c_double),
        ("direct_normal", c_double),
        ("diffuse_horizontal", c_double),
        ("zenith_luminance", c_double),
        ("dew_point", c_double),
        ("ground_reflectance", c_double),
        ("sky_kelvin", c_double),
        ("sun_kelvin", c_double),
        ("north", c_float * 3),
        ("rows", c_uint32),
    ]
    enumerations: dict[str, type] = {"model": types.SkyModel, "unit": types.DaylightUnit}
    struct_type = LUXFER_STRUCT_SKY_PARAMS


class luxfer_sky_report(Structure):
    """The light of a sky."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("sun", c_uint32),
        ("direct_normal", c_double),
        ("diffuse_horizontal", c_double),
        ("zenith_luminance", c_double),
        ("ground_luminance", c_double),
        ("clearness", c_double),
        ("brightness", c_double),
    ]
    result = types.SkyReport


class luxfer_weather_hour(Structure):
    """The weather of an hour; values that the file does not have are NaN. Callers pass arrays of this struct,
    so its size and fields never change in later versions."""

    _fields_ = [
        ("year", c_int32),
        ("month", c_uint32),
        ("day", c_uint32),
        ("reserved", c_uint32),
        ("hour", c_double),
        ("dew_point", c_double),
        ("direct_normal", c_double),
        ("diffuse_horizontal", c_double),
        ("direct_normal_illuminance", c_double),
        ("diffuse_horizontal_illuminance", c_double),
    ]
    result = types.WeatherHour


class luxfer_weather_report(Structure):
    """The place of a weather file."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("hours", c_uint32),
        ("latitude", c_double),
        ("longitude", c_double),
        ("time_zone", c_double),
        ("elevation", c_double),
    ]
    result = types.WeatherReport


class luxfer_mixture(Structure):
    """A colour mixed from LED primaries: the result of luxfer_mix_primaries."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("in_gamut", c_uint32),
        ("colour", c_double * 3),
        ("delta_e", c_double),
    ]
    result = types.Mixture


class luxfer_temperature_fit(Structure):
    """The blackbody light that fits a target best: the result of luxfer_fit_temperature."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("kelvin", c_double),
        ("luminance", c_double),
        ("achieved", c_double * 3),
        ("delta_e", c_double),
    ]
    result = types.TemperatureFit


class luxfer_preset(Structure):
    """Requirements of EN 12464-1 for one kind of room, as manufacturers of luminaires quote them. Only the
    standard itself is binding."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("edition", c_uint32),
        ("illuminance", c_double),
        ("glare", c_double),
        ("uniformity", c_double),
        ("rendering", c_double),
        ("walls", c_double),
        ("ceiling", c_double),
        ("name", c_char_p),
    ]
    result = types.Preset


class luxfer_pendants_params(Structure):
    """Settings with which luxfer_pendants_find fits bodies to lamps."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("alike", c_uint32),
        ("level", c_uint32),
        ("refine", c_uint32),
        ("known", c_int32),
        ("reserved", c_uint32),
        ("known_length", c_double),
        ("ceiling", c_double),
        ("suspension_error", c_double),
        ("focal", c_double),
        ("focal_error", c_double),
        ("axes_error", c_double),
        ("principal", c_double * 2),
        ("axes", (c_double * 3) * 3),
    ]
    enumerations: dict[str, type] = {"known": types.Known}
    struct_type = LUXFER_STRUCT_PENDANTS_PARAMS


class luxfer_pendant(Structure):
    """A hanging lamp: its body, its place and the doubts about them. Fields called an interval hold three
    numbers: the value, and the lower and the upper end of its 95 % confidence interval. If the photo does not
    determine the value, the ends are the known bounds of the value, which may be 0 and infinity. A value
    without an estimate is NaN."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("profile_count", c_uint32),
        ("kind", c_int32),
        ("doubts", c_uint32),
        ("probability", c_double),
        ("aspect", c_double * 3),
        ("diameter", c_double * 3),
        ("height", c_double * 3),
        ("drop", c_double * 3),
        ("centre", (c_double * 3) * 3),
        ("residual", c_double),
        ("cut", c_double),
        ("clipped", c_double),
        ("profile", (c_float * 2) * 65),
        ("profile_error", c_float * 65),
        ("radiance", (c_float * 3) * 16),
        ("contour", (c_float * 2) * 180),
        ("reserved", c_uint32),
    ]
    enumerations: dict[str, type] = {"kind": types.Body, "doubts": types.Doubt}
    result = types.Pendant


class luxfer_guides_params(Structure):
    """Settings of the guides."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("samples", c_uint32),
        ("camera", c_uint32),
        ("smooth", c_uint32),
        ("seed", c_uint64),
    ]
    struct_type = LUXFER_STRUCT_GUIDES_PARAMS


class luxfer_stylize_params(Structure):
    """Settings of a stylisation. The defaults stated here belong to StylizePreset.FULL."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("search", c_int32),
        ("patch", c_uint32),
        ("guide_weight", c_float),
        ("coarse_guides", c_float),
        ("levels", c_uint32),
        ("iterations", c_uint32),
        ("coarse_iterations", c_uint32),
        ("finest_iterations", c_uint32),
        ("polish", c_uint32),
        ("search_iterations", c_uint32),
        ("coverage", c_float),
        ("passes", c_uint32),
        ("settle", c_uint32),
        ("seam", c_float),
        ("vote", c_int32),
        ("final_vote", c_int32),
        ("preview", c_uint32),
        ("keep_for_update", c_uint32),
        ("coherence", c_float),
        ("match_appearance", c_float),
        ("reserved", c_uint32),
        ("seed", c_uint64),
    ]
    enumerations: dict[str, type] = {"search": types.StylizeSearch, "vote": types.StylizeVote, "final_vote": types.StylizeVote}
    struct_type = LUXFER_STRUCT_STYLIZE_PARAMS


class luxfer_stylize_report(Structure):
    """Quality of a stylisation."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("is_complete", c_uint32),
        ("levels", c_uint32),
        ("halvings", c_uint32),
        ("patch", c_uint32),
        ("max_uses", c_uint32),
        ("energy", c_double),
        ("used", c_double),
        ("entropy", c_double),
        ("guide_error", c_double),
        ("broken_source", c_uint64),
        ("broken_target", c_uint64),
        ("unblended_share", c_double),
        ("normals_weight", c_double),
    ]
    result = types.StylizeReport


class luxfer_sheet_params(Structure):
    """Settings of a print sheet."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("even_light", c_uint32),
        ("paper_width", c_double),
        ("paper_height", c_double),
        ("dpi", c_double),
        ("margin", c_double),
        ("contrast", c_double),
    ]
    struct_type = LUXFER_STRUCT_SHEET_PARAMS


class luxfer_sheet_report(Structure):
    """Quality of the alignment of a photo with its picture."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("marks", c_uint32),
        ("residual", c_double),
        ("error", c_double),
        ("to_photo", c_double * 9),
        ("bend", c_double),
        ("dots", c_uint32),
        ("reserved", c_uint32),
    ]
    result = types.SheetReport


class luxfer_plan_params(Structure):
    """Goal of a plan, a time or an error: set exactly one of time_budget_ms and target_error."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("time_budget_ms", c_uint32),
        ("target_error", c_float),
        ("reserved", c_uint32),
    ]
    struct_type = LUXFER_STRUCT_PLAN_PARAMS


class luxfer_plan_report(Structure):
    """Times and errors that a plan predicts."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("relights", c_uint32),
        ("seconds", c_double),
        ("error", c_double),
        ("relight_seconds", c_double),
        ("relight_error", c_double),
        ("render_seconds", c_double),
        ("render_error", c_double),
    ]
    result = types.PlanReport


class luxfer_render_part(Structure):
    """A part of a rendering."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("x", c_uint32),
        ("y", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("first_sample", c_uint32),
        ("samples", c_uint32),
    ]
    struct_type = LUXFER_STRUCT_RENDER_PART


class luxfer_demo_photo_params(Structure):
    """Settings of the demonstration photo."""

    _fields_ = [
        ("struct_size", c_uint32),
        ("width", c_uint32),
        ("height", c_uint32),
        ("samples", c_uint32),
        ("seed", c_uint64),
    ]
    struct_type = LUXFER_STRUCT_DEMO_PHOTO_PARAMS


#: What each function returns, and takes: names and types.
FUNCTIONS: dict[str, tuple[Any, list[tuple[str, Any]]]] = {
    "luxfer_get_version": (c_uint32, []),
    "luxfer_get_version_string": (c_char_p, []),
    "luxfer_status_get_name": (c_char_p, [("status", c_int32)]),
    "luxfer_init": (c_int32, [("struct_type", c_int32), ("place", c_void_p), ("size", c_size_t)]),
    "luxfer_context_create": (c_int32, [("params", POINTER(luxfer_context_params)), ("context", POINTER(POINTER(luxfer_context)))]),
    "luxfer_context_get_last_error": (c_int32, [("context", POINTER(luxfer_context)), ("buffer", c_char_p), ("capacity", c_size_t), ("needed", POINTER(c_size_t))]),
    "luxfer_retain": (c_int32, [("handle", c_void_p)]),
    "luxfer_release": (c_int32, [("handle", c_void_p)]),
    "luxfer_image_create": (c_int32, [("context", POINTER(luxfer_context)), ("view", POINTER(luxfer_image_view)), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_image_load": (c_int32, [("context", POINTER(luxfer_context)), ("path", c_char_p), ("colour_space", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_image_load_memory": (c_int32, [("context", POINTER(luxfer_context)), ("data", c_void_p), ("size", c_size_t), ("colour_space", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_image_save": (c_int32, [("image", POINTER(luxfer_image)), ("path", c_char_p), ("exposure", c_float)]),
    "luxfer_image_get_size": (c_int32, [("image", POINTER(luxfer_image)), ("width", POINTER(c_uint32)), ("height", POINTER(c_uint32)), ("channels", POINTER(c_uint32))]),
    "luxfer_image_read": (c_int32, [("image", POINTER(luxfer_image)), ("first_channel", c_uint32), ("view", POINTER(luxfer_image_view))]),
    "luxfer_image_get_metadata": (c_int32, [("image", POINTER(luxfer_image)), ("metadata", POINTER(luxfer_photo_metadata)), ("size", c_size_t)]),
    "luxfer_image_merge_exposures": (c_int32, [("context", POINTER(luxfer_context)), ("photos", POINTER(POINTER(luxfer_image))), ("count", c_size_t), ("params", POINTER(luxfer_merge_params)), ("image", POINTER(POINTER(luxfer_image))), ("report", POINTER(luxfer_merge_report)), ("size", c_size_t)]),
    "luxfer_strokes_create": (c_int32, [("context", POINTER(luxfer_context)), ("width", c_uint32), ("height", c_uint32), ("strokes", POINTER(POINTER(luxfer_strokes)))]),
    "luxfer_strokes_add": (c_int32, [("strokes", POINTER(luxfer_strokes)), ("phase", c_int32), ("points", POINTER(c_float)), ("point_count", c_size_t), ("radius", c_float), ("positive", c_int32)]),
    "luxfer_strokes_add_image": (c_int32, [("strokes", POINTER(luxfer_strokes)), ("drawing", POINTER(luxfer_image))]),
    "luxfer_strokes_add_text": (c_int32, [("strokes", POINTER(luxfer_strokes)), ("description", c_char_p)]),
    "luxfer_job_wait": (c_int32, [("job", POINTER(luxfer_job)), ("timeout_ms", c_int32), ("progress", luxfer_progress_fn), ("user", c_void_p), ("outcome", POINTER(c_int32))]),
    "luxfer_job_get_progress": (c_int32, [("job", POINTER(luxfer_job)), ("fraction", POINTER(c_double))]),
    "luxfer_job_cancel": (c_int32, [("job", POINTER(luxfer_job))]),
    "luxfer_job_start": (c_int32, [("context", POINTER(luxfer_context)), ("work", luxfer_work_fn), ("user", c_void_p), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_scene_create": (c_int32, [("context", POINTER(luxfer_context)), ("scene", POINTER(POINTER(luxfer_scene)))]),
    "luxfer_scene_export": (c_int32, [("scene", POINTER(luxfer_scene)), ("path", c_char_p)]),
    "luxfer_scene_export_memory": (c_int32, [("scene", POINTER(luxfer_scene)), ("write", luxfer_write_fn), ("user", c_void_p)]),
    "luxfer_scene_get_counts": (c_int32, [("scene", POINTER(luxfer_scene)), ("counts", POINTER(luxfer_scene_counts)), ("size", c_size_t)]),
    "luxfer_scene_set_environment": (c_int32, [("scene", POINTER(luxfer_scene)), ("image", POINTER(luxfer_image)), ("rgb", POINTER(c_float))]),
    "luxfer_scene_find_surface": (c_int32, [("scene", POINTER(luxfer_scene)), ("name", c_char_p), ("found", POINTER(luxfer_surface)), ("size", c_size_t)]),
    "luxfer_scene_place_emission": (c_int32, [("scene", POINTER(luxfer_scene)), ("name", c_char_p), ("texture", POINTER(luxfer_image)), ("rgb", POINTER(c_float)), ("mesh", POINTER(c_uint32)), ("material", POINTER(c_uint32))]),
    "luxfer_scene_load": (c_int32, [("context", POINTER(luxfer_context)), ("path", c_char_p), ("params", POINTER(luxfer_scene_load_params)), ("scene", POINTER(POINTER(luxfer_scene)))]),
    "luxfer_scene_load_memory": (c_int32, [("context", POINTER(luxfer_context)), ("data", c_void_p), ("size", c_size_t), ("base_path", c_char_p), ("params", POINTER(luxfer_scene_load_params)), ("scene", POINTER(POINTER(luxfer_scene)))]),
    "luxfer_scene_get_origin": (c_int32, [("scene", POINTER(luxfer_scene)), ("x", POINTER(c_double)), ("y", POINTER(c_double)), ("z", POINTER(c_double))]),
    "luxfer_scene_add_material": (c_int32, [("scene", POINTER(luxfer_scene)), ("params", POINTER(luxfer_material_params)), ("index", POINTER(c_uint32))]),
    "luxfer_scene_set_material": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("params", POINTER(luxfer_material_params))]),
    "luxfer_scene_get_material": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("params", POINTER(luxfer_material_params)), ("size", c_size_t)]),
    "luxfer_scene_add_texture": (c_int32, [("scene", POINTER(luxfer_scene)), ("image", POINTER(luxfer_image)), ("wrap_u", c_int32), ("wrap_v", c_int32), ("index", POINTER(c_uint32))]),
    "luxfer_scene_set_material_texture": (c_int32, [("scene", POINTER(luxfer_scene)), ("material", c_uint32), ("role", c_int32), ("texture", c_uint32), ("uv_set", c_uint32), ("transform", POINTER(c_float))]),
    "luxfer_scene_get_material_texture": (c_int32, [("scene", POINTER(luxfer_scene)), ("material_index", c_uint32), ("role", c_int32), ("texture_use", POINTER(luxfer_texture_use)), ("size", c_size_t)]),
    "luxfer_scene_get_texture": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_scene_add_mesh": (c_int32, [("scene", POINTER(luxfer_scene)), ("params", POINTER(luxfer_mesh_params)), ("index", POINTER(c_uint32))]),
    "luxfer_scene_add_camera": (c_int32, [("scene", POINTER(luxfer_scene)), ("params", POINTER(luxfer_camera_params)), ("index", POINTER(c_uint32))]),
    "luxfer_scene_set_camera": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("params", POINTER(luxfer_camera_params))]),
    "luxfer_scene_get_camera": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("params", POINTER(luxfer_camera_params)), ("size", c_size_t)]),
    "luxfer_distribution_load": (c_int32, [("context", POINTER(luxfer_context)), ("path", c_char_p), ("distribution", POINTER(POINTER(luxfer_distribution)))]),
    "luxfer_distribution_load_memory": (c_int32, [("context", POINTER(luxfer_context)), ("data", c_void_p), ("size", c_size_t), ("format", c_int32), ("distribution", POINTER(POINTER(luxfer_distribution)))]),
    "luxfer_distribution_save": (c_int32, [("distribution", POINTER(luxfer_distribution)), ("path", c_char_p)]),
    "luxfer_distribution_get_report": (c_int32, [("distribution", POINTER(luxfer_distribution)), ("report", POINTER(luxfer_distribution_report)), ("size", c_size_t)]),
    "luxfer_distribution_get_name": (c_int32, [("distribution", POINTER(luxfer_distribution)), ("buffer", c_char_p), ("capacity", c_size_t), ("needed", POINTER(c_size_t))]),
    "luxfer_distribution_get_intensity": (c_int32, [("distribution", POINTER(luxfer_distribution)), ("c", c_double), ("gamma", c_double), ("candela", POINTER(c_double))]),
    "luxfer_scene_add_light": (c_int32, [("scene", POINTER(luxfer_scene)), ("params", POINTER(luxfer_light_params)), ("index", POINTER(c_uint32))]),
    "luxfer_scene_add_luminaire": (c_int32, [("scene", POINTER(luxfer_scene)), ("distribution", POINTER(luxfer_distribution)), ("params", POINTER(luxfer_luminaire_params)), ("index", POINTER(c_uint32))]),
    "luxfer_scene_intersect": (c_int32, [("scene", POINTER(luxfer_scene)), ("rays", POINTER(luxfer_ray)), ("count", c_size_t), ("ray_stride", c_size_t), ("hits", POINTER(luxfer_hit)), ("hit_stride", c_size_t)]),
    "luxfer_scene_get_requirements": (c_int32, [("scene", POINTER(luxfer_scene)), ("error", c_float), ("requirements", POINTER(luxfer_requirements)), ("size", c_size_t)]),
    "luxfer_scene_get_requirements_text": (c_int32, [("scene", POINTER(luxfer_scene)), ("buffer", c_char_p), ("capacity", c_size_t), ("needed", POINTER(c_size_t))]),
    "luxfer_scene_get_mesh": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("info", POINTER(luxfer_mesh_info)), ("size", c_size_t)]),
    "luxfer_scene_get_mesh_name": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("buffer", c_char_p), ("capacity", c_size_t), ("needed", POINTER(c_size_t))]),
    "luxfer_scene_read_vertices": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("attribute", c_int32), ("values", POINTER(c_float)), ("capacity", c_size_t)]),
    "luxfer_scene_read_triangles": (c_int32, [("scene", POINTER(luxfer_scene)), ("index", c_uint32), ("indices", POINTER(c_uint32)), ("capacity", c_size_t)]),
    "luxfer_scene_get_candidates": (c_int32, [("scene", POINTER(luxfer_scene)), ("candidates", POINTER(POINTER(luxfer_candidates)))]),
    "luxfer_candidates_get_count": (c_int32, [("candidates", POINTER(luxfer_candidates)), ("count", POINTER(c_uint32))]),
    "luxfer_candidates_get": (c_int32, [("candidates", POINTER(luxfer_candidates)), ("index", c_uint32), ("candidate", POINTER(luxfer_candidate)), ("size", c_size_t)]),
    "luxfer_render_create": (c_int32, [("context", POINTER(luxfer_context)), ("render", POINTER(POINTER(luxfer_render)))]),
    "luxfer_render_set_scene": (c_int32, [("render", POINTER(luxfer_render)), ("scene", POINTER(luxfer_scene))]),
    "luxfer_render_set_camera": (c_int32, [("render", POINTER(luxfer_render)), ("camera", POINTER(luxfer_camera_params))]),
    "luxfer_render_start": (c_int32, [("render", POINTER(luxfer_render)), ("params", POINTER(luxfer_render_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_render_get_image": (c_int32, [("render", POINTER(luxfer_render)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_render_get_requirements_text": (c_int32, [("render", POINTER(luxfer_render)), ("buffer", c_char_p), ("capacity", c_size_t), ("needed", POINTER(c_size_t))]),
    "luxfer_render_get_report": (c_int32, [("render", POINTER(luxfer_render)), ("report", POINTER(luxfer_render_report)), ("size", c_size_t)]),
    "luxfer_render_add_expression": (c_int32, [("render", POINTER(luxfer_render)), ("name", c_char_p), ("expression", c_char_p)]),
    "luxfer_render_clear_expressions": (c_int32, [("render", POINTER(luxfer_render))]),
    "luxfer_render_set_emitter_as": (c_int32, [("render", POINTER(luxfer_render)), ("emitter_as", c_int32)]),
    "luxfer_render_set_aovs": (c_int32, [("render", POINTER(luxfer_render)), ("flags", c_uint32)]),
    "luxfer_render_get_layer_count": (c_int32, [("render", POINTER(luxfer_render)), ("count", POINTER(c_uint32))]),
    "luxfer_render_get_layer_name": (c_int32, [("render", POINTER(luxfer_render)), ("index", c_uint32), ("buffer", c_char_p), ("capacity", c_size_t), ("needed", POINTER(c_size_t))]),
    "luxfer_render_get_layer": (c_int32, [("render", POINTER(luxfer_render)), ("name", c_char_p), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_render_write_exr": (c_int32, [("render", POINTER(luxfer_render)), ("path", c_char_p)]),
    "luxfer_homography_from_corners": (c_int32, [("context", POINTER(luxfer_context)), ("from", POINTER(c_double)), ("to", POINTER(c_double)), ("homography", POINTER(c_double))]),
    "luxfer_image_warp": (c_int32, [("source", POINTER(luxfer_image)), ("to_source", POINTER(c_double)), ("width", c_uint32), ("height", c_uint32), ("warped", POINTER(POINTER(luxfer_image)))]),
    "luxfer_rectify_create": (c_int32, [("context", POINTER(luxfer_context)), ("rectify", POINTER(POINTER(luxfer_rectify)))]),
    "luxfer_rectify_set_photo": (c_int32, [("rectify", POINTER(luxfer_rectify)), ("photo", POINTER(luxfer_image))]),
    "luxfer_rectify_set_mask": (c_int32, [("rectify", POINTER(luxfer_rectify)), ("mask", POINTER(luxfer_image))]),
    "luxfer_rectify_start": (c_int32, [("rectify", POINTER(luxfer_rectify)), ("params", POINTER(luxfer_rectify_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_rectify_get_image": (c_int32, [("rectify", POINTER(luxfer_rectify)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_rectify_undistort": (c_int32, [("rectify", POINTER(luxfer_rectify)), ("image", POINTER(luxfer_image)), ("undistorted", POINTER(POINTER(luxfer_image)))]),
    "luxfer_rectify_get_report": (c_int32, [("rectify", POINTER(luxfer_rectify)), ("report", POINTER(luxfer_rectify_report)), ("size", c_size_t)]),
    "luxfer_features_create": (c_int32, [("context", POINTER(luxfer_context)), ("features", POINTER(POINTER(luxfer_features)))]),
    "luxfer_features_set_photo": (c_int32, [("features", POINTER(luxfer_features)), ("photo", POINTER(luxfer_image))]),
    "luxfer_features_set_depth": (c_int32, [("features", POINTER(luxfer_features)), ("depth", POINTER(luxfer_image)), ("kind", c_int32)]),
    "luxfer_features_set_network": (c_int32, [("features", POINTER(luxfer_features)), ("path", c_char_p), ("normalisation", c_int32)]),
    "luxfer_features_set_view": (c_int32, [("features", POINTER(luxfer_features)), ("rectify", POINTER(luxfer_rectify))]),
    "luxfer_features_set_strokes": (c_int32, [("features", POINTER(luxfer_features)), ("strokes", POINTER(luxfer_strokes))]),
    "luxfer_features_start": (c_int32, [("features", POINTER(luxfer_features)), ("params", POINTER(luxfer_features_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_features_get_image": (c_int32, [("features", POINTER(luxfer_features)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_features_get_report": (c_int32, [("features", POINTER(luxfer_features)), ("report", POINTER(luxfer_features_report)), ("size", c_size_t)]),
    "luxfer_segment_create": (c_int32, [("context", POINTER(luxfer_context)), ("segment", POINTER(POINTER(luxfer_segment)))]),
    "luxfer_segment_set_features": (c_int32, [("segment", POINTER(luxfer_segment)), ("features", POINTER(luxfer_image))]),
    "luxfer_segment_set_region": (c_int32, [("segment", POINTER(luxfer_segment)), ("region", POINTER(luxfer_image))]),
    "luxfer_segment_set_strokes": (c_int32, [("segment", POINTER(luxfer_segment)), ("phase", c_int32), ("strokes", POINTER(luxfer_strokes))]),
    "luxfer_segment_start": (c_int32, [("segment", POINTER(luxfer_segment)), ("params", POINTER(luxfer_segment_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_segment_get_image": (c_int32, [("segment", POINTER(luxfer_segment)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_segment_get_report": (c_int32, [("segment", POINTER(luxfer_segment)), ("report", POINTER(luxfer_segment_report)), ("size", c_size_t)]),
    "luxfer_emission_create": (c_int32, [("context", POINTER(luxfer_context)), ("emission", POINTER(POINTER(luxfer_emission)))]),
    "luxfer_emission_set_exemplar": (c_int32, [("emission", POINTER(luxfer_emission)), ("unwarped", POINTER(luxfer_image)), ("light", POINTER(luxfer_image)), ("valid", POINTER(luxfer_image))]),
    "luxfer_emission_set_photo": (c_int32, [("emission", POINTER(luxfer_emission)), ("photo", POINTER(luxfer_image)), ("to_photo", POINTER(c_double))]),
    "luxfer_emission_start": (c_int32, [("emission", POINTER(luxfer_emission)), ("params", POINTER(luxfer_emission_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_emission_get_image": (c_int32, [("emission", POINTER(luxfer_emission)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_emission_get_report": (c_int32, [("emission", POINTER(luxfer_emission)), ("report", POINTER(luxfer_emission_report)), ("size", c_size_t)]),
    "luxfer_emission_get_luminaire": (c_int32, [("emission", POINTER(luxfer_emission)), ("index", c_uint32), ("luminaire", POINTER(luxfer_luminaire)), ("size", c_size_t)]),
    "luxfer_emission_get_corner": (c_int32, [("emission", POINTER(luxfer_emission)), ("index", c_uint32), ("corner", c_uint32), ("x", POINTER(c_double)), ("y", POINTER(c_double))]),
    "luxfer_emission_add_style": (c_int32, [("emission", POINTER(luxfer_emission)), ("unwarped", POINTER(luxfer_image)), ("light", POINTER(luxfer_image)), ("valid", POINTER(luxfer_image)), ("photo", POINTER(luxfer_image)), ("to_photo", POINTER(c_double)), ("scale", c_double), ("weights", POINTER(luxfer_image))]),
    "luxfer_emission_clear_styles": (c_int32, [("emission", POINTER(luxfer_emission))]),
    "luxfer_emission_start_composition": (c_int32, [("emission", POINTER(luxfer_emission)), ("params", POINTER(luxfer_emission_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_emission_render_tile": (c_int32, [("emission", POINTER(luxfer_emission)), ("x", c_uint32), ("y", c_uint32), ("width", c_uint32), ("height", c_uint32), ("tile", POINTER(POINTER(luxfer_image)))]),
    "luxfer_relight_create": (c_int32, [("context", POINTER(luxfer_context)), ("relight", POINTER(POINTER(luxfer_relight)))]),
    "luxfer_relight_set_scene": (c_int32, [("relight", POINTER(luxfer_relight)), ("scene", POINTER(luxfer_scene)), ("material", c_uint32), ("mesh", c_uint32)]),
    "luxfer_relight_set_target": (c_int32, [("relight", POINTER(luxfer_relight)), ("rgb", POINTER(c_float))]),
    "luxfer_relight_set_constraint": (c_int32, [("relight", POINTER(luxfer_relight)), ("constraint", POINTER(c_int32))]),
    "luxfer_relight_start": (c_int32, [("relight", POINTER(luxfer_relight)), ("params", POINTER(luxfer_relight_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_relight_get_report": (c_int32, [("relight", POINTER(luxfer_relight)), ("report", POINTER(luxfer_relight_report)), ("size", c_size_t)]),
    "luxfer_transfer_create": (c_int32, [("context", POINTER(luxfer_context)), ("transfer", POINTER(POINTER(luxfer_transfer)))]),
    "luxfer_transfer_set_photo": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("photo", POINTER(luxfer_image))]),
    "luxfer_transfer_set_depth": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("depth", POINTER(luxfer_image)), ("kind", c_int32)]),
    "luxfer_transfer_set_scene": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("scene", POINTER(luxfer_scene)), ("surface", c_char_p)]),
    "luxfer_transfer_set_triangles": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("triangles", POINTER(c_uint32)), ("count", c_size_t)]),
    "luxfer_transfer_set_texture": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("texture", POINTER(luxfer_image))]),
    "luxfer_transfer_set_camera": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("camera", POINTER(luxfer_camera_params))]),
    "luxfer_transfer_set_strokes": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("strokes", POINTER(luxfer_strokes))]),
    "luxfer_transfer_set_zones": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("zones", POINTER(c_double)), ("count", c_size_t)]),
    "luxfer_transfer_use_rectify": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("rectify", POINTER(luxfer_rectify))]),
    "luxfer_transfer_use_features": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("features", POINTER(luxfer_features))]),
    "luxfer_transfer_use_segment": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("phase", c_int32), ("segment", POINTER(luxfer_segment))]),
    "luxfer_transfer_use_mask": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("phase", c_int32), ("mask", POINTER(luxfer_image))]),
    "luxfer_transfer_start": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("first", c_int32), ("last", c_int32), ("params", POINTER(luxfer_transfer_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_transfer_start_all": (c_int32, [("context", POINTER(luxfer_context)), ("transfers", POINTER(POINTER(luxfer_transfer))), ("count", c_size_t), ("first", c_int32), ("last", c_int32), ("params", POINTER(POINTER(luxfer_transfer_params))), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_transfer_get_image": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_transfer_get_scene": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("kind", c_int32), ("scene", POINTER(POINTER(luxfer_scene)))]),
    "luxfer_transfer_get_report": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("report", POINTER(luxfer_transfer_report)), ("size", c_size_t)]),
    "luxfer_transfer_get_view": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("view", POINTER(luxfer_rectify_report)), ("size", c_size_t)]),
    "luxfer_transfer_get_solution": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("solution", POINTER(luxfer_relight_report)), ("size", c_size_t)]),
    "luxfer_transfer_get_fixture": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("index", c_uint32), ("fixture", POINTER(luxfer_fixture)), ("size", c_size_t)]),
    "luxfer_transfer_save_fixtures": (c_int32, [("transfer", POINTER(luxfer_transfer)), ("path", c_char_p)]),
    "luxfer_warnings_get_count": (c_int32, [("warnings", POINTER(luxfer_warnings)), ("count", POINTER(c_uint32))]),
    "luxfer_warnings_get": (c_int32, [("warnings", POINTER(luxfer_warnings)), ("index", c_uint32), ("warning", POINTER(luxfer_warning)), ("size", c_size_t)]),
    "luxfer_warning_get_name": (c_char_p, [("code", c_int32)]),
    "luxfer_get_warnings": (c_int32, [("handle", c_void_p), ("warnings", POINTER(POINTER(luxfer_warnings)))]),
    "luxfer_illuminance_create": (c_int32, [("context", POINTER(luxfer_context)), ("illuminance", POINTER(POINTER(luxfer_illuminance)))]),
    "luxfer_illuminance_set_scene": (c_int32, [("illuminance", POINTER(luxfer_illuminance)), ("scene", POINTER(luxfer_scene))]),
    "luxfer_illuminance_start_grid": (c_int32, [("illuminance", POINTER(luxfer_illuminance)), ("grid", POINTER(luxfer_illuminance_grid)), ("params", POINTER(luxfer_illuminance_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_illuminance_start_mesh": (c_int32, [("illuminance", POINTER(luxfer_illuminance)), ("mesh", c_uint32), ("back", c_uint32), ("params", POINTER(luxfer_illuminance_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_illuminance_get_image": (c_int32, [("illuminance", POINTER(luxfer_illuminance)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_illuminance_get_report": (c_int32, [("illuminance", POINTER(luxfer_illuminance)), ("report", POINTER(luxfer_illuminance_report)), ("size", c_size_t)]),
    "luxfer_lamps_create": (c_int32, [("context", POINTER(luxfer_context)), ("lamps", POINTER(POINTER(luxfer_lamps)))]),
    "luxfer_lamps_set_scene": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("scene", POINTER(luxfer_scene)), ("material", c_uint32)]),
    "luxfer_lamps_start": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("params", POINTER(luxfer_lamps_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_lamps_add_mesh": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("mesh", c_uint32), ("quantity", c_int32), ("rgb", POINTER(c_float)), ("weight", c_double)]),
    "luxfer_lamps_add_grid": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("grid", POINTER(luxfer_illuminance_grid)), ("lux", c_float), ("weight", c_double)]),
    "luxfer_lamps_set_constraint": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("goal", c_uint32), ("constraint", POINTER(c_int32))]),
    "luxfer_lamps_set_levels": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("levels", POINTER(c_double)), ("count", c_size_t)]),
    "luxfer_lamps_clear_goals": (c_int32, [("lamps", POINTER(luxfer_lamps))]),
    "luxfer_lamps_get_report": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("report", POINTER(luxfer_lamps_report)), ("size", c_size_t)]),
    "luxfer_lamps_get_lamp": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("index", c_uint32), ("lamp", POINTER(luxfer_lamp)), ("size", c_size_t)]),
    "luxfer_lamps_get_goal": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("index", c_uint32), ("goal", POINTER(luxfer_lamps_goal)), ("size", c_size_t)]),
    "luxfer_lamps_get_response": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("goal", c_uint32), ("lamp", c_uint32), ("response", POINTER(luxfer_lamps_response)), ("size", c_size_t)]),
    "luxfer_lamps_get_reason": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("buffer", c_char_p), ("capacity", c_size_t), ("needed", POINTER(c_size_t))]),
    "luxfer_lamps_get_texture": (c_int32, [("lamps", POINTER(luxfer_lamps)), ("texture", POINTER(POINTER(luxfer_image)))]),
    "luxfer_importance_create": (c_int32, [("context", POINTER(luxfer_context)), ("importance", POINTER(POINTER(luxfer_importance)))]),
    "luxfer_importance_set_scene": (c_int32, [("importance", POINTER(luxfer_importance)), ("scene", POINTER(luxfer_scene)), ("material", c_uint32), ("mesh", c_uint32)]),
    "luxfer_importance_start": (c_int32, [("importance", POINTER(luxfer_importance)), ("params", POINTER(luxfer_importance_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_importance_get_image": (c_int32, [("importance", POINTER(luxfer_importance)), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_importance_respond": (c_int32, [("importance", POINTER(luxfer_importance)), ("texture", POINTER(luxfer_image)), ("placement", POINTER(c_double)), ("report", POINTER(luxfer_importance_report)), ("size", c_size_t)]),
    "luxfer_importance_solve": (c_int32, [("importance", POINTER(luxfer_importance)), ("texture", POINTER(luxfer_image)), ("placement", POINTER(c_double)), ("rgb", POINTER(c_float)), ("report", POINTER(luxfer_relight_report)), ("size", c_size_t)]),
    "luxfer_importance_start_placement": (c_int32, [("importance", POINTER(luxfer_importance)), ("texture", POINTER(luxfer_image)), ("params", POINTER(luxfer_placement_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_importance_get_placement": (c_int32, [("importance", POINTER(luxfer_importance)), ("placement", POINTER(luxfer_placement)), ("size", c_size_t)]),
    "luxfer_colour_to_temperature": (c_int32, [("context", POINTER(luxfer_context)), ("rgb", POINTER(c_double)), ("kelvin", POINTER(c_double)), ("duv", POINTER(c_double))]),
    "luxfer_temperature_to_colour": (c_int32, [("context", POINTER(luxfer_context)), ("kelvin", c_double), ("duv", c_double), ("rgb", POINTER(c_double))]),
    "luxfer_image_get_glare": (c_int32, [("image", POINTER(luxfer_image)), ("fov_y", c_double), ("threshold", c_double), ("report", POINTER(luxfer_glare_report)), ("size", c_size_t)]),
    "luxfer_image_rate_glare": (c_int32, [("image", POINTER(luxfer_image)), ("params", POINTER(luxfer_glare_params)), ("report", POINTER(luxfer_glare_report)), ("size", c_size_t)]),
    "luxfer_scene_get_glare": (c_int32, [("scene", POINTER(luxfer_scene)), ("observers", POINTER(luxfer_observer)), ("count", c_size_t), ("observer_stride", c_size_t), ("samples", c_uint32), ("seed", c_uint64), ("ratings", POINTER(luxfer_observer_glare)), ("rating_stride", c_size_t)]),
    "luxfer_scene_get_distribution": (c_int32, [("scene", POINTER(luxfer_scene)), ("meshes", POINTER(c_uint32)), ("count", c_size_t), ("params", POINTER(luxfer_gonio_params)), ("distribution", POINTER(POINTER(luxfer_distribution))), ("report", POINTER(luxfer_gonio_report)), ("size", c_size_t)]),
    "luxfer_image_false_colour": (c_int32, [("image", POINTER(luxfer_image)), ("params", POINTER(luxfer_false_colour_params)), ("shown", POINTER(POINTER(luxfer_image)))]),
    "luxfer_sun_get_position": (c_int32, [("context", POINTER(luxfer_context)), ("params", POINTER(luxfer_sun_params)), ("position", POINTER(luxfer_sun_position)), ("size", c_size_t)]),
    "luxfer_scene_set_sky": (c_int32, [("scene", POINTER(luxfer_scene)), ("params", POINTER(luxfer_sky_params)), ("report", POINTER(luxfer_sky_report)), ("size", c_size_t)]),
    "luxfer_weather_read": (c_int32, [("context", POINTER(luxfer_context)), ("path", c_char_p), ("first", c_size_t), ("count", c_size_t), ("hours", POINTER(luxfer_weather_hour)), ("hour_stride", c_size_t), ("report", POINTER(luxfer_weather_report)), ("size", c_size_t)]),
    "luxfer_mix_primaries": (c_int32, [("context", POINTER(luxfer_context)), ("primaries", POINTER(c_double)), ("count", c_size_t), ("max_drive", c_double), ("rgb", POINTER(c_double)), ("drives", POINTER(c_double)), ("mixture", POINTER(luxfer_mixture)), ("size", c_size_t)]),
    "luxfer_fit_temperature": (c_int32, [("context", POINTER(luxfer_context)), ("response", POINTER(c_double)), ("background", POINTER(c_double)), ("target", POINTER(c_double)), ("fit", POINTER(luxfer_temperature_fit)), ("size", c_size_t)]),
    "luxfer_preset_get_count": (c_int32, [("context", POINTER(luxfer_context)), ("count", POINTER(c_uint32))]),
    "luxfer_preset_get": (c_int32, [("context", POINTER(luxfer_context)), ("index", c_uint32), ("preset", POINTER(luxfer_preset)), ("size", c_size_t)]),
    "luxfer_pendants_find": (c_int32, [("context", POINTER(luxfer_context)), ("photo", POINTER(luxfer_image)), ("mask", POINTER(luxfer_image)), ("view", POINTER(luxfer_rectify)), ("suspensions", POINTER(c_double)), ("suspension_count", c_size_t), ("params", POINTER(luxfer_pendants_params)), ("pendants", POINTER(luxfer_pendant)), ("size", c_size_t), ("capacity", c_size_t), ("count", POINTER(c_size_t))]),
    "luxfer_scene_add_pendants": (c_int32, [("scene", POINTER(luxfer_scene)), ("pendant", POINTER(luxfer_pendant)), ("places", POINTER(c_double)), ("count", c_size_t), ("diameter", c_float), ("luminance", c_float), ("first_mesh", POINTER(c_uint32)), ("material", POINTER(c_uint32))]),
    "luxfer_guides_create": (c_int32, [("context", POINTER(luxfer_context)), ("guides", POINTER(POINTER(luxfer_guides)))]),
    "luxfer_guides_set_scene": (c_int32, [("guides", POINTER(luxfer_guides)), ("scene", POINTER(luxfer_scene))]),
    "luxfer_guides_start": (c_int32, [("guides", POINTER(luxfer_guides)), ("params", POINTER(luxfer_guides_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_guides_get_image": (c_int32, [("guides", POINTER(luxfer_guides)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_guides_get_motion": (c_int32, [("guides", POINTER(luxfer_guides)), ("previous", POINTER(luxfer_guides)), ("motion", POINTER(POINTER(luxfer_image)))]),
    "luxfer_stylize_get_preset": (c_int32, [("preset", c_int32), ("params", POINTER(luxfer_stylize_params)), ("size", c_size_t)]),
    "luxfer_stylize_create": (c_int32, [("context", POINTER(luxfer_context)), ("stylize", POINTER(POINTER(luxfer_stylize)))]),
    "luxfer_stylize_set_artwork": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("artwork", POINTER(luxfer_image))]),
    "luxfer_stylize_add_guide": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("name", c_char_p), ("source", POINTER(luxfer_image)), ("target", POINTER(luxfer_image)), ("weight", c_float), ("range", c_int32)]),
    "luxfer_stylize_add_guides": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("source", POINTER(luxfer_guides)), ("target", POINTER(luxfer_guides)), ("extras", c_uint32), ("extra_weight", c_float)]),
    "luxfer_stylize_clear_guides": (c_int32, [("stylize", POINTER(luxfer_stylize))]),
    "luxfer_stylize_set_source_mask": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("mask", POINTER(luxfer_image))]),
    "luxfer_stylize_set_target_mask": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("mask", POINTER(luxfer_image)), ("known", POINTER(luxfer_image))]),
    "luxfer_stylize_set_motion": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("motion", POINTER(luxfer_image))]),
    "luxfer_stylize_start": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("params", POINTER(luxfer_stylize_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_stylize_update": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("artwork", POINTER(luxfer_image)), ("changed_mask", POINTER(luxfer_image)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_stylize_set_painted": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("painted", POINTER(luxfer_image))]),
    "luxfer_stylize_get_image": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_stylize_get_report": (c_int32, [("stylize", POINTER(luxfer_stylize)), ("report", POINTER(luxfer_stylize_report)), ("size", c_size_t)]),
    "luxfer_sheet_print": (c_int32, [("picture", POINTER(luxfer_image)), ("params", POINTER(luxfer_sheet_params)), ("sheet", POINTER(POINTER(luxfer_image)))]),
    "luxfer_sheet_align": (c_int32, [("photo", POINTER(luxfer_image)), ("width", c_uint32), ("height", c_uint32), ("params", POINTER(luxfer_sheet_params)), ("artwork", POINTER(POINTER(luxfer_image))), ("report", POINTER(luxfer_sheet_report)), ("size", c_size_t)]),
    "luxfer_plan_create": (c_int32, [("context", POINTER(luxfer_context)), ("plan", POINTER(POINTER(luxfer_plan)))]),
    "luxfer_plan_start_render": (c_int32, [("plan", POINTER(luxfer_plan)), ("render", POINTER(luxfer_render)), ("settings", POINTER(luxfer_render_params)), ("params", POINTER(luxfer_plan_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_plan_start_transfer": (c_int32, [("plan", POINTER(luxfer_plan)), ("transfer", POINTER(luxfer_transfer)), ("settings", POINTER(luxfer_transfer_params)), ("params", POINTER(luxfer_plan_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_plan_get_report": (c_int32, [("plan", POINTER(luxfer_plan)), ("report", POINTER(luxfer_plan_report)), ("size", c_size_t)]),
    "luxfer_plan_get_render_params": (c_int32, [("plan", POINTER(luxfer_plan)), ("params", POINTER(luxfer_render_params)), ("size", c_size_t)]),
    "luxfer_plan_get_relight_params": (c_int32, [("plan", POINTER(luxfer_plan)), ("params", POINTER(luxfer_relight_params)), ("size", c_size_t)]),
    "luxfer_plan_start_stylize": (c_int32, [("plan", POINTER(luxfer_plan)), ("stylize", POINTER(luxfer_stylize)), ("settings", POINTER(luxfer_stylize_params)), ("params", POINTER(luxfer_plan_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_plan_get_stylize_params": (c_int32, [("plan", POINTER(luxfer_plan)), ("params", POINTER(luxfer_stylize_params)), ("size", c_size_t)]),
    "luxfer_render_split": (c_int32, [("render", POINTER(luxfer_render)), ("params", POINTER(luxfer_render_params)), ("columns", c_uint32), ("rows", c_uint32), ("ranges", c_uint32), ("index", c_uint32), ("part", POINTER(luxfer_render_part)), ("size", c_size_t)]),
    "luxfer_render_start_part": (c_int32, [("render", POINTER(luxfer_render)), ("params", POINTER(luxfer_render_params)), ("part", POINTER(luxfer_render_part)), ("path", c_char_p), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_render_add_part": (c_int32, [("render", POINTER(luxfer_render)), ("path", c_char_p)]),
    "luxfer_render_clear_parts": (c_int32, [("render", POINTER(luxfer_render))]),
    "luxfer_render_start_merge": (c_int32, [("render", POINTER(luxfer_render)), ("params", POINTER(luxfer_render_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_demo_create_scene": (c_int32, [("context", POINTER(luxfer_context)), ("kind", c_int32), ("scene", POINTER(POINTER(luxfer_scene)))]),
    "luxfer_demo_create_artwork": (c_int32, [("guides", POINTER(luxfer_guides)), ("style", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
    "luxfer_demo_photo_create": (c_int32, [("context", POINTER(luxfer_context)), ("demo", POINTER(POINTER(luxfer_demo_photo)))]),
    "luxfer_demo_photo_start": (c_int32, [("demo", POINTER(luxfer_demo_photo)), ("params", POINTER(luxfer_demo_photo_params)), ("job", POINTER(POINTER(luxfer_job)))]),
    "luxfer_demo_photo_get_image": (c_int32, [("demo", POINTER(luxfer_demo_photo)), ("kind", c_int32), ("image", POINTER(POINTER(luxfer_image)))]),
}
