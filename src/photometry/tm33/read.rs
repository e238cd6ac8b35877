//! Reads a TM-33 file.

use super::super::luminaire::{File, Luminaire};
use super::super::sum::{MAX_PARTS, sum};
use super::super::xml::{self, Element};
use super::{areas, intensities};
use crate::error::{Error, ErrorKind, Result};

/// Whether an element of this name is the root of a TM-33 file.
fn is_root(name: &str) -> bool {
    name.starts_with("IESTM33") || name == "LuminaireOpticalData"
}

/// Reads a TM-33 file held in memory. The distributions of several emitters are added up.
///
/// # Errors
/// `Format`, with the line, if the file is malformed; `Unsupported` for photometry of other types than C, for
/// directions that form no grid, and for files that state no luminous intensities.
pub fn read(bytes: &[u8]) -> Result<Luminaire> {
    read_file(bytes).map(|file| file.luminaire)
}

/// Reads a TM-33 file like [`read`], and also counts its emitters.
///
/// # Errors
/// The errors of [`read`].
pub fn read_file(bytes: &[u8]) -> Result<File> {
    let text = xml::decode(bytes)?;
    let document = xml::parse(&text)?;
    let root = Element::root(&document);
    if !is_root(root.name()) {
        return Err(root.error(format_args!("the root is {:?}; a TM-33 file has the root IESTM33", root.name())));
    }
    check_type(root, &["Equipment/Gonioradiometer/Type", "Equipment/Goniometer/GoniometerType"])?;
    let (mut parts, mut emitters) = (Vec::new(), Vec::new());
    for emitter in root.all("Emitter") {
        if parts.len() == MAX_PARTS {
            return Err(emitter.error(format_args!("more than {MAX_PARTS} emitters")));
        }
        if let Some(element) = luminous(emitter) {
            parts.push(part(emitter, element)?);
            emitters.push(emitter);
        }
    }
    if parts.is_empty() {
        let message = "the file states no luminous intensities (Emitter/LuminousData)";
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let mut luminaire = sum(parts)?;
    areas::read(&emitters, &mut luminaire)?;
    let names = ["Header/Description", "Header/CatalogNumber"].into_iter().filter_map(|path| root.find(path));
    luminaire.name = names.map(Element::line_of_text).find(|name| !name.is_empty()).unwrap_or_default();
    luminaire.manufacturer = root.find("Header/Manufacturer").map(Element::line_of_text).unwrap_or_default();
    luminaire.check()?;
    Ok(File { luminaire, variants: 1, emitters: emitters.len() })
}

/// Finds the element that holds the luminous intensities of an emitter.
fn luminous(emitter: Element) -> Option<Element> {
    let found = emitter.find("LuminousData/LuminousIntensity").or_else(|| emitter.find("LuminousData"));
    let other = emitter.all("IntensityDistribution").find(|element| {
        let metric = element.text_at("Metric");
        metric.is_empty() || metric.eq_ignore_ascii_case("luminous")
    });
    found.or(other)
}

/// Returns an error if one of the elements at `paths` states another type of photometry than C. If no element states a
/// type, the photometry counts as type C.
fn check_type(element: Element, paths: &[&str]) -> Result<()> {
    for found in paths.iter().filter_map(|path| element.find(path)) {
        let letters: String = found.text().chars().filter(char::is_ascii_alphanumeric).collect();
        if !["", "C", "CIEC", "IESC", "TYPEC"].contains(&letters.to_ascii_uppercase().as_str()) {
            let (line, kind) = (found.line(), found.text());
            let message =
                format!("line {line}: the photometry has the type {kind:?}; only type C is read, as in IES_C or CIE_C");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
    }
    Ok(())
}

/// Reads an emitter whose intensities are in `element`.
fn part(emitter: Element, element: Element) -> Result<Luminaire> {
    check_type(emitter, &["PhotometryType", "LuminousData/PhotometryType"])?;
    check_type(element, &["PhotometryType"])?;
    let found = intensities::read(element)?;
    // As in LM-63, the file's intensities hold for the full flux of the lamps; the ballast factor may reduce them.
    let multiplier = element.number_at("Multiplier", 0.0, 1e9)?.unwrap_or(1.0);
    let ballast = emitter.number_at("BallastFactor", 0.0, 1e6)?.unwrap_or(1.0);
    let is_absolute = matches!(element.text_at("AbsolutePhotometry").to_ascii_lowercase().as_str(), "true" | "1");
    let quantity = emitter.number_at("Quantity", 0.0, 1e6)?.unwrap_or(1.0);
    let rated = emitter.number_at("RatedLumens", 0.0, 1e12)?.unwrap_or(0.0);
    // The tools that write `IntensityData` copy the intensities of EULUMDAT: candela per 1000 lumens of all lamps.
    let is_of_tools = element.find("IntensityData").is_some();
    let lamp_flux = if is_of_tools { rated } else { rated * quantity };
    let per_lamps = if is_of_tools && !is_absolute && rated > 0.0 { rated / 1000.0 } else { 1.0 };
    let first = |paths: [&str; 2], high: f64| -> Result<f64> {
        let found = paths.into_iter().find_map(|path| emitter.number_at(path, 0.0, high).transpose());
        Ok(found.transpose()?.unwrap_or(0.0))
    };
    Ok(Luminaire {
        gammas: found.gammas,
        planes: found.planes,
        candela: found.candela.iter().map(|v| v * multiplier * ballast * per_lamps).collect(),
        lamp_flux: if is_absolute { 0.0 } else { lamp_flux },
        watts: first(["InputWattage", "InputWatts"], 1e9)?,
        temperature: first(["ColorTemperature/FixedCCT", "CCT"], 1e6)?,
        rendering: first(["ColorRendering/CIE_CRI/Ra", "ColorRendering/Ra"], 100.0)?,
        ..Luminaire::lambertian("", 0.0, [0.0; 3])
    })
}
