//! Checks rules of the source code: which module may use which, which files may contain `unsafe`, which macros are
//! banned, how long files and comment lines may be, that float constants state their origin, and that the name of a
//! type has one meaning in its module.

#[path = "layering/circles.rs"]
mod circles;
#[path = "layering/comments.rs"]
mod comments;
#[path = "layering/constants.rs"]
mod constants;
#[path = "layering/names.rs"]
mod names;

use std::path::{Path, PathBuf};

/// The modules that each module of `src` may use besides itself. Each module uses only modules above it in this list.
const ARROWS: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("warning", &[]),
    ("reserve", &[]),
    ("quiet", &[]),
    ("job", &["error", "reserve"]),
    ("exec", &["reserve", "quiet", "error", "job"]),
    ("maths", &[]),
    ("rng", &["maths"]),
    ("simd", &[]),
    ("image", &["reserve", "error", "job", "exec", "simd", "maths"]),
    ("geometry", &["error", "maths", "rng"]),
    ("network", &["error", "job", "exec", "simd", "maths", "image"]),
    ("photometry", &["error", "maths", "image"]),
    ("daylight", &["error", "maths", "image", "photometry"]),
    ("accel", &["simd", "error", "job", "exec", "maths", "image"]),
    ("scene", &["simd", "error", "warning", "job", "exec", "maths", "rng", "image", "geometry", "photometry"]),
    ("render", &["simd", "error", "job", "exec", "maths", "rng", "image", "geometry", "photometry", "accel", "scene"]),
    ("patch", &["simd", "error", "job", "exec", "rng", "image"]),
    // Stages never use each other, with one exception: segmentation reads the layout of the channels of the features.
    ("features", &["simd", "error", "warning", "job", "exec", "maths", "rng", "image", "geometry", "network"]),
    ("segment", &["simd", "error", "warning", "job", "exec", "maths", "rng", "image", "geometry", "features"]),
    ("rectify", &["simd", "error", "warning", "job", "exec", "maths", "rng", "image", "geometry"]),
    ("emission", &["error", "warning", "job", "exec", "maths", "rng", "image", "geometry", "patch"]),
    ("pendant", &["error", "job", "maths", "image", "geometry", "scene"]),
    ("relight", &["error", "warning", "job", "exec", "maths", "rng", "image", "geometry", "scene", "render"]),
    ("stylize", &["error", "warning", "job", "exec", "maths", "rng", "image", "geometry", "patch"]),
    // Pipelines, which pass data between stages.
    ("guides", &["error", "warning", "job", "exec", "maths", "rng", "image", "geometry", "scene", "render"]),
    ("sheet", &["error", "job", "exec", "maths", "image", "geometry", "rectify"]),
    ("demo", &["error", "job", "exec", "maths", "rng", "image", "geometry", "scene", "render", "segment", "guides"]),
    ("schedule", &["maths", "image", "scene", "photometry", "emission"]),
    (
        "transfer",
        &[
            "error", "warning", "job", "exec", "rng", "image", "geometry", "scene", "render", "features", "segment",
            "rectify", "emission", "relight", "schedule",
        ],
    ),
    // Chooses the settings of the pipelines.
    ("plan", &["error", "job", "maths", "scene", "render", "relight", "transfer", "stylize"]),
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
    "accel/cache_lines.rs",
    "accel/node.rs",
    "accel/packet.rs",
    "accel/pages.rs",
    "accel/stack.rs",
    "accel/traverse.rs",
    "patch/kernel.rs",
];

/// The only allowed thread-local state, and its module: whether the thread is inside the library.
const PER_THREAD: (&str, &str) = ("thread_local!", "quiet");

/// Number of comments on constants with the tag `[judged on N photos]` or `[judged on N scenes]` (docs/glossary.md,
/// "Tags of constants"). It may only be lowered.
const JUDGED: usize = 98;

/// Maximum number of lines of a file.
const MAX_LINES: usize = 600;

/// The text files of a folder of the project and of its subfolders, without built and generated ones.
fn files(folder: &str) -> Vec<(PathBuf, String)> {
    fn walk(folder: &Path, out: &mut Vec<(PathBuf, String)>) {
        let mut entries: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
        entries.sort();
        for path in entries {
            if comments::SKIPPED.iter().any(|name| path.ends_with(name)) {
                continue;
            }
            if path.is_dir() {
                walk(&path, out);
            } else if let Ok(text) = std::fs::read_to_string(&path) {
                out.push((path, text));
            }
        }
    }
    let mut out = Vec::new();
    walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut out);
    out
}

