//! The pattern of lights on the surface: size, rotation, offset, and margins without lamps.

use crate::emission::Scale;
use crate::error::{Result, check_range};
use glam::DVec2;
use std::f64::consts::TAU;

/// Size, rotation, offset and margin of the pattern on the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    pub scale: Scale,
    /// Metres per texel, in `[0, 1e6]`. 0 means the size of an unwarped pixel or, if the texture would then have more
    /// than `max_texels` along a side, the smallest size that keeps to this limit.
    pub texel_size: f64,
    /// Rotation of the pattern from the surface's u axis towards v, in radians, in `[-2π, 2π]`.
    pub rotation: f64,
    /// Shift of the pattern along its own axes in metres, each component in `[-1e6, 1e6]`.
    pub offset: DVec2,
    /// Minimum distance in metres, in `[-1, 1e6]`, between a lamp and the surface's edge or a keep-out zone
    /// ([`super::Input::zones`]). Lamps that are closer are removed. If the margin is negative, lamps may cross the
    /// surface's edge and are cut off there.
    pub margin: f64,
}

impl Default for Pattern {
    fn default() -> Self {
        Self { scale: Scale::Distance, texel_size: 0.0, rotation: 0.0, offset: DVec2::ZERO, margin: -1.0 }
    }
}

impl Pattern {
    pub(super) fn check(&self) -> Result<()> {
        match self.scale {
            Scale::Distance | Scale::Across => {}
            Scale::Lamp(length) => drop(check_range("pattern.lamp_length", length, 1e-6, 1e6)?),
            Scale::Spacing(length) => drop(check_range("pattern.spacing", length, 1e-6, 1e6)?),
        }
        check_range("pattern.texel_size", self.texel_size, 0.0, 1e6)?;
        check_range("pattern.rotation", self.rotation, -TAU, TAU)?;
        check_range("pattern.offset.u", self.offset.x, -1e6, 1e6)?;
        check_range("pattern.offset.v", self.offset.y, -1e6, 1e6)?;
        check_range("pattern.margin", self.margin, -1.0, 1e6)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_out_of_range_are_named() {
        let wrong = |change: &dyn Fn(&mut Pattern)| {
            let mut pattern = Pattern::default();
            change(&mut pattern);
            pattern.check().unwrap_err().message
        };
        assert!(wrong(&|p| p.scale = Scale::Lamp(0.0)).contains("pattern.lamp_length is 0"));
        assert!(wrong(&|p| p.scale = Scale::Spacing(f64::NAN)).contains("pattern.spacing is NaN"));
        assert!(wrong(&|p| p.rotation = 7.0).contains("pattern.rotation is 7"));
        assert!(wrong(&|p| p.offset.y = f64::INFINITY).contains("pattern.offset.v is inf"));
        assert!(wrong(&|p| p.margin = -2.0).contains("pattern.margin is -2"));
    }
}
