//! The luminous intensities of an emitter: a list of directions and values in any order, which form a grid of planes
//! and vertical angles.

use super::super::symmetry::unfold;
use super::super::text_lines::{MAX_ANGLES, MAX_VALUES};
use super::super::xml::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::image::{try_vec, try_with_capacity};

/// The largest intensity in candela. [convention]
const MAX_INTENSITY: f64 = 1e12;

/// A luminous intensity distribution in C planes over the full circle, as in `Luminaire`.
pub struct Distribution {
    pub planes: Vec<f64>,
    pub gammas: Vec<f64>,
    pub candela: Vec<f64>,
}

/// A horizontal and a vertical angle in degrees, and the intensity in candela in their direction.
type Point = [f64; 3];

/// Reads the intensities in `element`, whose children are `IntData` or `IntensityData`.
pub fn read(element: Element) -> Result<Distribution> {
    let points = points(element)?;
    let angles = |i: usize| {
        let mut angles: Vec<f64> = points.iter().map(|point| point[i]).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    };
    let (mut stored, gammas) = (angles(0), angles(1));
    for (what, name, angles) in [("horizontal", "NumberHorz", &stored), ("vertical", "NumberVert", &gammas)] {
        if angles.len() > MAX_ANGLES {
            let n = angles.len();
            return Err(element.error(format_args!("{n} {what} angles; at most {MAX_ANGLES} are read")));
        }
        let stated = element.number_at(name, 0.0, 1e9)?;
        if stated.is_some_and(|stated| stated != angles.len() as f64) {
            let message = format!("{name} is {}, but there are {} {what} angles", stated.unwrap_or(0.0), angles.len());
            return Err(element.error(message));
        }
    }
    let mut values = grid(element, &points, &stored, &gammas)?;
    if check_symmetry(element, &stored)? {
        (stored, values) = mirrored(&stored, &values, gammas.len());
    }
    let (planes, candela) =
        unfold(&stored, &values, gammas.len()).map_err(|e| e.context(format_args!("line {}", element.line())))?;
    Ok(Distribution { planes, gammas, candela })
}

/// Reads the list of directions and intensities.
fn points(element: Element) -> Result<Vec<Point>> {
    let is_point = |child: &Element| matches!(child.name(), "IntData" | "IntensityData");
    let count = element.children().filter(is_point).count();
    let stated = element.number_at("NumberMeasured", 0.0, 1e9)?;
    if stated.is_some_and(|stated| stated != count as f64) {
        let stated = stated.unwrap_or(0.0);
        return Err(element.error(format_args!("NumberMeasured is {stated}, but there are {count} intensities")));
    }
    if count == 0 || count > MAX_VALUES {
        return Err(element.error(format_args!("{count} intensities; 1 to {MAX_VALUES} are read")));
    }
    let mut points = try_with_capacity(count)?;
    for child in element.children().filter(is_point) {
        let angle = |names: [&str; 3], high: f64| {
            let found = names.iter().find_map(|name| child.number_of(name, 0.0, high).transpose());
            found.unwrap_or_else(|| Err(child.error(format_args!("an intensity has no attribute {}", names[0]))))
        };
        let (c, gamma) = (angle(["h", "horz", "horizontal"], 360.0)?, angle(["v", "vert", "vertical"], 180.0)?);
        points.push([c, gamma, child.number(0.0, MAX_INTENSITY)?]);
    }
    Ok(points)
}

/// Sorts the intensities into a grid, plane by plane. All planes meet at γ = 0 and at γ = 180; a single intensity there
/// holds for all planes.
fn grid(element: Element, points: &[Point], planes: &[f64], gammas: &[f64]) -> Result<Vec<f64>> {
    let n = gammas.len();
    if planes.len() * n > MAX_VALUES {
        let m = planes.len();
        return Err(element.error(format_args!("{m} x {n} intensities; at most {MAX_VALUES} are read")));
    }
    let mut values = try_vec(planes.len() * n, f64::NAN)?;
    for [c, gamma, value] in points {
        let plane = planes.partition_point(|p| p < c);
        let place = &mut values[plane * n + gammas.partition_point(|g| g < gamma)];
        if !place.is_nan() {
            return Err(element.error(format_args!("two intensities have the direction h = {c}, v = {gamma}")));
        }
        *place = *value;
    }
    for column in (0..n).filter(|column| gammas[*column] == 0.0 || gammas[*column] == 180.0) {
        let mut known = (0..planes.len()).map(|plane| values[plane * n + column]).filter(|v| !v.is_nan());
        if let (Some(value), None) = (known.next(), known.next()) {
            (0..planes.len()).for_each(|plane| values[plane * n + column] = value);
        }
    }
    match values.iter().position(|v| v.is_nan()) {
        None => Ok(values),
        Some(i) => {
            let (c, gamma) = (planes[i / n], gammas[i % n]);
            let message = format!(
                "line {}: the directions form no grid: no intensity has the direction h = {c}, v = {gamma}",
                element.line()
            );
            Err(Error::new(ErrorKind::Unsupported, message))
        }
    }
}

/// Mirrors the planes from 270 through 0 to 90 about the plane through 90 and 270. The mirrored planes ascend from 90
/// to 270.
fn mirrored(planes: &[f64], values: &[f64], gammas: usize) -> (Vec<f64>, Vec<f64>) {
    let images = planes.iter().map(|c| (180.0 - c).rem_euclid(360.0)).zip(values.chunks(gammas));
    let mut images: Vec<(f64, &[f64])> = images.collect();
    images.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Planes at 0 and at 360 are the same plane: keep one of them.
    images.dedup_by(|a, b| a.0 == b.0);
    (images.iter().map(|(c, _)| *c).collect(), images.iter().flat_map(|(_, values)| values.iter().copied()).collect())
}

/// Checks that the planes suffice for the symmetry that the file states. The symmetry itself follows from the range of
/// the planes, because TM-33-18 has no element for it. This range cannot tell the half circle from 270 through 0 to 90
/// from the full circle; returns true if the planes are that half circle.
fn check_symmetry(element: Element, planes: &[f64]) -> Result<bool> {
    let stated = [element.text_at("Symm"), element.text_at("SymmType")].concat();
    let symmetry: String = stated.chars().filter(|c| c.is_ascii_alphanumeric()).collect();
    let (first, last) = (planes[0], planes[planes.len() - 1]);
    let is_whole = first == 0.0 && last > 180.0;
    let is_behind = |c: &f64| *c > 90.0 && *c < 270.0;
    let is_before_90 = planes.contains(&90.0) && planes.contains(&270.0) && !planes.iter().any(is_behind);
    let symmetry = symmetry.to_ascii_lowercase();
    if symmetry == "symmbi90" && is_before_90 {
        return Ok(true);
    }
    let is_covered = match symmetry.as_str() {
        "symmnone" | "symmarbitrary" => is_whole,
        "symmbi0" => is_whole || (first, last) == (0.0, 180.0),
        "symmbi90" => is_whole && planes.iter().any(is_behind) || (first, last) == (90.0, 270.0),
        "symmquad" => is_whole || (first == 0.0 && (last == 90.0 || last == 180.0)),
        "symmfull" | "" => true,
        _ => {
            let known = "Symm_None, Symm_Arbitrary, Symm_Bi_0, Symm_Bi_90, Symm_Quad and Symm_Full";
            return Err(element.error(format_args!("the symmetry is {stated:?}; {known} are read")));
        }
    };
    if !is_covered {
        let message = format!("the symmetry is {stated}, but the horizontal angles go from {first} to {last}");
        return Err(element.error(message));
    }
    Ok(false)
}
