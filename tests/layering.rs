//! Checks rules of the source code: which module may use which, which files may contain `unsafe`, which macros are
//! banned, how long files may be, and that float constants state their origin.

#[path = "layering/circles.rs"]
mod circles;

use std::path::{Path, PathBuf};

/// The modules that each module of `src` may use besides itself. Each module uses only modules above it in this list.
const ARROWS: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("warning", &[]),
    ("reserve", &[]),
    ("quiet", &[]),
    ("job", &["error", "reserve"]),
    ("exec", &["reserve", "quiet", "error", "job"]),
    ("rng", &[]),
    ("simd", &[]),
    ("image", &["reserve", "error", "job", "exec", "simd"]),
    ("geometry", &["error", "rng"]),
    ("network", &["error", "job", "exec", "simd", "image"]),
    ("photometry", &["error", "image"]),
    ("accel", &["simd", "error", "job", "exec", "image"]),
    ("scene", &["simd", "error", "warning", "job", "exec", "rng", "image", "geometry", "photometry"]),
    ("render", &["simd", "error", "job", "exec", "rng", "image", "geometry", "photometry", "accel", "scene"]),
    ("patch", &["simd", "error", "job", "exec", "rng", "image"]),
    // Stages never use each other, with one exception: segmentation reads the number of channels of the features.
    ("features", &["simd", "error", "warning", "job", "exec", "rng", "image", "geometry", "network"]),
    ("segment", &["simd", "error", "warning", "job", "exec", "rng", "image", "geometry", "features"]),
    ("rectify", &["simd", "error", "warning", "job", "exec", "rng", "image", "geometry"]),
    ("emission", &["error", "warning", "job", "exec", "rng", "image", "geometry", "patch"]),
    ("fixture", &["error", "job", "image", "geometry", "scene"]),
    ("relight", &["error", "warning", "job", "exec", "rng", "image", "geometry", "scene", "render"]),
    ("stylize", &["error", "warning", "job", "exec", "rng", "image", "geometry", "patch"]),
    // Pipelines, which pass data between stages.
    ("guides", &["error", "warning", "job", "exec", "rng", "image", "geometry", "scene", "render"]),
    ("sheet", &["error", "job", "exec", "image", "geometry", "rectify"]),
    ("demo", &["error", "job", "exec", "rng", "image", "geometry", "scene", "render", "segment", "guides"]),
    (
        "transfer",
        &[
            "error",
            "warning",
            "job",
            "exec",
            "rng",
            "image",
            "geometry",
            "scene",
            "render",
            "features",
            "segment",
            "rectify",
            "emission",
            "relight",
            "photometry",
        ],
    ),
    // Chooses the settings of the pipelines.
    ("plan", &["error", "job", "scene", "render", "relight", "transfer", "stylize"]),
];

/// Files outside `ffi` that may contain `unsafe`: SIMD kernels, chosen at run time, and the memory that they work on.
const UNSAFE: &[&str] = &[
    "reserve.rs",
    "simd.rs",
    "image/pages.rs",
    "rectify/lanes.rs",
    "rectify/gather.rs",
    "accel/cluster.rs",
    "accel/lanes.rs",
    "accel/lines.rs",
    "accel/node.rs",
    "accel/packet.rs",
    "accel/pages.rs",
    "accel/stack.rs",
    "accel/traverse.rs",
    "patch/kernel.rs",
];

/// The only allowed thread-local state, and its module: whether the thread is inside the library.
const PER_THREAD: (&str, &str) = ("thread_local!", "quiet");

/// Maximum numbers of comments on constants with the tags `[origin not recorded]` and `[judged on N photos]`
/// (docs/glossary.md, "Tags of constants"). They may only be lowered.
const UNRECORDED: usize = 113;
const JUDGED: usize = 100;

/// Maximum number of lines of a file.
const MAX_LINES: usize = 600;

fn sources() -> Vec<(PathBuf, String)> {
    fn walk(folder: &Path, out: &mut Vec<(PathBuf, String)>) {
        let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        entries.sort();
        for path in entries {
            if path.is_dir() {
                walk(&path, out);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                out.push((path, text));
            }
        }
    }
    let mut out = Vec::new();
    walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), &mut out);
    assert!(out.len() > 20, "the sources were not found");
    out
}

/// The module that a file belongs to: its folder under `src`, or its own name.
fn part(path: &Path) -> String {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let first = path.strip_prefix(src).unwrap().components().next().unwrap();
    first.as_os_str().to_string_lossy().trim_end_matches(".rs").to_string()
}

/// Whether a file holds unit tests: it is named `tests.rs`, or lies in a folder `tests`.
fn is_test(path: &Path) -> bool {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    path.strip_prefix(src).unwrap().components().any(|c| c.as_os_str().to_string_lossy().contains("tests"))
}

