# Generated from include/luxfer.h by generate.py: do not edit.
"""Enumerations, settings and reports of the library: what the functions of this package take and return."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import TypedDict


class Status(IntEnum):
    """The result of a call: Status.OK, or the reason for the failure."""

    OK = 0
    """Success."""
    UNKNOWN = 1
    """An error that has no status value of its own."""
    INVALID_ARGUMENT = 2
    """A parameter is None, out of range, of the wrong kind or from another context, or contradicts another
    parameter."""
    INVALID_OPERATION = 3
    """The call is not allowed in the object's present state: a job is still running on it, or an input is
    missing."""
    OUT_OF_MEMORY = 4
    """The memory budget of the context, or the machine, is used up."""
    UNSUPPORTED = 5
    """The file or the request is valid, but uses a feature that this library does not support."""
    CANCELLED = 6
    """The job was cancelled by the caller."""
    IO = 7
    """The operating system could not read or write a file, or the caller's write function returned an error."""
    FORMAT = 8
    """A file is truncated or corrupt, or does not have the format that it claims."""
    NOT_READY = 9
    """A result was requested before its job has succeeded, or a wait timed out."""
    INTERNAL = 10
    """A bug in this library: please report it."""
    DEGENERATE = 11
    """The input is well formed but has no answer: for example a photo without lines, a plane seen edge-on, or
    strokes of one class only."""
    NOT_FOUND = 12
    """No surface, image or entry has the given name or index."""
    UNREACHABLE = 13
    """No solution exists: no emitted light reaches the target, or the other lights alone exceed the wanted
    value."""


class Sample(IntEnum):
    """Storage type of a sample, in the machine's byte order."""

    U8 = 0
    """8-bit unsigned integer that stands for [0, 1]."""
    U16 = 1
    """16-bit unsigned integer that stands for [0, 1]."""
    F16 = 2
    """16-bit floating point (IEEE 754 half)."""
    F32 = 3
    """32-bit floating point."""


class ColourSpace(IntEnum):
    """Encoding of the values."""

    LINEAR = 0
    """Scene-linear Rec.709, or data that is not colour."""
    SRGB = 1
    """Colour with the sRGB curve; alpha, the second of two or the fourth of four channels, is linear."""


class FileColour(IntEnum):
    """How the colours of an image were interpreted."""

    NONE = 0
    """The image was not loaded from a file."""
    ASSUMED = 1
    """The file states no colour space. Integers were decoded as sRGB, and floating-point samples taken as
    linear Rec.709."""
    STATED = 2
    """The file states sRGB (integers) or linear Rec.709 (floating point)."""
    CONVERTED = 3
    """The file states another colour space. The colours were converted to linear Rec.709."""
    UNCONVERTED = 4
    """The library cannot convert the colours of the file, for example because its profile is damaged, or
    because it is in CMYK without a profile. The colours were read as if the file stated no colour space, so
    saturated colours may be wrong. Warn the user, and ask for an export of the photo as sRGB."""
    DATA = 5
    """The image was loaded with ColourSpace.LINEAR. Its samples are unchanged."""


class ExposureSource(IntEnum):
    """Where the exposures of photos come from."""

    BOTH = 0
    """From the metadata and the pixels, weighted by their errors; where one of the two sources is missing, from
    the other source alone. If the two contradict each other by more than a third of a stop,
    luxfer_image_merge_exposures returns Status.INVALID_ARGUMENT."""
    METADATA = 1
    """From the exposure time, ISO speed and f-number in the files."""
    PIXELS = 2
    """From pixels that two neighbouring exposures both show well."""


class ToneCurve(IntEnum):
    """The tone curve with which photos were taken."""

    RECOVERED = 0
    """That of sRGB, unless the exposures are known and the photos agree significantly better with another
    curve, which is then undone. Exposures are known from the field exposures, or from the metadata."""
    SRGB = 1
    """That of sRGB: the photos are linear as they are."""


class DepthKind(IntEnum):
    """Quantity that a depth map measures."""

    ALONG_Z = 0
    """Distance from the camera along the viewing axis (depth z)."""
    ALONG_RAY = 1
    """Distance from the camera along the ray of each pixel."""


class Phase(IntEnum):
    """The mask for which strokes are painted."""

    PLANE = 0
    """The mask of the plane that carries the lights: positive strokes lie on the plane; strokes on lights count
    as positive strokes too."""
    LIGHTS = 1
    """The mask of the lights on the plane: positive strokes lie on lights, negative strokes on the plane beside
    them."""


class LuminaireShape(IntEnum):
    """From where a luminaire shines."""

    FACES = 0
    """A luminaire shines from the faces of its luminous opening, with the size that its file states: a
    rectangle, a disc, a box, a cylinder or an ellipsoid. In each direction, all points of the faces have equal
    luminance: the intensity divided by the projected area of the faces. The light is therefore right at any
    distance, and renderings show the faces. A luminaire whose file states no size, or a size below 1 mm²,
    shines from a point."""
    POINT = 1
    """A luminaire shines from its position as from a point, and is invisible in renderings. The light is right
    only at distances of at least five times its size."""


class AlphaMode(IntEnum):
    """How a surface uses its alpha."""

    OPAQUE = 0
    """The alpha is ignored: the surface is opaque."""
    MASK = 1
    """The surface is opaque where its alpha is at least alpha_cutoff, and absent elsewhere."""
    BLEND = 2
    """The surface stops a share of the light that is equal to its alpha; the rest of the light passes straight
    through."""


class Wrap(IntEnum):
    """How a texture continues beyond its edges."""

    REPEAT = 0
    """The texture repeats."""
    CLAMP = 1
    """Beyond the edge, the texel at the edge is repeated."""
    MIRROR = 2
    """The texture repeats, mirrored every second time."""


class TextureRole(IntEnum):
    """Purpose of a texture in a material."""

    BASE_COLOR = 0
    """Base colour: the texture multiplies the material's base colour, and its alpha multiplies the material's
    alpha."""
    METALLIC_ROUGHNESS = 1
    """Metallic-roughness: the green channel multiplies the roughness, the blue channel multiplies the metallic
    value."""
    NORMAL = 2
    """Normals in tangent space, as in glTF 2.0: a channel value c in [0, 1] stands for 2 c - 1, and green
    points up in the image (OpenGL convention). Load the map as data (ColourSpace.LINEAR), not as sRGB."""
    EMISSION = 3
    """Emission: the texture multiplies the emission; it is looked up without interpolation."""


class DistributionFormat(IntEnum):
    """A file format of distributions."""

    IES = 0
    """IES LM-63 (.ies) with photometry of type C. Files with photometry of type B are converted to type C when
    they are loaded."""
    LDT = 1
    """EULUMDAT (.ldt)."""
    TM33 = 2
    """ANSI/IES TM-33-18 and TM-33-23 (.xml). The distributions of all emitters are added up. Saved files are
    TM-33-23."""
    GLDF = 3
    """GLDF container (.gldf): a product with variants, of which one is read."""
    ANY = 4
    """Any of these formats; the library recognises the format by the content of the file."""


class LightKind(IntEnum):
    """A kind of punctual light."""

    POINT = 0
    """A point light: equal intensity in every direction."""
    SPOT = 1
    """A spot light: it shines into a cone."""
    DIRECTIONAL = 2
    """A directional light: it shines from infinitely far away, with parallel rays or as a disc."""


class VertexAttribute(IntEnum):
    """An attribute of the vertices of a mesh."""

    POSITION = 0
    """Positions in metres, three floats per vertex."""
    NORMAL = 1
    """Normals, three floats per vertex."""
    UV_0 = 2
    """The first set of texture coordinates, two floats per vertex; (0, 0) is the top-left corner of a
    texture."""
    UV_1 = 3
    """The second set of texture coordinates, two floats per vertex."""
    COLOUR = 4
    """Colours: linear red, green, blue and alpha, four floats per vertex."""


class CandidateKind(IntEnum):
    """Whether a candidate is an object or a material."""

    OBJECT = 0
    """An object: all meshes with one name."""
    MATERIAL = 1
    """A material: all triangles that use it."""


class RenderImage(IntEnum):
    """An image of a rendering."""

    BEAUTY = 0
    """Mean radiance of each pixel, linear RGB in cd/m²."""
    VARIANCE = 1
    """Variance of the mean radiance of each pixel; 3 channels, in (cd/m²)². Infinite where a pixel has fewer
    than two paths. Blocks of eight neighbouring pixels share parts of their paths, so the errors of these
    pixels are correlated: the variance of a sum over pixels is up to eight times the sum of their variances."""
    PATHS = 2
    """Number of paths of each pixel; 1 channel."""
    INTERVAL = 3
    """Half the width of the 95 % confidence interval of each pixel's radiance, in cd/m²; 3 channels; infinite
    where a pixel has fewer than two paths."""
    PREVIEW = 4
    """The beauty image after a noise filter that follows the edges of the visible surfaces. The filter averages
    a pixel with neighbours that differ from it by no more than the noise. A pixel keeps its unfiltered value if
    this value is estimated to be more accurate than the filtered value. The filter never changes a pixel by
    more than three standard errors. Details that come from the light alone, such as soft shadows, can be
    blurred; RenderReport.preview_error estimates the remaining error. The image exists only if
    RenderParams.preview is not 0."""
    PREVIEW_INTERVAL = 5
    """Half the width of the 95 % interval of each pixel of the preview, in cd/m²; 3 channels. The interval
    includes the bias of the filter. It is infinite where a pixel has fewer than four paths. Measured in rooms
    with 4 to 256 paths per pixel, the intervals contain the true value of 93 % to 98 % of the pixels; along
    edges of surfaces, they contain it less often. The image exists only if RenderParams.preview is not 0."""


class EmitterAs(IntEnum):
    """Letters that match emissive surfaces and the environment in expressions that start at the camera: a
    EmitterAs. Punctual lights always match L."""

    BOTH = 0
    """Emissive surfaces match L and O, the environment matches L and B, so C<RD>L is all direct light that is
    reflected diffusely. The default."""
    LIGHT = 1
    """Emissive surfaces and the environment match L only."""
    OBJECT = 2
    """As in Open Shading Language: surfaces match O, the environment matches B."""


class Lines(IntEnum):
    """The detector of lines."""

    REGIONS = 0
    """Fits segments with sub-pixel end points to regions of similar gradient direction (LSD, Grompone von Gioi
    et al. 2010)."""
    HOUGH = 1
    """The method of Lighting Style Transfer (section 5.1): a Hough transform of Canny edges, in which an edge
    pixel votes only for lines nearly perpendicular to its gradient."""


class Search(IntEnum):
    """The search for vanishing points."""

    MANHATTAN = 0
    """Finds three orthogonal directions and the focal length together, then refines each direction with the
    lines that run along it."""
    SUCCESSIVE = 1
    """The method of Lighting Style Transfer, RANSAC: finds one vanishing point after the other, each from the
    lines that do not run to an earlier vanishing point."""


class Metric(IntEnum):
    """The distance of a vanishing point from a line, for Search.SUCCESSIVE."""

    SEGMENT = 0
    """The distance of the detected segment's end points from the line through its midpoint and the vanishing
    point; finite for vanishing points at infinity."""
    VISIBLE_LINE = 1
    """The distance by Eq. 2 of Lighting Style Transfer, which may be infinite: the smaller of d and d x / y.
    Here d is the distance of the vanishing point from the line, x is half the length of the part of the line
    that the photo shows, and y is the distance along the line from the middle of this part to the point nearest
    to the vanishing point."""


class RectifyImage(IntEnum):
    """An image of a rectification."""

    UNWARPED = 0
    """The plane in frontal view, linear RGB."""
    VALID = 1
    """The mask of the plane in frontal view: 1 where the mask is set and the photo's values are finite, else 0;
    1 channel."""


class FocalSource(IntEnum):
    """The source of a focal length."""

    GIVEN = 0
    """The caller has set the focal length."""
    FROM_VANISHING_POINTS = 1
    """Estimated, mainly from the vanishing points of orthogonal directions."""
    ASSUMED = 2
    """Mainly assumed: a usual value, 0.85 times the width of the photo, has a greater weight than the estimate
    from vanishing points."""
    FROM_METADATA = 3
    """Mainly from the metadata of the photo's file; see luxfer_image_get_metadata."""
    FROM_LAMPS = 4
    """Estimated so that the lamps have equal sizes and shapes, or lie on a lattice, in the frontal view of
    their plane (lighting transfer only)."""


class Normalisation(IntEnum):
    """Normalisation of the colours that a network expects as its input."""

    BY_SIZE = 0
    """Chosen by the size of the network's input: Normalisation.IMAGENET for 256 x 256, else
    Normalisation.HALF."""
    IMAGENET = 1
    """(sRGB - (0.485, 0.456, 0.406)) / (0.229, 0.224, 0.225), for MiDaS 2.1, large and small."""
    HALF = 2
    """(sRGB - 0.5) / 0.5, for DPT."""
    NONE = 3
    """No normalisation: sRGB in [0, 1]."""


class FeaturesImage(IntEnum):
    """An image of the features."""

    CHANNELS = 0
    """The ten features, one channel each: L*, a*, b* (CIELAB, D65); depth; position x, y, z; unit normal x, y,
    z, towards the camera. The depth is (1/near - 1/z) / (1/near - 1/far), where z is the distance along the
    viewing axis, near is near_plane and far is far_plane. Positions are relative to the camera, in the unit of
    near_plane. The axes are x right, y down, z forward: the axes of the camera or, after
    luxfer_features_set_view, of the room. luxfer_image_read reads up to four channels at a time."""
    DEPTH_CONFIDENCE = 1
    """Confidence of the depth of each pixel, in [0, 1]; 1 channel."""
    NETWORK_DEPTH = 2
    """The distance along the viewing axis that a network has estimated, in [near_plane, far_plane]; 1 channel.
    Set it as the depth map of later jobs, or of a luxfer_transfer, to avoid running the network again."""


class DepthSource(IntEnum):
    """The source of the depth."""

    CALLER = 0
    """The caller's depth map."""
    LAYOUT = 1
    """A box-shaped room fitted to the lines of the photo and to strokes."""
    NOTHING = 2
    """No source: a fixed depth that does not depend on the photo."""
    NETWORK = 3
    """The caller's network."""


class Subject(IntEnum):
    """The subject of a segmentation."""

    AUTO = 0
    """Chooses the subject: lamps if luxfer_segment_set_region gave a mask and the features have ten channels,
    as luxfer_features makes them; else a surface."""
    SURFACE = 1
    """A surface, such as the plane that carries the lamps: each pixel is classified by its features. With the
    ten channels of luxfer_features and without luxfer_segment_set_region, the mask is then restricted to the
    wall, the floor or the ceiling that the positive strokes lie on. If the positive strokes lie on several of
    these surfaces, the mask keeps only its connected parts that positive strokes touch."""
    LAMPS = 2
    """Lamps: compact regions with a sharp contour, brighter than their surroundings. Each positive stroke marks
    one lamp or more. Regions without a stroke that resemble the marked lamps and lie in the mask of
    luxfer_segment_set_region count as lamps too. Negative strokes are not needed. The first three channels of
    the features must be CIELAB."""


class SegmentImage(IntEnum):
    """An image of a segmentation."""

    MASK = 0
    """The mask: 1 where the confidence is above one half, else 0; 1 channel."""
    CONFIDENCE = 1
    """The confidence that a pixel is of the positive class, in [0, 1]; 1 channel. For a surface: the
    probability. For lamps: 1 inside a lamp, 0 outside, 0.5 on its contour; it changes from 1 to 0 within about
    two pixels."""
    UNSEEN = 2
    """How much a pixel differs from all pixels under strokes, in [0, 1]; 1 channel. For lamps: 1 in regions
    that resemble the painted lamps but not closely enough for the mask, else 0. Another stroke helps where the
    value is high."""


class EmissionLaw(IntEnum):
    """The law, that is, the rule by which a texture continues the lights of its exemplar."""

    BEST = 0
    """In settings only: the law that predicts the lamps of the photo best. The law of EmissionLaw.CORRELATION
    is kept unless another law predicts the lamps clearly better. If EmissionReport.error of the texture then
    exceeds 1, and there is a single exemplar, the other laws are tried, and the texture with the smallest error
    is kept. The emission has the warning WarningCode.NO_PATTERN even if another law gives a better texture."""
    CORRELATION = 1
    """In settings only: the law follows from the periods in the autocorrelation of the lights. Two periods give
    EmissionLaw.LATTICE, one period gives EmissionLaw.ROW. Without a period, the law is EmissionLaw.WHOLE if the
    exemplar shows few lamps or one isolated group of lamps, and otherwise EmissionLaw.FREE. A period counts
    only if the correlation after a shift by this period is at least the setting min_regularity."""
    LATTICE = 2
    """The lamps form a lattice with two periods."""
    ROW = 3
    """The lamps form a row with one period. Across the row, the strip that the exemplar shows is repeated edge
    to edge."""
    WHOLE = 4
    """The exemplar repeats as a whole, edge to edge, in both directions."""
    FREE = 5
    """The lights have no period: patches of the exemplar are placed anywhere in the texture."""
    COPY = 6
    """In results only: the texture is a copied part of the exemplar, or the caller supplied the texture."""


