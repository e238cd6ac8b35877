// Advice about warnings in terms of this page. The library's own advice names settings that only programs have.

/** The advice by the code of the warning; codes that are missing here keep the library's advice. */
const ADVICE: Record<string, string> = {
  FOCAL_ASSUMED: "Drag the Grid onto a rectangle, or compare Lamps with real ones and set Size by the length of a lamp",
  VIEW_UNCERTAIN:
    "Tick Lines: if they do not follow the edges of the room, drag the Grid onto a rectangle of the ceiling",
  LENS_DISTORTION: "Use a photo of a longer lens, or straighten it in a photo program",
  NOT_SQUARE: "Tick Lines: if they follow the edges, the room is not square, and lamps may be a little skewed",
  LAYOUT_UNCERTAIN: "Paint a Not plane stroke on each wall and on the floor",
  MAGNIFIED: "Trust the lamps near the camera; for the far ones take a photo from nearer",
  PLANE_NEAR_HORIZON: "Take the photo from farther below the lamps, so that their plane is seen less edge-on",
  OFF_PLANE: "Lamps that hang or lie on several planes have no pattern; else drag the Grid onto a rectangle of the ceiling",
  PATTERN_UNCERTAIN: "Compare the plan in Lamps with the photo; correct the lights by Light and Not light strokes",
  NO_PATTERN: "Paint more strokes where the masks are wrong; lamps that hang or lie on several planes have no pattern",
  FEW_LAMPS: "Use a photo with more lamps in full view, or check that the mask keeps them apart",
  NO_LATTICE: "If the lamps are regular, correct their mask by strokes; else the plan in Lamps is as good as it gets",
  UNREACHABLE: "Raise White of the photo, or choose a room whose surfaces are less dark",
  TARGET_CLIPPED: "Use a darker photo of the same lamps: in this one they have lost their colour",
  EMPTY_MASK: "Paint a stroke on the plane, and one on a light",
  MISSED_STROKES: "Paint more strokes on both sides: they look alike at this place",
  IMPLAUSIBLE_SIZE: "Export the room again in metres",
  FAR_FROM_ORIGIN: "Move the room to the origin in the program that made it, and export it again",
  NOT_RENDERED: "Compare the picture with the program that made the room; what is missing can be baked into textures",
};

export function adviceFor(code: string, own: string): string {
  return ADVICE[code] ?? own;
}
