//! Text files read line by line, within bounds, with errors that name the line.

use crate::error::{Error, Result};
use std::str::FromStr;

/// Largest file that is read: a distribution of a tenth of a degree all around would have fewer bytes.
pub const MOST_BYTES: usize = 64 << 20;
/// Most angles along either side of a distribution, and most values in it.
pub const MOST_ANGLES: usize = 4096;
pub const MOST_VALUES: usize = 1 << 22;

/// The lines of a file. Old files are Latin-1: each byte that is not ASCII becomes a character.
pub struct Lines {
    text: String,
}

impl Lines {
    /// # Errors
    /// `Format` if the file is too large, or has bytes that no text has.
    pub fn new(bytes: &[u8]) -> Result<Self> {
        if bytes.len() > MOST_BYTES {
            return Err(Error::format(format!("the file has {} bytes; at most {MOST_BYTES} are read", bytes.len())));
        }
        if bytes.contains(&0) {
            return Err(Error::format("the file is not a text: it contains zero bytes"));
        }
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}').into(),
            Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
        };
        Ok(Self { text })
    }

    /// The lines, numbered from 1.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text.lines().map(str::trim).zip(1..).map(|(line, number)| (number, line))
    }
}

/// An error at a line.
pub fn at(line: usize, message: impl std::fmt::Display) -> Error {
    Error::format(format!("line {line}: {message}"))
}

/// A number as a file has it; a decimal comma counts as a point.
pub fn number<T: FromStr>(line: usize, word: &str, what: &str) -> Result<T> {
    word.replace(',', ".").parse().map_err(|_| at(line, format_args!("{what} is {word:?}, which is no number")))
}

/// A finite number in a range.
pub fn within(line: usize, word: &str, what: &str, low: f64, high: f64) -> Result<f64> {
    let value: f64 = number(line, word, what)?;
    if value >= low && value <= high {
        Ok(value)
    } else {
        Err(at(line, format_args!("{what} is {value}; it must lie in [{low}, {high}]")))
    }
}

/// A count in a range; files write counts as `3` or `3.0`.
pub fn count(line: usize, word: &str, what: &str, low: usize, high: usize) -> Result<usize> {
    let value = within(line, word, what, low as f64, high as f64)?;
    if value.fract() == 0.0 {
        Ok(value as usize)
    } else {
        Err(at(line, format_args!("{what} is {value}, no whole number")))
    }
}

/// Text for one line of a file.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
