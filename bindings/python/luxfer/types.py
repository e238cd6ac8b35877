# Generated from include/luxfer.h by generate.py: do not edit.
"""Enumerations, settings and reports of the library: what the functions of this package take and return."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import TypedDict


class Status(IntEnum):
    """The result of a call: Status.OK, or why it failed."""

    OK = 0
    """Success."""
    UNKNOWN = 1
    """A cause that has no status of its own."""
    INVALID_ARGUMENT = 2
    """A parameter is None, out of range, of the wrong kind or from another context, or contradicts another."""
    INVALID_OPERATION = 3
    """The call is not allowed in the object's present state: a job is still running on it, or an input is
    missing."""
    OUT_OF_MEMORY = 4
    """The memory budget of the context, or the machine, is used up."""
    UNSUPPORTED = 5
    """The file or the request is valid, but uses something this library does not do."""
    CANCELLED = 6
    """The job was cancelled by the caller."""
    IO = 7
    """The operating system could not read or write a file, or the caller's writer refused."""
    FORMAT = 8
    """A file is truncated, corrupt, or not what it claims to be."""
    NOT_READY = 9
    """A result was asked for before the job that makes it has succeeded, or a wait timed out."""
    INTERNAL = 10
    """A defect in this library: please report it."""
    DEGENERATE = 11
    """The input is well formed but has no answer: no lines, a plane seen edge-on, strokes of one class only."""
    NOT_FOUND = 12
    """No surface, image or entry has the given name or index."""
    UNREACHABLE = 13
    """No light can reach the target: no path, a channel fully absorbed, or negative light would be needed."""


class Sample(IntEnum):
    """How a sample is stored."""

    U8 = 0
    """8-bit unsigned integer that stands for [0, 1]."""
    U16 = 1
    """16-bit unsigned integer that stands for [0, 1]."""
    F16 = 2
    """16-bit floating point (IEEE 754 half)."""
    F32 = 3
    """32-bit floating point."""


class ColourSpace(IntEnum):
    """What the numbers mean."""

    LINEAR = 0
    """Scene-linear Rec.709, or data that is no colour."""
    SRGB = 1
    """Colour encoded with the sRGB curve; the second of two and the fourth of four channels is alpha, which is
    linear."""


class AlphaMode(IntEnum):
    """What the alpha of a surface means."""

    OPAQUE = 0
    """Nothing: it is there everywhere."""
    MASK = 1
    """It is there where alpha is at least alpha_cutoff."""
    BLEND = 2
    """That share of light meets it, the rest finds nothing in its way."""


class Wrap(IntEnum):
    """How a texture continues beyond its edges."""

    REPEAT = 0
    """It repeats."""
    CLAMP = 1
    """Its border goes on."""
    MIRROR = 2
    """It repeats, every other one mirrored."""


class TextureRole(IntEnum):
    """What a material uses a texture for."""

    BASE_COLOR = 0
    """Multiplies the base colour; its alpha multiplies the material's."""
    METALLIC_ROUGHNESS = 1
    """Green multiplies the roughness, blue the metallic share."""
    NORMAL = 2
    """Normals in tangent space."""
    EMISSION = 3
    """Multiplies the emission; looked up without interpolation."""


class DistributionFormat(IntEnum):
    """A file format of distributions."""

    IES = 0
    """IES LM-63, type C."""
    LDT = 1
    """EULUMDAT."""


class LightKind(IntEnum):
    """A kind of light."""

    POINT = 0
    """Shines the same in every direction."""
    SPOT = 1
    """Shines in a cone."""
    DIRECTIONAL = 2
    """Shines from infinitely far away."""


class Lines(IntEnum):
    """How lines are found."""

    REGIONS = 0
    """Regions of like gradient direction, with sub-pixel end points."""
    HOUGH = 1
    """The paper's: gradient-restricted Hough transform of Canny edges."""


class Search(IntEnum):
    """How vanishing points are found."""

    MANHATTAN = 0
    """Three orthogonal directions and the focal length at once, then each refined freely."""
    SUCCESSIVE = 1
    """The paper's: one group of lines after the other."""


class Metric(IntEnum):
    """How far a vanishing point is from a line, in Search.SUCCESSIVE."""

    SEGMENT = 0
    """The paper's measure on the segment that was detected, finite for vanishing points at infinity."""
    VISIBLE_LINE = 1
    """As printed in the paper (Eq. 2), on the whole visible line."""


class RectifyImage(IntEnum):
    """An image of a rectification."""

    UNWARPED = 0
    """The plane seen straight on, linear RGB."""
    VALID = 1
    """1 where the photo shows the plane, else 0; 1 channel."""


class FocalSource(IntEnum):
    """Where a focal length came from."""

    GIVEN = 0
    """The caller gave it."""
    FROM_VANISHING_POINTS = 1
    """From vanishing points of orthogonal directions."""
    ASSUMED = 2
    """A guess, 0.85 of the image's width."""


class DepthKind(IntEnum):
    """What a depth map measures."""

    ALONG_Z = 0
    """Distance along the viewing axis."""
    ALONG_RAY = 1
    """Distance along the ray of each pixel."""


class Normalisation(IntEnum):
    """What the colours of a photo become before a network sees them."""

    BY_SIZE = 0
    """By the size of the network's input: Normalisation.IMAGENET for 256 x 256, else Normalisation.HALF."""
    IMAGENET = 1
    """sRGB less (0.485, 0.456, 0.406), over (0.229, 0.224, 0.225): MiDaS 2.1, large and small."""
    HALF = 2
    """sRGB less 0.5, over 0.5: DPT."""
    NONE = 3
    """sRGB in [0, 1]."""


class FeaturesImage(IntEnum):
    """An image of the features."""

    CHANNELS = 0
    """The ten channels; luxfer_image_read takes them apart."""
    DEPTH_CONFIDENCE = 1
    """Trust in the depth of each pixel, in [0, 1]; 1 channel."""
    NETWORK_DEPTH = 2
    """The depth along z that a network has estimated, from near_plane to far_plane; 1 channel. It can be set as
    the depth map of a further run, or of luxfer_transfer, without running the network again."""


class DepthSource(IntEnum):
    """Where the depth came from."""

    CALLER = 0
    """The caller's depth map."""
    LAYOUT = 1
    """A room laid out from the lines of the photo, and strokes."""
    NOTHING = 2
    """A guess that knows nothing of the photo."""
    NETWORK = 3
    """The caller's network."""


class Phase(IntEnum):
    """What strokes are about."""

    PLANE = 0
    """The plane that carries the lights; its positive strokes lie on the plane, those of lights count as
    well."""
    LIGHTS = 1
    """The lights in the plane; its positive strokes lie on lights, the others on the plane beside them."""


class SegmentImage(IntEnum):
    """An image of a segmentation."""

    MASK = 0
    """1 where the confidence is above one half, else 0; 1 channel."""
    CONFIDENCE = 1
    """Probability that a pixel is of the positive class, in [0, 1]; 1 channel."""
    UNSEEN = 2
    """How far a pixel is from anything that strokes have shown, in [0, 1]: where it is high one more stroke
    helps; 1 channel."""


class EmissionLaw(IntEnum):
    """How the lights of an exemplar go on."""

    BEST = 0
    """The law that predicts the lamps of the photo best: that of their correlation, unless another is clearly
    better."""
    CORRELATION = 1
    """The law that the correlation of the lights tells, by least_regularity."""
    LATTICE = 2
    """A lattice of two periods."""
    ROW = 3
    """A row of one period; the extent of the exemplar serves as the other."""
    WHOLE = 4
    """The exemplar repeats as a whole."""
    FREE = 5
    """Patches go anywhere."""
    COPY = 6
    """Of results only: the texture is a part of the exemplar, or was given."""


class EmissionImage(IntEnum):
    """An image of the emission."""

    TEXTURE = 0
    """The texture: linear RGB relative to the photo's white, 0 where there is no lamp."""
    MASK = 1
    """1 on lamps, else 0; 1 channel."""
    EXEMPLAR_METADATA = 2
    """What synthesis started from, at working size: confidence, signed x and y distance to the nearest light; 3
    channels."""
    METADATA = 3
    """The same of its result."""


class RenderImage(IntEnum):
    """An image of a rendering."""

    BEAUTY = 0
    """Mean radiance of each pixel, linear RGB in cd/m²."""
    VARIANCE = 1
    """Variance of that mean; 3 channels. Pixels in blocks of eight share what their paths find, so that the
    error of a mean over pixels is up to the root of eight times what their variances add up to."""
    PATHS = 2
    """Number of paths of each pixel; 1 channel."""
    INTERVAL = 3
    """Half the width of the interval around each pixel of the beauty that holds the true radiance with a
    probability of 95 %, in cd/m²; 3 channels; infinite where a pixel has less than two paths."""
    PREVIEW = 4
    """The beauty with its noise filtered out, guided by surfaces: what it does not see, such as soft shadows,
    it blurs. How far, the report tells as preview_bias. Only if RenderParams.preview is not 0."""


