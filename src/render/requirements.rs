//! Static analysis of a scene before tracing: which kinds of scattering and which lights can occur, and how much light
//! a bounce can reflect or transmit at most.
//!
//! The analysis multiplies each factor of a material with the smallest and the largest texel of the factor's texture.
//! Only materials of meshes with triangles count. Tracing skips features that cannot occur, which changes no estimate.
//! The number of bounces that carry nearly all light ([`Requirements::bounces`]) is only reported: paths end by Russian
//! roulette, not after this number of bounces.

use super::bsdf::BsdfParams;
use super::clear_coat::CoatParams;
use super::compiled_material::{self, CompiledMaterial, PointValues, SolidParams};
use super::ggx::{self, AlbedoTable, MIRROR_ROUGHNESS};
use super::medium;
use crate::maths;
use crate::scene::{AlphaMode, Environment, Material, Mesh, PunctualLight, Scene, TextureRef};
use glam::{Vec3, Vec4};

/// The shading features that a scene requires.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Requirements {
    /// Whether each kind of scattering can occur: diffuse, glossy, mirror.
    pub diffuse: bool,
    pub glossy: bool,
    pub mirror: bool,
    /// Whether the scene has clear panes.
    pub glass: bool,
    /// Whether the scene has solid glass, which refracts.
    pub refraction: bool,
    /// Whether a surface has a clear coat.
    pub clear_coat: bool,
    /// Whether a surface has an opacity below 1.
    pub alpha: bool,
    pub normal_maps: bool,
    /// For each kind of light, whether the scene has a light of this kind that emits. `textured_surfaces` tells whether
    /// the emission of a surface varies with a texture. Luminaires with faces count as surfaces, luminaires without
    /// faces as points.
    pub surfaces: bool,
    pub textured_surfaces: bool,
    pub points: bool,
    pub spots: bool,
    pub directional: bool,
    /// Whether a directional light with parallel rays emits, rather than a disc like the sun's.
    pub parallel: bool,
    pub environment: bool,
    /// Number of textures that make scattering or emission vary over a surface (`textures`), and number of all textures
    /// of the scene (`textures_given`).
    pub textures: usize,
    pub textures_given: usize,
    /// Upper bound of the albedo of all surfaces, per channel. The albedo includes diffuse, glossy and transmitted
    /// light.
    pub albedo: Vec3,
    /// Index of the material with the largest albedo bound.
    pub brightest: Option<usize>,
    /// Number of degenerate triangles, which no ray can hit.
    pub flat_triangles: usize,
    /// Number of closed transparent meshes whose material has no thickness (`solids`), and index of the first of them.
    /// They are rendered as thin panes.
    pub solids: usize,
    pub first_solid: Option<usize>,
    /// Number of meshes of solid glass that are not closed (`open_solids`), and index of the first of them.
    pub open_solids: usize,
    pub first_open_solid: Option<usize>,
    /// Index of the first mesh of solid glass whose front sides face inwards.
    pub inverted_solid: Option<usize>,
    /// Index of the first material of thin panes that is rough. Frosted panes are not modelled.
    pub frosted: Option<usize>,
}

impl Requirements {
    /// Returns the number of bounces after which at most the share `error` of all scattered light remains. `None` if
    /// `error` is not positive, or if the largest channel of `albedo` is 1 or more.
    ///
    /// Let `a` be the largest channel of `albedo`: no surface reflects or transmits a larger share of light. So each
    /// bounce carries at most `a` times the flux of the previous bounce, and less in open scenes. If each bounce
    /// carries exactly `a` times the flux of the previous one, the share of the flux that comes after `n` bounces is
    /// a^n; otherwise it is smaller. This bounds the loss of flux in the whole scene. An image may lose more if it
    /// shows only a part of the scene that is lit by many bounces.
    pub fn bounces(&self, error: f32) -> Option<u32> {
        let a = f64::from(self.albedo.max_element());
        if !(error > 0.0 && a < 1.0) {
            return None;
        }
        if a == 0.0 || error >= 1.0 {
            return Some(1);
        }
        Some((maths::ln(f64::from(error)) / maths::ln(a)).ceil().clamp(1.0, f64::from(u32::MAX)) as u32)
    }

