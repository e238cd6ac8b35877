//! Parses IES and EULUMDAT files line by line, with bounded sizes and errors that name the line.

use crate::error::{Error, Result};
use std::str::FromStr;

/// Maximum size of a file in bytes: 16 bytes for each of `MAX_VALUES` intensities.
pub const MAX_BYTES: usize = 64 << 20;
/// Maximum number of angles γ and of C planes of a distribution (`MAX_ANGLES`), and maximum number of its intensities
/// (`MAX_VALUES`).
pub const MAX_ANGLES: usize = 4096;
pub const MAX_VALUES: usize = 1 << 22;

/// The lines of a text file. A file that is not UTF-8 is read as Latin-1.
pub struct Lines {
    text: String,
}

impl Lines {
    /// Decodes the bytes of a file to text.
    ///
    /// # Errors
    /// `Format` if the file is too large or contains zero bytes.
    pub fn new(bytes: &[u8]) -> Result<Self> {
        if bytes.len() > MAX_BYTES {
            return Err(Error::format(format!("the file has {} bytes; at most {MAX_BYTES} are read", bytes.len())));
        }
        if bytes.contains(&0) {
            return Err(Error::format("the file is not a text file: it contains zero bytes"));
        }
        let text = match std::str::from_utf8(bytes) {
            Ok(text) => text.trim_start_matches('\u{feff}').into(),
            Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
        };
        Ok(Self { text })
    }

    /// Iterates over the lines, trimmed, with their numbers from 1.
    pub fn numbered(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text.lines().map(str::trim).zip(1..).map(|(line, number)| (number, line))
    }
}

/// Returns a `Format` error that names a line.
pub fn at(line: usize, message: impl std::fmt::Display) -> Error {
    Error::format(format!("line {line}: {message}"))
}

/// Parses a number; a decimal comma counts as a decimal point. `what` names the number in errors.
pub fn number<T: FromStr>(line: usize, word: &str, what: &str) -> Result<T> {
    word.replace(',', ".").parse().map_err(|_| at(line, format_args!("{what} is {word:?}, which is not a number")))
}

/// Parses a finite number in `[low, high]`.
pub fn within(line: usize, word: &str, what: &str, low: f64, high: f64) -> Result<f64> {
    let value: f64 = number(line, word, what)?;
    if value >= low && value <= high {
        Ok(value)
    } else {
        Err(at(line, format_args!("{what} is {value}; it must lie in [{low}, {high}]")))
    }
}

/// Parses a whole number in `[low, high]`, written as `3` or as `3.0`.
pub fn count(line: usize, word: &str, what: &str, low: usize, high: usize) -> Result<usize> {
    let value = within(line, word, what, low as f64, high as f64)?;
    if value.fract() == 0.0 {
        Ok(value as usize)
    } else {
        Err(at(line, format_args!("{what} is {value}; it must be a whole number")))
    }
}

/// Replaces line breaks and other control characters by blanks, so that a text fits on one line of a file.
pub fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