class EmissionImage(IntEnum):
    """An image of the emission."""

    TEXTURE = 0
    """The texture: linear RGB, where 1 is the photo's white; 0 outside lamps."""
    MASK = 1
    """The mask of the texture: 1 on lamps, else 0; 1 channel."""
    EXEMPLAR_GUIDES = 2
    """The guide channels of the exemplar, by which patches are compared in addition to colour; 3 channels, at
    the reduced resolution that working_side gives. Channel 0 is the confidence, in [0, 1], that the pixel shows
    a light. Channels 1 and 2 are the x and y offsets from the pixel to the nearest lit pixel, positive to the
    right and down, divided by a length L and clamped to [-1, 1]; both are 1 if no pixel is lit. L is the side
    of a patch, but at most half the longer period if the lights repeat."""
    GUIDES = 3
    """The guide channels of the texture, at the resolution of EmissionImage.EXEMPLAR_GUIDES: pixels of that
    image, copied with the patches that give the texture its colours."""


class Constraint(IntEnum):
    """Whether light should equal its target value, or stay above or below it."""

    EQUAL = 0
    """The light should equal its target value."""
    AT_LEAST = 1
    """The light should be at least its target value, for example because a standard requires it on a desk, or
    because the photo clips this channel."""
    AT_MOST = 2
    """The light should be at most its target value, for example to limit glare."""


class Quantity(IntEnum):
    """The quantity of the target surface that should match the photo."""

    OUTGOING = 0
    """Light that the target surface reflects diffusely, its albedo included: the radiance that a photo shows of
    a matt surface."""
    INCIDENT = 1
    """Light that arrives at the target surface, as the radiance of a white surface in this light: illuminance /
    pi."""


class Fit(IntEnum):
    """How the light of the target surface is compared with its target value."""

    MEAN = 0
    """The mean of the light over the target surface should equal the target value."""
    LEAST_SQUARES = 1
    """The sum, over all points of the target surface, of the squared difference between light and target value
    should be smallest. A gradient descent on the texels of the emission would minimise this sum too. Bright
    points count more, so the emission is dimmer than with Fit.MEAN. Without other light it is dimmer by the
    factor 1/(1+CV²), where CV is the coefficient of variation (standard deviation divided by mean) of the light
    over the target surface."""


class Outcome(IntEnum):
    """Whether the target is met in a colour channel, and if not, the reason."""

    SATISFIED = 0
    """The target, or its limit, is met."""
    TOO_BRIGHT = 1
    """The other lights alone exceed the target, so the emission is 0 in this channel; or, for a luxfer_lamps
    and for luxfer_transfer_start_all, two targets contradict each other."""
    DARK = 2
    """No light of this channel reaches the target: the channel gets the mean scale of the channels that meet
    the target."""
    TOO_DIM = 3
    """All lamps at their largest power are too weak, or two goals contradict each other. Occurs only for a
    luxfer_lamps, and for transfers whose light luxfer_transfer_start_all solves for together."""


class PatternScale(IntEnum):
    """Choice of the length that sets the size of the pattern on the surface."""

    DISTANCE = 0
    """The distance of the photo's camera from the plane with the lights. It is plane_distance of
    TransferParams, or if that is 0, an estimate. The estimate comes from the size of the lamps if they are
    rectangular; otherwise it is a usual distance with a large error."""
    LAMP = 1
    """The length of the lamps: the pattern is scaled until the median of their longer sides is
    PatternParams.length."""
    SPACING = 2
    """The spacing of the lamps: the pattern is scaled until this spacing is PatternParams.length. The spacing
    is the shorter period of the lamps' lattice or, without a lattice, the median distance from a lamp to its
    nearest neighbour."""
    ACROSS = 3
    """The width of the surface: as many lamps lie side by side on it as on the plane in the photo."""


class Stage(IntEnum):
    """A stage of the transfer."""

    STYLIZE = -2
    """No stage of a transfer, but a stylisation or its guides: occurs only in warnings."""
    SCENE = -1
    """No stage, but a luxfer_scene: occurs only in warnings."""
    VIEW = 0
    """Finds lines, vanishing points and the camera of the photo."""
    FEATURES = 1
    """Computes the ten feature channels of each pixel of the photo."""
    PLANE = 2
    """Segments the plane that carries the lights."""
    LIGHTS = 3
    """Segments the lights on the plane."""
    UNWARP = 4
    """Unwarps the plane to a frontal view."""
    EMISSION = 5
    """Synthesises the emissive texture and maps it onto the scene's surface."""
    RELIGHT = 6
    """Solves for the colour and intensity of the emission."""
    RENDER = 7
    """Renders the scene in its new light."""


class Target(IntEnum):
    """The part of the photo whose mean colour is matched."""

    SURFACE = 0
    """The plane that carries the lights, without the lights and their halo."""
    WHOLE_IMAGE = 1
    """The whole photo."""


class TransferImage(IntEnum):
    """An image that a stage of the transfer has made."""

    FEATURES = 0
    """The ten channels of the features, as FeaturesImage.CHANNELS."""
    PLANE_MASK = 1
    """The mask of the plane in the photo: 1 on the plane, else 0; 1 channel."""
    PLANE_CONFIDENCE = 2
    """Probability that a pixel of the photo is on the plane, in [0, 1]; 1 channel."""
    LIGHTS_MASK = 3
    """The mask of the lights in the photo: 1 on lights, else 0; 1 channel."""
    LIGHTS_CONFIDENCE = 4
    """Confidence that a pixel of the photo is a light, in [0, 1], as SegmentImage.CONFIDENCE; 1 channel."""
    UNWARPED = 5
    """The unwarped image: the plane in frontal view, linear RGB."""
    UNWARPED_VALID = 6
    """The mask of the plane in frontal view: 1 where the mask is set and the photo's values are finite, else 0;
    1 channel."""
    EMISSION = 7
    """The emissive texture: linear RGB, where 1 is the photo's white."""
    EMISSION_MASK = 8
    """The mask of the emissive texture: 1 on lamps, else 0; 1 channel."""
    RENDER = 9
    """The scene in its new light: linear RGB in cd/m²; while the rendering runs, the picture so far."""
    RENDER_VARIANCE = 10
    """Variance of the rendering, as RenderImage.VARIANCE; 3 channels."""
    RENDER_PREVIEW = 11
    """The rendering after a noise filter, if the settings of the stage RENDER ask for a preview; see
    RenderImage.PREVIEW."""


class TransferScene(IntEnum):
    """A scene that the transfer has made."""

    UNSOLVED = 0
    """The scene with the emission before the stage RELIGHT solves for its factor: the texture times
    white_luminance of TransferParams, as bright as the lamps in the photo."""
    LIT = 1
    """The scene with the solved emission: the result."""
    WHITE = 2
    """As TransferScene.LIT, but the emission is white, at unchanged luminance; for comparison."""


class WarningCode(IntEnum):
    """The code of a warning."""

    FOCAL_ASSUMED = 1
    """The vanishing points determine the focal length poorly, so it was mainly assumed; the severity is the
    relative standard deviation of the focal length, or the limit if the limit is larger."""
    VIEW_UNCERTAIN = 2
    """The directions of the room axes are uncertain; the severity is the largest standard deviation in
    radians."""
    LENS_DISTORTION = 3
    """The lens bends straight lines; the severity is the distortion of RectifyReport without its sign."""
    NOT_SQUARE = 4
    """The walls do not meet at right angles, or the pixels are not square; the severity is the largest
    deviation of an angle between two room axes from a right angle, in radians."""
    LAYOUT_UNCERTAIN = 5
    """There is no depth map, and the room that was fitted to the lines of the photo is uncertain. The severity
    is the confidence of the fit, in [0, 1], which is below the limit; 0 if no room could be fitted."""
    UNSEEN = 6
    """Much of the mask of a surface is unlike every stroke, or the mask of lamps leaves out regions that partly
    resemble the painted or proposed lamps. The severity is the area of these doubtful pixels, divided by the
    area of the mask and the doubtful pixels together. The warning points to the pixel where one more stroke
    helps most."""
    CONTRADICTORY_STROKES = 7
    """Positive and negative strokes cover the same pixels, where the later strokes count. The severity is the
    number of these pixels, divided by the number of painted pixels that the segmentation learns from."""
    OFF_IMAGE_STROKES = 8
    """Pixels of strokes lie outside the photo and are ignored. The severity is the number of these pixels,
    divided by the number of painted pixels that the segmentation learns from."""
    UNCERTAIN_MASK = 9
    """A mask is uncertain; the severity is the expected share of wrong pixels."""
    EMPTY_MASK = 10
    """A mask has no pixel; the severity is 0, which is below the limit."""
    MISSED_STROKES = 11
    """A mask contradicts the strokes that it was made from; the severity is the share of the painted pixels
    that it contradicts. The warning points to one of these pixels."""
    ALMOST_ALL_LIT = 12
    """Lights cover much of their plane; the severity is the share of the plane that they cover."""
    MAGNIFIED = 13
    """Much of the unwarped plane is magnified more than 4 times from the photo; the severity is the share of
    the plane that is magnified so much. The warning points to the point with the largest magnification."""
    PLANE_NEAR_HORIZON = 14
    """The camera sees the plane nearly edge-on. The severity is the median, over the plane, of the sine of the
    angle between the plane and the viewing ray; it is below the limit. The warning points to the point with the
    smallest angle."""
    PATTERN_UNCERTAIN = 15
    """The texture and the photo differ in the statistics of their lamps; the severity is
    EmissionReport.error."""
    FEW_LAMPS = 16
    """The photo shows too few whole lamps for a pattern; the severity is the number of whole lamps, which is
    below the limit."""
    NO_LATTICE = 17
    """No lattice was found on which the lamps lie, and the texture differs from the photo; the severity is
    EmissionReport.error."""
    UNREACHABLE = 18
    """Colour channels do not meet their target; the severity is the number of these channels."""
    TARGET_CLIPPED = 19
    """Channels of the target colour are only lower bounds (Constraint.AT_LEAST). A transfer sets such a bound
    if the photo clips the channel in most pixels that the target colour is computed from. The severity is the
    number of these channels."""
    IMPLAUSIBLE_SIZE = 20
    """A scene is so high, so wide or so small that its unit is probably not the metre. The severity is the
    implausible height or width in metres. For a scene that is too small, it is the larger of height and width,
    and is below the limit. The message names the likely unit."""
    NOT_RENDERED = 21
    """The file of a scene has a feature or an extension that is not rendered. The message names the feature and
    the first objects that have it; the severity is the number of these objects."""
    DIM_LAMPS = 22
    """The painted lamps are hardly brighter than the plane: they are off, or face away. The severity is the
    probability that a pixel painted as light is brighter than a pixel painted as plane; it is below the limit.
    The warning points to the darkest lamp."""
    NO_PATTERN = 23
    """A texture without any light would differ less from the photo than the texture that was synthesised first.
    The severity is the error of that first texture. If EmissionLaw.BEST has then found a better texture by
    another law, EmissionReport.error is smaller than the severity. This warning replaces
    WarningCode.PATTERN_UNCERTAIN."""
    PROPOSED = 24
    """A mask is only a proposal, because strokes are missing: for the plane, positive or negative strokes, or
    both; for the lights, positive strokes. The severity is the expected share of wrong pixels."""
    FAR_FROM_ORIGIN = 25
    """A scene lies far from the origin. There are two cases. If luxfer_scene_get_origin is not 0, positions are
    relative to that origin; the severity is its distance from the origin of the file in metres, and the limit
    is 0. Otherwise coordinates of vertices are so large that floats round them; the severity is the step of the
    rounding in metres."""
    NOT_IN_PICTURE = 26
    """A scene has luminaires that shine from points: they are invisible in renderings, and
    luxfer_image_get_glare does not rate them. The severity is the number of these luminaires; the message lists
    the first few with their positions."""
    NO_COUNTERPART = 27
    """Objects that this frame of a sequence shows are missing in the previous frame, or have other triangles
    there. Their motion is unknown and therefore NaN. The severity is the share of the picture that shows these
    objects; the message names them. The warning points to a pixel of the largest of these objects."""
    MOTION_DISAGREES = 28
    """The motion of a stylisation contradicts the guides: at the end of a pixel's motion, the previous frame
    shows another surface. If the targets of both frames come from luxfer_stylize_add_guides, the motion is
    compared with the exact motion of their scenes. Otherwise the GuideRange.DATA guides, such as object codes
    or normals, of the pixel and of the end of its motion are compared. Previews, and stylisations without such
    guides, skip this comparison of guides. If nothing was compared, the warning does not occur. The severity is
    the share of pixels with wrong motion among the pixels that were compared. The warning points to the pixel
    with the largest error."""
    LIGHT_NOT_PAINTED = 29
    """The target of a stylisation shows light that no usable place of the exemplar shows, for example a cast
    shadow if the painted part of a half-painted picture has no shadow. The new paint there is a guess. The
    severity is the share of such pixels among the pixels to paint; StylizeImage.GUIDE_ERROR shows them. The
    warning points to the place of the target where most of them lie."""
    AMBIGUOUS_PAINT = 30
    """Places of the exemplar with equal guides are painted in two ways, which a stylisation mixes. The severity
    is the share of the exemplar that such places cover. The warning points to one of them in the artwork."""
    BLEMISH = 31
    """A small place of the artwork, such as a stain, is painted unlike all places with similar guides. The
    severity is the difference in paint from this place that all but 5 % of the places with similar guides
    exceed, divided by the typical difference in paint between places with equal guides. The warning points to
    the place in the artwork."""
    OFF_PLANE = 32
    """The sizes of the lamps in the photo contradict the perspective of the plane: the lamps hang or lie on
    several planes, the mask of the lights shows other things, or the camera is wrong. Where the photo shows the
    plane k times as large, it would show lamps on the plane k times as large, but shows these lamps k^severity
    times as large. Only luxfer_transfer compares them, because luxfer_rectify does not know the lamps."""


class IlluminanceImage(IntEnum):
    """An image of an illuminance calculation."""

    LUX = 0
    """Illuminance in lux; 1 channel; NaN in texels that the mesh does not cover."""
    ERROR = 1
    """Standard error of each illuminance, in lux; 1 channel; NaN in texels that the mesh does not cover."""


class Group(IntEnum):
    """Groups of lamps that share one power."""

    ALL = 0
    """All lamps form one group."""
    EACH = 1
    """Each lamp is a group of its own."""
    BY_X = 2
    """Each row of lamps is a group. The lamps are sorted by the x coordinates of their centres; a new row
    begins where two successive lamps differ by more than row_tolerance. If the emission has a texture, the
    texture coordinate u replaces x."""
    BY_Y = 3
    """Each row of lamps is a group. The lamps are sorted by the y coordinates of their centres; a new row
    begins where two successive lamps differ by more than row_tolerance. If the emission has a texture, the
    texture coordinate v replaces y."""
    BY_Z = 4
    """Each row of lamps is a group. The lamps are sorted by the z coordinates of their centres; a new row
    begins where two successive lamps differ by more than row_tolerance. If the emission has a texture, all
    lamps form one group."""
    BY_TYPE = 5
    """Lamps of about equal area form a group: in the order of their areas, a new group begins where the area
    grows by more than 25 % from one lamp to the next. Among punctual lights, each kind (point, spot,
    directional) forms one group, and all luminaires with one distribution form one group."""


class Aim(IntEnum):
    """Objective of a placement."""

    MAX_LUMINANCE = 0
    """Make the luminance of the target as large as possible."""
    MIN_LUMINANCE = 1
    """Make the luminance of the target as small as possible."""
    RADIANCE = 2
    """Bring the mean radiance of the target, under the texture and all other light, as near as possible to
    PlacementParams.radiance."""


class Projection(IntEnum):
    """The projection of an image."""

    PERSPECTIVE = 0
    """Perspective: the image of a pinhole camera."""
    ANGULAR = 1
    """Angular (equidistant) fisheye: the distance of a pixel from the centre of the image is proportional to
    the angle between its direction and the line of sight, as in Radiance's views of type a."""


class Scale(IntEnum):
    """The scale that maps values to colours."""

    LINEAR = 0
    """Linear: equal differences of the value take equal lengths of the scale bar."""
    LOGARITHMIC = 1
    """Logarithmic: each factor of ten takes an equal length of the scale bar."""


class Unit(IntEnum):
    """The quantity of an image's values."""

    LUMINANCE = 0
    """Luminance in cd/m²."""
    ILLUMINANCE = 1
    """Illuminance in lux."""


class SkyModel(IntEnum):
    """A model of the sky's relative luminance."""

    CIE = 0
    """A standard sky of CIE S 011 / ISO 15469."""
    PEREZ = 1
    """The all-weather sky of Perez et al. (1993)."""


