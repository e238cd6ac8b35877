//! Writes a TM-33-23 file.

use super::super::clock::Moment;
use super::super::luminaire::Luminaire;
use super::super::xml::Writer;
use super::areas;
use crate::error::Result;

/// Writes a luminaire as a TM-33-23 file, with all planes of its distribution. Items that the format demands but a
/// luminaire does not state (laboratory, report) are written as "none". The report has the date of `now`.
///
/// # Errors
/// The errors of [`Luminaire::check`].
pub fn write(luminaire: &Luminaire, now: Moment) -> Result<String> {
    luminaire.check()?;
    let l = luminaire;
    let mut out = Writer::new();
    out.begin("IESTM33-22", "");
    out.leaf("Version", "", "1.1");
    out.begin("Header", "");
    if !l.manufacturer.is_empty() {
        out.leaf("Manufacturer", "", &l.manufacturer);
    }
    out.leaf("Description", "", &l.name);
    out.leaf("Laboratory", "", "none");
    out.leaf("ReportNumber", "", "none");
    out.leaf("ReportDate", "", now.date());
    out.leaf("DocumentCreator", "", concat!("luxfer ", env!("CARGO_PKG_VERSION")));
    out.end();
    if l.opening().is_some() {
        let [width, length, height] = l.bounds();
        out.begin("Luminaire", "");
        out.begin("Dimensions", "");
        out.leaf("Length", "", length);
        out.leaf("Width", "", width);
        out.leaf("Height", "", height);
        out.end();
        out.leaf("NumEmitter", "", 1);
        out.end();
    }
    out.begin("Equipment", "");
    out.begin("Gonioradiometer", "");
    out.leaf("Type", "", "IES_C");
    out.end();
    out.end();
    emitter(l, &mut out);
    Ok(out.finish())
}

fn emitter(l: &Luminaire, out: &mut Writer) {
    out.begin("Emitter", "");
    out.leaf("Quantity", "", 1);
    out.leaf("Description", "", if l.name.is_empty() { "emitter" } else { &l.name });
    if l.lamp_flux > 0.0 {
        out.leaf("RatedLumens", "", l.lamp_flux);
    }
    out.leaf("InputWattage", "", l.watts);
    if l.temperature > 0.0 {
        out.begin("ColorTemperature", "");
        out.leaf("FixedCCT", "", l.temperature.round());
        out.end();
    }
    if l.rendering > 0.0 {
        out.begin("ColorRendering", "");
        out.begin("CIE_CRI", "");
        out.leaf("Ra", "", l.rendering.round());
        out.end();
        out.end();
    }
    intensities(l, out);
    areas::write(l, out);
    out.end();
}

fn intensities(l: &Luminaire, out: &mut Writer) {
    let is_round = l.planes.len() == 1;
    // Repeat the first plane at 360 degrees, for readers that derive the symmetry from the range of the angles.
    let planes = l.planes.iter().copied().chain((!is_round).then_some(360.0));
    let n = l.gammas.len();
    let count = if is_round { 1 } else { l.planes.len() + 1 };
    out.begin("LuminousData", "");
    out.begin("LuminousIntensity", "");
    out.leaf("AbsolutePhotometry", "", l.lamp_flux <= 0.0);
    out.leaf("Symm", "", if is_round { "Symm_Full" } else { "Symm_None" });
    out.leaf("NumberMeasured", "", count * n);
    out.leaf("NumberHorz", "", count);
    out.leaf("NumberVert", "", n);
    for (plane, c) in planes.enumerate() {
        let values = &l.candela[plane % l.planes.len() * n..][..n];
        for (gamma, value) in l.gammas.iter().zip(values) {
            out.leaf("IntData", &format!(" h=\"{c}\" v=\"{gamma}\""), value);
        }
    }
    out.end();
    out.leaf("LuminousFlux", "", l.flux());
    out.end();
}
