//! Finds the segments and chunks of picture files without decoding them. Each is a slice of the file.

/// Iterates over the segments of a JPEG before its pixels: the marker and the payload of each.
pub fn jpeg_segments(bytes: &[u8]) -> impl Iterator<Item = (u8, &[u8])> {
    let mut rest = bytes.strip_prefix(&[0xff, 0xd8]).unwrap_or_default();
    std::iter::from_fn(move || {
        // A marker begins with one or more 0xff bytes.
        let at = rest.iter().position(|&b| b != 0xff)?;
        let (&marker, after) = rest.get(at..)?.split_first()?;
        // Stop at the start of a scan (0xda), which holds the pixels; at the start or end of an image (0xd8, 0xd9),
        // which have no length; or at bytes that are not a marker.
        if at == 0 || matches!(marker, 0x00 | 0xd8..=0xda) {
            return None;
        }
        let (length, _) = after.split_first_chunk()?;
        let (segment, next) = after.split_at_checked(usize::from(u16::from_be_bytes(*length)))?;
        rest = next;
        Some((marker, segment.get(2..)?))
    })
}

/// Iterates over the chunks of a PNG: name, stated length and content. In a truncated file the last content is shorter
/// than stated.
pub fn png_chunks(bytes: &[u8]) -> impl Iterator<Item = (&[u8; 4], usize, &[u8])> {
    let mut rest = bytes.get(8..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (&[a, b, c, d, ..], _) = rest.split_first_chunk::<8>()?;
        let (name, content) = rest[4..].split_first_chunk()?;
        let length = u32::from_be_bytes([a, b, c, d]) as usize;
        // Skip the content and the checksum of four bytes that follows it.
        rest = content.get(length.saturating_add(4)..).unwrap_or_default();
        Some((name, length, &content[..length.min(content.len())]))
    })
}

/// Iterates over the chunks of a RIFF file such as WebP: name and content. In a truncated file the last content is
/// shorter than stated.
pub fn riff_chunks(bytes: &[u8]) -> impl Iterator<Item = (&[u8; 4], &[u8])> {
    let mut rest = bytes.get(12..).unwrap_or_default();
    std::iter::from_fn(move || {
        let (name, after) = rest.split_first_chunk()?;
        let (length, content) = after.split_first_chunk()?;
        let length = u32::from_le_bytes(*length) as usize;
        // Chunks begin at even offsets.
        rest = content.get(length.saturating_add(length % 2)..).unwrap_or_default();
        Some((name, &content[..length.min(content.len())]))
    })
}

/// Returns left, top, width and height of the first frame of a GIF within its logical screen, in pixels. `None` if the
/// file is cut off or damaged before the frame.
pub fn gif_frame(bytes: &[u8]) -> Option<[usize; 4]> {
    let table = |flags: u8| if flags & 0x80 != 0 { 3 << ((flags & 7) + 1) } else { 0 };
    // Skip the header, the logical screen descriptor and the global colour table.
    let mut rest = bytes.get(13 + table(*bytes.get(10)?)..)?;
    loop {
        match rest {
            // Skip an extension: a label, then sub-blocks that begin with their length, then an empty sub-block.
            [0x21, _, blocks @ ..] => {
                let mut blocks = blocks;
                while let (&length @ 1.., after) = blocks.split_first()? {
                    blocks = after.get(usize::from(length)..)?;
                }
                rest = &blocks[1..];
            }
            [0x2c, numbers @ ..] => {
                let (numbers, _) = numbers.first_chunk::<8>()?.as_chunks::<2>();
                return Some([0, 1, 2, 3].map(|k| u16::from_le_bytes(numbers[k]).into()));
            }
            _ => return None,
        }
    }
}

/// Finds the first application extension named `name` that stands before the first frame of a GIF. Iterates over the
/// extension's sub-blocks after the name. `None` if there is no such extension.
pub fn gif_extension<'a>(bytes: &'a [u8], name: &[u8; 11]) -> Option<impl Iterator<Item = &'a [u8]> + use<'a>> {
    let table = |flags: u8| if flags & 0x80 != 0 { 3 << ((flags & 7) + 1) } else { 0 };
    let mut rest = bytes.strip_prefix(b"GIF8")?.get(9 + table(*bytes.get(10)?)..)?;
    while let [0x21, label, blocks @ ..] = rest {
        let (_, first) = sub_blocks(blocks).next()?;
        let is_wanted = *label == 0xff && first == name;
        if is_wanted {
            return Some(sub_blocks(blocks).skip(1).map(|(_, block)| block));
        }
        // Skip this extension, which ends with an empty sub-block.
        let length: usize = sub_blocks(blocks).map(|(length, _)| length).sum();
        rest = blocks.get(length + 1..)?;
    }
    None
}

/// Iterates over the sub-blocks of a GIF up to the empty one: the size in bytes including the length byte, and the
/// content.
fn sub_blocks(mut rest: &[u8]) -> impl Iterator<Item = (usize, &[u8])> {
    std::iter::from_fn(move || {
        let (&length @ 1.., after) = rest.split_first()? else { return None };
        let (block, next) = after.split_at_checked(usize::from(length))?;
        rest = next;
        Some((usize::from(length) + 1, block))
    })
}

