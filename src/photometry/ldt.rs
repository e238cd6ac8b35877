//! Reads and writes EULUMDAT files (Stockmar 1990). They have one value per line in a fixed order, and intensities in
//! candela per 1000 lumens of the lamps.

use super::luminaire::Luminaire;
use super::text_lines::{Lines, MAX_ANGLES, MAX_VALUES, at, count, plain, within};
use crate::error::Result;
use crate::image::try_vec;
use std::fmt::Write;

/// Maximum number of lamp sets in a file.
const MAX_SETS: usize = 20;
/// Number of direct ratios in a file, one for each of the standard room indices. A direct ratio is the share of the
/// flux that reaches the working plane directly; a room index stands for the proportions of a room.
const ROOM_INDICES: usize = 10;

/// Width along C = 90, in millimetres, that is written for an upright rectangle: such a rectangle has no width, but a
/// width of 0 would mark a round opening. It is the smallest width that can be stated in whole millimetres, as sizes
/// often are. [convention]
const MIN_WIDTH: f64 = 1.0;

struct Rows<'a, I> {
    lines: I,
    line: usize,
    text: &'a str,
}

impl<'a, I: Iterator<Item = (usize, &'a str)>> Rows<'a, I> {
    fn next(&mut self, what: &str) -> Result<&'a str> {
        let (line, text) =
            self.lines.next().ok_or_else(|| at(self.line + 1, format_args!("the file ends before {what}")))?;
        (self.line, self.text) = (line, text);
        Ok(text)
    }

    fn skip(&mut self, n: usize, what: &str) -> Result<()> {
        (0..n).try_for_each(|_| self.next(what).map(drop))
    }

    fn within(&mut self, what: &str, low: f64, high: f64) -> Result<f64> {
        let text = self.next(what)?;
        within(self.line, text, what, low, high)
    }

    fn count(&mut self, what: &str, low: usize, high: usize) -> Result<usize> {
        let text = self.next(what)?;
        count(self.line, text, what, low, high)
    }

    fn list(&mut self, n: usize, what: &str, low: f64, high: f64) -> Result<Vec<f64>> {
        let mut values = try_vec(n, 0.0)?;
        for value in &mut values {
            *value = self.within(what, low, high)?;
        }
        Ok(values)
    }
}

/// Reads a EULUMDAT file held in memory.
///
/// # Errors
/// `Format`, with the line number, if the file is malformed.
pub fn read(bytes: &[u8]) -> Result<Luminaire> {
    let text = Lines::new(bytes)?;
    let mut rows = Rows { lines: text.numbered(), line: 0, text: "" };
    let manufacturer = rows.next("the manufacturer")?.to_string();
    rows.count("the type", 0, 3)?;
    let symmetry = rows.count("the symmetry", 0, 4)?;
    let planes = rows.count("the number of C planes", 1, MAX_ANGLES)?;
    rows.within("the distance between C planes", 0.0, 360.0)?;
    let gammas = rows.count("the number of intensities of a plane", 1, MAX_ANGLES)?;
    rows.within("the distance between intensities", 0.0, 180.0)?;
    rows.next("the report's number")?;
    let name = rows.next("the luminaire's name")?.to_string();
    rows.skip(3, "the date")?;
    if gammas * planes > MAX_VALUES {
        return Err(at(rows.line, format_args!("{gammas} x {planes} intensities; at most {MAX_VALUES} are read")));
    }

    // Read the sizes in millimetres: first the sizes of the housing, which are not used, then the sizes of the luminous
    // area.
    rows.list(3, "a size of the luminaire", 0.0, 1e7)?;
    let [length, width] = [rows.within("the luminous length", 0.0, 1e7)?, rows.within("the luminous width", 0.0, 1e7)?];
    // Read the luminous heights of the four sides, which face towards C = 0, 90, 180 and 270.
    let heights = rows.list(4, "a height of the luminous area", 0.0, 1e7)?;
    let height = heights.iter().copied().fold(0.0, f64::max);
    // EULUMDAT states the length along C = 90 first, but the first dimension of `Luminaire::size` lies along C = 0:
    // swap length and width. EULUMDAT states a round luminaire by a width of 0 and its diameter as the length.
    // `Luminaire::size` marks a diameter by a negative sign, as IES does.
    let size = if width == 0.0 { [-length, -length, height] } else { [width, length, height] }.map(|mm| mm / 1e3);
    let differ = width > 0.0 && heights.iter().any(|h| *h != height);
    let side_heights = differ.then(|| std::array::from_fn(|i| heights[i] / 1e3));
    rows.skip(2, "the light output ratio")?;
    let factor = rows.within("the conversion factor", 0.0, 1e9)?;
    rows.skip(1, "the tilt")?;

    let LampSet { lumens, watts, absolute, temperature, rendering } = lamp_sets(&mut rows)?;
    rows.list(ROOM_INDICES, "a direct ratio", -1e9, 1e9)?;

    let angles = rows.list(planes, "the angle of a C plane", 0.0, 360.0)?;
    let vertical = rows.list(gammas, "a vertical angle", 0.0, 180.0)?;
    let stored = stored_planes(symmetry, planes).map_err(|what| at(3, what))?;
    let scale = factor * lumens / 1000.0;
    let mut values = rows.list(stored.len() * gammas, "an intensity", 0.0, 1e12)?;
    values.iter_mut().for_each(|v| *v *= scale);

    let (shown, candela) = unfold(symmetry, &angles, &stored, &values, gammas);
    let luminaire = Luminaire {
        name,
        manufacturer,
        gammas: vertical,
        planes: shown,
        candela,
        lamp_flux: if absolute { 0.0 } else { lumens },
        watts,
        temperature,
        rendering,
        size,
        side_heights,
    };
    luminaire.check().map_err(|e| e.context(format_args!("line {}", rows.line)))?;
    Ok(luminaire)
}

