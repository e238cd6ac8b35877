//! Tests that a transfer corrects the camera from lamps of equal shape: a bare ceiling has too few edges for a good
//! camera estimate, but its lamps are all round and equal.

use glam::{DMat3, DVec2, DVec3};
use luxfer::exec::Pool;
use luxfer::geometry::{FocalSource, Perspective, Segment};
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::rectify::{self, View};
use luxfer::segment::{Stroke, StrokeSet};
use luxfer::transfer::{Input, Stage, Transfer};
use std::sync::Arc;

const SIZE: [usize; 2] = [640, 480];
const LAMP_RADIUS: f64 = 0.06;
/// Centres of the lamps (right, ahead) on the ceiling plane, in units of its height above the camera.
const LAMPS: [[f64; 2]; 8] =
    [[-0.5, 0.6], [0.1, 0.5], [0.45, 0.8], [-0.3, 1.0], [0.2, 1.2], [-0.6, 1.4], [0.6, 1.5], [-0.1, 1.7]];

/// The camera that took the photo: it looks up by 37 degrees.
fn camera() -> Perspective {
    let down = DVec3::new(0.0, 0.8, -0.6);
    let ahead = DVec3::new(0.0, 0.6, 0.8);
    let axes = DMat3::from_cols(down.cross(ahead), down, ahead);
    let principal = DVec2::new(SIZE[0] as f64, SIZE[1] as f64) / 2.0;
    Perspective { focal: 560.0, focal_source: FocalSource::Given, principal, bend: 0.0, axes }
}

fn on_ceiling(pixel: DVec2) -> DVec2 {
    let (camera, ray) = (camera(), camera().ray(pixel));
    DVec2::new(camera.axes.col(0).dot(ray), camera.axes.col(2).dot(ray)) / -camera.axes.col(1).dot(ray)
}

/// Distance ahead at which the ceiling ends at a wall.
const WALL: f64 = 2.0;

/// Draws bright lamps on a dim ceiling, and the brighter wall where the ceiling ends.
fn photo() -> Image {
    Image::from_fn(SIZE[0], SIZE[1], |x, y| {
        let at = on_ceiling(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let is_lit = LAMPS.iter().any(|&[u, v]| at.distance(DVec2::new(u, v)) < LAMP_RADIUS);
        let wall = if (0.0..WALL).contains(&at.y) { 0.1 } else { 0.45 };
        [if is_lit { 1.0 } else { wall }; 3]
    })
    .unwrap()
}

/// Standard deviation in radians that an estimate from few edges states for its axes.
const DOUBT: f64 = 0.15;

/// Angle in radians by which the wrong estimate is turned from the true camera.
const TURN: f64 = 0.5;

/// The wrong camera that a few edges suggest: turned about its x axis, with a wrong focal length and large stated
/// errors.
fn wrong_view() -> View {
    let edge = |ax, ay, bx, by| Segment { a: DVec2::new(ax, ay), b: DVec2::new(bx, by) };
    let edges = [edge(40.0, 60.0, 150.0, 55.0), edge(400.0, 440.0, 520.0, 447.0)];
    let (params, job) = (rectify::Params::default(), Monitor::default());
    let mut view = rectify::view_from_segments(&edges, SIZE[0], SIZE[1], &params, job.job()).unwrap();
    let axes = DMat3::from_rotation_x(TURN) * camera().axes;
    view.perspective = Perspective { focal: 480.0, focal_source: FocalSource::Assumed, axes, ..view.perspective };
    for (axis, point) in view.vanishing_points.iter_mut().enumerate() {
        (point.point, point.error) = (view.perspective.vanishing_point(axis).normalize(), DOUBT);
    }
    view
}

/// Light strokes on two of the lamps, plane strokes beside two others, and a negative plane stroke on the wall.
fn strokes() -> StrokeSet {
    let to_photo = |[u, v]: [f64; 2]| {
        let camera = camera();
        let point = camera.intrinsics() * (camera.axes.col(0) * u + camera.axes.col(2) * v - camera.axes.col(1));
        point.truncate() / point.z
    };
    let dot = |at: DVec2| Stroke::polyline(&[at, at + DVec2::new(6.0, 0.0)], 2.0, true, SIZE[0], SIZE[1]).unwrap();
    let beside = |at: DVec2| dot(at + DVec2::new(60.0, 0.0));
    let wall = Stroke { positive: false, ..dot(DVec2::new(320.0, 440.0)) };
    StrokeSet {
        plane: vec![beside(to_photo(LAMPS[1])), beside(to_photo(LAMPS[3])), wall],
        lights: vec![dot(to_photo(LAMPS[0])), dot(to_photo(LAMPS[2]))],
    }
}

fn transfer() -> Transfer {
    let input = Input { photo: Some(Arc::new(photo())), strokes: strokes(), ..Input::default() };
    let mut transfer = Transfer { input, ..Transfer::default() };
    transfer.results.view = Some(Arc::new(wrong_view()));
    transfer
}

/// Runs the transfer until the lights are found; returns the camera that it has then.
fn found(transfer: &mut Transfer) -> Perspective {
    let monitor = Monitor::default();
    let run = || transfer.run(Stage::Features, Stage::Lights, monitor.job(), |_| {});
    Pool::new(2).unwrap().run(run).unwrap();
    transfer.results.view.as_ref().unwrap().perspective
}

#[test]
fn lamps_that_are_alike_correct_the_camera() {
    let mut transfer = transfer();
    let wrong = transfer.results.view.as_ref().unwrap().perspective;
    let right = found(&mut transfer);
    let angle = |p: &Perspective| p.axes.col(1).dot(camera().axes.col(1)).abs().min(1.0).acos();
    assert!(angle(&wrong) > 0.3 && angle(&right) < 0.03, "{} and {}", angle(&wrong), angle(&right));
    assert!((right.focal / camera().focal).ln().abs() < 0.06, "{}", right.focal);
    assert_eq!(right.focal_source, FocalSource::Lamps);
    assert_eq!(transfer.results.view_by_lines.as_ref().unwrap().perspective, wrong);

    // Run these stages again: they give the same camera, although they now start from the corrected one.
    assert_eq!(found(&mut transfer), right);
}

#[test]
fn a_camera_of_the_caller_stays() {
    let mut transfer = transfer();
    transfer.results.view_is_given = true;
    let given = transfer.results.view.as_ref().unwrap().perspective;
    assert_eq!(found(&mut transfer), given);
}