class EmitterAs(IntEnum):
    """How emissive surfaces and the environment answer to the lights of camera-first expressions."""

    BOTH = 0
    """Surfaces are both L and O, the environment is both L and B: C<RD>L is all direct light. The default."""
    LIGHT = 1
    """Every light is L only."""
    OBJECT = 2
    """As in Open Shading Language: surfaces are O, the environment is B."""


class IlluminanceImage(IntEnum):
    """An image of the calculation."""

    LUX = 0
    """Illuminance in lux; 1 channel, NaN where a mesh has no point."""
    ERROR = 1
    """Standard error of each value, in lux; 1 channel."""


class Quantity(IntEnum):
    """What should match the photo."""

    OUTGOING = 0
    """The light the target surface sends back, its albedo included: what a photo shows of it."""
    INCIDENT = 1
    """The light that arrives at it, as if it were white."""


class Fit(IntEnum):
    """What of the target counts."""

    MEAN = 0
    """Its mean."""
    LEAST_SQUARES = 1
    """Every point of it, by least squares: what gradient descent on texels comes to. Bright points count more,
    so the answer is dimmer than that of the mean, by 1 / (1 + CV²) without other light, where CV is the spread
    of the response over the target relative to its mean."""


class Sense(IntEnum):
    """On which side of its value light should be."""

    EXACTLY = 0
    """At it."""
    AT_LEAST = 1
    """At it or above: what a standard asks of a desk, or what a clipped channel of a photo says."""
    AT_MOST = 2
    """At it or below: a limit against glare."""


class Reach(IntEnum):
    """How far the answer goes to meet the target in one colour channel."""

    MET = 0
    """The target is met."""
    TOO_BRIGHT = 1
    """Other lights alone exceed the target: the emission is off in this channel."""
    DARK = 2
    """No light of this channel reaches the target: the emission keeps the mean scale of the other channels."""
    TOO_DIM = 3
    """All lamps at their largest power do not suffice, or one goal asks for what another forbids."""


class Group(IntEnum):
    """Which lamps share their power."""

    ALL = 0
    """All lamps."""
    EACH = 1
    """Every lamp for itself."""
    FIRST = 2
    """Those whose centres agree in their first coordinate: u of a texture, x of meshes."""
    SECOND = 3
    """Those whose centres agree in their second coordinate: v of a texture, y of meshes."""
    THIRD = 4
    """Those whose centres agree in their third coordinate: z of meshes."""
    TYPE = 5
    """Those of a type: of about the same area; of lights without a surface points, spots, and luminaires by
    their distribution."""


class Aim(IntEnum):
    """What a placement should do."""

    MOST = 0
    """As much luminance for the target as possible."""
    LEAST = 1
    """As little."""
    RADIANCE = 2
    """The mean radiance of the target that is given, all other light included."""


class Scale(IntEnum):
    """How values are spread over the colours."""

    LINEAR = 0
    """Evenly."""
    LOGARITHMIC = 1
    """Decades are equally wide."""


class Unit(IntEnum):
    """What the values of an image are."""

    LUMINANCE = 0
    """Luminance in cd/m²."""
    ILLUMINANCE = 1
    """Illuminance in lux."""


class PatternScale(IntEnum):
    """What sets the size of the pattern on the surface."""

    DISTANCE = 0
    """The distance of the photo's camera from the lit plane: plane_distance of TransferParams."""
    LAMP = 1
    """The length of a lamp: the longer side of the photo's, of which the median counts."""
    SPACING = 2
    """The shorter period of the lattice of lamps; without a lattice, the median distance from a lamp to the
    nearest other."""
    ACROSS = 3
    """The width of the surface: it becomes as many lamps wide as the photo's plane."""


class Target(IntEnum):
    """What part of the photo gives the colour to match."""

    SURFACE = 0
    """The plane that carries the lights, without them and their halo."""
    WHOLE_IMAGE = 1
    """The whole photo."""


class Stage(IntEnum):
    """A stage of the transfer."""

    VIEW = 0
    """Lines, vanishing points and the photo's camera."""
    FEATURES = 1
    """Ten channels for each pixel."""
    PLANE = 2
    """The mask of the plane that carries the lights."""
    LIGHTS = 3
    """The mask of the lights in it."""
    UNWARP = 4
    """The plane seen straight on."""
    EMISSION = 5
    """The emissive texture, laid onto the scene's surface."""
    RELIGHT = 6
    """Its colour and intensity."""
    RENDER = 7
    """The picture."""


class TransferImage(IntEnum):
    """An image of the transfer."""

    FEATURES = 0
    """The ten channels of the features."""
    PLANE_MASK = 1
    """1 on the plane, else 0; 1 channel."""
    PLANE_CONFIDENCE = 2
    """Probability that a pixel is on the plane; 1 channel."""
    LIGHTS_MASK = 3
    """1 on lights, else 0; 1 channel."""
    LIGHTS_CONFIDENCE = 4
    """Probability that a pixel is a light; 1 channel."""
    UNWARPED = 5
    """The plane seen straight on, linear RGB."""
    UNWARPED_VALID = 6
    """1 where the photo shows the plane, else 0; 1 channel."""
    EMISSION = 7
    """The emissive texture, linear RGB relative to the photo's white."""
    EMISSION_MASK = 8
    """1 on lamps of the texture, else 0; 1 channel."""
    RENDER = 9
    """The scene in its new light, linear RGB in cd/m²; while it is being rendered, as far as it is."""
    RENDER_VARIANCE = 10
    """Variance of the rendering; 3 channels."""
    RENDER_PREVIEW = 11
    """The picture with its noise filtered out, if the settings of the stage RENDER have a preview; see
    RenderImage.PREVIEW."""


class TransferScene(IntEnum):
    """A scene of the transfer."""

    UNSOLVED = 0
    """With the emission at the photo's own strength, before it is solved for."""
    LIT = 1
    """With the solved emission: the result."""
    WHITE = 2
    """As TransferScene.LIT, the light's colour taken away and its luminance kept."""


class GuidesImage(IntEnum):
    """An image of guides."""

    FULL = 0
    """All light."""
    DIRECT = 1
    """Light reflected once, by something matt (LDE)."""
    SPECULAR = 2
    """Light reflected once, by something glossy (LSE)."""
    INDIRECT = 3
    """Light whose last two reflections were matt (L.*DDE): where colours bleed."""
    TWO_BOUNCES = 4
    """Light reflected once or twice, by matt things (LD{1,2}E): what is in the shadow."""
    NORMALS = 5
    """Normals as the camera has them: x right, y up, z towards it; 3 channels."""
    EDGES = 6
    """Edges of shapes, in [0, 1]; 1 channel."""
    MATERIALS = 7
    """A colour for each material, made from its name; 3 channels."""
    CAUSTICS = 8
    """Light that glossy things throw onto matt ones (LS+DE)."""


class StylizeMode(IntEnum):
    """How matches between exemplar and target are made."""

    BUDGET = 0
    """Exemplar patches look for their places under an error budget (Fiser et al. 2016), the default."""
    UNIFORM = 1
    """Every exemplar patch is used equally often (Jamriska et al. 2015)."""
    NEAREST = 2
    """Each place takes its nearest exemplar patch (Wexler et al. 2007)."""
    GREEDY = 3
    """One pass in scan order (Hertzmann et al. 2001); on one thread."""
    LIT_SPHERE = 4
    """Each pixel takes the exemplar pixel whose guides are nearest; with normals as guides the Lit Sphere
    (Sloan et al. 2001)."""
    OCCURRENCE = 5
    """Each place takes its nearest exemplar patch, and one that is used often counts as farther (Kaspar et al.
    2015): see occurrence. On one thread, and by StylizeSearch.PATCHMATCH only."""


class StylizeSearch(IntEnum):
    """How nearest patches are searched for."""

    PATCHMATCH = 0
    """PatchMatch, the default."""
    TABLE = 1
    """A k-d tree over the means of patches: not PatchMatch."""


class StylizeVote(IntEnum):
    """How patches that overlap make a pixel."""

    PLAIN = 0
    """Their mean."""
    WEIGHTED = 1
    """Their mean, closer matches counting more."""
    NEAREST = 2
    """The one nearest to their mean, so that no colour is made that is not in the artwork."""
    MOST = 3
    """The one that most of them put there, so that pieces of the artwork stay whole up to their seams."""


