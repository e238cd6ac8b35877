//! Tests of light path expressions: which written-out paths they accept, and which expressions are refused.

use super::alphabet::Scatter;
use super::automaton::DEAD;
use super::{Automaton, BUILT_IN, EmitterAs, Expression};
use crate::error::{Error, ErrorKind};
use crate::render::LightSource;
use crate::scene::{Material, Mesh, PunctualLight, Scene};
use glam::{Vec2, Vec3};

const MESHES: [(&str, &str); 4] = [("Floor", "Wood"), ("Ball", "Chrome"), ("Window", "Glass"), ("Lamp", "Glow")];

fn scene() -> Scene {
    let mesh = |i: usize| Mesh { name: MESHES[i].0.into(), material: i, ..Mesh::default() };
    let light = PunctualLight::Point { position: Vec3::ZERO, intensity: Vec3::ONE };
    Scene {
        meshes: (0..4).map(mesh).collect(),
        materials: MESHES.iter().map(|m| Material { name: m.1.into(), ..Material::default() }).collect(),
        lights: vec![light, light],
        ..Scene::default()
    }
}

fn automaton(expressions: &[&str], emitter_as: EmitterAs) -> Automaton {
    let parsed: Vec<Expression> = expressions.iter().map(|e| Expression::parse(e).unwrap()).collect();
    Automaton::new(&scene(), &parsed.iter().collect::<Vec<_>>(), emitter_as).unwrap()
}

/// Returns the indices of the expressions that accept a path. The path is written camera first, as in `D G@Ball S T
/// L`. Scattering events are the modes `D`, `G` and `S`, and `T` for a pane. The last event is `L` for a lamp, `P` or
/// `Q` for one of two punctual lights, or `B` for the environment. `@` names the object; by default it is the ball for
/// `S`, the window for `T`, the lamp for `L`, and the floor for `D` and `G`.
fn accepted(automaton: &Automaton, path: &str) -> Vec<u16> {
    let mut state = automaton.start();
    for event in path.split_whitespace() {
        let (letter, object) = event.split_once('@').unwrap_or((event, ""));
        let mesh = |default: u32| MESHES.iter().position(|m| m.0 == object).map_or(default, |i| i as u32);
        let lamp = |mesh| LightSource::Surface { mesh, triangle: 0, uv: Vec2::ZERO };
        let go = |mesh, scatter| automaton.next(state, automaton.class(mesh))[scatter as usize];
        let end = |source| automaton.lists()[usize::from(automaton.accepting(state, automaton.light(source)))].clone();
        state = match letter {
            "D" => go(mesh(0), Scatter::Diffuse),
            "G" => go(mesh(0), Scatter::Glossy),
            "S" => go(mesh(1), Scatter::Mirror),
            "T" => go(mesh(2), Scatter::Pane),
            "L" => return end(lamp(mesh(3))),
            "P" => return end(LightSource::Punctual(0)),
            "Q" => return end(LightSource::Punctual(1)),
            "B" => return end(LightSource::Environment),
            other => panic!("{other}"),
        };
    }
    panic!("{path} does not end at a light");
}

