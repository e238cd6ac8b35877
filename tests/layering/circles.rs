//! Finds circles of files inside a module of `src`: files that use each other, directly or through further files; and
//! circles of folders, in which each folder counts as a whole.
//!
//! A file uses another if it names an item that is defined there, in a `use` or in a path. A name that a file only
//! re-exports (`pub use`) belongs to the file that defines it. Re-exports and unit tests do not count as uses.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A source file as a module.
struct Module {
    tokens: Vec<String>,
    /// Names of the items that the file defines.
    items: BTreeSet<String>,
    /// Names that the file re-exports, with the paths from which it takes them.
    exports: BTreeMap<String, Vec<String>>,
}

/// Modules by path, such as `image::tiff`; the path of the crate itself is "".
type Modules = BTreeMap<String, Module>;

/// For each module or folder the ones that it uses, without itself.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// Returns the sets of modules that use each other. Each source is a path below `src` and the text of the file.
pub fn circles(sources: &[(String, String)]) -> Vec<Vec<String>> {
    circles_of(&uses(sources)).into_iter().collect()
}

/// Returns the sets of folders and files of one folder that use each other, if each subfolder counts as a whole.
pub fn folder_circles(sources: &[(String, String)]) -> Vec<Vec<String>> {
    // The folders by their paths, such as `image`, each with the uses between its children.
    let mut folders: BTreeMap<String, Uses> = BTreeMap::new();
    for (from, used) in uses(sources) {
        for to in used {
            let (a, b): (Vec<&str>, Vec<&str>) = (from.split("::").collect(), to.split("::").collect());
            let common = a.iter().zip(&b).take_while(|(a, b)| a == b).count();
            // The module of the folder itself, `mod.rs`, is not one of its children.
            if common < a.len() && common < b.len() {
                let folder = folders.entry(a[..common].join("::")).or_default();
                let [child, other] = [a, b].map(|path| path[..=common].join("::"));
                folder.entry(other.clone()).or_default();
                folder.entry(child).or_default().insert(other);
            }
        }
    }
    folders.values().flat_map(circles_of).collect()
}

/// What each module uses.
fn uses(sources: &[(String, String)]) -> Uses {
    let modules: Modules =
        sources.iter().filter(|(path, _)| !path.contains("tests")).map(|(p, text)| (name(p), parse(text))).collect();
    modules.keys().map(|m| (m.clone(), used_by(m, &modules).into_iter().filter(|u| u != m).collect())).collect()
}

/// A module is in a circle with all modules that it reaches and that reach it.
fn circles_of(uses: &Uses) -> BTreeSet<Vec<String>> {
    let reach: BTreeMap<&str, BTreeSet<&str>> = uses.keys().map(|m| (m.as_str(), reached(m, uses))).collect();
    let circle = |m: &str| -> Vec<String> {
        reach[m].iter().filter(|&&o| reach[o].contains(m)).map(|o| (*o).to_string()).collect()
    };
    uses.keys().map(|m| circle(m)).filter(|c| c.len() > 1).collect()
}

/// The module path of a source file below `src`.
fn name(path: &str) -> String {
    let path = Path::new(path).with_extension("");
    let names: Vec<_> = path.iter().map(|p| p.to_string_lossy()).filter(|p| p != "mod" && p != "lib").collect();
    names.join("::")
}

/// The modules that `from` uses, directly or through other modules.
fn reached<'a>(from: &str, uses: &'a Uses) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut open: Vec<&str> = uses[from].iter().map(String::as_str).collect();
    while let Some(module) = open.pop() {
        if found.insert(module) {
            open.extend(uses[module].iter().map(String::as_str));
        }
    }
    found
}

/// Identifiers and punctuation of the code before the unit tests; comments, strings and attributes are left out.
fn tokens(text: &str) -> Vec<String> {
    let code = ["#[cfg(test)]\nmod tests {", "#[cfg(test)]\npub mod tests {"];
    let code = code.iter().fold(text, |code, tests| code.split(tests).next().unwrap());
    let code: Vec<char> = code.lines().map(without_comment).collect::<Vec<_>>().join("\n").chars().collect();
    let mut out = Vec::new();
    let mut at = 0;
    while at < code.len() {
        let start = at;
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        if is_word(code[at]) {
            while at < code.len() && is_word(code[at]) {
                at += 1;
            }
        } else if code[at] == '\'' && code.get(at + 2) == Some(&'\'') {
            at += 3;
            continue;
        } else if code[at] == '"' {
            at += 1;
            while at < code.len() && code[at] != '"' {
                at += if code[at] == '\\' { 2 } else { 1 };
            }
            at += 1;
            continue;
        } else {
            at += if code[at..].starts_with(&[':', ':']) { 2 } else { 1 };
        }
        let token: String = code[start..at].iter().collect();
        if !token.trim().is_empty() {
            out.push(token);
        }
    }
    out
}