class StylizePreset(IntEnum):
    """How good and how fast."""

    FULL = 0
    """Full quality, the default."""
    FAST = 1
    """Nearly as good in half the time."""
    PREVIEW = 2
    """Half resolution, guides compressed: for watching while painting."""
    PAPER = 3
    """The settings of the paper, for comparison."""


class GuideRange(IntEnum):
    """What the numbers of a guide mean."""

    LIGHT = 0
    """Linear light >= 0, such as renderings; compared as it would look on a screen."""
    DATA = 1
    """Numbers without a curve, such as normals, object codes and edges; the range of both images together
    becomes [0, 1]."""


class StylizeImage(IntEnum):
    """An image of a stylisation."""

    PICTURE = 0
    """The stylised target, linear, with the artwork's channels. Before the last level, in preview and after a
    cancel its sides are those of the target halved StylizeReport.halvings times, rounded down."""
    GUIDE_ERROR = 1
    """How far the guides at each pixel are from those where its paint was taken, in [0, 1]; 1 channel. High
    where the exemplar has nothing that fits."""
    SOURCES = 2
    """Where in the artwork the paint of each pixel was taken, x and y in pixels, -1 where nothing was painted;
    2 channels."""


class Demo(IntEnum):
    """A generated scene."""

    TARGET_ROOM = 0
    """A furnished room without any light; its ceiling is the object "Ceiling"."""
    EXEMPLAR_ROOM = 1
    """An office under a grid of luminaires; camera 0 takes the photo."""
    SPHERE_ON_TABLE = 2
    """A glossy red ball on a white table, for artists to paint: the exemplar of a stylisation."""
    STILL_LIFE = 3
    """A vase, a ring and two balls on the same table under the same lamp: a target for a stylisation."""


class Artwork(IntEnum):
    """How an artwork is drawn."""

    PEN = 0
    """Hatching with a pen and two inks."""
    STIPPLE = 1
    """Dots of two inks."""
    PAINT = 2
    """Oil on canvas."""


class DemoPhotoImage(IntEnum):
    """An image of the demonstration."""

    PICTURE = 0
    """The photo: linear RGB, 1 = display white; its lamps are clipped."""
    STROKES = 1
    """The strokes on it, in the colours of luxfer_segment_add_strokes_image."""


class Aov(IntFlag):
    """Aov, to be combined with |."""

    DEPTH = 1
    """Distance along the viewing direction, in metres; infinite where nothing is. Layer Depth, channel Z."""
    DISTANCE = 2
    """Distance along the ray, in metres; infinite where nothing is. Layer Distance, channel Z."""
    POSITION = 4
    """Place in the world, in metres. Layer Position, channels X Y Z."""
    NORMAL = 8
    """Shading normal in the world, towards the viewer; 0 where nothing is. Layer Normal, channels X Y Z."""
    GEOMETRIC_NORMAL = 16
    """Normal of the triangle itself, likewise. Layer GeometricNormal, channels X Y Z."""
    ALBEDO = 32
    """Colour at normal incidence. Layer Albedo, channels R G B."""
    OBJECT = 64
    """Index of the mesh plus 1, 0 where nothing is; of what most samples met. Layer IndexOB, channel X."""
    MATERIAL = 128
    """Index of the material plus 1, likewise. Layer IndexMA, channel X."""
    ALPHA = 256
    """Share of the pixel that is covered by surfaces. Layer Alpha, channel A."""
    LUMINANCE = 512
    """Luminance of the main image, in cd/m². Layer Luminance, channel Y."""


class GuidesWith(IntFlag):
    """GuidesWith, to be combined with |."""

    NORMALS = 1
    """Flag of luxfer_stylize_add_guides: normals too."""
    EDGES = 2
    """Flag: edges too, for shapes finer than the strokes."""
    MATERIALS = 4
    """Flag: the colour code of materials too, so that things of one material are painted from things of the
    same."""
    CAUSTICS = 8
    """Flag: caustics too, light at the common exposure, for scenes in which glossy things throw light onto
    others."""


class Lights(IntFlag):
    """Lights, to be combined with |."""

    SURFACE = 1
    """Some surface emits."""
    TEXTURE = 2
    """Some surface emits by a texture."""
    POINT = 4
    """There is a point light that shines."""
    SPOT = 8
    """There is a spot light that shines."""
    DIRECTIONAL = 16
    """There is a directional light that shines."""
    ENVIRONMENT = 32
    """The environment shines."""


class Scattering(IntFlag):
    """Scattering, to be combined with |."""

    DIFFUSE = 1
    """Some surface scatters diffusely."""
    GLOSSY = 2
    """Some surface has a rough reflecting layer."""
    MIRROR = 4
    """Some surface reflects as a mirror."""
    GLASS = 8
    """Some surface is a clear pane."""
    ALPHA = 16
    """Some surface is partly not there."""


class View(IntFlag):
    """View, to be combined with |."""

    BOTTOM_UP = 1
    """Flag of a view: the first row in memory is the bottom one."""


class ContextParams(TypedDict, total=False):
    """How a context is set up."""

    num_threads: int
    """Number of worker threads in [0, 1024]; 0, the default, is one for each core the process may use."""
    memory_budget_mib: int
    """Limit in MiB for the pixels, meshes and textures of all objects the caller makes in this context; what
    exceeds it is Status.OUT_OF_MEMORY. 0, the default, is no limit. Working memory of a job and its results are
    not counted."""


class ImageView(TypedDict, total=False):
    """An image in the caller's memory."""

    channels: int
    """Samples per pixel in [1, 4]; default 3."""
    sample: Sample | str | int
    """Sample; default Sample.F32."""
    colour_space: ColourSpace | str | int
    """ColourSpace; default ColourSpace.LINEAR."""
    width: int
    """Pixels in a row, in [1, 65536]; default 0, to be set."""
    height: int
    """Rows, in [1, 65536]; default 0, to be set."""
    flags: View | str | int
    """View, or 0, the default. Unknown flags are refused."""
    pixel_stride: int
    """Bytes from a pixel to the next; at least the pixel's size, or 0, the default: packed."""
    row_stride: int
    """Bytes from a row to the next; at least the row's size, or 0, the default: packed."""
    byte_size: int
    """Bytes at data that may be accessed; what the layout needs beyond is Status.INVALID_ARGUMENT. To be
    set."""
    data: int
    """The pixels; any alignment. Bytes between pixels and rows are never touched. To be set."""


@dataclass(frozen=True)
class SceneCounts:
    """How much there is in a scene."""

    meshes: int
    """Number of meshes, whose indices are 0 to meshes - 1; so with what follows."""
    materials: int
    """Number of materials."""
    textures: int
    """Number of textures."""
    lights: int
    """Number of lights without a surface."""
    cameras: int
    """Number of cameras."""
    triangles: int
    """Triangles of all meshes."""


@dataclass(frozen=True)
class Surface:
    """A planar surface of a scene."""

    triangles: int
    """Number of its triangles."""
    origin: tuple[float, float, float]
    """Corner of its bounding rectangle where u = v = 0, in metres."""
    u_axis: tuple[float, float, float]
    """Unit direction of u, along the first side of the rectangle."""
    v_axis: tuple[float, float, float]
    """Unit direction of v, along the second side."""
    normal: tuple[float, float, float]
    """Unit normal on the side that will emit: into the room."""
    size: tuple[float, float]
    """Lengths of the sides along u and v, in metres."""
    area: float
    """Area of the triangles in m²."""
    bent: float
    """Area of what was named besides and slopes from this plane by 5 to 75 degrees, in m²: as of a vault, which
    gets no light."""


class MaterialParams(TypedDict, total=False):
    """A material: metallic-roughness, as in glTF 2.0."""

    double_sided: int
    """Whether back faces reflect and emit as front faces do: 0 or 1, the default."""
    name: str
    """Name in UTF-8, copied; None, the default, is none."""
    base_color: Sequence[float]
    """Linear colour of the surface, each in [0, 1]; default 0.8."""
    metallic: float
    """In [0, 1]; default 0."""
    roughness: float
    """Perceptual roughness in [0, 1]; default 1."""
    emission: Sequence[float]
    """Emitted luminance per channel in cd/m², >= 0; default 0."""
    transmission: float
    """Share of light that passes through instead of being reflected diffusely, in [0, 1]; default 0."""
    ior: float
    """Index of refraction in [1, 4]; default 1.5."""
    alpha: float
    """In [0, 1], multiplies the alpha of the base colour's texture; default 1."""
    alpha_mode: AlphaMode | str | int
    """AlphaMode; default AlphaMode.OPAQUE."""
    alpha_cutoff: float
    """For AlphaMode.MASK, >= 0; default 0.5."""
    normal_scale: float
    """How far the normal texture bends: multiplies its x and y; finite; default 1."""