    /// Returns one sentence for each shading feature that the scene does not need and tracing therefore omits, and one
    /// for each feature of the scene that the renderer does not model.
    pub fn left_out(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        let mut unless = |present: bool, sentence: &str| {
            if !present {
                sentences.push(sentence.to_string());
            }
        };
        unless(self.glossy || self.mirror, "No surface has a reflecting layer: only diffuse scattering is evaluated.");
        unless(self.glossy || !self.mirror, "Reflecting layers are perfect mirrors: no rough reflection is evaluated.");
        unless(self.mirror || !self.glossy, "No reflecting layer is a perfect mirror.");
        unless(self.diffuse, "No surface scatters diffusely.");
        unless(self.glass || self.refraction, "Nothing is transparent: no light passes through surfaces.");
        unless(self.alpha, "No surface is partly absent: rays do not ask for the opacity of what they hit.");
        unless(self.glass || self.alpha, "Shadow rays end at the first surface they meet.");
        unless(self.normal_maps, "No texture bends normals: tangents are not computed.");
        unless(self.surfaces, "No surface emits.");
        unless(self.textured_surfaces || !self.surfaces, "Surfaces emit evenly: no texture is sampled for light.");
        unless(self.points || self.spots || self.directional, "There are no punctual lights.");
        unless(self.environment, "The environment is dark: rays that leave the scene end there.");
        if self.textures < self.textures_given {
            let idle = self.textures_given - self.textures;
            sentences.push(format!("{idle} of {} textures vary nothing and are not looked up.", self.textures_given));
        }
        if self.flat_triangles > 0 {
            sentences.push(format!("{} triangles have no area: no ray meets them.", self.flat_triangles));
        }
        if let Some(first) = self.first_solid {
            let meshes = named_meshes(self.solids, first);
            sentences.push(format!(
                "{meshes} closed and transparent, of a material without thickness: light goes straight on through, and \
                 is not bent."
            ));
        }
        if self.clear_coat {
            sentences
                .push("Clear coats reflect, but do not absorb, and no light goes back and forth below them.".into());
        }
        self.name_limits_of_solids(&mut sentences);
        if let Some(material) = self.frosted {
            let what = "transparent and rough: light goes straight on through, and is not scattered";
            sentences.push(format!("Material {material} is {what}."));
        }
        sentences
    }
}

impl Requirements {
    /// Adds sentences about solid glass that is not closed, and about light that does not find its way through.
    fn name_limits_of_solids(&self, sentences: &mut Vec<String>) {
        if let Some(first) = self.first_open_solid {
            let meshes = named_meshes(self.open_solids, first);
            sentences.push(format!("{meshes} solid glass but not closed: where light leaves, it is not clear."));
        }
        if let Some(mesh) = self.inverted_solid {
            let what = "solid glass with its front sides inwards";
            sentences.push(format!("Mesh {mesh} is {what}: light is bent as if glass were outside and air inside."));
        }
        if self.refraction && (self.points || self.spots || self.parallel) {
            let what = "Solid glass casts a black shadow of lights without a size (points, spots, parallel light)";
            sentences.push(format!("{what}: their refracted light is left out."));
        }
        let has_discs = self.directional && !self.parallel;
        if self.refraction && (self.surfaces || self.environment || has_discs) {
            let what = "No light is sampled through solid glass";
            sentences.push(format!(
                "{what}: only paths that happen to meet a lamp, the sky or the sun behind it bring light."
            ));
        }
    }
}

/// Returns the subject and the verb of a sentence about `count` meshes, the first of which has the index `first`.
fn named_meshes(count: usize, first: usize) -> String {
    match count {
        1 => format!("Mesh {first} is"),
        count => format!("{count} meshes, the first of them mesh {first}, are"),
    }
}

/// Smallest and largest value of each channel.
#[derive(Clone, Copy)]
struct Range {
    low: Vec4,
    high: Vec4,
}

impl Range {
    const ONE: Self = Self { low: Vec4::ONE, high: Vec4::ONE };

    fn is_constant(&self) -> bool {
        self.low == self.high
    }

    /// Returns the range of the products of a value in `self` and a value in `other`.
    fn times(&self, other: &Self) -> Self {
        let products = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        Self {
            low: products.into_iter().fold(Vec4::INFINITY, Vec4::min),
            high: products.into_iter().fold(Vec4::NEG_INFINITY, Vec4::max),
        }
    }

