//! Writes a GLDF container for one luminaire: its description by the schema of GLDF 1.0 (release candidate 3), and its
//! photometry as EULUMDAT.

use super::super::clock::Moment;
use super::super::ldt;
use super::super::luminaire::Luminaire;
use super::super::opening::Opening;
use super::super::xml::Writer;
use crate::error::{Error, ErrorKind, Result};
use miniz_oxide::deflate::compress_to_vec;
use rawzip::{CompressionMethod, DataDescriptorOutput, ZipArchiveWriter};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write;

/// Compression level of the archive; 6 is the usual level. [convention]
const LEVEL: u8 = 6;

/// Writes a luminaire as a container with one variant. `now` becomes the date of the file.
///
/// # Errors
/// The errors of [`Luminaire::check`].
pub fn write(luminaire: &Luminaire, now: Moment) -> Result<Vec<u8>> {
    let photometry = ldt::write(luminaire)?;
    let product = product(luminaire, &photometry, now);
    let failed =
        |e: &dyn std::fmt::Display| Error::new(ErrorKind::Internal, format!("cannot write a ZIP archive: {e}"));
    let mut out = Vec::new();
    let mut archive = ZipArchiveWriter::new(&mut out);
    for (name, text) in [("product.xml", &product), ("ldc/photometry.ldt", &photometry)] {
        let bytes = text.as_bytes();
        let file = archive.new_file(name).compression_method(CompressionMethod::DEFLATE);
        let (mut entry, _) = file.start().map_err(|e| failed(&e))?;
        entry.write_all(&compress_to_vec(bytes, LEVEL)).map_err(|e| failed(&e))?;
        let end = DataDescriptorOutput::new(rawzip::crc32(bytes), bytes.len() as u64);
        entry.finish(end).map_err(|e| failed(&e))?;
    }
    archive.finish().map_err(|e| failed(&e))?;
    Ok(out)
}

/// Returns an identifier in the form of a UUID (RFC 9562, version 8). It is a hash, so equal luminaires get equal
/// identifiers. Different values of `salt` give different identifiers for one luminaire.
fn identifier(luminaire: &Luminaire, photometry: &str, salt: u8) -> String {
    let half = |part: u8| {
        let mut hasher = DefaultHasher::new();
        (salt, part, &luminaire.name, &luminaire.manufacturer, photometry).hash(&mut hasher);
        hasher.finish()
    };
    let (high, low) = (half(0), half(1));
    format!(
        "{:08x}-{:04x}-8{:03x}-{:04x}-{:012x}",
        high >> 32,
        (high >> 16) & 0xffff,
        high & 0xfff,
        0x8000 | ((low >> 48) & 0x3fff),
        low & 0xffff_ffff_ffff
    )
}

/// Writes `product.xml`.
fn product(l: &Luminaire, photometry: &str, now: Moment) -> String {
    let mut out = Writer::new();
    let schema = "https://gldf.io/xsd/gldf/1.0.0-rc.3/gldf.xsd";
    let spaces =
        format!(" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xsi:noNamespaceSchemaLocation=\"{schema}\"");
    out.begin("Root", &spaces);
    out.begin("Header", "");
    out.leaf("Manufacturer", "", &l.manufacturer);
    out.leaf("FormatVersion", " major=\"1\" minor=\"0\" pre-release=\"3\"", "");
    out.leaf("CreatedWithApplication", "", concat!("luxfer ", env!("CARGO_PKG_VERSION")));
    out.leaf("GldfCreationTimeCode", "", now.date_and_time());
    out.leaf("UniqueGldfId", "", identifier(l, photometry, 0));
    out.end();
    out.begin("GeneralDefinitions", "");
    definitions(l, &mut out);
    out.end();
    out.begin("ProductDefinitions", "");
    out.begin("ProductMetaData", "");
    out.leaf("UniqueProductId", "", identifier(l, photometry, 1));
    locale("ProductNumber", "none", &mut out);
    locale("Name", &l.name, &mut out);
    out.end();
    out.begin("Variants", "");
    out.begin("Variant", " id=\"variant\"");
    locale("Name", &l.name, &mut out);
    out.begin("Geometry", "");
    if l.opening().is_some() {
        out.leaf("SimpleGeometryReference", " geometryId=\"geometry\" emitterId=\"emitter\"", "");
    } else {
        out.leaf("EmitterReference", " emitterId=\"emitter\"", "");
    }
    out.finish()
}

