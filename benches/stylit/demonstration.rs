//! The scenes of the demonstration: their guides, the artworks of its artists, and the objects in view.

use luxfer::demo::artwork::Style;
use luxfer::exec::Pool;
use luxfer::guides::{self, Extras, Guides, pairs};
use luxfer::job::Monitor;
use luxfer::render::World;
use luxfer::scene::Scene;
use luxfer::stylize::{Guide, Range};
use std::sync::Arc;

/// Size of the pictures of the demonstration scenes, and paths per pixel of their guides.
pub const SIZE: [usize; 2] = [600, 456];
const SAMPLES: u32 = 32;

/// The styles of the demonstration's artists.
pub const STYLES: [(&str, Style); 3] = [("pen", Style::Pen), ("stipple", Style::Stipple), ("paint", Style::Paint)];

/// Renders the guides of a scene.
pub fn guides_of(pool: &Pool, scene: Scene) -> Guides {
    let camera = scene.cameras[0].clone();
    let params = guides::Params { width: SIZE[0], height: SIZE[1], samples: SAMPLES, ..guides::Params::default() };
    let monitor = Monitor::default();
    let render = || {
        let world = World::build(Arc::new(scene), monitor.job())?;
        guides::run(&world, &camera, &params, monitor.job())
    };
    pool.run(render).expect("a valid scene")
}

/// For each pixel, whether it shows an object that stands on the table.
pub fn objects(guides: &Guides) -> Vec<bool> {
    let stands = |p: &Option<guides::Point>| {
        let name = p.map(|p| guides.surfaces.shapes[p.mesh as usize].name.clone()).unwrap_or_default();
        !["", "Table", "Wall"].contains(&name.as_str())
    };
    guides.surfaces.points.iter().map(stands).collect()
}

/// The guides of light of two scenes, each with its name.
pub struct Lights(Vec<guides::Pair>);

impl Lights {
    pub fn new(source: &Guides, target: &Guides) -> Self {
        Self(pairs(source, target, Extras::default()).expect("guides of one kind"))
    }

    pub fn guides(&self) -> Vec<Guide<'_>> {
        let pairs = self.0.iter();
        pairs
            .map(|p| Guide { name: p.name, source: &p.source, target: &p.target, weight: 1.0, range: Range::Light })
            .collect()
    }
}
