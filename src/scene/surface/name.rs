//! Finds the meshes of an object or a material by name.

use crate::error::{Error, ErrorKind, Result};
use crate::scene::Scene;

/// Maximum number of names that an error message lists.
const LISTED: usize = 10;

/// Returns the indices of the meshes of the object with the given name, or else of the material with that name, by the
/// rules of [`super::find`]. Meshes without triangles are ignored.
pub fn find(scene: &Scene, name: &str) -> Result<Vec<usize>> {
    let objects: Vec<(usize, &str)> = scene
        .meshes
        .iter()
        .enumerate()
        .filter(|(_, mesh)| !mesh.triangles.is_empty())
        .map(|(i, mesh)| (i, mesh.name.as_str()))
        .collect();
    let materials: Vec<(usize, &str)> = objects
        .iter()
        .filter_map(|&(i, _)| Some((i, scene.materials.get(scene.meshes[i].material)?.name.as_str())))
        .collect();
    let wanted = name.to_lowercase();
    let matchers: [&dyn Fn(&str) -> bool; 3] = [&|n| n == name, &|n| n.to_lowercase() == wanted, &|n| {
        !wanted.is_empty() && n.to_lowercase().contains(&wanted)
    }];
    for (strictness, matches) in matchers.iter().enumerate() {
        for list in [&objects, &materials] {
            let found: Vec<_> = list.iter().filter(|(_, n)| matches(n)).collect();
            let unique = found.iter().all(|(_, n)| *n == found[0].1);
            if strictness == 2 && !unique {
                let names = distinct(found.iter().map(|(_, n)| *n));
                return Err(not_found(name, "is part of several names", &names));
            }
            if !found.is_empty() {
                return Ok(found.into_iter().map(|&(i, _)| i).collect());
            }
        }
    }
    let names = distinct(objects.iter().chain(&materials).map(|(_, n)| *n));
    Err(not_found(name, "is the name of no object and no material", &closest(&wanted, names)))
}

fn not_found(name: &str, why: &str, names: &[&str]) -> Error {
    let shown: Vec<String> = names.iter().take(LISTED).map(|n| format!("{n:?}")).collect();
    let hint = match (shown.len(), names.len()) {
        (0, _) => "the scene has no objects".into(),
        (listed, all) if listed < all => format!("there are {} and {} more", shown.join(", "), all - listed),
        _ => format!("there are {}", shown.join(", ")),
    };
    Error::new(ErrorKind::NotFound, format!("{name:?} {why}; {hint}"))
}

/// Returns the distinct non-empty names in order of appearance.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = std::collections::HashSet::new();
    names.filter(|n| !n.is_empty() && seen.insert(*n)).collect()
}

/// Sorts names by their similarity to the wanted name, most similar first. The similarity is Dice's coefficient of the
/// pairs of adjacent letters: 2 × common pairs / all pairs of both names (Dice 1945).
fn closest<'a>(wanted: &str, mut names: Vec<&'a str>) -> Vec<&'a str> {
    let pairs = |text: &str| -> Vec<(char, char)> { text.chars().zip(text.chars().skip(1)).collect() };
    let target = pairs(wanted);
    names.sort_by_cached_key(|name| {
        let own = pairs(&name.to_lowercase());
        // A pair of the wanted name is common only once, however often the other name contains it.
        let mut unmatched = target.clone();
        let mut is_common = |p: &(char, char)| {
            let found = unmatched.iter().position(|q| q == p);
            found.map(|k| unmatched.swap_remove(k)).is_some()
        };
        let shared = own.iter().filter(|p| is_common(p)).count();
        std::cmp::Reverse(2000 * shared / (own.len() + target.len()).max(1))
    });
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_letters_do_not_make_names_more_similar() {
        assert_eq!(closest("aab", vec!["aaaa", "aabb", "b"]), ["aabb", "aaaa", "b"]);
    }
}
