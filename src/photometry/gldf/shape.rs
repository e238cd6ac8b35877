//! The opening of an emitter: either the opening of its photometry, turned together with the emitter, or the simple
//! geometry of the variant.

use super::super::luminaire::Luminaire;
use super::super::opening::Opening;
use super::super::xml::Element;
use crate::error::{Error, ErrorKind, Result};

/// Largest size in millimetres. [convention]
const MAX_SIZE: f64 = 1e7;

/// The luminous opening that a simple geometry states, in metres.
pub struct Shape {
    /// Sizes along C = 0 and along C = 90, negative if they are diameters; `None` if the geometry states no luminous
    /// face.
    sides: Option<[f64; 2]>,
    /// Luminous heights of the sides that face towards C = 0, 90, 180 and 270; `None` if the geometry states no
    /// heights.
    heights: Option<[f64; 4]>,
}

impl Shape {
    /// Reads the simple geometry to which a variant's `Geometry` element refers; `None` if the element refers to none.
    pub fn of(definitions: Element, geometry: Element) -> Result<Option<Self>> {
        let inner = geometry.find("GeometryReferences").unwrap_or(geometry);
        let Some(reference) = inner.find("SimpleGeometryReference") else { return Ok(None) };
        let id = reference.attribute("geometryId").unwrap_or("");
        let mut all = definitions.find("Geometries").into_iter().flat_map(|list| list.all("SimpleGeometry"));
        let Some(shape) = all.find(|shape| shape.attribute("id") == Some(id)) else {
            return Err(reference.error(format_args!("Geometries has no SimpleGeometry with the id {id:?}")));
        };
        let metres = |path: &str| Ok(shape.number_at(path, 0.0, MAX_SIZE)?.unwrap_or(0.0) / 1e3);
        let diameter = metres("CircularEmitter/Diameter")?;
        // The width lies along X, towards C = 0, and the length along Y.
        let sides = [metres("RectangularEmitter/Width")?, metres("RectangularEmitter/Length")?];
        let sides = if diameter > 0.0 { [-diameter; 2] } else { sides };
        let mut heights = [0.0; 4];
        for (height, name) in heights.iter_mut().zip(["C0", "C90", "C180", "C270"]) {
            *height = metres(&format!("C-Heights/{name}"))?;
        }
        let has_heights = shape.find("C-Heights").is_some();
        Ok(Some(Self { sides: (sides != [0.0; 2]).then_some(sides), heights: has_heights.then_some(heights) }))
    }

    /// Replaces the opening of a luminaire by this shape. Sizes or heights that the geometry does not state keep the
    /// values of the photometry.
    fn replace(&self, luminaire: &mut Luminaire) {
        if let Some([x, y]) = self.sides {
            luminaire.size = [x, y, luminaire.size[2].abs()];
        }
        if let Some(heights) = self.heights {
            let height = heights.into_iter().fold(0.0, f64::max);
            luminaire.size[2] = height;
            luminaire.side_heights = heights.iter().any(|h| *h != height).then_some(heights);
        }
        if luminaire.size.iter().any(|size| *size < 0.0) {
            luminaire.side_heights = None;
        }
    }
}

/// Returns the luminaire of an emitter, turned about its axis by the emitter's rotation. The simple geometry of the
/// variant, if any, replaces the opening and is not turned.
///
/// # Errors
/// `Unsupported` for turns about other axes, and for turns of an opening that is not round by angles other than
/// multiples of 90 degrees, unless a simple geometry replaces the opening.
pub fn placed(light: Element, mut luminaire: Luminaire, shape: Option<&Shape>) -> Result<Luminaire> {
    let by = angle(light)?;
    turn(by, &mut luminaire);
    let is_turned = turn_opening(by, &mut luminaire);
    match shape {
        Some(shape) => shape.replace(&mut luminaire),
        None if is_turned => {}
        None => {
            let (line, [x, y, z]) = (light.line(), luminaire.bounds());
            let message = format!(
                "line {line}: the emitter is turned by {by} degrees about the axis Z, and its opening of {x} x {y} x \
                 {z} m is not round; only round openings are turned by other angles than 90, 180 and 270 degrees"
            );
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
    }
    Ok(luminaire)
}

/// Returns the angle in degrees by which the emitter is turned about the axis Z.
fn angle(light: Element) -> Result<f64> {
    let angle = |name: &str| Ok(light.number_at(&format!("Rotation/{name}"), 0.0, 360.0)?.unwrap_or(0.0) % 360.0);
    let [x, y, z, g0] = [angle("X")?, angle("Y")?, angle("Z")?, angle("G0")?];
    if x != 0.0 || y != 0.0 {
        let message = format!(
            "line {}: the emitter is turned by {x} and {y} degrees about the axes X and Y; only turns about the axis Z \
             are read",
            light.line()
        );
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    Ok((z + g0) % 360.0)
}

/// Turns the distribution of a luminaire about its axis by `by` degrees.
fn turn(by: f64, luminaire: &mut Luminaire) {
    let n = luminaire.gammas.len();
    if by == 0.0 || luminaire.planes.len() == 1 {
        return;
    }
    // The list of planes must contain C = 0. If no turned plane lies there, interpolate a plane for it.
    let zero: Vec<f64> = luminaire.gammas.iter().map(|gamma| luminaire.intensity(-by, *gamma)).collect();
    let mut planes: Vec<(f64, Vec<f64>)> = luminaire
        .planes
        .iter()
        .zip(luminaire.candela.chunks(n))
        .map(|(c, values)| ((c + by) % 360.0, values.to_vec()))
        .collect();
    if planes.iter().all(|(c, _)| *c != 0.0) {
        planes.push((0.0, zero));
    }
    planes.sort_by(|a, b| a.0.total_cmp(&b.0));
    luminaire.planes = planes.iter().map(|(c, _)| *c).collect();
    luminaire.candela = planes.into_iter().flat_map(|(_, values)| values).collect();
}

/// Turns the opening of a luminaire about its axis by `by` degrees. Returns false if the luminaire cannot represent the
/// turned opening: a round opening can be turned by any angle, any other opening only by multiples of 90 degrees.
fn turn_opening(by: f64, luminaire: &mut Luminaire) -> bool {
    let is_round = match luminaire.opening() {
        None => true,
        Some(Opening::Cylinder { axis, diameters: [a, b], .. }) => axis == 2 && a == b,
        Some(Opening::Ellipsoid(diameters)) => diameters.x == diameters.y,
        Some(Opening::Box { .. }) => false,
    };
    if by % 90.0 != 0.0 {
        return is_round;
    }
    let quarters = (by / 90.0) as usize;
    if quarters % 2 == 1 {
        luminaire.size.swap(0, 1);
    }
    if let Some(heights) = &mut luminaire.side_heights {
        heights.rotate_right(quarters);
    }
    true
}
