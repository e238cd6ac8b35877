//! Reads directories of tagged values, as in TIFF files and in the EXIF blocks of other pictures (TIFF 6.0, section
//! 2).
//!
//! The bytes are untrusted. A directory or a value that lies outside these bytes counts as absent. Chains of
//! directories are not followed. Reading therefore needs no memory, and it ends after one pass over each directory
//! requested.

/// A block of bytes with directories and a valid header.
#[derive(Clone, Copy)]
pub struct Ifds<'a> {
    bytes: &'a [u8],
    order: Order,
}

/// The byte order of numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    Little,
    Big,
}

impl Order {
    pub fn u16(self, bytes: [u8; 2]) -> u16 {
        if self == Self::Little { u16::from_le_bytes(bytes) } else { u16::from_be_bytes(bytes) }
    }

    pub fn u32(self, bytes: [u8; 4]) -> u32 {
        if self == Self::Little { u32::from_le_bytes(bytes) } else { u32::from_be_bytes(bytes) }
    }

    pub fn u64(self, bytes: [u8; 8]) -> u64 {
        if self == Self::Little { u64::from_le_bytes(bytes) } else { u64::from_be_bytes(bytes) }
    }
}

impl<'a> Ifds<'a> {
    /// Reads the header at the start of `bytes`; `None` if it is not valid.
    pub fn new(bytes: &'a [u8]) -> Option<Self> {
        let order = match bytes.first_chunk()? {
            [b'I', b'I', 42, 0] => Order::Little,
            [b'M', b'M', 0, 42] => Order::Big,
            _ => return None,
        };
        Some(Self { bytes, order })
    }

    /// Returns the directory to which the header points.
    pub fn first(self) -> Option<Directory<'a>> {
        self.directory(self.order.u32(*self.bytes.get(4..)?.first_chunk()?))
    }

    /// Returns the directory at an offset. Entries that lie beyond the end of the block are dropped.
    pub fn directory(self, offset: u32) -> Option<Directory<'a>> {
        let (count, entries) = self.bytes.get(offset as usize..)?.split_first_chunk()?;
        let (entries, _) = entries.as_chunks();
        let count = usize::from(self.order.u16(*count)).min(entries.len());
        Some(Directory { ifds: self, entries: &entries[..count] })
    }

    pub fn order(self) -> Order {
        self.order
    }

    /// Returns `len` bytes from an offset on; `None` if they exceed the block.
    pub fn slice(self, offset: u64, len: u64) -> Option<&'a [u8]> {
        let start = usize::try_from(offset).ok()?;
        self.bytes.get(start..start.checked_add(usize::try_from(len).ok()?)?)
    }
}

/// A directory: a list of values with their tags.
#[derive(Clone, Copy)]
pub struct Directory<'a> {
    ifds: Ifds<'a>,
    entries: &'a [[u8; 12]],
}

impl<'a> Directory<'a> {
    pub fn ifds(&self) -> Ifds<'a> {
        self.ifds
    }

    /// Returns the values of a tag; `None` if the directory lacks the tag, or if their type is unknown. Values outside
    /// the file count in [`Field::len`], but cannot be read.
    pub fn field(&self, tag: u16) -> Option<Field<'a>> {
        let order = self.ifds.order;
        let entry = self.entries.iter().find(|e| order.u16([e[0], e[1]]) == tag)?;
        let [_, _, k0, k1, c0, c1, c2, c3, ref inline @ ..] = *entry;
        let kind = FieldType::new(order.u16([k0, k1]))?;
        let count = order.u32([c0, c1, c2, c3]);
        // Values of four bytes or less are stored in the entry itself.
        let len = u64::from(count) * kind.size() as u64;
        let values =
            if len <= 4 { inline.get(..len as usize) } else { self.ifds.slice(order.u32(*inline).into(), len) };
        Some(Field { kind, count: count as usize, values: values.unwrap_or_default(), order })
    }

    /// Returns the first value of a tag if it is an unsigned integer.
    pub fn integer(&self, tag: u16) -> Option<u64> {
        self.field(tag)?.integer(0)
    }

    /// Returns the bytes of a tag's values if they lie within the file.
    pub fn bytes(&self, tag: u16) -> Option<&'a [u8]> {
        self.field(tag).map(|field| field.values).filter(|values| !values.is_empty())
    }

    /// Returns the first value of a tag if it is a finite number.
    pub fn number(&self, tag: u16) -> Option<f64> {
        self.field(tag)?.number(0)
    }
}