    /// Extends the range to include a value.
    fn include(&mut self, value: Vec4) {
        self.low = self.low.min(value);
        self.high = self.high.max(value);
    }
}

/// Analyses a validated scene. Returns its requirements and its compiled materials.
pub fn analyse(scene: &Scene, table: Option<&AlbedoTable>) -> (Requirements, Vec<CompiledMaterial>) {
    let ranges: Vec<Range> = scene.textures.iter().map(|t| range_of(&t.image)).collect();
    let range = |t: &Option<TextureRef>| t.as_ref().map_or(Range::ONE, |t| ranges[t.texture]);
    // Mark the materials that meshes use (`used`). Also mark the materials that have a triangle of positive area
    // (`spread`): no other material can emit.
    let (mut used, mut spread) = (vec![false; scene.materials.len()], vec![false; scene.materials.len()]);
    // Find, for each material, the range of the vertex colours that multiply its base colour and its opacity. A mesh
    // without vertex colours counts as having the colour 1.
    let none = Range { low: Vec4::INFINITY, high: Vec4::NEG_INFINITY };
    let mut tints = vec![none; scene.materials.len()];
    for mesh in scene.meshes.iter().filter(|m| !m.triangles.is_empty()) {
        used[mesh.material] = true;
        spread[mesh.material] |= has_area(mesh);
        let tint = &mut tints[mesh.material];
        mesh.colours.iter().for_each(|&colour| tint.include(colour));
        if mesh.colours.is_empty() {
            tint.include(Vec4::ONE);
        }
    }
    let mut needed = Requirements { textures_given: scene.textures.len(), ..Requirements::default() };
    let mut varied = vec![false; scene.textures.len()];
    let mut compiled_materials = Vec::with_capacity(scene.materials.len());
    for (index, material) in scene.materials.iter().enumerate() {
        let tint = if used[index] { tints[index] } else { Range::ONE };
        let texels = TexelRanges {
            base: range(&material.base_color_texture).times(&tint),
            layers: range(&material.metallic_roughness_texture),
            normals: range(&material.normal_texture),
            specular: range(&material.specular.texture),
            specular_color: range(&material.specular.color_texture),
            coat: range(&material.coat.texture),
            coat_roughness: range(&material.coat.roughness_texture),
        };
        let compiled = compile_material(material, &texels);
        compiled_materials.push(compiled);
        if used[index] {
            if material.is_solid() {
                needed.include_solid_material(index, &compiled, solid_extremes(material, &texels), table);
            } else {
                needed.include_material(index, &compiled, extremes(material, &texels), table);
            }
            if spread[index] {
                needed.include_emission(material, range(&material.emission_texture));
            }
            mark_varied_textures(material, &compiled, &ranges, &mut varied);
        }
    }
    needed.textures = varied.iter().filter(|&&v| v).count();
    needed.include_solids(scene);
    needed.include_lights(scene);
    (needed, compiled_materials)
}

/// Whether any triangle of a mesh has an area; a triangle without area cannot emit.
fn has_area(mesh: &Mesh) -> bool {
    (0..mesh.triangles.len()).any(|triangle| {
        let [a, b, c] = mesh.corners(triangle).map(|p| p.as_dvec3());
        (b - a).cross(c - a).length() as f32 > 0.0
    })
}

/// Marks the textures of a material that affect its scattering or its emission. A texture of a single colour does not
/// count, because it is a constant factor.
fn mark_varied_textures(material: &Material, compiled: &CompiledMaterial, ranges: &[Range], varied: &mut [bool]) {
    for (texture, counts) in [
        (&material.base_color_texture, compiled.is_textured || compiled.has_alpha),
        (&material.metallic_roughness_texture, compiled.is_textured),
        (&material.normal_texture, compiled.has_normal_map),
        (&material.emission_texture, material.emission.max_element() > 0.0),
        (&material.specular.texture, compiled.is_textured),
        (&material.specular.color_texture, compiled.is_textured),
        (&material.coat.texture, compiled.is_textured),
        (&material.coat.roughness_texture, compiled.is_textured),
    ] {
        if let Some(t) = texture {
            varied[t.texture] |= counts && !ranges[t.texture].is_constant();
        }
    }
}