#[test]
fn every_part_uses_only_what_lies_below_it() {
    for (path, text) in sources() {
        let part = part(&path);
        if part == "lib" || part == "ffi" {
            continue;
        }
        let allowed = ARROWS.iter().find(|(name, _)| *name == part).unwrap_or_else(|| panic!("{part} has no rule")).1;
        // Unit tests may build their input with any module.
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        if is_test(&path) {
            continue;
        }
        for (at, _) in code.match_indices("crate::") {
            let rest = &code[at + "crate::".len()..];
            let names: Vec<&str> = match rest.strip_prefix('{') {
                Some(group) => group.split('}').next().unwrap().split(',').map(str::trim).collect(),
                None => vec![rest],
            };
            for name in names {
                let name: String = name.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let ok = name.is_empty() || name == part || allowed.contains(&name.as_str());
                assert!(ok, "{} uses crate::{name}, which {part} may not", path.display());
            }
        }
    }
}

#[test]
fn unsafe_stands_only_at_the_c_boundary_and_in_simd_kernels() {
    for (path, text) in sources() {
        if part(&path) == "ffi" || part(&path) == "lib" || UNSAFE.iter().any(|u| path.ends_with(u)) {
            continue;
        }
        let found = text.lines().find(|l| l.split("//").next().unwrap().split_whitespace().any(|w| w == "unsafe"));
        assert!(found.is_none(), "{}: {}", path.display(), found.unwrap_or_default());
    }
}

#[test]
fn nothing_unfinished_nothing_printed_nothing_too_long() {
    let banned = ["todo!(", "unimplemented!(", "println!(", "print!(", "dbg!(", "static mut", "thread_local!"];
    for (path, text) in sources() {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for word in banned {
            let is_allowed = is_test(&path) || (word, part(&path).as_str()) == PER_THREAD;
            assert!(is_allowed || !code.contains(word), "{} contains {word}", path.display());
        }
        let lines = text.lines().count();
        assert!(lines <= MAX_LINES, "{} has {lines} lines; split it along a step of its algorithm", path.display());
    }
}

/// The comment above a line, also if other constants stand in between: neighbouring constants share one comment.
fn comment_above(lines: &[&str], at: usize) -> String {
    let is_constant = |l: &str| l.trim_start_matches("pub ").contains("const ") && !l.starts_with("//");
    let above = lines[..at].iter().rev().map(|l| l.trim()).skip_while(|l| is_constant(l));
    let comment: Vec<&str> =
        above.take_while(|l| l.starts_with("//")).map(|l| l.trim_start_matches(['/', ' '])).collect();
    comment.into_iter().rev().collect::<Vec<_>>().join(" ")
}

#[test]
fn float_constants_say_where_they_come_from() {
    const TAGS: [&str; 6] = ["[paper", "[bench", "[rounding]", "[convention", "[judged on ", "[origin not recorded]"];
    let (mut unrecorded, mut judged) = (0, 0);
    for (path, text) in sources().iter().filter(|(path, _)| !is_test(path)) {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        let comments = code.replace("\n///", "");
        unrecorded += comments.matches("[origin not recorded]").count();
        judged += comments.matches("[judged on ").count();
        let lines: Vec<&str> = code.lines().collect();
        for (at, line) in lines.iter().enumerate() {
            let constant = line.trim_start().trim_start_matches("pub ").strip_prefix("const ");
            let Some((_, kind)) = constant.and_then(|c| c.split_once(": ")) else { continue };
            let kind = kind.trim_start_matches(['[', '(']);
            if line.contains("fn ") || !(kind.starts_with("f32") || kind.starts_with("f64")) {
                continue;
            }
            let comment = comment_above(&lines, at);
            assert!(TAGS.iter().any(|tag| comment.contains(tag)), "{}: no tag on {line:?}", path.display());
        }
    }
    assert!(unrecorded <= UNRECORDED, "{unrecorded} constants of unrecorded origin; there were {UNRECORDED}");
    assert!(judged <= JUDGED, "{judged} constants judged by eye; there were {JUDGED}");
}

#[test]
fn files_of_a_module_do_not_use_each_other_in_circles() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let relative = |path: PathBuf| path.strip_prefix(&src).unwrap().to_string_lossy().into_owned();
    let sources: Vec<(String, String)> = sources().into_iter().map(|(path, text)| (relative(path), text)).collect();
    let found = circles::circles(&sources);
    assert!(found.is_empty(), "modules that use each other in a circle: {found:?}");
    // Test the check itself: two files that use each other form a circle, and a re-export does not count as a use.
    let file = |name: &str, text: &str| (name.to_string(), text.to_string());
    let all = [
        file("a/mod.rs", "mod b; mod c; pub use b::B; use c::C; /* */"),
        file("a/b.rs", "use super::c::{self, C}; pub struct B;"),
        file("a/c.rs", "pub struct C; fn f() { super::B; } // super::d::D"),
    ];
    assert_eq!(circles::circles(&all), [["a::b", "a::c"]]);
    assert_eq!(circles::circles(&all[..2]), [[""; 0]; 0]);
}
