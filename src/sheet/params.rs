//! The settings of a sheet.

use crate::error::{Result, check_range};
use glam::DVec2;

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the paper in millimetres, each in `[60, 2000]`.
    pub paper: DVec2,
    /// Dots per inch of the printed sheet, in `[20, 1200]`.
    pub dpi: f64,
    /// Contrast of the printed picture, in `[0, 1]`; 1 prints it unchanged.
    pub contrast: f32,
    /// Distance of the marks from the edge of the paper in millimetres, in `[0, 50]`: printers need a margin.
    pub margin: f64,
    /// Whether to remove uneven illumination from the photo.
    pub even_light: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self { paper: DVec2::new(297.0, 210.0), dpi: 300.0, contrast: 0.25, margin: 8.0, even_light: true }
    }
}

impl Params {
    /// Checks that every setting is in its range.
    pub(super) fn check(&self) -> Result<()> {
        check_range("paper_width", self.paper.x, 60.0, 2000.0)?;
        check_range("paper_height", self.paper.y, 60.0, 2000.0)?;
        check_range("dpi", self.dpi, 20.0, 1200.0)?;
        check_range("contrast", self.contrast, 0.0, 1.0)?;
        check_range("margin", self.margin, 0.0, 50.0)?;
        Ok(())
    }
}
