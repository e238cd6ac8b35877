//! Reads and writes the XML of luminaire files. The parser is `roxmltree`. This module limits the parser's input, so
//! that a hostile file can demand neither much memory nor much time, and reports errors with their line.
//!
//! Elements are found by their local names: files of different tools declare different namespaces.

use super::text_lines::within;
use crate::error::{Error, Result};
use roxmltree::{Document, Node, ParsingOptions};
use std::fmt::Write;

/// Maximum size of a file in bytes (`MAX_BYTES`), and maximum number of its nodes: elements, texts and comments
/// (`MAX_NODES`). A distribution with an intensity every half degree reaches a third of each limit. [convention]
pub const MAX_BYTES: usize = 32 << 20;
const MAX_NODES: u32 = 1 << 21;
/// Maximum number of attributes of an element (`MAX_ATTRIBUTES`), and maximum number of namespace declarations in a
/// file (`MAX_NAMESPACES`). [convention]
const MAX_ATTRIBUTES: usize = 64;
const MAX_NAMESPACES: usize = 256;

/// Decodes the bytes of a file to text: UTF-8, UTF-16 with a byte order mark, or Latin-1.
///
/// # Errors
/// `Format` if the file is too large or is damaged UTF-16.
pub fn decode(bytes: &[u8]) -> Result<String> {
    if bytes.len() > MAX_BYTES {
        return Err(Error::format(format!("the XML has {} bytes; at most {MAX_BYTES} are read", bytes.len())));
    }
    let wide = |unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes[2..].chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        String::from_utf16(&units).map_err(|_| Error::format("the XML is damaged UTF-16"))
    };
    match bytes {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        _ => Ok(match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}').into(),
            Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
        }),
    }
}

/// Parses a file.
///
/// # Errors
/// `Format`, with the line, if the file is malformed, has a document type (which could define entities), or exceeds
/// a limit of this module.
pub fn parse(text: &str) -> Result<Document<'_>> {
    check_tags(text)?;
    if text.matches("xmlns").nth(MAX_NAMESPACES).is_some() {
        return Err(Error::format(format!("the XML declares more than {MAX_NAMESPACES} namespaces")));
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|e| match e {
        roxmltree::Error::NodesLimitReached => {
            Error::format(format!("the XML has more than {MAX_NODES} elements and texts"))
        }
        e => Error::format(format!("line {}: {e}", e.pos().row)),
    })
}

/// Returns an error if an element has too many attributes. The parser compares each attribute of an element with all
/// others, which would take long.
fn check_tags(text: &str) -> Result<()> {
    let mut rest = text;
    while let Some(start) = rest.find('<') {
        rest = &rest[start..];
        let comments = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((begin, end)) = comments.iter().find(|(begin, _)| rest.starts_with(begin)) {
            // Search for the end only behind the beginning, so that they do not overlap: `<!-->` begins a comment and
            // does not end it.
            rest = rest[begin.len()..].split_once(end).map_or("", |(_, after)| after);
            continue;
        }
        let (mut quote, mut attributes, mut length) = (None, 0, rest.len());
        for (at, byte) in rest.bytes().enumerate() {
            match (quote, byte) {
                (Some(open), byte) if byte == open => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => attributes += 1,
                (None, b'>') => {
                    length = at;
                    break;
                }
                _ => {}
            }
        }
        if attributes > MAX_ATTRIBUTES {
            let line = text[..text.len() - rest.len()].matches('\n').count() + 1;
            let message =
                format!("line {line}: an element has {attributes} attributes; at most {MAX_ATTRIBUTES} are read");
            return Err(Error::format(message));
        }
        rest = &rest[length..];
    }
    Ok(())
}

/// An element of a parsed file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<'a>(Node<'a, 'a>);

impl<'a> Element<'a> {
    pub fn root(document: &'a Document<'a>) -> Self {
        Self(document.root_element())
    }

