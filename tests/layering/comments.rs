//! Finds comment lines that are too long.

use std::path::Path;

/// Maximum number of characters of a comment line.
const MAX_CHARACTERS: usize = 120;

/// The folders with hand-written sources, and include with the generated headers.
pub const FOLDERS: [&str; 8] = ["src", "include", "benches", "tests", "examples_c", "bindings", "fuzz", "docs"];

/// The hand-written files beside these folders whose comments are checked.
pub const ROOT_FILES: [&str; 10] = [
    "Cargo.toml",
    "Makefile",
    "CMakeLists.txt",
    "mkdocs.yml",
    ".ci/run",
    "deny.toml",
    "clippy.toml",
    "rustfmt.toml",
    "cbindgen.toml",
    "build.rs",
];

/// Folders of built files and of packages, and generated files.
pub const SKIPPED: [&str; 9] =
    ["node_modules", "target", "static", "build", "out", "corpus", "artifacts", "_abi.py", "types.py"];

/// Returns the numbers of the comment lines of a source file that are too long; none for a file of another kind.
pub fn long_comments(path: &Path, text: &str) -> Vec<usize> {
    let marks: &[&str] = match path.extension().and_then(|e| e.to_str()) {
        Some("rs" | "c" | "h" | "hpp" | "cpp" | "ts" | "js" | "css") => &["//", "/*", "*"],
        Some("py" | "sh" | "mk" | "toml" | "txt" | "in" | "yml") => &["#"],
        None if path.ends_with("Makefile") || path.ends_with(".ci/run") => &["#"],
        _ => return Vec::new(),
    };
    let is_python = path.extension().is_some_and(|e| e == "py");
    // Inside a Python string of several lines: whether it is a docstring, which begins its line.
    let mut string: Option<bool> = None;
    let mut found = Vec::new();
    for (at, line) in text.lines().enumerate() {
        let start = line.trim_start();
        let is_docstring = string.unwrap_or(is_python && start.starts_with("\"\"\""));
        let is_comment = is_docstring || string.is_none() && marks.iter().any(|mark| start.starts_with(mark));
        if is_comment && line.chars().count() > MAX_CHARACTERS {
            found.push(at + 1);
        }
        if is_python && line.matches("\"\"\"").count() % 2 == 1 {
            string = if string.is_some() { None } else { Some(is_docstring) };
        }
    }
    found
}
