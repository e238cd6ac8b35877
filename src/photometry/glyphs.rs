//! A dot-matrix font for the numbers and units on the scale bar of false-colour images.

use crate::image::Image;
use glam::Vec3;

/// Width and height of a glyph in dots, and the distance in dots from one glyph to the next.
pub const WIDTH: usize = 3;
pub const HEIGHT: usize = 5;
pub const ADVANCE: usize = WIDTH + 1;

/// Returns the rows of a glyph from the top. The three lowest bits of a row are its dots, from left to right.
fn rows(letter: char) -> [u8; HEIGHT] {
    match letter {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b011, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        '.' => [0b000, 0b000, 0b000, 0b000, 0b010],
        '-' => [0b000, 0b000, 0b111, 0b000, 0b000],
        '/' => [0b001, 0b001, 0b010, 0b100, 0b100],
        'c' => [0b000, 0b000, 0b111, 0b100, 0b111],
        'd' => [0b001, 0b001, 0b111, 0b101, 0b111],
        'e' => [0b000, 0b111, 0b111, 0b100, 0b011],
        'l' => [0b110, 0b010, 0b010, 0b010, 0b111],
        'm' => [0b000, 0b000, 0b111, 0b111, 0b101],
        'x' => [0b000, 0b000, 0b101, 0b010, 0b101],
        _ => [0; HEIGHT],
    }
}

/// Draws a text with its top-left corner at `at`. Each dot is a square of `dot` pixels; dots outside the image are
/// dropped.
pub fn draw(image: &mut Image, text: &str, at: [usize; 2], dot: usize, ink: Vec3) {
    for (place, letter) in text.chars().enumerate() {
        for (row, bits) in rows(letter).into_iter().enumerate() {
            for column in (0..WIDTH).filter(|c| bits >> (WIDTH - 1 - c) & 1 == 1) {
                let (x, y) = (at[0] + (place * ADVANCE + column) * dot, at[1] + row * dot);
                for y in y..(y + dot).min(image.height) {
                    for x in x..(x + dot).min(image.width) {
                        ink.write_to_slice(image.pixel_mut(x, y));
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_differ_and_keep_within_the_image() {
        let all = "0123456789.-/cdelmx";
        for (i, a) in all.chars().enumerate() {
            assert!(rows(a) != [0; HEIGHT] && all.chars().skip(i + 1).all(|b| rows(a) != rows(b)), "{a}");
        }
        let mut image = Image::new(9, 7, 3).unwrap();
        draw(&mut image, "1888", [1, 1], 1, Vec3::ONE);
        let row = |y: usize| (0..9).map(|x| if image.rgb(x, y) == Vec3::ONE { '#' } else { '.' }).collect::<String>();
        assert_eq!([1, 2, 5, 6].map(row), ["..#..###.", ".##..#.#.", ".###.###.", "........."]);
    }
}
