//! Groups the triangles of an object into planes.

use crate::error::{Error, Result};
use crate::image::try_collect;
use crate::scene::Scene;
use glam::DVec3;
use std::collections::BTreeMap;

/// Cosine of 2°, the maximum angle between the normals of a triangle and of its plane. Neighbouring sides of a cylinder
/// with 64 sides differ by 5.6°; with a maximum angle of up to 2.8°, no two of them belong to one plane. With a maximum
/// angle of 0.6° or more, a plane accepts a triangle that is 1/20 as long as the object and whose corners are off by
/// [`OFFSET`]. [convention]
const COS_ANGLE: f64 = 0.999_390_827;
/// Tolerance of planes, relative to the diagonal of the object's bounding box: corners lie within twice this distance
/// of their plane. In a room of 10 m, the tolerance is 5 mm. If the tolerance were 0.6 mm or more per metre of the
/// diagonal, the two faces of a board of 12 mm would be one plane in such a room. Any smaller value down to 1e-6 is far
/// above the rounding of positions in f32, and suffices for planes that are modelled exactly. [convention]
const OFFSET: f64 = 5e-4;
/// Side of a cell in the grid of unit normals: the angle of [`COS_ANGLE`] in radians. [convention]
const DIRECTION_CELL: f64 = 0.035;
/// Maximum number of normals for which planes are searched. The normals shared by the largest area of triangles come
/// first.
const DIRECTIONS: usize = 32;
/// Maximum number of planes returned.
const PLANES: usize = 16;
/// Minimum area of a plane relative to the area of the largest plane. [bench constants:surface]
const MIN_AREA: f64 = 0.05;

/// A triangle counts as sloped if it is inclined to the plane by 5 to 75 degrees; these are the cosines of 75 and 5
/// degrees. Steeper triangles are the edges of a slab; triangles of smaller inclination count as parallel to the plane.
/// [convention: luxfer_surface]
const SLOPED: [f64; 2] = [0.258_819_045, 0.996_194_698];

/// Triangles that lie in one plane, within tolerances.
pub struct Patch {
    pub triangles: Vec<(usize, usize)>,
    /// Unit normal of the plane, with an arbitrary sign.
    pub normal: DVec3,
    /// Centroid of the triangles.
    pub centre: DVec3,
    /// Area of the triangles in m².
    pub area: f64,
    /// Tolerance in metres: the corners lie within twice this distance of the plane.
    pub tolerance: f64,
}

#[derive(Clone, Copy)]
struct Facet {
    id: (usize, usize),
    /// Normal of the triangle; its length is the triangle's area.
    area_vector: DVec3,
    area: f64,
    centre: DVec3,
    corners: [DVec3; 3],
}

/// Returns the planes of the triangles, largest first, without small planes.
///
/// First the areas of the triangles are summed by normal, in the cells of a grid of unit vectors. Opposite normals
/// count as equal, since sheets may be wound either way. The cells with the largest sums give the normals of the
/// planes. For each normal, the triangles that have it are sorted by their offset along it. Triangles of about equal
/// offset form a plane.
pub fn planes(scene: &Scene, triangles: &[(usize, usize)]) -> Result<Vec<Patch>> {
    let facets = try_collect(triangles.iter().filter_map(|&id| facet(scene, id)))?;
    let no_area = || Error::degenerate(format!("its {} triangles have no area", triangles.len()));
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in facets.iter().flat_map(|f| f.corners) {
        low = low.min(corner);
        high = high.max(corner);
    }
    let tolerance = OFFSET * (high - low).length();

    // Accumulate the area of each direction in the cells of a grid; opposite directions count as one.
    let mut cells: BTreeMap<[i32; 3], (f64, DVec3)> = BTreeMap::new();
    for f in &facets {
        let direction = unsigned(f.area_vector / f.area);
        let cell = cells.entry((direction / DIRECTION_CELL).round().as_ivec3().to_array()).or_default();
        cell.0 += f.area;
        cell.1 += direction * f.area;
    }
    let mut directions: Vec<(f64, DVec3)> = cells.into_values().collect();
    directions.sort_by(|a, b| b.0.total_cmp(&a.0));

    // Find planes along each direction. A triangle belongs to the first plane that accepts it.
    let mut free = vec![true; facets.len()];
    let mut patches: Vec<Patch> = Vec::new();
    for &(_, direction) in directions.iter().take(DIRECTIONS) {
        let Some(direction) = direction.try_normalize() else { continue };
        while let Some(members) = heaviest(&facets, &free, direction, tolerance) {
            let largest = patches.iter().map(|p| p.area).fold(0.0, f64::max);
            let patch = gather(&facets, &members, tolerance);
            if patch.area < MIN_AREA * largest || patches.len() >= DIRECTIONS * PLANES {
                break;
            }
            members.iter().for_each(|&i| free[i] = false);
            patches.push(patch);
        }
    }
    patches.sort_by(|a, b| b.area.total_cmp(&a.area));
    let largest = patches.first().ok_or_else(no_area)?.area;
    patches.retain(|p| p.area >= MIN_AREA * largest);
    patches.truncate(PLANES);
    Ok(patches)
}

