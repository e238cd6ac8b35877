//! Warnings about defects of the exemplar, on the artworks of the demonstration's artists as they are, and with planted
//! defects: stains of foreign colours, and a part of the picture in other paint.
//!
//! - `clean`: share of the clean artworks with a warning.
//! - `stains`, `two_paints`: share of the planted defects that are named.

use super::demonstration::{Lights, SIZE, STYLES, guides_of};
use crate::harness::{Table, figure};
use luxfer::demo::artwork::draw;
use luxfer::demo::{sphere_on_table, still_life};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::stylize::{Guide, Input, Params, run};
use luxfer::warning::Code;

/// Stains: centre and radius in pixels, and colour.
const STAINS: [([f32; 2], f32, [f32; 3]); 4] = [
    ([480.0, 380.0], 14.0, [0.1, 0.5, 0.1]),
    ([100.0, 420.0], 9.0, [0.02, 0.02, 0.02]),
    ([300.0, 200.0], 20.0, [0.1, 0.5, 0.1]),
    ([450.0, 60.0], 14.0, [0.3, 0.2, 0.08]),
];
/// Shares of the width from which on the paint is another one.
const PARTS: [f32; 2] = [0.5, 0.67];

pub fn measure(pool: &Pool) {
    let mut table = Table::new(["scene", "style", "artwork", "blemish", "at", "two paints %", "warnings"]);
    let [mut clean, mut stains, mut paints] = [Vec::new(), Vec::new(), Vec::new()];
    for (scene_name, scene) in [("ball", sphere_on_table()), ("still life", still_life())] {
        let guides = guides_of(pool, scene.expect("a scene"));
        let lights = Lights::new(&guides, &guides);
        for (style_name, style) in STYLES {
            let art = draw(style, &guides).expect("an artwork");
            let mut row = |name: String, art: &Image| {
                let (codes, cells) = examined(art, &lights.guides(), pool);
                table.row([[scene_name, style_name].map(String::from).to_vec(), vec![name], cells].concat());
                codes
            };
            clean.push(!row("clean".into(), &art).is_empty());
            for stain in STAINS {
                let [x, y] = stain.0;
                stains.push(row(format!("stain at {x:.0}, {y:.0}"), &stained(&art, stain)).contains(&Code::Blemish));
            }
            for from in PARTS {
                let codes = row(format!("other paint from {from}"), &in_other_paint(&art, from));
                paints.push(codes.contains(&Code::AmbiguousPaint));
            }
        }
    }
    table.print("defects of the exemplar, 600 x 456");
    for (name, warned) in [("clean", clean), ("stains", stains), ("two_paints", paints)] {
        let share = warned.iter().filter(|w| **w).count() as f64 / warned.len() as f64;
        figure(&format!("stylit.doubts.{name}"), 100.0 * share, "%");
    }
}

/// The codes of the warnings, and the cells of the table.
fn examined(art: &Image, guides: &[Guide], pool: &Pool) -> (Vec<Code>, Vec<String>) {
    // The examination does not depend on the matches, so few of them suffice.
    let params = Params { levels: 1, polish: 0, ..Params::fast() };
    let monitor = Monitor::default();
    let output = pool.run(|| run(&Input::new(art, guides), &params, monitor.job())).expect("valid input");
    let doubts = output.report.doubts;
    let place = doubts.blemish_at.map_or("-".to_string(), |[x, y]| format!("{x}, {y}"));
    let codes: Vec<Code> = output.report.warnings(false).iter().map(|w| w.code).collect();
    let cells =
        [format!("{:.1}", doubts.blemish), place, format!("{:.1}", 100.0 * doubts.ambiguous), format!("{codes:?}")];
    (codes, cells.to_vec())
}

fn stained(art: &Image, ([cx, cy], radius, colour): ([f32; 2], f32, [f32; 3])) -> Image {
    let is_in = |x: usize, y: usize| (x as f32 - cx).powi(2) + (y as f32 - cy).powi(2) < radius * radius;
    let pixel = |x: usize, y: usize| if is_in(x, y) { colour } else { art.rgb(x, y).to_array() };
    Image::from_fn(art.width, art.height, pixel).expect("the size of the artwork")
}

fn in_other_paint(art: &Image, from: f32) -> Image {
    let pixel = |x: usize, y: usize| {
        let [r, g, b] = art.rgb(x, y).to_array();
        if x as f32 > from * SIZE[0] as f32 { [0.5 * r, g, (0.9 * b + 0.1).min(1.0)] } else { [r, g, b] }
    };
    Image::from_fn(art.width, art.height, pixel).expect("the size of the artwork")
}