@dataclass(frozen=True)
class TextureUse:
    """A texture as a material uses it."""

    texture: int
    """Index of the texture; LUXFER_NONE if there is none, and what follows is 0."""
    uv_set: int
    """Which of the mesh's sets of texture coordinates it is looked up with, 0 or 1."""
    wrap_u: Wrap
    """Wrap, along u."""
    wrap_v: Wrap
    """Wrap, along v."""
    transform: tuple[float, ...]
    """Two rows of three, applied to (u, v, 1) before the look-up."""


class MeshParams(TypedDict, total=False):
    """A triangle mesh in world space."""

    material: int
    """Index of its material, as luxfer_scene_add_material has returned it; default 0."""
    name: str
    """Name in UTF-8, copied; surfaces are found by it. None, the default, is none."""
    vertex_count: int
    """Number of vertices in [3, 2^32 - 1]; to be set."""
    positions: int
    """Three floats for each vertex, in metres, in [-1e15, 1e15]; to be set."""
    position_stride: int
    """Bytes from a position to the next; at least 12, or 0, the default: packed."""
    normals: int
    """Three floats for each vertex, finite; None, the default: faces are flat."""
    normal_stride: int
    """Bytes from a normal to the next; at least 12, or 0, the default: packed."""
    uvs: int
    """Two floats for each vertex, finite, (0, 0) the top-left corner of a texture; None, the default: none."""
    uv_stride: int
    """Bytes from a pair of texture coordinates to the next; at least 8, or 0, the default: packed."""
    triangle_count: int
    """Number of triangles, at least 1; to be set."""
    indices: int
    """Three uint32_t for each triangle, each below vertex_count, counter-clockwise seen from the front; to be
    set."""
    index_stride: int
    """Bytes from a triangle to the next; at least 12, or 0, the default: packed."""


class CameraParams(TypedDict, total=False):
    """A pinhole camera."""

    fov_y: float
    """Full vertical angle of view in radians, in [0.001, 3.1]; default 1."""
    position: Sequence[float]
    """Where it stands, in metres, in [-1e15, 1e15]; default (0, 0, 0)."""
    target: Sequence[float]
    """What it looks at, another point, in [-1e15, 1e15]; default (0, 0, -1)."""
    up: Sequence[float]
    """Direction that is up in the image, not along the view; default (0, 1, 0)."""


@dataclass(frozen=True)
class DistributionReport:
    """A distribution on the whole."""

    planes: int
    """C planes."""
    angles: int
    """Vertical angles of each plane."""
    flux: float
    """Luminous flux in lumens: the intensity over all directions."""
    lamp_flux: float
    """Rated flux of its lamps in lumens; 0 if the file states none (absolute photometry)."""
    watts: float
    """Electric power in watts; 0 if not known."""
    size: tuple[float, float, float]
    """Length, width and height of the luminous opening in metres; negative for round ones."""


class LightParams(TypedDict, total=False):
    """A light without a surface."""

    kind: LightKind | str | int
    """LightKind; default LightKind.POINT."""
    position: Sequence[float]
    """Where a point or a spot stands, in metres, in [-1e15, 1e15]; default (0, 0, 0)."""
    direction: Sequence[float]
    """Where a spot or a directional light shines; any length but 0; default (0, -1, 0)."""
    intensity: Sequence[float]
    """Luminous intensity per channel in cd, on the axis of a spot; of a directional light the illuminance in
    lux on a surface that faces it. Each >= 0; default (1, 1, 1)."""
    inner_angle: float
    """Half the angle of a spot's cone of full intensity, in radians, in [0, outer_angle]; default 0."""
    outer_angle: float
    """Half the angle of a spot's whole cone, in radians, in (0, pi / 2]; default pi / 4."""


class LuminaireParams(TypedDict, total=False):
    """How a luminaire hangs."""

    flux: float
    """Luminous flux in lumens, finite and >= 0; default 0: that of the distribution."""
    position: Sequence[float]
    """Where it hangs, in metres, in [-1e15, 1e15]; default (0, 0, 0)."""
    axis: Sequence[float]
    """The direction of its axis, where gamma is 0; any length but 0; default (0, -1, 0): it shines down."""
    c0: Sequence[float]
    """About where C is 0: what of it is at right angles to the axis counts, which must not be 0; default (1, 0,
    0). C grows anticlockwise as seen from above a luminaire that shines down."""
    colour: Sequence[float]
    """Linear colour of its light, each >= 0 and not all 0; its brightness does not count; default (1, 1, 1)."""


@dataclass(frozen=True)
class Ray:
    """A half-line. An element of arrays, so it will never change."""

    origin: tuple[float, float, float]
    """Where it starts, in metres."""
    direction: tuple[float, float, float]
    """Where it goes; need not be of unit length, but not 0."""
    t_max: float
    """Hits lie at distances in (0, t_max), in units of direction; may be infinite."""


@dataclass(frozen=True)
class Hit:
    """Where a ray meets a scene. An element of arrays, so it will never change."""

    t: float
    """Distance in units of the ray's direction; infinite for a miss."""
    mesh: int
    """Index of the mesh; LUXFER_NONE for a miss."""
    triangle: int
    """Index of the triangle in its mesh; LUXFER_NONE for a miss."""
    u: float
    """Barycentric coordinate of the triangle's second corner."""
    v: float
    """Barycentric coordinate of the triangle's third corner."""


@dataclass(frozen=True)
class Requirements:
    """What a scene requires of the renderer."""

    scattering: Scattering
    """Ways of scattering that can occur: Scattering."""
    lights: Lights
    """Lights that can shine: Lights."""
    textures: int
    """Textures that vary what surfaces scatter, emit, or how they are bent."""
    bounces: int
    """How many times light can scatter and still matter: light that was scattered more often is at most the
    share error, given in the call, of all light that surfaces scatter. 0 if albedos set no bound. Rendering
    ends paths there only if RenderParams.bounce_error asks for it."""
    brightest_material: int
    """Index of the material that sends on most of the light it receives; LUXFER_NONE if there are no
    surfaces."""
    albedo: tuple[float, float, float]
    """The most that any surface sends on, per channel, in [0, 1]."""
    flat_triangles: int
    """Triangles without an area, which are left out."""


@dataclass(frozen=True)
class MeshInfo:
    """A mesh of a scene."""

    material: int
    """Index of its material."""
    vertex_count: int
    """Number of vertices."""
    triangle_count: int
    """Number of triangles."""
    has_normals: int
    """1 if it has a normal for each vertex, 0 if its faces are flat."""
    uv_sets: int
    """Sum of 1 if it has the first set of texture coordinates and 2 if it has the second."""


class RectifyParams(TypedDict, total=False):
    """Settings of a rectification."""

    detector: Lines | str | int
    """Lines; default Lines.REGIONS."""
    search: Search | str | int
    """Search; default Search.MANHATTAN."""
    metric: Metric | str | int
    """Metric; default Metric.SEGMENT."""
    hough_band: float
    """Half-width in radians of the band around the gradient's direction that votes for a line, in [1e-4, pi/2];
    default 0.0436, which is 2.5 degrees."""
    focal: float
    """Focal length in pixels, > 0, or 0, the default: unknown."""
    principal: Sequence[float]
    """Principal point in pixels; NaN, the default: the image's centre."""
    plane_axes: Sequence[int]
    """The two room axes that the plane spans, each 0, 1 or 2; -1, the default: found from the lines in it."""
    max_side: int
    """Longest side of the unwarped image in pixels, in [16, 16384]; default 2048. The photo's own density
    decides below."""
    max_magnification: float
    """Largest magnification of the photo, > 0; default 16. What is further away is cut off."""
    seed: int
    """Seed of the search; default 1."""