/// The lamps with which a luminaire was measured: their total flux in lumens, and the power in watts.
struct LampSet {
    lumens: f64,
    watts: f64,
    /// Whether the file declares absolute photometry.
    absolute: bool,
    /// Colour temperature in kelvin and colour rendering index; 0 if the file does not state them as numbers.
    temperature: f64,
    rendering: f64,
}

/// Reads the lamp sets and returns the first, with which the luminaire was measured. A negative number of lamps
/// declares absolute photometry.
fn lamp_sets<'a>(rows: &mut Rows<'a, impl Iterator<Item = (usize, &'a str)>>) -> Result<LampSet> {
    let sets = rows.count("the number of sets of lamps", 1, MAX_SETS)?;
    let mut first = LampSet { lumens: 0.0, watts: 0.0, absolute: false, temperature: 0.0, rendering: 0.0 };
    for set in 0..sets {
        let lamps = rows.within("the number of lamps", -1e6, 1e6)?;
        rows.next("the type of lamps")?;
        let flux = rows.within("the lamps' flux", 0.0, 1e12)?;
        let temperature = temperature(rows.next("the colour temperature")?);
        let rendering = rendering(rows.next("the colour rendering")?);
        let power = rows.within("the power", 0.0, 1e9)?;
        if set == 0 {
            first = LampSet { lumens: flux, watts: power, absolute: lamps < 0.0, temperature, rendering };
        }
    }
    Ok(first)
}

/// Finds the whole numbers in a text, such as 3000 in "ww/3000K".
fn numbers(text: &str) -> impl Iterator<Item = u32> {
    text.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse().ok())
}

/// Returns the colour temperature in kelvin of lamps, written as a temperature ("3000 K", "ww/3000") or as a colour
/// code ("840": the hundreds of kelvin are 40); 0 if the text has neither.
fn temperature(text: &str) -> f64 {
    let kelvin = numbers(text).find(|n| (1000..=25_000).contains(n));
    let code = numbers(text).find(|n| (200..1000).contains(n) && n % 100 >= 18).map(|n| n % 100 * 100);
    f64::from(kelvin.or(code).unwrap_or(0))
}

/// Returns the colour rendering index of lamps ("80", "1B/85"); 0 if the text has none. A number below 20 is not an
/// index but a colour rendering group, as the 1 of "1B".
fn rendering(text: &str) -> f64 {
    f64::from(numbers(text).find(|n| (20..=100).contains(n)).unwrap_or(0))
}

/// Returns the angles in degrees and the intensities in candela of all C planes of the full circle. Each plane that the
/// file does not store is a copy of the stored plane that is symmetric to it. A rotationally symmetric luminaire gets a
/// single plane.
fn unfold(symmetry: usize, angles: &[f64], stored: &[usize], values: &[f64], gammas: usize) -> (Vec<f64>, Vec<f64>) {
    let single = symmetry == 1;
    let planes = angles.len();
    let (mut shown, mut candela) = (Vec::new(), Vec::new());
    for plane in 0..if single { 1 } else { planes } {
        if !single && angles[plane] >= 360.0 {
            continue;
        }
        let source = image_of(symmetry, plane, planes);
        let at_stored = stored.iter().position(|s| *s == source).unwrap_or(0);
        shown.push(if single { 0.0 } else { angles[plane] });
        candela.extend_from_slice(&values[at_stored * gammas..][..gammas]);
    }
    (shown, candela)
}

