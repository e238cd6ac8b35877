use super::*;
use crate::geometry::Perspective;
use crate::job::Monitor;
use crate::rectify::focal::FocalPrior;
use crate::rectify::sphere::round_covariance;
use crate::rectify::{Params, VanishingPoint};
use glam::{DMat3, DVec2, DVec3};

const SIZE: [usize; 2] = [640, 480];
const FOCAL: f64 = 560.0;

/// The normal of a ceiling, seen by a camera that is pitched upwards.
fn true_normal() -> DVec3 {
    DVec3::new(0.05, -0.8, 0.6).normalize()
}

fn camera(normal: DVec3, focal: f64) -> Perspective {
    let down = -normal;
    let ahead = (DVec3::Z - down * down.z).normalize();
    let axes = DMat3::from_cols(down.cross(ahead), down, ahead);
    let principal = DVec2::new(SIZE[0] as f64, SIZE[1] as f64) / 2.0;
    Perspective { focal, focal_source: FocalSource::Assumed, principal, bend: 0.0, axes }
}

/// A view whose axes are uncertain, as if only a few lines determined them. `error` is the standard deviation of each
/// axis in radians.
fn view(normal: DVec3, error: f64) -> View {
    let perspective = camera(normal, 500.0);
    let point = |axis: usize| VanishingPoint {
        point: perspective.vanishing_point(axis).normalize(),
        support: 2,
        error,
        covariance: round_covariance(perspective.axes.col(axis), error),
    };
    let expected_focal = FocalPrior::new(&Params::default(), SIZE[0]);
    View {
        segments: Vec::new(),
        vanishing_points: [0, 1, 2].map(point),
        perspective,
        focal_spread: expected_focal.spread,
        squareness: [None; 3],
        distortion: None,
        undone: 0.0,
        expected_focal,
        lattice_lamps: 0,
    }
}

/// Draws the mask of discs on the plane with the normal [`true_normal`], at distance 1 from the camera. Each disc has a
/// centre and a radius in plane units.
fn discs(at: &[(DVec2, f64)]) -> Image {
    let perspective = camera(true_normal(), FOCAL);
    let (right, down) = (perspective.axes.col(0), perspective.axes.col(2));
    Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let ray = perspective.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let depth = true_normal().dot(ray);
        let point = DVec2::new(right.dot(ray), down.dot(ray)) / depth;
        let is_lit = depth > 0.0 && at.iter().any(|(centre, radius)| point.distance(*centre) < *radius);
        [f32::from(is_lit)]
    })
    .unwrap()
}

fn scattered(radius: impl Fn(usize) -> f64) -> Vec<(DVec2, f64)> {
    let places = [[-0.5, 0.6], [0.1, 0.5], [0.45, 0.8], [-0.3, 1.0], [0.2, 1.2], [-0.6, 1.4], [0.6, 1.5]];
    places.iter().enumerate().map(|(k, &[x, y])| (DVec2::new(x, y), radius(k))).collect()
}

fn corrected(view: &View, lamps: &Image) -> Option<View> {
    let everywhere = Image::from_fn(SIZE[0], SIZE[1], |_, _| [1.0]).unwrap();
    view.corrected_by_lamps(&everywhere, lamps, Monitor::default().job()).unwrap()
}

fn angle(view: &View) -> f64 {
    (-view.perspective.axes.col(1)).dot(true_normal()).min(1.0).acos()
}

#[test]
fn equal_discs_show_the_tilt_of_their_plane_and_the_focal_length() {
    let wrong = view(DVec3::new(0.1, -0.99, 0.1).normalize(), 0.15);
    let found = corrected(&wrong, &discs(&scattered(|_| 0.06))).expect("the discs contradict the lines");
    let error = found.vanishing_points[1].error;
    assert!(angle(&wrong) > 0.4);
    assert!(angle(&found) < 0.02 && angle(&found) < 3.0 * error, "{} rad, stated {error}", angle(&found));
    assert!((found.perspective.focal / FOCAL).ln().abs() < 0.05, "{}", found.perspective.focal);
    assert_eq!(found.perspective.focal_source, FocalSource::Lamps);
    let stated = found.focal_error();
    assert!((found.perspective.focal - FOCAL).abs() < 3.0 * stated && stated < 0.25 * FOCAL, "{stated}");
    let axes = found.perspective.axes;
    assert!(
        (axes.determinant() - 1.0).abs() < 1e-9
            && (axes.transpose() * axes - DMat3::IDENTITY).abs_diff_eq(DMat3::ZERO, 1e-9)
    );
}

#[test]
fn equal_discs_overrule_lines_that_are_certain_within_45_degrees_if_they_are_many() {
    let all = scattered(|_| 0.06);
    let near = view(DVec3::new(0.1, -0.5, 0.86).normalize(), 0.01);
    let found = corrected(&near, &discs(&all)).expect("the discs contradict the lines");
    assert!(angle(&near) > 0.35 && angle(&found) < 0.03, "{} rad", angle(&found));
    assert!(corrected(&near, &discs(&all[..2])).is_none());
    // These lines take a wall for the plane.
    let far = view(DVec3::new(0.1, -0.99, 0.1).normalize(), 0.01);
    assert!(corrected(&far, &discs(&all)).is_none());
}

