//! Reads the wire format of Protocol Buffers: the fields of a message, as views of its bytes.

use crate::error::{Error, Result};
use crate::image::try_push;

/// The value of a field, by its wire type.
#[derive(Clone, Copy)]
pub enum Value<'a> {
    Varint(u64),
    Fixed64(u64),
    Bytes(&'a [u8]),
    Fixed32(u32),
}

fn truncated() -> Error {
    Error::format("the file is truncated, or not an ONNX file")
}

/// Calls `field` with the number and the value of each field of a message.
pub fn fields<'a>(message: &'a [u8], mut field: impl FnMut(u64, Value<'a>) -> Result<()>) -> Result<()> {
    let mut rest = message;
    while !rest.is_empty() {
        let key = varint(&mut rest)?;
        let value = match key & 7 {
            0 => Value::Varint(varint(&mut rest)?),
            1 => Value::Fixed64(u64::from_le_bytes(array(&mut rest)?)),
            2 => {
                let length = usize::try_from(varint(&mut rest)?).map_err(|_| truncated())?;
                let (bytes, after) = rest.split_at_checked(length).ok_or_else(truncated)?;
                rest = after;
                Value::Bytes(bytes)
            }
            5 => Value::Fixed32(u32::from_le_bytes(array(&mut rest)?)),
            kind => return Err(Error::format(format!("a field has wire type {kind}: this is not an ONNX file"))),
        };
        field(key >> 3, value)?;
    }
    Ok(())
}

fn varint(rest: &mut &[u8]) -> Result<u64> {
    let mut value = 0u64;
    for shift in (0..64).step_by(7) {
        let (&byte, after) = rest.split_first().ok_or_else(truncated)?;
        *rest = after;
        value |= u64::from(byte & 127) << shift;
        if byte < 128 {
            return Ok(value);
        }
    }
    Err(Error::format("a number has more than ten bytes: this is not an ONNX file"))
}

fn array<const N: usize>(rest: &mut &[u8]) -> Result<[u8; N]> {
    let (bytes, after) = rest.split_first_chunk::<N>().ok_or_else(truncated)?;
    *rest = after;
    Ok(*bytes)
}

impl<'a> Value<'a> {
    pub fn bytes(self) -> Result<&'a [u8]> {
        match self {
            Self::Bytes(bytes) => Ok(bytes),
            _ => Err(Error::format("a field that should hold bytes holds a number: this is not an ONNX file")),
        }
    }

    pub fn text(self) -> Result<&'a str> {
        std::str::from_utf8(self.bytes()?).map_err(|_| Error::format("a name is not in UTF-8"))
    }

    pub fn integer(self) -> Result<i64> {
        match self {
            Self::Varint(value) | Self::Fixed64(value) => Ok(value as i64),
            Self::Fixed32(value) => Ok(i64::from(value)),
            Self::Bytes(_) => {
                Err(Error::format("a field that should hold a number holds bytes: this is not an ONNX file"))
            }
        }
    }

    pub fn float(self) -> Result<f32> {
        match self {
            Self::Fixed32(bits) => Ok(f32::from_bits(bits)),
            _ => Err(Error::format("a field that should hold a float does not: this is not an ONNX file")),
        }
    }

    /// Appends the integers of a repeated field to `to`, whether the field is packed or not.
    pub fn integers(self, to: &mut Vec<i64>) -> Result<()> {
        let Self::Bytes(mut rest) = self else {
            to.push(self.integer()?);
            return Ok(());
        };
        while !rest.is_empty() {
            try_push(to, varint(&mut rest)? as i64)?;
        }
        Ok(())
    }

    /// Appends the floats of a repeated field to `to`, whether the field is packed or not.
    pub fn floats(self, to: &mut Vec<f32>) -> Result<()> {
        let Self::Bytes(mut rest) = self else {
            to.push(self.float()?);
            return Ok(());
        };
        while !rest.is_empty() {
            try_push(to, f32::from_le_bytes(array(&mut rest)?))?;
        }
        Ok(())
    }
}
