//! Reads and writes IES LM-63 files of all editions from 1986 to 2019, with photometry of type C, or of type B
//! (floodlights), which is converted to type C ([`type_b`]). Type A (car lamps) is refused.

use super::luminaire::Luminaire;
use super::symmetry::unfold;
use super::text_lines::{self, Lines, MAX_ANGLES, MAX_VALUES, at, count, number, plain, within};
use super::type_b;
use crate::error::{Error, ErrorKind, Result};
use crate::image::try_vec;
use std::fmt::Write;

/// Metres per foot. [convention]
const FEET: f64 = 0.3048;

/// The words after the line `TILT=`, each with its line number.
struct Words<'a> {
    list: std::vec::IntoIter<(usize, &'a str)>,
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self, what: &str) -> Result<(usize, &'a str)> {
        let word = self.list.next().ok_or_else(|| at(self.line, format_args!("the file ends before {what}")))?;
        self.line = word.0;
        Ok(word)
    }

    fn within(&mut self, what: &str, low: f64, high: f64) -> Result<f64> {
        let (line, word) = self.next(what)?;
        within(line, word, what, low, high)
    }

    fn count(&mut self, what: &str, low: usize, high: usize) -> Result<usize> {
        let (line, word) = self.next(what)?;
        count(line, word, what, low, high)
    }

    fn list(&mut self, what: &str, n: usize, high: f64) -> Result<Vec<f64>> {
        let mut values = try_vec(n, 0.0)?;
        for value in &mut values {
            let (line, word) = self.next(what)?;
            *value = within(line, word, what, -high, high)?;
        }
        Ok(values)
    }
}

/// Reads an IES file held in memory.
///
/// # Errors
/// `Format`, with the line number, if the file is malformed; `Unsupported` for photometry of type A.
pub fn read(bytes: &[u8]) -> Result<Luminaire> {
    let text = Lines::new(bytes)?;
    // The number after the ballast factor means different things in different editions. Before LM-63-2002 it is the
    // ballast-lamp factor. LM-63-2002 reserves it for future use. In LM-63-2019 it states how the file was made ("file
    // generation type", such as 1.1 for an accredited laboratory).
    let edition = text.numbered().next().map_or("", |(_, line)| line).to_ascii_uppercase();
    let has_lamp_factor = !["IESNA:LM-63-2002", "IES:LM-63-"].iter().any(|later| edition.starts_with(later));
    let mut lines = text.numbered();
    let mut luminaire = Luminaire::lambertian("", 0.0, [0.0; 3]);

    let (last, tilt) = keywords(&mut lines, &mut luminaire)?;
    let list: Vec<_> = lines
        .flat_map(|(n, line)| line.split([' ', '\t', ',']).filter(|w| !w.is_empty()).map(move |word| (n, word)))
        .collect();
    let mut words = Words { list: list.into_iter(), line: last };
    if tilt.eq_ignore_ascii_case("INCLUDE") {
        words.next("the lamp's orientation")?;
        let pairs = words.count("the number of tilt angles", 0, MAX_ANGLES)?;
        words.list("a tilt angle", pairs, 360.0)?;
        words.list("a tilt factor", pairs, 1e9)?;
    }

    // The standard puts ten numbers on one line and three on the next, but files in practice break lines anywhere.
    let lamps = words.within("the number of lamps", 0.0, 1e6)?;
    let (line, word) = words.next("lumens per lamp")?;
    let lumens: f64 = number(line, word, "lumens per lamp")?;
    let multiplier = words.within("the candela multiplier", 0.0, 1e9)?;
    let gammas = words.count("the number of vertical angles", 1, MAX_ANGLES)?;
    let planes = words.count("the number of horizontal angles", 1, MAX_ANGLES)?;
    if gammas * planes > MAX_VALUES {
        return Err(at(words.line, format_args!("{gammas} x {planes} intensities; at most {MAX_VALUES} are read")));
    }
    let kind = words.count("the photometric type", 1, 3)?;
    if kind == 3 {
        let message = format!("line {}: photometry of type A; only types B and C are read", words.line);
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let unit = if words.count("the unit", 1, 2)? == 1 { FEET } else { 1.0 };
    let [width, length, height] = [
        words.within("the width", -1e4, 1e4)?,
        words.within("the length", -1e4, 1e4)?,
        words.within("the height", -1e4, 1e4)?,
    ];
    luminaire.size = [length * unit, width * unit, height * unit];
    let ballast = words.within("the ballast factor", 0.0, 1e6)?;
    let lamp_factor = words.within("the ballast-lamp factor", 0.0, 1e6)?;
    let lamp_factor = if has_lamp_factor && lamp_factor > 0.0 { lamp_factor } else { 1.0 };
    luminaire.watts = words.within("the input watts", 0.0, 1e9)?;
    luminaire.lamp_flux = if lumens > 0.0 && lumens.is_finite() { lumens * lamps } else { 0.0 };

    let vertical = words.list("a vertical angle", gammas, 360.0)?;
    let horizontal = words.list("a horizontal angle", planes, 360.0)?;
    let factor = multiplier * ballast * lamp_factor;
    let mut candela = words.list("an intensity", gammas * planes, 1e12)?;
    candela.iter_mut().for_each(|v| *v *= factor);
    let at_end = |e: Error| e.context(format_args!("line {}", words.line));
    if kind == 2 {
        (luminaire.gammas, luminaire.planes, luminaire.candela) =
            type_b::to_type_c(&vertical, &horizontal, &candela).map_err(at_end)?;
    } else {
        (luminaire.planes, luminaire.candela) = unfold(&horizontal, &candela, gammas).map_err(at_end)?;
        luminaire.gammas = vertical;
    }
    luminaire.check().map_err(at_end)?;
    Ok(luminaire)
}

/// Reads the keywords up to the line `TILT=`. Returns the number of that line and the text after `TILT=`.
fn keywords<'a>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
    luminaire: &mut Luminaire,
) -> Result<(usize, &'a str)> {
    let mut last = 1;
    for (number, line) in lines {
        last = number;
        if let Some(tilt) = line.strip_prefix("TILT=") {
            return Ok((number, tilt.trim()));
        }
        if let Some((key, value)) = line.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            match key.to_ascii_uppercase().as_str() {
                "LUMINAIRE" => luminaire.name = value.trim().into(),
                "MANUFAC" => luminaire.manufacturer = value.trim().into(),
                _ => {}
            }
        }
    }
    Err(at(last, "the file has no line TILT=: it is not an IES file, or it is truncated"))
}

