//! Finds edges that are pieces of one line, such as the edges of the tiles in a row of a ceiling.

use glam::DVec2;

/// An edge of the photo, traced point by point. All edges have their brighter side on the same side, seen from `a`
/// towards `b`.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    pub a: DVec2,
    pub b: DVec2,
    /// Points of the edge in pixels, in order from `a` to `b`.
    pub points: Vec<DVec2>,
}

/// Maximum gap between two pieces, as a share of the shorter piece's length; `MAX_STEP` pixels are added to it.
/// [judged on 77 photos]
const MAX_GAP: f64 = 0.5;
/// The second piece starts at most this number of pixels beside the line of the first. [judged on 77 photos]
const MAX_STEP: f64 = 2.0;
/// Maximum sine of the angle between two pieces: 2 degrees, more than a lens bends a line from one piece to the next.
/// [judged on 77 photos]
const MAX_TURN: f64 = 0.035;

/// Groups edges that are pieces of one line, in their order along the line. The nearest pieces are joined first, and
/// each end is joined at most once. An edge that is joined to no other edge is a group of its own.
pub fn lines(edges: &[Edge]) -> Vec<Vec<&Edge>> {
    let mut joints: Vec<(f64, usize, usize)> = Vec::new();
    for (i, edge) in edges.iter().enumerate() {
        joints.extend(edges.iter().enumerate().filter_map(|(k, other)| Some((gap(edge, other)?, i, k))));
    }
    joints.sort_by(|x, y| x.0.total_cmp(&y.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    let (mut next, mut has_previous) = (vec![None; edges.len()], vec![false; edges.len()]);
    for (_, i, k) in joints {
        if next[i].is_none() && !has_previous[k] {
            (next[i], has_previous[k]) = (Some(k), true);
        }
    }
    let starts = (0..edges.len()).filter(|&i| !has_previous[i]);
    starts.map(|start| std::iter::successors(Some(start), |&i| next[i]).map(|i| &edges[i]).collect()).collect()
}

/// Returns the gap in pixels between `edge` and `other` if `other` continues the line of `edge`, else `None`.
fn gap(edge: &Edge, other: &Edge) -> Option<f64> {
    let between = other.a - edge.b;
    let (own, others) = (edge.b - edge.a, other.b - other.a);
    let (length, other_length) = (own.length(), others.length());
    let shorter = length.min(other_length);
    if between.length() > MAX_GAP * shorter + MAX_STEP || own.dot(others) <= 0.0 {
        return None;
    }
    let gap = own.dot(between) / length;
    let is_in_line = own.perp_dot(between).abs() <= MAX_STEP * length
        && own.perp_dot(others).abs() <= MAX_TURN * length * other_length;
    (is_in_line && (-MAX_STEP..=MAX_GAP * shorter).contains(&gap)).then_some(gap)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(a: [f64; 2], b: [f64; 2]) -> Edge {
        let (a, b) = (DVec2::from_array(a), DVec2::from_array(b));
        Edge { a, b, points: vec![a, b] }
    }

    #[test]
    fn pieces_of_a_line_are_joined_in_order() {
        let pieces = [[110.0, 210.0], [0.0, 100.0], [220.0, 300.0]].map(|[x, end]| edge([x, 50.0], [end, 51.0]));
        assert_eq!(lines(&pieces), [[&pieces[1], &pieces[0], &pieces[2]]]);
    }

    #[test]
    fn parallel_turned_opposite_and_distant_edges_stay_apart() {
        let first = edge([0.0, 0.0], [100.0, 0.0]);
        for other in [
            edge([105.0, 4.0], [205.0, 4.0]),
            edge([105.0, 0.0], [205.0, 10.0]),
            edge([205.0, 0.0], [105.0, 0.0]),
            edge([160.0, 0.0], [260.0, 0.0]),
        ] {
            assert_eq!(lines(&[first.clone(), other]).len(), 2);
        }
    }
}