@dataclass(frozen=True)
class RectifyReport:
    """What the lines of a photo say about its camera, and how the plane was unwarped."""

    segments: int
    """Number of line segments found."""
    vanishing_points: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    """Vanishing points of the room axes, homogeneous pixels of unit length; the third coordinate is 0 at
    infinity."""
    vanishing_errors: tuple[float, float, float]
    """Standard deviation of their directions in camera space, in radians."""
    vanishing_support: tuple[int, int, int]
    """Number of segments that agree with each; 0 = derived from the other two."""
    focal_source: FocalSource
    """FocalSource."""
    focal: float
    """Focal length in pixels."""
    principal: tuple[float, float]
    """Principal point in pixels."""
    axes: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    """Room axes as unit vectors in camera space."""
    is_unwarped: int
    """1 if the plane has been unwarped, else 0, and what follows is 0."""
    to_photo: tuple[float, ...]
    """The map from unwarped pixels to photo pixels, row by row."""
    corners: tuple[tuple[float, float], tuple[float, float], tuple[float, float], tuple[float, float]]
    """Corners of the unwarped rectangle in the photo, x and y."""
    corner_errors: tuple[float, float, float, float]
    """Expected error of each corner, in unwarped pixels."""
    pixel_size: float
    """Size of an unwarped pixel as a share of the camera's distance from the plane."""
    aspect_confidence: float
    """Trust in the aspect ratio, in [0, 1]: low where the focal length had to be assumed."""
    distortion: float
    """How far outwards the lens moves what it shows in the corners of the photo, as a share of their distance
    from its centre: below 0 for a barrel, as of wide angles. It is measured by how far straight lines are bent,
    and not undone. NaN where the photo has too few lines to tell."""
    distortion_error: float
    """Its standard deviation; NaN where it is."""
    squareness: tuple[float, float, float]
    """For each axis how far the angle between the two others is from a right one, in radians, by the lines of
    these two alone: walls that meet at other angles, pixels that are not square and a principal point elsewhere
    show here. The axes are made orthogonal all the same. NaN where an axis has no lines."""
    squareness_errors: tuple[float, float, float]
    """Standard deviation of each; NaN where it is."""


class FeaturesParams(TypedDict, total=False):
    """Settings of the features."""

    near_plane: float
    """Near plane of the paper's Eq. 1, in its own units, in [1e-3, 1e3]; default 1."""
    far_plane: float
    """Far plane of Eq. 1, in [1.001, 1e6] times near_plane; default 10."""
    normal_radius: int
    """Half-width of the window the normals are fitted in, in pixels, in [0, 64]; default 0: from the photo's
    size."""


@dataclass(frozen=True)
class FeaturesReport:
    """How good the features are."""

    depth_source: DepthSource
    """DepthSource."""
    depth_confidence: float
    """Mean trust in the depth, in [0, 1]."""
    replaced_pixels: int
    """Pixels of the photo that were NaN, infinite or negative and have been replaced from their neighbours."""


class SegmentParams(TypedDict, total=False):
    """Settings of a segmentation."""

    samples_per_class: int
    """Samples drawn from the strokes of each class, in [1, 1000000]; default 1000."""
    channels: int
    """Which channels of the features to use, bit i for channel i. 0, the default: of the ten of luxfer_features
    colour, colour and position, colour and normal, or all, whichever does best on strokes held out; of any
    other number all. For lights 7, colour only, is best: they share the plane's geometry."""
    refine_radius: int
    """Half-width in pixels, in [0, 1024], of the windows of an edge-aware refinement, which makes the mask
    follow the edges of the photo: the guided filter, with the first three channels of the features as its
    guide. 0, the default: none."""
    ridge: float
    """Strength of the prior that keeps weights small, in [1e-9, 1e3]; default 1e-3."""
    seed: int
    """Seed of the samples; default 1."""
    refine_tolerance: float
    """Differences of those channels, in their own units (for colour those of CIELAB), below which neighbours
    are taken for one surface by the refinement, in [1e-3, 1e6]; default 8."""


@dataclass(frozen=True)
class SegmentReport:
    """How good a segmentation is."""

    channels: int
    """The channels of the features that were used, bit i for channel i."""
    error: float
    """Expected share of wrong pixels, in [0, 1], from strokes held out of the training."""
    negative_samples: int
    """Samples used of the negative class."""
    positive_samples: int
    """Samples used of the positive class."""
    contradictory_pixels: int
    """Pixels that strokes of both classes cover; the later stroke counts."""


class EmissionParams(TypedDict, total=False):
    """Settings of the emission."""

    width: int
    """Width of the texture in texels, in [1, 65536]; default 1024."""
    height: int
    """Height of the texture in texels, in [1, 65536]; default 1024."""
    block: int
    """Side of a patch in working pixels; 0, the default, chooses it from the spacing of the lights."""
    scale: float
    """Unwarped pixels per texel, in [1e-3, 1e3]; default 1."""
    working_side: int
    """Longest side of the exemplar during synthesis, in pixels, in [16, 2048]; default 256."""
    metadata_weight: float
    """Weight of the metadata channels against colour, in [0, 1e3]; default 1; 0 is plain quilting."""
    seed: int
    """Seed of the synthesis; default 1."""
    least_regularity: float
    """Correlation of the lights with themselves from which they are taken for regular, in [0, 1]; default 0.6.
    At 0 any repetition is held to exactly, at 1 none is, and patches go anywhere."""
    whole_lamps: int
    """1, the default, shows every lamp as one piece; with 0 seams may cut lamps."""
    offset: Sequence[float]
    """Where the pattern begins, in texels right of and below the texture's corner, each in [-1e6, 1e6]; default
    0. Lights without a lattice begin nowhere: of these it shifts lamps of a texture that is tileable, and must
    be 0 in others."""
    clip_level: float
    """Channel value from which the photo is clipped, in [0, 1]; default 0.95. Lamps it shows so get the colour
    of their rims, as dark as the clipped channels allow. With 0 nothing is taken for clipped."""
    even_lamps: int
    """With 1 every lamp shines evenly, in its mean colour; default 0: as in the photo."""
    tileable: int
    """With 1 the texture may be repeated: what leaves it on one side comes in on the other, and a lattice is
    stretched, by less than half a period over the whole, to fit. Needs whole_lamps. Default 0."""
    centred: int
    """With 1 a lattice lies evenly between the sides of the texture, shifted by offset from there: a lamp or
    the middle between two in its middle, so that the border cuts as few lamps as it can. Default 0."""
    candidates: int
    """Patches that are compared for each block, at most, where none is held to a lattice, in [1, 65536];
    default 192."""
    law: EmissionLaw | str | int
    """How the lights go on: EmissionLaw other than EmissionLaw.COPY; default EmissionLaw.BEST."""
    clean_lamps: int
    """With 1, the default, lamps of a kind have one size and an outline that is exact at any resolution, and
    lie at the sites of their lattice. Needs the photo and whole_lamps. With 0 each lamp is shown with the
    outline of the mask."""
    max_magnification: float
    """Magnification of the photo up to which the exemplar is used, against its sharpest pixel and in length, in
    [1, 1e6]: what is magnified more counts as not shown. Default 0: all of it is used."""


@dataclass(frozen=True)
class EmissionReport:
    """How good the texture is."""

    luminaires: int
    """Number of luminaires; see luxfer_emission_get_luminaire."""
    error: float
    """The largest relative difference between texture and exemplar in the share that is lit, the area of whole
    lamps, and the distance from each to the nearest other. It weighs as much as exemplar_lamps. NaN of a plan,
    which is no texture yet."""
    regularity: float
    """How regular the lights are, in [0, 1]: correlation with themselves shifted by the lattice that was found,
    0 without."""
    exemplar_lamps: int
    """Number of lamps that the exemplars show whole. Fewer than six tell little about a design: what the border
    cuts off is a large part of what there is, and without a whole lamp the texture shows the cut ones."""
    sampling_error: float
    """By how much the exemplar's own statistics are off, as far as can be told: the root mean square of the
    same difference between parts of the texture as large as the exemplar, and the whole. An error of up to
    twice this says nothing against the texture. 0 where the texture shows nothing else than the exemplar does,
    of blended exemplars, and of a plan."""
    law: EmissionLaw
    """How the lights go on, and the law that would have been next best: EmissionLaw."""
    runner_up: EmissionLaw
    law_score: float
    """How well the law predicts the lamps of the photo from each other, in [0, 1], each weighed by its photo
    pixels; NaN where too few of the lights are whole lamps to tell."""
    margin: float
    """By how much that exceeds the score of the runner-up; below 0 where the law was kept though another scores
    slightly better."""


@dataclass(frozen=True)
class Luminaire:
    """One lamp of the texture."""

    corners: int
    """Number of corners of its outline."""
    centre: tuple[float, float]
    """Centre in texels, x and y."""
    size: tuple[float, float]
    """Lengths of the principal axes in texels, the long one first."""
    orientation: float
    """Angle of the long axis from x towards y, in radians, in (-pi/2, pi/2]."""
    area: float
    """Area in texels, of those at the edge what is light."""
    flux_share: float
    """Share of the light of the whole texture, in [0, 1]."""
    colour: tuple[float, float, float]
    """Mean linear colour, relative to the photo's white."""
    kind: int
    """Number of its kind, from 1, those with most lamps first: lamps of about the same size and shape. 0 if the
    border cuts it."""