/// Writes a luminaire as an LM-63-2002 file.
///
/// # Errors
/// The errors of [`Luminaire::check`].
pub fn write(luminaire: &Luminaire) -> Result<String> {
    luminaire.check()?;
    let l = luminaire;
    let round = l.planes.len() == 1;
    let mut text = format!(
        "IESNA:LM-63-2002\r\n[TEST] none\r\n[TESTLAB] none\r\n[ISSUEDATE] none\r\n[MANUFAC] {}\r\n",
        plain(&l.manufacturer)
    );
    let _ = write!(text, "[LUMINAIRE] {}\r\nTILT=NONE\r\n", plain(&l.name));
    // -1 lumens per lamp declares absolute photometry.
    let lumens = if l.lamp_flux > 0.0 { l.lamp_flux } else { -1.0 };
    let planes = if round { 1 } else { l.planes.len() + 1 };
    let [length, width, height] = l.size;
    let _ =
        write!(text, "1 {lumens} 1 {} {planes} 1 2 {width} {length} {height}\r\n1 1 {}\r\n", l.gammas.len(), l.watts);
    push(&mut text, &l.gammas);
    let horizontal: Vec<f64> = l.planes.iter().copied().chain((!round).then_some(360.0)).collect();
    push(&mut text, &horizontal);
    for plane in 0..planes {
        let from = plane % l.planes.len() * l.gammas.len();
        push(&mut text, &l.candela[from..from + l.gammas.len()]);
    }
    Ok(text)
}

/// Appends numbers, ten per line so that old programs can read them.
fn push(text: &mut String, values: &[f64]) {
    for line in values.chunks(10) {
        let words: Vec<String> = line.iter().map(|v| v.to_string()).collect();
        let _ = write!(text, "{}\r\n", words.join(" "));
    }
}

/// Maximum size in bytes of an IES file.
pub const MAX_BYTES: usize = text_lines::MAX_BYTES;

#[cfg(test)]
mod tests {
    use super::*;

    const QUARTER: &str = "IESNA:LM-63-1995\n[MANUFAC] Works\n[LUMINAIRE] Two tubes\n[OTHER] x\nTILT=NONE\n\
        2 1000 1.5 3 3 1 1 1 2 0\n0.9 1 40\n0 45 90\n0 45 90\n100 80 0\n100 70,0\n100 60 0\n";

    #[test]
    fn a_quarter_is_unfolded() {
        let l = read(QUARTER.as_bytes()).unwrap();
        assert_eq!(
            (l.name.as_str(), l.manufacturer.as_str(), l.lamp_flux, l.watts),
            ("Two tubes", "Works", 2000.0, 40.0)
        );
        assert_eq!(l.planes, [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0]);
        assert!((l.size[0] - 0.6096).abs() < 1e-12 && (l.size[1] - 0.3048).abs() < 1e-12);
        let factor = 1.5 * 0.9;
        for (c, want) in
            [(0.0, 80.0), (45.0, 70.0), (90.0, 60.0), (135.0, 70.0), (180.0, 80.0), (270.0, 60.0), (22.5, 75.0)]
        {
            assert!((l.intensity(c, 45.0) - want * factor).abs() < 1e-9, "{c}");
        }
    }