/// Returns the indices of the planes that a file with the given symmetry stores.
fn stored_planes(symmetry: usize, planes: usize) -> std::result::Result<Vec<usize>, &'static str> {
    match symmetry {
        0 => Ok((0..planes).collect()),
        1 => Ok(vec![0]),
        2 if planes.is_multiple_of(2) => Ok((0..=planes / 2).collect()),
        3 if planes.is_multiple_of(4) => Ok((0..=planes / 2).map(|i| (3 * planes / 4 + i) % planes).collect()),
        4 if planes.is_multiple_of(4) => Ok((0..=planes / 4).collect()),
        _ => Err("the symmetry needs a number of C planes that it divides"),
    }
}

/// Returns the index of the stored plane that equals `plane` by symmetry.
fn image_of(symmetry: usize, plane: usize, planes: usize) -> usize {
    let about_0 = |p: usize| (planes - p) % planes;
    let about_90 = |p: usize| (planes + planes / 2 - p) % planes;
    match symmetry {
        0 => plane,
        1 => 0,
        2 => plane.min(about_0(plane)),
        3 if plane > planes / 4 && plane < 3 * planes / 4 => about_90(plane),
        3 => plane,
        _ => {
            let half = plane.min(about_0(plane));
            half.min(about_90(half))
        }
    }
}

/// Returns the luminaire without its light above the horizontal.
fn below_horizon(l: &Luminaire) -> Luminaire {
    let is_below = |i: usize| l.gammas[i % l.gammas.len()] <= 90.0;
    let candela = l.candela.iter().enumerate().map(|(i, v)| if is_below(i) { *v } else { 0.0 });
    Luminaire { candela: candela.collect(), ..l.clone() }
}

/// Returns the length, the width and the height of the opening in millimetres. In the file, a width of 0 marks a round
/// opening, whose diameter is the length.
fn opening(l: &Luminaire) -> [f64; 3] {
    let [width, length, height] = l.size.map(|m| m * 1e3);
    if width.min(length) < 0.0 && width.max(length) <= 0.0 {
        return [-width.min(length), 0.0, height.abs()];
    }
    if l.opening().is_none() {
        // A luminaire with a length alone is a point. Do not write this length: without a width, it would be the
        // diameter of a disc.
        return [if width == 0.0 { 0.0 } else { length.abs() }, width.abs(), height.abs()];
    }
    // Write a horizontal tube as the box around it, and give an upright rectangle the width `MIN_WIDTH`.
    let [width, length, height] = l.bounds().map(|m| m * 1e3);
    [length, if length > 0.0 { width.max(MIN_WIDTH) } else { width }, height]
}

