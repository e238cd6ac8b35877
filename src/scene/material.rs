//! glTF 2.0 metallic-roughness materials. They may transmit light as thin panes or as solid glass, state the strength
//! and the colour of a dielectric's reflections, and have a clear coat.

use glam::{Mat3, Vec3};

/// A material's reference to a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into the scene's textures.
    pub texture: usize,
    /// Index of the mesh's set of texture coordinates: 0 or 1.
    pub uv_set: usize,
    /// Matrix applied to (u, v, 1) before the lookup (`KHR_texture_transform`).
    pub transform: Mat3,
}

impl TextureRef {
    pub fn new(texture: usize) -> Self {
        Self { texture, uv_set: 0, transform: Mat3::IDENTITY }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    Opaque,
    /// Surface points with an alpha below this cutoff are absent: rays pass through them.
    Mask(f32),
    /// A surface point is present with the probability alpha; otherwise rays pass through it.
    Blend,
}

/// Strength and colour of the reflections of a dielectric (`KHR_materials_specular`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Specular {
    /// Factor of the reflectance for all directions, in `[0, 1]`, multiplied by the alpha of `texture`.
    pub strength: f32,
    pub texture: Option<TextureRef>,
    /// Factor of the reflectance at normal incidence, per channel, at least 0, multiplied by `color_texture`. The
    /// product with the reflectance that follows from the index of refraction is limited to 1.
    pub color: Vec3,
    pub color_texture: Option<TextureRef>,
}

impl Default for Specular {
    fn default() -> Self {
        Self { strength: 1.0, texture: None, color: Vec3::ONE, color_texture: None }
    }
}

/// A clear layer with an index of refraction of 1.5 on top of a material (`KHR_materials_clearcoat`).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClearCoat {
    /// Share of the surface that the coat covers, in `[0, 1]`, multiplied by the red channel of `texture`.
    pub strength: f32,
    pub texture: Option<TextureRef>,
    /// Perceptual roughness in `[0, 1]`, multiplied by the green channel of `roughness_texture`.
    pub roughness: f32,
    pub roughness_texture: Option<TextureRef>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear reflectance per channel, in `[0, 1]`, multiplied by the base colour texture and by the vertex colours.
    pub base_color: Vec3,
    pub base_color_texture: Option<TextureRef>,
    /// Opacity in `[0, 1]`, multiplied by the alpha of the base colour texture and of the vertex colours.
    pub alpha: f32,
    pub alpha_mode: AlphaMode,
    /// Metalness in `[0, 1]`: 0 for dielectrics, 1 for metals.
    pub metallic: f32,
    /// Perceptual roughness in `[0, 1]`; its square is the width parameter α of the GGX distribution.
    pub roughness: f32,
    /// The green channel is a factor of `roughness`, the blue channel a factor of `metallic`.
    pub metallic_roughness_texture: Option<TextureRef>,
    pub normal_texture: Option<TextureRef>,
    pub normal_scale: f32,
    /// Emitted luminance per channel in cd/m² (`emissiveFactor × emissiveStrength` of glTF), multiplied by the emission
    /// texture.
    pub emission: Vec3,
    pub emission_texture: Option<TextureRef>,
    /// If true, back faces emit the same light as front faces; if false, they emit none. In both cases, back faces
    /// reflect and block light like front faces.
    pub double_sided: bool,
    /// Share of the light entering through the dielectric surface that is transmitted rather than reflected diffusely;
    /// in `[0, 1]`.
    pub transmission: f32,
    /// Index of refraction of the dielectric layer, at least 1; a layer of index 1 reflects nothing.
    pub ior: f32,
    /// The renderer ignores it for the clear surface of solid glass.
    pub specular: Specular,
    /// Has the normals of `normal_texture`, as all layers. The renderer ignores it for the clear surface of solid
    /// glass.
    pub coat: ClearCoat,
    /// If positive, and `transmission` too, the meshes of this material bound solid bodies, which refract light and
    /// absorb it inside. If 0, they are thin panes. The renderer ignores the value otherwise, as the geometry states
    /// how thick the body is (`KHR_materials_volume`).
    pub thickness: f32,
    /// Share of the light, per channel in `[0, 1]`, that is left after `attenuation_distance` metres inside a solid.
    pub attenuation_color: Vec3,
    /// In metres, positive; infinite if the solid absorbs nothing.
    pub attenuation_distance: f32,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec3::ONE,
            base_color_texture: None,
            alpha: 1.0,
            alpha_mode: AlphaMode::Opaque,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            emission: Vec3::ZERO,
            emission_texture: None,
            double_sided: false,
            transmission: 0.0,
            ior: 1.5,
            specular: Specular::default(),
            coat: ClearCoat::default(),
            thickness: 0.0,
            attenuation_color: Vec3::ONE,
            attenuation_distance: f32::INFINITY,
        }
    }
}

impl Material {
    /// A perfectly diffuse, double-sided material of one colour. Its index of refraction is 1, so it has no specular
    /// layer.
    pub fn diffuse(name: &str, base_color: Vec3) -> Self {
        Self { name: name.into(), base_color, metallic: 0.0, ior: 1.0, double_sided: true, ..Self::default() }
    }

    /// Returns the references to textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureRef> {
        let references = [
            self.base_color_texture,
            self.metallic_roughness_texture,
            self.normal_texture,
            self.emission_texture,
            self.specular.texture,
            self.specular.color_texture,
            self.coat.texture,
            self.coat.roughness_texture,
        ];
        references.into_iter().flatten()
    }

    /// Whether the surfaces of this material bound solid, transparent bodies.
    pub fn is_solid(&self) -> bool {
        self.thickness > 0.0 && self.transmission > 0.0
    }
}
