// The colours and dashes of all marks that mean something. Colours are by Okabe and Ito, which people with any colour
// vision tell apart; marks whose colours are near each other differ by their dashes or their form too. The test "marks
// differ for every colour vision" computes it.

export interface Look {
  colour: string;
  dashes: number[];
  /** What is drawn: marks of different forms need no different colours. */
  form: "line" | "area";
}

const look = (colour: string, dashes: number[] = [], form: Look["form"] = "line"): Look => ({ colour, dashes, form });

/** Marks on the photo. */
export const ON_PHOTO = {
  plane: look("#56b4e9"),
  "not-plane": look("#d55e00", [7, 5]),
  light: look("#f0e442"),
  "not-light": look("#cc79a7", [2, 5]),
  axis0: look("#e69f00"),
  axis1: look("#009e73", [8, 4]),
  axis2: look("#cc79a7", [2, 4]),
  grid: look("#ffffff"),
  "lamp before": look("#ffffff", [4, 4]),
  "plane mask": look("#56b4e9", [], "area"),
  "lights mask": look("#f0e442", [], "area"),
};

/** Marks on the plan of the lamps. */
export const ON_PLAN = {
  lamp: look("#56b4e9"),
  "free place": look("#ffffff", [6, 5]),
};

/** The axes of the room in the photo. */
export const AXES = [ON_PHOTO.axis0, ON_PHOTO.axis1, ON_PHOTO.axis2];

/** Cividis by Nuñez, Anderton and Renslow, at eleven steps: dark blue to yellow. */
export const CIVIDIS = [
  "#00224e",
  "#083370",
  "#35456c",
  "#4f576c",
  "#666970",
  "#7d7c78",
  "#948e77",
  "#aea371",
  "#c8b866",
  "#e5cf52",
  "#fee838",
];

// For tests.
Object.assign(window, { luxferMarks: { photo: ON_PHOTO, plan: ON_PLAN, map: CIVIDIS } });
