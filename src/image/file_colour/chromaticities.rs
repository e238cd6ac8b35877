//! Primaries and white point of a colour space, and the matrix that converts its linear colours to linear Rec.709.

use glam::{DMat3, DVec3};

/// The chromaticity coordinates (x, y) of the primaries and of white (CIE 15:2018).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chromaticities {
    pub primaries: [[f64; 2]; 3],
    pub white: [f64; 2],
}

/// Matrix from CIE XYZ to Bradford cone responses (Lam 1985; ICC.1:2022, annex E). [convention: ICC]
const BRADFORD: DMat3 = DMat3::from_cols(
    DVec3::new(0.8951, -0.7502, 0.0389),
    DVec3::new(0.2664, 1.7135, -0.0685),
    DVec3::new(-0.1614, 0.0367, 1.0296),
);

/// CIE XYZ of the white in the profile connection space of ICC (ICC.1:2022, 7.2.16). [convention: ICC]
const D50: DVec3 = DVec3::new(0.9642, 1.0, 0.8249);

/// A matrix counts as the identity if every element deviates from the identity by less than this value. Files store
/// chromaticities with four digits, and ICC profiles store their matrix columns with 16 bits. [rounding]
const SAME: f64 = 1e-3;

/// A matrix with a larger element is refused: its primaries lie almost on one line. [convention]
const MAX_ELEMENT: f64 = 1e3;

impl Chromaticities {
    /// Recommendation ITU-R BT.709-6. \[convention\]
    pub const REC709: Self = Self { primaries: [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]], white: [0.3127, 0.3290] };

    /// Adobe RGB (1998), 4.3.1.1. \[convention\]
    pub const ADOBE_RGB: Self = Self { primaries: [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]], white: [0.3127, 0.3290] };

    /// Returns the chromaticities of a code point for primaries (Recommendation ITU-T H.273, table 2); `None` if the
    /// code point is unknown.
    pub fn of_code(code: u8) -> Option<Self> {
        // [convention: Recommendation ITU-T H.273]
        const D65: [f64; 2] = Chromaticities::REC709.white;
        const C: [f64; 2] = [0.310, 0.316];
        let (primaries, white) = match code {
            1 => return Some(Self::REC709),
            4 => ([[0.67, 0.33], [0.21, 0.71], [0.14, 0.08]], C),
            5 => ([[0.64, 0.33], [0.29, 0.60], [0.15, 0.06]], D65),
            6 | 7 => ([[0.630, 0.340], [0.310, 0.595], [0.155, 0.070]], D65),
            8 => ([[0.681, 0.319], [0.243, 0.692], [0.145, 0.049]], C),
            9 => ([[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]], D65),
            10 => ([[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]], [1.0 / 3.0, 1.0 / 3.0]),
            11 => ([[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]], [0.314, 0.351]),
            12 => ([[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]], D65),
            22 => ([[0.630, 0.340], [0.295, 0.605], [0.155, 0.077]], D65),
            _ => return None,
        };
        Some(Self { primaries, white })
    }

    /// Returns the matrix from linear colours in these primaries to linear Rec.709. It maps white to white. `None` if
    /// the primaries are collinear.
    pub fn to_rec709(self) -> Option<DMat3> {
        self.to_rec709_from_white(self.white)
    }

    /// Returns the matrix from linear colours in these primaries to linear Rec.709. It maps colours of the chromaticity
    /// `white` to white, even if (1, 1, 1) has another chromaticity. `None` if the primaries are collinear.
    pub fn to_rec709_from_white(self, white: [f64; 2]) -> Option<DMat3> {
        let target = Self::REC709;
        let matrix = target.to_xyz()?.inverse() * adaptation(xyz(white)?, xyz(target.white)?) * self.to_xyz()?;
        usable(matrix)
    }

    /// Returns the matrix from linear colours to CIE XYZ. The Y of (1, 1, 1) is 1. `None` if the primaries are
    /// collinear.
    fn to_xyz(self) -> Option<DMat3> {
        let [r, g, b] = self.primaries.map(|[x, y]| DVec3::new(x, y, 1.0 - x - y));
        let primaries = DMat3::from_cols(r, g, b);
        if !(primaries.determinant().abs() > 1e-9) {
            return None;
        }
        let amounts = primaries.inverse() * xyz(self.white)?;
        Some(primaries * DMat3::from_diagonal(amounts))
    }
}