/// A line up to its comment, if the comment does not begin inside a string.
fn without_comment(line: &str) -> &str {
    let starts = line.match_indices("//").map(|(at, _)| at);
    let outside = |at: &usize| line[..*at].replace("\\\"", "").matches('"').count().is_multiple_of(2);
    starts.into_iter().find(outside).map_or(line, |at| &line[..at])
}

/// Removes the paths of visibilities, such as `in crate::scene` of `pub(in crate::scene)`: they use no item.
fn without_visibility(tokens: Vec<String>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let mut tokens = tokens.into_iter();
    while let Some(token) = tokens.next() {
        let is_path = token == "in" && out.ends_with(&["pub".to_string(), "(".to_string()]);
        out.push(if is_path { tokens.find(|t| t == ")").unwrap_or(token) } else { token });
    }
    out
}

fn parse(text: &str) -> Module {
    const KINDS: [&str; 8] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union"];
    let tokens = without_visibility(tokens(text));
    let items = tokens.windows(2).filter(|w| KINDS.contains(&w[0].as_str())).map(|w| w[1].clone()).collect();
    let exported = statements(&tokens).filter(|s| s.is_export).flat_map(|s| paths(&mut s.tree.iter()));
    let exports = exported.filter_map(|p| Some((p.last()?.clone(), p))).collect();
    Module { tokens, items, exports }
}

/// A `use` statement.
struct Statement<'a> {
    is_export: bool,
    tree: &'a [String],
}

fn statements(tokens: &[String]) -> impl Iterator<Item = Statement<'_>> {
    let starts = (0..tokens.len()).filter(|&i| tokens[i] == "use");
    starts.map(|i| {
        let length = tokens[i..].iter().position(|t| t == ";").unwrap_or(0);
        let is_export = i > 0 && (tokens[i - 1] == "pub" || tokens[i - 1] == ")");
        Statement { is_export, tree: &tokens[i + 1..i + length.max(1)] }
    })
}

/// The paths of a `use` tree, up to the end of its group.
fn paths<'a>(tree: &mut impl Iterator<Item = &'a String>) -> Vec<Vec<String>> {
    let (mut all, mut path) = (Vec::new(), Vec::new());
    while let Some(token) = tree.next() {
        match token.as_str() {
            "::" => {}
            "," => all.push(std::mem::take(&mut path)),
            "{" => {
                let inner = paths(tree);
                all.extend(inner.into_iter().map(|rest| [path.clone(), rest].concat()));
                path.clear();
            }
            "}" => break,
            // Skip the new name of a renamed item: the path names the item as it is defined.
            "as" => drop(tree.next()),
            _ => path.push(token.clone()),
        }
    }
    all.push(path);
    all.retain(|p| !p.is_empty());
    all
}

/// The modules that a module uses.
fn used_by(module: &str, modules: &Modules) -> BTreeSet<String> {
    let tokens = &modules[module].tokens;
    let mut named: Vec<Vec<String>> =
        statements(tokens).filter(|s| !s.is_export).flat_map(|s| paths(&mut s.tree.iter())).collect();
    // Paths in expressions and types.
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at] == "use" {
            at += tokens[at..].iter().position(|t| t == ";").unwrap_or(1);
        }
        let mut path = vec![tokens[at].clone()];
        while tokens.get(at + 1).is_some_and(|t| t == "::") && at + 2 < tokens.len() {
            path.push(tokens[at + 2].clone());
            at += 2;
        }
        at += 1;
        if path.len() > 1 {
            named.push(path);
        }
    }
    named.iter().filter_map(|path| definition(module, path, modules, 0)).collect()
}

/// Resolves a path that occurs in `module`: returns the module that defines its item, or `None` if that lies outside
/// the top-level module of `module`.
fn definition(module: &str, path: &[String], modules: &Modules, depth: usize) -> Option<String> {
    let own: Vec<&str> = module.split("::").collect();
    let ups = path.iter().take_while(|p| *p == "super").count();
    let (base, rest) = match path[0].as_str() {
        "crate" => (Vec::new(), &path[1..]),
        "self" => (own.clone(), &path[1..]),
        "super" => (own[..own.len().checked_sub(ups)?].to_vec(), &path[ups..]),
        first if modules.contains_key(&format!("{module}::{first}")) => (own.clone(), path),
        _ => return None,
    };
    let (mut found, mut rest) = (base.join("::"), rest);
    while let Some(next) = rest.first() {
        let child = if found.is_empty() { next.clone() } else { format!("{found}::{next}") };
        if !modules.contains_key(&child) {
            break;
        }
        (found, rest) = (child, &rest[1..]);
    }
    if found.split("::").next() != own.first().copied() || found.is_empty() {
        return None;
    }
    let defined = &modules[&found];
    match rest.first() {
        Some(item) if !defined.items.contains(item) && depth < 8 => match defined.exports.get(item) {
            Some(export) => definition(&found, export, modules, depth + 1).or(Some(found)),
            None => Some(found),
        },
        _ => Some(found),
    }
}