fn locale(name: &'static str, text: &str, out: &mut Writer) {
    out.begin(name, "");
    out.leaf("Locale", " language=\"en\"", text);
    out.end();
}

/// Writes the photometry, the light source, the emitter and the geometry.
fn definitions(l: &Luminaire, out: &mut Writer) {
    out.begin("Files", "");
    let attributes = " id=\"file\" contentType=\"ldc/eulumdat\" type=\"localFileName\"";
    out.leaf("File", attributes, "photometry.ldt");
    out.end();
    out.begin("Photometries", "");
    out.begin("Photometry", " id=\"photometry\"");
    out.leaf("PhotometryFileReference", " fileId=\"file\"", "");
    out.end();
    out.end();
    out.begin("LightSources", "");
    out.begin("FixedLightSource", " id=\"lightSource\"");
    locale("Name", "light source", out);
    out.leaf("RatedInputPower", "", l.watts);
    if l.temperature > 0.0 || l.rendering > 0.0 {
        out.begin("ColorInformation", "");
        for (name, value) in [("ColorRenderingIndex", l.rendering), ("CorrelatedColorTemperature", l.temperature)] {
            if value > 0.0 {
                out.leaf(name, "", value.round());
            }
        }
        out.end();
    }
    out.end();
    out.end();
    out.begin("Emitters", "");
    out.begin("Emitter", " id=\"emitter\"");
    out.begin("FixedLightEmitter", "");
    out.leaf("PhotometryReference", " photometryId=\"photometry\"", "");
    out.leaf("LightSourceReference", " fixedLightSourceId=\"lightSource\"", "");
    // The schema's integers have 32 bits.
    let flux = if l.lamp_flux > 0.0 { l.lamp_flux } else { l.flux() };
    out.leaf("RatedLuminousFlux", "", flux.round().min(f64::from(i32::MAX)));
    out.end();
    out.end();
    out.end();
    if let Some(opening) = l.opening() {
        geometry(l, &opening, out);
    }
}

/// Writes the opening as a box or a cylinder, in millimetres. Its lower face is luminous, and its sides have the
/// luminous heights of the opening.
fn geometry(l: &Luminaire, opening: &Opening, out: &mut Writer) {
    let [width, length, height] = l.bounds();
    let is_cylinder = match opening {
        Opening::Cylinder { axis, diameters: [a, b], .. } => *axis == 2 && a == b,
        Opening::Ellipsoid(_) => width == length,
        Opening::Box { .. } => false,
    };
    let heights = match *opening {
        Opening::Box { heights, .. } => heights,
        _ => [height; 4],
    };
    out.begin("Geometries", "");
    out.begin("SimpleGeometry", " id=\"geometry\"");
    if is_cylinder {
        out.begin("Cylinder", "");
        sizes(&[("Diameter", width), ("Height", height)], out);
        out.begin("CircularEmitter", "");
        sizes(&[("Diameter", width)], out);
    } else {
        out.begin("Cuboid", "");
        sizes(&[("Width", width), ("Length", length), ("Height", height)], out);
        out.begin("RectangularEmitter", "");
        sizes(&[("Width", width), ("Length", length)], out);
    }
    if height > 0.0 {
        out.begin("C-Heights", "");
        for (name, height) in ["C0", "C90", "C180", "C270"].iter().zip(heights) {
            out.leaf(name, "", (height * 1e3).round());
        }
        out.end();
    }
    out.end();
    out.end();
}

/// Writes sizes as whole millimetres, then ends the innermost element. The schema allows no size below 1 mm, so smaller
/// sizes become 1 mm.
fn sizes(list: &[(&str, f64)], out: &mut Writer) {
    for (name, metres) in list {
        out.leaf(name, "", (metres * 1e3).round().max(1.0));
    }
    out.end();
}