/// An expression, paths that it must accept, and paths that it must reject.
type Row = (&'static str, &'static [&'static str], &'static [&'static str]);

const LIGHT_FIRST: &[Row] = &[
    ("LDE", &["D L", "D P", "D B"], &["L", "G L", "S L", "T L", "D D L", "D T L", "G D L"]),
    ("LSE", &["G L", "S L", "T L", "G P", "S B"], &["L", "D L", "G G L", "D S L"]),
    ("LD{1,2}E", &["D L", "D D L", "D D P"], &["L", "D D D L", "D G L", "G D L"]),
    ("L.*DDE", &["D D L", "D D D L", "D D G S T L", "D D B"], &["D L", "D G D L", "G D D L", "L"]),
    ("LS*DE", &["D L", "D G L", "D S L", "D T L", "D G S T P"], &["L", "D D L", "G D L", "D G D L"]),
    ("LS+DE", &["D G L", "D T B"], &["D L", "G D L"]),
    ("L(D|S)*E", &["L", "D L", "D G S T D L"], &[]),
    ("LDS*E", &["D L", "S D L", "G T D L"], &["D S L", "D D L"]),
    ("LE", &["L", "B"], &["D L"]),
    ("L D S E", &["S D L", "G D L"], &["D S L"]),
    ("LGE", &["G L"], &["S L", "T L", "D L"]),
    ("L<RS>E", &["G L", "S L"], &["T L", "D L"]),
    ("L<Ts>DE", &["D T L"], &["T D L", "D S L", "D L"]),
    ("OE", &["L"], &["P", "B"]),
    ("<L.'Lamp'>DE", &["D L"], &["D L@Ball", "D P", "D B"]),
    ("L<RD'Floor'>SE", &["S D L", "G@Ball D L"], &["S D@Ball L"]),
    ("LD{2}E", &["D D L"], &["D L", "D D D L"]),
    ("LD{2,}E", &["D D L", "D D D D L"], &["D L"]),
    ("LD?SE", &["S L", "S D L"], &["S D D L", "D S L"]),
    ("L[^D]E", &["G L", "S L", "T L"], &["D L", "L"]),
    ("BD*E", &["B", "D B", "D D B"], &["D L", "D P"]),
];

const CAMERA_FIRST: &[Row] = &[
    ("C.*", &["L", "D P", "G S T D B"], &[]),
    ("C<RD>L", &["D L", "D P", "D B"], &["G L", "D D L", "L"]),
    ("CDL", &["D L"], &["D T L", "S L"]),
    ("C[GS]L", &["G L", "S L", "T L"], &["D L", "G G L"]),
    ("CDD.*L", &["D D L", "D D S L"], &["D L", "D S D L"]),
    ("CD{1,2}L", &["D L", "D D L"], &["D D D L"]),
    ("C<RS>L", &["S L"], &["G L", "T L"]),
    ("C<RG>L", &["G L"], &["S L", "D L"]),
    ("C<TS>.*L", &["T L", "T D L"], &["S L", "D T L"]),
    ("CsL", &["T L"], &["S L"]),
    ("C<.D>O", &["D L"], &["D P", "D B"]),
    ("C.*B", &["B", "D B"], &["D L", "P"]),
    ("C.*<L.'Lamp'>", &["L", "D S L"], &["P", "D L@Ball", "B"]),
    ("C.*<L.'Glow'>", &["D L"], &["D L@Ball"]),
    ("C.*'light1'", &["Q", "D Q"], &["P", "D P", "L"]),
    ("C.*<[LB].'environment'>", &["B", "D B"], &["L"]),
    ("C<RD'Floor'>.*L", &["D L", "D D@Ball L"], &["D@Ball L", "G L"]),
    ("C<RD'Floor''Wood'>L", &["D L"], &["D@Ball L"]),
    ("C<RD'Floor''Glow'>L|CDL", &["D L", "D@Ball L"], &["G L"]),
    ("C<R[DG][^'Ball']>L", &["D L", "G L"], &["D@Ball L", "S L"]),
    ("C<RS[^'coat''sheen']>.*L", &["S L", "S D L"], &["G L"]),
    ("C<R.['Floor''Ball']>L", &["D L", "S L"], &["G@Lamp L", "T L"]),
    ("C<R[^D]>L", &["G L", "S L"], &["D L", "T L"]),
    ("C<[^T].>L", &["D L", "S L"], &["T L"]),
    ("C[^D]+L", &["G L", "S T L"], &["D L", "G D L"]),
    ("C[^'Floor']L", &["S L", "T L", "D@Ball L"], &["D L", "G L"]),
    ("C[D'Ball']L", &["D L", "S L", "G@Ball L"], &["G L", "T L"]),
    ("C[<RD><TS>]L", &["D L", "T L"], &["G L", "S L"]),
    ("C(DG)*L", &["L", "D G L", "D G D G L"], &["D L", "G D L"]),
    ("C(D|GS)+L", &["D L", "G S L", "D G S D L"], &["G L", "L"]),
    ("C(D{1,2}G){2}L", &["D G D G L", "D D G D D G L"], &["D G L", "D D D G D G L"]),
    ("CD{0,1}L", &["L", "D L"], &["D D L"]),
    ("C .* [LO]", &["L", "D P"], &[]),
    ("(CDL)|(CGL)", &["D L", "G L"], &["S L"]),
    ("C[RT]L", &["D L", "T L"], &["L", "D D L"]),
];

#[test]
fn expressions_accept_exactly_their_paths() {
    let mut rows = 0;
    for &(expression, yes, no) in LIGHT_FIRST.iter().chain(CAMERA_FIRST) {
        let automaton = automaton(&[expression], EmitterAs::Both);
        for (paths, expected) in [(yes, vec![0]), (no, vec![])] {
            for path in paths {
                assert_eq!(accepted(&automaton, path), expected, "{expression} and {path}");
                rows += 1;
            }
        }
    }
    assert!(rows >= 180, "{rows}");
}

#[test]
fn all_expressions_together_accept_what_each_accepts_alone() {
    let rows: Vec<&Row> = LIGHT_FIRST.iter().chain(CAMERA_FIRST).collect();
    let expressions: Vec<&str> = rows.iter().map(|r| r.0).collect();
    let together = automaton(&expressions, EmitterAs::Both);
    for (number, (expression, yes, no)) in rows.iter().enumerate() {
        let number = number as u16;
        assert!(yes.iter().all(|p| accepted(&together, p).contains(&number)), "{expression}");
        assert!(!no.iter().any(|p| accepted(&together, p).contains(&number)), "{expression}");
    }
    // The five expressions of StyLit need few states. This matters because a path stores its light once for each
    // state.
    let five = automaton(&["L.*E", "LDE", "LSE", "L.*DDE", "LD{1,2}E"], EmitterAs::Both);
    assert!(five.states() <= 8, "{} states", five.states());
}

#[test]
fn emitters_are_the_letters_they_are_asked_to_be() {
    let expressions = ["CDL", "CDO", "CDB"];
    for (emitter_as, lamp, sky) in [
        (EmitterAs::Both, vec![0, 1], vec![0, 2]),
        (EmitterAs::Light, vec![0], vec![0]),
        (EmitterAs::Object, vec![1], vec![2]),
    ] {
        let automaton = automaton(&expressions, emitter_as);
        assert_eq!(accepted(&automaton, "D L"), lamp, "{emitter_as:?}");
        assert_eq!(accepted(&automaton, "D B"), sky, "{emitter_as:?}");
        assert_eq!(accepted(&automaton, "D P"), [0], "{emitter_as:?}");
    }
}

#[test]
fn built_in_kinds_of_light_add_up_to_the_whole() {
    let paths = ["L", "P", "B", "D L", "G P", "S B", "T L", "D D L", "D T L", "G D B", "S S P", "T T L", "T G D L"];
    let parts: [&[&str]; 2] = [
        &["emission", "background", "direct", "indirect"],
        &[
            "emission",
            "background",
            "diffuse_direct",
            "diffuse_indirect",
            "specular_direct",
            "specular_indirect",
            "transmission_direct",
            "transmission_indirect",
        ],
    ];
    for emitter_as in [EmitterAs::Both, EmitterAs::Light, EmitterAs::Object] {
        for parts in parts {
            let automaton = automaton(parts, emitter_as);
            for path in paths {
                // A punctual light is invisible to the camera, so no expression needs to accept the path.
                if path != "P" {
                    assert_eq!(accepted(&automaton, path).len(), 1, "{path}, {emitter_as:?}");
                }
            }
        }
    }
    for (name, _) in BUILT_IN {
        assert_eq!(Expression::parse(name).unwrap().text(), *name);
    }
}

#[test]
fn paths_that_no_expression_can_accept_are_dropped_at_once() {
    let automaton = automaton(&["LDE", "LSE"], EmitterAs::Both);
    let class = automaton.class(0);
    let [diffuse, ..] = *automaton.next(automaton.start(), class);
    assert_ne!(diffuse, DEAD);
    assert_eq!(automaton.next(diffuse, class)[Scatter::Diffuse as usize], DEAD);
}

#[test]
fn syntax_errors_state_their_column() {
    let rows: &[(&str, usize, &str)] = &[
        ("", 1, "expected an event"),
        ("LDXE", 3, "found 'X'"),
        ("~C.*L", 1, "found '~'"),
        ("C.*L:noshadow", 5, "found ':'"),
        ("DL", 3, "expected C at the start"),
        ("diffuse_dirct", 1, "found 'd'"),
        ("CDE", 3, "C and E"),
        ("C<RD", 5, "found the end"),
        ("C<XD>L", 3, "a type"),
        ("C<RX>L", 4, "a mode"),
        ("C<R'a'>L", 4, "before the label"),
        ("C<RD'a>L", 5, "no closing quote"),
        ("C<RD''>L", 6, "the label is empty"),
        ("C<RD[a]>L", 6, "a label in quotes"),
        ("C<LD>", 3, "does not scatter"),
        ("C[DS", 5, "found the end"),
        ("C[]L", 3, "an event of the set"),
        ("C(D|)L", 5, "found ')'"),
        ("C(DL", 5, "')'"),
        ("CD)L", 3, "found ')'"),
        ("C*+L", 3, "found '+'"),
        ("CD{}L", 4, "a number"),
        ("CD{2,1}L", 4, "second number"),
        ("CD{0}L", 4, "at least one"),
        ("CD{1,99}L", 6, "at most 64"),
        ("CD{1L", 5, "'}'"),
        ("C<RD>A", 6, "albedo"),
        ("|CL", 1, "found '|'"),
        ("Cé", 2, "found 'é'"),
    ];
    for (text, column, says) in rows {
        let error = Expression::parse(text).unwrap_err();
        assert_eq!(error.kind, ErrorKind::InvalidArgument, "{text}");
        assert!(error.message.contains(&format!("column {column}:")), "{text}: {}", error.message);
        assert!(error.message.contains(says), "{text}: {}", error.message);
    }
    assert!(Expression::parse(&"(".repeat(100_000)).is_err());
    let deep = format!("C{}D{}L", "(".repeat(2000), ")".repeat(10));
    assert!(Expression::parse(&deep).unwrap_err().message.contains("deeper"));
}

fn refused(text: &str) -> Error {
    let expression = Expression::parse(text).unwrap();
    Automaton::new(&scene(), &[&expression], EmitterAs::Both).err().unwrap()
}

#[test]
fn expressions_with_too_many_states_are_refused() {
    // For `C.*D.{12}L`, the automaton must remember which of the last 12 scattering events were diffuse, which takes
    // at least 2^12 states.
    automaton(&["C.*D.{8}L"], EmitterAs::Both);
    for text in ["C.*D.{12}L", "L(DD|....+.(DD|....+...S?){8}E?){6}E"] {
        let error = refused(text);
        assert!(error.kind == ErrorKind::InvalidArgument && error.message.contains("4096 states"), "{text}: {error}");
    }
}

#[test]
fn expressions_that_no_path_can_match_are_refused() {
    for text in ["C", "CD", "CVL", "CLD", "CCL", "LED", "C<RD'Floor''Ball'>L"] {
        assert!(refused(text).message.contains("matches no path"), "{text}");
    }
    let error = refused("C<RD'Flor'>L");
    assert_eq!(error.kind, ErrorKind::NotFound);
    assert!(error.message.contains("'Flor'") && error.message.contains("'Floor'"), "{}", error.message);
    // Test an expression with exponentially many states, and one whose nested repetitions have a huge number of NFA
    // states.
    let states = format!("C.*D{}L", ".".repeat(20));
    assert!(refused(&states).message.contains("states"));
    assert!(refused("C((D{64}G){64}S){64}L").message.contains("states"));
}