class RenderParams(TypedDict, total=False):
    """Settings of a rendering."""

    width: int
    """Width of the image in pixels, in [1, 65536]; default 1280."""
    height: int
    """Height of the image in pixels, in [1, 65536]; default 720."""
    samples: int
    """Paths per pixel, in [1, 1048576]; default 64. With a target this is the most on the average over the
    image."""
    target_error: float
    """Stop when the error of the report falls to this, >= 0, and give paths to where they lower it most;
    default 0: never."""
    time_budget_ms: int
    """Stop after this many milliseconds; default 0: never."""
    seed: int
    """Seed of the paths; default 1."""
    pixel_error: float
    """Stop when every part of the image (8 x 8 pixels, root mean square) is known to this, >= 0: half the width
    of the 95 % interval of a pixel's luminance, relative to that luminance or to a tenth of the image's mean,
    whichever is more. 0.1 means within 10 % of its value, 19 times out of 20. A part gets at most 64 times
    samples, though it may miss the target. Default 0: never."""
    bounce_error: float
    """End every path where what is left is at most this share of all light that surfaces scatter, in [0, 1):
    the image is too dark by up to that share. After how many bounces, luxfer_scene_requirements tells. Default
    0: never; paths end by chance alone, and the image is right on the average."""
    preview: float
    """Strength of the filter for RenderImage.PREVIEW, in [0, 10]; 1 is usual, more blurs more. Default 0: no
    preview, as final images are made. The other images are the same with and without it."""
    relative_error: float
    """Stop when the relative_error of the report falls to this, >= 0, and give paths to where they lower it
    most: as noise is seen, in the shade as in the light. Default 0: never. With several targets all are
    reached."""


@dataclass(frozen=True)
class RenderReport:
    """How good a rendering is."""

    samples: int
    """Paths per pixel so far, on the average."""
    error: float
    """Root mean square over the pixels of the standard error, relative to the image's mean; infinite while a
    pixel has less than two paths."""
    discarded: int
    """Paths that were left out because their radiance was no finite number."""
    preview_bias: float
    """How far the mean of such previews is from the truth: root mean square over squares of 8 x 8 pixels,
    relative to the image's mean, estimated. 0 without a preview."""
    relative_error: float
    """Root mean square over the pixels of the standard error, relative to the pixel itself (the mean of its
    channels, but at least a hundredth of the image's mean); infinite while a pixel has less than two paths. Of
    few paths it states rather too much, of 8 about a quarter."""


class RenderPart(TypedDict, total=False):
    """A part of a rendering."""

    x: int
    """Column of its first pixel; default 0."""
    y: int
    """Row of its first pixel, from the top; default 0."""
    width: int
    """Width in pixels; default 0: as far as the image goes."""
    height: int
    """Height in pixels; default 0: as far as the image goes."""
    first_sample: int
    """Number of its first path in each pixel; default 0."""
    samples: int
    """Paths per pixel; default 0: all that follow, of RenderParams.samples."""


class IlluminanceParams(TypedDict, total=False):
    """Settings of the calculation."""

    columns: int
    """Points along the first edge or texture coordinate, in [1, 65536]; default 32."""
    rows: int
    """Points along the second, in [1, 65536]; default 32."""
    samples: int
    """Paths per point, in [16, 16777216], rounded up to a multiple of 16; default 1024."""
    seed: int
    """Seed of the paths; default 1."""


class IlluminanceGrid(TypedDict, total=False):
    """A calculation grid."""

    origin: Sequence[float]
    """A corner, in metres; default (0, 0, 0)."""
    across: Sequence[float]
    """The edge along which columns count, in metres; default (1, 0, 0). Points are the centres of the cells."""
    down: Sequence[float]
    """The edge along which rows count, in metres; default (0, 0, 1)."""
    normal: Sequence[float]
    """The side from which light counts, of any length but 0; default (0, 1, 0)."""


@dataclass(frozen=True)
class IlluminanceReport:
    """The illuminance on the whole, in lux."""

    points: int
    """Points that there are: of a mesh, the texels with a surface."""
    least: float
    """Smallest illuminance; least / mean is the uniformity U0."""
    mean: float
    """Mean illuminance."""
    largest: float
    """Largest illuminance."""
    mean_error: float
    """Standard error of the mean."""


class RelightParams(TypedDict, total=False):
    """Settings of a relighting."""

    quantity: Quantity | str | int
    """Quantity; default Quantity.OUTGOING."""
    paths: int
    """Most paths to trace, in [1024, 2^30]; default 2^20."""
    target_error: float
    """Stop when the half-width of the widest 95 % interval is below this share of its answer, in [0, 1];
    default 0.01; 0 = never."""
    time_budget_ms: int
    """Stop after this many milliseconds; default 0: never."""
    fit: Fit | str | int
    """Fit; default Fit.MEAN."""
    seed: int
    """Seed of the paths; default 1."""


@dataclass(frozen=True)
class RelightReport:
    """The solution and how sure it is."""

    paths: int
    """Paths traced."""
    scale: tuple[float, float, float]
    """What to multiply the emission with, per channel, >= 0."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of scale."""
    response: tuple[float, float, float]
    """Mean radiance of the target under the emission at scale 1, in cd/m²."""
    background: tuple[float, float, float]
    """Mean radiance of the target under all other light, in cd/m²."""
    reach: tuple[Reach, Reach, Reach]
    """Reach of each channel."""
    error: float
    """The widest relative half-width among the channels that met their target."""
    delta_e: float
    """How far the target's colour may be off: 95 % of errors are below this CIEDE2000 difference, seen at the
    exposure that shows the target as a middle grey."""


class LampsParams(TypedDict, total=False):
    """Settings of the calculation."""

    group: Group | str | int
    """Group; default Group.EACH."""
    row_tolerance: float
    """Centres agree whose neighbours along the coordinate are closer than this, >= 0; default 0.01."""
    free_colour: int
    """1: each channel of a group is solved for itself, for goals of colour only; 0: its power alone; default
    0."""
    most: float
    """Largest multiplier of a group, >= 0; default infinity."""
    evenness: float
    """How much lamps that differ weigh against missing the goals, in [1e-9, 1e3]; default 1e-6."""
    tolerance: float
    """A goal is met when it is missed by no more than this share of itself, in [1e-6, 1], or its noise; default
    0.01."""
    paths: int
    """Most paths to trace for a goal, in [1024, 2^30]; default 2^20."""
    target_error: float
    """Stop when a goal's response to all lamps together is known to this share, in [0, 1]; default 0.01; 0 =
    never."""
    time_budget_ms: int
    """Stop after this many milliseconds; default 0: never."""
    seed: int
    """Seed of the paths; default 1."""


@dataclass(frozen=True)
class LampsReport:
    """The result on the whole."""

    lamps: int
    """Number of lamps."""
    groups: int
    """Number of groups."""
    goals: int
    """Number of goals."""
    paths: int
    """Paths traced for each goal."""
    met: int
    """1 if all goals are met; 0 if not: luxfer_lamps_get_reason tells why."""


@dataclass(frozen=True)
class Lamp:
    """One lamp."""

    group: int
    """The group it is in."""
    centre: tuple[float, float, float]
    """Its centre: texture coordinates and 0, or metres."""
    scale: tuple[float, float, float]
    """What to multiply its emission with, per channel, >= 0."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of scale."""


@dataclass(frozen=True)
class LampsGoal:
    """What a goal gets."""

    reach: tuple[Reach, Reach, Reach]
    """Reach of each channel."""
    target: tuple[float, float, float]
    """Mean radiance asked for, in cd/m²; illuminance / pi for a grid."""
    achieved: tuple[float, float, float]
    """Mean radiance under the powers found."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of achieved."""
    background: tuple[float, float, float]
    """Mean radiance under all other light."""


@dataclass(frozen=True)
class LampsResponse:
    """What one lamp means to one goal."""

    mean: tuple[float, float, float]
    """Mean radiance of the goal under the lamp as it is, in cd/m² per channel."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of mean."""


class ImportanceParams(TypedDict, total=False):
    """Settings of the map."""

    width: int
    """Cells along u of the surface, in [1, 512]; default 64."""
    height: int
    """Cells along v, in [1, 512]; default 64."""
    quantity: Quantity | str | int
    """Quantity; default Quantity.OUTGOING."""
    paths: int
    """Most paths to trace, in [1024, 2^30]; default 2^20."""
    target_error: float
    """Stop when the response to an even emission is known to this share, in [0, 1]; default 0.01; 0 = never."""
    time_budget_ms: int
    """Stop after this many milliseconds; default 0: never."""
    seed: int
    """Seed of the paths; default 1."""