/// Writes a luminaire as a EULUMDAT file: with rotational symmetry if it has a single plane, otherwise without
/// symmetry.
///
/// # Errors
/// The errors of [`Luminaire::check`].
pub fn write(luminaire: &Luminaire) -> Result<String> {
    luminaire.check()?;
    let l = luminaire;
    let single = l.planes.len() == 1;
    // For a single plane, list the angles of 24 planes, as is common for interior luminaires.
    let planes: Vec<f64> = if single { (0..24).map(|i| f64::from(i) * 15.0).collect() } else { l.planes.clone() };
    let step = |angles: &[f64]| match angles {
        [a, b, ..] if angles.windows(2).all(|w| (w[1] - w[0] - (b - a)).abs() < 1e-9) => b - a,
        _ => 0.0,
    };
    let flux = l.flux();
    let lumens = if l.lamp_flux > 0.0 { l.lamp_flux } else { flux };
    let down = if flux > 0.0 { 100.0 * below_horizon(l).flux() / flux } else { 0.0 };
    let output_ratio = if lumens > 0.0 { 100.0 * flux / lumens } else { 0.0 };
    let [length, width, height] = opening(l);
    let mut text = String::new();
    let mut line = |value: &dyn std::fmt::Display| {
        let _ = write!(text, "{value}\r\n");
    };
    line(&plain(&l.manufacturer));
    line(&if single { 1 } else { 3 });
    line(&if single { 1 } else { 0 });
    line(&planes.len());
    line(&step(&planes));
    line(&l.gammas.len());
    line(&step(&l.gammas));
    for text in ["", &plain(&l.name), "", "", ""] {
        line(&text);
    }
    for value in [length, width, height, length, width] {
        line(&value);
    }
    l.side_heights.map_or([height; 4], |heights| heights.map(|m| m * 1e3)).iter().for_each(|h| line(h));
    for value in [down, output_ratio, 1.0, 0.0] {
        line(&value);
    }
    // Write one lamp set; a negative number of lamps declares absolute photometry.
    line(&1);
    line(&if l.lamp_flux > 0.0 { 1 } else { -1 });
    line(&"");
    line(&lumens);
    for value in [l.temperature, l.rendering] {
        line(&if value > 0.0 { value.round().to_string() } else { String::new() });
    }
    line(&l.watts);
    (0..ROOM_INDICES).for_each(|_| line(&0));
    planes.iter().for_each(|c| line(c));
    l.gammas.iter().for_each(|g| line(g));
    let per_kilolumen = if lumens > 0.0 { 1000.0 / lumens } else { 0.0 };
    l.candela.iter().for_each(|v| line(&(v * per_kilolumen)));
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of a luminaire with `planes` C planes and vertical angles of 0 and 90 degrees; `values` are the stored
    /// intensities at 90 degrees.
    fn file(symmetry: usize, planes: usize, values: &[f64]) -> String {
        let mut lines: Vec<String> = ["Works", "3"].map(String::from).into();
        lines.push(symmetry.to_string());
        lines.push(planes.to_string());
        lines.extend([(360.0 / planes as f64).to_string(), "2".into(), "90".into(), String::new(), "Lamp".into()]);
        lines.extend(
            ["", "", "", "1200", "300", "80", "1190", "0", "0", "0", "0", "0", "100", "80", "1", "0"].map(String::from),
        );
        lines.extend(["1", "2", "tube", "2000", "840", "80", "58"].map(String::from));
        lines.extend((0..10).map(|_| "0".into()));
        lines.extend((0..planes).map(|i| (360.0 / planes as f64 * i as f64).to_string()));
        lines.extend(["0".into(), "90,0".into()]);
        lines.extend(values.iter().flat_map(|v| ["50".into(), v.to_string()]));
        lines.join("\r\n")
    }

    #[test]
    fn symmetries_are_unfolded() {
        let side = |symmetry, values: &[f64]| {
            let l = read(file(symmetry, 4, values).as_bytes()).unwrap();
            // At 2000 lm, the intensities are twice the file's values per 1000 lm.
            [0.0, 90.0, 180.0, 270.0].map(|c| l.intensity(c, 90.0) / 2.0)
        };
        assert_eq!(side(0, &[1.0, 2.0, 3.0, 4.0]), [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(side(1, &[7.0]), [7.0; 4]);
        assert_eq!(side(2, &[1.0, 2.0, 3.0]), [1.0, 2.0, 3.0, 2.0]);
        // Symmetry 3 stores the planes from C270 through C0 to C90.
        assert_eq!(side(3, &[4.0, 1.0, 2.0]), [1.0, 2.0, 1.0, 4.0]);
        assert_eq!(side(4, &[1.0, 2.0]), [1.0, 2.0, 1.0, 2.0]);
        let l = read(file(1, 24, &[7.0]).as_bytes()).unwrap();
        assert_eq!((l.name.as_str(), l.watts, l.lamp_flux, l.size), ("Lamp", 58.0, 2000.0, [-1.19, -1.19, 0.0]));
    }

    #[test]
    fn written_files_are_read_back() {
        let uneven = Luminaire {
            planes: vec![0.0, 30.0, 200.0],
            candela: [vec![1.0; 37], vec![2.0; 37], vec![3.0; 37]].concat(),
            lamp_flux: 0.0,
            ..Luminaire::lambertian("uneven", 0.0, [0.3, 0.2, 0.1])
        };
        for l in [Luminaire::lambertian("panel", 3500.0, [-0.6, -0.6, 0.0]), uneven] {
            let again = read(write(&l).unwrap().as_bytes()).unwrap();
            let near = |a: &[f64], b: &[f64]| {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * (1.0 + b.abs()))
            };
            assert!(near(&again.candela, &l.candela) && near(&again.size, &l.size) && near(&again.planes, &l.planes));
            assert!((again.flux() / l.flux() - 1.0).abs() < 1e-9);
            assert_eq!((again.name, again.lamp_flux), (l.name, l.lamp_flux));
        }
    }

    /// EULUMDAT states the length along C90, IES along C0.
    #[test]
    fn the_opening_keeps_its_orientation_in_both_formats() {
        use crate::photometry::ies;
        let long = file(1, 24, &[7.0]).replace("1190\r\n0\r\n", "1190\r\n300\r\n");
        let l = read(long.as_bytes()).unwrap();
        assert_eq!(l.size, [0.3, 1.19, 0.0]);
        assert_eq!(ies::read(ies::write(&l).unwrap().as_bytes()).unwrap().size, l.size);
        assert_eq!(read(write(&l).unwrap().as_bytes()).unwrap().size, l.size);
    }

    #[test]
    fn round_openings_stay_round_and_tubes_become_boxes() {
        for (size, want) in [
            ([-0.4, -0.4, 0.0], [-0.4, -0.4, 0.0]),
            ([0.0, -0.4, 0.0], [-0.4, -0.4, 0.0]),
            ([-0.4, 0.0, 0.1], [-0.4, -0.4, 0.1]),
            ([1.2, -0.025, -0.025], [1.2, 0.025, 0.025]),
            ([-0.025, 1.2, -0.025], [0.025, 1.2, 0.025]),
            // LM-63-1995 states a tube by its length and one diameter. An upright rectangle has no width.
            ([0.0, 1.2, -0.026], [0.026, 1.2, 0.026]),
            ([1.2, 0.0, -0.026], [1.2, 0.026, 0.026]),
            ([0.0, 1.2, 0.3], [0.001, 1.2, 0.3]),
            ([1.2, 0.0, 0.3], [1.2, 0.0, 0.3]),
            // A point stays a point.
            ([0.0, 1.2, 0.0], [0.0, 0.0, 0.0]),
            ([1.2, 0.0, 0.0], [1.2, 0.0, 0.0]),
        ] {
            let l = Luminaire::lambertian("", 1000.0, size);
            assert_eq!(read(write(&l).unwrap().as_bytes()).unwrap().size, want);
        }
    }

    #[test]
    fn colours_of_lamps_are_read() {
        for (text, want) in
            [("3000 K", 3000.0), ("ww/2700", 2700.0), ("840", 4000.0), ("-", 0.0), ("", 0.0), ("12", 0.0)]
        {
            assert_eq!(temperature(text), want, "{text}");
        }
        for (text, want) in [("80", 80.0), ("1A/90", 90.0), ("1B", 0.0), ("-", 0.0), ("1", 0.0)] {
            assert_eq!(rendering(text), want, "{text}");
        }
        let l = read(file(1, 24, &[7.0]).as_bytes()).unwrap();
        assert_eq!((l.temperature, l.rendering), (4000.0, 80.0));
        let again = read(write(&l).unwrap().as_bytes()).unwrap();
        assert_eq!((again.temperature, again.rendering), (4000.0, 80.0));
    }

    /// A batten that runs along C = 90. Its long sides, which face towards C = 0 and 180, are luminous; its ends are
    /// dark.
    #[test]
    fn sides_keep_their_heights() {
        let batten =
            file(1, 24, &[7.0]).replace("1190\r\n0\r\n0\r\n0\r\n0\r\n0\r\n", "1190\r\n60\r\n80\r\n0\r\n80\r\n0\r\n");
        let l = read(batten.as_bytes()).unwrap();
        assert_eq!((l.size, l.side_heights), ([0.06, 1.19, 0.08], Some([0.08, 0.0, 0.08, 0.0])));
        let again = read(write(&l).unwrap().as_bytes()).unwrap();
        assert_eq!((again.size, again.side_heights), (l.size, l.side_heights));
        assert_eq!(read(file(1, 24, &[7.0]).as_bytes()).unwrap().side_heights, None);
    }

    #[test]
    fn malformed_files_are_refused_with_the_line() {
        let good = file(2, 4, &[1.0, 2.0, 3.0]);
        let says = |text: &str, what: &str| {
            let error = read(text.as_bytes()).unwrap_err();
            assert!(error.message.contains(what), "{error}");
        };
        says("", "line 1: the file ends");
        says(&good.replacen("\r\n4\r\n", "\r\n5\r\n", 1), "");
        says(&good.replacen("\r\n4\r\n", "\r\n400000000\r\n", 1), "line 4: the number of C planes");
        says(&good.replacen("tube\r\n2000", "tube\r\nmany", 1), "\"many\"");
        says(&good.replacen("Works\r\n3", "Works\r\n9", 1), "line 2: the type is 9");
        // Every file with missing lines gives an error.
        let lines: Vec<&str> = good.lines().collect();
        for end in 0..lines.len() {
            assert!(read(lines[..end].join("\n").as_bytes()).is_err(), "{end}");
        }
    }
}
