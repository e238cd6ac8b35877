//! Parses the text of a light path expression into a tree of event patterns. The tree is in camera-first order,
//! whatever the order of the text.

use crate::error::{Error, Result};

/// Largest number of characters in an expression, of nested parentheses, and of repetitions in braces. [convention]
const MAX_CHARACTERS: usize = 2048;
const MAX_DEPTH: usize = 32;
const MAX_REPEATS: u32 = 64;

/// Bits of the types of an event.
pub mod kind {
    pub const REFLECT: u8 = 1;
    pub const TRANSMIT: u8 = 2;
    pub const VOLUME: u8 = 4;
    pub const CAMERA: u8 = 8;
    pub const LIGHT: u8 = 16;
    pub const OBJECT: u8 = 32;
    pub const BACKGROUND: u8 = 64;
    pub const SCATTER: u8 = REFLECT | TRANSMIT | VOLUME;
}

/// Bits of the scattering modes of an event; lights and the camera have none.
pub mod mode {
    pub const DIFFUSE: u8 = 1;
    pub const GLOSSY: u8 = 2;
    pub const SINGULAR: u8 = 4;
    pub const STRAIGHT: u8 = 8;
}

/// An event of a light path. It may have several types or modes: a lamp may be both `L` and `O`.
#[derive(Clone, Debug)]
pub struct Event {
    pub kinds: u8,
    pub modes: u8,
    pub labels: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum SyntaxTree {
    Event(EventSet),
    Sequence(Vec<SyntaxTree>),
    Either(Vec<SyntaxTree>),
    /// The node, with the smallest and the largest number of its repetitions; `None` for no upper limit.
    Repeat(Box<SyntaxTree>, u32, Option<u32>),
}

/// The set of events that match at least one of the patterns, or, if negated, none of them.
#[derive(Clone, Debug, PartialEq)]
pub struct EventSet {
    pub patterns: Vec<Pattern>,
    pub negated: bool,
}

/// The pattern `<type mode labels>`. An event matches the pattern if it matches all parts of the pattern.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    kinds: Bits,
    modes: Bits,
    labels: Vec<Labels>,
}

/// Matches events that have any of these bits, or, if negated, none of them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bits {
    bits: u8,
    negated: bool,
}

/// Matches events that have any of these labels, or, if negated, none of them.
#[derive(Clone, Debug, PartialEq)]
struct Labels {
    names: Vec<String>,
    negated: bool,
}

impl Bits {
    const ANY: Self = Self { bits: 0, negated: true };

    fn of(bits: u8) -> Self {
        Self { bits, negated: false }
    }

    fn fit(self, bits: u8) -> bool {
        (self.bits & bits != 0) != self.negated
    }
}

impl Pattern {
    const ANY: Self = Self { kinds: Bits::ANY, modes: Bits::ANY, labels: Vec::new() };

    fn fits(&self, event: &Event) -> bool {
        let label_fits = |l: &Labels| l.names.iter().any(|n| event.labels.contains(n)) != l.negated;
        self.kinds.fit(event.kinds) && self.modes.fit(event.modes) && self.labels.iter().all(label_fits)
    }
}

impl EventSet {
    pub fn contains(&self, event: &Event) -> bool {
        self.patterns.iter().any(|p| p.fits(event)) != self.negated
    }
}

impl SyntaxTree {
    /// Calls `see` with every label of the tree and a flag: true if a pattern asks for the label, false if a pattern
    /// excludes the label.
    pub fn labels(&self, see: &mut impl FnMut(&str, bool)) {
        match self {
            SyntaxTree::Event(set) => {
                for labels in set.patterns.iter().flat_map(|p| &p.labels) {
                    labels.names.iter().for_each(|n| see(n, !labels.negated && !set.negated));
                }
            }
            SyntaxTree::Sequence(nodes) | SyntaxTree::Either(nodes) => nodes.iter().for_each(|n| n.labels(see)),
            SyntaxTree::Repeat(node, ..) => node.labels(see),
        }
    }

    fn reverse(&mut self) {
        match self {
            SyntaxTree::Event(_) => (),
            SyntaxTree::Sequence(nodes) => {
                nodes.reverse();
                nodes.iter_mut().for_each(SyntaxTree::reverse);
            }
            SyntaxTree::Either(nodes) => nodes.iter_mut().for_each(SyntaxTree::reverse),
            SyntaxTree::Repeat(node, ..) => node.reverse(),
        }
    }
}

/// Parses an expression in light-first or camera-first order.
pub fn parse(text: &str) -> Result<SyntaxTree> {
    let characters: Vec<char> = text.chars().collect();
    if characters.len() > MAX_CHARACTERS {
        return Err(Error::argument(format!(
            "the expression has {} characters; at most {MAX_CHARACTERS} are read",
            characters.len()
        )));
    }
    let mut parser = Parser { text, characters, at: 0, depth: 0, light_first: false };
    parser.find_order()?;
    let mut tree = parser.either()?;
    if parser.peek().is_some() {
        return Err(parser.unexpected("an event, '|', or the end"));
    }
    if parser.light_first {
        tree.reverse();
    }
    Ok(tree)
}