/// The type of a tag's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum FieldType {
    U8,
    U16,
    U32,
    I8,
    I16,
    I32,
    F32,
    F64,
    URational,
    IRational,
}

impl FieldType {
    fn new(code: u16) -> Option<Self> {
        Some(match code {
            // Bytes, which may be text or have an undefined meaning.
            1 | 2 | 7 => Self::U8,
            3 => Self::U16,
            // 32-bit integers, some of which are offsets of directories.
            4 | 13 => Self::U32,
            5 => Self::URational,
            6 => Self::I8,
            8 => Self::I16,
            9 => Self::I32,
            10 => Self::IRational,
            11 => Self::F32,
            12 => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::F64 | Self::URational | Self::IRational => 8,
        }
    }
}

/// The values of one tag.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    kind: FieldType,
    count: usize,
    values: &'a [u8],
    order: Order,
}

impl Field<'_> {
    pub fn len(&self) -> usize {
        self.count
    }

    fn bytes<const N: usize>(&self, index: usize) -> Option<[u8; N]> {
        self.values.as_chunks::<N>().0.get(index).copied()
    }

    /// Returns the value at an index if it is an unsigned integer.
    pub fn integer(&self, index: usize) -> Option<u64> {
        match self.kind {
            FieldType::U8 => self.bytes(index).map(|[v]| v.into()),
            FieldType::U16 => self.bytes(index).map(|v| self.order.u16(v).into()),
            FieldType::U32 => self.bytes(index).map(|v| self.order.u32(v).into()),
            _ => None,
        }
    }

    /// Returns the value at an index if it is a finite number.
    pub fn number(&self, index: usize) -> Option<f64> {
        let u32 = |index| self.bytes(index).map(|v| self.order.u32(v));
        let value = match self.kind {
            FieldType::U8 | FieldType::U16 | FieldType::U32 => self.integer(index)? as f64,
            FieldType::I8 => self.bytes(index).map(i8::from_ne_bytes)?.into(),
            FieldType::I16 => (self.bytes(index).map(|v| self.order.u16(v))? as i16).into(),
            FieldType::I32 => (u32(index)? as i32).into(),
            FieldType::F32 => f32::from_bits(u32(index)?).into(),
            FieldType::F64 => f64::from_bits(self.bytes(index).map(|v| self.order.u64(v))?),
            FieldType::URational => f64::from(u32(2 * index)?) / f64::from(u32(2 * index + 1)?),
            FieldType::IRational => f64::from(u32(2 * index)? as i32) / f64::from(u32(2 * index + 1)? as i32),
        };
        value.is_finite().then_some(value)
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// One entry of a directory: its tag, its type code, and its values as bytes in the file's order.
    pub type Entry = (u16, u16, Vec<u8>);

    /// A block with one directory, in the given byte order. Values too long for their entry follow the directory.
    pub fn structure(order: Order, entries: &[Entry]) -> Vec<u8> {
        let (head, u16, u32) = writers(order);
        let mut out = [head.to_vec(), u32(8), u16(entries.len() as u16)].concat();
        let mut tail = 8 + 2 + 12 * entries.len() + 4;
        let mut values: Vec<u8> = Vec::new();
        for (tag, kind, bytes) in entries {
            let size = FieldType::new(*kind).unwrap().size();
            out.extend([u16(*tag), u16(*kind), u32((bytes.len() / size) as u32)].concat());
            if bytes.len() <= 4 {
                out.extend(bytes);
                out.resize(out.len() + 4 - bytes.len(), 0);
            } else {
                out.extend(u32(tail as u32));
                tail += bytes.len();
                values.extend(bytes);
            }
        }
        out.extend([0; 4]);
        out.extend(values);
        out
    }

    type Writers = (&'static [u8], fn(u16) -> Vec<u8>, fn(u32) -> Vec<u8>);

    /// Returns the first four bytes of a file in this byte order, and the functions that write its 16-bit and 32-bit
    /// numbers.
    pub fn writers(order: Order) -> Writers {
        match order {
            Order::Little => (b"II*\0", |v| v.to_le_bytes().to_vec(), |v| v.to_le_bytes().to_vec()),
            Order::Big => (b"MM\0*", |v| v.to_be_bytes().to_vec(), |v| v.to_be_bytes().to_vec()),
        }
    }

    #[test]
    fn values_of_every_kind_are_read_in_either_order() {
        for order in [Order::Little, Order::Big] {
            let (_, u16, u32) = writers(order);
            let rational = [u32(7), u32(2)].concat();
            let negative = [u32(-7i32 as u32), u32(2)].concat();
            let double = if order == Order::Little { 2.5f64.to_le_bytes() } else { 2.5f64.to_be_bytes() };
            let entries = vec![
                (1, 3, u16(500)),
                (2, 4, [u32(70_000), u32(3)].concat()),
                (3, 5, rational),
                (4, 10, negative),
                (5, 1, vec![1, 2, 3]),
                (6, 11, u32(0.25f32.to_bits())),
                (7, 12, double.to_vec()),
                (8, 8, u16(-3i16 as u16)),
                (9, 6, vec![0xff]),
            ];
            let bytes = structure(order, &entries);
            let directory = Ifds::new(&bytes).unwrap().first().unwrap();
            assert_eq!(directory.integer(1), Some(500));
            assert_eq!(
                directory.field(2).map(|f| [f.integer(0), f.integer(1), f.integer(2)]),
                Some([Some(70_000), Some(3), None])
            );
            let numbers = [3, 4, 6, 7, 8, 9].map(|tag| directory.number(tag));
            assert_eq!(numbers, [3.5, -3.5, 0.25, 2.5, -3.0, -1.0].map(Some));
            assert!(directory.integer(7).is_none());
            assert_eq!(directory.field(5).unwrap().integer(2), Some(3));
            assert!(directory.field(10).is_none());
        }
    }

    #[test]
    fn values_outside_the_file_are_absent() {
        let order = Order::Little;
        let (_, u16, u32) = writers(order);
        let bytes =
            structure(order, &[(1, 3, u16(1)), (2, 5, [u32(1), u32(2)].concat()), (3, 5, [u32(1), u32(0)].concat())]);
        let first = |bytes: &[u8], tag| Ifds::new(bytes).and_then(Ifds::first).and_then(|d| d.number(tag));
        assert_eq!([1, 2, 3].map(|tag| first(&bytes, tag)), [Some(1.0), Some(0.5), None]);
        for cut in 0..bytes.len() {
            let known = [1, 2].map(|tag| first(&bytes[..cut], tag));
            assert!(known[0].is_none_or(|v| v == 1.0) && known[1].is_none_or(|v| v == 0.5), "cut at {cut}");
        }
        // Counts and offsets of every size must not cause a panic.
        for at in 4..bytes.len() - 3 {
            for value in [0, 1, 9, 255, 65_535, 0x7fff_ffff, 0xffff_ffff] {
                let mut bad = bytes.clone();
                bad[at..at + 4].copy_from_slice(&u32(value));
                for tag in 0..5 {
                    let _ = first(&bad, tag);
                }
            }
        }
        assert!(Ifds::new(b"II+\0\x08\0\0\0").is_none() && Ifds::new(b"II").is_none());
    }
}
