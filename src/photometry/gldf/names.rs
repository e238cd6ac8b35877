//! Names of files, and texts in several languages.

use super::super::xml::Element;
use crate::error::{Error, Result};

/// Returns the text of an element with `Locale` children: English if there is one, otherwise the first.
pub fn locale(element: Option<Element<'_>>) -> &str {
    let Some(element) = element else { return "" };
    let is_english = |locale: &Element| locale.attribute("language").is_some_and(|language| language.starts_with("en"));
    let found = element.all("Locale").find(is_english).or_else(|| element.all("Locale").next());
    found.unwrap_or(element).text()
}

/// Iterates over the texts of an element with `Locale` children: one text per language.
pub fn locales(element: Option<Element<'_>>) -> impl Iterator<Item = &str> {
    element.into_iter().flat_map(|element| element.all("Locale")).map(Element::text)
}

/// Returns the path of a file in a folder of the container.
///
/// # Errors
/// `Format` if the name leaves the folder.
pub fn path(folder: &str, name: &str) -> Result<String> {
    let is_inside = name.split(['/', '\\']).all(|part| !matches!(part, "" | "." | "..")) && !name.contains(':');
    if !is_inside {
        return Err(Error::format(format!("the file name {name:?} leaves the folder {folder} of the container")));
    }
    Ok(format!("{folder}/{name}"))
}
