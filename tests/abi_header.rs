//! The header is generated and complete: it equals the output of cbindgen, compiles as C99 and C++17 without warnings,
//! its structs have the sizes and offsets of the Rust structs, and its functions are the exported ones.
//!
//! `LUXFER_BLESS=1 cargo test --test abi_header` rewrites `include/luxfer.h` and its parts in
//! `include/luxfer`.

// The header describes the library with all features.
#![cfg(feature = "stylize")]

use luxfer::ffi::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::mem::offset_of;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A header file in `include/luxfer`.
struct Part {
    name: &'static str,
    /// Its content in a few words.
    title: &'static str,
    /// The parts whose types it uses. Of a struct of another part it may only use pointers; see [`with_forward`].
    includes: &'static [&'static str],
    /// The files of `src/ffi` from which it is generated, in order.
    groups: &'static [&'static str],
}

/// The parts of the header, in order; `luxfer.h` includes them all.
const PARTS: &[Part] = &[
    Part {
        name: "core",
        title: "version, status, settings, context, references, images, strokes and jobs",
        includes: &[],
        groups: &[
            "version",
            "status",
            "init",
            "context",
            "references",
            "image",
            "photo",
            "exposures",
            "depth",
            "strokes",
            "job",
            "job_start",
        ],
    },
    Part {
        name: "scene",
        title: "scenes: loading, building, reading and queries",
        includes: &["core"],
        groups: &[
            "scene",
            "scene_load",
            "scene_materials",
            "scene_parts",
            "distribution",
            "scene_lights",
            "query",
            "requirements",
            "scene_read",
            "candidates",
        ],
    },
    Part {
        name: "render",
        title: "rendering, and its layers and images",
        includes: &["scene"],
        groups: &["render", "render_outputs"],
    },
    Part {
        name: "stages",
        title: "the stages of a lighting transfer, one by one",
        includes: &["scene"],
        groups: &[
            "geometry",
            "rectify",
            "features",
            "segment",
            "emission_law",
            "emission",
            "emission_tiles",
            "relight",
        ],
    },
    Part {
        name: "transfer",
        title: "the lighting transfer from end to end, and warnings",
        includes: &["scene"],
        groups: &["pattern", "transfer", "transfer_results", "warning", "warning_create"],
    },
    Part {
        name: "lighting",
        title: "lighting design: illuminance, powers, places and bodies of lamps, photometry",
        includes: &["stages"],
        groups: &[
            "illuminance",
            "lamps",
            "lamps_goals",
            "lamps_results",
            "importance",
            "placement",
            "photometry",
            "glare",
            "gonio",
            "false_colour",
            "daylight",
            "weather",
            "design",
            "pendants",
        ],
    },
    Part {
        name: "stylize",
        title: "stylisation by example",
        includes: &["scene"],
        groups: &["guides", "stylize_params", "stylize", "stylize_results", "sheet"],
    },
    Part {
        name: "plan",
        title: "settings for a given error or time",
        includes: &["transfer", "stages", "render", "stylize"],
        groups: &["plan", "plan_stylize"],
    },
    Part {
        name: "farm",
        title: "renderings in parts, for many machines",
        includes: &["render"],
        groups: &["render_parts"],
    },
    Part {
        name: "demo",
        title: "generated scenes, photos and artworks",
        includes: &["stylize"],
        groups: &["demo", "demo_photo"],
    },
];

/// The part that an author of a lighting-transfer plug-in includes, and the maximum number of functions in it and in
/// the parts that it includes.
const MAX_READ: (&str, usize) = ("transfer", 110);

/// Maximum number of functions in all parts.
const MAX_FUNCTIONS: usize = 230;

/// The macro that marks functions that will go; cbindgen.toml says where it stands.
const DEPRECATED: &str = r"/**
 * Marks a function that will leave the library with a later minor version: compilers warn where a program calls it, and
 * say what to call instead. Without such warnings, define LUXFER_NO_DEPRECATED before the first include.
 */
