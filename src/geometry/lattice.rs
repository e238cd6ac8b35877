//! Lattices in the plane.

use glam::DVec2;

/// The two shortest vectors that span the same lattice as the given ones (Lagrange's reduction).
pub fn reduced([mut a, mut b]: [DVec2; 2]) -> [DVec2; 2] {
    // The number of steps grows only with the logarithm of the vectors' lengths: 64 steps suffice for any image.
    for _ in 0..64 {
        if b.length_squared() < a.length_squared() {
            std::mem::swap(&mut a, &mut b);
        }
        let times = (a.dot(b) / a.length_squared()).round();
        if times == 0.0 || !times.is_finite() {
            break;
        }
        b -= a * times;
    }
    [a, b]
}