class DaylightUnit(IntEnum):
    """The unit of the light of sun and sky."""

    LUX = 0
    """Illuminance in lux."""
    WATTS = 1
    """Irradiance in W/m², converted to lux by the luminous efficacies of Perez et al. (1990)."""


class Known(IntEnum):
    """The length that determines the size of the lamps."""

    NOTHING = 0
    """No length is known. The points where suspensions meet the ceiling then determine the size, together with
    the height of the ceiling. Without such points, each lamp has Doubt.SIZE."""
    DROP = 1
    """The distance of the first lamp's top below the ceiling; with alike = 0, of every lamp's top."""
    DIAMETER = 2
    """The largest diameter of the body. All lamps then have this diameter, also with alike = 0."""
    SPACING = 3
    """The horizontal distance between the axes of the first two lamps; with alike = 0 it determines no size."""


class Body(IntEnum):
    """The kind of a lamp's body."""

    GLOBE = 0
    """A sphere."""
    SPHEROID = 1
    """An ellipsoid of revolution."""
    DRUM = 2
    """A cylinder."""
    DISC = 3
    """A cylinder lower than a quarter of its diameter."""
    CONE = 4
    """A frustum of a cone."""
    BOWL = 5
    """A part of a sphere below a horizontal plane."""
    DOME = 6
    """A part of a sphere above a horizontal plane."""
    OTHER = 7
    """Any other body of revolution, such as a bell."""


class GuidesImage(IntEnum):
    """A guide image."""

    FULL = 0
    """All light (L.*E): lights that are seen directly, and light that is reflected or transmitted any number of
    times."""
    DIRECT = 1
    """Light reflected once, by a diffuse surface (LDE)."""
    SPECULAR = 2
    """Light reflected or transmitted once, at a glossy surface, mirror or clear pane (LSE)."""
    INDIRECT = 3
    """Light whose last two reflections were diffuse (L.*DDE): it shows colour bleeding."""
    TWO_BOUNCES = 4
    """Light reflected once or twice, by diffuse surfaces (LD{1,2}E): unlike direct light, it shows detail in
    shadows."""
    NORMALS = 5
    """Unit normals in camera space: x right, y up, z towards the camera; 0 where there is no surface; 3
    channels."""
    EDGES = 6
    """Strength of the edges of shapes, in [0, 1]: changes of material, creases and jumps in depth; 1 on a clear
    edge, 0 away from edges; 1 channel."""
    MATERIALS = 7
    """A colour for each material, derived from its name, so that materials of equal name match in all scenes;
    black where there is no surface; 3 channels."""
    CAUSTICS = 8
    """Caustics: light that glossy surfaces, mirrors or clear panes (one or more of them) cast onto a diffuse
    surface, which reflects it to the camera (LS+DE)."""


class StylizePreset(IntEnum):
    """A preset of the settings, which trades quality for speed."""

    FULL = 0
    """Full quality, the default."""
    FAST = 1
    """Nearly the quality of StylizePreset.FULL in half the time."""
    PREVIEW = 2
    """Half resolution with compressed guides (see StylizeParams.preview), for feedback while painting."""
    PAPER = 3
    """The settings of StyLit (Fiser et al. 2016), for comparison."""


class StylizeSearch(IntEnum):
    """The search for nearest patches."""

    PATCHMATCH = 0
    """PatchMatch (Barnes et al. 2009), the default."""
    KD_TREE = 1
    """A k-d tree over the mean colours and guides of patches."""


class StylizeVote(IntEnum):
    """How a pixel is computed from overlapping patches."""

    PLAIN = 0
    """The mean of the colours that the overlapping patches have at the pixel."""
    WEIGHTED = 1
    """The mean of the colours that the overlapping patches have at the pixel, weighted so that closer matches
    count more."""
    NEAREST = 2
    """Of the overlapping patches' colours, the colour that is nearest to their mean, so that every colour
    occurs in the artwork."""
    MAJORITY = 3
    """The artwork pixel that the largest number of overlapping patches put at this pixel. Where two pieces of
    the artwork meet, each stays whole up to the seam."""
    ADAPTIVE = 4
    """A blend of StylizeVote.PLAIN and StylizeVote.MAJORITY. The proportion varies, so that each place of the
    picture has as much fine detail as the place of the artwork from which it was painted. The blend thus copies
    pixels of the artwork unchanged in rough paint, has soft transitions in smooth paint, and has edges as sharp
    as in the artwork. StylizeReport.unblended_share is the share of unchanged pixels."""


class GuideRange(IntEnum):
    """How the values of a guide are compared."""

    LIGHT = 0
    """Linear light >= 0, such as a rendering. Its values are clipped at white (1) and compared in the sRGB
    encoding. If the 99.9th percentile of source and target together exceeds 1, all values are divided by this
    percentile first."""
    DATA = 1
    """Data, such as normals, object codes and edges. The range of values that all channels of source and target
    have together is scaled to [0, 1]."""


class StylizeImage(IntEnum):
    """An image of a stylisation."""

    PICTURE = 0
    """The stylised target, linear, with the artwork's channels. Before the last level, in preview and after a
    cancel it is smaller than the target: the target's sides are halved StylizeReport.halvings times, rounded
    down."""
    GUIDE_ERROR = 1
    """Weighted root mean square difference, in [0, 1], between the guides at a pixel and the guides at the
    place in the exemplar from which the pixel was painted; 1 channel. It is high where nothing in the exemplar
    fits."""
    SOURCES = 2
    """Position in the artwork from which each pixel was painted, x and y in pixels of the artwork, (0.5, 0.5)
    for the top-left pixel; -1 where nothing was painted; 2 channels."""


class Demo(IntEnum):
    """A scene that the library generates."""

    TARGET_ROOM = 0
    """A furnished room without lights; its ceiling is the object "Ceiling"."""
    EXEMPLAR_ROOM = 1
    """An office under a grid of luminaires; luxfer_demo_photo takes its photo with camera 0."""
    SPHERE_ON_TABLE = 2
    """A glossy red ball on a white table: the exemplar scene of a stylisation, of which an artist would paint a
    picture."""
    STILL_LIFE = 3
    """A vase, a ring and two balls, on the table and under the lamp of Demo.SPHERE_ON_TABLE: a target scene for
    a stylisation."""


class Artwork(IntEnum):
    """The style of a generated artwork."""

    PEN = 0
    """Pen: hatching in two inks."""
    STIPPLE = 1
    """Stipple: dots of two inks."""
    PAINT = 2
    """Paint: oil on canvas."""


class DemoPhotoImage(IntEnum):
    """An image of the demonstration photo."""

    PICTURE = 0
    """The photo: linear RGB, 1 = display white; lamps are clipped to white."""
    STROKES = 1
    """The strokes on the photo, as a drawing in the colours of luxfer_strokes_add_image."""


class Aov(IntFlag):
    """Aov, to be combined with |."""

    DEPTH = 1
    """Distance of the surface from the camera along the viewing direction (depth z), in metres; infinite where
    there is no surface. Layer Depth, channel Z."""
    DISTANCE = 2
    """Distance of the surface from the camera along the pixel's ray, in metres; infinite where there is no
    surface. Layer Distance, channel Z."""
    POSITION = 4
    """Position in world space, in metres; 0 where there is no surface. Layer Position, channels X Y Z."""
    NORMAL = 8
    """Shading normal in world space, towards the camera; 0 where there is no surface. Layer Normal, channels X
    Y Z."""
    GEOMETRIC_NORMAL = 16
    """Normal of the triangle in world space, towards the camera; 0 where there is no surface. Layer
    GeometricNormal, channels X Y Z."""
    ALBEDO = 32
    """Reflectance plus transmittance at normal incidence: the mean over all samples of the pixel, where samples
    that meet no surface count as 0. Layer Albedo, channels R G B."""
    OBJECT = 64
    """1 + index of the mesh on which more than half of the pixel's hits lie. Without such a majority: 1 + index
    of any mesh that was hit. 0 where there is no surface. The luminous opening of the luminaire with index i
    among the punctual lights has the value m + i + 1, where m is the number of meshes. Layer IndexOB, channel
    X."""
    MATERIAL = 128
    """1 + index of the material on which more than half of the pixel's hits lie. Without such a majority: 1 +
    index of any material that was hit. 0 where there is no surface. The luminous openings of luminaires have
    the value n + 1, where n is the number of materials. Layer IndexMA, channel X."""
    ALPHA = 256
    """Share of the pixel that surfaces cover, in [0, 1]. Layer Alpha, channel A."""
    LUMINANCE = 512
    """Luminance of the main image, in cd/m². Layer Luminance, channel Y."""


class Doubt(IntFlag):
    """Doubt, to be combined with |."""

    SIZE = 1
    """The size is unknown: no length determines it, or its standard deviation exceeds half of it. The fields
    drop, diameter and height then hold only bounds."""
    KIND = 2
    """The probability of the kind is below 0.9."""
    CLIPPED = 4
    """The photo clips more than a tenth of the lamp's pixels (see Pendant.clipped): the lamp may be brighter
    than it appears, and its glare may enlarge the outline."""
    CUT = 8
    """The border of the photo cuts off a part of the outline."""
    HIDDEN = 16
    """The body hides a part of its own profile. At least one value of Pendant.profile_error exceeds 0.05."""


class GuidesWith(IntFlag):
    """GuidesWith, to be combined with |."""

    NORMALS = 1
    """Flag of luxfer_stylize_add_guides: add the normals. Without this flag, the normals are used only if the
    strokes of the artwork follow the shapes."""
    EDGES = 2
    """Flag of luxfer_stylize_add_guides: add the edges, for shapes finer than the brush strokes."""
    MATERIALS = 4
    """Flag of luxfer_stylize_add_guides: add the colour code of materials, so that objects of one material are
    painted from objects of that material."""
    CAUSTICS = 8
    """Flag of luxfer_stylize_add_guides: add a guide of the caustics, at the same exposure as the other guides
    of light. Use it for scenes in which glossy objects reflect light onto others."""


class Lights(IntFlag):
    """Lights, to be combined with |."""

    SURFACE = 1
    """At least one surface emits; the luminous openings of luminaires count."""
    TEXTURE = 2
    """At least one emitting surface has an emission texture."""
    POINT = 4
    """At least one point light, or luminaire that shines from a point, has an intensity above 0."""
    SPOT = 8
    """At least one spot light has an intensity above 0."""
    DIRECTIONAL = 16
    """At least one directional light has an illuminance above 0."""
    ENVIRONMENT = 32
    """The environment emits."""


class Scattering(IntFlag):
    """Scattering, to be combined with |."""

    DIFFUSE = 1
    """At least one surface scatters diffusely."""
    GLOSSY = 2
    """At least one surface has a rough specular reflection."""
    MIRROR = 4
    """At least one surface is a mirror."""
    GLASS = 8
    """At least one surface is a clear pane of glass."""
    ALPHA = 16
    """At least one surface is partly transparent because of its alpha."""
    REFRACTION = 32
    """At least one body is solid glass, which refracts."""
    CLEAR_COAT = 64
    """At least one surface has a clear coat (KHR_materials_clearcoat)."""


class View(IntFlag):
    """View, to be combined with |."""

    BOTTOM_UP = 1
    """Flag of a view: the first row in memory is the bottom row of the image."""


class ContextParams(TypedDict, total=False):
    """Settings of a context."""

    num_threads: int
    """Number of worker threads, in [0, 1024]; 0, the default: one for each core that the process may use. All
    jobs share these threads. Synchronous calls, which do their work before they return, do not use them, and so
    never wait for a job. A synchronous call runs on the calling thread, or on a set of num_threads other
    threads, which it shares with no other call. The context keeps up to four idle sets for later calls."""
    memory_budget_mib: int
    """Limit in MiB on the memory of all pixels, meshes and textures that the caller creates in this context; 0,
    the default: no limit. A call that would exceed the limit returns Status.OUT_OF_MEMORY. While a picture file
    is read, the memory of its decoder counts too. The working memory and the results of jobs do not count."""


class ImageView(TypedDict, total=False):
    """An image in the caller's memory."""

    channels: int
    """Samples per pixel in [1, 4]; default 3."""
    sample: Sample | str | int
    """Storage type of the samples: Sample; default Sample.F32."""
    colour_space: ColourSpace | str | int
    """Encoding of the samples: ColourSpace; default ColourSpace.LINEAR."""
    width: int
    """Width in pixels, in [1, 65536]; default 0: the caller must set it."""
    height: int
    """Height in pixels, in [1, 65536]; default 0: the caller must set it."""
    flags: View | str | int
    """View, or 0, the default. Unknown flags give Status.INVALID_ARGUMENT."""
    pixel_stride: int
    """Bytes from one pixel to the next, at least the size of a pixel; 0, the default: pixels are packed."""
    row_stride: int
    """Bytes from one row to the next, at least the size of a row; 0, the default: rows are packed."""
    byte_size: int
    """Size of the memory at data in bytes; default 0: the caller must set it. Status.INVALID_ARGUMENT if the
    pixels and the strides need more."""
    data: int
    """The pixels, at any alignment; default None: the caller must set it. The library neither reads nor writes
    the bytes between pixels or rows."""


@dataclass(frozen=True)
class PhotoMetadata:
    """Metadata of the file of a loaded photo."""

    orientation: int
    """EXIF orientation of the stored photo, in [1, 8]; 1 = upright or not recorded. Loading has already applied
    it: 2 mirrors left to right, 3 rotates by 180 degrees, 4 mirrors top to bottom, 6 rotates clockwise by 90
    degrees, 8 counter-clockwise, 5 mirrors about the diagonal from top left to bottom right, 7 about the other
    diagonal."""
    focal: float
    """Focal length in pixels of the loaded photo; 0 if it is unknown, or if the aspect ratio shows that the
    photo was cropped."""
    focal_error: float
    """Standard deviation of the field focal, in pixels; 0 = unknown."""
    f_number: float
    """F-number N of the aperture; 0 = unknown."""
    exposure_time: float
    """Exposure time t in seconds; 0 = unknown."""
    iso: float
    """ISO speed S; 0 = unknown."""
    white_luminance: float
    """Scene luminance in cd/m² that the camera recorded as white (value 1): 78 N² / (0.65 t S), from the
    definition of the saturation-based speed in ISO 12232. N, t and S are the three fields above. 0 = unknown.
    Valid only for the image that the camera wrote: an editor that changes the brightness keeps the tags, so the
    value is then wrong."""
    white_luminance_low: float
    """Lower bound of white_luminance: 0.71 times white_luminance. This is the value for a camera whose ISO
    speed is a standard output sensitivity (ISO 12232) instead of a saturation-based speed."""
    white_luminance_high: float
    """Upper bound of white_luminance: twice white_luminance. It allows for an ISO speed that is a recommended
    exposure index (ISO 12232), with which the manufacturer chooses the luminance at which the camera clips."""
    colour: FileColour
    """How the colours of the file were interpreted: FileColour."""


class MergeParams(TypedDict, total=False):
    """Settings for merging exposures."""

    source: ExposureSource | str | int
    """Where the exposures come from, unless the field exposures states them: ExposureSource; default
    ExposureSource.BOTH."""
    reference: int
    """Index of the reference; -1, the default: the photo with the most pixels that are well exposed."""
    keep_moving: int
    """Treatment of pixels at which the exposures differ by more than noise explains, because something moved.
    0, the default: a pixel is averaged only over the exposures that agree with the reference or, where the
    reference is clipped, with the next shorter exposure that is not clipped. 1: all exposures are averaged."""
    max_shift: float
    """Largest shift between photos that are neighbours in exposure, as a part of the longer side of a photo, in
    [0, 0.25]; default 0.03. 0: the photos are not aligned, as for a camera on a tripod."""
    saturation: float
    """Value in [0.1, 1] from which on a channel counts as clipped; default 0.95. A photo with any value above 2
    counts as a photo of high dynamic range, in which no pixel is clipped."""
    exposures: Sequence[float]
    """Exposure of each photo in any unit, such as seconds, in [1e-9, 1e9]; all 0, the default: see the field
    source. Elements beyond the number of photos must be 0."""
    tone_curve: ToneCurve | str | int
    """Tone curve of the photos: ToneCurve; default ToneCurve.RECOVERED."""