#[test]
fn a_view_in_which_the_discs_are_alike_stays() {
    assert!(corrected(&view(true_normal(), 0.15), &discs(&scattered(|_| 0.06))).is_none());
}

#[test]
fn discs_of_many_sizes_show_nothing() {
    let wrong = view(DVec3::new(0.1, -0.99, 0.1).normalize(), 0.15);
    let sizes = [0.03, 0.09, 0.05, 0.12, 0.04, 0.1, 0.06];
    assert!(corrected(&wrong, &discs(&scattered(|k| sizes[k]))).is_none_or(|found| angle(&found) < 0.1));
}

#[test]
fn masks_without_shapes_show_nothing() {
    let wrong = view(DVec3::new(0.1, -0.99, 0.1).normalize(), 0.15);
    let one = discs(&scattered(|_| 0.06)[..1]);
    let all = Image::from_fn(SIZE[0], SIZE[1], |_, _| [1.0]).unwrap();
    for lamps in [discs(&[]), one, all] {
        assert!(corrected(&wrong, &lamps).is_none());
    }
    let nowhere = discs(&[]);
    assert!(
        wrong.corrected_by_lamps(&nowhere, &discs(&scattered(|_| 0.06)), Monitor::default().job()).unwrap().is_none()
    );
}

/// Places of lamps on a lattice whose steps, at any angle to the camera, are at a right angle.
fn lattice(columns: usize, rows: usize, turn: f64) -> Vec<DVec2> {
    let (step, across) = (DVec2::from_angle(turn) * 0.25, DVec2::from_angle(turn).perp() * 0.2);
    let place = |k: usize| {
        let (i, j) =
            ((k % columns) as f64 - 0.5 * (columns - 1) as f64, (k / columns) as f64 - 0.5 * (rows - 1) as f64);
        DVec2::new(0.0, 1.0) + step * i + across * j
    };
    (0..columns * rows).map(place).collect()
}

/// Radii that tell nothing about the tilt.
const RADII: [f64; 5] = [0.025, 0.045, 0.03, 0.055, 0.035];

fn unlike(places: &[DVec2]) -> Vec<(DVec2, f64)> {
    places.iter().enumerate().map(|(k, &place)| (place, RADII[k % RADII.len()])).collect()
}

#[test]
fn a_lattice_shows_the_tilt_of_its_plane_although_its_lamps_and_the_lines_contradict_it() {
    // Lines that are certain but wrong, for instance rays of glare.
    let wrong = view(DVec3::new(0.4, -0.4, 0.8).normalize(), 0.01);
    let mut places = lattice(4, 3, 0.4);
    places.remove(5);
    let found = corrected(&wrong, &discs(&unlike(&places))).expect("the lattice contradicts the lines");
    let error = found.vanishing_points[1].error;
    assert!(angle(&found) < 0.02 && angle(&found) < 3.0 * error, "{} rad, stated {error}", angle(&found));
    assert!((found.perspective.focal / FOCAL).ln().abs() < 0.05, "{}", found.perspective.focal);
    assert_eq!(found.lattice_lamps, 11);
}

#[test]
fn a_hexagonal_lattice_overrules_lines_that_are_certain() {
    let wrong = view(DVec3::new(0.1, -0.99, 0.1).normalize(), 0.01);
    let sites = (0..4).flat_map(|row| (0..5).map(move |column| (f64::from(column), f64::from(row))));
    let place =
        |(column, row): (f64, f64)| DVec2::new(column + 0.5 * (row % 2.0) - 2.2, 0.75f64.sqrt() * row + 2.0) * 0.35;
    let places: Vec<DVec2> = sites.map(place).collect();
    let found = corrected(&wrong, &discs(&unlike(&places))).expect("the lattice contradicts the lines");
    assert!(angle(&found) < 0.02, "{} rad", angle(&found));
    assert!((found.perspective.focal / FOCAL).ln().abs() < 0.05, "{}", found.perspective.focal);
}

#[test]
fn lamps_beside_the_lattice_do_not_hide_it() {
    let wrong = view(DVec3::new(0.1, -0.99, 0.1).normalize(), 0.15);
    let mut lamps = unlike(&lattice(4, 3, 0.4));
    lamps.extend([(DVec2::new(0.02, 0.64), 0.03), (DVec2::new(-0.55, 1.1), 0.03)]);
    let found = corrected(&wrong, &discs(&lamps)).expect("most lamps lie on a lattice");
    assert!(angle(&found) < 0.02 && found.lattice_lamps == 12, "{} rad, {}", angle(&found), found.lattice_lamps);
}

#[test]
fn too_few_lamps_on_a_lattice_and_scattered_lamps_do_not_overrule_lines() {
    let certain = view(DVec3::new(0.1, -0.99, 0.1).normalize(), 0.01);
    let places: Vec<DVec2> = scattered(|_| 0.0).iter().map(|lamp| lamp.0).collect();
    for places in [&lattice(5, 1, 0.4)[..], &lattice(2, 2, 0.4), &places] {
        assert!(corrected(&certain, &discs(&unlike(places))).is_none());
    }
}

#[test]
fn a_lattice_that_agrees_with_the_lines_changes_nothing() {
    let right = View { perspective: camera(true_normal(), FOCAL), ..view(true_normal(), 0.15) };
    assert!(corrected(&right, &discs(&unlike(&lattice(4, 3, 0.4)))).is_none());
}
