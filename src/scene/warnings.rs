//! Warnings about signs that a scene will not be rendered as its author intended.

use super::{PunctualLight, Scene};
use crate::maths;
use crate::warning::{Code, Warning};
use glam::{DVec3, Vec3};

/// Height in metres above which the unit of a scene is probably not the metre. Few interiors are higher than this,
/// whereas rooms of 2 to 4 m given in inches are 79 to 157 units high, and higher in smaller units. [convention]
pub const MAX_HEIGHT: f64 = 50.0;

/// Width in metres above which the unit of a scene is probably not the metre. This limit serves for scenes without
/// height, such as a plan or a ceiling alone. Few halls are longer than 1 km, whereas a room of 3 m is 3000 units wide
/// in millimetres. [convention]
pub const MAX_WIDTH: f64 = 2000.0;

/// If the larger of height and width is below this value in metres, the unit of a scene is probably not the metre: even
/// a table lamp is larger. [convention]
pub const MIN_EXTENT: f64 = 0.2;

/// Height and width of a typical room in metres. A warning suggests the unit that brings the scene closest to this
/// size. [convention]
const USUAL_HEIGHT: f64 = 3.0;
const USUAL_WIDTH: f64 = 6.0;

/// Maximum number of lights that a warning describes; further lights are only counted.
const MAX_LISTED: usize = 3;

/// Units smaller than the metre in which modelling programs write scenes, with their length in metres. [convention]
const SMALL_UNITS: [(&str, f64); 3] = [("the millimetre", 0.001), ("the centimetre", 0.01), ("the inch", 0.0254)];

/// Units larger than the metre, with their length in metres. A warning suggests one of them for a scene that is too
/// small because it was scaled down once too often. [convention]
const LARGE_UNITS: [(&str, f64); 3] = [("ten metres", 10.0), ("a hundred metres", 100.0), ("the kilometre", 1000.0)];

/// Maximum distance in metres between neighbouring `f32` values at the scene's largest coordinate: half a millimetre.
/// Coordinates below 8192 m keep this limit (0.49 mm); from 8192 m on, the distance is 0.98 mm or more. With coarser
/// values, walls, lamps and panes that lie close together would merge. [convention]
pub const MAX_SPACING: f64 = 0.0005;

impl Scene {
    pub fn warnings(&self) -> Vec<Warning> {
        let unrendered = self.unrendered.iter().map(|feature| {
            let advice =
                "compare a rendering with the program that wrote the file; bake the feature into meshes and textures";
            Warning::new(Code::NotRendered, feature.count as f64, 0.0, feature.to_string(), advice)
        });
        self.implausible_size()
            .into_iter()
            .chain(self.far_away())
            .chain(unrendered)
            .chain(self.not_in_picture())
            .collect()
    }

    /// Warns if the importer moved the scene to an origin other than the origin of its file. Otherwise, warns if
    /// coordinates are so large that neighbouring `f32` values differ by more than [`MAX_SPACING`].
    fn far_away(&self) -> Option<Warning> {
        if self.origin != DVec3::ZERO {
            let [x, y, z] = self.origin.to_array();
            let message = format!(
                "the scene lies {} m from the origin of its file: positions are relative to ({x}, {y}, {z})",
                significant(self.origin.length())
            );
            let advice = "subtract luxfer_scene_get_origin from positions in the coordinates of the file, or load it with \
                          keep_origin = 1";
            return Some(Warning::new(Code::FarFromOrigin, self.origin.length(), 0.0, message, advice));
        }
        let (low, high) = self.bounds()?;
        // The largest coordinate has the coarsest rounding.
        let largest = low.abs().max(high.abs()).max_element();
        let spacing = f64::from(largest.next_up() - largest);
        Warning::above(
            Code::FarFromOrigin,
            spacing,
            MAX_SPACING,
            || {
                let (far, step) = (significant(f64::from(largest)), significant(spacing * 1000.0));
                format!("coordinates of vertices reach {far} m, where f32 rounds them to steps of {step} mm")
            },
            "store vertices relative to their nodes, and place the nodes by translations, or move the scene to the origin",
        )
    }

