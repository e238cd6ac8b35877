//! What EN 12464-1 asks of common rooms: maintained illuminance, glare, uniformity and colour rendering, and illuminance of
//! walls and ceilings.
//!
//! A short excerpt for design, of what makers of luminaires quote of the standard in public, each with its edition: the rows
//! of schools and libraries as Glamox quotes the tables of 2021; offices by what Trilux, Fagerhult and Performance in
//! Lighting say of 500 lx, U0 0.6, and of 300 lx, U0 0.4, with walls and ceilings of the edition of 2011. The standard itself is
//! what counts.

/// What a place should have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    pub name: &'static str,
    /// Year of the edition.
    pub edition: u32,
    /// Least mean illuminance of the task area, in lux.
    pub illuminance: f64,
    /// Largest unified glare rating.
    pub glare: f64,
    /// Least uniformity U0: smallest over mean illuminance of the task area.
    pub uniformity: f64,
    /// Least colour rendering index.
    pub rendering: f64,
    /// Least mean illuminance of walls and of the ceiling, in lux, with a uniformity of [`SURROUND_UNIFORMITY`]; 0 where
    /// none is asked for.
    pub walls: f64,
    pub ceiling: f64,
}

const fn preset(name: &'static str, edition: u32, task: [f64; 4], surround: [f64; 2]) -> Preset {
    let [illuminance, glare, uniformity, rendering] = task;
    let [walls, ceiling] = surround;
    Preset { name, edition, illuminance, glare, uniformity, rendering, walls, ceiling }
}

pub const PRESETS: &[Preset] = &[
    preset("office: writing, reading, data processing", 2011, [500.0, 19.0, 0.6, 80.0], [75.0, 50.0]),
    preset("office: filing, copying", 2011, [300.0, 19.0, 0.4, 80.0], [75.0, 50.0]),
    preset("school: entrance halls", 2021, [200.0, 22.0, 0.4, 80.0], [75.0, 50.0]),
    preset("school: circulation areas, corridors", 2021, [100.0, 25.0, 0.4, 80.0], [50.0, 30.0]),
    preset("school: stairs", 2021, [150.0, 25.0, 0.4, 80.0], [50.0, 30.0]),
    preset("library: bookshelves", 2021, [200.0, 19.0, 0.6, 80.0], [0.0, 0.0]),
    preset("library: reading areas", 2021, [500.0, 19.0, 0.6, 80.0], [100.0, 50.0]),
];

/// Least uniformity of walls and ceilings.
pub const SURROUND_UNIFORMITY: f64 = 0.1;

/// What is amiss of a preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortfall {
    Illuminance,
    Uniformity,
    Glare,
}

impl Preset {
    /// The preset of a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        PRESETS.iter().find(|p| p.name == name)
    }

    /// What a task area of this least and mean illuminance, seen with this glare rating (if it is known), falls short of.
    pub fn check(&self, least: f64, mean: f64, glare: Option<f64>) -> Vec<Shortfall> {
        let bright = mean >= self.illuminance;
        let even = mean > 0.0 && least / mean >= self.uniformity;
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