@dataclass(frozen=True)
class ImportanceReport:
    """What a texture means to the target."""

    paths: int
    """Paths behind the map."""
    response: tuple[float, float, float]
    """Mean radiance of the target under the texture, in cd/m² per channel as the texture's values are."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of response."""
    band_error: tuple[float, float, float]
    """What cells of twice the side change, noise included; the cells themselves are off by about a third of
    it."""


class PlacementParams(TypedDict, total=False):
    """What may be, and what is best. A texture is scaled and then turned about the centre of the surface's
    texture coordinates, and shifted."""

    aim: Aim | str | int
    """Aim; default Aim.MOST."""
    radiance: Sequence[float]
    """The radiance to aim at, in cd/m² per channel, each finite and >= 0; default 0."""
    starts: int
    """Places the search starts from, in [1, 4096]; default 64."""
    least_offset: Sequence[float]
    """Smallest offset along u and v of the texture, which has period 1, in [-16, 16]; default -0.5."""
    most_offset: Sequence[float]
    """Largest; default 0.5. Where smallest and largest are the same, here and below, nothing changes."""
    least_scale: Sequence[float]
    """How often the texture repeats along the surface's u and v, at least, in [1/64, 64]; default 1."""
    most_scale: Sequence[float]
    """At most; default 1."""
    least_rotation: float
    """Smallest rotation in radians, in [-2 pi, 2 pi]; default 0."""
    most_rotation: float
    """Largest; default 0."""
    seed: int
    """Seed of the places; default 1."""


@dataclass(frozen=True)
class Placement:
    """The best placement, and what it means to the target."""

    placement: tuple[float, ...]
    """From the surface's texture coordinates to those of the texture, as luxfer_importance_respond takes it."""
    offset: tuple[float, float]
    """Its offset along u and v."""
    scale: tuple[float, float]
    """Its scale along u and v."""
    rotation: float
    """Its rotation in radians."""
    response: tuple[float, float, float]
    """Mean radiance of the target under the texture alone, in cd/m² per channel."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of response."""
    band_error: tuple[float, float, float]
    """What cells of twice the side change, noise included; the cells themselves are off by about a third of
    it."""


@dataclass(frozen=True)
class GlareReport:
    """The glare of a view."""

    sources: int
    """Sources of glare."""
    ugr: float
    """Unified glare rating (CIE 117): below 10 means none, 19 is what offices may have; -infinity without
    sources."""
    background: float
    """Luminance of the background in cd/m²."""
    threshold: float
    """Luminance from which on a pixel counted as glare, in cd/m²."""
    solid_angle: float
    """Solid angle of all sources in steradian."""


class FalseColourParams(TypedDict, total=False):
    """Settings of a false colour image."""

    scale: Scale | str | int
    """Scale; default Scale.LINEAR."""
    unit: Unit | str | int
    """Unit, written above the bar; default Unit.LUMINANCE."""
    bar: int
    """1: draw the scale bar beside the image, which then is wider; 0: none; default 1."""
    least: float
    """Value of the darkest colour, >= 0; on a logarithmic scale 0 stands for a thousandth of the largest;
    default 0."""
    most: float
    """Value of the lightest colour, more than least; 0 stands for the largest value of the image; default 0."""


@dataclass(frozen=True)
class Mixture:
    """A light mixed from primaries."""

    reached: int
    """1 if it is the colour asked for; 0 if that is out of reach, and this the nearest."""
    colour: tuple[float, float, float]
    """The linear colour it is."""
    delta_e: float
    """CIEDE2000 difference from the colour asked for, seen at the exposure that shows that as a middle grey."""


@dataclass(frozen=True)
class TemperatureFit:
    """The blackbody light that suits a target."""

    kelvin: float
    """Correlated colour temperature, in [1000, 20000] kelvin."""
    luminance: float
    """Luminance of the emission, >= 0, where responses are those to 1 cd/m² of white."""
    achieved: tuple[float, float, float]
    """Mean radiance of the target under it and all other light, in cd/m²."""
    delta_e: float
    """CIEDE2000 difference of that from the target, seen at the exposure that shows the target as a middle
    grey."""


@dataclass(frozen=True)
class Preset:
    """What EN 12464-1 asks of a place, as makers of luminaires quote it. The standard itself is what counts."""

    edition: int
    """Year of the edition of the standard."""
    illuminance: float
    """Least mean illuminance of the task area, in lux."""
    glare: float
    """Largest unified glare rating."""
    uniformity: float
    """Least uniformity U0 of the task area."""
    rendering: float
    """Least colour rendering index."""
    walls: float
    """Least mean illuminance of the walls, in lux; 0 where none is asked for."""
    ceiling: float
    """Least mean illuminance of the ceiling, in lux; 0 where none is asked for."""


class PatternParams(TypedDict, total=False):
    """How the pattern lies on the surface, whose axes u and v and corner are those of Surface."""

    scale: PatternScale | str | int
    """PatternScale; default PatternScale.DISTANCE."""
    length: float
    """What the lamp or the spacing measures, in metres, in [1e-6, 1e6]; default 1. The other scales do not read
    it."""
    texel_size: float
    """Metres per texel, in [0, 1e6]; 0, the default, is as fine as the unwarped photo, where max_texels of
    TransferParams allows it."""
    rotation: float
    """Turn of the pattern from u towards v in radians, in [-2 pi, 2 pi]; default 0."""
    offset: Sequence[float]
    """Shift of the pattern along its own axes in metres, each in [-1e6, 1e6]; default 0. Lamps without a
    lattice go anywhere, and are not shifted."""
    margin: float
    """Distance in metres that lamps keep from the edge of the surface and from the zones of
    luxfer_transfer_set_zones, in [-1, 1e6]; those that do not are left out. Below 0 the edge of the surface
    cuts lamps; default -1."""


class TransferParams(TypedDict, total=False):
    """Settings of a transfer. The structs pointed to are read during the call."""

    max_texels: int
    """Longest side of the emissive texture in texels, in [1, 16384]; default 2048."""
    plane_distance: float
    """Distance of the photo's camera from the lit plane in metres, in [0.01, 1e4]; default 1.2. It sets the
    scale of the pattern."""
    white_luminance: float
    """Luminance that the photo's white stands for, in cd/m², in [1e-6, 1e9]; default 100."""
    target: Target | str | int
    """Target; default Target.SURFACE."""
    rectify: RectifyParams
    """Settings of the stages VIEW and UNWARP; None, the default, for their defaults."""
    features: FeaturesParams
    """Settings of the stage FEATURES; None, the default, for their defaults."""
    plane: SegmentParams
    """Settings of the stage PLANE; None, the default, for their defaults."""
    lights: SegmentParams
    """Settings of the stage LIGHTS; None, the default, for those of luxfer_segment with channels = 7, colour
    only."""
    emission: EmissionParams
    """Settings of the stage EMISSION, whose width, height, scale and offset the transfer sets; None, the
    default, for their defaults."""
    relight: RelightParams
    """Settings of the stage RELIGHT; None, the default, for their defaults."""
    render: RenderParams
    """Settings of the stage RENDER; None, the default, for their defaults."""
    pattern: PatternParams
    """How the lights lie on the surface; None, the default, for the defaults."""


@dataclass(frozen=True)
class TransferReport:
    """What each stage took and how good its result is. Errors of stages without a result are NaN."""

    fixtures: int
    """Number of fixtures; see luxfer_transfer_get_fixture. 0 before the stage RELIGHT has ended."""
    seconds: tuple[float, ...]
    """Seconds each stage took when it last ran, by Stage."""
    view_error: float
    """Largest standard deviation of a vanishing point's direction, in radians."""
    depth_confidence: float
    """Mean trust in the depth of the features, in [0, 1]."""
    plane_error: float
    """Expected share of wrong pixels in the mask of the plane."""
    lights_error: float
    """Expected share of wrong pixels in the mask of the lights."""
    unwarp_error: float
    """Largest expected error of a corner of the unwarped image, in unwarped pixels."""
    emission_error: float
    """Relative difference between texture and photo in the share of lit area."""
    relight_error: float
    """Widest relative half-width of the solution's 95 % intervals."""
    render_error: float
    """As the error of RenderReport: root mean square of the picture's standard errors, relative to its mean."""
    texel_size: float
    """Size of a texel of the emission in metres."""
    target: tuple[float, float, float]
    """Mean colour the surface is to have, relative to the photo's white."""