/// The Rust files of the library. A file in a folder `absent` stands in for a file of the same name in builds without a
/// Cargo feature; only one of the two is compiled, and here it is the other.
fn sources() -> Vec<(PathBuf, String)> {
    let mut out = files("src");
    out.retain(|(path, _)| path.extension().is_some_and(|e| e == "rs"));
    out.retain(|(path, _)| !path.parent().is_some_and(|folder| folder.ends_with("absent")));
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

#[test]
fn comment_lines_are_not_too_long() {
    let root_file = |name: &&str| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
        let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{name}: {error}"));
        (path, text)
    };
    let all = comments::FOLDERS.iter().flat_map(|folder| files(folder));
    let all = all.chain(comments::ROOT_FILES.iter().map(root_file));
    let long = |(path, text): (PathBuf, String)| {
        comments::long_comments(&path, &text).into_iter().map(move |line| format!("{}:{line}", path.display()))
    };
    let found: Vec<String> = all.flat_map(long).collect();
    assert!(found.is_empty(), "comment lines of more than 120 characters:\n{}", found.join("\n"));
    // Test the check itself: characters count, not bytes, and code does not count.
    let line = |start: &str, length: usize| format!("{start}{}\n", "é".repeat(length - start.len()));
    let rust = line("// ", 120) + &line("let a = ", 130) + &line("// ", 121);
    assert_eq!(comments::long_comments(Path::new("a.rs"), &rust), [3]);
    let script = line("# ", 120) + &line("echo ", 130) + &line("# ", 121);
    for name in ["Makefile", ".ci/run", "mkdocs.yml", "deny.toml"] {
        assert_eq!(comments::long_comments(Path::new(name), &script), [3], "{name}");
    }
    let python = line("\"\"\"A ", 110) + &line("", 121) + "\"\"\"\na = \"\"\"\n" + &line("# ", 121) + "\"\"\"\n# ";
    assert_eq!(comments::long_comments(Path::new("a.py"), &line(&python, python.len() + 120)), [2, 7]);
}

#[test]
fn float_constants_say_where_they_come_from() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let (mut judged, mut wrong) = (Vec::new(), Vec::new());
    for (path, text) in sources().iter().filter(|(path, _)| !is_test(path)) {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        // The demonstration scenes choose their colours and sizes freely.
        let found = constants::origins(code, part(path) != "demo");
        let name = path.strip_prefix(&src).unwrap().display();
        judged.extend((found.judged > 0).then(|| (found.judged, name.to_string())));
        wrong.extend(found.wrong.iter().map(|problem| format!("{name}: {problem}")));
    }
    assert!(wrong.is_empty(), "constants without an origin:\n{}", wrong.join("\n"));
    let count: usize = judged.iter().map(|(count, _)| count).sum();
    let list: String = judged.iter().map(|(count, name)| format!("{count:4} {name}\n")).collect();
    assert_eq!(count, JUDGED, "JUDGED is to be lowered to the present number and never raised; by file:\n{list}");
}

#[test]
fn the_check_of_constants_sees_every_kind() {
    let kinds = [
        "const A: f64 = 0.5;",
        "pub const A: [f32; 2] = [0.5; 2];",
        "pub(super) const A: f64 = 0.5;",
        "    pub(crate) const A: DVec3 = DVec3::ONE;",
        "const A: (usize, f32) = (8, 0.5);",
        "const A: &[(Kind, [f32; 3])] = &[",
    ];
    for kind in kinds {
        assert_eq!(constants::origins(kind, true).wrong.len(), 1, "{kind}");
        let tagged = format!("/// Half. [bench\n/// emission]\nconst B: usize = 1;\n{kind}");
        assert_eq!(constants::origins(&tagged, true), constants::Origins::default(), "{kind}");
    }
    assert_eq!(constants::origins(kinds[3], false).wrong.len(), 0);
    // A constant whose tag is not documented counts as a constant without a tag.
    assert_eq!(constants::origins("/// Half. [origin not recorded]\nconst A: f32 = 0.5;", true).wrong.len(), 1);
    for other in
        ["const A: usize = 1;", "pub const fn a(b: f32) -> f32 {", "let a: f32 = 1.0;", "fn a<const N: f32>() {"]
    {
        assert_eq!(constants::origins(other, true), constants::Origins::default(), "{other}");
    }
    let judged = constants::origins("/// [judged on 3\n/// photos] [judged on 1 scene] [judged on rooms]", true);
    assert_eq!((judged.judged, judged.wrong.len()), (3, 1));
}

