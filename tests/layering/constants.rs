//! Finds the float constants of a source file, and the tags in their comments that state their origin.

/// The documented tags (docs/glossary.md, "Tags of constants") up to their variable parts.
const TAGS: [&str; 5] = ["[paper", "[bench", "[rounding]", "[convention", "[judged on "];

/// Vectors and matrices of floats.
const VECTORS: [&str; 14] = [
    "Vec2", "Vec3", "Vec3A", "Vec4", "DVec2", "DVec3", "DVec4", "Mat2", "Mat3", "Mat4", "DMat2", "DMat3", "DMat4",
    "Quat",
];

/// The constants of a file that somebody judged by eye, and those with a wrong tag.
#[derive(Default, Debug, PartialEq)]
pub struct Origins {
    /// Comments with a tag `[judged on N photos]` or `[judged on N scenes]`.
    pub judged: usize,
    /// Lines of the constants without a tag, and tags that do not state how many photos or scenes were judged.
    pub wrong: Vec<String>,
}

/// Reads the part of a file before its unit tests. Vectors, arrays and tuples count `with_vectors`; arrays that begin
/// with a float always count.
pub fn origins(code: &str, with_vectors: bool) -> Origins {
    let lines: Vec<&str> = code.lines().collect();
    let comments: Vec<&str> = lines.iter().filter_map(|l| l.trim().strip_prefix("//")).collect();
    let comments = comments.iter().map(|l| l.trim_start_matches('/').trim()).collect::<Vec<_>>().join(" ");
    let judged: Vec<&str> = comments.match_indices("[judged on ").map(|(at, _)| &comments[at..]).collect();
    let mut found = Origins {
        judged: judged.len(),
        wrong: judged.iter().filter(|t| !counts_photos(t)).map(|t| t.chars().take(30).collect()).collect(),
    };
    for (at, line) in lines.iter().enumerate() {
        let Some((_, kind)) = constant(line) else { continue };
        let plain = kind.trim_start_matches(['[', '(']);
        let is_float = plain.starts_with("f32") || plain.starts_with("f64") || with_vectors && has_float(kind);
        let comment = comment_above(&lines, at);
        if is_float && !TAGS.iter().any(|tag| comment.contains(tag)) {
            found.wrong.push(format!("no tag on line {}: {}", at + 1, line.trim()));
        }
    }
    found
}

/// Whether a tag that begins with `[judged on ` goes on with a number of photos or scenes.
fn counts_photos(tag: &str) -> bool {
    let rest = tag.trim_start_matches("[judged on ");
    let kind = rest.trim_start_matches(|c: char| c.is_ascii_digit());
    kind.len() < rest.len() && [" photos]", " photo]", " scenes]", " scene]"].iter().any(|end| kind.starts_with(end))
}

/// Name and type of the constant that a line defines, with any visibility.
fn constant(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_start();
    let line = match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
        Some(rest) => rest.trim_start(),
        None => line,
    };
    let (name, kind) = line.strip_prefix("const ")?.split_once(": ")?;
    let is_name = name.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
    is_name.then_some((name, kind.split(" = ").next().unwrap_or(kind)))
}

/// Whether a type names a float, a vector or a matrix of floats.
fn has_float(kind: &str) -> bool {
    let mut words = kind.split(|c: char| !c.is_ascii_alphanumeric());
    words.any(|word| word == "f32" || word == "f64" || VECTORS.contains(&word))
}

/// The comment above a line, also if other constants stand in between: neighbouring constants share one comment.
fn comment_above(lines: &[&str], at: usize) -> String {
    let above = lines[..at].iter().rev().skip_while(|l| constant(l).is_some()).map(|l| l.trim());
    let comment: Vec<&str> =
        above.take_while(|l| l.starts_with("//")).map(|l| l.trim_start_matches(['/', ' '])).collect();
    comment.into_iter().rev().collect::<Vec<_>>().join(" ")
}
