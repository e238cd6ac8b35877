use super::*;
use crate::job::Monitor;
use crate::rng::Rng;

const SIZE: [usize; 2] = [360, 240];

/// Linear luminances by which the ceiling is lighter than the wall: a faint seam, and a clear one.
const FAINT: f64 = 0.06;
const CLEAR: f64 = 0.25;

/// A wall below a lighter ceiling, with a soft seam at row 100 and noise. A dark door hides the wall from column 250
/// to 300.
fn room(lighter: f64) -> Image {
    Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let ceiling = 1.0 / (1.0 + (0.7 * (y as f64 - 100.0)).exp());
        let is_door = y > 130 && (250..300).contains(&x);
        let noise = 0.002 * Rng::new(1, &[x as u64, y as u64]).normal();
        [(if is_door { 0.02 } else { 0.30 + lighter * ceiling } + noise) as f32; 3]
    })
    .unwrap()
}

/// The pixels of a rectangle `[x0, y0, x1, y1]`; column x1 and row y1 are excluded.
fn painted([x0, y0, x1, y1]: [usize; 4]) -> Vec<u32> {
    (y0..y1).flat_map(|y| (x0..x1).map(move |x| (y * SIZE[0] + x) as u32)).collect()
}

fn grown(lighter: f64, strokes: &[([usize; 4], bool)]) -> Option<Surfaces> {
    let pixels: Vec<Vec<u32>> = strokes.iter().map(|(rectangle, _)| painted(*rectangle)).collect();
    let strokes: Vec<PlaneStroke> =
        pixels.iter().zip(strokes).map(|(pixels, (_, positive))| PlaneStroke { pixels, positive: *positive }).collect();
    grow(&room(lighter), &strokes, Monitor::default().job()).unwrap()
}

/// Asserts that the ceiling is on the plane, the wall off it, and the door unknown. Skips pixels less than 8 rows from
/// the seam or less than 8 columns from the door.
fn assert_parted(surfaces: &Surfaces) {
    for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
        let label = surfaces.on_plane[y * SIZE[0] + x];
        match (x, y) {
            (_, 0..92) => assert_eq!(label, Some(true), "{x} {y}"),
            (0..242 | 308.., 108..) => assert_eq!(label, Some(false), "{x} {y}"),
            (258..292, 138..) => assert_eq!(label, None, "{x} {y}"),
            _ => {}
        }
    }
}

#[test]
fn strokes_grow_to_a_faint_seam_and_not_behind_strong_edges() {
    let surfaces = grown(FAINT, &[([20, 20, 60, 24], true), ([100, 180, 104, 220], false)]).unwrap();
    assert_parted(&surfaces);
    assert!(surfaces.is_off_plane(200 * SIZE[0] + 20, SIZE) && !surfaces.is_off_plane(20 * SIZE[0] + 20, SIZE));
    // The same place in a photo of twice the size.
    assert!(surfaces.is_off_plane(400 * 2 * SIZE[0] + 40, SIZE.map(|n| 2 * n)));
}

#[test]
fn the_end_of_a_stroke_beyond_an_edge_does_not_grow() {
    let surfaces = grown(CLEAR, &[([20, 20, 60, 24], true), ([100, 80, 104, 220], false)]).unwrap();
    assert_parted(&surfaces);
}

#[test]
fn strokes_of_one_class_do_not_grow() {
    assert!(grown(FAINT, &[([20, 20, 60, 24], true)]).is_none());
    assert!(grown(FAINT, &[([100, 180, 104, 220], false)]).is_none());
    assert!(grown(FAINT, &[]).is_none());
}