    /// Number of lights that shine from a point and are therefore invisible in renderings: point lights, spot lights,
    /// and luminaires without faces. Lights with zero intensity do not count.
    pub fn unseen_lights(&self) -> usize {
        let is_unseen = |light: &&PunctualLight| match light {
            PunctualLight::Point { intensity, .. } | PunctualLight::Spot { intensity, .. } => {
                intensity.max_element() > 0.0
            }
            PunctualLight::Luminaire { colour, .. } => {
                colour.max_element() > 0.0 && light.opening(&self.distributions).is_none()
            }
            PunctualLight::Directional { .. } => false,
        };
        self.lights.iter().filter(is_unseen).count()
    }

    /// Warns if the scene has luminaires that shine from points, because they are invisible in renderings. A luminaire
    /// shines from a point if its file states no luminous size, or if the caller asked for it (`is_point`). Point and
    /// spot lights raise no warning, because nobody expects to see them in a rendering.
    fn not_in_picture(&self) -> Option<Warning> {
        let luminaire = |(index, light): (usize, &PunctualLight)| match *light {
            PunctualLight::Luminaire { position, colour, .. }
                if colour.max_element() > 0.0 && light.opening(&self.distributions).is_none() =>
            {
                Some((index, position))
            }
            _ => None,
        };
        let luminaires: Vec<_> = self.lights.iter().enumerate().filter_map(luminaire).collect();
        let count = luminaires.len();
        let describe = |(index, p): &(usize, Vec3)| format!("light {index}, a luminaire at {p}");
        let mut listed: Vec<String> = luminaires.iter().take(MAX_LISTED).map(describe).collect();
        listed.extend((count > MAX_LISTED).then(|| format!("and {} more", count - MAX_LISTED)));
        let message = format!("pictures do not show luminaires that shine from points: {}", listed.join("; "));
        let advice = "state their luminous size in their files, and let them shine from their faces; \
                      luxfer_scene_get_glare rates luminaires with a size, luxfer_image_get_glare only what a picture \
                      shows";
        (count > 0).then(|| Warning::new(Code::NotInPicture, count as f64, 0.0, message, advice))
    }

    /// Warns if the extent of the scene suggests a unit other than the metre, because the scene is too high, too wide
    /// or too small. Only the first of these defects is reported.
    pub fn implausible_size(&self) -> Option<Warning> {
        let (low, high) = self.bounds()?;
        let extent = (high - low).as_dvec3();
        let (height, width) = (extent.y, extent.x.max(extent.z));
        let warn = |word: &str, size: f64, limit: f64, usual: f64, units: &[(&str, f64)]| {
            let distance = |unit: f64| maths::ln(size * unit / usual).abs();
            let (name, unit) = units.iter().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?;
            let (size_text, likely) = (significant(size), significant(size * unit));
            let message =
                format!("the scene is {size_text} m {word}; its unit may be {name}, and it {likely} m {word}");
            let advice =
                format!("load it with unit = {unit} (luxfer_scene_load_params), or scale it where it was made");
            Some(Warning::new(Code::ImplausibleSize, size, limit, message, &advice))
        };
        if height > MAX_HEIGHT {
            warn("high", height, MAX_HEIGHT, USUAL_HEIGHT, &SMALL_UNITS)
        } else if width > MAX_WIDTH {
            warn("wide", width, MAX_WIDTH, USUAL_WIDTH, &SMALL_UNITS)
        } else if height.max(width) > 0.0 && height.max(width) < MIN_EXTENT {
            let (word, size, usual) =
                if height >= width { ("high", height, USUAL_HEIGHT) } else { ("wide", width, USUAL_WIDTH) };
            warn(word, size, MIN_EXTENT, usual, &LARGE_UNITS)
        } else {
            None
        }
    }

