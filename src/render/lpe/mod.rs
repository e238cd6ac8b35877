//! Light path expressions: images of the light that came by certain ways (Heckbert 1990, "Adaptive radiosity textures for
//! bidirectional ray tracing"; StyLit, section 3.2; Open Shading Language, "OSL Light Path Expressions").
//!
//! An expression is a regular expression over the events of a path, in one of two orders:
//!
//! * light first, as in the papers, with `L` at its start and the eye `E` at its end: `LDE`, `LSE`, `LD{1,2}E`, `L.*DDE`,
//!   `LS*DE`. `L` is any light and `S` all that is not diffuse: Heckbert knows nothing between.
//! * camera first, as in Open Shading Language, with `C` at its start: `C<RD>L`, `C[GS]+.*<L.'Lamp'>`.
//!
//! | event | |
//! |---|---|
//! | `<type mode labels>` | e.g. `<RD>`, `<TS'pane'>`, `<L.'Ceiling'>`; each part a letter, `.` for any, `[..]`, `[^..]` |
//! | types | `R` reflection, `T` transmission, `V` volume (never met here); `L` `O` `B` lights; `C` the camera |
//! | modes | `D` diffuse, `G` glossy, `S` mirror or clear pane, `s` clear pane: straight through |
//! | labels | names of objects (meshes) or of their materials; of lights the same, `light0`, `light1`, ... for punctual lights in the scene's order, and `environment`; `Name#0`, `Name#1`, ... for the lamps of the emission texture of the object or material Name, its connected patches in the order of their first texels |
//! | `D`, `R`, `L`, `'x'` | short for `<.D>`, `<R.>`, `<L.>`, `<..'x'>` |
//! | `.` `[DS]` `[^D]` | any event, one of these, none of these |
//! | `*` `+` `?` `{n}` `{n,}` `{n,m}` `\|` `( )` | as in any regular expression |
//!
//! Several labels in one event must all fit: `<RD'Floor''Wood'>`. A label that nothing in the scene bears is an error, unless
//! it is one to be left out (`[^'coat']`): a black image would hide the slip. In Open Shading Language, emissive surfaces are
//! `O` and the environment is `B`; [`EmitterAs`] says whether they are `L` too. The names of Arnold's built-in expressions
//! are known ([`BUILT_IN`]).
//!
//! What happens at a vertex: the diffuse layer is `<RD>`, the top layer `<RG>`, or `<RS>` if it is a mirror; a clear pane is
//! `<TS>` and `<Ts>` at once, whether a path goes through it or a shadow ray. Surfaces that are partly there (alpha) are no
//! event where they are not there.
//!
//! text → `parse` a tree → `automaton` one table for all expressions of a rendering, over the `alphabet` of events that its
//! scene can have → `trail` what a path carries along it.

mod alphabet;
mod automaton;
mod parse;
mod sparse_sums;
mod trail;

pub(super) use automaton::Automaton;
pub(super) use trail::{PathOutcome, Trail};

use crate::error::Result;

/// How emissive surfaces and the environment answer to the light letters of camera-first expressions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmitterAs {
    /// Surfaces are both `L` and `O`, the environment both `L` and `B`: `C<RD>L` is all direct light. A sum over `L` and
    /// `O` counts them twice.
    #[default]
    Both,
    /// Every light is `L` only.
    Light,
    /// As in Open Shading Language: surfaces are `O`, the environment is `B`, punctual lights are `L`.
    Object,
}

/// A light path expression that has been understood.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    text: String,
    tree: parse::Node,
}

impl Expression {
    /// # Errors
    /// What is no expression: with the column where it ceases to be one, what stands there, and what could.
    pub fn parse(text: &str) -> Result<Self> {
        let built_in = BUILT_IN.iter().find(|(name, _)| *name == text);
        let tree = parse::parse(built_in.map_or(text, |(_, meaning)| meaning))?;
        Ok(Self { text: text.to_string(), tree })
    }

    /// The text it was made from.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Names that stand for expressions, after Arnold's built-in ones. Here "direct" is light from any source, the environment
/// and emissive surfaces included, "specular" both glossy and mirror reflection, and under every [`EmitterAs`]
/// `emission`, `background`, and direct and indirect light of each kind add up to the whole.
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