@dataclass(frozen=True)
class MergeReport:
    """The exposures and shifts that luxfer_image_merge_exposures found. Arrays have an element for each photo,
    in the order of the photos; further elements are 0."""

    count: int
    """Number of photos."""
    reference: int
    """Index of the reference."""
    clipped: float
    """Part of the pixels that are clipped in every photo that shows them, in [0, 1]. Their values come from the
    shortest exposure and are lower bounds."""
    moved: float
    """Part of the pixels at which neighbouring exposures differ by more than noise explains, in [0, 1]; 0 if
    keep_moving is 1."""
    exposures: tuple[float, ...]
    """Exposure of each photo divided by the exposure of the reference: a ratio of amounts of light, not of
    stops; above 1 for a photo with more light, 1 for the reference."""
    errors: tuple[float, ...]
    """Relative standard error of each exposure; 0 for exposures that MergeParams.exposures states."""
    stated: tuple[float, ...]
    """Exposure of each photo divided by the exposure of the reference, as the metadata state it; 0 =
    unknown."""
    shift_x: tuple[int, ...]
    """Column of each photo that shows the part of the view that column 0 of the reference shows; below 0 if the
    photo does not show that part."""
    shift_y: tuple[int, ...]
    """Row of each photo that shows the part of the view that row 0 of the reference shows; below 0 if the photo
    does not show that part."""
    tone_curve: ToneCurve
    """The tone curve that the photos were taken to have: ToneCurve.RECOVERED if another curve than that of sRGB
    was recovered and undone, else ToneCurve.SRGB."""
    contradicts_srgb: int
    """1 if the photos contradict the tone curve of sRGB and no other curve was recovered, because the exposures
    are unknown, the levels of the photos determine no curve, or the settings say so: the light of the merged
    image is then wrong by more than noise, and you should state the exposures. 0 otherwise."""
    tone_curve_error: float
    """Largest error of the recovered curve, as a share of the light, over the codes that two photos show: of
    the light at a code, relative to the light at the brightest of these codes. For brighter codes, which one
    photo shows at most, the curve of sRGB is assumed. 0 without a recovered curve."""
    tone_curve_light: tuple[float, ...]
    """Light at the codes 0, 1/16, ... 1 of the photos' files, relative to white: of the recovered curve, or
    else of sRGB."""


@dataclass(frozen=True)
class SceneCounts:
    """Number of objects of each kind in a scene."""

    meshes: int
    """Number of meshes. Their indices are 0 to meshes - 1; the objects that the fields below count are numbered
    in this way too."""
    materials: int
    """Number of materials."""
    textures: int
    """Number of textures."""
    lights: int
    """Number of punctual lights: points, spots, directional lights and luminaires."""
    cameras: int
    """Number of cameras."""
    triangles: int
    """Number of triangles in all meshes."""


@dataclass(frozen=True)
class Surface:
    """A planar surface of a scene: triangles in one plane, and their bounding rectangle. Seen from the room, u
    runs to the right and v runs down, as in an image."""

    triangles: int
    """Number of triangles in the plane."""
    origin: tuple[float, float, float]
    """Corner of the bounding rectangle where u = v = 0, in metres."""
    u_axis: tuple[float, float, float]
    """Unit vector of u, along the first side of the rectangle."""
    v_axis: tuple[float, float, float]
    """Unit vector of v, along the second side of the rectangle."""
    normal: tuple[float, float, float]
    """Unit normal on the side that will emit; it points into the room."""
    size: tuple[float, float]
    """Lengths of the rectangle's sides along u and v, in metres."""
    area: float
    """Area of the triangles in m²."""
    sloped_area: float
    """Area in m² of the other triangles of the object or material whose planes are inclined to this plane by 5
    to 75 degrees, such as the sides of a vault; they receive no emission."""


class SceneLoadParams(TypedDict, total=False):
    """Settings for loading a scene file."""

    allow_external_files: int
    """1: also read files outside the folder of the scene file if the scene file names them by .. or by an
    absolute path; 0, the default: such a name gives Status.UNSUPPORTED. Set it only for scene files that you
    trust. Only files are read, never devices or addresses on a network."""
    unit: float
    """Length in metres of a unit of the file, in [1e-6, 1e6]; default 1, as glTF defines; 0.001 for a file in
    millimetres. It scales positions, but not intensities and luminances."""
    keep_origin: int
    """0, the default: if a scene lies far from the origin of its file, as on a national grid, its positions are
    made relative to an origin near the scene, which luxfer_scene_get_origin gives. 1: positions stay relative
    to the origin of the file; in a scene far from that origin, the rounding of coordinates to floats visibly
    moves vertices."""
    luminaire_shape: LuminaireShape | str | int
    """From where the luminaires of the file (EXT_lights_ies) shine: LuminaireShape; default
    LuminaireShape.FACES."""


class MaterialParams(TypedDict, total=False):
    """A metallic-roughness material, as in glTF 2.0."""

    double_sided: int
    """1, the default: back faces emit as front faces do; 0: only front faces emit. In both cases, back faces
    reflect and block light as front faces do."""
    name: str
    """Name in UTF-8, copied; None, the default: no name."""
    base_color: Sequence[float]
    """Linear RGB base colour, each channel in [0, 1]; default 0.8."""
    metallic: float
    """Share of the surface that is metal, in [0, 1]; default 0."""
    roughness: float
    """Perceptual roughness in [0, 1], as in glTF; default 1."""
    emission: Sequence[float]
    """Emission per channel in cd/m², each in [0, 1e15]; default 0."""
    transmission: float
    """Share of the light entering the non-metallic part of the surface that passes through, instead of being
    reflected diffusely, in [0, 1]; default 0. base_color tints this light. If thickness is 0, it passes
    straight through, as through a thin clear pane, and roughness does not blur it."""
    ior: float
    """Index of refraction in [1, 4]; default 1.5. With 1, only metal reflects specularly."""
    alpha: float
    """Opacity in [0, 1]; multiplies the alpha of the base colour texture; default 1."""
    alpha_mode: AlphaMode | str | int
    """Use of alpha: AlphaMode; default AlphaMode.OPAQUE."""
    alpha_cutoff: float
    """Threshold of alpha for AlphaMode.MASK, >= 0; default 0.5."""
    normal_scale: float
    """Strength of the normal texture: a factor for the x and y of its normals, finite; default 1."""
    thickness: float
    """If above 0, and transmission too, the meshes of this material are the surfaces of solid bodies, which
    refract and absorb light: closed meshes whose front sides, from which the triangles wind counter-clockwise,
    face outwards. base_color tints the light whenever it passes the surface, and roughness blurs it. If 0, the
    default, the meshes are thin panes. The value itself does not matter: the mesh states how thick the body is.
    In metres, finite."""
    attenuation_color: Sequence[float]
    """Share of the light that is left after attenuation_distance inside a solid body, each channel in [0, 1];
    default 1."""
    attenuation_distance: float
    """Distance in metres, > 0; infinite, the default: the body absorbs nothing."""


@dataclass(frozen=True)
class TextureUse:
    """The texture that a material uses for one purpose."""

    texture: int
    """Index of the texture; LUXFER_NONE if the material has no texture for this purpose: the fields below are
    then 0."""
    uv_set: int
    """Set of the mesh's texture coordinates that the material uses for this texture: 0 or 1."""
    wrap_u: Wrap
    """Continuation of the texture along u: Wrap."""
    wrap_v: Wrap
    """Continuation of the texture along v: Wrap."""
    transform: tuple[float, ...]
    """Affine map that is applied to the texture coordinates (u, v, 1) before the look-up: two rows of three
    numbers."""


class MeshParams(TypedDict, total=False):
    """A triangle mesh in world space."""

    material: int
    """Index of the mesh's material, as luxfer_scene_add_material returns it; default 0."""
    name: str
    """Name in UTF-8, copied; luxfer_scene_find_surface finds surfaces by it. None, the default: no name."""
    vertex_count: int
    """Number of vertices in [3, 2^32 - 1]; default 0: the caller must set it."""
    positions: int
    """Positions: three floats per vertex, in metres, each in [-1e15, 1e15]; default None: the caller must set
    them."""
    position_stride: int
    """Bytes from one position to the next; at least 12, or 0, the default: packed."""
    normals: int
    """Normals: three floats per vertex, finite; None, the default: triangles are shaded flat."""
    normal_stride: int
    """Bytes from one normal to the next; at least 12, or 0, the default: packed."""
    uvs: int
    """Texture coordinates: two floats per vertex, finite; (0, 0) is the top-left corner of a texture. None, the
    default: no texture coordinates."""
    uv_stride: int
    """Bytes from one pair of texture coordinates to the next; at least 8, or 0, the default: packed."""
    triangle_count: int
    """Number of triangles, at least 1; default 0: the caller must set it."""
    indices: int
    """Vertex indices: three uint32_t per triangle, each less than vertex_count, counter-clockwise seen from the
    front; default None: the caller must set them."""
    index_stride: int
    """Bytes from one triangle to the next; at least 12, or 0, the default: packed."""
    colours: int
    """Colours of the vertices: red, green, blue and alpha as four floats per vertex, linear, each in [0, 1].
    They multiply the material's base colour and alpha. None, the default: no colours."""
    colour_stride: int
    """Bytes from one colour to the next; at least 16, or 0, the default: packed."""


class CameraParams(TypedDict, total=False):
    """A pinhole camera."""

    fov_y: float
    """Full vertical angle of view in radians, in [0.001, 3.1]; default 1."""
    position: Sequence[float]
    """Position of the eye in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0)."""
    target: Sequence[float]
    """Point that the camera looks at, in metres, each coordinate in [-1e15, 1e15], different from position;
    default (0, 0, -1)."""
    up: Sequence[float]
    """Up direction of the image, finite and not parallel to the viewing direction; default (0, 1, 0)."""


@dataclass(frozen=True)
class DistributionReport:
    """Summary of a luminous intensity distribution."""

    planes: int
    """Number of C planes, the half-planes through the axis in which the intensities are given. Planes that the
    file leaves out because of symmetry are included. A single plane holds for all directions around the
    axis."""
    angles: int
    """Number of vertical angles gamma in each C plane."""
    flux: float
    """Luminous flux in lumens: the integral of the intensity over all directions."""
    lamp_flux: float
    """Rated flux of the lamps in lumens; 0 if the file does not state it (absolute photometry)."""
    watts: float
    """Electric power in watts; 0 if unknown."""
    size: tuple[float, float, float]
    """Size of the luminous opening in metres: along C = 0°, along C = 90° and along the axis. As in IES files,
    negative values stand for a round opening: the absolute value is the diameter. IES files name the three
    values length, width and height; EULUMDAT and TM-33 files name them width, length and height."""
    temperature: float
    """Correlated colour temperature of the lamps in kelvin; 0 if unknown."""
    rendering: float
    """General colour rendering index Ra of the lamps; 0 if unknown."""
    variants: int
    """Number of variants of the product in a GLDF container; 1 for all other formats."""
    emitters: int
    """Number of emitters whose distributions were added up. For TM-33, it counts the emitters of the file; for
    GLDF, the emitters of the variant that was read. 1 for IES and EULUMDAT."""


class LightParams(TypedDict, total=False):
    """A punctual light."""

    kind: LightKind | str | int
    """Kind of the light: LightKind; default LightKind.POINT."""
    position: Sequence[float]
    """Position of a point or spot light, in metres, each coordinate in [-1e15, 1e15]; default (0, 0, 0)."""
    direction: Sequence[float]
    """Direction in which a spot or directional light shines; any length but 0; default (0, -1, 0)."""
    intensity: Sequence[float]
    """Strength of the light per channel, each in [0, 1e15]; default (1, 1, 1). For a point light it is the
    luminous intensity in cd; for a spot light, the luminous intensity in cd on its axis; for a directional
    light, the illuminance in lux on a surface that faces the light."""
    inner_angle: float
    """Half angle of the cone in which a spot light has its full intensity, in radians, in [0, outer_angle];
    default 0."""
    outer_angle: float
    """Half angle of the whole cone of a spot light, in radians, in (0, pi / 2]; default pi / 4. From
    inner_angle to outer_angle, the intensity falls smoothly to 0, as in glTF."""
    angular_diameter: float
    """Angle in radians under which the disc of a directional light is seen, in [0, pi / 2]; for the sun it is
    0.0093. The disc has uniform luminance; it casts soft shadows, and pictures and mirrors show it. 0, the
    default: parallel rays."""


class LuminaireParams(TypedDict, total=False):
    """Flux, position, orientation, colour and shape of a luminaire."""

    shape: LuminaireShape | str | int
    """From where the luminaire shines: LuminaireShape; default LuminaireShape.FACES."""
    flux: float
    """Luminous flux in lumens, finite and >= 0; 0, the default: the flux of the distribution."""
    position: Sequence[float]
    """Position of the centre of the luminous opening in metres, each coordinate in [-1e15, 1e15]; default (0,
    0, 0). Flat faces are moved outwards by at least 0.2 mm, so that a ceiling in the same plane does not hide
    them."""
    axis: Sequence[float]
    """Direction of the luminaire's axis, in which gamma is 0; any length but 0; default (0, -1, 0): it shines
    down."""
    c0: Sequence[float]
    """Direction of the half-plane C = 0; it must not be parallel to axis, and only its component perpendicular
    to axis counts. Default (1, 0, 0). For a luminaire that shines down, C grows anticlockwise as seen from
    above."""
    colour: Sequence[float]
    """Linear RGB colour of the light, each channel in [0, 1e15] and not all 0; only the ratio of the channels
    counts; default (1, 1, 1)."""


@dataclass(frozen=True)
class Ray:
    """A ray. Callers pass arrays of this struct, so its size and fields never change in later versions."""

    origin: tuple[float, float, float]
    """Start of the ray, in metres."""
    direction: tuple[float, float, float]
    """Direction of the ray; any length but 0. Its length is the unit of distances along the ray."""
    t_max: float
    """Maximum distance of a hit, in units of the length of direction; may be infinite. Only hits at distances
    in (0, t_max) count."""


@dataclass(frozen=True)
class Hit:
    """The nearest hit of a ray. Callers pass arrays of this struct, so its size and fields never change in
    later versions."""

    t: float
    """Distance of the hit in units of the length of the ray's direction; infinite for a miss."""
    mesh: int
    """Index of the mesh; LUXFER_NONE for a miss."""
    triangle: int
    """Index of the triangle in its mesh; LUXFER_NONE for a miss."""
    u: float
    """Barycentric coordinate of the hit for the triangle's second corner; 0 for a miss."""
    v: float
    """Barycentric coordinate of the hit for the triangle's third corner; 0 for a miss."""


@dataclass(frozen=True)
class Requirements:
    """Features that a scene requires of the renderer."""

    scattering: Scattering
    """Kinds of scattering that can occur: Scattering."""
    lights: Lights
    """Kinds of lights that emit: Lights."""
    textures: int
    """Number of textures that change the scattering, the emission or the normals of surfaces."""
    bounces: int
    """Number n of bounces that matter: the smallest positive integer with a^n <= error. Here a is the largest
    channel of the field albedo, and error is the argument of luxfer_scene_get_requirements. With error = 0.01,
    for example, light with more than n bounces is at most 1 % of all scattered light. 0 if there is no such n.
    For information only: no rendering ends paths at this number."""
    brightest_material: int
    """Index of the material with the largest albedo; LUXFER_NONE if there are no surfaces."""
    albedo: tuple[float, float, float]
    """Upper bound of the albedo of all surfaces, per channel, in [0, 1]. The albedo is the share of the
    received light that a surface reflects or transmits."""
    flat_triangles: int
    """Number of triangles with zero area, which are skipped."""


@dataclass(frozen=True)
class MeshInfo:
    """Sizes and attributes of a mesh."""

    material: int
    """Index of the mesh's material."""
    vertex_count: int
    """Number of vertices."""
    triangle_count: int
    """Number of triangles."""
    has_normals: int
    """1 if each vertex has a normal, 0 if triangles are shaded flat."""
    uv_sets: int
    """Bit 0 is set if the mesh has the first set of texture coordinates, bit 1 if it has the second set."""
    has_colours: int
    """1 if each vertex has a colour, else 0."""


@dataclass(frozen=True)
class Candidate:
    """A candidate for the ceiling: an object or a material of a scene."""

    kind: CandidateKind
    """Whether the candidate is an object or a material: CandidateKind."""
    index: int
    """Index of the object's first mesh in the scene, or index of the material."""
    area: float
    """Area of all triangles in m²."""
    level_area: float
    """Area in m² of the level triangles. A triangle is level if it faces up or down and is inclined by at most
    15 degrees to the horizontal."""
    height: float
    """Mean height (y coordinate) in metres, weighted by area, of the level triangles, or of all triangles if no
    triangle is level."""
    low: float
    """Height (y coordinate) of the lowest point, in metres."""
    high: float
    """Height (y coordinate) of the highest point, in metres."""
    normal: tuple[float, float, float]
    """Mean normal of the front sides of all triangles, weighted by area: a unit vector, or 0 if the normals
    cancel, as for a closed box."""
    score: float
    """Resemblance to a ceiling: s = (level_area / area) * min(1, level_area / F) * h², in [0, 1]. F is the
    floor area of the scene's bounding box in m², and h = (height - lowest y of the scene) / (height of the
    scene). A name with a word for a ceiling, such as "ceiling" or "Decke", raises the score to (1 + s) / 2,
    unless level_area is 0."""
    triangles: int
    """Number of triangles whose area is not 0."""
    name: str
    """Name of the object or material, in zero-terminated UTF-8. The string lives as long as the
    luxfer_candidates."""
    reason: str
    """The reason for the score: an English sentence that states area, level_area and height, and in percent the
    factors min(1, level_area / F) and h of the formula of the score; or that no triangle is level. It is zero-
    terminated UTF-8. The string lives as long as the luxfer_candidates."""


