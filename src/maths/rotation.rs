//! Rotations from angles, for glam's vectors. Glam's own functions for this call the platform's sines.

use super::{Real, atan2, sin_cos};
use glam::{DMat2, DMat3, DQuat, DVec2, DVec3, Mat3, Vec3};

/// The unit vector at an angle from the x axis towards the y axis.
#[inline]
pub fn direction_at<R: Real>(angle: R) -> R::Vec2 {
    let (sine, cosine) = sin_cos(angle);
    R::Vec2::from([cosine, sine])
}

/// The angle of a vector from the x axis towards the y axis, from -π to π.
#[inline]
pub fn angle_of(v: DVec2) -> f64 {
    atan2(v.y, v.x)
}

/// The rotation of the plane by an angle.
#[inline]
pub fn rotation_2d(angle: f64) -> DMat2 {
    let x_axis = direction_at(angle);
    DMat2::from_cols(x_axis, x_axis.perp())
}

/// The rotation about a unit vector.
#[inline]
pub fn rotation_about(axis: DVec3, angle: f64) -> DQuat {
    let (sine, cosine) = sin_cos(0.5 * angle);
    DQuat::from_vec4((axis * sine).extend(cosine))
}

/// The rotation about a unit vector, as a matrix.
pub fn rotation_3d(axis: Vec3, angle: f32) -> Mat3 {
    DMat3::from_quat(rotation_about(axis.as_dvec3(), f64::from(angle))).as_mat3()
}

/// The rotation about a vector by its length.
pub fn rotation_by(turn: DVec3) -> DQuat {
    let angle = turn.length();
    if angle == 0.0 { DQuat::IDENTITY } else { rotation_about(turn / angle, angle) }
}