impl Requirements {
    /// Adds the kinds of scattering that a material can cause, and the bound of the material's albedo. `extremes`
    /// holds the material's BSDF parameters at the ends of their ranges (see the function `extremes`).
    fn include_material(
        &mut self,
        index: usize,
        compiled: &CompiledMaterial,
        extremes: impl Iterator<Item = BsdfParams>,
        table: Option<&AlbedoTable>,
    ) {
        self.alpha |= compiled.has_alpha;
        self.normal_maps |= compiled.has_normal_map;
        for bsdf_params in extremes {
            self.include(&bsdf_params);
            if bsdf_params.transmission != Vec3::ZERO && bsdf_params.roughness >= MIRROR_ROUGHNESS {
                self.frosted.get_or_insert(index);
            }
            let albedo = albedo_bound(&bsdf_params, table);
            if self.brightest.is_none() || albedo.max_element() > self.albedo.max_element() {
                self.brightest = Some(index);
            }
            self.albedo = self.albedo.max(albedo);
        }
    }

    /// Adds the kinds of scattering that the material of solid bodies can cause, and the bound of its albedo.
    fn include_solid_material(
        &mut self,
        index: usize,
        compiled: &CompiledMaterial,
        extremes: impl Iterator<Item = SolidParams> + Clone,
        table: Option<&AlbedoTable>,
    ) {
        let opaque = extremes.clone().filter(|s| s.clear < 1.0).map(|s| s.opaque);
        self.include_material(index, compiled, opaque, table);
        for solid in extremes.filter(|s| s.clear > 0.0) {
            self.refraction = true;
            self.glossy |= solid.roughness >= MIRROR_ROUGHNESS;
            self.mirror |= solid.roughness < MIRROR_ROUGHNESS;
            // At grazing angles, glass reflects everything.
            self.brightest = self.brightest.filter(|_| self.albedo.max_element() >= 1.0).or(Some(index));
            self.albedo = Vec3::ONE;
        }
    }

    /// Sets the flags of surface emission for a material whose emission texture has values in the range `emission`.
    fn include_emission(&mut self, material: &Material, emission: Range) {
        if (material.emission * emission.high.truncate()).max_element() > 0.0 {
            self.surfaces = true;
            self.textured_surfaces |= !emission.is_constant();
        }
    }

    /// Clears the flags of surface emission if `pieces`, the number of emissive pieces, is 0. An example is a lamp
    /// whose lit texels all lie outside its triangles.
    pub fn keep_surfaces_that_emit(&mut self, pieces: usize) {
        self.surfaces &= pieces > 0;
        self.textured_surfaces &= pieces > 0;
    }

    /// Counts the transparent meshes that are closed although their material is thin, or open although it is solid.
    fn include_solids(&mut self, scene: &Scene) {
        for (index, mesh) in scene.meshes.iter().enumerate() {
            let material = &scene.materials[mesh.material];
            if mesh.triangles.is_empty() || material.transmission <= 0.0 || material.metallic >= 1.0 {
                continue;
            }
            let (count, first) = match (material.is_solid(), mesh.is_closed()) {
                (false, true) => (&mut self.solids, &mut self.first_solid),
                (true, false) => (&mut self.open_solids, &mut self.first_open_solid),
                (true, true) if mesh.volume() < 0.0 => {
                    self.inverted_solid.get_or_insert(index);
                    continue;
                }
                _ => continue,
            };
            *count += 1;
            first.get_or_insert(index);
        }
    }

    /// Adds the kinds of punctual lights, and the environment.
    fn include_lights(&mut self, scene: &Scene) {
        for light in &scene.lights {
            let (kind, strength) = match light {
                PunctualLight::Point { intensity, .. } => (&mut self.points, intensity),
                PunctualLight::Spot { intensity, .. } => (&mut self.spots, intensity),
                PunctualLight::Directional { illuminance, half_angle, .. } => {
                    self.parallel |= *half_angle == 0.0 && illuminance.max_element() > 0.0;
                    (&mut self.directional, illuminance)
                }
                PunctualLight::Luminaire { colour, .. } => {
                    let has_faces = light.opening(&scene.distributions).is_some();
                    (if has_faces { &mut self.surfaces } else { &mut self.points }, colour)
                }
            };
            *kind |= strength.max_element() > 0.0;
        }
        self.environment = match &scene.environment {
            None => false,
            Some(Environment::Constant(radiance)) => radiance.max_element() > 0.0,
            Some(Environment::Image(image)) => range_of(image).high.truncate().max_element() > 0.0,
        };
    }

