//! Finds names that a module of `src` gives to more than one type.

use std::collections::BTreeMap;

/// Names that several files of a module may give to their types: those of the data that a computation takes and
/// returns.
const SHARED: [&str; 4] = ["Params", "Input", "Inputs", "Output"];

/// Returns the names, with their module. Each source is the name of its module and the text of the file.
pub fn with_two_meanings(sources: &[(String, String)]) -> Vec<String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for (part, text) in sources {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for name in code.lines().filter_map(defined).filter(|name| !SHARED.contains(name)) {
            *counts.entry(format!("{part}::{name}")).or_default() += 1;
        }
    }
    counts.into_iter().filter(|(_, count)| *count > 1).map(|(name, _)| name).collect()
}

/// The name of the type that a line defines. Types within items, such as `type Item` in an `impl`, do not count.
fn defined(line: &str) -> Option<&str> {
    let public = line.strip_prefix("pub").map(|rest| match rest.strip_prefix('(') {
        Some(rest) => rest.split_once(')').map_or(rest, |(_, rest)| rest).trim_start(),
        None => rest.trim_start(),
    });
    let (kind, rest) = public.unwrap_or(line).split_once(' ')?;
    let is_type = ["struct", "enum", "trait", "type", "union"].contains(&kind);
    is_type.then(|| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or(rest))
}