#if defined(LUXFER_NO_DEPRECATED)
#  define LUXFER_DEPRECATED(advice)
#elif defined(__GNUC__) || defined(__clang__)
#  define LUXFER_DEPRECATED(advice) __attribute__((deprecated(advice)))
#elif defined(_MSC_VER)
#  define LUXFER_DEPRECATED(advice) __declspec(deprecated(advice))
#else
#  define LUXFER_DEPRECATED(advice)
#endif

";

/// Structs that callers pass in arrays. They have no size field, so their layout must never change.
const ELEMENTS: &[&str] =
    &["luxfer_ray", "luxfer_hit", "luxfer_observer", "luxfer_observer_glare", "luxfer_weather_hour"];

#[test]
fn the_headers_are_what_the_sources_say() {
    for (name, generated) in generate() {
        let path = root().join("include").join(&name);
        if std::env::var_os("LUXFER_BLESS").is_some() {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, &generated).unwrap();
        }
        let checked_in = std::fs::read_to_string(&path).unwrap_or_default();
        if let Some((a, b)) = checked_in.lines().zip(generated.lines()).find(|(a, b)| a != b) {
            panic!("{name} says {a:?} where the sources say {b:?}; run with LUXFER_BLESS=1 and review the change");
        }
        assert_eq!(checked_in.len(), generated.len(), "{name} ends early or late; run with LUXFER_BLESS=1");
    }
}

/// Each part of the header compiles alone, and the parts that a plug-in author reads have few enough functions.
#[test]
fn each_part_compiles_alone() {
    for part in PARTS {
        for (compiler, standard, ending) in [("cc", "-std=c99", "c"), ("c++", "-std=c++17", "cpp")] {
            let file = scratch(&format!("part_{}.{ending}", part.name));
            std::fs::write(&file, format!("#include \"luxfer/{}.h\"\nint main(void) {{ return 0; }}\n", part.name))
                .unwrap();
            check_syntax(compiler, standard, &file);
        }
    }
    let read: usize = with_included(MAX_READ.0).iter().map(|name| functions(&part(name)).len()).sum();
    assert!(read <= MAX_READ.1, "{read} functions");
    let all = functions(&header()).len();
    assert!(all <= MAX_FUNCTIONS, "{all} functions");
}

/// The C program in the README compiles, with warnings as errors.
#[test]
fn the_readme_program_compiles() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let program = readme.split("```c\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let file = scratch("readme.c");
    std::fs::write(&file, program).unwrap();
    check_syntax("cc", "-std=c99", &file);
}

#[test]
fn the_header_compiles_as_c99_and_as_cpp17_without_a_warning() {
    let source = "#include \"luxfer.h\"\n#include \"luxfer.h\"\nint main(void) { return (int)(luxfer_get_version() - LUXFER_VERSION); }\n";
    for (compiler, standard, name) in [("cc", "-std=c99", "alone.c"), ("c++", "-std=c++17", "alone.cpp")] {
        let file = scratch(name);
        std::fs::write(&file, source).unwrap();
        check_syntax(compiler, standard, &file);
    }
}