/// Returns the matrix to linear Rec.709 for primaries given by their CIE XYZ under D50, as in ICC profiles.
pub fn of_colorants(colorants: DMat3) -> Option<DMat3> {
    let target = Chromaticities::REC709;
    let to_pcs = adaptation(xyz(target.white)?, D50) * target.to_xyz()?;
    let matrix = usable(to_pcs.inverse() * colorants)?;
    // The colorants of a profile are rounded, so their sum is not exactly white. If it is white within [`SAME`], scale
    // the rounding error away, so that greys stay grey.
    let white = matrix * DVec3::ONE;
    let is_white = (white - DVec3::ONE).abs().max_element() < SAME;
    Some(if is_white { DMat3::from_diagonal(white.recip()) * matrix } else { matrix })
}

/// Whether a matrix is the identity within the precision with which files store colour spaces.
pub fn is_identity(matrix: DMat3) -> bool {
    (matrix - DMat3::IDENTITY).to_cols_array().iter().all(|v| v.abs() < SAME)
}

fn usable(matrix: DMat3) -> Option<DMat3> {
    matrix.to_cols_array().iter().all(|v| v.abs() < MAX_ELEMENT).then_some(matrix)
}

/// Returns the CIE XYZ of a chromaticity, with Y = 1.
fn xyz([x, y]: [f64; 2]) -> Option<DVec3> {
    (x.is_finite() && y > 0.0).then(|| DVec3::new(x, y, 1.0 - x - y) / y)
}

/// Returns the matrix that adapts CIE XYZ from one white to another (Bradford).
fn adaptation(from: DVec3, to: DVec3) -> DMat3 {
    let gain = (BRADFORD * to) / (BRADFORD * from);
    BRADFORD.inverse() * DMat3::from_diagonal(gain) * BRADFORD
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(matrix: DMat3, rows: [[f64; 3]; 3]) {
        for (row, wanted) in rows.into_iter().enumerate() {
            assert!((matrix.row(row) - DVec3::from(wanted)).abs().max_element() < 2e-4, "{matrix}");
        }
    }

    #[test]
    fn matrices_meet_published_ones() {
        // Display P3 to sRGB, as in CSS Color 4.
        assert_near(
            Chromaticities::of_code(12).unwrap().to_rec709().unwrap(),
            [[1.224940, -0.224940, 0.0], [-0.042057, 1.042057, 0.0], [-0.019638, -0.078636, 1.098274]],
        );
        // BT.2020 to BT.709, as in Recommendation ITU-R BT.2087-0.
        assert_near(
            Chromaticities::of_code(9).unwrap().to_rec709().unwrap(),
            [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]],
        );
        // Code point 10 stands for CIE XYZ, with the white (1, 1, 1). Check that `to_rec709` maps this white to white.
        // With D65 as white, compare with the published matrix from CIE XYZ to Rec.709.
        let xyz = Chromaticities::of_code(10).unwrap();
        assert!((xyz.to_rec709().unwrap() * DVec3::ONE - DVec3::ONE).abs().max_element() < 1e-9);
        assert_near(
            xyz.to_rec709_from_white([0.3127, 0.3290]).unwrap(),
            [[3.240970, -1.537383, -0.498611], [-0.969244, 1.875968, 0.041555], [0.055630, -0.203977, 1.056972]],
        );
        assert!(is_identity(Chromaticities::REC709.to_rec709().unwrap()));
    }

    #[test]
    fn primaries_without_area_are_refused() {
        let line = Chromaticities { primaries: [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]], ..Chromaticities::REC709 };
        let dark = Chromaticities { white: [0.3, 0.0], ..Chromaticities::REC709 };
        let lost = Chromaticities { white: [f64::NAN, 0.3], ..Chromaticities::REC709 };
        assert!([line, dark, lost].iter().all(|c| c.to_rec709().is_none()));
    }
}