    /// Adds the kinds of scattering that occur with the BSDF parameters `s`.
    fn include(&mut self, s: &BsdfParams) {
        self.diffuse |= s.diffuse != Vec3::ZERO;
        self.glass |= s.transmission != Vec3::ZERO;
        self.mirror |= s.f90 > 0.0 && s.roughness < MIRROR_ROUGHNESS;
        self.glossy |= s.f90 > 0.0 && s.roughness >= MIRROR_ROUGHNESS;
        if s.coat.share > 0.0 {
            self.clear_coat = true;
            self.mirror |= s.coat.is_mirror();
            self.glossy |= !s.coat.is_mirror();
        }
    }
}

fn range_of(image: &crate::image::Image) -> Range {
    let (mut low, mut high) = (Vec4::splat(f32::INFINITY), Vec4::splat(f32::NEG_INFINITY));
    for pixel in image.data.chunks_exact(image.channels.max(1)) {
        let value = match *pixel {
            [v] => Vec4::new(v, v, v, 1.0),
            [r, g, b] => Vec4::new(r, g, b, 1.0),
            [r, g, b, a, ..] => Vec4::new(r, g, b, a),
            _ => Vec4::ONE,
        };
        (low, high) = (low.min(value), high.max(value));
    }
    Range { low, high }
}

/// The ranges of the textures of a material; the range of an absent texture is 1.
struct TexelRanges {
    /// Base colour, multiplied by the vertex colours.
    base: Range,
    /// Metalness and roughness.
    layers: Range,
    normals: Range,
    specular: Range,
    specular_color: Range,
    coat: Range,
    coat_roughness: Range,
}

fn compile_material(material: &Material, texels: &TexelRanges) -> CompiledMaterial {
    let TexelRanges { base, layers, normals, specular, specular_color, coat, coat_roughness } = texels;
    let min_alpha = (material.alpha * base.low.w).min(material.alpha * base.high.w);
    let has_alpha = match material.alpha_mode {
        AlphaMode::Opaque => false,
        AlphaMode::Mask(cutoff) => min_alpha < cutoff,
        AlphaMode::Blend => min_alpha < 1.0,
    };
    // A neutral normal map has x = y = 1/2, which decodes to 0, and a z that decodes to a positive value.
    let bends = (normals.low.truncate() * 2.0 - 1.0).abs().max((normals.high.truncate() * 2.0 - 1.0).abs());
    let is_neutral = (bends * material.normal_scale).truncate().max_element() == 0.0 && normals.low.z > 0.5;
    let base_varies = base.low.truncate() != base.high.truncate();
    let layers_vary = (layers.low.y, layers.low.z) != (layers.high.y, layers.high.z);
    let specular_varies =
        specular.low.w != specular.high.w || specular_color.low.truncate() != specular_color.high.truncate();
    let plain = PointValues::new(material);
    let values = PointValues {
        base: plain.base * base.high.truncate(),
        metallic: plain.metallic * layers.high.z,
        roughness: plain.roughness * layers.high.y,
        specular: plain.specular * specular.high.w,
        specular_color: plain.specular_color * specular_color.high.truncate(),
        coat: CoatParams {
            share: plain.coat.share * coat.high.x,
            roughness: plain.coat.roughness * coat_roughness.high.y,
        },
    };
    let coat_varies =
        plain.coat.share > 0.0 && (coat.low.x, coat_roughness.low.y) != (coat.high.x, coat_roughness.high.y);
    CompiledMaterial {
        bsdf_params: compiled_material::bsdf_params(material, &values),
        is_textured: base_varies || layers_vary || specular_varies || coat_varies,
        layered: material.is_solid() || extremes(material, texels).any(|s| s.is_layered()),
        has_normal_map: material.normal_texture.is_some() && !is_neutral,
        has_alpha,
        lets_light_through: has_alpha || (material.transmission > 0.0 && !material.is_solid()),
        medium: medium::AIR,
    }
}

