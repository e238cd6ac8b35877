//! Groups triangles into planes.

use crate::error::{Error, Result};
use crate::image::try_collect;
use crate::scene::Scene;
use glam::DVec3;
use std::collections::BTreeMap;

/// Maximum angle between a triangle and its plane: 2° [origin not recorded].
const COS_ANGLE: f64 = 0.999_390_827;
/// Maximum distance of the corners from the plane, relative to the diagonal of the object [origin not recorded].
const OFFSET: f64 = 5e-4;
/// Side of a cell in the grid of directions: the angle of [`COS_ANGLE`] [convention].
const DIRECTION_CELL: f64 = 0.035;
/// Maximum number of directions examined, largest area first.
const DIRECTIONS: usize = 32;
/// Maximum number of planes returned, and the minimum area of a plane relative to the largest [origin not recorded].
const PLANES: usize = 16;
const MIN_AREA: f64 = 0.05;

/// Cosines of 75 and 5 degrees: triangles between them belong neither to the plane nor to the edges of a slab
/// [convention: luxfer_surface].
const SLOPED: [f64; 2] = [0.258_819_045, 0.996_194_698];

/// Coplanar triangles.
pub struct Patch {
    pub triangles: Vec<(usize, usize)>,
    /// Unit normal; its sign has no meaning yet.
    pub normal: DVec3,
    /// Centroid.
    pub centre: DVec3,
    /// Area in m².
    pub area: f64,
    /// Maximum distance of corners from the plane, in metres.
    pub tolerance: f64,
}

#[derive(Clone, Copy)]
struct Facet {
    id: (usize, usize),
    /// A normal vector whose length is the area.
    area_vector: DVec3,
    area: f64,
    centre: DVec3,
    corners: [DVec3; 3],
}

/// The planes among the triangles, largest first; small ones are left out.
///
/// Normals are compared without sign, since sheets may be wound either way. Directions are accumulated in the cells of
/// a grid, weighted by area. Along the directions of the heaviest cells, planes are found by their offsets.
pub fn planes(scene: &Scene, triangles: &[(usize, usize)]) -> Result<Vec<Patch>> {
    let facets = try_collect(triangles.iter().filter_map(|&id| facet(scene, id)))?;
    let no_area = || Error::degenerate(format!("its {} triangles have no area", triangles.len()));
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in facets.iter().flat_map(|f| f.corners) {
        low = low.min(corner);
        high = high.max(corner);
    }
    let tolerance = OFFSET * (high - low).length();

    // Accumulate the area in each cell of directions, combining opposite directions.
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

/// Area of the triangles that slope from a plane, on either side.
pub fn bent(scene: &Scene, triangles: &[(usize, usize)], normal: DVec3) -> f64 {
    let slopes = |f: &Facet| {
        let cosine = f.area_vector.dot(normal).abs() / f.area;
        SLOPED[0] < cosine && cosine < SLOPED[1]
    };
    // `sum` would start at -0.
    triangles.iter().filter_map(|&id| facet(scene, id)).filter(slopes).fold(0.0, |sum, f| sum + f.area)
}

fn facet(scene: &Scene, id: (usize, usize)) -> Option<Facet> {
    let corners = scene.meshes[id.0].corners(id.1).map(|p| p.as_dvec3());
    let [a, b, c] = corners;
    let area_vector = (b - a).cross(c - a) / 2.0;
    let area = area_vector.length();
    (area > 0.0 && area.is_finite()).then_some(Facet { id, area_vector, area, centre: (a + b + c) / 3.0, corners })
}

/// The direction or its opposite, chosen by a fixed rule.
fn unsigned(direction: DVec3) -> DVec3 {
    let largest = direction.abs().max_element();
    let leading = direction.to_array().into_iter().find(|c| c.abs() > 0.5 * largest).unwrap_or(1.0);
    direction * leading.signum()
}

/// The unassigned facets of the plane of largest area perpendicular to a direction.
fn heaviest(facets: &[Facet], free: &[bool], direction: DVec3, tolerance: f64) -> Option<Vec<usize>> {
    let mut offsets: Vec<(f64, usize)> = facets
        .iter()
        .enumerate()
        .filter(|&(i, f)| free[i] && f.area_vector.dot(direction).abs() >= COS_ANGLE * f.area)
        .map(|(i, f)| (direction.dot(f.centre), i))
        .collect();
    offsets.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));

    // Slide a window of twice the tolerance over the sorted offsets.
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

    // Refine membership by the plane's own normal and offset: the cell's direction is only approximate.
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