@dataclass(frozen=True)
class Fixture:
    """One lamp of the lit scene."""

    position: tuple[float, float, float]
    """Centre in metres."""
    normal: tuple[float, float, float]
    """Unit direction the lamp shines in."""
    axis: tuple[float, float, float]
    """Unit direction of its long axis."""
    radiance: tuple[float, float, float]
    """Mean luminance per channel in cd/m²."""
    kind: int
    """Number of its kind, as of Luminaire."""
    size: tuple[float, float]
    """Lengths along and across the axis in metres."""
    area: float
    """Area in m²."""
    flux: float
    """Luminous flux in lumens."""
    cct: float
    """Correlated colour temperature in kelvin; 0 for a lamp that is off."""
    duv: float
    """Distance from the blackbody in the CIE 1960 diagram."""


class PlanParams(TypedDict, total=False):
    """What a plan is made for: one of its fields must be set."""

    time_budget_ms: int
    """Milliseconds for all that is planned; default 0: the error counts."""
    target_error: float
    """Error of the picture, root mean square over its pixels relative to its mean, in [1e-5, 1]; default 0: the
    time counts."""


@dataclass(frozen=True)
class PlanReport:
    """What a plan expects."""

    relights: int
    """1 if the plan relights, as that of a transfer; 0 if it is of a rendering or a stylisation."""
    seconds: float
    """Seconds for all that is planned."""
    error: float
    """Error of the picture."""
    relight_seconds: float
    """Seconds for relighting, which makes the scene ready first; 0 in other plans than that of a transfer."""
    relight_error: float
    """The error that RelightReport should state, half the width of its interval; 0 in other plans."""
    render_seconds: float
    """Seconds for rendering; in a plan of a transfer it makes the scene ready first; 0 in a plan of a
    stylisation."""
    render_error: float
    """The error that RenderReport should state; 0 in a plan of a stylisation."""


class GuidesParams(TypedDict, total=False):
    """Settings of guides."""

    width: int
    """Width of the images in pixels, in [1, 32768]; default 800."""
    height: int
    """Height of the images in pixels, in [1, 32768]; default 608."""
    samples: int
    """Paths per pixel, in [1, 1048576]; default 64."""
    camera: int
    """Index of the scene's camera; default 0."""
    smooth: int
    """1: smooth the light along surfaces, so that noise is not matched; default 1."""
    seed: int
    """Seed of the paths; default 1."""


class StylizeParams(TypedDict, total=False):
    """Settings of a stylisation. Fill them with luxfer_stylize_params_init or luxfer_stylize_params_preset; the
    defaults given here are those of StylizePreset.FULL."""

    mode: StylizeMode | str | int
    """StylizeMode; default StylizeMode.BUDGET."""
    search: StylizeSearch | str | int
    """StylizeSearch; default StylizeSearch.PATCHMATCH."""
    patch: int
    """Width of a patch in pixels, odd, in [1, 33]; default 5."""
    guide_weight: float
    """Weight of all guides together against the artwork's colours together, in [0, 1e6]; default 2."""
    levels: int
    """Most resolution levels, each half of the next, in [1, 16]; default 6."""
    iterations: int
    """Rounds of matching and painting on the level before the finest, in [1, 100]; default 6."""
    finest_iterations: int
    """Rounds on the finest level, in [1, 100]; default 1."""
    polish: int
    """Rounds after those, without the budget, in which each place takes its nearest match, in [0, 100]; default
    3; 0 is the paper's. Modes without a budget do as many more of their own."""
    sweeps: int
    """Sweeps of a search, in [1, 100]; default 1."""
    coverage: float
    """Share of the target that is matched under the budget before the rest is matched without, in [0, 1];
    default 0.9."""
    passes: int
    """Most passes of matching under the budget in a round, in [1, 1000]; default 6."""
    settle: int
    """Sweeps in which places may continue their neighbours' matches, for fewer seams, in [0, 100]; default 2; 0
    is the paper's."""
    seam: float
    """What a seam between neighbours costs in those sweeps, as a share of the mean error, in [0, 100]; default
    0.2."""
    vote: StylizeVote | str | int
    """StylizeVote; default StylizeVote.WEIGHTED."""
    final_vote: StylizeVote | str | int
    """StylizeVote for the final picture; default StylizeVote.MOST."""
    preview: int
    """1: work at half resolution with compressed guides, so the picture is half as wide and high; default 0."""
    keep_for_update: int
    """1: keep what luxfer_stylize_update needs, about as much memory as all guides take; default 0."""
    coherence: float
    """Share of the paint of the frame before that is kept where it fits, in [0, 1]; default 1. Below 1 it
    boils, as hand-painted frames do, if each frame has its own seed. Without luxfer_stylize_set_motion it has
    no effect."""
    match_appearance: float
    """How far the exemplar's light is changed to the brightness and contrast of the target's, in [0, 1];
    default 0."""
    seed: int
    """Seed of the search; default 1."""
    coarse_guides: float
    """How many times as much the guides weigh on all levels but the finest, in [0, 1000]; default 4; 1 is the
    paper's. More follows the guides more closely, in smaller pieces."""
    coarse_iterations: int
    """Rounds on each level coarser than the one before the finest, in [1, 100]; default 24; 6 is the
    paper's."""
    occurrence: float
    """Weight of usage in StylizeMode.OCCURRENCE, lambda, in [0, 10]; default 0.1, which Fiser et al. found best
    by hand (Fig. 10n). What a match to a patch that is used as often as all on average costs beside its
    distance, both in the unit of Eq. 1: squared differences of channels in [0, 1], summed over a patch. 0 is
    StylizeMode.NEAREST."""


@dataclass(frozen=True)
class StylizeReport:
    """How good a stylisation is."""

    finished: int
    """1 if the run ended, 0 if only `levels` levels are done: then the fields from `used` on are 0."""
    levels: int
    """Number of levels done; see luxfer_stylize_get_level."""
    halvings: int
    """How often the sides of the picture are half those of the target."""
    patch: int
    """Width of patches that was used."""
    most_used: int
    """Most uses of one exemplar patch."""
    energy: float
    """Mean squared difference of the channels in [0, 1] of matched patches (Eq. 3), last round; the artwork's
    channels count 1 together, the guides guide_weight."""
    used: float
    """Share of the exemplar's patches that were used."""
    entropy: float
    """Entropy of their usage in bits."""
    guide_error: float
    """Root mean square of StylizeImage.GUIDE_ERROR."""
    broken_source: int
    """Exemplar pixels left out because they are no numbers."""
    broken_target: int
    """Pixels of the target's guides taken as 0 for it."""


@dataclass(frozen=True)
class StylizeRound:
    """One round of matching and painting."""

    passes: int
    """Passes of matching under the budget; see luxfer_stylize_get_pass."""
    energy: float
    """As StylizeReport.energy, after this round."""


@dataclass(frozen=True)
class StylizePass:
    """One pass of matching under the budget."""

    knee: float
    """Share of the exemplar's patches that fitted well enough, in [0, 1]."""
    coverage: float
    """Share of the target with a match after this pass, in [0, 1]."""
    gained: int
    """Target patches that were given a match in this pass."""


class SheetParams(TypedDict, total=False):
    """Settings of a print sheet."""

    even_light: int
    """1: even out the light of the photo by the white of the marks, so that paper is 1; default 1."""
    paper_width: float
    """Width of the paper in millimetres, in [60, 2000]; default 297."""
    paper_height: float
    """Height of the paper in millimetres, in [60, 2000]; default 210."""
    dpi: float
    """Dots per inch of the sheet, in [20, 1200]; default 300."""
    margin: float
    """Distance of the marks from the edge of the paper in millimetres, in [0, 50]; default 8."""
    contrast: float
    """Contrast of the printed picture, in [0, 1]; default 0.25; 1 prints it as it is."""


@dataclass(frozen=True)
class SheetReport:
    """How well a photo was aligned."""

    marks: int
    """Marks found, of 10; 6 are enough."""
    residual: float
    """Root mean square distance between marks and where the map puts them, in pixels of the photo; more than a
    pixel or two means paper that is not flat, or a lens that bends lines."""
    error: float
    """Expected alignment error in pixels of the picture."""
    to_photo: tuple[float, ...]
    """From pixels of the picture to pixels of the photo, 3 x 3, row by row."""


class DemoPhotoParams(TypedDict, total=False):
    """Settings of the photo."""

    width: int
    """Width in pixels, in [16, 8192]; default 600."""
    height: int
    """Height in pixels, in [16, 8192]; default 400. The camera is made for 3:2."""
    samples: int
    """Paths per pixel, in [2, 1048576]; default 12: few enough to leave some noise."""
    seed: int
    """Seed of paths and noise; default 1."""
