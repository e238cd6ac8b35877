//! Textures that are too large to be made as a whole: time and memory against their size, and whether tiles equal the
//! whole texture to the bit.

use crate::harness::{Clock, Table, absent, figure, forget_peak_memory, peak_memory, time};
use crate::{DESIGNS, Exemplar};
use luxfer::emission::{Composition, Params, Tile};
use luxfer::job::Monitor;

const SIDES: [usize; 4] = [2048, 4096, 8192, 16_384];
const TILE: usize = 1024;

pub fn tiles() {
    let exemplar = DESIGNS[1].exemplar(512);
    let mut table = Table::new(["side", "plan s", "tiles s", "ns per texel", "lamps", "peak MiB", "values off"]);
    for side in SIDES {
        let params = Params { width: side, height: side, ..Params::default() };
        let whole = (side <= 4096).then(|| exemplar.run(&params));
        forget_peak_memory();
        let (planning, plan) = time(Clock::Wall, || plan(&exemplar, &params));
        let (rendering, off) = time(Clock::Wall, || {
            let places = (0..side / TILE).flat_map(|y| (0..side / TILE).map(move |x| (x * TILE, y * TILE)));
            places.map(|(x, y)| differing(&exemplar, &plan, (x, y), whole.as_ref().map(|w| &w.texture))).sum::<usize>()
        });
        // The peak includes all memory of the process: the exemplar, and for sides below 8192 the whole texture for
        // comparison.
        let peak = peak_memory().map(|bytes| bytes as f64 / 1048576.0).filter(|mib| *mib > 0.0);
        let seconds = planning + rendering;
        table.row([
            side.to_string(),
            format!("{planning:.2}"),
            format!("{rendering:.2}"),
            format!("{:.0}", 1e9 * seconds / (side * side) as f64),
            plan.lamps().to_string(),
            peak.map_or("-".into(), |mib| format!("{mib:.0}")),
            whole.map_or("-".into(), |_| off.to_string()),
        ]);
        if side == 16_384 {
            figure("emission.16k.seconds", seconds, "s");
            match peak {
                Some(mib) => figure("emission.16k.peak", mib, "MiB"),
                None => absent("emission.16k.peak", "the system does not tell the peak of memory"),
            }
        }
    }
    table.print("In tiles of 1024 x 1024, from 512 x 512; the texture of 16384 x 16384 itself has 3072 MiB");
}

fn plan(exemplar: &Exemplar, params: &Params) -> Composition {
    Composition::new(&exemplar.input(), &[], params, Monitor::default().job()).expect("a plan")
}

/// Renders a tile; returns the number of its values that differ from the whole texture, or 0 without one.
fn differing(
    exemplar: &Exemplar,
    plan: &Composition,
    (x, y): (usize, usize),
    whole: Option<&luxfer::image::Image>,
) -> usize {
    let tile = Tile { x, y, width: TILE, height: TILE };
    let (texture, _) = plan.tile(&exemplar.input(), &[], tile, Monitor::default().job()).expect("a tile");
    let Some(whole) = whole else { return 0 };
    let rows = texture.data.chunks_exact(3 * TILE).enumerate();
    rows.map(|(row, made)| {
        let start = 3 * ((y + row) * whole.width + x);
        made.iter().zip(&whole.data[start..]).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
    })
    .sum()
}