class RenderParams(TypedDict, total=False):
    """Settings of a rendering."""

    width: int
    """Width of the image in pixels, in [1, 65536]; default 1280."""
    height: int
    """Height of the image in pixels, in [1, 65536]; default 720."""
    samples: int
    """Paths per pixel, in [1, 1048576]; default 64. With a target error, rendering stops at the latest when the
    mean number of paths per pixel reaches this value."""
    target_error: float
    """Stop when RenderReport.error is at most this value, >= 0. With this target, paths go to the pixels where
    they reduce the error most. Default 0: no target."""
    time_budget_ms: int
    """Stop after this number of milliseconds; default 0: no limit."""
    seed: int
    """Seed of the paths; default 1."""
    pixel_error: float
    """Stop when the relative error of every block of 8 x 8 pixels is at most this value, >= 0; 0.1 means within
    10 % of the value, 19 times out of 20. Default 0: no target. A block receives at most 64 * samples paths per
    pixel (the field samples), even if it then misses the target. The relative error of a pixel is e / max(Y, m
    / 10). Here e is half the width of the 95 % confidence interval of the pixel's luminance Y, and m is the
    mean of the image. The relative error of a block is the root mean square over its pixels."""
    preview: float
    """Strength of the noise filter for RenderImage.PREVIEW, in [0, 10]; 1 is usual, larger values blur more.
    Default 0: no preview, as for final images. The preview does not change the other images. After a cancel, a
    rendering with a preview keeps all images of the last preview, because one more preview would take too
    long."""
    relative_error: float
    """Stop when RenderReport.relative_error is at most this value, >= 0. With this target, paths go to the
    pixels where they reduce this error most. In this error, noise in dark areas counts as much as noise in
    bright areas, as for the eye. Default 0: no target. With several targets, rendering stops when all targets
    are reached."""


@dataclass(frozen=True)
class RenderReport:
    """Quality of a rendering."""

    samples: int
    """Mean number of paths per pixel so far."""
    error: float
    """Root mean square of the standard errors of all pixels, divided by the image's mean; infinite while a
    pixel has fewer than two paths."""
    discarded: int
    """Number of paths that were discarded because their radiance was not finite."""
    preview_bias: float
    """Estimated bias of the preview. The bias of a block of 8 x 8 pixels is the expected value of the block's
    mean minus its true mean. This field is the root mean square of the bias over all blocks, divided by the
    image's mean. 0 without a preview."""
    relative_error: float
    """Root mean square, over all pixels, of the standard error divided by the pixel's value. The value is the
    mean of the pixel's channels, but at least a hundredth of the image's mean. Infinite while a pixel has fewer
    than two paths. With few paths this estimate is too high: with 8 paths by about a quarter."""
    preview_error: float
    """Estimated error of the preview, remaining noise and bias together: root mean square over pixels and
    channels, divided by the image's mean. Compare it with the field error, the error of the unfiltered image.
    Infinite while a pixel has fewer than four paths; 0 without a preview."""


class RectifyParams(TypedDict, total=False):
    """Settings of a rectification."""

    detector: Lines | str | int
    """Detector of lines: Lines; default Lines.REGIONS."""
    search: Search | str | int
    """Search for vanishing points: Search; default Search.MANHATTAN."""
    metric: Metric | str | int
    """Distance of a vanishing point from a line: Metric; default Metric.SEGMENT."""
    hough_band: float
    """For Lines.HOUGH: largest angle in radians between a pixel's gradient and the normal of a line for which
    the pixel votes, in [1e-4, pi/2]; default 0.0436, which is 2.5 degrees."""
    focal: float
    """Focal length in pixels, in [1e-3, 1e9]; 0, the default: estimated from the lines, and from the photo's
    metadata if it has any."""
    principal: Sequence[float]
    """Principal point in pixels, x and y in [-1e9, 1e9]; NaN, the default: the image's centre."""
    plane_axes: Sequence[int]
    """The two room axes that the plane spans, each 0, 1 or 2; -1, the default: estimated from the lines on the
    plane."""
    max_side: int
    """Maximum length of the longer side of the unwarped image in pixels, in [16, 16384]; default 2048. The
    image is smaller if the resolution of the photo does not support this size."""
    max_magnification: float
    """Limit of the magnification by unwarping, a ratio of lengths in (0, 1e6]; default 16. The farther a part
    of the plane is from the camera, the more its photo pixels are magnified. Parts that are magnified more than
    this factor times as much as the nearest part are cut off."""
    seed: int
    """Seed of the search; default 1."""
    distortion: float
    """Radial distortion of the lens to undo: the outward shift of the corners of the photo, as a share of their
    distance from its centre, in [-1, 0.2]; below 0 for barrel distortion, which wide-angle lenses have. NaN,
    the default: the distortion is measured. It is undone if it lies between -0.1 and -0.02, if its absolute
    value is at least two standard deviations, and if the lines meet better in vanishing points without it. 0:
    no distortion is undone."""


@dataclass(frozen=True)
class RectifyReport:
    """The camera found from the lines of a photo, and the unwarping of the plane."""

    segments: int
    """Number of line segments found."""
    vanishing_points: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    """Vanishing points of the room axes, in homogeneous pixel coordinates of unit length; the third coordinate
    is 0 at infinity. If a distortion was undone, they lie in the photo that luxfer_rectify_undistort makes."""
    vanishing_errors: tuple[float, float, float]
    """Standard deviation of the direction to each vanishing point in camera space, in radians."""
    vanishing_support: tuple[int, int, int]
    """Number of segments that run to each vanishing point; 0: no segment runs to the point, which is then
    derived from the other vanishing points, or from the assumption that the camera is upright."""
    focal_source: FocalSource
    """Source of the focal length: FocalSource."""
    focal: float
    """Focal length in pixels."""
    principal: tuple[float, float]
    """Principal point in pixels."""
    axes: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    """Room axes as unit vectors in camera space: axis 0 points right, axis 1 down, axis 2 forward."""
    is_unwarped: int
    """1 if the plane has been unwarped; 0 if not: the fields from to_photo to aspect_confidence are then 0."""
    to_photo: tuple[float, ...]
    """Homography from unwarped pixels to photo pixels: a 3 x 3 matrix, row by row. With it, luxfer_image_warp
    unwarps other images of the photo's size, such as the confidence of the lights. If a distortion was undone,
    it leads to the pixels of the photo that luxfer_rectify_undistort makes; undistort the other images
    first."""
    corners: tuple[tuple[float, float], tuple[float, float], tuple[float, float], tuple[float, float]]
    """Corners of the unwarped rectangle in the photo, x and y in pixels: top left, then clockwise."""
    corner_errors: tuple[float, float, float, float]
    """Expected error of each corner, in unwarped pixels."""
    pixel_size: float
    """Length of an unwarped pixel's side on the plane, divided by the camera's distance from the plane."""
    aspect_confidence: float
    """Confidence of the aspect ratio, 1 / (1 + (s / 0.1)²), where s is its relative standard deviation; in [0,
    1]. It is low if the focal length was assumed."""
    distortion: float
    """Lens distortion: the outward shift of the corners of the photo, as a share of their distance from its
    centre; below 0 for barrel distortion, which wide-angle lenses have. It is estimated from the curvature of
    straight edges. NaN if the photo has too few lines."""
    distortion_error: float
    """Standard deviation of the field distortion; NaN if distortion is NaN."""
    squareness: tuple[float, float, float]
    """For each axis, the angle between the two other axes minus 90 degrees, in radians. For this angle, each of
    the two axes is estimated only from the lines that run along that axis; the vectors of the field axes, in
    contrast, are always orthogonal. The value differs from 0 if walls are oblique, pixels are not square or the
    principal point is wrong. NaN if one of the two axes has no lines."""
    squareness_errors: tuple[float, float, float]
    """Standard deviations of the field squareness; NaN where squareness is NaN."""
    undone: float
    """The distortion that was undone, in the unit of the field distortion; 0 if no distortion was undone. It
    equals RectifyParams.distortion or, if that is NaN, the measured distortion."""


class FeaturesParams(TypedDict, total=False):
    """Settings of the features."""

    near_plane: float
    """Distance of the near plane, where the depth channel is 0, in [1e-3, 1e3]; default 1. All depths are
    multiplied by one factor, so that the nearest part of the photo (the 2 % quantile of its depths) lies on
    this plane. The unit of length is therefore arbitrary."""
    far_plane: float
    """Distance of the far plane, where the depth channel is 1, in the unit of near_plane and in [1.001, 1e6]
    times near_plane; default 10."""
    normal_radius: int
    """Half the width, in pixels, of the square window around a pixel in which a plane is fitted to find the
    normal of the pixel; in [0, 64]. 0, the default: 1 % of the photo's width, but at least 2 and at most 64."""


@dataclass(frozen=True)
class FeaturesReport:
    """Quality of the features."""

    depth_source: DepthSource
    """Source of the depth: DepthSource."""
    depth_confidence: float
    """Mean confidence of the depth, in [0, 1]."""
    replaced_pixels: int
    """Number of pixels of the photo that were NaN, infinite or negative and were replaced by values of their
    neighbours."""


class SegmentParams(TypedDict, total=False):
    """Settings of a segmentation."""

    samples_per_class: int
    """Maximum number of pixels that are drawn as samples from the strokes of each class, in [1, 1000000];
    default 1000."""
    channels: int
    """Channels of the features to use, bit i for channel i; default 0. With the ten channels of
    luxfer_features, 0 tries four sets (colour; colour and position; colour and normal; all channels) and uses
    the set with the smallest error on held-out strokes. Sets with position are left out if the mask will be
    restricted to a wall, floor or ceiling of a room that was fitted as a box. With another number of channels,
    0 uses all channels. If you segment lights as Subject.SURFACE, use 7 (colour only), since lights and their
    plane have the same geometry."""
    refine_radius: int
    """Half-width in pixels of the windows of an edge-aware refinement, in [0, 1024]; 0, the default: no
    refinement. The refinement makes the mask follow the edges of the photo: it is a guided filter with the
    first three channels of the features as guide."""
    ridge: float
    """Strength of the prior that keeps the weights of the classifier small (ridge regression), in [1e-9, 1e3];
    default 1e-3."""
    seed: int
    """Seed of the samples that are drawn; default 1."""
    refine_tolerance: float
    """Smallest contrast that the refinement by refine_radius follows. In windows in which the standard
    deviation of the first three channels is below this value, the refinement smooths the mask; in other
    windows, the mask follows the edges. In the unit of these channels (CIELAB units for colour), in [1e-3,
    1e6]; default 8. No effect if refine_radius is 0."""
    subject: Subject | str | int
    """Kind of object that the positive strokes mark: Subject; default Subject.AUTO. If the subject is lamps,
    the settings above have no effect."""


@dataclass(frozen=True)
class SegmentReport:
    """Quality of a segmentation."""

    channels: int
    """Channels of the features that the segmentation has used, bit i for channel i."""
    error: float
    """Expected share of wrong pixels, in [0, 1]. For a surface, it is estimated on strokes held out of the
    training. For lamps, it is the area of the lamps, times the share of wrong pixels that is usual in such
    lamps, divided by the area of the mask of luxfer_segment_set_region or, without this mask, of the photo."""
    negative_samples: int
    """Number of samples of the negative class."""
    positive_samples: int
    """Number of samples of the positive class."""
    contradictory_pixels: int
    """Number of pixels that strokes of both classes cover. Such a pixel belongs to the later stroke."""


class EmissionParams(TypedDict, total=False):
    """Settings of an emissive texture."""

    width: int
    """Width of the texture in texels, in [1, 65536]; default 1024."""
    height: int
    """Height of the texture in texels, in [1, 65536]; default 1024."""
    block: int
    """Side of the square patches that are copied from the exemplar, in [0, 65536], in pixels of the exemplar
    after its reduction to working_side. 0, the default: with EmissionLaw.LATTICE, 1.5 times the longer period,
    but at most half of the exemplar's shorter side; with other laws, a quarter of the shorter side."""
    scale: float
    """Number of unwarped pixels per texel, along one side, in [1e-3, 1e3]; default 1."""
    working_side: int
    """Length in pixels to which the longest side of the exemplar is reduced for the synthesis, in [16, 2048];
    default 256."""
    guide_weight: float
    """Weight of the guide channels (EmissionImage.EXEMPLAR_GUIDES) relative to colour when patches are
    compared, in [0, 1e3]; default 1. 0: patches are compared by colour only, as in image quilting."""
    seed: int
    """Seed of the synthesis; default 1."""
    min_regularity: float
    """Threshold of EmissionLaw.CORRELATION, in [0, 1]; default 0.6. A shift counts as a period of the lights if
    their autocorrelation after this shift is at least this value. At 0, even a poor repetition counts.
    EmissionLaw.BEST also tries periods with a lower autocorrelation. At 1, both choose EmissionLaw.FREE."""
    whole_lamps: int
    """1, the default: every lamp of the texture stays in one piece; 0: seams between patches may cut lamps."""
    offset: Sequence[float]
    """Offset of the pattern from the texture's top-left corner, in texels to the right and down, each in [-1e6,
    1e6]; default 0. EmissionLaw.FREE has no lattice that an offset could shift: with this law, an offset other
    than 0 ends the job with Status.INVALID_ARGUMENT. There are two exceptions. If the texture is tileable and
    no light is copied patch by patch (luxfer_emission_get_luminaire says which lights are), the offset shifts
    all lamps. With whole_lamps = 0, the offset has no effect."""
    clip_level: float
    """A channel of the photo counts as clipped if it is at least this value, in [0, 1]; default 0.95. The
    clipped core of a lamp gets the colour of the lamp's rim, at the lowest brightness that is consistent with
    the clipped channels. 0: no lamp counts as clipped."""
    even_lamps: int
    """1: every lamp has its mean colour over its whole area; 0, the default: lamps look as in the photo."""
    tileable: int
    """1: the texture can be repeated without seams. Lamps that cross an edge of the texture continue at the
    opposite edge. Lights with periods are stretched so that a whole number of periods fits; the width and the
    height of the pattern change by less than half a period. Needs whole_lamps = 1, or else the job ends with
    Status.INVALID_ARGUMENT. Default 0."""
    centred: int
    """Whether the pattern is centred on the texture. A lamp, or the middle between two or four neighbouring
    lamps, then lies at the texture's centre, whichever lets the border cut the fewest lamps, and the field
    offset shifts the pattern from there. 0: not centred. 1: centred. 2, the default: centred if the texture is
    larger than what the photo shows of the plane; but not if it is tileable, or if the photo shows both ends of
    a row of lamps. No effect with EmissionLaw.FREE."""
    candidates: int
    """For EmissionLaw.FREE: number of patches, drawn at random from the exemplar, that are compared for each
    patch of the texture; in [1, 65536]; default 192. Patches of the exemplar that continue the neighbours
    already placed in the texture are compared in addition."""
    law: EmissionLaw | str | int
    """The law: the rule by which the texture continues the lights of the exemplar, EmissionLaw other than
    EmissionLaw.COPY; default EmissionLaw.BEST."""
    clean_lamps: int
    """1, the default: all lamps of one kind (of about equal size and shape) that resemble rectangles or
    ellipses, or frames or rings, are drawn with one size and one outline, which stays sharp at any resolution.
    They lie exactly on their lattice. This needs the photo and whole_lamps. 0: each lamp has the outline that
    the mask gives."""
    max_magnification: float
    """Maximum relative magnification of the exemplar's pixels, in [1, 1e6]; 0, the default: no limit. Unwarping
    magnifies distant parts of the plane more than near parts. The magnification of a pixel is its length in the
    unwarped photo divided by its length in the photo; the relative magnification is the magnification of the
    pixel divided by the magnification of the least magnified pixel of the exemplar. Pixels beyond the limit are
    left out, as if the photo did not show them."""


