//! Sheets of paper that are bent or crumpled, seen by a camera whose lens distorts: the exact map from the page to a
//! simulated photo. The bench `constants` includes this file too, so it uses only glam and the standard library.

use glam::{DMat2, DMat3, DVec2, DVec3};

/// How the curvature of the paper depends on the place across its generators, from -1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Profile {
    /// Constant curvature.
    Arc,
    /// Flat on one side, and more and more bent on the other.
    Curl,
    /// Bent to one side, then to the other.
    Wave,
}

/// What distinguishes a photo from one of a flat sheet by an ideal lens.
#[derive(Clone, Copy, Debug)]
pub struct Defects {
    pub profile: Profile,
    /// Height of the bent paper above the plane through its borders, as a share of the page's longer side.
    pub bow: f64,
    /// Angle across the generators against the page's x axis.
    pub angle: f64,
    /// Displacement in the corners of the photo towards its centre, as a share of their distance; and a part of it that
    /// grows with the fifth power of the distance, not with the third.
    pub barrel: [f64; 2],
    /// Standard deviation of random smooth relief, and the length over which it changes, as shares of the page's longer
    /// side.
    pub relief: [f64; 2],
}

pub const NONE: Defects = Defects { profile: Profile::Arc, bow: 0.0, angle: 0.0, barrel: [0.0; 2], relief: [0.0, 0.3] };

/// Numbers without pattern (SplitMix64).
pub struct Numbers(pub u64);

impl Numbers {
    /// A number from 0 to 1.
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    /// Noise with standard deviation 1; faster than [`Self::normal`].
    pub fn noise(&mut self) -> f64 {
        12.0f64.sqrt() * (self.uniform() - 0.5)
    }

    pub fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().max(1e-12).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

const STEPS: usize = 800;
const WAVES: usize = 60;

/// A photo of a sheet.
pub struct View {
    defects: Defects,
    page: DVec2,
    photo: DVec2,
    /// Places across the generators and heights of the bent paper, at equal steps along it.
    curve: Vec<DVec2>,
    length: f64,
    waves: Vec<(DVec2, f64)>,
    turn: DMat3,
    focal: f64,
    distance: f64,
}

impl View {
    /// A view of a page of `page` pixels that fills a photo of `photo` pixels. Tilt, direction and focal length follow
    /// from the seed; `max_tilt` is in degrees.
    pub fn new(page: DVec2, photo: DVec2, defects: Defects, max_tilt: f64, seed: u64) -> Self {
        let mut numbers = Numbers(seed);
        let tilt = (0.1 + 0.9 * numbers.uniform()) * max_tilt.to_radians();
        let about = DVec2::from_angle(std::f64::consts::TAU * numbers.uniform()).extend(0.0);
        let upright = if (page.x > page.y) == (photo.x > photo.y) { 0.0 } else { std::f64::consts::FRAC_PI_2 };
        let turn = DMat3::from_rotation_z(upright + 0.4 * (numbers.uniform() - 0.5));
        let turn = turn * DMat3::from_axis_angle(about, tilt);
        let focal = photo.max_element() * (0.75 + 0.45 * numbers.uniform());
        let waves = (0..WAVES)
            .map(|_| {
                let along = DVec2::new(numbers.normal(), numbers.normal());
                (along / (defects.relief[1] * page.max_element()), std::f64::consts::TAU * numbers.uniform())
            })
            .collect();
        let axis = DVec2::from_angle(defects.angle);
        let length = axis.abs().dot(page);
        let side = if numbers.uniform() < 0.5 { -1.0 } else { 1.0 };
        let curve = bent(defects.profile, side * defects.bow * page.max_element(), length);
        let mut view = Self { defects, page, photo, curve, length, waves, turn, focal, distance: 0.0 };
        let (mut near, mut far) = (0.2 * page.min_element(), 20.0 * page.max_element());
        for _ in 0..50 {
            view.distance = 0.5 * (near + far);
            if view.is_inside() { far = view.distance } else { near = view.distance }
        }
        view.distance = far;
        view
    }

    fn is_inside(&self) -> bool {
        let margin = 0.03 * self.photo;
        let border = (0..=8).flat_map(|i| {
            let t = f64::from(i) / 8.0;
            [DVec2::new(t, 0.0), DVec2::new(t, 1.0), DVec2::new(0.0, t), DVec2::new(1.0, t)]
        });
        border
            .map(|share| self.photo(share * self.page))
            .all(|p| p.cmpgt(margin).all() && p.cmplt(self.photo - margin).all())
    }

