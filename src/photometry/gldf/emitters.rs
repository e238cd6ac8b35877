//! Reads the emitters of a GLDF product: the photometry of each, and the flux, power and colour of its lamps.

use super::super::luminaire::Luminaire;
use super::super::sum::{MAX_PARTS, sum};
use super::super::text_lines::{MAX_BYTES, MAX_VALUES};
use super::super::xml::Element;
use super::super::{ies, ldt, tm33};
use super::container::Container;
use super::names::path;
use super::shape::{self, Shape};
use crate::error::{Error, ErrorKind, Result};
use std::cell::Cell;

/// A description states fluxes in whole lumens. If a stated flux differs from the photometry's flux by less than this,
/// in lumens, the difference is taken as rounding and ignored. [convention]
const WHOLE_LUMEN: f64 = 1.0;
/// Largest flux in lumens (`MAX_FLUX`), and largest power in watts (`MAX_POWER`). [convention]
const MAX_FLUX: f64 = 1e12;
const MAX_POWER: f64 = 1e9;

/// Reads the emitters of one variant from the definitions of a product.
pub struct Emitters<'a, 'b> {
    container: &'b Container<'b>,
    definitions: Element<'a>,
    /// The simple geometry of the variant, which replaces the openings of the photometries.
    shape: Option<Shape>,
    /// Number of photometries read so far (`photometries`), and number of their intensities (`values`).
    photometries: Cell<usize>,
    values: Cell<usize>,
}

/// Properties of an emitter's lamps as the description states them: flux in lumens, power in watts, colour temperature
/// in kelvin, and colour rendering index. A property that is not stated is 0.
#[derive(Default)]
struct Lamps {
    flux: f64,
    watts: f64,
    temperature: f64,
    rendering: f64,
}

impl<'a, 'b> Emitters<'a, 'b> {
    pub fn new(container: &'b Container<'b>, definitions: Element<'a>, shape: Option<Shape>) -> Self {
        Self { container, definitions, shape, photometries: Cell::new(0), values: Cell::new(0) }
    }

