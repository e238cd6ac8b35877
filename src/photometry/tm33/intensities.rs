//! The luminous intensities of an emitter: a list of directions and values in any order, which form a grid of planes
//! and vertical angles.

use super::super::symmetry::unfold;
use super::super::text_lines::{MAX_ANGLES, MAX_VALUES};
use super::super::xml::Element;
use crate::error::{Error, ErrorKind, Result};
use crate::image::{try_vec, try_with_capacity};

/// The largest intensity in candela. [convention]
const MAX_INTENSITY: f64 = 1e12;

/// A distribution in all planes of the circle.
pub struct Distribution {
    pub planes: Vec<f64>,
    pub gammas: Vec<f64>,
    pub candela: Vec<f64>,
}

/// An intensity in the direction of a horizontal and a vertical angle.
type Point = [f64; 3];

/// Reads the intensities in `element`, which holds `IntData` or `IntensityData`.
pub fn read(element: Element) -> Result<Distribution> {
    let points = points(element)?;
    let angles = |i: usize| {
        let mut angles: Vec<f64> = points.iter().map(|point| point[i]).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    };
    let (stored, gammas) = (angles(0), angles(1));
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
    let values = grid(element, &points, &stored, &gammas)?;
    check_symmetry(element, &stored)?;
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
        let value = match child.text().parse() {
            Ok(value) if (0.0..=MAX_INTENSITY).contains(&value) => value,
            _ => child.number(0.0, MAX_INTENSITY)?,
        };
        points.push([c, gamma, value]);
    }
    Ok(points)
}

/// Sorts the intensities into a grid, plane by plane. At γ = 0 and 180, where all planes meet, one value does for all.
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

/// Checks that the planes cover what the stated symmetry needs. The symmetry itself follows from their range, as in
/// TM-33-18, which has no element for it.
fn check_symmetry(element: Element, planes: &[f64]) -> Result<()> {
    let stated = [element.text_at("Symm"), element.text_at("SymmType")].concat();
    let symmetry: String = stated.chars().filter(|c| c.is_ascii_alphanumeric()).collect();
    let (first, last) = (planes[0], planes[planes.len() - 1]);
    let is_whole = first == 0.0 && last > 180.0;
    let is_covered = match symmetry.to_ascii_lowercase().as_str() {
        "symmnone" | "symmarbitrary" => is_whole,
        "symmbi0" => is_whole || (first, last) == (0.0, 180.0),
        "symmbi90" => is_whole || (first, last) == (90.0, 270.0),
        "symmquad" => is_whole || (first == 0.0 && (last == 90.0 || last == 180.0)),
        "symmfull" | "" => true,
        _ => return Err(element.error(format_args!("the symmetry is {stated:?}, which TM-33 does not define"))),
    };
    if !is_covered {
        let message = format!("the symmetry is {stated}, but the horizontal angles go from {first} to {last}");
        return Err(element.error(message));
    }
    Ok(())
}
