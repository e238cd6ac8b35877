//! A font of three by five dots, for the captions of contact sheets; small letters are drawn as capitals.

use glam::Vec3;
use luxfer::image::Image;

const WIDTH: usize = 3;
const HEIGHT: usize = 5;

/// Rows of a letter from the top; each row is an octal digit of three dots.
fn rows(letter: char) -> u32 {
    match letter.to_ascii_uppercase() {
        'A' => 0o25755,
        'B' => 0o65656,
        'C' => 0o34443,
        'D' => 0o65556,
        'E' => 0o74647,
        'F' => 0o74644,
        'G' => 0o34553,
        'H' => 0o55755,
        'I' => 0o72227,
        'J' => 0o11152,
        'K' => 0o55655,
        'L' => 0o44447,
        'M' => 0o57755,
        'N' => 0o65555,
        'O' => 0o25552,
        'P' => 0o65644,
        'Q' => 0o25573,
        'R' => 0o65655,
        'S' => 0o34216,
        'T' => 0o72222,
        'U' => 0o55557,
        'V' => 0o55552,
        'W' => 0o55775,
        'X' => 0o55255,
        'Y' => 0o55222,
        'Z' => 0o71247,
        '0' => 0o75557,
        '1' => 0o26227,
        '2' => 0o71747,
        '3' => 0o71717,
        '4' => 0o55711,
        '5' => 0o74717,
        '6' => 0o74757,
        '7' => 0o71222,
        '8' => 0o75757,
        '9' => 0o75717,
        '.' => 0o00002,
        ',' => 0o00024,
        ':' => 0o02020,
        '-' => 0o00700,
        '_' => 0o00007,
        '/' => 0o11244,
        '%' => 0o51245,
        '(' => 0o12221,
        ')' => 0o42224,
        '\'' => 0o22000,
        '=' => 0o07070,
        '+' => 0o02720,
        _ => 0,
    }
}

/// Writes a text on a dark background. `at` is the top left corner in pixels, and each dot is a square of `dot` pixels.
pub fn write(image: &mut Image, text: &str, at: [usize; 2], dot: usize, ink: Vec3) {
    let advance = (WIDTH + 1) * dot;
    let size = [text.chars().count() * advance + dot, (HEIGHT + 2) * dot];
    square(image, at, size, Vec3::splat(0.01));
    for (place, letter) in text.chars().enumerate() {
        let bits = rows(letter);
        for dot_index in (0..WIDTH * HEIGHT).filter(|i| bits >> (WIDTH * HEIGHT - 1 - i) & 1 == 1) {
            let (column, row) = (dot_index % WIDTH, dot_index / WIDTH);
            let corner = [at[0] + place * advance + (column + 1) * dot, at[1] + (row + 1) * dot];
            square(image, corner, [dot, dot], ink);
        }
    }
}

fn square(image: &mut Image, at: [usize; 2], size: [usize; 2], ink: Vec3) {
    for y in at[1]..(at[1] + size[1]).min(image.height) {
        for x in at[0]..(at[0] + size[0]).min(image.width) {
            ink.write_to_slice(image.pixel_mut(x, y));
        }
    }
}