#[test]
fn the_name_of_a_type_has_one_meaning_in_a_module() {
    let library = sources().into_iter().filter(|(path, _)| !is_test(path));
    let library: Vec<(String, String)> = library.map(|(path, text)| (part(&path), text)).collect();
    let found = names::with_two_meanings(&library);
    assert!(found.is_empty(), "names that a module gives to two types: {found:?}");
    // Test the check itself: types of unit tests and of other modules do not count.
    let file = |part: &str, text: &str| (part.to_string(), text.to_string());
    let all = [
        file("a", "pub struct B<'a> {}\npub(super) type C = B;\nimpl D for B {\n    type Item = B;\n}\nstruct Params;"),
        file("a", "enum C { B }\npub struct Params;\n#[cfg(test)]\nmod tests {\nstruct B;\n}"),
        file("b", "struct B;"),
    ];
    assert_eq!(names::with_two_meanings(&all), ["a::C"]);
}

#[test]
fn the_glossary_lists_names_of_types_in_several_modules() {
    let library = sources().into_iter().filter(|(path, _)| !is_test(path));
    let library: Vec<(String, String)> = library.map(|(path, text)| (part(&path), text)).collect();
    let glossary = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/glossary.md")).unwrap();
    let listed = names::listed(&glossary, "## Names with a meaning of their own in each module");
    assert_eq!(names::of_several_modules(&library), listed, "left: types of src; right: rows of docs/glossary.md");
    // Test the check itself: private types, the same module and `ffi` do not count.
    let file = |part: &str, text: &str| (part.to_string(), text.to_string());
    let all = [
        file("a", "pub struct B;\npub enum C {}\nstruct D;\npub struct E;\npub struct Params;"),
        file("a", "pub trait F {}\npub struct E;"),
        file("b", "pub(super) type B = u8;\npub struct D;\npub struct Params;"),
        file("ffi", "pub struct C;"),
    ];
    assert_eq!(names::of_several_modules(&all), ["B"]);
    assert_eq!(names::listed("## H\n\n| name | m |\n|---|---|\n| B | b |\n\n## I\n| C | c |\n", "## H"), ["B"]);
}

#[test]
fn files_of_a_module_do_not_use_each_other_in_circles() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let relative = |path: PathBuf| path.strip_prefix(&src).unwrap().to_string_lossy().into_owned();
    let sources: Vec<(String, String)> = sources().into_iter().map(|(path, text)| (relative(path), text)).collect();
    let found = circles::circles(&sources);
    assert!(found.is_empty(), "modules that use each other in a circle: {found:?}");
    let found = circles::folder_circles(&sources);
    assert!(found.is_empty(), "folders that use each other in a circle: {found:#?}");
    // Test the check itself: two files that use each other form a circle, and a re-export does not count as a use.
    let file = |name: &str, text: &str| (name.to_string(), text.to_string());
    let all = [
        file("a/mod.rs", "mod b; mod c; pub use b::B; use c::C; /* */"),
        file("a/b.rs", "use super::c::{self, C}; pub struct B { pub(in crate::a) c: C }"),
        file("a/c.rs", "pub struct C; fn f() { super::B; } // super::d::D"),
    ];
    assert_eq!(circles::circles(&all), [["a::b", "a::c"]]);
    assert_eq!(circles::circles(&all[..2]), [[""; 0]; 0]);
    // Two folders whose files use no circle, but that use each other.
    let all = [
        file("a/b/mod.rs", "pub mod d; use super::c::C;"),
        file("a/b/d.rs", "pub struct D;"),
        file("a/c.rs", "use super::b::d::D; pub struct C;"),
    ];
    assert_eq!(circles::circles(&all), [[""; 0]; 0]);
    assert_eq!(circles::folder_circles(&all), [["a::b", "a::c"]]);
}