/// Area in m² of the triangles inclined to the plane of `normal` by 5 to 75 degrees, on either side.
pub fn sloped_area(scene: &Scene, triangles: &[(usize, usize)], normal: DVec3) -> f64 {
    let slopes = |f: &Facet| {
        let cosine = f.area_vector.dot(normal).abs() / f.area;
        SLOPED[0] < cosine && cosine < SLOPED[1]
    };
    // Use `fold`, because the `sum` of an empty list is -0.
    triangles.iter().filter_map(|&id| facet(scene, id)).filter(slopes).fold(0.0, |sum, f| sum + f.area)
}

fn facet(scene: &Scene, id: (usize, usize)) -> Option<Facet> {
    let corners = scene.meshes[id.0].corners(id.1).map(|p| p.as_dvec3());
    let [a, b, c] = corners;
    let area_vector = (b - a).cross(c - a) / 2.0;
    let area = area_vector.length();
    (area > 0.0 && area.is_finite()).then_some(Facet { id, area_vector, area, centre: (a + b + c) / 3.0, corners })
}

/// Maps two opposite directions to one of them: the direction whose first large component is positive. A component is
/// large if its magnitude is more than half of the largest magnitude; rounding might change the sign of smaller ones.
fn unsigned(direction: DVec3) -> DVec3 {
    let largest = direction.abs().max_element();
    let leading = direction.to_array().into_iter().find(|c| c.abs() > 0.5 * largest).unwrap_or(1.0);
    direction * leading.signum()
}

/// Returns the unassigned facets of the plane with the largest area among the planes perpendicular to `direction`;
/// `None` if no unassigned facet is perpendicular to `direction`.
fn heaviest(facets: &[Facet], free: &[bool], direction: DVec3, tolerance: f64) -> Option<Vec<usize>> {
    let mut offsets: Vec<(f64, usize)> = facets
        .iter()
        .enumerate()
        .filter(|&(i, f)| free[i] && f.area_vector.dot(direction).abs() >= COS_ANGLE * f.area)
        .map(|(i, f)| (direction.dot(f.centre), i))
        .collect();
    offsets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));

    // Slide a window of twice the tolerance over the sorted offsets and keep the window of largest area.
    let (mut first, mut area) = (0, 0.0);
    let mut best = (0.0, 0..0);
    for last in 0..offsets.len() {
        area += facets[offsets[last].1].area;
        while offsets[last].0 - offsets[first].0 > 2.0 * tolerance {
            area -= facets[offsets[first].1].area;
            first += 1;
        }
        if area > best.0 {
            best = (area, first..last + 1);
        }
    }
    let window = &offsets[best.1];
    if window.is_empty() {
        return None;
    }

    // Fit a plane to the facets in the window, and select the facets again by the normal and offset of this plane. Its
    // normal is more precise than `direction`, which is a mean over a cell of the grid of normals.
    let members: Vec<usize> = window.iter().map(|w| w.1).collect();
    let plane = gather(facets, &members, tolerance);
    let belongs = |f: &Facet| {
        f.area_vector.dot(plane.normal).abs() >= COS_ANGLE * f.area
            && f.corners.iter().all(|c| plane.normal.dot(*c - plane.centre).abs() <= 2.0 * tolerance)
    };
    let refined: Vec<usize> = (0..facets.len()).filter(|&i| free[i] && belongs(&facets[i])).collect();
    Some(if refined.is_empty() { members } else { refined })
}

fn gather(facets: &[Facet], members: &[usize], tolerance: f64) -> Patch {
    let reference = members.first().map_or(DVec3::Y, |&i| facets[i].area_vector);
    let (mut normal, mut centre, mut area) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for f in members.iter().map(|&i| &facets[i]) {
        normal += f.area_vector * f.area_vector.dot(reference).signum();
        centre += f.centre * f.area;
        area += f.area;
    }
    let triangles = members.iter().map(|&i| facets[i].id).collect();
    Patch { triangles, normal: normal.normalize_or(DVec3::Y), centre: centre / area, area, tolerance }
}