@dataclass(frozen=True)
class EmissionReport:
    """Description of a texture: its lamps, the law (rule) by which it continues the exemplar's lights, and its
    quality. A composition (luxfer_emission_start_composition) has no texels yet, so its error is NaN and its
    sampling_error is 0. If there are several exemplars, the fields regularity, law, runner_up, law_score and
    margin describe the first exemplar."""

    luminaires: int
    """Number of luminaires in the texture; see luxfer_emission_get_luminaire."""
    error: float
    """Largest relative difference between texture and exemplar in three statistics: the share of lit area, the
    mean area of a whole lamp, and the mean distance from a whole lamp to its nearest neighbour. The value 0.1
    stands for 10 %. It means little if exemplar_lamps is small. NaN for a composition."""
    regularity: float
    """Regularity of the lights, in [0, 1]: their autocorrelation after a shift by one period. If there are two
    periods, it is the lower of their two autocorrelations. 0 if the lights have no period, or if the period was
    found from the distances between lamps."""
    exemplar_lamps: int
    """Number of whole lamps in the exemplars. If it is below six, the statistics in the field error are
    unreliable, because the border then cuts a large share of the lamps. If there is no whole lamp, the texture
    is made from the lamps that the border cuts; with clean_lamps, they are completed to rectangles unless the
    photo contradicts this."""
    sampling_error: float
    """Estimate of the value that the field error takes by chance, because the exemplar shows only a part of its
    ceiling. It is the root mean square difference between the three statistics of the whole texture and the
    statistics of parts of the texture that are as large as the exemplar. If error is at most twice this value,
    it does not indicate a bad texture. 0 for EmissionLaw.WHOLE and EmissionLaw.COPY, for several exemplars, for
    a composition, and if the texture is too small to hold parts as large as the exemplar at clearly different
    places."""
    law: EmissionLaw
    """The law (rule) by which the texture continues the lights: EmissionLaw."""
    runner_up: EmissionLaw
    """The law with the best score among the laws that were not chosen: EmissionLaw. It equals the field law if
    the two laws differ only in their periods, or if no other law was compared."""
    law_score: float
    """Score of the chosen law, in [0, 1]: how well it predicts the position of each lamp of the photo from the
    other lamps. Lamps weigh in proportion to their pixels in the photo. EmissionLaw.WHOLE and EmissionLaw.FREE
    predict nothing and have a fixed score. NaN if no score was computed, for example because too few of the
    lights are whole lamps."""
    margin: float
    """law_score minus the score of runner_up; law_score alone if no other law was compared; NaN if law_score is
    NaN. EmissionLaw.BEST prefers the law that EmissionLaw.CORRELATION would choose, and lattices along the axes
    of the room. If it has kept a preferred law although runner_up scores slightly better, the value is
    negative."""


@dataclass(frozen=True)
class Luminaire:
    """A luminaire: one lamp of the texture."""

    corners: int
    """Number of corners of the outer outline."""
    centre: tuple[float, float]
    """Centre in texels, x to the right and y down; the texture's top-left corner is (0, 0)."""
    size: tuple[float, float]
    """Extents of the lamp along its two principal axes, in texels, the longer one first."""
    orientation: float
    """Angle of the long axis, measured from x (right) towards y (down), in radians, in (-pi/2, pi/2]."""
    area: float
    """Area in square texels, without the hole of a ring. A texel at the edge of the lamp counts with the share
    that the lamp covers."""
    flux_share: float
    """This lamp's share of the luminous flux of all lamps of the texture, in [0, 1]."""
    colour: tuple[float, float, float]
    """Mean linear RGB colour, where 1 is the photo's white."""
    kind: int
    """Number of the lamp's kind, from 1. Lamps of about equal size and shape, whose areas and sides differ by
    at most 25 %, are of one kind; kind 1 has the most lamps. 0 if the border of the texture cuts the lamp."""


class RelightParams(TypedDict, total=False):
    """Settings of a relighting."""

    quantity: Quantity | str | int
    """Quantity to match: Quantity; default Quantity.OUTGOING."""
    paths: int
    """Maximum number of paths, in [1024, 2^30]; default 2^20."""
    target_error: float
    """Stop when RelightReport.error is at most this value, in [0, 1]; default 0.01; 0: do not stop for this
    reason."""
    time_budget_ms: int
    """Stop after this number of milliseconds; default 0: no limit."""
    fit: Fit | str | int
    """How the light of the target is compared with its target value: Fit; default Fit.MEAN."""
    seed: int
    """Seed of the paths; default 1."""


@dataclass(frozen=True)
class RelightReport:
    """The solution of a relighting and its confidence."""

    paths: int
    """Number of traced paths."""
    scale: tuple[float, float, float]
    """Factor for the emission, per channel, >= 0."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of the field scale."""
    response: tuple[float, float, float]
    """Mean radiance of the target from the emission at scale 1, in cd/m² per channel."""
    background: tuple[float, float, float]
    """Mean radiance of the target from all other light, in cd/m² per channel."""
    outcome: tuple[Outcome, Outcome, Outcome]
    """Whether each channel meets its target: Outcome."""
    error: float
    """The largest relative half-width (half_width / scale) among the channels that meet their target; 0 without
    such channels."""
    delta_e: float
    """Uncertainty of the target's colour under the solution. With a probability of 95 %, the CIEDE2000
    difference between the actual and the wanted colour is below this value. Both colours are taken at the
    exposure that shows the target as middle grey."""


class PatternParams(TypedDict, total=False):
    """Layout of the light pattern on a surface; Surface gives the corner and the axes u and v of the
    surface."""

    scale: PatternScale | str | int
    """The length that sets the size of the pattern: PatternScale; default PatternScale.DISTANCE."""
    length: float
    """Length of a lamp for PatternScale.LAMP, or spacing of the lamps for PatternScale.SPACING, in metres, in
    [1e-6, 1e6]; default 1. Other values of scale do not use it."""
    texel_size: float
    """Side of a texel in metres, in [0, 1e6]. 0, the default: the size of an unwarped pixel on the surface, or
    a larger size if the texture would otherwise exceed max_texels of TransferParams. With a size at which the
    texture exceeds max_texels, the job ends with Status.INVALID_ARGUMENT."""
    rotation: float
    """Rotation of the pattern from u towards v in radians, in [-2 pi, 2 pi]; default 0."""
    offset: Sequence[float]
    """Shift of the pattern in metres, along u and v after their rotation by the field rotation; each in [-1e6,
    1e6]; default 0. With EmissionLaw.FREE, the shift must be 0, unless EmissionParams.offset allows another
    value."""
    margin: float
    """Minimum distance in metres of lamps from the edge of the surface and from the zones of
    luxfer_transfer_set_zones, in [-1, 1e6]; lamps that are nearer are left out. With a value below 0, such as
    the default -1, only lamps that touch a zone are left out, and the edge of the surface cuts lamps."""


class TransferParams(TypedDict, total=False):
    """Settings of a transfer. The library reads the structs to which the pointers lead only during the call
    that gets the settings."""

    max_texels: int
    """Maximum length of the longer side of the emissive texture in texels, in [1, 16384]; default 2048."""
    plane_distance: float
    """Distance in metres of the photo's camera from the plane with the lights, in [0.01, 1e4]. With
    PatternScale.DISTANCE, it sets the scale of the pattern. 0, the default: estimated from the size of the
    lamps, which are mostly made to fit ceiling tiles. TransferReport states the distance and its error."""
    white_luminance: float
    """Luminance in cd/m² of the photo's white (value 1), in [1e-6, 1e9]; default 100, the luminance of matt
    white paper in 314 lux. The strength of the lamps is proportional to it. A photo alone does not determine
    this luminance: see proposed_white of TransferReport."""
    target: Target | str | int
    """Part of the photo whose mean colour is matched: Target; default Target.SURFACE."""
    rectify: RectifyParams
    """Settings of the stages VIEW and UNWARP; None, the default: the defaults of RectifyParams."""
    features: FeaturesParams
    """Settings of the stage FEATURES; None, the default: the defaults of FeaturesParams."""
    plane: SegmentParams
    """Settings of the stage PLANE; None, the default: the defaults of SegmentParams."""
    lights: SegmentParams
    """Settings of the stage LIGHTS; None, the default: the defaults of SegmentParams, but channels = 7, colour
    only."""
    emission: EmissionParams
    """Settings of the stage EMISSION; None, the default: the defaults of EmissionParams. The transfer sets
    width, height, scale and offset itself."""
    relight: RelightParams
    """Settings of the stage RELIGHT; None, the default: the defaults of RelightParams."""
    render: RenderParams
    """Settings of the stage RENDER; None, the default: the defaults of RenderParams."""
    pattern: PatternParams
    """Layout of the lights on the surface; None, the default: the defaults of PatternParams."""


@dataclass(frozen=True)
class TransferReport:
    """Time and error of each stage. The error of a stage without a result is NaN."""

    fixtures: int
    """Number of fixtures (lamps of the lit scene); see luxfer_transfer_get_fixture. 0 before the stage RELIGHT
    has ended."""
    seconds: tuple[float, ...]
    """Duration of each stage's last run in seconds, 0 without a run; the index is the Stage."""
    view_error: float
    """Largest standard deviation of the directions of the vanishing points, in radians."""
    depth_confidence: float
    """Mean confidence of the depth in the features, in [0, 1]."""
    plane_error: float
    """Expected share of wrong pixels in the mask of the plane, in [0, 1]."""
    lights_error: float
    """Expected share of wrong pixels in the mask of the lights, in [0, 1]."""
    unwarp_error: float
    """Largest expected error of a corner of the unwarped image, in unwarped pixels."""
    emission_error: float
    """EmissionReport.error: largest relative difference between texture and photo in the lit share, the size or
    the spacing of their lamps."""
    relight_error: float
    """RelightReport.error: largest relative half-width of the solution's 95 % confidence intervals."""
    render_error: float
    """RenderReport.error: root mean square of the rendering's standard errors, divided by its mean."""
    texel_size: float
    """Length of a texel's side on the surface, in metres."""
    target: tuple[float, float, float]
    """Mean colour that the surface should have: linear RGB, where 1 is the photo's white."""
    plane_distance: float
    """Distance in metres of the photo's camera from the plane with the lights. Seen from this distance, the
    lamps on the surface of the scene look as large as the lamps in the photo. NaN before the stage EMISSION has
    ended, and if the caller gave the texture."""
    plane_distance_error: float
    """Relative standard deviation of plane_distance. If the distance is estimated from the size of the lamps,
    it is about 0.25 for lamps of a usual size, and 0.6 if the lamps do not determine it. 0 if the settings
    determine the distance."""
    proposed_white: float
    """Value proposed for TransferParams.white_luminance in cd/m²: the white_luminance of PhotoMetadata if the
    photo's file states the exposure, else 159, the luminance of white paper in the 500 lux of an office."""
    proposed_white_low: float
    """Lower bound of proposed_white in cd/m²: white_luminance_low if the photo's file states the exposure, else
    32, the luminance of white paper in the 100 lux of a corridor."""
    proposed_white_high: float
    """Upper bound of proposed_white in cd/m²: white_luminance_high if the photo's file states the exposure,
    else 318, the luminance of white paper in 1000 lux."""
    preview_error: float
    """RenderReport.preview_error: estimated error of TransferImage.RENDER_PREVIEW, divided by the image's mean.
    NaN without this image."""


@dataclass(frozen=True)
class Fixture:
    """One lamp of the lit scene."""

    position: tuple[float, float, float]
    """Centre of the lamp in metres."""
    normal: tuple[float, float, float]
    """Unit vector of the direction in which the lamp shines."""
    axis: tuple[float, float, float]
    """Unit vector along the lamp's long axis."""
    radiance: tuple[float, float, float]
    """Mean emission of the lamp: linear RGB in cd/m²."""
    kind: int
    """Number of the lamp's kind, from 1, as in Luminaire.kind; 0 if the border of the texture cuts the lamp."""
    size: tuple[float, float]
    """Lengths of the lamp along its long axis and across it, in metres."""
    area: float
    """Area in m²."""
    flux: float
    """Luminous flux in lumens: pi * luminance * area, since the lamp is Lambertian."""
    cct: float
    """Correlated colour temperature of the light in kelvin; 0 for a lamp that is off."""
    duv: float
    """Signed distance of the light from the blackbody locus in the CIE 1960 diagram: positive for greenish
    light, negative for pinkish light."""


@dataclass(frozen=True)
class Warning:
    """A warning: a reason to doubt a result."""

    code: WarningCode
    """Kind of the warning: WarningCode."""
    stage: Stage
    """The stage whose result is in doubt: Stage. For a luxfer_segment it is Stage.LIGHTS if
    luxfer_segment_set_region gave a mask, else Stage.PLANE; for a luxfer_scene, and for the scene of a
    luxfer_transfer, it is Stage.SCENE; for a luxfer_guides or a luxfer_stylize it is Stage.STYLIZE."""
    has_place: int
    """1 if the warning points to a place, else 0."""
    severity: float
    """The number that caused the warning; the comment of the WarningCode in the field code says what this
    number measures."""
    limit: float
    """The limit that the severity has passed: an upper limit, unless the comment of the WarningCode says that
    the severity is below the limit."""
    place: tuple[float, float]
    """The place, x and y in pixels of the photo; for a luxfer_guides or a luxfer_stylize, in pixels of the
    target or, where the comment of the WarningCode says so, of the artwork. 0 if the warning has no place."""
    message: str
    """The defect: an English sentence, which for most warnings states the value of severity, in zero-terminated
    UTF-8. The string lives as long as the luxfer_warnings."""
    advice: str
    """The remedy: an English sentence in zero-terminated UTF-8. The string lives as long as the
    luxfer_warnings."""


class IlluminanceGrid(TypedDict, total=False):
    """A calculation grid: a parallelogram of columns x rows cells, with a point at the centre of each cell. The
    default is a square metre at the origin that faces up."""

    origin: Sequence[float]
    """Corner of the grid, in metres; default (0, 0, 0)."""
    across: Sequence[float]
    """First edge of the grid, a vector from origin in metres; it is divided into columns. Default (1, 0, 0)."""
    down: Sequence[float]
    """Second edge of the grid, a vector from origin in metres; it is divided into rows. Default (0, 0, 1)."""
    normal: Sequence[float]
    """Normal of the side that receives the light; any length but 0; default (0, 1, 0)."""


class IlluminanceParams(TypedDict, total=False):
    """Settings of an illuminance calculation."""

    columns: int
    """Number of points along the first edge of a grid, or along u of a mesh, in [1, 65536]; default 32."""
    rows: int
    """Number of points along the second edge of a grid, or along v of a mesh, in [1, 65536]; default 32."""
    samples: int
    """Paths per point, in [16, 16777216], rounded up to a multiple of 16; default 1024."""
    seed: int
    """Seed of the paths; default 1."""


@dataclass(frozen=True)
class IlluminanceReport:
    """Summary of the illuminance, in lux."""

    points: int
    """Number of points with a value: on a mesh, the number of texels that the mesh covers. If it is 0, the
    other values are 0."""
    minimum: float
    """Smallest illuminance. The uniformity U0 is minimum / mean."""
    mean: float
    """Mean illuminance."""
    maximum: float
    """Largest illuminance."""
    mean_error: float
    """Standard error of the mean."""


class LampsParams(TypedDict, total=False):
    """Settings of the solver for lamps."""

    group: Group | str | int
    """Lamps that share one power: Group; default Group.EACH."""
    row_tolerance: float
    """Largest gap between neighbouring lamps in one row, for Group.BY_X, _Y and _Z: the difference of the
    coordinates by which the lamps are grouped, in metres or as a texture coordinate, >= 0; default 0.01. A
    larger gap starts a new row."""
    free_colour: int
    """1: solve for one power for each colour channel of a group. All goals must then come from
    luxfer_lamps_add_mesh, because luxfer_lamps_add_grid states no channels. 0, the default: solve for one power
    for all channels of a group, which keeps the colour."""
    max_scale: float
    """Largest power of a group, that is, the largest factor for its emission, >= 0; default infinity."""
    regularisation: float
    """Weight of the regularisation, which pulls all powers towards the equal power that meets the goals best,
    in [1e-9, 1e3]; default 1e-6. With a small weight the goals are met, with a large weight the powers are
    nearly equal."""
    tolerance: float
    """Tolerance of the goals, in [1e-6, 1]; default 0.01. A goal counts as met if its light misses the target
    by at most tolerance times the target's brightest channel, plus the half-width of the 95 % confidence
    interval of the light."""
    paths: int
    """Maximum number of paths for each goal, in [1024, 2^30]; default 2^20."""
    target_error: float
    """Stop tracing when, for every goal, the light from all lamps together is known to this relative error, in
    [0, 1]; default 0.01; 0: do not stop for this reason. The error is the half-width of the 95 % confidence
    interval divided by the mean, in the worst channel."""
    time_budget_ms: int
    """Stop tracing after this number of milliseconds; default 0: no limit."""
    seed: int
    """Seed of the paths; default 1."""


@dataclass(frozen=True)
class LampsReport:
    """Summary of the solution for lamps."""

    lamps: int
    """Number of lamps."""
    groups: int
    """Number of groups."""
    goals: int
    """Number of goals."""
    paths: int
    """Number of paths traced for each goal."""
    all_goals_satisfied: int
    """1 if all goals of positive weight are met, else 0: luxfer_lamps_get_reason then gives the reason."""


@dataclass(frozen=True)
class Lamp:
    """The solution for one lamp."""

    group: int
    """Index of the group that the lamp belongs to."""
    centre: tuple[float, float, float]
    """Centre of the lamp: (u, v, 0) in texture coordinates if the emission has a texture, else the position in
    metres; 0 for directional lights."""
    scale: tuple[float, float, float]
    """Factor for the lamp's emission, per channel, >= 0."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of the field scale."""


