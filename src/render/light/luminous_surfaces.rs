//! Counts the lamps of a scene as a person would: a connected luminous surface is one lamp, however many triangles it
//! has.

use super::selector::Inventory;
use crate::error::Result;
use crate::image::{try_collect, try_vec, try_with_capacity};
use crate::render::emissive::Emitters;

/// The luminous surfaces of a scene, grouped into lamps.
pub struct LuminousSurfaces {
    /// For each piece of an emissive surface (a triangle, a tile of a textured triangle, or a patch of a luminaire's
    /// face), the index of its lamp.
    of_pieces: Vec<u32>,
    /// Number of lamps.
    count: usize,
}

impl LuminousSurfaces {
    /// Groups the luminous surfaces into lamps by [`connected`]: each connected surface is one lamp. `pieces` is the
    /// number of pieces into which the triangles are divided.
    pub fn new(emitters: &Emitters, pieces: usize) -> Result<Self> {
        let roots = connected(emitters)?;
        // Number the lamps in the order of their first pieces. A set of connected triangles without pieces is dark and
        // not a lamp.
        let (mut of_roots, mut lamps) = (try_vec(roots.len(), u32::MAX)?, 0);
        let of_pieces = try_collect((0..pieces).map(|piece| {
            let lamp = &mut of_roots[roots[emitters.emitter_of(piece)] as usize];
            if *lamp == u32::MAX {
                (*lamp, lamps) = (lamps, lamps + 1);
            }
            *lamp
        }))?;
        Ok(Self { of_pieces, count: lamps as usize })
    }

    /// Returns the number of all lamps of the scene, and the number of hidden lamps. A lamp is hidden if all its lights
    /// are hidden. A connected luminous surface is one lamp, whose lights are its pieces. Every punctual light that
    /// emits is a lamp of its own, and so is an environment that emits. `is_hidden` takes the number of a light in the
    /// [`Inventory`].
    pub fn count(&self, lights: &Inventory, is_hidden: impl Fn(usize) -> bool) -> Result<[usize; 2]> {
        let mut surfaces = try_vec(self.count, true)?;
        self.of_pieces.iter().enumerate().for_each(|(piece, &lamp)| surfaces[lamp as usize] &= is_hidden(piece));
        let (mut lamps, mut hidden) = (surfaces.len(), surfaces.iter().filter(|&&is_hidden| is_hidden).count());
        let near = lights.pieces..lights.bounds.len();
        let far = (0..lights.flux.len()).filter(|&i| lights.is_far[i] && lights.flux[i] > 0.0);
        let sky = (lights.environment > 0.0).then(|| lights.environment());
        for light in near.chain(far.map(|i| lights.directional(i))).chain(sky) {
            lamps += 1;
            hidden += usize::from(is_hidden(light));
        }
        Ok([lamps, hidden])
    }
}

/// Returns, for each emitter, the first emitter of its connected surface. Emissive triangles with a corner at the same
/// position belong to one surface, and so do all faces of a luminaire.
pub fn connected(emitters: &Emitters) -> Result<Vec<u32>> {
    let count = emitters.emitters.len();
    let mut corners = try_with_capacity(3 * count)?;
    for (index, emitter) in emitters.emitters.iter().enumerate() {
        corners.extend(emitter.corners.map(|corner| (corner.to_array().map(f32::to_bits), index as u32)));
    }
    corners.sort_unstable();
    let mut parents = try_collect(0..count as u32)?;
    let touching = corners.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1]);
    let of_one_luminaire = (1..count).filter(|&i| emitters.are_of_one_luminaire([i - 1, i]));
    for pair in touching.chain(of_one_luminaire.map(|i| [i as u32 - 1, i as u32])) {
        let [a, b] = pair.map(|emitter| root(&mut parents, emitter));
        parents[a.max(b) as usize] = a.min(b);
    }
    for emitter in 0..count as u32 {
        parents[emitter as usize] = root(&mut parents, emitter);
    }
    Ok(parents)
}

/// Union-find: returns the representative of the set (the surface) that contains `emitter`. Shortens the chain of
/// `parents` on the way.
fn root(parents: &mut [u32], mut emitter: u32) -> u32 {
    while parents[emitter as usize] != emitter {
        let parent = parents[parents[emitter as usize] as usize];
        parents[emitter as usize] = parent;
        emitter = parent;
    }
    emitter
}
