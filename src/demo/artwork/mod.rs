//! Artworks of the sphere on a table, drawn by a program in place of an artist: a pen drawing, a stipple drawing and a
//! painting.
//!
//! Each artwork is drawn stroke by stroke on paper or canvas from the guides of the scene, so that artwork and guides
//! are exactly aligned. The programs draw light as artists do: highlights stay white, shadows are cross-hatched or take
//! another colour, and red ink marks the red light that the ball casts onto the table. Stroke sizes are proportional to
//! the width of the picture. The result is the same to the bit every time.

mod canvas;
mod paint;
mod pen;
mod stipple;
mod subject;

use crate::error::Result;
use crate::guides::Guides;
use crate::image::Image;
use subject::Subject;

/// The drawing technique.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Hatching with a pen in two inks.
    Pen,
    /// Stippling in two inks.
    Stipple,
    /// Oil on canvas.
    Paint,
}

/// Draws the scene of the guides in a style. Returns linear RGB at the size of the guides.
pub fn draw(style: Style, guides: &Guides) -> Result<Image> {
    let subject = Subject::new(guides)?;
    let canvas = match style {
        Style::Pen => pen::draw(&subject)?,
        Style::Stipple => stipple::draw(&subject)?,
        Style::Paint => paint::draw(&subject)?,
    };
    canvas.into_image()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo;
    use crate::guides::{Params, run};
    use crate::image::colour::luminance;
    use crate::job::Monitor;
    use crate::render::World;
    use glam::Vec3;
    use std::sync::Arc;

    #[test]
    fn every_artwork_answers_to_the_light_and_is_the_same_each_time() {
        let scene = demo::sphere_on_table().unwrap();
        let (camera, job) = (scene.cameras[0].clone(), Monitor::default());
        let world = World::build(Arc::new(scene), job.job()).unwrap();
        let params = Params { width: 240, height: 180, samples: 16, ..Params::default() };
        let guides = run(&world, &camera, &params, job.job()).unwrap();
        for style in [Style::Pen, Style::Stipple, Style::Paint] {
            let art = draw(style, &guides).unwrap();
            assert!(art == draw(style, &guides).unwrap());
            assert!(art.data.iter().all(|v| (0.0..=1.0).contains(v)));
            let mean = |x: std::ops::Range<usize>, y: std::ops::Range<usize>| {
                let count = (x.len() * y.len()) as f32;
                y.flat_map(|y| x.clone().map(move |x| (x, y))).map(|(x, y)| art.rgb(x, y)).sum::<Vec3>() / count
            };
            let tone = |c: Vec3| luminance(c);
            // Compare three pairs of places: lit table and shadow; lit side and dark side of the ball; table beside the
            // ball, which receives red light, and lit table. The last pair does not count for the painting, because its
            // lit table is painted yellow.
            let (lit, shadow) = (mean(190..230, 130..170), mean(60..100, 128..142));
            assert!(tone(lit) > 1.5 * tone(shadow), "{style:?}: {lit} {shadow}");
            let (day, night) = (mean(128..140, 42..56), mean(90..115, 100..115));
            assert!(tone(day) > 1.2 * tone(night), "{style:?}: {day} {night}");
            let bled = mean(158..178, 116..130);
            assert!(bled.x / bled.z > 1.1 * lit.x / lit.z || style == Style::Paint, "{style:?}: {bled} {lit}");
        }
    }
}
