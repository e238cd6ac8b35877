//! The error type of the library. At the C boundary, the kind becomes the status code. The message names the
//! parameter, its value and the allowed range, and suggests a remedy.

use std::fmt;

/// Kinds of errors. They have the values of `luxfer_status`, so new kinds may only be appended. The values 0 to 4 and 6
/// mean the same as in Embree and Open Image Denoise, where 5 stands for an unsupported device.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorKind {
    /// The cause does not belong to any of the other kinds.
    Unknown = 1,
    /// A parameter is null, out of range, or contradicts another.
    InvalidArgument = 2,
    /// The object's present state does not allow the call.
    InvalidOperation = 3,
    /// The memory budget of the context, or the machine, is used up.
    OutOfMemory = 4,
    /// The file or the request is valid, but uses a feature that this library does not support.
    Unsupported = 5,
    /// The caller cancelled the job.
    Cancelled = 6,
    /// The operating system could not read or write a file.
    Io = 7,
    /// A file is truncated, corrupt, or not in the format it claims.
    Format = 8,
    /// A result was requested before the stage that computes it has run.
    NotReady = 9,
    /// The library has a defect; please report it.
    Internal = 10,
    /// The input is valid but has no answer. Examples: a photo without straight lines, a plane seen edge-on, strokes of
    /// only one class.
    Degenerate = 11,
    /// No surface, image or entry has the given name.
    NotFound = 12,
    /// The emission cannot produce the light of the target: no light path connects them, a material on the way absorbs
    /// a whole channel, or the emission would have to be negative.
    Unreachable = 13,
}

impl ErrorKind {
    /// All kinds, in the order of their values, which start at 1.
    const ALL: [Self; 13] = [
        Self::Unknown,
        Self::InvalidArgument,
        Self::InvalidOperation,
        Self::OutOfMemory,
        Self::Unsupported,
        Self::Cancelled,
        Self::Io,
        Self::Format,
        Self::NotReady,
        Self::Internal,
        Self::Degenerate,
        Self::NotFound,
        Self::Unreachable,
    ];

    /// Returns the kind with this value of `luxfer_status`; `None` for 0 (success) and for unknown values.
    pub fn from_value(value: i32) -> Option<Self> {
        Self::ALL.into_iter().find(|&kind| kind as i32 == value)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    pub kind: ErrorKind,
    pub message: String,
}

pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into() }
    }

    pub fn argument(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::InvalidArgument, message)
    }

    pub fn degenerate(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Degenerate, message)
    }

    pub fn format(message: impl Into<String>) -> Self {
        Self::new(ErrorKind::Format, message)
    }

    /// A part of the library is missing, because it was compiled without a Cargo feature.
    pub fn left_out(what: &str, feature: &str) -> Self {
        let message = format!("{what} left out of this build of luxfer; build it with the Cargo feature {feature}");
        Self::new(ErrorKind::Unsupported, message)
    }

    pub fn cancelled() -> Self {
        Self::new(ErrorKind::Cancelled, "the job was cancelled")
    }

    /// Returns the error with `place` and a colon before its message: `texture 3: the file is truncated`.
    pub fn context(self, place: impl fmt::Display) -> Self {
        Self { message: format!("{place}: {}", self.message), ..self }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}

/// Returns `value` if it lies in `[low, high]`, otherwise an error that calls it `name`. NaN gives an error.
pub fn check_range<T: Copy + PartialOrd + fmt::Display>(name: &str, value: T, low: T, high: T) -> Result<T> {
    if value >= low && value <= high {
        Ok(value)
    } else {
        Err(Error::argument(format!("{name} is {value}; it must lie in [{low}, {high}]")))
    }
}