struct Parser<'a> {
    text: &'a str,
    characters: Vec<char>,
    at: usize,
    depth: usize,
    light_first: bool,
}

impl Parser<'_> {
    fn error(&self, at: usize, what: &str) -> Error {
        Error::argument(format!("expression {:?}, column {}: {what}", self.text, at + 1))
    }

    /// Returns an error at the next character that is not a space.
    fn unexpected(&mut self, expected: &str) -> Error {
        let found = self.peek().map_or("the end".to_string(), |c| format!("{c:?}"));
        self.error(self.at, &format!("found {found}; expected {expected}"))
    }

    fn peek(&mut self) -> Option<char> {
        while self.characters.get(self.at).is_some_and(|c| c.is_whitespace()) {
            self.at += 1;
        }
        self.characters.get(self.at).copied()
    }

    fn next_if(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        self.at += usize::from(found);
        found
    }

    /// Finds out the order of the text: `C` means camera first, `E` means light first.
    fn find_order(&mut self) -> Result<()> {
        let mut quoted = false;
        let mut seen = [None; 2];
        for (at, &c) in self.characters.iter().enumerate() {
            quoted ^= c == '\'';
            match c {
                'C' if !quoted => seen[0] = seen[0].or(Some(at)),
                'E' if !quoted => seen[1] = seen[1].or(Some(at)),
                _ => (),
            }
        }
        match seen {
            [Some(camera), Some(eye)] => Err(self.error(
                camera.max(eye),
                "C and E in one expression; use C for camera-first or E for light-first order",
            )),
            [None, None] => {
                // Parse the text first, so that any other syntax error is reported rather than the missing camera or
                // eye.
                self.either()?;
                self.unexpected_unless_end()?;
                let end = self.characters.len();
                Err(self
                    .error(end, "found no eye; expected C at the start (camera first) or E at the end (light first)"))
            }
            [_, eye] => {
                self.light_first = eye.is_some();
                Ok(())
            }
        }
    }

    fn unexpected_unless_end(&mut self) -> Result<()> {
        if self.peek().is_some() { Err(self.unexpected("an event, '|', or the end")) } else { Ok(()) }
    }

    fn either(&mut self) -> Result<SyntaxTree> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.error(self.at, &format!("parentheses nest deeper than {MAX_DEPTH}")));
        }
        let mut nodes = vec![self.sequence()?];
        while self.next_if('|') {
            nodes.push(self.sequence()?);
        }
        self.depth -= 1;
        Ok(if nodes.len() == 1 { nodes.remove(0) } else { SyntaxTree::Either(nodes) })
    }

    fn sequence(&mut self) -> Result<SyntaxTree> {
        let mut nodes = vec![self.repeated()?];
        while !matches!(self.peek(), None | Some('|' | ')')) {
            nodes.push(self.repeated()?);
        }
        Ok(SyntaxTree::Sequence(nodes))
    }

    fn repeated(&mut self) -> Result<SyntaxTree> {
        let node = self.atom()?;
        let (min, max) = match self.peek() {
            Some('*') => (0, None),
            Some('+') => (1, None),
            Some('?') => (0, Some(1)),
            Some('{') => {
                self.at += 1;
                let counts = self.counts()?;
                return Ok(SyntaxTree::Repeat(node.into(), counts.0, counts.1));
            }
            _ => return Ok(node),
        };
        self.at += 1;
        Ok(SyntaxTree::Repeat(node.into(), min, max))
    }

    /// Parses the repetition counts `n}`, `n,}` or `n,m}` after an opening brace.
    fn counts(&mut self) -> Result<(u32, Option<u32>)> {
        let start = self.at;
        let min = self.number()?;
        let max = match self.next_if(',') {
            false => Some(min),
            true if self.peek() == Some('}') => None,
            true => Some(self.number()?),
        };
        if !self.next_if('}') {
            return Err(self.unexpected("'}'"));
        }
        if max.is_some_and(|m| m < min.max(1)) {
            return Err(self.error(start, "a repetition must allow at least one, and its second number not be smaller"));
        }
        Ok((min, max))
    }

    fn number(&mut self) -> Result<u32> {
        self.peek();
        let start = self.at;
        while self.characters.get(self.at).is_some_and(char::is_ascii_digit) {
            self.at += 1;
        }
        let digits: String = self.characters[start..self.at].iter().collect();
        if digits.is_empty() {
            return Err(self.unexpected("a number"));
        }
        digits.parse().ok().filter(|&n| n <= MAX_REPEATS).ok_or_else(|| {
            self.error(start, &format!("found {digits}; expected a number of at most {MAX_REPEATS} repetitions"))
        })
    }

    fn atom(&mut self) -> Result<SyntaxTree> {
        if self.next_if('(') {
            let node = self.either()?;
            return if self.next_if(')') { Ok(node) } else { Err(self.unexpected("an event, '|' or ')'")) };
        }
        if self.next_if('[') {
            let negated = self.next_if('^');
            let mut patterns = vec![self.event("an event of the set")?];
            while !self.next_if(']') {
                patterns.push(self.event("an event of the set or ']'")?);
            }
            return Ok(SyntaxTree::Event(EventSet { patterns, negated }));
        }
        let pattern = if self.next_if('.') { Pattern::ANY } else { self.event("an event")? };
        Ok(SyntaxTree::Event(EventSet { patterns: vec![pattern], negated: false }))
    }

    /// Parses a single event: a letter, a label, or `<...>`.
    fn event(&mut self, expected: &str) -> Result<Pattern> {
        if self.next_if('<') {
            return self.pattern();
        }
        match self.peek() {
            Some('\'') => Ok(Pattern { labels: vec![self.label()?], ..Pattern::ANY }),
            Some('A') => Err(self.error(self.at, "A (albedo) is no way of light; the output of that name has it")),
            Some(letter) => {
                let (kind, mode) = (self.kind_bits(letter), self.mode_bits(letter));
                let pattern = match (kind, mode) {
                    (Some(kind), _) => Pattern { kinds: Bits::of(kind), ..Pattern::ANY },
                    (_, Some(mode)) => Pattern { modes: Bits::of(mode), ..Pattern::ANY },
                    _ => return Err(self.unexpected(&format!("{expected}: {}", self.letters()))),
                };
                self.at += 1;
                Ok(pattern)
            }
            None => Err(self.unexpected(expected)),
        }
    }

    fn letters(&self) -> &'static str {
        if self.light_first {
            "one of L O B R T V D G S s E, a label in quotes, or <...>"
        } else {
            "one of C R T V D G S s L O B, a label in quotes, or <...>"
        }
    }

    /// Parses the remainder of `<...>` after the opening bracket.
    fn pattern(&mut self) -> Result<Pattern> {
        let start = self.at;
        let kinds = self.part("a type: R T V L O B, '.', or a set of them", Self::kind_bits)?;
        let mut modes = Bits::ANY;
        if self.peek() == Some('\'') {
            return Err(self.unexpected("a scattering mode, or '.' for any, before the label"));
        }
        if self.peek() != Some('>') {
            modes = self.part("a mode: D G S s, '.', or a set of them; or '>'", Self::mode_bits)?;
        }
        let mut labels = Vec::new();
        while !self.next_if('>') {
            match self.peek() {
                Some('\'') => labels.push(self.label()?),
                Some('.') => self.at += 1,
                Some('[') => {
                    self.at += 1;
                    let negated = self.next_if('^');
                    let mut names = self.label()?.names;
                    while !self.next_if(']') {
                        names.extend(self.label()?.names);
                    }
                    labels.push(Labels { names, negated });
                }
                _ => return Err(self.unexpected("a label in quotes or '>'")),
            }
        }
        if modes != Bits::ANY && kinds != Bits::ANY && !kinds.negated && kinds.bits & kind::SCATTER == 0 {
            return Err(self.error(start, "a light or camera does not scatter; write '.' for its mode"));
        }
        Ok(Pattern { kinds, modes, labels })
    }

    /// Parses the type or the mode of a pattern: a letter, `.`, or a set of letters in brackets.
    fn part(&mut self, expected: &str, bits: impl Fn(&Self, char) -> Option<u8>) -> Result<Bits> {
        if self.next_if('.') {
            return Ok(Bits::ANY);
        }
        let is_set = self.next_if('[');
        let mut part = Bits { bits: 0, negated: is_set && self.next_if('^') };
        loop {
            match self.peek().and_then(|c| bits(self, c)) {
                Some(more) => part.bits |= more,
                None => return Err(self.unexpected(expected)),
            }
            self.at += 1;
            if !is_set || self.next_if(']') {
                return Ok(part);
            }
        }
    }

    fn label(&mut self) -> Result<Labels> {
        if !self.next_if('\'') {
            return Err(self.unexpected("a label in quotes"));
        }
        let start = self.at;
        while self.characters.get(self.at).is_some_and(|&c| c != '\'') {
            self.at += 1;
        }
        let name: String = self.characters[start..self.at].iter().collect();
        if self.at == self.characters.len() {
            return Err(self.error(start - 1, "the label has no closing quote"));
        }
        if name.is_empty() {
            return Err(self.error(start, "the label is empty"));
        }
        self.at += 1;
        Ok(Labels { names: vec![name], negated: false })
    }

    fn kind_bits(&self, letter: char) -> Option<u8> {
        Some(match letter {
            'R' => kind::REFLECT,
            'T' => kind::TRANSMIT,
            'V' => kind::VOLUME,
            'C' | 'E' => kind::CAMERA,
            'L' if self.light_first => kind::LIGHT | kind::OBJECT | kind::BACKGROUND,
            'L' => kind::LIGHT,
            'O' => kind::OBJECT,
            'B' => kind::BACKGROUND,
            _ => return None,
        })
    }

    fn mode_bits(&self, letter: char) -> Option<u8> {
        Some(match letter {
            'D' => mode::DIFFUSE,
            'G' => mode::GLOSSY,
            'S' if self.light_first => mode::GLOSSY | mode::SINGULAR | mode::STRAIGHT,
            'S' => mode::SINGULAR,
            's' => mode::STRAIGHT,
            _ => return None,
        })
    }
}