/// Returns the BSDF parameters of a material, with its largest colours, for all combinations of its smallest or largest
/// metalness, roughness, specular strength and coat. All parameters of the layers are linear or monotone in these
/// values, so their extremes are among these combinations. The attenuation of the diffuse layer is that of the smallest
/// specular colour.
fn extremes(material: &Material, texels: &TexelRanges) -> impl Iterator<Item = BsdfParams> {
    let least = material.specular.color * texels.specular_color.low.truncate();
    extreme_values(material, texels).into_iter().map(move |values| {
        let faint = PointValues { specular_color: values.specular_color.min(least), ..values };
        let dielectric_f0 = compiled_material::bsdf_params(material, &faint).dielectric_f0;
        BsdfParams { dielectric_f0, ..compiled_material::bsdf_params(material, &values) }
    })
}

/// Returns the parameters of the material of solid bodies for the same combinations as [`extremes`].
fn solid_extremes(material: &Material, texels: &TexelRanges) -> impl Iterator<Item = SolidParams> + Clone {
    let values = extreme_values(material, texels).into_iter();
    values.map(move |values| compiled_material::solid_params(material, &values))
}

/// Returns the largest colours of a material with each combination of the extremes of its other values.
fn extreme_values(material: &Material, texels: &TexelRanges) -> Vec<PointValues> {
    let plain = PointValues::new(material);
    let largest = |colour: Vec3, range: &Range| (colour * range.low.truncate()).max(colour * range.high.truncate());
    let base = largest(plain.base, &texels.base);
    let specular_color = largest(plain.specular_color, &texels.specular_color);
    let mut all = vec![PointValues { base, specular_color, ..plain }];
    let TexelRanges { layers, specular, coat, coat_roughness, .. } = texels;
    let with = &mut all;
    with_both(with, plain.metallic, [layers.low.z, layers.high.z], |values| &mut values.metallic);
    with_both(with, plain.roughness, [layers.low.y, layers.high.y], |values| &mut values.roughness);
    with_both(with, plain.specular, [specular.low.w, specular.high.w], |values| &mut values.specular);
    with_both(with, plain.coat.share, [coat.low.x, coat.high.x], |values| &mut values.coat.share);
    let texels = [coat_roughness.low.y, coat_roughness.high.y];
    with_both(with, plain.coat.roughness, texels, |values| &mut values.coat.roughness);
    all
}

/// Replaces each entry by two: with the products of a factor with the smallest and the largest texel. `place` tells the
/// number to set.
fn with_both(all: &mut Vec<PointValues>, factor: f32, texels: [f32; 2], place: fn(&mut PointValues) -> &mut f32) {
    let [a, b] = texels.map(|texel| factor * texel);
    all.iter_mut().for_each(|values| *place(values) = a);
    if a != b {
        let mut others = all.clone();
        others.iter_mut().for_each(|values| *place(values) = b);
        all.append(&mut others);
    }
}

/// Returns the largest albedo, over all directions of incidence, with the BSDF parameters `s`. The result may be up to
/// 0.003 too small, because the albedo is evaluated at a finite number of directions.
fn albedo_bound(s: &BsdfParams, table: Option<&AlbedoTable>) -> Vec3 {
    // Number of intervals between the cosines at which the albedo is evaluated. With 32 to 128 intervals, the result
    // may be up to 0.003 below the largest albedo, which is less than the error of the table. [convention]
    const STEPS: usize = 64;
    let mut bound = Vec3::ZERO;
    for i in 0..=STEPS {
        let cosine = i as f32 / STEPS as f32;
        let (top, taken) = match table {
            _ if s.f90 == 0.0 => (Vec3::ZERO, 0.0),
            Some(table) if s.roughness >= MIRROR_ROUGHNESS => {
                let share = table.row(s.roughness).directional(cosine);
                (s.f0 * share.x + s.f90 * share.y, s.dielectric_f0 * share.x + s.dielectric_f90 * share.y)
            }
            _ => {
                let dielectric_f0 = Vec3::splat(s.dielectric_f0);
                (ggx::schlick(s.f0, s.f90, cosine), ggx::schlick(dielectric_f0, s.dielectric_f90, cosine).x)
            }
        };
        let mut albedo = s.diffuse * (1.0 - taken) + top + s.through(cosine);
        if s.coat.share > 0.0 {
            // `through` is already that below the coat.
            let coat = s.coat.albedo(cosine, table);
            albedo = Vec3::splat(coat) + (s.diffuse * (1.0 - taken) + top) * (1.0 - coat) + s.through(cosine);
        }
        bound = bound.max(albedo);
    }
    bound.min(Vec3::ONE)
}
