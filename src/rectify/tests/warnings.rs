//! Every defect of a camera or a plane raises its warning, and a good camera and a good plane raise none.

use super::*;
use crate::geometry::{Homography, Perspective, Segment};
use crate::image::Image;
use crate::job::Monitor;
use crate::rectify::{Distortion, Params, Squareness, UnwarpParams, unwarp, view_from_segments};
use crate::rng::Rng;
use glam::{DMat3, DQuat};

const WIDTH: usize = 800;
const HEIGHT: usize = 600;

fn camera(yaw: f64, pitch: f64) -> Perspective {
    Perspective {
        focal: 700.0,
        focal_source: FocalSource::Given,
        principal: DVec2::new(WIDTH as f64, HEIGHT as f64) / 2.0,
        bend: 0.0,
        axes: DMat3::from_quat(DQuat::from_rotation_x(pitch) * DQuat::from_rotation_y(yaw)),
    }
}

/// Estimates the view from thirty noisy lines along each axis.
fn view(camera: &Perspective, noise: f64) -> View {
    let mut rng = Rng::new(5, &[]);
    let mut segments = Vec::new();
    for axis in 0..3 {
        let vanishing = camera.vanishing_point(axis);
        for _ in 0..30 {
            let a = DVec2::new(rng.next_f64() * WIDTH as f64, rng.next_f64() * HEIGHT as f64);
            let b = a + (vanishing.truncate() - a * vanishing.z).normalize() * (60.0 + 150.0 * rng.next_f64());
            let mut moved = |p: DVec2| p + noise * DVec2::new(rng.normal(), rng.normal());
            segments.push(Segment { a: moved(a), b: moved(b) });
        }
    }
    view_from_segments(&segments, WIDTH, HEIGHT, &Params::default(), Monitor::default().job()).unwrap()
}

fn codes(list: &[Warning]) -> Vec<Code> {
    list.iter().map(|warning| warning.code).collect()
}

#[test]
fn a_room_seen_at_an_angle_raises_nothing() {
    let view = view(&camera(0.5, 0.3), 0.3);
    assert_eq!(codes(&view.warnings()), []);
}

#[test]
fn a_room_seen_along_its_axis_leaves_the_focal_length_open() {
    let view = view(&camera(0.0, 0.0), 0.3);
    let warnings = view.warnings();
    assert_eq!(codes(&warnings), [Code::FocalAssumed]);
    // The warning states the spread of the prior, since the lines do not narrow it.
    assert!((warnings[0].severity / USUAL_SPREAD - 1.0).abs() < 0.1, "{:?}", warnings[0]);
    assert!(warnings[0].severity > warnings[0].limit);
    // A focal length that the caller gives raises no warning.
    let mut given = view.clone();
    given.perspective.focal_source = FocalSource::Given;
    assert_eq!(codes(&given.warnings()), []);
}

#[test]
fn uncertain_axes_bent_lines_and_oblique_walls_raise_warnings() {
    let good = view(&camera(0.5, 0.3), 0.3);
    let mut uncertain = good.clone();
    uncertain.vanishing_points[1].error = 0.5;
    assert_eq!(codes(&uncertain.warnings()), [Code::ViewUncertain]);

    let bent = |corner, error| View { distortion: Some(Distortion { corner, error, segments: 40 }), ..good.clone() };
    let warnings = bent(-0.05, 0.01).warnings();
    assert_eq!(codes(&warnings), [Code::LensDistortion]);
    assert!(warnings[0].message.contains("5.0 % of barrel"), "{}", warnings[0].message);
    // Neither a little distortion nor a distortion within its error raises a warning.
    assert_eq!(codes(&bent(0.01, 0.001).warnings()), []);
    assert_eq!(codes(&bent(0.05, 0.02).warnings()), []);

    let skewed = |angle, error| View { squareness: [None, Some(Squareness { angle, error }), None], ..good.clone() };
    assert_eq!(codes(&skewed(-0.1, 0.01).warnings()), [Code::NotSquare]);
    assert_eq!(codes(&skewed(0.02, 0.001).warnings()), []);
    assert_eq!(codes(&skewed(0.1, 0.05).warnings()), []);
    // No room is 30 degrees off right angles: one of the two vanishing points is wrong.
    assert_eq!(codes(&skewed(0.52, 0.01).warnings()), []);
}

/// An unwarped plane of 100 x 80 pixels with the given homography to the photo.
fn unwarped(to_photo: DMat3) -> Unwarped {
    Unwarped {
        image: Image::new(100, 80, 3).unwrap(),
        valid: Image::from_fn(100, 80, |_, _| [1.0]).unwrap(),
        to_photo: Homography(to_photo).rescaled().into(),
        pixel_size: 0.01,
        corners: [DVec2::ZERO; 4],
        aspect_confidence: 1.0,
        corner_error: [0.0; 4],
    }
}

#[test]
fn a_plane_magnified_for_the_most_part_raises_a_warning() {
    assert_eq!(codes(&unwarped(DMat3::IDENTITY).warnings()), []);
    let far = unwarped(DMat3::from_scale(DVec2::splat(0.2)));
    let warnings = far.warnings();
    assert_eq!(codes(&warnings), [Code::Magnified]);
    assert_eq!(warnings[0].severity, 1.0);
    // A plane without a valid pixel has no footprint.
    let hidden = Unwarped { valid: Image::new(100, 80, 1).unwrap(), ..far };
    assert_eq!(codes(&hidden.warnings()), []);
}

#[test]
fn a_footprint_has_the_magnification_and_the_angle_to_the_plane() {
    let footprint = unwarped(DMat3::from_scale(DVec2::new(0.5, 0.125))).footprint(DVec2::new(30.0, 20.0));
    assert!(footprint.place.abs_diff_eq(DVec2::new(15.0, 2.5), 1e-9));
    assert!((footprint.magnification - 4.0).abs() < 1e-9 && (footprint.incidence - 0.25).abs() < 1e-9);
    // Rotations change neither the magnification nor the incidence.
    let turned = DMat3::from_angle(0.7) * DMat3::from_scale(DVec2::new(0.5, 0.125)) * DMat3::from_angle(-0.3);
    let footprint = unwarped(turned).footprint(DVec2::new(30.0, 20.0));
    assert!((footprint.magnification - 4.0).abs() < 1e-9 && (footprint.incidence - 0.25).abs() < 1e-9);
}

#[test]
fn a_ceiling_seen_nearly_edge_on_raises_a_warning() {
    // Unwarps the part of the ceiling that lies between `above` and `2 * above` pixels above the horizon.
    let seen = |above: f64| {
        let camera = camera(0.5, 0.0);
        let view = view(&camera, 0.1);
        let horizon = HEIGHT as f64 / 2.0;
        let rows = horizon - 2.0 * above..horizon - above;
        let mask = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(rows.contains(&(y as f64)))]).unwrap();
        let photo = Image::new(WIDTH, HEIGHT, 3).unwrap();
        unwarp(&photo, &view, &mask, &UnwarpParams::default(), Monitor::default().job()).unwrap()
    };
    let flat = seen(20.0).warnings();
    assert!(codes(&flat).contains(&Code::PlaneNearHorizon), "{flat:?}");
    let steep = seen(140.0).warnings();
    assert!(!codes(&steep).contains(&Code::PlaneNearHorizon), "{steep:?}");
}
