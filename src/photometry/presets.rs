//! Requirements of EN 12464-1 for common rooms: maintained illuminance, glare, uniformity, colour rendering, and
//! illuminance of walls and ceilings.
//!
//! This is a short excerpt for design. Luminaire manufacturers quote these values publicly, and each row states its
//! edition of the standard. The rows of schools and libraries are from the tables of 2021, as quoted by Glamox. The
//! rows of offices have 500 lx with U0 0.6, and 300 lx with U0 0.4, as quoted by Trilux, Fagerhult and Performance in
//! Lighting; their walls and ceilings are from the edition of 2011. Only the standard itself is authoritative.

use std::ffi::CStr;

/// The requirements for one type of room or activity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    pub name: &'static CStr,
    /// Year of the standard's edition.
    pub edition: u32,
    /// Minimum mean illuminance of the task area, in lux.
    pub illuminance: f64,
    /// Maximum unified glare rating.
    pub glare: f64,
    /// Minimum uniformity U0 of the task area: minimum over mean illuminance.
    pub uniformity: f64,
    /// Minimum general colour rendering index Ra.
    pub rendering: f64,
    /// Minimum mean illuminance of walls and of the ceiling, in lux, with a uniformity of at least 0.1 (EN 12464-1); 0
    /// if there is no requirement.
    pub walls: f64,
    pub ceiling: f64,
}

const fn preset(name: &'static CStr, edition: u32, task: [f64; 4], surround: [f64; 2]) -> Preset {
    let [illuminance, glare, uniformity, rendering] = task;
    let [walls, ceiling] = surround;
    Preset { name, edition, illuminance, glare, uniformity, rendering, walls, ceiling }
}

/// The rooms and activities, each with its requirements. \[convention: EN 12464-1\]
pub const PRESETS: &[Preset] = &[
    preset(c"office: writing, reading, data processing", 2011, [500.0, 19.0, 0.6, 80.0], [75.0, 50.0]),
    preset(c"office: filing, copying", 2011, [300.0, 19.0, 0.4, 80.0], [75.0, 50.0]),
    preset(c"school: entrance halls", 2021, [200.0, 22.0, 0.4, 80.0], [75.0, 50.0]),
    preset(c"school: circulation areas, corridors", 2021, [100.0, 25.0, 0.4, 80.0], [50.0, 30.0]),
    preset(c"school: stairs", 2021, [150.0, 25.0, 0.4, 80.0], [50.0, 30.0]),
    preset(c"library: bookshelves", 2021, [200.0, 19.0, 0.6, 80.0], [0.0, 0.0]),
    preset(c"library: reading areas", 2021, [500.0, 19.0, 0.6, 80.0], [100.0, 50.0]),
];

/// A requirement that is not met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortfall {
    Illuminance,
    Uniformity,
    Glare,
}

impl Preset {
    /// Returns the preset with the given name.
    pub fn find(name: &str) -> Option<&'static Self> {
        PRESETS.iter().find(|p| p.name.to_bytes() == name.as_bytes())
    }

    /// Returns the requirements that a task area fails, given its minimum and mean illuminance in lux and its glare
    /// rating. An unknown glare rating (`None`) counts as met.
    pub fn check(&self, minimum: f64, mean: f64, glare: Option<f64>) -> Vec<Shortfall> {
        let bright = mean >= self.illuminance;
        let even = mean > 0.0 && minimum / mean >= self.uniformity;
        let calm = glare.is_none_or(|g| g <= self.glare);
        let all = [(bright, Shortfall::Illuminance), (even, Shortfall::Uniformity), (calm, Shortfall::Glare)];
        all.into_iter().filter(|(good, _)| !good).map(|(_, what)| what).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_office_desk_is_checked() {
        let desk = Preset::find("office: writing, reading, data processing").unwrap();
        assert_eq!(desk.illuminance, 500.0);
        assert_eq!(desk.check(320.0, 520.0, Some(18.0)), []);
        assert_eq!(desk.check(320.0, 520.0, None), []);
        assert_eq!(
            desk.check(100.0, 400.0, Some(22.0)),
            [Shortfall::Illuminance, Shortfall::Uniformity, Shortfall::Glare]
        );
        assert_eq!(desk.check(0.0, 0.0, None), [Shortfall::Illuminance, Shortfall::Uniformity]);
        assert_eq!(Preset::find("the moon"), None);
        // Names are unique.
        assert!(PRESETS.iter().all(|p| PRESETS.iter().filter(|q| q.name == p.name).count() == 1));
    }
}
