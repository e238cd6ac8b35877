//! The list of features of a scene's file that the renderer does not show, for messages to the user.

use std::fmt;

/// Maximum number of objects that an entry names; further objects are only counted.
const MAX_NAMED: usize = 3;

/// A feature of a scene's file that is not rendered, and the objects that have it.
#[derive(Clone, Debug, PartialEq)]
pub struct Unrendered {
    /// Name of the glTF extension, or words for a feature of glTF itself.
    pub feature: String,
    /// The visible consequence, such as "reflections are not stretched".
    pub effect: &'static str,
    /// Names of the first `MAX_NAMED` objects that have the feature.
    pub named: Vec<String>,
    /// Number of objects that have the feature.
    pub count: usize,
}

impl fmt::Display for Unrendered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: not rendered, {} ({}", self.feature, self.effect, self.named.join(", "))?;
        match self.count - self.named.len() {
            0 => write!(f, ")"),
            more => write!(f, " and {more} more)"),
        }
    }
}

/// Adds an object to the entry of `feature`, or starts that entry. `place` names the object.
pub fn note(list: &mut Vec<Unrendered>, feature: &str, effect: &'static str, place: impl FnOnce() -> String) {
    let at = list.iter().position(|known| known.feature == feature).unwrap_or_else(|| {
        list.push(Unrendered { feature: feature.into(), effect, named: Vec::new(), count: 0 });
        list.len() - 1
    });
    let known = &mut list[at];
    known.count += 1;
    if known.named.len() < MAX_NAMED {
        known.named.push(place());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_feature_is_listed_once_with_its_first_places_and_their_number() {
        let mut list = Vec::new();
        for i in 0..5 {
            note(&mut list, "skins", "no pose", || format!("node {i}"));
        }
        note(&mut list, "morph targets", "no shape", || "mesh \"Face\"".into());
        let texts: Vec<String> = list.iter().map(ToString::to_string).collect();
        assert_eq!(texts[0], "skins: not rendered, no pose (node 0, node 1, node 2 and 2 more)");
        assert_eq!(texts[1], "morph targets: not rendered, no shape (mesh \"Face\")");
    }
}
