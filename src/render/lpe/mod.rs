//! Light path expressions: images of the light that took certain paths (Heckbert 1990, "Adaptive radiosity textures
//! for bidirectional ray tracing"; StyLit, section 3.2; Open Shading Language, "OSL Light Path Expressions").
//!
//! An expression is a regular expression over the events of a path, in one of two orders:
//!
//! * Light first, as in the papers, from a light `L` to the eye `E`: `LDE`, `LSE`, `LD{1,2}E`, `L.*DDE`, `LS*DE`. `L`
//!   is any light and `S` is any event that is not diffuse: Heckbert has no other classes.
//! * Camera first, as in Open Shading Language, from the camera `C`: `C<RD>L`, `C[GS]+.*<L.'Lamp'>`.
//!
//! | event | |
//! |---|---|
//! | `<type mode labels>` | such as `<RD>`, `<TS'pane'>`, `<L.'Lamp'>`; each part is a letter, `.` for any, `[..]`, `[^..]` |
//! | types | `R` reflection, `T` transmission, `V` volume (never occurs here); `L` `O` `B` lights; `C` the camera |
//! | modes | `D` diffuse, `G` glossy, `S` mirror or clear pane, `s` clear pane (straight) |
//! | labels | names of objects (meshes), materials and lights |
//! | `D`, `R`, `L`, `'x'` | short for `<.D>`, `<R.>`, `<L.>`, `<..'x'>` |
//! | `.` `[DS]` `[^D]` | any event, one of these, any except these |
//! | `*` `+` `?` `{n}` `{n,}` `{n,m}` `\|` `( )` | as in any regular expression |
//!
//! Labels of lights are the names of their objects and materials, `light0`, `light1`, ... for punctual lights in the
//! order of the scene, and `environment`. `Name#0`, `Name#1`, ... are the lamps of the emission texture of the object or
//! material Name: its connected patches, ordered by their first texels.
//!
//! An event must match all of several labels: `<RD'Floor''Wood'>`. A label that does not exist in the scene is an
//! error, since a black image would hide the mistake; excluded labels (`[^'coat']`) need not exist. In Open Shading
//! Language, emissive surfaces are `O` and the environment is `B`; [`EmitterAs`] decides whether they are also `L`.
//! Arnold's built-in expressions are available by name ([`BUILT_IN`]).
//!
//! Events at a vertex: the diffuse layer is `<RD>`; the top layer is `<RG>`, or `<RS>` if it is a mirror; a clear pane
//! is both `<TS>` and `<Ts>`, for paths and for shadow rays. A surface with opacity below 1 is no event where a ray
//! passes it.
//!
//! `parse` turns the text into a tree, `automaton` compiles all expressions of a render over the `alphabet` of events
//! in the scene, and `trail` tracks a path's states in the automaton.

mod alphabet;
mod automaton;
mod parse;
mod sparse_sums;
mod trail;

pub(super) use automaton::Automaton;
pub(super) use trail::{PathOutcome, Trail};

use crate::error::Result;

/// Which light letters match emissive surfaces and the environment in camera-first expressions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmitterAs {
    /// Surfaces are both `L` and `O`, the environment both `L` and `B`: `C<RD>L` is all direct light. The sum of `L`
    /// and `O` counts surfaces twice.
    #[default]
    Both,
    /// Every light is only `L`.
    Light,
    /// As in Open Shading Language: surfaces are `O`, the environment is `B`, punctual lights are `L`.
    Object,
}

/// A parsed light path expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    text: String,
    tree: parse::Node,
}

impl Expression {
    /// # Errors
    /// A syntax error, with its column, the character found there, and the characters allowed there.
    pub fn parse(text: &str) -> Result<Self> {
        let built_in = BUILT_IN.iter().find(|(name, _)| *name == text);
        let tree = parse::parse(built_in.map_or(text, |(_, meaning)| meaning))?;
        Ok(Self { text: text.to_string(), tree })
    }

    /// The text of the expression.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Names of expressions, after Arnold's built-in ones. "direct" is light from any source, including the environment
/// and emissive surfaces; "specular" is glossy and mirror reflection. With every [`EmitterAs`], `emission`,
/// `background`, and the direct and indirect light of each kind add up to the whole image.
pub const BUILT_IN: &[(&str, &str)] = &[
    ("RGBA", "C.*"),
    ("beauty", "C.*"),
    ("direct", "C[DGS][LOB]"),
    ("indirect", "C[DGS][DGS].*"),
    ("emission", "C[^B]"),
    ("background", "CB"),
    ("diffuse", "C<RD>.*"),
    ("diffuse_direct", "C<RD>[LOB]"),
    ("diffuse_indirect", "C<RD>[DGS].*"),
    ("specular", "C<R[GS]>.*"),
    ("specular_direct", "C<R[GS]>[LOB]"),
    ("specular_indirect", "C<R[GS]>[DGS].*"),
    ("transmission", "C<T.>.*"),
    ("transmission_direct", "C<T.>[LOB]"),
    ("transmission_indirect", "C<T.>[DGS].*"),
];

#[cfg(test)]
mod tests;
