//! Light path expressions: each renders an image of the light that arrived by certain paths (Heckbert 1990, "Adaptive
//! radiosity textures for bidirectional ray tracing"; StyLit, section 3.2; Open Shading Language, "OSL Light Path
//! Expressions").
//!
//! An expression is a regular expression over the events of a light path. It is written in one of two orders:
//!
//! * Light first, as in the papers, from a light `L` to the eye `E`: `LDE`, `LSE`, `LD{1,2}E`, `L.*DDE`, `LS*DE`. In
//!   this order, `L` is any light, and `S` is any scattering event that is not diffuse, as Heckbert's notation has no
//!   further classes.
//! * Camera first, as in Open Shading Language, from the camera `C`: `C<RD>L`, `C[GS]+.*<L.'Lamp'>`.
//!
//! | event | |
//! |---|---|
//! | `<type mode labels>` | such as `<RD>`, `<TS'pane'>`; each part is a letter, `.` for any, `[..]`, or `[^..]` |
//! | types | `R` reflection, `T` transmission, `V` volume (never occurs here); `L` `O` `B` lights; `C` the camera |
//! | modes | `D` diffuse, `G` glossy, `S` mirror or clear pane, `s` clear pane (straight) |
//! | labels | names of objects (meshes), materials and lights |
//! | `D`, `R`, `L`, `'x'` | short for `<.D>`, `<R.>`, `<L.>`, `<..'x'>` |
//! | `.` `[DS]` `[^D]` | any event, one of these, any except these |
//! | `*` `+` `?` `{n}` `{n,}` `{n,m}` `\|` `( )` | as in any regular expression |
//!
//! The labels of an emissive surface are the names of its object and material. Punctual lights are called `light0`,
//! `light1`, ... in the order of the scene, and the environment is called `environment`. `Name#0`, `Name#1`, ... are
//! the lamps in the emission texture of the object or material Name: its connected regions, in the order of their
//! first texels.
//!
//! If an event has several labels, all must match: `<RD'Floor''Wood'>`. A label that does not exist in the scene is an
//! error, since a black image would hide the mistake; excluded labels (`[^'coat']`) need not exist. In Open Shading
//! Language, emissive surfaces are `O` and the environment is `B`; [`EmitterAs`] decides whether they are also `L`. The
//! built-in expressions of the renderer Arnold are available by name ([`BUILT_IN`]).
//!
//! Events at a surface: the diffuse layer is `<RD>`; the top layer is `<RG>`, or `<RS>` if it is a mirror. A clear
//! pane is both `<TS>` and `<Ts>`, for paths and for shadow rays. Where a ray passes through a surface because its
//! opacity is below 1, there is no event.
//!
//! `parse` turns the text into a tree. `alphabet` numbers the events of the scene, and `automaton` compiles all
//! expressions of a render into one automaton over these events. `path_tracker` tracks the states of a path in the
//! automaton.

mod alphabet;
mod automaton;
mod parse;
mod path_tracker;
mod sparse_sums;

pub(super) use automaton::Automaton;
pub(super) use path_tracker::{PathOutcome, PathTracker};

use crate::error::Result;

/// Which of the letters `L`, `O` and `B` match emissive surfaces and the environment in camera-first expressions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EmitterAs {
    /// Surfaces are both `L` and `O`, and the environment is both `L` and `B`. `C<RD>L` is therefore all directly lit
    /// diffuse reflection. If the images of an `L` and of an `O` expression are added, surfaces count twice.
    #[default]
    Both,
    /// All lights are `L` only.
    Light,
    /// As in Open Shading Language: surfaces are `O`, the environment is `B`, punctual lights are `L`.
    Object,
}

/// A parsed light path expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    text: String,
    tree: parse::SyntaxTree,
}

impl Expression {
    /// Parses an expression in either order, or the name of a built-in expression.
    ///
    /// # Errors
    /// A syntax error, with its column, the character found there, and the characters allowed there.
    pub fn parse(text: &str) -> Result<Self> {
        let built_in = BUILT_IN.iter().find(|(name, _)| *name == text);
        let tree = parse::parse(built_in.map_or(text, |(_, meaning)| meaning))?;
        Ok(Self { text: text.to_string(), tree })
    }

    /// Returns the text from which the expression was parsed.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// Name and text of each built-in expression, after the renderer Arnold. "direct" is light that is scattered once on
/// its way from a source to the camera. A source is a light, the environment or an emissive surface. "specular" is
/// glossy and mirror reflection. Whichever [`EmitterAs`] is chosen, `emission`, `background`, and the direct and
/// indirect light of all kinds add up to the whole image.
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
