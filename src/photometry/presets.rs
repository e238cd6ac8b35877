//! What EN 12464-1:2011 asks of common rooms: maintained illuminance, glare, uniformity and colour rendering (tables 5.1 to
//! 5.53), and of the surfaces around (4.3). An excerpt for design; the standard itself is what counts.

/// What a place should have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    pub name: &'static str,
    /// Least mean illuminance of the task area, in lux.
    pub illuminance: f64,
    /// Largest unified glare rating.
    pub glare: f64,
    /// Least uniformity: smallest over mean illuminance of the task area.
    pub uniformity: f64,
    /// Least colour rendering index.
    pub rendering: f64,
}

const fn preset(name: &'static str, illuminance: f64, glare: f64, uniformity: f64, rendering: f64) -> Preset {
    Preset { name, illuminance, glare, uniformity, rendering }
}

pub const PRESETS: &[Preset] = &[
    preset("circulation areas and corridors", 100.0, 28.0, 0.4, 40.0),
    preset("stairs", 100.0, 25.0, 0.4, 40.0),
    preset("rest rooms", 100.0, 22.0, 0.4, 80.0),
    preset("office: filing, copying", 300.0, 19.0, 0.4, 80.0),
    preset("office: writing, reading, data processing", 500.0, 19.0, 0.6, 80.0),
    preset("office: technical drawing", 750.0, 16.0, 0.7, 80.0),
    preset("office: conference and meeting rooms", 500.0, 19.0, 0.6, 80.0),
    preset("office: reception desk", 300.0, 22.0, 0.6, 80.0),
    preset("office: archives", 200.0, 25.0, 0.4, 80.0),
    preset("retail: sales area", 300.0, 22.0, 0.4, 80.0),
    preset("retail: till area", 500.0, 19.0, 0.6, 80.0),
    preset("restaurant: kitchen", 500.0, 22.0, 0.6, 80.0),
    preset("library: reading areas", 500.0, 19.0, 0.6, 80.0),
    preset("library: bookshelves", 200.0, 19.0, 0.6, 80.0),
    preset("school: classrooms", 300.0, 19.0, 0.6, 80.0),
    preset("school: adult education", 500.0, 19.0, 0.6, 80.0),
    preset("school: lecture halls", 500.0, 19.0, 0.6, 80.0),
    preset("school: sports halls", 300.0, 22.0, 0.6, 80.0),
];

/// Least mean illuminance in lux of walls and ceilings of offices, schools and hospitals, and the uniformity of both.
pub const WALLS: f64 = 75.0;
pub const CEILING: f64 = 50.0;
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

    /// Least illuminance of the area around the task (table 1), in lux.
    pub fn surrounding(&self) -> f64 {
        match self.illuminance {
            e if e >= 750.0 => 500.0,
            e if e >= 500.0 => 300.0,
            e if e >= 300.0 => 200.0,
            e if e >= 200.0 => 150.0,
            e => e,
        }
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
        assert_eq!((desk.illuminance, desk.surrounding()), (500.0, 300.0));
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
