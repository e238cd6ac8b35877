//! Computes the minimum-error boundary cut of image quilting (Efros and Freeman 2001, §2.1).

/// Finds the cheapest path from the top row to the bottom row of a `width` × `height` grid of costs. The path moves by
/// at most one column from row to row. Returns its column in each row. Among equally cheap paths, the leftmost one is
/// chosen.
pub fn vertical_cut(cost: &[f32], width: usize, height: usize) -> Vec<usize> {
    if width == 0 || height == 0 {
        return vec![0; height];
    }
    // Compute for each cell the lowest cost of the paths from the top row to this cell.
    let mut total: Vec<f64> = cost.iter().map(|&c| f64::from(c)).collect();
    let best_above = |total: &[f64], x: usize, y: usize| {
        let row = &total[(y - 1) * width..y * width];
        (x.saturating_sub(1)..(x + 2).min(width)).fold(None, |best: Option<usize>, c| match best {
            Some(b) if row[b] <= row[c] => Some(b),
            _ => Some(c),
        })
    };
    for y in 1..height {
        for x in 0..width {
            if let Some(c) = best_above(&total, x, y) {
                total[y * width + x] += total[(y - 1) * width + c];
            }
        }
    }
    // Trace the path back from its cheapest end.
    let last = &total[(height - 1) * width..];
    let mut x = (1..width).fold(0, |best, c| if last[c] < last[best] { c } else { best });
    let mut path = vec![x; height];
    for y in (1..height).rev() {
        x = best_above(&total, x, y).unwrap_or(x);
        path[y - 1] = x;
    }
    path
}

/// Finds the cheapest path from the left column to the right column, and returns its row in each column.
pub fn horizontal_cut(cost: &[f32], width: usize, height: usize) -> Vec<usize> {
    let transposed: Vec<f32> = (0..width * height).map(|i| cost[(i % height) * width + i / height]).collect();
    vertical_cut(&transposed, height, width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// Cost of the cheapest path from `(x, y)` to the bottom row, found by trying all paths.
    fn brute_force(cost: &[f32], width: usize, height: usize, x: usize, y: usize) -> f64 {
        let here = f64::from(cost[y * width + x]);
        if y + 1 == height {
            return here;
        }
        let below = (x.saturating_sub(1)..(x + 2).min(width)).map(|c| brute_force(cost, width, height, c, y + 1));
        here + below.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_cut_is_the_cheapest_of_all_paths_and_connected() {
        for case in 0..60 {
            let mut rng = Rng::new(11, &[case]);
            let (width, height) = (1 + rng.below(6), 1 + rng.below(7));
            let cost: Vec<f32> = (0..width * height).map(|_| rng.below(9) as f32).collect();
            let path = vertical_cut(&cost, width, height);
            assert!(path.windows(2).all(|p| p[0].abs_diff(p[1]) <= 1));
            let sum: f64 = path.iter().enumerate().map(|(y, &x)| f64::from(cost[y * width + x])).sum();
            let best = (0..width).map(|x| brute_force(&cost, width, height, x, 0)).fold(f64::INFINITY, f64::min);
            assert_eq!(sum, best);

            let transposed: Vec<f32> = (0..width * height).map(|i| cost[(i % height) * width + i / height]).collect();
            assert_eq!(horizontal_cut(&transposed, height, width), path);
        }
    }

    #[test]
    fn a_lamp_in_the_way_is_passed() {
        // A barrier of high cost with one gap at the left, where the path must pass.
        let cost: Vec<f32> =
            (0..25).map(|i| if i / 5 == 2 && i % 5 > 0 { 1e3 } else { (i % 5 == 0) as u8 as f32 * 2.0 }).collect();
        assert_eq!(vertical_cut(&cost, 5, 5)[2], 0);
    }
}