@dataclass(frozen=True)
class LampsGoal:
    """The light that the surface or grid of one goal receives with the powers found."""

    outcome: tuple[Outcome, Outcome, Outcome]
    """Whether each channel meets its target: Outcome."""
    target: tuple[float, float, float]
    """Target: the mean radiance that the goal's surface should have, in cd/m² per channel. For a grid, it is
    the wanted illuminance divided by pi."""
    achieved: tuple[float, float, float]
    """Mean radiance of the goal's surface with the powers found, in cd/m² per channel."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of the field achieved, in cd/m²."""
    background: tuple[float, float, float]
    """Mean radiance of the goal's surface from all light but the lamps, in cd/m² per channel."""
    target_lux: float
    """Target in lux: pi times the luminance of the field target. This field and the three fields below are set
    only for goals of illuminance: grids, and meshes with Quantity.INCIDENT. They are 0 for other goals."""
    achieved_lux: float
    """Illuminance with the powers found, in lux."""
    half_width_lux: float
    """Half-width of the 95 % confidence interval of achieved_lux, in lux. It is an upper bound, computed as if
    the errors of all channels had the same sign."""
    background_lux: float
    """Illuminance from all light but the lamps, in lux."""


@dataclass(frozen=True)
class LampsResponse:
    """The light that the surface or grid of one goal receives from one lamp."""

    mean: tuple[float, float, float]
    """Mean radiance of the goal's surface from the lamp at scale 1, in cd/m² per channel."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of the field mean, per channel, in cd/m²."""


class ImportanceParams(TypedDict, total=False):
    """Settings of an importance map."""

    width: int
    """Number of cells of the map along the texture coordinate u of the surface, in [1, 512]; default 64."""
    height: int
    """Number of cells of the map along the texture coordinate v of the surface, in [1, 512]; default 64."""
    quantity: Quantity | str | int
    """Quantity of the target that the map predicts: Quantity; default Quantity.OUTGOING."""
    paths: int
    """Maximum number of paths, in [1024, 2^30]; default 2^20."""
    target_error: float
    """Stop when the light that the target would receive from a uniform emission is known to this relative
    error, in [0, 1]; default 0.01; 0: do not stop for this reason. The error is the half-width of the 95 %
    confidence interval divided by the mean, in the worst channel."""
    time_budget_ms: int
    """Stop after this number of milliseconds; default 0: no limit."""
    seed: int
    """Seed of the paths; default 1."""


@dataclass(frozen=True)
class ImportanceReport:
    """The light that the target receives from a texture: the result of luxfer_importance_respond."""

    paths: int
    """Number of paths that were traced for the map."""
    response: tuple[float, float, float]
    """Mean radiance of the target from the texture alone, in cd/m² per channel."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of the field response, in cd/m²."""
    resolution_difference: tuple[float, float, float]
    """The result for a map whose cells are twice as wide and high, minus the value in response, in cd/m² per
    channel. About a third of this difference is the error of response that comes from the size of the cells.
    The difference also contains noise."""


class PlacementParams(TypedDict, total=False):
    """Objective and bounds of a placement. A placement scales the texture coordinates of the surface about
    their centre (0.5, 0.5), then rotates them about this centre, and then shifts them."""

    aim: Aim | str | int
    """Objective: Aim; default Aim.MAX_LUMINANCE."""
    radiance: Sequence[float]
    """Wanted mean radiance of the target for Aim.RADIANCE, in cd/m² per channel, each finite and >= 0; default
    0."""
    starts: int
    """Number of placements that are tried first, in [1, 4096]; default 64. The search then descends from the
    best of these placements."""
    min_offset: Sequence[float]
    """Smallest offset along u and v of the texture, in periods of the texture, in [-16, 16]; default -0.5."""
    max_offset: Sequence[float]
    """Largest offset along u and v, in periods, in [-16, 16]; default 0.5. A range of one period, such as the
    default, allows every offset. If min_offset and max_offset are equal, the offset is fixed; in the same way,
    equal bounds fix the scale and the rotation."""
    min_scale: Sequence[float]
    """Smallest number of repetitions of the texture along the surface's u and v, in [1/64, 64]; default 1."""
    max_scale: Sequence[float]
    """Largest number of repetitions along u and v, in [1/64, 64]; default 1."""
    min_rotation: float
    """Smallest rotation of the texture coordinates from u towards v in radians, in [-2 pi, 2 pi]; default 0."""
    max_rotation: float
    """Largest rotation in radians, in [-2 pi, 2 pi]; default 0."""
    seed: int
    """Seed of the starting placements; default 1."""


@dataclass(frozen=True)
class Placement:
    """The best placement, and the light that the target then receives."""

    placement: tuple[float, ...]
    """The placement of the texture on the surface: a 3 x 3 matrix, row by row, like the argument placement of
    luxfer_importance_respond."""
    offset: tuple[float, float]
    """Offset of the placement along u and v of the texture, in periods."""
    scale: tuple[float, float]
    """Number of repetitions of the texture along u and v of the surface."""
    rotation: float
    """Rotation of the placement in radians, from u towards v."""
    response: tuple[float, float, float]
    """Mean radiance of the target from the texture alone, in cd/m² per channel."""
    half_width: tuple[float, float, float]
    """Half-widths of the 95 % confidence intervals of the field response, in cd/m²."""
    resolution_difference: tuple[float, float, float]
    """The result for a map whose cells are twice as wide and high, minus the value in response, in cd/m² per
    channel. About a third of this difference is the error of response that comes from the size of the cells.
    The difference also contains noise."""


@dataclass(frozen=True)
class GlareReport:
    """The glare of a view: the result of luxfer_image_get_glare."""

    sources: int
    """Number of glare sources."""
    ugr: float
    """Unified glare rating (CIE 117): below 10 the glare causes no discomfort; 19 is the limit for offices;
    -infinity without sources."""
    background: float
    """Background luminance of the rating in cd/m²: the mean over the pixels that are not glare sources,
    weighted by their contribution to the illuminance at the eye."""
    threshold: float
    """The threshold that was used: pixels of at least this luminance in cd/m² counted as glare sources."""
    solid_angle: float
    """Solid angle of all sources in steradians."""
    unseen_lights: int
    """Number of lights of the rendered scene that shine from points: point lights, spot lights, and luminaires
    without luminous opening. They are invisible in the image, and ugr leaves them out. Known only for images of
    luxfer_render_get_image and luxfer_render_get_layer; 0 for other images. If these lights include luminaires,
    the scene has WarningCode.NOT_IN_PICTURE."""
    dgp: float
    """Daylight glare probability (Wienold and Christoffersen 2006), at most 1: 5.87e-5 E + 0.0918 log10(1 + sum
    of L² w / (E^1.87 p²)) + 0.16, with the vertical illuminance E in lux and the luminance L, solid angle w and
    position index p of each source. Below 0.35 glare is imperceptible; above 0.45 it is intolerable. The
    formula was found for values from 0.2 to 0.8 and E of at least 380 lux."""
    vertical_illuminance: float
    """Illuminance in lux at the eye, on a plane across the line of sight, from which dgp was computed: the
    setting vertical_illuminance of GlareParams or, if that is 0, the illuminance from all pixels of the image.
    The latter is too low, and dgp wrong, if the image does not show the whole half-space ahead."""
    dgp_low_light: float
    """The field dgp corrected for low light, as versions 1 and 2 of evalglare do: below 1000 lux, it is
    multiplied by 1 / (1 + exp(4 - 0.024 E))."""


class GlareParams(TypedDict, total=False):
    """Settings of the glare rating of an image."""

    projection: Projection | str | int
    """Projection of the image: Projection; default Projection.PERSPECTIVE."""
    fov_y: float
    """Vertical angle of view of the image in radians, in [0.001, pi - 0.001]; with Projection.ANGULAR in
    [0.001, 2 pi]; default pi / 2. Pixels that are a right angle or more away from the line of sight do not
    count."""
    threshold: float
    """Luminance in cd/m² from which on a pixel belongs to a glare source, in [0, 1e12]; 0, the default: five
    times the mean luminance of the image."""
    vertical_illuminance: float
    """Illuminance in lux at the eye on a plane across the line of sight, in [0, 1e12], for an image that does
    not show the whole half-space ahead; 0, the default: the illuminance from all pixels of the image."""


@dataclass(frozen=True)
class Observer:
    """An observer: an eye that looks in a direction. Callers pass arrays of this struct, so its size and fields
    never change in later versions."""

    position: tuple[float, float, float]
    """Position of the eye, in metres."""
    direction: tuple[float, float, float]
    """Line of sight; any length but 0. It must not be vertical: its horizontal part must be at least 2 % of its
    length."""


@dataclass(frozen=True)
class ObserverGlare:
    """The glare that an observer experiences. Callers pass arrays of this struct, so its size and fields never
    change in later versions."""

    ugr: float
    """Unified glare rating: 8 log10(0.25 / background * sum of L² w / p²) over the sources in view, with their
    luminance L in cd/m², solid angle w in steradians and position index p. Below 10, glare is imperceptible; 19
    is the limit for offices. -infinity if no source is in view; infinity if a source is in view and the
    background is black."""
    background: float
    """Luminance of the background in cd/m²: the indirect illuminance at the eye, divided by pi."""
    background_error: float
    """Standard error of the field background, in cd/m²."""
    unrated_lux: float
    """Direct illuminance at the eye, in lux, from all light that the rating leaves out: of luminaires without a
    luminous opening, of point, spot and directional lights, of the environment, and the glow of emissive
    meshes."""
    solid_angle: float
    """Solid angle of the visible parts of all sources in view, in steradians."""
    sources: int
    """Number of sources in view: rated luminaires, and luminous parts of emissive meshes."""
    outside_range: int
    """Number of sources in view whose solid angle is outside [0.0003, 0.1] steradians, the range for which CIE
    117 is valid; they count in ugr too. Lamps in an emission texture that are narrower than 0.32 degrees may be
    missed."""


class GonioParams(TypedDict, total=False):
    """Settings of luxfer_scene_get_distribution: the directions, the paths and the axes of the luminaire."""

    planes: int
    """Number of C planes, in [1, 360], at equal angles around the axis; default 24. A single plane, C = 0,
    holds for all directions around the axis."""
    angles: int
    """Number of vertical angles gamma in each C plane, in [2, 361], at equal angles from 0 to 180 degrees;
    default 73."""
    samples: int
    """Paths per direction, in [16, 16777216], rounded up to a multiple of 16; default 1024."""
    seed: int
    """Seed of the paths; default 1."""
    axis: Sequence[float]
    """Direction of the luminaire's axis, in which gamma is 0; any length but 0; default (0, -1, 0): down."""
    c0: Sequence[float]
    """Direction of the half-plane C = 0; it must not be parallel to axis, and only its component perpendicular
    to axis counts. Default (1, 0, 0). For an axis that points down, C grows anticlockwise as seen from
    above."""


@dataclass(frozen=True)
class GonioReport:
    """Errors of a distribution that luxfer_scene_get_distribution has measured, and the place of its
    luminaire."""

    position: tuple[float, float, float]
    """Centre of the luminous opening in metres, in the coordinates of the scene: a luminaire with this
    position, and with the axis and c0 of the settings, takes the place of the meshes."""
    flux: float
    """Luminous flux in lumens."""
    flux_error: float
    """Standard error of the flux, in lumens."""
    intensity_error: float
    """Largest standard error of an intensity, in candela."""


class FalseColourParams(TypedDict, total=False):
    """Settings of a false colour image."""

    scale: Scale | str | int
    """Scale that maps values to colours: Scale; default Scale.LINEAR."""
    unit: Unit | str | int
    """Quantity of the values, whose unit is written above the bar: Unit; default Unit.LUMINANCE."""
    bar: int
    """1, the default: draw a scale bar beside the image, which makes it wider; 0: no bar."""
    minimum: float
    """Value that gets the darkest colour, >= 0; default 0. On a logarithmic scale, 0 stands for a thousandth of
    the value that gets the lightest colour."""
    maximum: float
    """Value that gets the lightest colour, greater than minimum; 0, the default: the largest finite value of
    the image."""


class SunParams(TypedDict, total=False):
    """A place on the Earth and a time."""

    year: int
    """Year in the Gregorian calendar, in [1600, 2500]; default 2000."""
    month: int
    """Month, in [1, 12]; default 1."""
    day: int
    """Day of the month, from 1 to the number of its days; default 1."""
    hour: float
    """Hours of universal time (UTC) since the midnight with which the date begins, in [-24, 48]; default 12.
    For a local time it is the local hour minus the zone, such as 14.5 - 2 for half past two in a zone two hours
    ahead."""
    latitude: float
    """Latitude in degrees, in [-90, 90], positive to the north; default 0."""
    longitude: float
    """Longitude in degrees, in [-180, 180], positive to the east; default 0."""


@dataclass(frozen=True)
class SunPosition:
    """The position of the sun."""

    altitude: float
    """Angle of the sun's centre above the horizon in radians, in [-pi / 2, pi / 2], without refraction."""
    azimuth: float
    """Angle in radians from north over east, in [0, 2 pi)."""
    distance: float
    """Distance of the sun in astronomical units."""


class SkyParams(TypedDict, total=False):
    """A state of sun and sky. The default is the overcast sky of type 1 with 10,000 lx: 100 lx indoors are then
    a daylight factor of 1 %."""

    model: SkyModel | str | int
    """Model of the sky: SkyModel; default SkyModel.CIE."""
    cie_type: int
    """Type of a standard sky: 1 to 15 as in CIE S 011 (1 overcast, 5 uniform, 12 clear), or 16 for the
    traditional overcast sky, whose zenith is three times as bright as its horizon; default 1."""
    unit: DaylightUnit | str | int
    """Unit of direct_normal and diffuse_horizontal: DaylightUnit; default DaylightUnit.LUX."""
    sun_altitude: float
    """Altitude of the sun in radians, in [-pi / 2, pi / 2], such as luxfer_sun_get_position gives it; default
    pi / 4. A sun at 0 or below gives no light, and the sky has the shape that it has with the sun at 0."""
    sun_azimuth: float
    """Azimuth of the sun in radians, from north over east, in [-2 pi, 2 pi]; default pi, the south."""
    sun_distance: float
    """Distance of the sun in astronomical units, in [0.9, 1.1]; default 1. It counts for the Perez sky, for
    irradiances and for the size of the sun's disc."""
    direct_normal: float
    """Light of the sun on a plane that faces it, in [0, 1e6] lx or [0, 2000] W/m²; default 0."""
    diffuse_horizontal: float
    """Light of the sky, without the sun, on a level plane, in [0, 1e6] lx or [0, 2000] W/m²; default 10000."""
    zenith_luminance: float
    """Luminance of the zenith in cd/m², in [0, 1e6]. If it is not 0, it replaces diffuse_horizontal. It must be
    0 for the Perez sky. Default 0."""
    dew_point: float
    """Dew point at the ground in degrees Celsius, in [-90, 60], from which the efficacies of irradiances
    estimate the water in the air; default 11, which stands for 2.0 cm of water."""
    ground_reflectance: float
    """Reflectance of the ground, in [0, 1]; default 0.2. Below the horizon the environment has the uniform
    luminance of a diffuse ground with this reflectance under the unobstructed sun and sky."""
    sky_kelvin: float
    """Colour temperature of the sky in kelvin, in [1000, 20000]; 0, the default: neutral white."""
    sun_kelvin: float
    """Colour temperature of the sun in kelvin, in [1000, 20000]; 0, the default: neutral white."""
    north: Sequence[float]
    """Direction of north in the scene, of which only the part perpendicular to y counts; default (0, 0, -1), so
    that east is +x."""
    rows: int
    """Rows of the environment image, an even number in [16, 4096]; default 256. The image has twice as many
    columns."""


@dataclass(frozen=True)
class SkyReport:
    """The light of a sky."""

    sun: int
    """Index of the sun among the punctual lights of the scene; LUXFER_NONE if the scene has no sun."""
    direct_normal: float
    """Illuminance in lux of a plane that faces the sun, by the sun alone; 0 if the sun is not above the
    horizon."""
    diffuse_horizontal: float
    """Illuminance in lux of a level plane by the sky alone."""
    zenith_luminance: float
    """Luminance of the zenith in cd/m²."""
    ground_luminance: float
    """Luminance of the ground in cd/m²."""
    clearness: float
    """Clearness epsilon of Perez et al., from 1, an overcast sky, to 12, a clear one."""
    brightness: float
    """Brightness delta of Perez et al., in [0.01, 0.6]."""


@dataclass(frozen=True)
class WeatherHour:
    """The weather of an hour; values that the file does not have are NaN. Callers pass arrays of this struct,
    so its size and fields never change in later versions."""

    year: int
    """Year; in files of typical years, months may have different years."""
    month: int
    """Month, in [1, 12]."""
    day: int
    """Day of the month, in [1, 31], in the time zone of the file."""
    hour: float
    """Middle of the hour in universal time, in hours since the midnight with which year, month and day begin;
    negative or above 24 if universal time has another date. It suits SunParams."""
    dew_point: float
    """Dew point in degrees Celsius."""
    direct_normal: float
    """Direct normal irradiance in W/m², the mean of the hour."""
    diffuse_horizontal: float
    """Diffuse horizontal irradiance in W/m², the mean of the hour."""
    direct_normal_illuminance: float
    """Direct normal illuminance in lux, the mean of the hour."""
    diffuse_horizontal_illuminance: float
    """Diffuse horizontal illuminance in lux, the mean of the hour."""


