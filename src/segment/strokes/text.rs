//! Reads strokes from a text file with one stroke per line:
//!
//! ```text
//! # what       radius  x y of each point, in pixels from the top left corner
//! plane        6       120 40  300 60  520 45
//! not-plane    6       80 400  80 200
//! light        3       310 30            # a dot
//! not-light    4       400 80  480 80
//! ```

use super::{Kind, Stroke, StrokeSet};
use crate::error::{Error, Result};
use glam::DVec2;

/// Reads the strokes for a photo of the given size. Errors name the line.
pub fn parse(text: &str, width: usize, height: usize) -> Result<StrokeSet> {
    let mut set = StrokeSet::default();
    for (index, line) in text.lines().enumerate() {
        let place = || format!("strokes, line {}", index + 1);
        let content = line.split('#').next().unwrap_or_default();
        let mut words = content.split_whitespace();
        let Some(word) = words.next() else { continue };
        let kind = match word {
            "plane" => Kind::Plane,
            "not-plane" => Kind::NotPlane,
            "light" => Kind::Light,
            "not-light" => Kind::NotLight,
            other => {
                let what = format!("'{other}' is not plane, not-plane, light or not-light");
                return Err(Error::format(what).context(place()));
            }
        };
        let numbers: Vec<f64> = words
            .map(|w| w.parse().map_err(|_| Error::format(format!("'{w}' is not a number")).context(place())))
            .collect::<Result<_>>()?;
        if numbers.len() < 3 || numbers.len().is_multiple_of(2) {
            let what =
                format!("a radius and pairs of x and y are needed after '{word}'; there are {} numbers", numbers.len());
            return Err(Error::format(what).context(place()));
        }
        let points: Vec<DVec2> = numbers[1..].chunks_exact(2).map(DVec2::from_slice).collect();
        let stroke = Stroke::polyline(&points, numbers[0], kind.is_positive(), width, height);
        set.push(kind, stroke.map_err(|e| e.context(place()))?);
    }
    Ok(set)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_goes_to_its_phase() {
        let set =
            parse("# a comment\n\nplane 1 5 5\nnot-plane 2 1 1 8 1 # end\nlight 1 4 4\r\nnot-light 1 2 7", 10, 10)
                .unwrap();
        let signs = |s: &[Stroke]| s.iter().map(|s| s.positive).collect::<Vec<_>>();
        assert_eq!(signs(&set.plane), [true, false]);
        assert_eq!(signs(&set.lights), [true, false]);
        assert_eq!(set.plane_examples().len(), 3);
        assert_eq!(parse("", 10, 10).unwrap(), StrokeSet::default());
    }

    #[test]
    fn errors_name_the_line_and_the_word() {
        for (text, part) in [
            ("plane 1 2 3\nlamp 1 2 3", "line 2: 'lamp'"),
            ("plane 1 2 x", "line 1: 'x'"),
            ("\n\nlight 1 2", "line 3: a radius"),
            ("light", "line 1"),
            ("light 1 2 3 4", "line 1"),
            ("light -1 2 3", "line 1: stroke radius"),
            ("light 1 nan 3", "line 1: a stroke needs"),
        ] {
            let error = parse(text, 10, 10).unwrap_err();
            assert!(error.message.contains(part), "{text:?}: {error}");
        }
    }
}