/// Checks a file against the header with a compiler, with warnings as errors.
fn check_syntax(compiler: &str, standard: &str, file: &Path) {
    run(Command::new(compiler)
        .args([standard, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-I"])
        .arg(root().join("include"))
        .arg(file));
}

/// Each struct of settings has its inline `_init` function, and its `LUXFER_STRUCT_` constant is its position in the
/// list.
#[test]
fn every_type_of_luxfer_init_has_its_inline_function() {
    let header = header();
    let settings = settings(&header);
    let inline: Vec<&str> = header.lines().filter_map(|l| l.strip_prefix("static inline luxfer_status ")).collect();
    assert_eq!(inline.len(), settings.len());
    for (number, name) in settings.iter().enumerate() {
        assert!(inline.iter().any(|l| l.starts_with(&format!("{name}_init({name} *"))), "{name}");
        let constant = name.replace("luxfer_", "LUXFER_STRUCT_").to_uppercase();
        assert!(header.contains(&format!("#define {constant} {number}\n")), "{constant} is not {number}");
    }
}

/// A function that Rust calls deprecated is marked in the header, above its declaration, with the same advice.
#[test]
fn a_deprecated_function_is_marked_in_the_header() {
    let source = "/// Does it.\n#[deprecated(note = \"use luxfer_new\")]\n#[unsafe(no_mangle)]\n\
                  pub extern \"C\" fn luxfer_old() -> luxfer_status {}\n";
    let file = scratch("deprecated.rs");
    std::fs::write(&file, source).unwrap();
    let mut config = cbindgen::Config::from_file(root().join("cbindgen.toml")).expect("cbindgen.toml");
    config.header = None;
    let marked = items(&config, &file);
    let expected = "/** Does it. */\nLUXFER_DEPRECATED(\"use luxfer_new\")\nluxfer_status luxfer_old(void);\n";
    assert_eq!(marked, expected);
    assert_eq!(functions(&marked), ["luxfer_old"]);
}

#[test]
fn every_exported_item_is_documented() {
    let header = header();
    let mut previous = "";
    for line in header.lines() {
        let starts_item = line.starts_with("typedef struct") && !line.ends_with(';')
            || line.starts_with("luxfer_status ") && line.contains('(')
            || line.starts_with("#define LUXFER_") && !line.contains("VERSION_") && !line.ends_with("_H")
            || line.starts_with("typedef int32_t");
        assert!(!starts_item || previous.ends_with("*/"), "{line} has no documentation");
        previous = line;
    }
}

#[test]
fn structs_have_the_same_layout_in_c_and_rust() {
    let header = header();
    let structs = structs(&header);
    assert!(structs.len() > 5);

    // Write a C program that prints the offset and the size of each field in the header.
    let mut source = "#include \"luxfer.h\"\n#include <stdio.h>\nint main(void) {\n".to_string();
    for (name, fields) in &structs {
        writeln!(source, "printf(\"{name} = %zu\\n\", sizeof({name}));").unwrap();
        for field in fields {
            writeln!(
                source,
                "printf(\"{name}.{field} = %zu + %zu\\n\", offsetof({name}, {field}), sizeof((({name} *)0)->{field}));"
            )
            .unwrap();
        }
    }
    source += "return 0;\n}\n";
    let (file, program) = (scratch("layout.c"), scratch("layout"));
    std::fs::write(&file, source).unwrap();
    run(Command::new("cc").args(["-std=c99", "-o"]).arg(&program).arg("-I").arg(root().join("include")).arg(&file));
    let seen_by_c = run(&mut Command::new(&program));

    let in_rust = rust_layouts();
    assert_eq!(structs.keys().collect::<Vec<_>>(), in_rust.keys().collect::<Vec<_>>(), "a struct is not in the test");
    let mut seen_by_rust = String::new();
    for (name, (size, fields)) in &in_rust {
        writeln!(seen_by_rust, "{name} = {size}").unwrap();
        for (field, offset, field_size) in fields {
            writeln!(seen_by_rust, "{name}.{field} = {offset} + {field_size}").unwrap();
        }
        // A larger struct size is the only sign of a new field, so no new field may hide in padding at the end.
        let (_, offset, field_size) = fields.last().unwrap();
        assert_eq!(offset + field_size, *size, "{name} has padding at its end");
        let starts_with_size = fields[0] == ("struct_size", 0, 4);
        assert_eq!(starts_with_size, !ELEMENTS.contains(name), "{name} must start with its size, or be fixed for ever");
    }
    assert_eq!(seen_by_c, seen_by_rust);
}

#[test]
#[cfg(target_os = "linux")]
fn the_library_exports_the_header_and_nothing_else_under_its_soname() {
    let library = library();
    let symbols = run(Command::new("nm").args(["-D", "--defined-only", "--format=posix"]).arg(&library));
    let mut exported: Vec<&str> = symbols.lines().map(|l| l.split(' ').next().unwrap()).collect();
    exported.sort_unstable();
    let header = header();
    let mut declared = functions(&header);
    declared.sort_unstable();
    assert_eq!(exported, declared);

    let dynamic = run(Command::new("readelf").arg("-d").arg(&library));
    let soname = format!("[libluxfer.so.{}.{}]", env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"));
    let line = dynamic.lines().find(|l| l.contains("(SONAME)")).expect("the library has no SONAME");
    assert!(line.ends_with(&soname), "{line}");
}

#[test]
fn the_version_is_cargos() {
    let [major, minor, patch] = version().map(|v| v.parse::<u32>().unwrap());
    assert_eq!(luxfer_get_version(), 10_000 * major + 100 * minor + patch);
    // SAFETY: a static string.
    let text = unsafe { std::ffi::CStr::from_ptr(luxfer_get_version_string()) };
    assert_eq!(text.to_str().unwrap(), env!("CARGO_PKG_VERSION"));
    let header = header();
    for (name, value) in [("MAJOR", major), ("MINOR", minor), ("PATCH", patch)] {
        assert!(header.contains(&format!("#define LUXFER_VERSION_{name} {value}\n")), "{name}");
    }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Reads the text of a header part.
fn part(name: &str) -> String {
    std::fs::read_to_string(root().join(format!("include/luxfer/{name}.h"))).expect(name)
}

/// Reads and joins the texts of all header parts.
fn header() -> String {
    PARTS.iter().map(|p| part(p.name)).collect()
}

/// Path of a temporary file outside the source tree, beside the test programs.
fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// The shared library that cargo built with this test.
fn library() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    test.parent().unwrap().join("libluxfer.so")
}

fn version() -> [&'static str; 3] {
    [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")]
}

/// Runs a program that must succeed; returns its output.
fn run(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}"));
    assert!(output.status.success(), "{command:?}:\n{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Generates the umbrella header and its parts; returns their paths below `include` and their texts.
fn generate() -> Vec<(String, String)> {
    let mut config = cbindgen::Config::from_file(root().join("cbindgen.toml")).expect("cbindgen.toml");
    let umbrella = config.header.take().unwrap();
    let includes: String = PARTS.iter().map(|p| format!("#include \"luxfer/{}.h\"\n", p.name)).collect();
    let settings = settings(&section(&config, "init"));
    // Name the structs of settings: cbindgen leaves out structs that no function of their own file takes.
    config.export.include.clone_from(&settings);
    let mut files = vec![("luxfer.h".to_string(), guarded(umbrella.trim_start(), "LUXFER_H", &includes))];
    let sections = |part: &Part| {
        part.groups.iter().map(|g| with_initialisers(&section(&config, g), &settings)).collect::<String>()
    };
    let texts: Vec<(&str, String)> = PARTS.iter().map(|part| (part.name, sections(part))).collect();
    for (part, (_, text)) in PARTS.iter().zip(&texts) {
        let head = format!(
            "/* luxfer: {}.\n *\n * tests/abi_header.rs generates this file from src/ffi.\n *\n \
             * SPDX-License-Identifier: MIT OR Apache-2.0\n */\n",
            part.title
        );
        let mut body: String = match part.includes {
            [] => "#include <stddef.h>\n#include <stdint.h>\n".into(),
            others => others.iter().map(|other| format!("#include \"{other}.h\"\n")).collect(),
        };
        body += "\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n";
        body += &with_forward(part, text, &texts);
        body += "\n#ifdef __cplusplus\n}\n#endif\n";
        let guard = format!("LUXFER_{}_H", part.name.to_uppercase());
        files.push((format!("luxfer/{}.h", part.name), guarded(&head, &guard, &body)));
    }
    files
}

/// The names of a part and of all parts that it includes, also indirectly.
fn with_included(name: &str) -> BTreeSet<&'static str> {
    let part = PARTS.iter().find(|part| part.name == name).expect(name);
    let mut names: BTreeSet<&str> = part.includes.iter().flat_map(|name| with_included(name)).collect();
    names.insert(part.name);
    names
}

/// Declares the structs of parts that a part does not include, of which it uses only pointers. A `typedef` must not be
/// repeated in C99, so `text` names these structs with `struct`.
fn with_forward(part: &Part, text: &str, texts: &[(&str, String)]) -> String {
    let included = with_included(part.name);
    let others = texts.iter().filter(|(name, _)| !included.contains(name));
    let foreign: BTreeSet<&str> = others
        .flat_map(|(_, text)| text.lines().filter_map(|l| l.strip_prefix("typedef struct ")?.split([' ', ';']).next()))
        .collect();
    let (mut used, mut out) = (BTreeSet::new(), String::new());
    let is_separator = |c: char| !c.is_alphanumeric() && c != '_';
    for line in text.lines() {
        let is_comment = line.trim_start().starts_with(['*', '/']);
        // Each piece is a word with the separator behind it.
        for piece in line.split_inclusive(is_separator) {
            if let Some(name) = foreign.get(piece.trim_end_matches(is_separator)).filter(|_| !is_comment) {
                used.insert(*name);
                out += "struct ";
            }
            out += piece;
        }
        out += "\n";
    }
    if used.is_empty() {
        return out;
    }
    let declared: String = used.iter().map(|name| format!("struct {name};\n")).collect();
    format!("\n/* Structs of parts that this part does not include. */\n{declared}{out}")
}

fn guarded(head: &str, guard: &str, body: &str) -> String {
    format!("{head}#ifndef {guard}\n#define {guard}\n\n{body}\n#endif /* {guard} */\n")
}

/// Generates the section of the header for the file `group` of `src/ffi`: its head comment, then its items.
fn section(config: &cbindgen::Config, group: &str) -> String {
    let path = root().join(format!("src/ffi/{group}.rs"));
    let mut out = banner(&std::fs::read_to_string(&path).unwrap());
    if group == "version" {
        out += &version_macros();
        out += DEPRECATED;
    }
    out + &items(config, &path)
}

/// Generates the items of a header from a file.
fn items(config: &cbindgen::Config, path: &Path) -> String {
    let bindings = cbindgen::Builder::new().with_config(config.clone()).with_src(path).generate();
    let mut items = Vec::new();
    bindings.unwrap_or_else(|e| panic!("{}: {e}", path.display())).write(&mut items);
    // With the style "both", structs have a tag for forward declarations; elsewhere, use the typedef without `struct`.
    let items = String::from_utf8(items)
        .unwrap()
        .replace("struct luxfer_", "luxfer_")
        .replace("typedef luxfer_", "typedef struct luxfer_");
    own_lines(&one_line_comments(items.trim()))
}

/// Puts each mark `LUXFER_DEPRECATED("...")` on a line of its own, so that a declaration starts with its type.
fn own_lines(text: &str) -> String {
    let mut out = String::new();
    for line in text.lines() {
        match line.split_once("\") ").filter(|_| line.starts_with("LUXFER_DEPRECATED(")) {
            Some((mark, declaration)) => writeln!(out, "{mark}\")\n{declaration}").unwrap(),
            None => writeln!(out, "{line}").unwrap(),
        }
    }
    out
}

/// Names of the structs that `luxfer_init` fills, derived from the `LUXFER_STRUCT_` constants of the section.
fn settings(section: &str) -> Vec<String> {
    let constants = section.lines().filter_map(|l| l.strip_prefix("#define LUXFER_STRUCT_"));
    constants.map(|l| format!("luxfer_{}", l.split(' ').next().unwrap().to_lowercase())).collect()
}

/// Adds an inline function after each struct of settings. It fills the struct as `luxfer_init` does, but its parameter
/// has the struct's type, so the compiler checks the argument.
fn with_initialisers(section: &str, settings: &[String]) -> String {
    let mut out = String::new();
    for line in section.lines() {
        writeln!(out, "{line}").unwrap();
        let ended = line.strip_prefix("} ").and_then(|l| l.strip_suffix(';'));
        let Some(name) = ended.filter(|name| settings.iter().any(|s| s == name)) else { continue };
        let constant = name.replace("luxfer_", "LUXFER_STRUCT_").to_uppercase();
        writeln!(
            out,
            "\n/** Fills *place with the defaults, as luxfer_init does; size is sizeof *place. */\n\
             static inline luxfer_status {name}_init({name} *place, size_t size) {{\n    \
             return luxfer_init({constant}, place, size);\n}}"
        )
        .unwrap();
    }
    out
}

/// Joins each comment that fits on one line into one line.
fn one_line_comments(text: &str) -> String {
    let mut lines = text.lines();
    let mut out = String::new();
    while let Some(line) = lines.next() {
        if line.trim() != "/**" {
            writeln!(out, "{line}").unwrap();
            continue;
        }
        let mut comment = vec![line];
        comment.extend(lines.by_ref().take_while(|l| l.trim() != "*/"));
        let first = comment.get(1).map_or("", |l| l.trim().trim_start_matches("* "));
        if comment.len() == 2 && line.len() + first.len() + 4 <= 120 {
            writeln!(out, "{line} {first} */").unwrap();
        } else {
            comment.iter().for_each(|l| writeln!(out, "{l}").unwrap());
            writeln!(out, "{} */", line.trim_end_matches("/**")).unwrap();
        }
    }
    out
}

/// Turns the head comment (`//!`) of a source file into a section heading of the header.
fn banner(source: &str) -> String {
    let rule = "=".repeat(114);
    let lines = source.lines().map_while(|l| l.strip_prefix("//!"));
    let text: String = lines.map(|l| format!(" *{l}\n")).collect();
    format!("\n/* {rule}\n{text} * {rule} */\n\n")
}

fn version_macros() -> String {
    let [major, minor, patch] = version();
    format!(
        "/** The version of this header. */\n#define LUXFER_VERSION_MAJOR {major}\n#define LUXFER_VERSION_MINOR {minor}\n\
         #define LUXFER_VERSION_PATCH {patch}\n\n/** The version of this header as one number, comparable with \
         luxfer_get_version(). */\n#define LUXFER_VERSION (10000 * LUXFER_VERSION_MAJOR + 100 * LUXFER_VERSION_MINOR + \
         LUXFER_VERSION_PATCH)\n\n"
    )
}

/// Names of the functions that a header declares.
fn functions(header: &str) -> Vec<&str> {
    let declarations = header.lines().filter(|l| !l.starts_with([' ', '#', '/']) && !l.starts_with("typedef"));
    let declarations = declarations.filter(|l| !l.starts_with("static inline "));
    let names =
        declarations.filter_map(|l| l.split_once('(')).filter_map(|(before, _)| before.rsplit([' ', '*']).next());
    names.filter(|n| n.starts_with("luxfer_")).collect()
}

/// Names of the fields of each struct that a header defines.
fn structs(header: &str) -> BTreeMap<&str, Vec<&str>> {
    let mut found = BTreeMap::new();
    let mut current = None;
    for line in header.lines() {
        if let Some(name) = line.strip_prefix("typedef struct ").and_then(|l| l.strip_suffix(" {")) {
            current = Some(found.entry(name).or_insert_with(Vec::new));
        } else if line.starts_with('}') {
            current = None;
        } else if line.trim_start().starts_with(['*', '/']) {
            // Skip comments, whose lines may end with a semicolon too.
        } else if let (Some(fields), Some(declaration)) = (&mut current, line.strip_suffix(';')) {
            let name = declaration.split('[').next().unwrap();
            fields.push(name.rsplit([' ', '*']).next().unwrap());
        }
    }
    found
}

type Fields = Vec<(&'static str, usize, usize)>;

macro_rules! layouts {
    ($($type:ident: $($field:ident)*;)*) => {
        /// For each struct its size, and the offsets and sizes of its fields, as Rust lays them out.
        fn rust_layouts() -> BTreeMap<&'static str, (usize, Fields)> {
            BTreeMap::from([$((stringify!($type), {
                fn size<T>(_: fn(&$type) -> &T) -> usize {
                    size_of::<T>()
                }
                (size_of::<$type>(), vec![$((stringify!($field), offset_of!($type, $field), size(|s| &s.$field))),*])
            })),*])
        }
    };
}

layouts! {
    luxfer_context_params: struct_size num_threads memory_budget_mib;
    luxfer_image_view: struct_size channels sample colour_space width height flags reserved pixel_stride row_stride
        byte_size data;
    luxfer_photo_metadata: struct_size orientation focal focal_error f_number exposure_time iso white_luminance
        white_luminance_low white_luminance_high colour reserved;
    luxfer_scene_counts: struct_size meshes materials textures lights cameras triangles;
    luxfer_surface: struct_size reserved triangles origin u_axis v_axis normal size area sloped_area;
    luxfer_scene_load_params: struct_size allow_external_files unit keep_origin luminaire_shape;
    luxfer_material_params: struct_size double_sided name base_color metallic roughness emission transmission ior
        alpha alpha_mode alpha_cutoff normal_scale thickness attenuation_color attenuation_distance reserved;
    luxfer_mesh_params: struct_size material name vertex_count positions position_stride normals normal_stride uvs
        uv_stride triangle_count indices index_stride colours
        colour_stride;
    luxfer_camera_params: struct_size fov_y position target up reserved;
    luxfer_ray: origin direction t_max;
    luxfer_hit: t mesh triangle u v;
    luxfer_observer: position direction;
    luxfer_observer_glare: ugr background background_error unrated_lux solid_angle sources outside_range;
    luxfer_mesh_info: struct_size material vertex_count triangle_count has_normals uv_sets has_colours reserved;
    luxfer_texture_use: struct_size texture uv_set wrap_u wrap_v transform;
    luxfer_demo_photo_params: struct_size width height samples seed;
    luxfer_light_params: struct_size kind position direction intensity inner_angle outer_angle reserved
        angular_diameter;
    luxfer_luminaire_params: struct_size shape flux position axis c0 colour;
    luxfer_features_params: struct_size near_plane far_plane normal_radius;
    luxfer_features_report: struct_size depth_source depth_confidence replaced_pixels;
    luxfer_segment_params: struct_size samples_per_class channels refine_radius ridge seed refine_tolerance subject reserved;
    luxfer_segment_report: struct_size channels error negative_samples positive_samples contradictory_pixels;
    luxfer_rectify_params: struct_size detector search metric hough_band focal principal plane_axes max_side reserved
        max_magnification seed distortion;
    luxfer_rectify_report: struct_size segments vanishing_points vanishing_errors vanishing_support focal_source
        focal principal axes is_unwarped reserved to_photo corners corner_errors pixel_size aspect_confidence
        distortion distortion_error squareness squareness_errors undone;
    luxfer_emission_params: struct_size width height block scale working_side guide_weight seed min_regularity
        whole_lamps offset clip_level even_lamps tileable centred candidates reserved law clean_lamps max_magnification;
    luxfer_emission_report: struct_size luminaires error regularity exemplar_lamps sampling_error law runner_up
        law_score margin;
    luxfer_luminaire: struct_size corners centre size orientation area flux_share colour kind;
    luxfer_requirements: struct_size scattering lights textures bounces brightest_material albedo
        flat_triangles;
    luxfer_render_params: struct_size width height samples target_error time_budget_ms seed pixel_error reserved
        preview relative_error;
    luxfer_render_report: struct_size samples error discarded preview_bias relative_error preview_error;
    luxfer_render_part: struct_size x y width height first_sample samples;
    luxfer_illuminance_params: struct_size columns rows samples seed;
    luxfer_illuminance_grid: struct_size origin across down normal reserved;
    luxfer_illuminance_report: struct_size points minimum mean maximum mean_error;
    luxfer_relight_params: struct_size quantity paths target_error time_budget_ms fit seed;
    luxfer_relight_report: struct_size paths scale half_width response background outcome reserved error delta_e;
    luxfer_lamps_params: struct_size group row_tolerance free_colour max_scale regularisation tolerance paths target_error
        time_budget_ms reserved seed;
    luxfer_lamps_report: struct_size lamps groups goals paths all_goals_satisfied;
    luxfer_lamp: struct_size group centre scale half_width;
    luxfer_lamps_goal: struct_size outcome target achieved half_width background target_lux achieved_lux half_width_lux
        background_lux;
    luxfer_lamps_response: struct_size reserved mean half_width;
    luxfer_importance_params: struct_size width height quantity paths target_error time_budget_ms reserved seed;
    luxfer_importance_report: struct_size paths response half_width resolution_difference;
    luxfer_placement_params: struct_size aim radiance starts min_offset max_offset min_scale max_scale
        min_rotation max_rotation seed;
    luxfer_placement: struct_size reserved placement offset scale rotation response half_width resolution_difference;
    luxfer_pendants_params: struct_size alike level refine known reserved known_length ceiling suspension_error focal
        focal_error axes_error principal axes;
    luxfer_pendant: struct_size profile_count kind doubts probability aspect diameter height drop centre residual cut
        clipped profile profile_error radiance contour reserved;
    luxfer_gonio_params: struct_size planes angles samples seed axis c0;
    luxfer_gonio_report: struct_size position flux flux_error intensity_error;
    luxfer_glare_params: struct_size projection fov_y threshold vertical_illuminance;
    luxfer_glare_report: struct_size sources ugr background threshold solid_angle unseen_lights reserved dgp
        vertical_illuminance dgp_low_light;
    luxfer_sun_params: struct_size year month day hour latitude longitude;
    luxfer_sun_position: struct_size reserved altitude azimuth distance;
    luxfer_sky_params: struct_size model cie_type unit sun_altitude sun_azimuth sun_distance direct_normal
        diffuse_horizontal zenith_luminance dew_point ground_reflectance sky_kelvin sun_kelvin north rows;
    luxfer_sky_report: struct_size sun direct_normal diffuse_horizontal zenith_luminance ground_luminance clearness
        brightness;
    luxfer_weather_report: struct_size hours latitude longitude time_zone elevation;
    luxfer_weather_hour: year month day reserved hour dew_point direct_normal diffuse_horizontal
        direct_normal_illuminance diffuse_horizontal_illuminance;
    luxfer_false_colour_params: struct_size scale unit bar minimum maximum;
    luxfer_mixture: struct_size in_gamut colour delta_e;
    luxfer_temperature_fit: struct_size reserved kelvin luminance achieved delta_e;
    luxfer_preset: struct_size edition illuminance glare uniformity rendering walls ceiling name;
    luxfer_distribution_report: struct_size planes angles reserved flux lamp_flux watts size temperature rendering
        variants emitters;
    luxfer_transfer_params: struct_size max_texels plane_distance white_luminance target rectify features plane lights
        emission relight render pattern;
    luxfer_pattern_params: struct_size scale length texel_size rotation offset margin;
    luxfer_transfer_report: struct_size fixtures seconds view_error depth_confidence plane_error lights_error
        unwarp_error emission_error relight_error render_error texel_size target reserved plane_distance plane_distance_error proposed_white
        proposed_white_low proposed_white_high preview_error;
    luxfer_candidate: struct_size kind index area level_area height low high normal score triangles name reason;
    luxfer_warning: struct_size code stage has_place severity limit place message advice;
    luxfer_plan_params: struct_size time_budget_ms target_error reserved;
    luxfer_plan_report: struct_size relights seconds error relight_seconds relight_error render_seconds render_error;
    luxfer_merge_params: struct_size source reference keep_moving max_shift saturation exposures tone_curve reserved;
    luxfer_merge_report: struct_size count reference reserved clipped moved exposures errors stated shift_x shift_y
        tone_curve contradicts_srgb tone_curve_error tone_curve_light;
    luxfer_sheet_params: struct_size even_light paper_width paper_height dpi margin contrast;
    luxfer_sheet_report: struct_size marks residual error to_photo bend dots reserved;
    luxfer_guides_params: struct_size width height samples camera smooth seed;
    luxfer_stylize_params: struct_size search patch guide_weight coarse_guides levels iterations coarse_iterations
        finest_iterations polish search_iterations coverage passes settle seam vote final_vote preview keep_for_update
        coherence match_appearance reserved seed;
    luxfer_stylize_report: struct_size is_complete levels halvings patch max_uses energy used entropy guide_error
        broken_source broken_target unblended_share normals_weight;
    luxfer_fixture: struct_size position normal axis radiance kind size area flux cct duv;
}
