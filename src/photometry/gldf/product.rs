//! Reads a variant of the product that a container describes.

use super::super::luminaire::{File, Luminaire};
use super::super::sum::{MAX_PARTS, sum};
use super::super::xml::{self, Element};
use super::container::Container;
use super::emitters::Emitters;
use super::names::{locale, locales};
use super::shape::Shape;
use crate::error::{Error, ErrorKind, Result};

/// Reads the luminaire of one variant from a container held in memory. `variant` is the variant's name, id or index
/// from 0; with `None`, the first variant is read.
///
/// # Errors
/// `Format` if the container is malformed; `NotFound` if it has no such variant; `Unsupported` if the variant's
/// photometry lies outside the container or is of a kind that is not read.
pub fn read(bytes: &[u8], variant: Option<&str>) -> Result<File> {
    let container = Container::new(bytes)?;
    let file = container.file("product.xml", xml::MAX_BYTES)?;
    let text = xml::decode(&file)?;
    let document = xml::parse(&text).map_err(|e| e.context("product.xml"))?;
    product(&container, Element::root(&document), variant).map_err(|e| e.context("product.xml"))
}

fn product(container: &Container, root: Element, variant: Option<&str>) -> Result<File> {
    let definitions = root.find("GeneralDefinitions");
    let product = root.find("ProductDefinitions");
    let (Some(definitions), Some(product), "Root") = (definitions, product, root.name()) else {
        let message = "a GLDF product has the root Root with GeneralDefinitions and ProductDefinitions";
        return Err(root.error(message));
    };
    let all: Vec<Element> = product.find("Variants").into_iter().flat_map(|list| list.all("Variant")).collect();
    let chosen = choose(&all, variant)?;
    let references = emitters_of(chosen, definitions)?;
    let shape = chosen.find("Geometry").map_or(Ok(None), |geometry| Shape::of(definitions, geometry))?;
    let emitters = Emitters::new(container, definitions, shape);
    let parts = references.iter().map(|id| emitters.read(id)).collect::<Result<Vec<Option<Luminaire>>>>()?;
    let parts: Vec<Luminaire> = parts.into_iter().flatten().collect();
    if parts.is_empty() {
        let message = format!("line {}: the variant has no emitter that shines in normal operation", chosen.line());
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let emitters = parts.len();
    let mut luminaire = sum(parts)?;
    // The name of a variant overrules the name of the product. A name without letters and digits, such as "---", counts
    // as missing.
    let of_variant = name_of(chosen);
    let has_name = of_variant.contains(char::is_alphanumeric);
    luminaire.name = if has_name { of_variant } else { locale(product.find("ProductMetaData/Name")) }.into();
    luminaire.manufacturer = root.find("Header/Manufacturer").map(Element::line_of_text).unwrap_or_default();
    luminaire.check()?;
    Ok(File { luminaire, variants: all.len(), emitters })
}

fn name_of(variant: Element<'_>) -> &str {
    locale(variant.find("Name"))
}

/// Finds a variant by its name in any language, by its id, or by its index.
fn choose<'a>(all: &[Element<'a>], wanted: Option<&str>) -> Result<Element<'a>> {
    let Some(first) = all.first() else { return Err(Error::format("the product has no variants")) };
    let Some(wanted) = wanted else { return Ok(*first) };
    let by_name = all.iter().find(|variant| locales(variant.find("Name")).any(|name| name == wanted));
    let by_id = || all.iter().find(|variant| variant.attribute("id") == Some(wanted));
    let by_index = || wanted.parse().ok().and_then(|index: usize| all.get(index));
    by_name.or_else(by_id).or_else(by_index).copied().ok_or_else(|| {
        let shown = 8;
        let mut names: Vec<String> = all.iter().take(shown).map(|variant| format!("{:?}", name_of(*variant))).collect();
        if all.len() > shown {
            names.push("...".into());
        }
        let message =
            format!("no variant has the name, id or index {wanted:?}; there are {}: {}", all.len(), names.join(", "));
        Error::new(ErrorKind::NotFound, message)
    })
}

/// Returns the ids of the emitters that a variant refers to. If it refers to none and the product has a single emitter,
/// returns the id of that emitter.
fn emitters_of<'a>(variant: Element<'a>, definitions: Element<'a>) -> Result<Vec<&'a str>> {
    let ids = variant.find("Geometry").map_or(Ok(Vec::new()), references)?;
    let all = || definitions.find("Emitters").into_iter().flat_map(|list| list.all("Emitter"));
    match (ids.is_empty(), all().next(), all().nth(1)) {
        (true, Some(only), None) => Ok(only.attribute("id").into_iter().collect()),
        _ => Ok(ids),
    }
}

/// Returns the ids of the emitters to which a geometry refers.
fn references(geometry: Element<'_>) -> Result<Vec<&str>> {
    // A simple geometry and a modelled geometry in one variant represent the same product, so do not add up their
    // emitters: use the emitters of the model, or else the emitters of the simple geometry.
    let inner = geometry.find("GeometryReferences").unwrap_or(geometry);
    let simple = inner.all("SimpleGeometryReference").filter_map(|reference| reference.attribute("emitterId"));
    let of_model = inner.all("ModelGeometryReference").flat_map(|model| model.all("EmitterReference"));
    let modelled =
        of_model.chain(inner.all("EmitterReference")).filter_map(|reference| reference.attribute("emitterId"));
    let mut ids: Vec<&str> = modelled.collect();
    if ids.is_empty() {
        ids = simple.collect();
    }
    if ids.len() > MAX_PARTS {
        return Err(geometry.error(format_args!("{} emitters; at most {MAX_PARTS} are read", ids.len())));
    }
    Ok(ids)
}
