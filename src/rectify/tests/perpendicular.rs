//! Tests of the choice of the vanishing points that are room axes.

use super::*;
use crate::rectify::camera::orient;
use crate::rectify::sphere::{Refined, round_covariance};
use crate::rectify::vanishing::{Vanishing, VanishingPoint};

/// Vanishing points of the given directions, each with its number of segments and its standard deviation.
fn found(truth: &Perspective, directions: &[(DVec3, usize, f64)]) -> Vanishing {
    let point = |&(direction, support, error): &(DVec3, usize, f64)| {
        let point = truth.intrinsics() * direction;
        VanishingPoint { point: point.normalize(), support, error, covariance: round_covariance(direction, error) }
    };
    let free = directions.iter().map(|&(direction, _, error)| Refined {
        direction: direction.normalize(),
        covariance: round_covariance(direction.normalize(), error),
    });
    Vanishing {
        points: directions.iter().map(point).collect(),
        members: Vec::new(),
        free: free.collect(),
        focal: truth.focal,
    }
}

#[test]
fn a_few_lines_that_meet_elsewhere_do_not_change_the_focal_length() {
    let truth = camera(0.6, 0.4, 0.0, 650.0);
    let axes = truth.axes;
    // The third point lies ahead of the camera, at right angles to no axis.
    let stray = DVec3::new(0.2, 0.15, 1.0).normalize();
    for order in [[0, 2, 1], [0, 1, 2], [1, 0, 2]] {
        let mut three = [(axes.x_axis, 30, 0.008), (axes.z_axis, 25, 0.009), (stray, 6, 0.04)];
        // The order of the points must not matter, only the number of their lines.
        three = order.map(|k| three[k]);
        let camera = orient(&found(&truth, &three), SIZE.0, SIZE.1, &Params::default());
        assert!((camera.perspective.focal / 650.0).ln().abs() < 0.02, "{}", camera.perspective.focal);
        assert!(angle(camera.perspective.axes.y_axis, axes.y_axis) < 0.01);
        assert_eq!(camera.axis_of.iter().flatten().count(), 2);
    }
}

#[test]
fn three_axes_and_all_their_points_are_used() {
    let truth = camera(0.6, 0.4, 0.0, 300.0);
    let three = [0, 1, 2].map(|k| (truth.axes.col(k), 20, 0.01));
    let camera = orient(&found(&truth, &three), SIZE.0, SIZE.1, &Params::default());
    assert_eq!(camera.axis_of.iter().flatten().count(), 3);
    assert!((camera.perspective.focal / 300.0).ln().abs() < 0.02, "{}", camera.perspective.focal);
}

#[test]
fn two_points_that_imply_a_lens_wider_than_any_are_not_both_axes() {
    let truth = camera(0.7, 0.6, 0.0, 180.0);
    let two = [(truth.axes.x_axis, 40, 0.01), (truth.axes.z_axis, 20, 0.01)];
    let camera = orient(&found(&truth, &two), SIZE.0, SIZE.1, &Params::default());
    assert_eq!(camera.axis_of.iter().map(|axis| axis.is_some()).collect::<Vec<_>>(), [true, false]);
    assert_eq!(camera.perspective.focal_source, FocalSource::Assumed);
    // With a given focal length, the two points are perpendicular or not.
    let given = Params { focal: Some(180.0), ..Params::default() };
    let camera = orient(&found(&truth, &two), SIZE.0, SIZE.1, &given);
    assert_eq!(camera.axis_of.iter().flatten().count(), 2);
}
