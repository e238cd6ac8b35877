//! Shapes of the demonstration scenes: sheets, boxes and bodies of revolution.
//!
//! Texture coordinates of flat shapes are in metres along the surface. Texture coordinates of round shapes are the
//! share of a turn about the axis, in `[0, 1]`, and the height in metres above the foot. Round shapes have normals and
//! flat shapes have none, so the two kinds must not share a mesh.

use crate::maths;
use crate::scene::Mesh;
use glam::{Vec2, Vec3};

/// Creates a mesh and lets `build` add flat shapes to it.
pub fn mesh_of(build: impl FnOnce(&mut Mesh)) -> Mesh {
    let mut mesh = Mesh::default();
    build(&mut mesh);
    mesh
}

/// Adds a rectangle with sides `u` and `v` from `corner`, divided into `cells`. Its front faces along `u × v`.
pub fn sheet(mesh: &mut Mesh, corner: Vec3, u: Vec3, v: Vec3, cells: [u32; 2]) {
    let first = mesh.positions.len() as u32;
    let [columns, rows] = cells;
    for j in 0..=rows {
        for i in 0..=columns {
            let (s, t) = (i as f32 / columns as f32, j as f32 / rows as f32);
            mesh.positions.push(corner + u * s + v * t);
            mesh.uvs[0].push(Vec2::new(s * u.length(), t * v.length()));
        }
    }
    for j in 0..rows {
        for i in 0..columns {
            let at = first + j * (columns + 1) + i;
            let above = at + columns + 1;
            mesh.triangles.extend([[at, at + 1, above + 1], [at, above + 1, above]]);
        }
    }
}

/// Adds a rectangle with rectangular openings. `u` and `v` are unit directions, and `size` is the rectangle's extent
/// along them. Each opening is given by its lower and upper corner in metres along `u` and `v`. The mesh cells are at
/// most `cell` metres wide.
pub fn pierced(mesh: &mut Mesh, corner: Vec3, [u, v]: [Vec3; 2], size: Vec2, openings: &[[Vec2; 2]], cell: f32) {
    let cuts = |axis: usize| {
        let mut cuts: Vec<f32> = openings.iter().flatten().map(|p| p[axis]).chain([0.0, size[axis]]).collect();
        cuts.sort_by(f32::total_cmp);
        cuts.dedup();
        cuts
    };
    let (xs, ys) = (cuts(0), cuts(1));
    for y in ys.windows(2) {
        for x in xs.windows(2) {
            let centre = Vec2::new(x[0] + x[1], y[0] + y[1]) / 2.0;
            if openings.iter().any(|[low, high]| centre.cmpgt(*low).all() && centre.cmplt(*high).all()) {
                continue;
            }
            let extent = Vec2::new(x[1] - x[0], y[1] - y[0]);
            let cells = (extent / cell).ceil().max(Vec2::ONE).as_uvec2().to_array();
            let first = mesh.uvs[0].len();
            sheet(mesh, corner + u * x[0] + v * y[0], u * extent.x, v * extent.y, cells);
            // Keep the texture continuous across the pieces around the openings.
            mesh.uvs[0][first..].iter_mut().for_each(|uv| *uv += Vec2::new(x[0], y[0]));
        }
    }
}

/// Adds a box between two opposite corners.
pub fn cuboid(mesh: &mut Mesh, low: Vec3, high: Vec3) {
    let d = high - low;
    let (x, y, z) = (Vec3::X * d.x, Vec3::Y * d.y, Vec3::Z * d.z);
    for (corner, u, v) in
        [(low + z, x, y), (low + x, -x, y), (low + x + z, -z, y), (low, z, y), (low + y + z, x, -z), (low, x, z)]
    {
        sheet(mesh, corner, u, v, [1, 1]);
    }
}

/// Adds a body of revolution about the vertical through `foot`. `profile` lists (radius, height) along the outside
/// from the bottom up.
pub fn lathe(mesh: &mut Mesh, foot: Vec3, profile: &[Vec2], segments: u32) {
    let first = mesh.positions.len() as u32;
    let last = profile.len() - 1;
    for (i, p) in profile.iter().enumerate() {
        let along = profile[(i + 1).min(last)] - profile[i.saturating_sub(1)];
        let outward = Vec2::new(along.y, -along.x).normalize_or(Vec2::X);
        for k in 0..=segments {
            let turn = k as f32 / segments as f32;
            let (s, c) = maths::sin_cos(std::f32::consts::TAU * turn);
            mesh.positions.push(foot + Vec3::new(p.x * c, p.y, -p.x * s));
            mesh.normals.push(Vec3::new(outward.x * c, outward.y, -outward.x * s));
            mesh.uvs[0].push(Vec2::new(turn, p.y));
        }
    }
    for i in 0..last as u32 {
        for k in 0..segments {
            let at = first + i * (segments + 1) + k;
            let above = at + segments + 1;
            mesh.triangles.extend([[at, at + 1, above + 1], [at, above + 1, above]]);
        }
    }
}

/// Adds an ellipsoid of revolution; `radius` holds its horizontal and its vertical radius.
pub fn ball(mesh: &mut Mesh, centre: Vec3, radius: Vec2, segments: u32) {
    let steps = segments / 2;
    let profile: Vec<Vec2> = (0..=steps)
        .map(|i| {
            let (s, c) = maths::sin_cos(std::f32::consts::PI * i as f32 / steps as f32);
            Vec2::new(s * radius.x, -c * radius.y)
        })
        .collect();
    lathe(mesh, centre, &profile, segments);
}

/// Rotates a mesh about the vertical through the origin, then moves it by `to`.
pub fn moved(mut mesh: Mesh, degrees: f32, to: Vec3) -> Mesh {
    let turn = maths::rotation_3d(Vec3::Y, degrees.to_radians());
    mesh.positions.iter_mut().for_each(|p| *p = turn * *p + to);
    mesh.normals.iter_mut().for_each(|n| *n = turn * *n);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computes the volume by the divergence theorem. It is positive if the faces point outwards.
    fn volume(mesh: &Mesh) -> f32 {
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn closed_shapes_face_outwards() {
        let mut cube = Mesh::default();
        cuboid(&mut cube, Vec3::new(1.0, 2.0, 3.0), Vec3::new(2.0, 4.0, 6.0));
        assert!((volume(&cube) - 6.0).abs() < 1e-4);
        let mut sphere = Mesh::default();
        ball(&mut sphere, Vec3::ONE, Vec2::splat(0.5), 64);
        assert!((volume(&sphere) - std::f32::consts::FRAC_PI_6).abs() < 0.005);
        for (p, n) in sphere.positions.iter().zip(&sphere.normals) {
            assert!(((*p - Vec3::ONE) * 2.0 - *n).length() < 0.06);
        }
    }

    #[test]
    fn openings_are_left_out() {
        let mut wall = Mesh::default();
        let openings = [[Vec2::new(1.0, 0.0), Vec2::new(2.0, 2.0)], [Vec2::new(3.0, 1.0), Vec2::new(4.0, 2.0)]];
        pierced(&mut wall, Vec3::ZERO, [Vec3::X, Vec3::Y], Vec2::new(5.0, 3.0), &openings, 0.5);
        let area: f32 =
            (0..wall.triangles.len()).map(|t| wall.corners(t)).map(|[a, b, c]| (b - a).cross(c - a).z / 2.0).sum();
        assert!((area - 12.0).abs() < 1e-4);
        assert!(wall.positions.iter().zip(&wall.uvs[0]).all(|(p, uv)| (p.truncate() - *uv).length() < 1e-5));
    }
}
