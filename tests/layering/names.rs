//! Finds names that a module of `src` gives to more than one type, and names that several modules give to a type.

use std::collections::{BTreeMap, BTreeSet};

/// Names that several files of a module may give to their types: those of the data that a computation takes and
/// returns.
const SHARED: [&str; 5] = ["Params", "Input", "Inputs", "Output", "Report"];
/// The module whose types bear the names of the objects behind their handles.
const HANDLES: &str = "ffi";

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

/// Returns the names of types that are visible outside their file in more than one module.
pub fn of_several_modules(sources: &[(String, String)]) -> Vec<String> {
    let mut modules: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (part, text) in sources.iter().filter(|(part, _)| part != HANDLES) {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for name in code.lines().filter(|line| line.starts_with("pub")).filter_map(defined) {
            modules.entry(name).or_default().insert(part);
        }
    }
    modules.retain(|name, parts| parts.len() > 1 && !SHARED.contains(name));
    modules.into_keys().map(str::to_string).collect()
}

/// The names in the first column of the table under a heading of a Markdown text.
pub fn listed(text: &str, heading: &str) -> Vec<String> {
    let table = text.split_once(heading).map_or("", |(_, rest)| rest.split("\n## ").next().unwrap());
    let rows = table.lines().filter_map(|line| line.strip_prefix("| ")?.split_once(" |"));
    rows.map(|(name, _)| name.to_string()).filter(|name| name != "name").collect()
}

/// The name of the type that a line defines. Types within items, such as `type Item` in an `impl` or a `struct` in a
/// module inside the file, do not count.
fn defined(line: &str) -> Option<&str> {
    let public = line.strip_prefix("pub").map(|rest| match rest.strip_prefix('(') {
        Some(rest) => rest.split_once(')').map_or(rest, |(_, rest)| rest).trim_start(),
        None => rest.trim_start(),
    });
    let item = public.unwrap_or(line);
    let (kind, rest) = item.strip_prefix("unsafe ").unwrap_or(item).split_once(' ')?;
    let is_type = ["struct", "enum", "trait", "type", "union"].contains(&kind);
    is_type.then(|| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or(rest))
}