@dataclass(frozen=True)
class WeatherReport:
    """The place of a weather file."""

    hours: int
    """Number of hours in the file."""
    latitude: float
    """Latitude in degrees, positive to the north."""
    longitude: float
    """Longitude in degrees, positive to the east."""
    time_zone: float
    """Hours by which the file's time is ahead of universal time."""
    elevation: float
    """Height above the sea in metres."""


@dataclass(frozen=True)
class Mixture:
    """A colour mixed from LED primaries: the result of luxfer_mix_primaries."""

    in_gamut: int
    """1 if the mixture equals the requested colour; 0 if the primaries cannot reach it and this is the nearest
    mixture."""
    colour: tuple[float, float, float]
    """Linear RGB colour of the mixture, in the unit of the primaries."""
    delta_e: float
    """CIEDE2000 difference from the requested colour, at the exposure that shows the requested colour as middle
    grey."""


@dataclass(frozen=True)
class TemperatureFit:
    """The blackbody light that fits a target best: the result of luxfer_fit_temperature."""

    kelvin: float
    """Correlated colour temperature, in [1000, 20000] kelvin."""
    luminance: float
    """Luminance of the emission, >= 0. It is in cd/m² if the array response of luxfer_fit_temperature was
    measured for a white emission of 1 cd/m²."""
    achieved: tuple[float, float, float]
    """Mean radiance of the target from this light and all other lights together, in cd/m² per channel."""
    delta_e: float
    """CIEDE2000 difference between the field achieved and the wanted radiance, at the exposure that shows the
    wanted radiance as middle grey."""


@dataclass(frozen=True)
class Preset:
    """Requirements of EN 12464-1 for one kind of room, as manufacturers of luminaires quote them. Only the
    standard itself is binding."""

    edition: int
    """Year of the edition of the standard."""
    illuminance: float
    """Minimum mean illuminance of the task area (maintained illuminance), in lux."""
    glare: float
    """Maximum unified glare rating."""
    uniformity: float
    """Minimum uniformity U0 (minimum / mean illuminance) of the task area."""
    rendering: float
    """Minimum general colour rendering index Ra."""
    walls: float
    """Minimum mean illuminance of the walls, in lux; 0 if there is no requirement."""
    ceiling: float
    """Minimum mean illuminance of the ceiling, in lux; 0 if there is no requirement."""
    name: str
    """The name, such as "office: filing, copying", in UTF-8; valid as long as the library is loaded."""


class PendantsParams(TypedDict, total=False):
    """Settings with which luxfer_pendants_find fits bodies to lamps."""

    alike: int
    """1, the default: all lamps of the mask have bodies of one shape and size; 0: each lamp has a body of its
    own."""
    level: int
    """1: all lamps hang at one height, which requires alike = 1; 0, the default: each lamp hangs at its own
    height."""
    refine: int
    """1, the default: each point of the mask's outline is moved to where the photo's luminance is the mean of
    the luminances inside and outside the lamp. Points where the photo is clipped or has little contrast stay on
    the outline of the mask. 0: all points stay on the outline of the mask."""
    known: Known | str | int
    """Meaning of known_length: Known; default Known.NOTHING."""
    known_length: float
    """The known length in metres: in [0, 1e4] for Known.DROP, in [1e-4, 1e4] for a diameter or a spacing. Must
    be 0, the default, with Known.NOTHING."""
    ceiling: float
    """Height of the ceiling above the camera in metres, in [0.01, 1000]; default 1. If the height is unknown,
    keep the default: the library then takes and returns all lengths, known_length included, in units of the
    true height instead of metres."""
    suspension_error: float
    """Standard deviation in pixels of the x and of the y of each point in the array suspensions of
    luxfer_pendants_find, in [0.05, 100]; default 1."""
    focal: float
    """Focal length of the camera in pixels; required, and > 0, if no rectification is given; default 0. Not
    used with a rectification. Without a rectification, the photo and the mask must be free of lens
    distortion."""
    focal_error: float
    """Standard deviation of the focal length in pixels, in [0, focal / 2]; default 0. With a rectification, 0
    stands for the standard deviation that the rectification has estimated, or focal / 2 if that is smaller.
    This estimate is 0 only if the caller gave the rectification the focal length."""
    axes_error: float
    """Standard deviation in radians of the tilt of the vertical axis about each horizontal axis, in [0, 0.5];
    default 0. Not used with a rectification, which has its own value."""
    principal: Sequence[float]
    """Principal point in pixels; NaN, the default: the photo's centre. Not used with a rectification."""
    axes: Sequence[float]
    """Room axes as unit vectors in camera space, as in RectifyReport.axes: axis 1 points down. Default: a
    camera that looks horizontally, without roll. Not used with a rectification."""


@dataclass(frozen=True)
class Pendant:
    """A hanging lamp: its body, its place and the doubts about them. Fields called an interval hold three
    numbers: the value, and the lower and the upper end of its 95 % confidence interval. If the photo does not
    determine the value, the ends are the known bounds of the value, which may be 0 and infinity. A value
    without an estimate is NaN."""

    profile_count: int
    """Number of vertices of the profile, in [2, 65]."""
    kind: Body
    """Kind of the body: Body."""
    doubts: Doubt
    """Reasons to doubt the result: Doubt."""
    probability: float
    """Probability of the kind among all kinds, in [0, 1]."""
    aspect: tuple[float, float, float]
    """Interval of height / largest diameter."""
    diameter: tuple[float, float, float]
    """Interval of the largest diameter in metres."""
    height: tuple[float, float, float]
    """Interval of the height of the body in metres."""
    drop: tuple[float, float, float]
    """Interval of the distance in metres of the body's top below the ceiling."""
    centre: tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]
    """Intervals of the position of the body's middle relative to the camera: along the horizontal room axes 0
    and 2, and upwards. The unit is the metre; with Doubt.SIZE it is the distance of the first lamp's middle
    from the camera."""
    residual: float
    """Median distance in pixels between the outline of the lamp and the outline of the fitted body."""
    cut: float
    """Share of the outline that the photo's border cuts off, in [0, 0.3]."""
    clipped: float
    """Share of the lamp's pixels that the photo clips, in [0, 1]. A pixel counts as clipped if a channel is at
    least 98 % of the photo's largest value."""
    profile: tuple[tuple[float, float], ...]
    """Vertices of the profile from bottom to top: radius, and height above the bottom, in multiples of the
    largest diameter. Elements from profile_count on are 0."""
    profile_error: tuple[float, ...]
    """Half-width of the 95 % confidence interval of each radius of the profile, in multiples of the largest
    diameter. It is large where the body hides its own profile."""
    radiance: tuple[tuple[float, float, float], ...]
    """Mean radiance of the lamp in 16 bands of equal height, from bottom to top: linear RGB in the units of the
    photo. Where the photo is clipped, it is only a lower bound."""
    contour: tuple[tuple[float, float], ...]
    """Outline of the fitted body in the photo, a closed polygon: x and y in pixels."""


class GuidesParams(TypedDict, total=False):
    """Settings of the guides."""

    width: int
    """Width of the images in pixels, in [1, 32768]; default 800."""
    height: int
    """Height of the images in pixels, in [1, 32768]; default 608."""
    samples: int
    """Paths per pixel, in [1, 1048576]; default 64."""
    camera: int
    """Index of the camera in the scene; default 0."""
    smooth: int
    """1, the default: smooth the light along surfaces, so that the stylisation does not match noise; 0: keep
    the noise."""
    seed: int
    """Seed of the paths; default 1."""


class StylizeParams(TypedDict, total=False):
    """Settings of a stylisation. The defaults stated here belong to StylizePreset.FULL."""

    search: StylizeSearch | str | int
    """Search for nearest patches: StylizeSearch; default StylizeSearch.PATCHMATCH."""
    patch: int
    """Width of a patch in pixels, odd, in [1, 33]; default 5. Patches are smaller if an image is smaller than
    one patch."""
    guide_weight: float
    """Weight of all guides together, relative to the weight of all colour channels of the artwork together, in
    [0, 1e6]; default 2."""
    coarse_guides: float
    """Factor for guide_weight on all levels but the finest, in [0, 1000]; default 4; StyLit has 1. With a
    larger factor the picture follows the guides more closely, with smaller connected pieces of the artwork."""
    levels: int
    """Maximum number of resolution levels, each half as wide and high as the next finer one, in [1, 16];
    default 6. The coarsest level is at least 5 patches wide and high."""
    iterations: int
    """Rounds on the second finest level, in [1, 100]; default 6. A round is an EM iteration: matching, then
    voting."""
    coarse_iterations: int
    """Rounds (EM iterations) on each level coarser than the second finest, in [1, 100]; default 24; StyLit has
    6."""
    finest_iterations: int
    """Rounds (EM iterations) on the finest level, in [1, 100]; default 1."""
    polish: int
    """Additional rounds (EM iterations) on the finest level, in [0, 100]; default 3; StyLit has 0. In these
    rounds each target patch takes its nearest exemplar patch, without the error budget."""
    search_iterations: int
    """Number of PatchMatch iterations in one search for nearest patches, in [1, 100]; default 1."""
    coverage: float
    """The passes under the error budget end once they have matched this share of the target patches, in [0, 1];
    default 0.9. Each remaining target patch then takes its nearest exemplar patch."""
    passes: int
    """Maximum number of matching passes under the error budget in one round (EM iteration), in [1, 1000];
    default 6."""
    settle: int
    """Number of iterations after each matching, in [0, 100]; default 2; StyLit has 0. In such an iteration, a
    target patch may take the exemplar patch that continues the match of its neighbour, which leaves fewer
    seams."""
    seam: float
    """Cost of a seam, as a share of the mean error of a match, in [0, 100]; default 0.2. A seam lies between
    two neighbouring target patches whose matches are not neighbours in the exemplar. The cost applies to the
    iterations after each matching; see settle."""
    vote: StylizeVote | str | int
    """How a pixel is computed from overlapping patches in all rounds but the last: StylizeVote; default
    StylizeVote.WEIGHTED."""
    final_vote: StylizeVote | str | int
    """How a pixel of the final picture, after the last round, is computed from overlapping patches: a
    StylizeVote; default StylizeVote.ADAPTIVE."""
    preview: int
    """1: work at half resolution, which makes the picture half as wide and high, with compressed guides: the
    few principal components of all guides instead of the guides themselves. 0, the default: full resolution."""
    keep_for_update: int
    """1: keep the data that luxfer_stylize_update needs, about as much memory as all guides; 0, the default:
    free it."""
    coherence: float
    """Share of the previous frame's paint that is kept where it fits, in [0, 1]; default 1. Below 1 the paint
    changes from frame to frame ("boils"), as in hand-painted animation, if each frame has its own seed. No
    effect without luxfer_stylize_set_motion."""
    match_appearance: float
    """Degree to which the exemplar's light guides are adapted, in brightness and contrast, to the target's
    light guides, in [0, 1]; 0, the default: not at all."""
    seed: int
    """Seed of the search; default 1."""


@dataclass(frozen=True)
class StylizeReport:
    """Quality of a stylisation."""

    is_complete: int
    """1 if the run is complete; 0 if only some levels are finished: then all fields but levels, halvings and
    energy are 0."""
    levels: int
    """Number of finished resolution levels."""
    halvings: int
    """Number of times that the target's sides were halved to get the size of the picture."""
    patch: int
    """Width of the patches, in pixels."""
    max_uses: int
    """Number of uses of the exemplar patch that was used most often."""
    energy: float
    """Mean squared difference of matched patches after the last round (Fiser et al. 2016, Eq. 3), with channels
    in [0, 1]. All channels of the artwork together have the weight 1. All guides together have the weight
    guide_weight; before the finest level is finished, they have guide_weight * coarse_guides."""
    used: float
    """Share of the exemplar patches that were used, in [0, 1]."""
    entropy: float
    """Entropy of the usage of exemplar patches, in bits."""
    guide_error: float
    """Root mean square of StylizeImage.GUIDE_ERROR."""
    broken_source: int
    """Number of exemplar pixels that were not used because a value is not finite."""
    broken_target: int
    """Number of target pixels with a guide value that is not finite and was taken as 0."""
    unblended_share: float
    """Share of the painted pixels that are unchanged copies of artwork pixels, in [0, 1]; the other painted
    pixels are blends of several artwork pixels. StylizeVote.ADAPTIVE gives rough paint a larger share than
    smooth paint. luxfer_stylize_update leaves this value as the last full run has set it."""
    normals_weight: float
    """Weight of the normals as a guide, where each guide of light has 1; 0: the normals are not used. Unless
    the caller has given this weight, it is above 0 only if the strokes of the artwork follow the shapes; see
    luxfer_stylize_add_guides."""


class SheetParams(TypedDict, total=False):
    """Settings of a print sheet."""

    even_light: int
    """1, the default: correct uneven lighting of the photo by the brightness of the white in the marks, so that
    paper gets the value 1; 0: no correction."""
    paper_width: float
    """Width of the paper in millimetres, in [60, 2000]; default 297."""
    paper_height: float
    """Height of the paper in millimetres, in [60, 2000]; default 210."""
    dpi: float
    """Dots per inch of the sheet, in [20, 1200]; default 300."""
    margin: float
    """Distance of the marks from the edge of the paper in millimetres, in [0, 50]; default 8."""
    contrast: float
    """Contrast of the printed picture, in [0, 1]; default 0.25; 1 prints the picture unchanged."""


@dataclass(frozen=True)
class SheetReport:
    """Quality of the alignment of a photo with its picture."""

    marks: int
    """Number of marks found, of 10; at least 6 are needed."""
    residual: float
    """Root mean square distance, in pixels of the photo, between the marks and dots found and the positions
    that the model of the sheet predicts for them: paper that is flat or bent in one direction, and a lens with
    radial distortion. If it is more than about half a pixel, the paper has waves or creases, or is bent in two
    directions."""
    error: float
    """Standard deviation of the alignment in pixels of the picture: the root mean square distance, over the
    picture, between true and found positions is below 1.96 times this value with a probability of about 95 %.
    It grows with what the model of the sheet does not hold."""
    to_photo: tuple[float, ...]
    """The homography from pixels of the picture to pixels of the photo that is nearest to the alignment, 3 x 3,
    row by row. The alignment itself also follows the bent paper and the distortion of the lens."""
    bend: float
    """Root mean square distance, in pixels of the picture, between the alignment and to_photo: the error that
    an alignment by a homography would have. It is 0 for flat paper and a lens without distortion."""
    dots: int
    """Number of dots found between the marks. Sheets printed by versions before 0.2 have none."""


class PlanParams(TypedDict, total=False):
    """Goal of a plan, a time or an error: set exactly one of time_budget_ms and target_error."""

    time_budget_ms: int
    """Time for all planned work in milliseconds, in [1, 1e9]; 0 (the default) if the goal is target_error."""
    target_error: float
    """Error of the picture, or of the stylisation, in [1e-5, 1]; 0 (the default) if the goal is
    time_budget_ms."""


@dataclass(frozen=True)
class PlanReport:
    """Times and errors that a plan predicts."""

    relights: int
    """1 for a plan of a transfer, which includes relighting; 0 for a plan of a rendering or a stylisation."""
    seconds: float
    """Predicted seconds for all planned work."""
    error: float
    """Predicted error of the picture or of the stylisation."""
    relight_seconds: float
    """Predicted seconds for relighting, including the preparation of the scene; 0 unless the plan is of a
    transfer."""
    relight_error: float
    """Predicted value of RelightReport.error; 0 unless the plan is of a transfer."""
    render_seconds: float
    """Predicted seconds for rendering. In a plan of a transfer, they include the preparation of the scene; in a
    plan of a rendering they do not, because the plan has already prepared it. 0 in a plan of a stylisation."""
    render_error: float
    """Predicted value of RenderReport.error; 0 in a plan of a stylisation."""


class RenderPart(TypedDict, total=False):
    """A part of a rendering."""

    x: int
    """Column of the first pixel; default 0."""
    y: int
    """Row of the first pixel, from the top; default 0."""
    width: int
    """Width in pixels; default 0: up to the right edge of the image."""
    height: int
    """Height in pixels; default 0: up to the bottom edge of the image."""
    first_sample: int
    """Index of the first path of each pixel, from 0; default 0."""
    samples: int
    """Paths per pixel; default 0: all paths from first_sample up to RenderParams.samples."""


class DemoPhotoParams(TypedDict, total=False):
    """Settings of the demonstration photo."""

    width: int
    """Width in pixels, in [16, 8192]; default 600."""
    height: int
    """Height in pixels, in [16, 8192]; default 400. The camera is designed for an aspect ratio of 3:2."""
    samples: int
    """Paths per pixel, in [2, 1048576]; default 12, which leaves visible noise."""
    seed: int
    """Seed of the paths and of the sensor noise; default 1."""
