//! The header is generated, complete, and true: it equals what cbindgen makes of the sources, compiles as C99 and C++17
//! without a warning, and its structs have the size and the offsets that Rust gives them.
//!
//! `LUXFER_BLESS=1 cargo test --test abi_header` rewrites `include/luxfer.h`.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files of `src/ffi` with exported items, in the order of the header.
const GROUPS: &[&str] = &["version", "status", "context", "image", "job"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|e| panic!("{path}: {e}"))
}

/// The head comment of a source file: title and text.
fn head(source: &str) -> (String, String) {
    let mut lines = source.lines().map_while(|l| l.strip_prefix("//!")).map(str::trim);
    let title = lines.next().expect("a group starts with its title").to_string();
    let text = lines.skip_while(|l| l.is_empty()).fold(String::new(), |text, l| text + " *" + if l.is_empty() { "" } else { " " } + l + "\n");
    (title, text)
}

fn generate() -> String {
    let config = cbindgen::Config::from_file(root().join("cbindgen.toml")).unwrap();
    let mut header = read("include/luxfer.head.h");
    for group in GROUPS {
        let path = format!("src/ffi/{group}.rs");
        let (title, text) = head(&read(&path));
        let rule = "=".repeat(110);
        write!(header, "\n/* {rule}\n * {title}\n *\n{text} * {rule} */\n\n").unwrap();
        if *group == "version" {
            header += &version_macros();
        }
        let bindings = cbindgen::Builder::new().with_config(config.clone()).with_src(root().join(&path)).generate();
        let mut items = Vec::new();
        bindings.unwrap_or_else(|e| panic!("{path}: {e}")).write(&mut items);
        header += String::from_utf8(items).unwrap().trim();
        header += "\n";
    }
    header + "\n#ifdef __cplusplus\n}\n#endif\n\n#endif /* LUXFER_H */\n"
}

fn version_macros() -> String {
    let [major, minor, patch] =
        [env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"), env!("CARGO_PKG_VERSION_PATCH")];
    format!(
        "/** Version of this header. */\n#define LUXFER_VERSION_MAJOR {major}\n#define LUXFER_VERSION_MINOR {minor}\n\
         #define LUXFER_VERSION_PATCH {patch}\n/** The version as one number that can be compared: 10000 * major + 100 * \
         minor + patch. */\n#define LUXFER_VERSION (10000 * LUXFER_VERSION_MAJOR + 100 * LUXFER_VERSION_MINOR + \
         LUXFER_VERSION_PATCH)\n\n"
    )
}