    /// Maps a pixel of the page to a pixel of the photo; NaN behind the camera.
    pub fn photo(&self, page: DVec2) -> DVec2 {
        let p = page - 0.5 * self.page;
        let axis = DVec2::from_angle(self.defects.angle);
        let place = ((axis.dot(p) / self.length + 0.5) * STEPS as f64).clamp(-1e3, STEPS as f64 + 1e3);
        let first = place.clamp(0.0, (STEPS - 1) as f64) as usize;
        let on_curve = self.curve[first].lerp(self.curve[first + 1], place - first as f64);
        let height = self.defects.relief[0] * self.page.max_element() * (2.0 / WAVES as f64).sqrt();
        let waves = if height == 0.0 { &[] } else { self.waves.as_slice() };
        let relief = height * waves.iter().map(|(along, phase)| (along.dot(p) + phase).cos()).sum::<f64>();
        let flat = on_curve.x * axis + axis.perp_dot(p) * axis.perp();
        let q = self.turn * flat.extend(on_curve.y + relief) + DVec3::new(0.0, 0.0, self.distance);
        if q.z <= 0.05 * self.distance {
            return DVec2::NAN;
        }
        let ideal = self.focal * q.truncate() / q.z;
        let squared = ideal.length_squared() / (0.25 * self.photo.length_squared());
        let [third, fifth] = self.defects.barrel;
        0.5 * self.photo + ideal * (1.0 - third * squared - fifth * squared * squared)
    }

    /// The derivative of [`Self::photo`].
    pub fn derivative(&self, page: DVec2) -> DMat2 {
        let along = |step: DVec2| self.photo(page + step) - self.photo(page - step);
        DMat2::from_cols(along(0.5 * DVec2::X), along(0.5 * DVec2::Y))
    }

    /// Maps a pixel of the photo to a pixel of the page (Newton's method). Pixels that do not show the page may get any
    /// place outside it.
    pub fn page(&self, photo: DVec2) -> DVec2 {
        let mut page = 0.5 * self.page;
        for _ in 0..40 {
            let step = self.derivative(page).inverse() * (photo - self.photo(page));
            if !step.is_finite() {
                page = page.lerp(0.5 * self.page, 0.5);
                continue;
            }
            let limit = 0.2 * self.page.max_element();
            page += step * (limit / step.length().max(limit));
            page = page.clamp(-0.5 * self.page, 1.5 * self.page);
            if step.length() < 1e-6 {
                break;
            }
        }
        page
    }
}

/// Returns the curve of paper of the given length: its points at equal steps along it.
fn bent(profile: Profile, height: f64, length: f64) -> Vec<DVec2> {
    let curvature = |i: usize| {
        let t = 2.0 * i as f64 / STEPS as f64 - 1.0;
        match profile {
            Profile::Arc => 1.0,
            Profile::Curl => t.max(0.0),
            Profile::Wave => t,
        }
    };
    let step = length / STEPS as f64;
    let curve = |strength: f64| {
        let mut angles = vec![0.0];
        for i in 0..STEPS {
            angles.push(angles[i] + strength * step * 0.5 * (curvature(i) + curvature(i + 1)));
        }
        let middle = angles[STEPS / 2];
        let mut points = vec![DVec2::ZERO];
        for i in 0..STEPS {
            points.push(points[i] + step * DVec2::from_angle(0.5 * (angles[i] + angles[i + 1]) - middle));
        }
        let centre = points[STEPS / 2];
        points.into_iter().map(|p| p - centre).collect::<Vec<DVec2>>()
    };
    let rise = |points: &[DVec2]| {
        let chord = points[STEPS] - points[0];
        let above = |p: &DVec2| chord.perp_dot(*p - points[0]) / chord.length();
        let heights: Vec<f64> = points.iter().map(above).collect();
        heights.iter().copied().fold(0.0, f64::max) - heights.iter().copied().fold(0.0, f64::min)
    };
    if height == 0.0 {
        return curve(0.0);
    }
    let mut strength = 1e-3 / length;
    for _ in 0..8 {
        strength *= height.abs() / rise(&curve(strength));
    }
    curve(strength * height.signum())
}