/// Returns the colour space type in the header of a BMP of version 4 or later, and the embedded profile, if any.
/// `None` for other files.
pub fn bmp_space(bytes: &[u8]) -> Option<([u8; 4], Option<&[u8]>)> {
    const HEADER: usize = 14;
    let word = |at: usize| Some(u32::from_le_bytes(*bytes.get(HEADER + at..)?.first_chunk()?));
    let length = word(0).filter(|_| bytes.starts_with(b"BM"))?;
    if length < 108 {
        return None;
    }
    let kind = word(56)?.to_be_bytes();
    let embedded = || {
        let (start, size) = (word(112)? as usize, word(116)? as usize);
        bytes.get(HEADER.checked_add(start)?..)?.get(..size)
    };
    Some((kind, if length >= 124 && kind == *b"MBED" { embedded() } else { None }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_end_where_pixels_begin() {
        let mut file = b"\xff\xd8\xff\xe0\x00\x04ab\xff\xff\xff\xe1\x00\x03c\xff\xda\x00\x02\xff\xe1\x00\x03x".to_vec();
        let segments: Vec<_> = jpeg_segments(&file).collect();
        assert_eq!(segments, [(0xe0, &b"ab"[..]), (0xe1, b"c")]);
        for cut in 0..file.len() {
            assert!(jpeg_segments(&file[..cut]).count() <= 2);
        }
        // State a segment length of 1, which is less than the two bytes of the length itself.
        file[5] = 1;
        assert_eq!(jpeg_segments(&file).count(), 0);
    }

    #[test]
    fn chunks_are_cut_where_the_file_ends() {
        let png = b"\x89PNG\r\n\x1a\n\0\0\0\x02abcdxy....\0\0\0\x09efgh12";
        let chunks: Vec<_> = png_chunks(png).collect();
        assert_eq!(chunks, [(b"abcd", 2, &b"xy"[..]), (b"efgh", 9, b"12")]);
        let webp = b"RIFF\0\0\0\0WEBPabcd\x03\0\0\0xyz.efgh\xff\xff\xff\xff12";
        let chunks: Vec<_> = riff_chunks(webp).collect();
        assert_eq!(chunks, [(b"abcd", &b"xyz"[..]), (b"efgh", b"12")]);
        for cut in 0..=webp.len() {
            assert!(riff_chunks(&webp[..cut]).chain(riff_chunks(&png[..cut.min(png.len())])).count() <= 4);
        }
    }

    #[test]
    fn extensions_of_a_gif_are_found_by_name() {
        let file = b"GIF89a\x09\0\x08\0\x80\0\0RGBrgb\x21\xf9\x02ab\0\x21\xff\x0bNETSCAPE2.0\x01c\0\x21\xff\x0bICCRGBG1012\x02de\x01f\0\x2c";
        let found = |name| gif_extension(file, name).map(|blocks| blocks.flatten().copied().collect::<Vec<_>>());
        assert_eq!(found(b"ICCRGBG1012"), Some(b"def".to_vec()));
        assert_eq!(found(b"NETSCAPE2.0"), Some(b"c".to_vec()));
        assert_eq!(found(b"ABCDEFGHIJK"), None);
        for cut in 0..file.len() - 6 {
            assert!(gif_extension(&file[..cut], b"ICCRGBG1012").is_none_or(|blocks| blocks.count() <= 1), "{cut}");
        }
    }

    #[test]
    fn a_bmp_states_its_space_in_later_headers() {
        let file = |length: u32, kind: &[u8; 4], start: u32, size: u32| {
            let mut file = [&b"BM"[..], &[0; 12], &length.to_le_bytes(), &[0; 120], b"profile"].concat();
            file[70..74].copy_from_slice(&u32::from_be_bytes(*kind).to_le_bytes());
            file[126..130].copy_from_slice(&start.to_le_bytes());
            file[130..134].copy_from_slice(&size.to_le_bytes());
            file
        };
        assert_eq!(bmp_space(&file(124, b"MBED", 124, 7)), Some((*b"MBED", Some(&b"profile"[..]))));
        assert_eq!(bmp_space(&file(124, b"MBED", 124, 8)), Some((*b"MBED", None)));
        assert_eq!(bmp_space(&file(124, b"MBED", u32::MAX, 8)), Some((*b"MBED", None)));
        assert_eq!(bmp_space(&file(108, b"sRGB", 124, 7)), Some((*b"sRGB", None)));
        assert_eq!(bmp_space(&file(40, b"sRGB", 124, 7)), None);
        let whole = file(124, b"MBED", 124, 7);
        assert!((0..whole.len()).all(|cut| bmp_space(&whole[..cut]).is_none_or(|(_, profile)| profile.is_none())));
    }

    #[test]
    fn the_first_frame_of_a_gif_is_found_behind_extensions() {
        let file = b"GIF89a\x09\0\x08\0\x80\0\0RGBrgb\x21\xff\x02ab\x01c\0\x2c\x01\0\x02\0\x03\0\x04\x01";
        assert_eq!(gif_frame(file), Some([1, 2, 3, 260]));
        for cut in 0..file.len() {
            assert_eq!(gif_frame(&file[..cut]), None);
        }
    }
}
