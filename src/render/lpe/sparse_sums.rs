//! An array of light sums. Each path changes only a few of the sums; these are marked, so that clearing the array is
//! cheap.

use glam::Vec3A;

#[derive(Default)]
pub struct SparseSums {
    sums: Vec<Vec3A>,
    /// One bit for each sum, set if the sum may differ from zero.
    touched: Vec<u64>,
}

impl SparseSums {
    /// Clears all sums and makes room for at least `count` sums.
    #[inline]
    pub fn begin(&mut self, count: usize) {
        self.drain(|_, _| ());
        if count > self.sums.len() {
            self.sums.resize(count, Vec3A::ZERO);
            self.touched.resize(count.div_ceil(64), 0);
        }
    }

    #[inline(always)]
    pub fn add(&mut self, number: usize, light: Vec3A) {
        self.sums[number] += light;
        self.touched[number / 64] |= 1 << (number % 64);
    }

    /// Calls `take` with the index and the value of each changed sum, in the order of the indices, and clears the sums.
    #[inline]
    pub fn drain(&mut self, mut take: impl FnMut(usize, Vec3A)) {
        for (word, bits) in self.touched.iter_mut().enumerate() {
            let mut left = std::mem::take(bits);
            while left != 0 {
                let number = 64 * word + left.trailing_zeros() as usize;
                take(number, std::mem::replace(&mut self.sums[number], Vec3A::ZERO));
                left &= left - 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_taken_once_in_order_and_nothing_is_left() {
        let mut sums = SparseSums::default();
        sums.begin(200);
        for (number, light) in [(130, 1.0), (3, 2.0), (64, 4.0), (3, 8.0), (199, 16.0)] {
            sums.add(number, Vec3A::splat(light));
        }
        let mut taken = Vec::new();
        sums.drain(|number, light| taken.push((number, light.x)));
        assert_eq!(taken, [(3, 10.0), (64, 4.0), (130, 1.0), (199, 16.0)]);
        sums.drain(|number, _| panic!("{number} was taken before"));
        // `begin` discards sums that were not drained.
        sums.add(5, Vec3A::ONE);
        sums.begin(10);
        sums.drain(|number, _| panic!("{number} was forgotten"));
    }
}