    /// Returns the corners of the bounding box of all triangles; `None` without a finite position.
    fn bounds(&self) -> Option<(Vec3, Vec3)> {
        let positions = self
            .meshes
            .iter()
            .flat_map(|mesh| mesh.triangles.iter().flatten().filter_map(|&i| mesh.positions.get(i as usize).copied()));
        let finite = positions.filter(|p| p.is_finite());
        finite.fold(None, |bounds, p| {
            let (low, high) = bounds.unwrap_or((p, p));
            Some((low.min(p), high.max(p)))
        })
    }
}

/// Formats a length without an exponent, with three significant digits but with all digits before the decimal point:
/// 2712, 4.56, 0.0123. Zeros at the end of a fraction are omitted: 4.5.
fn significant(length: f64) -> String {
    let digits = 2.0 - maths::log10(length).floor();
    let text = format!("{length:.*}", digits.clamp(0.0, 12.0) as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::Luminaire;
    use crate::scene::Mesh;
    use crate::scene::unrendered::note;

    /// A scene with one square wall of side `height`, in metres.
    fn room(height: f32) -> Scene {
        let wall = Mesh::parallelogram(Vec3::ZERO, Vec3::X * height, Vec3::Y * height, 0);
        Scene { meshes: vec![wall], ..Scene::default() }
    }

    #[test]
    fn a_room_in_another_unit_is_noticed_with_the_unit() {
        assert!(room(2.7).warnings().is_empty() && room(48.0).warnings().is_empty());
        assert!(Scene::default().warnings().is_empty());
        for (height, unit) in [(2700.0, "0.001"), (4000.0, "0.001"), (250.0, "0.01"), (400.0, "0.01"), (96.0, "0.0254")]
        {
            let warnings = room(height).warnings();
            assert_eq!(warnings.len(), 1, "{height}");
            let warning = &warnings[0];
            assert_eq!((warning.code, warning.severity), (Code::ImplausibleSize, f64::from(height)));
            assert!(warning.advice.contains(&format!("unit = {unit} ")), "{height}: {warning}");
        }
    }

    #[test]
    fn a_plan_without_height_is_noticed_by_its_width() {
        let plan = |width: f32| {
            let floor = Mesh::parallelogram(Vec3::ZERO, Vec3::X * width, Vec3::Z * width / 2.0, 0);
            Scene { meshes: vec![floor], ..Scene::default() }
        };
        assert!(plan(1500.0).warnings().is_empty() && plan(0.3).warnings().is_empty());
        let warnings = plan(8000.0).warnings();
        assert_eq!((warnings[0].severity, warnings[0].limit), (8000.0, MAX_WIDTH));
        assert!(warnings[0].message.contains("8000 m wide"), "{}", warnings[0]);
        assert!(warnings[0].advice.contains("unit = 0.001 "), "{}", warnings[0]);
    }

    #[test]
    fn a_room_that_is_too_small_is_noticed_with_the_unit() {
        assert!(room(0.25).warnings().is_empty());
        // A scene of no extent suggests no unit.
        assert_eq!(room(0.0).warnings(), []);
        for (height, unit) in [(0.0027, "1000"), (0.03, "100"), (0.07, "100")] {
            let warnings = room(height).warnings();
            assert_eq!(warnings.len(), 1, "{height}");
            assert_eq!((warnings[0].code, warnings[0].limit), (Code::ImplausibleSize, MIN_EXTENT));
            assert!(warnings[0].advice.contains(&format!("unit = {unit} ")), "{height}: {}", warnings[0]);
        }
        assert!(room(0.0027).warnings()[0].message.starts_with("the scene is 0.0027 m high"));
    }

    #[test]
    fn a_scene_far_from_the_origin_is_noticed() {
        let wall = |x: f32| Mesh::parallelogram(Vec3::X * x, Vec3::X * 4.0, Vec3::Y * 3.0, 0);
        let scene = |x: f32| Scene { meshes: vec![wall(x)], ..Scene::default() };
        assert!(scene(2000.0).warnings().is_empty());
        let warnings = scene(1e5).warnings();
        assert_eq!((warnings.len(), warnings[0].code, warnings[0].severity), (1, Code::FarFromOrigin, 0.0078125));
        assert!(warnings[0].message.contains("100004 m") && warnings[0].message.contains("7.81 mm"), "{}", warnings[0]);
        // The positions are small, so they are stored precisely. The warning is still due: the positions differ from
        // the positions in the file, because the importer moved the origin.
        let moved = Scene { origin: DVec3::new(3e5, 0.0, -4e5), ..scene(0.0) };
        let warnings = moved.warnings();
        assert_eq!((warnings[0].severity, warnings[0].limit), (5e5, 0.0));
        assert!(warnings[0].message.contains("(300000, 0, -400000)"), "{}", warnings[0]);
    }

    #[test]
    fn lights_that_no_picture_shows_are_listed_with_their_places() {
        let mut scene = room(3.0);
        let position = Vec3::new(1.0, 2.5, 0.0);
        scene.lights.push(PunctualLight::Directional {
            direction: Vec3::NEG_Y,
            illuminance: Vec3::ONE,
            half_angle: 0.0,
        });
        scene.lights.push(PunctualLight::Point { position, intensity: Vec3::ZERO });
        assert_eq!(scene.warnings(), []);
        scene.lights.push(PunctualLight::Point { position, intensity: Vec3::ONE });
        assert_eq!((scene.warnings(), scene.unseen_lights()), (Vec::new(), 1));
        let luminaire = |distribution, is_point| {
            let (axis, c0, colour) = (Vec3::NEG_Y, Vec3::X, Vec3::ONE);
            PunctualLight::Luminaire { position, axis, c0, colour, distribution, is_point }
        };
        // Distribution 1 has a luminous size, so its luminaire is visible, unless `is_point` is true.
        let sizes = [[0.0; 3], [0.6, 0.6, 0.0]];
        scene.distributions = sizes.map(|size| Luminaire::lambertian("", 1000.0, size).into()).into();
        scene.lights.push(luminaire(1, false));
        assert_eq!((scene.warnings(), scene.unseen_lights()), (Vec::new(), 1));
        scene.lights.pop();
        scene.lights.extend([luminaire(0, false), luminaire(1, true)]);
        scene.lights.extend([luminaire(0, false); 3]);
        let warnings = scene.warnings();
        assert_eq!((warnings[0].code, warnings[0].severity, warnings.len()), (Code::NotInPicture, 5.0, 1));
        let message = &warnings[0].message;
        assert!(
            message.contains("light 3, a luminaire at [1, 2.5, 0]") && message.ends_with("and 2 more"),
            "{message}"
        );
    }

    #[test]
    fn lengths_have_three_digits() {
        let texts = [2700.0, 60_000.4, 4.5, 0.012_345, 1e-9].map(significant);
        assert_eq!(texts, ["2700", "60000", "4.5", "0.0123", "0.000000001"]);
    }

    #[test]
    fn each_feature_that_is_not_rendered_is_a_warning() {
        let mut scene = room(3.0);
        note(&mut scene.unrendered, "skins", "no pose", || "node 1".into());
        note(&mut scene.unrendered, "skins", "no pose", || "node 2".into());
        note(&mut scene.unrendered, "COLOR_0", "one colour", || "mesh 1".into());
        let warnings = scene.warnings();
        assert_eq!(
            warnings.iter().map(|w| (w.code, w.severity)).collect::<Vec<_>>(),
            [(Code::NotRendered, 2.0), (Code::NotRendered, 1.0)]
        );
        assert!(warnings[0].message.contains("node 1, node 2"));
    }
}