    /// A floodlight of type B: its beam points up by 30° and right by 60°, where only one intensity is not 0.
    #[test]
    fn type_b_becomes_type_c() {
        let text = QUARTER.replace("3 3 1 1", "3 3 2 1").replace("0 45 90\n0 45 90", "-30 30 60\n-90 60 90");
        let text = text.replace("100 80 0", "0 0 0").replace("100 70,0", "0 100 0").replace("100 60 0", "0 0 0");
        let l = read(text.as_bytes()).unwrap();
        // The direction with V = 30° and H = 60° is (sin 30° / 2, -sin 60°, cos 30° / 2).
        let (c, gamma) = ((-(0.75f64).sqrt()).atan2(0.25).to_degrees(), (0.75f64.sqrt() / 2.0).acos().to_degrees());
        let at = |c: f64, gamma: f64| l.intensity(c, gamma) / (1.5 * 0.9);
        // Between the angles of the file, the intensity falls linearly to 0 within 30°, so it is lower by up to 8 % per
        // 2.5°.
        assert!((at(c, gamma) - 100.0).abs() < 10.0, "{}", at(c, gamma));
        assert!(at(-c, gamma) < 20.0 && at(0.0, gamma) < 50.0 && at(0.0, 91.0) == 0.0);
        assert_eq!(read(write(&l).unwrap().as_bytes()).unwrap(), l);
    }

    /// A first angle of -0 counts as 0, so that no plane occurs twice.
    #[test]
    fn a_first_angle_of_minus_zero_is_zero() {
        let want = read(QUARTER.as_bytes()).unwrap();
        for to in ["180", "90", "360"] {
            let plain = QUARTER.replace("0 45 90\n0 45 90", &format!("0 45 90\n0 45 {to}"));
            let minus = QUARTER.replace("0 45 90\n0 45 90", &format!("-0 45 90\n-0 45 {to}"));
            let (plain, minus) = (read(plain.as_bytes()).unwrap(), read(minus.as_bytes()).unwrap());
            assert_eq!(plain, minus);
            assert!(minus.planes[0].is_sign_positive() && minus.planes.len() == minus.candela.len() / 3);
        }
        assert_eq!(want.planes.len(), 8);
    }

    #[test]
    fn only_editions_before_2002_have_a_ballast_lamp_factor() {
        for (edition, factor) in
            [("IESNA:LM-63-1995", 1.1), ("IESNA91", 1.1), ("IESNA:LM-63-2002", 1.0), ("IES:LM-63-2019", 1.0)]
        {
            let text = QUARTER.replace("IESNA:LM-63-1995", edition).replace("0.9 1 40", "0.9 1.1 40");
            let found = read(text.as_bytes()).unwrap().intensity(0.0, 0.0);
            assert!((found - 100.0 * 1.5 * 0.9 * factor).abs() < 1e-9, "{edition}: {found}");
        }
    }

    #[test]
    fn written_files_are_read_back() {
        for l in [Luminaire::lambertian("panel", 3500.0, [0.6, 0.6, 0.0]), read(QUARTER.as_bytes()).unwrap()] {
            let again = read(write(&l).unwrap().as_bytes()).unwrap();
            assert_eq!(again, l);
        }
        // The tilt data of a file are skipped, and lines may be broken at other places.
        let tilted = QUARTER
            .replace("TILT=NONE", "TILT=INCLUDE\n1\n2\n0 90\n1 0.5")
            .replace("0 45 90\n0 45 90", "0\n45 90 0\n45 90");
        assert_eq!(read(tilted.as_bytes()).unwrap(), read(QUARTER.as_bytes()).unwrap());
    }

    #[test]
    fn malformed_files_are_refused_with_the_line() {
        let says = |text: &str, what: &str| {
            let error = read(text.as_bytes()).unwrap_err();
            assert!(error.message.contains(what), "{error}");
        };
        says("", "TILT");
        says(&QUARTER.replace("100 60 0\n", ""), "line 11: the file ends before an intensity");
        says(&QUARTER.replace("0.9 1 40", "0.9 one 40"), "line 7: the ballast-lamp factor is \"one\"");
        says(&QUARTER.replace("3 3 1 1", "3 900000000 1 1"), "line 6: the number of horizontal angles");
        says(&QUARTER.replace("3 3 1 1", "3 3 3 1"), "line 6: photometry of type A; only types B and C are read");
        says(
            &QUARTER.replace("3 3 1 1", "3 3 2 1").replacen("0 45 90", "9 45 90", 1),
            "line 12: the vertical angles of type B",
        );
        says(&QUARTER.replace("0 45 90\n0 45 90", "0 90 45\n0 45 90"), "vertical angles must ascend");
        says(
            &QUARTER.replace("0 45 90\n0 45 90", "0 45 90\n0 45 80"),
            "from 0 to 80; they must go from 0 to 0, 90, 180, or an angle above 180 up to 360",
        );
        says(&QUARTER.replace("100 80 0", "100 -80 0"), "an intensity is");
        says(&QUARTER.replace("100 80 0", "100 NaN 0"), "an intensity is");
        assert!(read(&[0xff, 0x00, 0x12]).is_err());
        // Every truncated file gives an error without a panic.
        for end in 0..QUARTER.len() - 3 {
            assert!(read(&QUARTER.as_bytes()[..end]).is_err(), "{end}");
        }
    }
}
