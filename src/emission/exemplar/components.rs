//! Connected components of a light mask: each is a lamp, or a part of one.

use crate::error::Result;
use crate::image::try_vec;
use glam::DVec2;

/// A connected set of lit pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// Number of pixels.
    pub area: usize,
    /// Mean of the pixel centres.
    pub centre: DVec2,
    /// `min`: first column and first row. `max`: last column and last row, inclusive.
    pub min: [usize; 2],
    pub max: [usize; 2],
}

impl Component {
    pub fn size(&self) -> [usize; 2] {
        [self.max[0] - self.min[0] + 1, self.max[1] - self.min[1] + 1]
    }

    /// The two corners of the bounding box: the smallest coordinates and the largest coordinates. Pixel (i, j) covers
    /// [i, i + 1) × [j, j + 1).
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let corner = |[x, y]: [usize; 2]| DVec2::new(x as f64, y as f64);
        (corner(self.min), corner(self.max) + 1.0)
    }
}

pub struct Components {
    /// For every pixel the index of its component plus 1; 0 for unlit pixels.
    pub labels: Vec<u32>,
    /// The components in the order of their first pixel, row by row.
    pub list: Vec<Component>,
}

impl Components {
    /// Removes the components for whose index `goes` returns true, and renumbers the others.
    pub fn remove(&mut self, goes: impl Fn(usize) -> bool) {
        let mut left = 0;
        let numbers: Vec<u32> = std::iter::once(0)
            .chain((0..self.list.len()).map(|k| {
                left += u32::from(!goes(k));
                if goes(k) { 0 } else { left }
            }))
            .collect();
        self.labels.iter_mut().for_each(|label| *label = numbers[*label as usize]);
        let mut k = 0;
        self.list.retain(|_| {
            k += 1;
            numbers[k] != 0
        });
    }
}

/// Finds the 8-connected components of the pixels for which `lit` is true, in two passes with union-find (Rosenfeld and
/// Pfaltz 1966).
pub fn find(width: usize, height: usize, lit: impl Fn(usize) -> bool) -> Result<Components> {
    let mut labels = try_vec(width * height, 0u32)?;
    let mut parent: Vec<u32> = vec![0];

    // First pass: give each lit pixel the smallest label among its four neighbours already visited (left, and three
    // above), or else a new label. Record in `parent` which labels belong to one component.
    for y in 0..height {
        for x in 0..width {
            let i = y * width + x;
            if !lit(i) {
                continue;
            }
            let mut label = 0;
            let left = (x > 0).then(|| i - 1);
            let above = [(x > 0, 1), (true, 0), (x + 1 < width, -1)]
                .into_iter()
                .filter(|&(inside, _)| inside && y > 0)
                .map(|(_, back)| (i - width).wrapping_add_signed(-back));
            for neighbour in left.into_iter().chain(above) {
                let other = labels[neighbour];
                if other != 0 {
                    label = if label == 0 { root(&mut parent, other) } else { unite(&mut parent, label, other) };
                }
            }
            if label == 0 {
                label = parent.len() as u32;
                parent.push(label);
            }
            labels[i] = label;
        }
    }

    // Second pass: assign final numbers in order of appearance, and measure each component.
    let mut number = vec![0u32; parent.len()];
    let mut list: Vec<Component> = Vec::new();
    for (i, label) in labels.iter_mut().enumerate().filter(|(_, l)| **l != 0) {
        let (x, y) = (i % width, i / width);
        let top = root(&mut parent, *label) as usize;
        if number[top] == 0 {
            list.push(Component { area: 0, centre: DVec2::ZERO, min: [x, y], max: [x, y] });
            number[top] = list.len() as u32;
        }
        *label = number[top];
        let component = &mut list[*label as usize - 1];
        component.area += 1;
        component.centre += DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        component.min = [component.min[0].min(x), component.min[1].min(y)];
        component.max = [component.max[0].max(x), component.max[1].max(y)];
    }
    list.iter_mut().for_each(|c| c.centre /= c.area as f64);
    Ok(Components { labels, list })
}

fn root(parent: &mut [u32], mut label: u32) -> u32 {
    while parent[label as usize] != label {
        let next = parent[parent[label as usize] as usize];
        parent[label as usize] = next;
        label = next;
    }
    label
}

fn unite(parent: &mut [u32], a: u32, b: u32) -> u32 {
    let (a, b) = (root(parent, a), root(parent, b));
    let (low, high) = (a.min(b), a.max(b));
    parent[high as usize] = low;
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_that_join_late_are_one_and_diagonals_touch() {
        let rows = ["#.#..#", "#.#...", "###.#.", "...#.."];
        let lit: Vec<bool> = rows.iter().flat_map(|r| r.bytes().map(|b| b == b'#')).collect();
        let found = find(6, 4, |i| lit[i]).unwrap();
        assert_eq!(found.list.len(), 2);
        assert_eq!(found.list[0].area, 9);
        assert_eq!((found.list[0].min, found.list[0].max), ([0, 0], [4, 3]));
        assert_eq!(found.list[1].centre, DVec2::new(5.5, 0.5));
        assert!(found.labels.iter().zip(&lit).all(|(&l, &on)| (l != 0) == on));

        // The result must equal the components of an image without the removed component's pixels.
        let (mut rest, gone) = (found, 1);
        let label = gone as u32 + 1;
        let alone = find(6, 4, |i| lit[i] && rest.labels[i] != label).unwrap();
        rest.remove(|k| k == gone);
        assert_eq!((rest.labels, rest.list), (alone.labels, alone.list));
    }
}