    /// Returns the element of the kind `kind` with the given id from the list `list` of the definitions.
    fn find(&self, list: &str, kind: &str, id: &str) -> Result<Element<'a>> {
        let found = self.definitions.find(list);
        found.and_then(|list| list.all(kind).find(|e| e.attribute("id") == Some(id))).ok_or_else(|| {
            let message = format!("{list} has no {kind} with the id {id:?}");
            Error::format(message)
        })
    }

    /// Follows a reference in `element`, such as `PhotometryReference` with its attribute `photometryId`, and returns
    /// the definition with that id.
    fn follow(&self, element: Element, [name, attribute]: [&str; 2], [list, kind]: [&str; 2]) -> Result<Element<'a>> {
        let reference = element.find(name).and_then(|reference| reference.attribute(attribute));
        let Some(id) = reference else { return Err(element.error(format_args!("{name} with {attribute} is missing"))) };
        self.find(list, kind, id)
    }

    /// Reads the emitter with the given id. An emitter may list several light emitters that can replace each other; of
    /// these, the first one that shines in normal operation is read. Returns `None` if the emitter has none, as a
    /// sensor.
    pub fn read(&self, id: &str) -> Result<Option<Luminaire>> {
        let emitter = self.find("Emitters", "Emitter", id)?;
        let is_normal = |e: &Element| e.attribute("emergencyBehaviour") != Some("EmergencyOnly");
        let Some(light) = emitter.children().filter(is_normal).find(|e| e.name().ends_with("LightEmitter")) else {
            return Ok(None);
        };
        let found = match light.name() {
            "FixedLightEmitter" => self.fixed(light),
            "ChangeableLightEmitter" => self.changeable(light),
            "MultiChannelLightEmitter" => self.channels(light),
            name => {
                let known = "FixedLightEmitter, ChangeableLightEmitter and MultiChannelLightEmitter";
                Err(light.error(format_args!("{name} is no kind of light emitter; {known} are read")))
            }
        };
        let placed = found.and_then(|luminaire| shape::placed(light, luminaire, self.shape.as_ref()));
        placed.map(Some).map_err(|e| e.context(format_args!("emitter {id:?}")))
    }

    fn fixed(&self, light: Element) -> Result<Luminaire> {
        let source = light.find("LightSourceReference").is_some().then(|| {
            self.follow(light, ["LightSourceReference", "fixedLightSourceId"], ["LightSources", "FixedLightSource"])
        });
        let mut lamps = source.transpose()?.map(lamps).transpose()?.unwrap_or_default();
        lamps.flux = light.number_at("RatedLuminousFlux", 0.0, MAX_FLUX)?.unwrap_or(0.0);
        Ok(scaled(self.photometry(light)?, &lamps))
    }

    fn changeable(&self, light: Element) -> Result<Luminaire> {
        let mut all = Lamps::default();
        if light.find("EquipmentReference").is_some() {
            let equipment = self.follow(light, ["EquipmentReference", "equipmentId"], ["Equipments", "Equipment"])?;
            let reference = ["LightSourceReference", "changeableLightSourceId"];
            let source = self.follow(equipment, reference, ["LightSources", "ChangeableLightSource"])?;
            let count = equipment.find("LightSourceReference").map(|r| r.number_of("lightSourceCount", 1.0, 1e6));
            let count = count.transpose()?.flatten().unwrap_or(1.0);
            all = lamps(source)?;
            all.flux = count * source.number_at("RatedLuminousFlux", 0.0, MAX_FLUX)?.unwrap_or(0.0);
            all.watts = equipment.number_at("RatedInputPower", 0.0, MAX_POWER)?.unwrap_or(all.watts * count);
        }
        Ok(scaled(self.photometry(light)?, &all))
    }

    /// Returns the sum of all channels of a multi-channel light source, each at full power.
    fn channels(&self, light: Element) -> Result<Luminaire> {
        let reference = ["LightSourceReference", "multiChannelLightSourceId"];
        let source = self.follow(light, reference, ["LightSources", "MultiChannelLightSource"])?;
        let mut parts = Vec::new();
        for channel in source.find("Channels").into_iter().flat_map(|list| list.all("Channel")) {
            if parts.len() == MAX_PARTS {
                return Err(channel.error(format_args!("more than {MAX_PARTS} channels")));
            }
            let flux = channel.number_at("RatedLuminousFlux", 0.0, MAX_FLUX)?.unwrap_or(0.0);
            parts.push(scaled(self.photometry(channel)?, &Lamps { flux, ..Lamps::default() }));
        }
        Ok(scaled(sum(parts)?, &lamps(source)?))
    }

    /// Reads the photometry that `element` refers to. Returns an error if the variant has too many photometries, or if
    /// these have too many intensities: many emitters and channels can refer to one large file, which is then read many
    /// times.
    fn photometry(&self, element: Element) -> Result<Luminaire> {
        let count = self.photometries.get() + 1;
        if count > MAX_PARTS {
            return Err(element.error(format_args!("the variant refers to more than {MAX_PARTS} photometries")));
        }
        self.photometries.set(count);
        let luminaire = self.file(element)?;
        let values = self.values.get() + luminaire.candela.len();
        if values > MAX_VALUES {
            let message =
                format!("the variant's photometries have {values} intensities; at most {MAX_VALUES} are read");
            return Err(element.error(message));
        }
        self.values.set(values);
        Ok(luminaire)
    }

    /// Reads the file of the photometry that `element` refers to.
    fn file(&self, element: Element) -> Result<Luminaire> {
        let reference = ["PhotometryReference", "photometryId"];
        let photometry = self.follow(element, reference, ["Photometries", "Photometry"])?;
        let file = self.follow(photometry, ["PhotometryFileReference", "fileId"], ["Files", "File"])?;
        let name = file.text();
        if file.attribute("type") == Some("url") {
            let message = format!("the photometry is not in the container but at {name:?}");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let bytes = self.container.file(&path("ldc", name)?, MAX_BYTES)?;
        let found = match file.attribute("contentType") {
            Some("ldc/eulumdat") => ldt::read(&bytes),
            Some("ldc/ies") => ies::read(&bytes),
            Some("ldc/iesxml") => tm33::read(&bytes),
            kind => {
                let kind = kind.unwrap_or("");
                let known = "ldc/eulumdat, ldc/ies and ldc/iesxml";
                let message = format!("the photometry has the content type {kind:?}; {known} are read");
                Err(Error::new(ErrorKind::Unsupported, message))
            }
        };
        found.map_err(|e| e.context(name))
    }
}

/// Reads the power, colour temperature and colour rendering of a light source. The flux stays 0; the caller sets it.
fn lamps(source: Element) -> Result<Lamps> {
    let number = |path: &str, high: f64| Ok(source.number_at(path, 0.0, high)?.unwrap_or(0.0));
    Ok(Lamps {
        flux: 0.0,
        watts: number("RatedInputPower", MAX_POWER)?,
        temperature: number("ColorInformation/CorrelatedColorTemperature", 1e6)?,
        rendering: number("ColorInformation/ColorRenderingIndex", 100.0)?,
    })
}

/// Returns the luminaire with other lamps. The intensities are scaled by the flux of `lamps` divided by the rated flux
/// of the luminaire's own lamps. If the luminaire states no lamp flux, the divisor is the flux of its distribution.
/// Properties that are 0 in `lamps` keep their values in `luminaire`.
fn scaled(mut luminaire: Luminaire, lamps: &Lamps) -> Luminaire {
    let measured = if luminaire.lamp_flux > 0.0 { luminaire.lamp_flux } else { luminaire.flux() };
    if lamps.flux > 0.0 && measured > 0.0 && (lamps.flux - measured).abs() >= WHOLE_LUMEN {
        let factor = lamps.flux / measured;
        luminaire.candela.iter_mut().for_each(|v| *v *= factor);
        luminaire.lamp_flux *= factor;
    }
    for (value, of_lamps) in [
        (&mut luminaire.watts, lamps.watts),
        (&mut luminaire.temperature, lamps.temperature),
        (&mut luminaire.rendering, lamps.rendering),
    ] {
        if of_lamps > 0.0 {
            *value = of_lamps;
        }
    }
    luminaire
}