    pub fn name(self) -> &'a str {
        self.0.tag_name().name()
    }

    pub fn children(self) -> impl Iterator<Item = Self> {
        self.0.children().filter(Node::is_element).map(Self)
    }

    /// Iterates over the child elements with the local name `name`.
    pub fn all<'n>(self, name: &'n str) -> impl Iterator<Item = Self> + use<'a, 'n> {
        self.0.children().filter(move |child| child.is_element() && child.tag_name().name() == name).map(Self)
    }

    /// Returns the element at a path of local names, separated by slashes. Each name stands for the first child of this
    /// name; `None` if a child is missing.
    pub fn find(self, path: &str) -> Option<Self> {
        path.split('/').try_fold(self, |element, name| element.all(name).next())
    }

    /// The element's first text that is not blank, trimmed; empty if there is no such text. Comments may precede it.
    pub fn text(self) -> &'a str {
        let texts = self.0.children().filter(Node::is_text).filter_map(|child| child.text());
        texts.map(str::trim).find(|text| !text.is_empty()).unwrap_or("")
    }

    /// The element's text on one line: each run of blanks and line breaks becomes one blank.
    pub fn line_of_text(self) -> String {
        self.text().split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// The trimmed text of the element at a path; empty if the element is missing or has no text.
    pub fn text_at(self, path: &str) -> &'a str {
        self.find(path).map_or("", Self::text)
    }

    pub fn attribute(self, name: &str) -> Option<&'a str> {
        self.0.attributes().find(|a| a.name() == name).map(|a| a.value().trim())
    }

    /// Parses the element's text as a number in `[low, high]`.
    pub fn number(self, low: f64, high: f64) -> Result<f64> {
        self.parsed(self.text(), self.name(), low, high)
    }

    /// Parses `word`, which stands in this element, as a number in `[low, high]`. `what` names the number in errors.
    fn parsed(self, word: &str, what: &str, low: f64, high: f64) -> Result<f64> {
        match word.replace(',', ".").parse() {
            Ok(value) if value >= low && value <= high => Ok(value),
            // Find the line only for an error message, because finding it takes a pass over the whole file.
            _ => within(self.line(), word, what, low, high),
        }
    }

    /// Parses the number at a path; `None` if the element is missing or empty.
    pub fn number_at(self, path: &str, low: f64, high: f64) -> Result<Option<f64>> {
        self.find(path).filter(|found| !found.text().is_empty()).map(|found| found.number(low, high)).transpose()
    }

    /// Parses an attribute as a number in `[low, high]`; `None` if it is missing.
    pub fn number_of(self, name: &str, low: f64, high: f64) -> Result<Option<f64>> {
        self.attribute(name).map(|word| self.parsed(word, name, low, high)).transpose()
    }

    /// The line on which the element begins, from 1. Finding it takes a pass over the whole file.
    pub fn line(self) -> usize {
        self.0.document().text_pos_at(self.0.range().start).row as usize
    }

    /// Returns a `Format` error that names the line of the element.
    pub fn error(self, message: impl std::fmt::Display) -> Error {
        Error::format(format!("line {}: {message}", self.line()))
    }
}

/// Escapes a text for the content of an element or for an attribute. Characters that XML does not allow become blanks.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => out.push(' '),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Writes XML elements, indented by two blanks per level of nesting.
pub struct Writer {
    text: String,
    open: Vec<&'static str>,
}

impl Writer {
    pub fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".into(), open: Vec::new() }
    }

    fn indent(&mut self) {
        self.text.extend(std::iter::repeat_n("  ", self.open.len()));
    }

    /// Begins an element; `attributes` is empty or begins with a blank.
    pub fn begin(&mut self, name: &'static str, attributes: &str) {
        self.indent();
        let _ = writeln!(self.text, "<{name}{attributes}>");
        self.open.push(name);
    }

    /// Ends the innermost element.
    pub fn end(&mut self) {
        if let Some(name) = self.open.pop() {
            self.indent();
            let _ = writeln!(self.text, "</{name}>");
        }
    }

    /// Writes an element with a text, which is escaped; `attributes` is empty or begins with a blank.
    pub fn leaf(&mut self, name: &str, attributes: &str, text: impl std::fmt::Display) {
        self.indent();
        let text = escape(&text.to_string());
        let _ = if text.is_empty() {
            writeln!(self.text, "<{name}{attributes}/>")
        } else {
            writeln!(self.text, "<{name}{attributes}>{text}</{name}>")
        };
    }

    /// Ends all elements and returns the file.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.end();
        }
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Instant;

    /// A valid number with a decimal comma is parsed without the search for its line, which takes a pass over the file.
    /// With that search, the 150 000 numbers of this file of 2.5 MB would take minutes.
    #[test]
    fn numbers_take_no_pass_over_the_file() {
        let text = format!("<a>{}</a>", "<b c='1,5' d='0.25'>\n2,5</b>\n".repeat(75_000));
        let document = parse(&text).unwrap();
        let began = Instant::now();
        let mut sum = 0.0;
        for element in Element::root(&document).children() {
            sum += element.number(0.0, 3.0).unwrap() + element.number_of("c", 0.0, 3.0).unwrap().unwrap();
        }
        assert_eq!(sum, 300_000.0);
        assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
        let first = Element::root(&document).children().nth(1).unwrap();
        assert!(first.number(0.0, 2.0).unwrap_err().message.contains("line 3: b is 2.5; it must lie in [0, 2]"));
        assert!(first.number_of("c", 2.0, 3.0).unwrap_err().message.contains("line 3: c is 1.5"));
    }

    #[test]
    fn comments_may_stand_before_a_text() {
        for (text, want) in [
            ("<a><!-- c -->7</a>", "7"),
            ("<a>\n<!-- c -->\n 7 <b/>8</a>", "7"),
            ("<a><b>7</b></a>", ""),
            ("<a><![CDATA[7]]></a>", "7"),
            ("<a/>", ""),
        ] {
            assert_eq!(Element::root(&parse(text).unwrap()).text(), want, "{text}");
        }
    }

    /// `<!-->` begins a comment and does not end it. The limit on attributes must therefore hold for the element after
    /// the comment's true end.
    #[test]
    fn comments_hide_no_attributes() {
        let flood: String = (0..1000).map(|i| format!(" a{i}=''")).collect();
        for text in [
            format!("<IESTM33><!--> <![CDATA[ --><b{flood}/><![CDATA[x]]></IESTM33>"),
            format!("<IESTM33><?a?><b{flood}/></IESTM33>"),
            format!("<IESTM33><!----><b{flood}/></IESTM33>"),
        ] {
            assert!(parse(&text).unwrap_err().message.contains("1000 attributes"));
        }
        parse(&format!("<a><!--> <b{flood}/> --><![CDATA[<b{flood}/>]]></a>")).unwrap();
    }
}
