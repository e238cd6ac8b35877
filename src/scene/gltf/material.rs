//! Reads the materials of a glTF file, with their textures and images.

use super::Budget;
use super::container::{File, missing};
use super::features::{CLEAR_COAT, SPECULAR};
use super::glossiness::{self, Colours};
use super::settings::ExtensionSettings;
use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::image::io::{self, Encoding, MAX_PIXELS};
use crate::maths;
use crate::scene::{AlphaMode, ClearCoat, MAX_LIGHT, Material, Specular, Texture, TextureRef, Wrap};
use glam::{Mat3, Vec2, Vec3};
use gltf::json::extensions::material::PbrSpecularGlossiness;
use gltf::json::validation::Checked;
use gltf::json::{self, Index, extensions, material, texture};

/// Identifies the encoded bytes of an image. Exporters often write several images that share one buffer view; all of
/// these images have the same source. Textures of equal source, encoding and wrap modes are therefore decoded only once
/// ([`Key`]).
#[derive(Clone, Copy, PartialEq)]
enum Source {
    View(usize),
    Image(usize),
    /// An image that this importer converted from specular-glossiness. The number only tells such images apart.
    Converted(usize),
}

/// A texture as the file describes it, before its image is decoded.
struct Stored<'a> {
    image: &'a json::Image,
    index: usize,
    source: Source,
    wrap: [Wrap; 2],
    name: String,
}

/// The properties of a material that both workflows (metallic-roughness and specular-glossiness) determine.
#[derive(Default)]
struct PbrValues {
    base_color: Vec3,
    alpha: f32,
    base_color_texture: Option<TextureRef>,
    metallic: f32,
    roughness: f32,
    metallic_roughness_texture: Option<TextureRef>,
}

/// Two references to textures share one texture of the scene if their image, encoding and wrap modes are equal.
type Key = (Source, Encoding, [Wrap; 2]);

/// Reads materials one after another and collects their textures for the scene.
pub struct Materials<'a> {
    file: &'a File<'a>,
    budget: &'a dyn Budget,
    pub textures: Vec<Texture>,
    keys: Vec<Key>,
    pixels: u64,
}

impl<'a> Materials<'a> {
    pub fn new(file: &'a File<'a>, budget: &'a dyn Budget) -> Self {
        Self { file, budget, textures: Vec::new(), keys: Vec::new(), pixels: 0 }
    }

    /// Reads a material. Factors slightly outside their range, as some exporters write them, are clamped.
    pub fn read(&mut self, index: usize, json: &material::Material) -> Result<Material> {
        let extensions = json.extensions.as_ref();
        let glossiness = extensions.and_then(|e| e.pbr_specular_glossiness.as_ref());
        let pbr = match glossiness.filter(|settings| glossiness::is_convertible(settings)) {
            Some(settings) => self.glossiness(settings)?,
            None => self.metallic_roughness(&json.pbr_metallic_roughness)?,
        };
        let transmission = extensions.and_then(|e| e.transmission.as_ref()).map_or(0.0, |t| t.transmission_factor.0);
        let strength = extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |s| s.emissive_strength.0);
        // `KHR_materials_ior`: an index of refraction of 0 stands for a surface that reflects everything. Such surfaces
        // are not modelled; the field `ior` below gets the default, 1.5, instead of 0.
        let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |i| i.ior.0);
        let volume = extensions.and_then(|e| e.volume.as_ref());
        Ok(Material {
            name: json.name.clone().unwrap_or_else(|| format!("Material {index}")),
            base_color: pbr.base_color.clamp(Vec3::ZERO, Vec3::ONE),
            base_color_texture: pbr.base_color_texture,
            alpha: pbr.alpha.clamp(0.0, 1.0),
            alpha_mode: match &json.alpha_mode {
                Checked::Valid(material::AlphaMode::Opaque) => AlphaMode::Opaque,
                Checked::Valid(material::AlphaMode::Mask) => AlphaMode::Mask(json.alpha_cutoff.map_or(0.5, |c| c.0)),
                Checked::Valid(material::AlphaMode::Blend) => AlphaMode::Blend,
                Checked::Invalid => return Err(Error::format("its alphaMode is unknown")),
            },
            metallic: pbr.metallic.clamp(0.0, 1.0),
            roughness: pbr.roughness.clamp(0.0, 1.0),
            metallic_roughness_texture: pbr.metallic_roughness_texture,
            normal_texture: match &json.normal_texture {
                Some(normal) => self.reference(normal.index, normal.tex_coord, None, Encoding::Linear)?,
                None => None,
            },
            normal_scale: json.normal_texture.as_ref().map_or(1.0, |n| n.scale),
            emission: Vec3::from(json.emissive_factor.0) * strength,
            emission_texture: self.optional(json.emissive_texture.as_ref(), Encoding::Srgb)?,
            double_sided: json.double_sided,
            transmission: transmission.clamp(0.0, 1.0),
            ior: if ior == 0.0 { 1.5 } else { ior.max(1.0) },
            specular: self.specular(&ExtensionSettings::new(json, SPECULAR))?,
            coat: self.coat(&ExtensionSettings::new(json, CLEAR_COAT))?,
            // The texture of the thickness only serves renderers that do not trace rays.
            thickness: volume.map_or(0.0, |v| v.thickness_factor.0.clamp(0.0, f32::MAX)),
            attenuation_color: volume
                .map_or(Vec3::ONE, |v| Vec3::from(v.attenuation_color.0))
                .clamp(Vec3::ZERO, Vec3::ONE),
            attenuation_distance: volume
                .map_or(f32::INFINITY, |v| v.attenuation_distance.0)
                .clamp(f32::MIN_POSITIVE, f32::INFINITY),
        })
    }

    fn metallic_roughness(&mut self, pbr: &material::PbrMetallicRoughness) -> Result<PbrValues> {
        let [r, g, b, alpha] = pbr.base_color_factor.0;
        Ok(PbrValues {
            base_color: Vec3::new(r, g, b),
            alpha,
            base_color_texture: self.optional(pbr.base_color_texture.as_ref(), Encoding::Srgb)?,
            metallic: pbr.metallic_factor.0,
            roughness: pbr.roughness_factor.0,
            metallic_roughness_texture: self.optional(pbr.metallic_roughness_texture.as_ref(), Encoding::Linear)?,
        })
    }

    fn specular(&mut self, settings: &ExtensionSettings) -> Result<Specular> {
        // Both textures may be one image with colour and alpha. The encoding does not change the alpha.
        Ok(Specular {
            strength: settings.number("specularFactor", 1.0)?.clamp(0.0, 1.0),
            texture: self.optional(settings.texture("specularTexture")?.as_ref(), Encoding::Srgb)?,
            color: settings.colour("specularColorFactor", 1.0)?.clamp(Vec3::ZERO, Vec3::splat(MAX_LIGHT)),
            color_texture: self.optional(settings.texture("specularColorTexture")?.as_ref(), Encoding::Srgb)?,
        })
    }

    /// Reads a clear coat; a coat without strength is no coat.
    fn coat(&mut self, settings: &ExtensionSettings) -> Result<ClearCoat> {
        let strength = settings.number("clearcoatFactor", 0.0)?.clamp(0.0, 1.0);
        if strength == 0.0 {
            return Ok(ClearCoat::default());
        }
        Ok(ClearCoat {
            strength,
            texture: self.optional(settings.texture("clearcoatTexture")?.as_ref(), Encoding::Linear)?,
            roughness: settings.number("clearcoatRoughnessFactor", 0.0)?.clamp(0.0, 1.0),
            roughness_texture: self
                .optional(settings.texture("clearcoatRoughnessTexture")?.as_ref(), Encoding::Linear)?,
        })
    }

    /// Converts a specular-glossiness material to metallic-roughness, with new textures if it has textures.
    fn glossiness(&mut self, settings: &PbrSpecularGlossiness) -> Result<PbrValues> {
        let [r, g, b, alpha] = settings.diffuse_factor.0;
        let infos = [&settings.diffuse_texture, &settings.specular_glossiness_texture].map(Option::as_ref);
        let diffuse_texture = infos[0].map_or(Ok(None), |info| self.decode_for_conversion(info.index))?;
        let specular_texture = infos[1].map_or(Ok(None), |info| self.decode_for_conversion(info.index))?;
        let colours = Colours {
            diffuse: Vec3::new(r, g, b),
            alpha,
            specular: Vec3::from(settings.specular_factor.0),
            glossiness: settings.glossiness_factor.0,
            diffuse_texture: diffuse_texture.as_ref(),
            specular_texture: specular_texture.as_ref(),
        };
        let (Some(size), Some(info)) = (colours.size(), infos[0].or(infos[1])) else {
            let (base_color, metallic) = glossiness::convert(colours.diffuse, colours.specular);
            let roughness = 1.0 - colours.glossiness;
            return Ok(PbrValues { base_color, alpha, metallic, roughness, ..PbrValues::default() });
        };
        let pixels = 2 * size[0] as u64 * size[1] as u64;
        self.count(pixels, pixels / 2 * 7)?;
        let wrap =
            [&diffuse_texture, &specular_texture].into_iter().flatten().next().map_or([Wrap::Repeat; 2], |t| t.wrap);
        let place = place(info.tex_coord, transform(info))?;
        let mut references = [None; 2];
        for (reference, (image, name)) in
            references.iter_mut().zip(colours.images(size)?.into_iter().zip(["base colour", "metallic-roughness"]))
        {
            *reference = Some(TextureRef { texture: self.textures.len(), ..place });
            // Give each converted texture a key of its own, so that no other texture reference shares it.
            self.keys.push((Source::Converted(self.keys.len()), Encoding::Linear, wrap));
            self.textures.push(Texture { name: format!("Converted {name}"), image, wrap });
        }
        let [base_color_texture, metallic_roughness_texture] = references;
        let (base_color, metallic, roughness) = (Vec3::ONE, 1.0, 1.0);
        Ok(PbrValues { base_color, alpha: 1.0, base_color_texture, metallic, roughness, metallic_roughness_texture })
    }

    /// Decodes a texture for a conversion, without adding it to the scene. `None` if it has no image.
    fn decode_for_conversion(&mut self, index: Index<texture::Texture>) -> Result<Option<Texture>> {
        let within = |e: Error| e.context(format_args!("texture {}", index.value()));
        let Some(stored) = self.stored(index).map_err(within)? else { return Ok(None) };
        self.load(&stored, Encoding::Srgb).map(Some).map_err(within)
    }

    fn optional(&mut self, info: Option<&texture::Info>, encoding: Encoding) -> Result<Option<TextureRef>> {
        let Some(info) = info else { return Ok(None) };
        self.reference(info.index, info.tex_coord, transform(info), encoding)
    }

    fn reference(
        &mut self,
        index: Index<texture::Texture>,
        uv_set: u32,
        transform: Option<&extensions::texture::TextureTransform>,
        encoding: Encoding,
    ) -> Result<Option<TextureRef>> {
        let place = place(uv_set, transform)?;
        let texture =
            self.texture(index, encoding).map_err(|e| e.context(format_args!("texture {}", index.value())))?;
        Ok(texture.map(|texture| TextureRef { texture, ..place }))
    }

    /// Returns the index of a texture in the scene, and decodes the texture at its first use. `None` if it has no
    /// image.
    fn texture(&mut self, index: Index<texture::Texture>, encoding: Encoding) -> Result<Option<usize>> {
        let Some(stored) = self.stored(index)? else { return Ok(None) };
        let key = (stored.source, encoding, stored.wrap);
        if let Some(known) = self.keys.iter().position(|k| *k == key) {
            return Ok(Some(known));
        }
        // The same image with another encoding or wrap mode becomes a separate texture.
        let texture = self.load(&stored, encoding)?;
        self.textures.push(texture);
        self.keys.push(key);
        Ok(Some(self.textures.len() - 1))
    }

    /// Finds a texture in the file; `None` if it has no image.
    fn stored(&self, index: Index<texture::Texture>) -> Result<Option<Stored<'a>>> {
        let root = &self.file.root;
        let json = root.get(index).ok_or_else(|| missing("texture", index.value(), root.textures.len()))?;
        let wrap = match json.sampler {
            None => [Wrap::Repeat; 2],
            Some(index) => {
                let sampler = root.get(index).ok_or_else(|| missing("sampler", index.value(), root.samplers.len()))?;
                [wrapping(sampler.wrap_s)?, wrapping(sampler.wrap_t)?]
            }
        };
        // The crate `gltf` stores this index for a texture without an image.
        if json.source.value() == u32::MAX as usize {
            return Ok(None);
        }
        let image = root.get(json.source).ok_or_else(|| missing("image", json.source.value(), root.images.len()))?;
        let source = image.buffer_view.map_or(Source::Image(json.source.value()), |view| Source::View(view.value()));
        let name = [&image.name, &json.name, &image.uri].into_iter().flatten().find(|n| !n.starts_with("data:"));
        let name = name.cloned().unwrap_or_else(|| format!("Image {}", json.source.value()));
        Ok(Some(Stored { image, index: json.source.value(), source, wrap, name }))
    }

    fn load(&mut self, stored: &Stored<'a>, encoding: Encoding) -> Result<Texture> {
        let image = stored.image;
        let decoded = match (image.buffer_view, &image.uri) {
            (Some(view), _) => self.decode(self.file.view(view)?, encoding),
            (None, Some(uri)) => self.file.resolve(uri).and_then(|bytes| self.decode(&bytes, encoding)),
            (None, None) => Err(Error::format("it has neither a buffer view nor a URI")),
        };
        let decoded = decoded.map_err(|e| e.context(format_args!("image {}", stored.index)))?;
        Ok(Texture { name: stored.name.clone(), image: decoded, wrap: stored.wrap })
    }

    /// Decodes an image. First the budget lends the decoder's temporary memory. Then `count` adds the size in the
    /// image's header to the totals. Only then are pixels decoded, so that an image that is too large is refused early.
    fn decode(&mut self, bytes: &[u8], encoding: Encoding) -> Result<Image> {
        let mut image = None;
        self.budget.lend(io::working_bytes(bytes)?, &mut || {
            image = Some(self.decode_within(bytes, encoding)?);
            Ok(())
        })?;
        image.ok_or_else(|| Error::new(ErrorKind::Internal, "the budget ran no work"))
    }

    fn decode_within(&mut self, bytes: &[u8], encoding: Encoding) -> Result<Image> {
        let (width, height, channels) = io::probe(bytes)?;
        let pixels = width as u64 * height as u64;
        self.count(pixels, pixels * channels as u64)?;
        io::decode(bytes, encoding)
    }

    /// Adds a texture's pixels to the total of all textures, and its samples (pixels × channels, stored as `f32`) to
    /// the budget. Errors: the total exceeds [`MAX_PIXELS`], or the budget refuses.
    fn count(&mut self, pixels: u64, samples: u64) -> Result<()> {
        self.pixels += pixels;
        if self.pixels > MAX_PIXELS {
            let message = format!("the textures have more than {MAX_PIXELS} pixels in all");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        self.budget.keep(samples * size_of::<f32>() as u64)
    }
}

fn transform(info: &texture::Info) -> Option<&extensions::texture::TextureTransform> {
    info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref())
}

/// Returns a texture reference with the set of texture coordinates (0 or 1; any other is an error) and their transform.
/// The caller sets the texture.
fn place(uv_set: u32, transform: Option<&extensions::texture::TextureTransform>) -> Result<TextureRef> {
    let uv_set = transform.and_then(|t| t.tex_coord).unwrap_or(uv_set) as usize;
    if uv_set > 1 {
        let message = format!("texCoord is {uv_set}; only the sets 0 and 1 are read");
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    Ok(TextureRef { texture: 0, uv_set, transform: transform.map_or(Mat3::IDENTITY, matrix) })
}

fn wrapping(mode: Checked<texture::WrappingMode>) -> Result<Wrap> {
    match mode {
        Checked::Valid(texture::WrappingMode::Repeat) => Ok(Wrap::Repeat),
        Checked::Valid(texture::WrappingMode::ClampToEdge) => Ok(Wrap::Clamp),
        Checked::Valid(texture::WrappingMode::MirroredRepeat) => Ok(Wrap::Mirror),
        Checked::Invalid => Err(Error::format("the sampler's wrapping mode is unknown")),
    }
}

fn matrix(transform: &extensions::texture::TextureTransform) -> Mat3 {
    transform_matrix(transform.offset.0.into(), transform.rotation.0, transform.scale.0.into())
}

/// Returns `translation × rotation × scale`. A positive angle in radians rotates counter-clockwise in an image whose v
/// axis runs down. This follows the prose of `KHR_texture_transform` and existing renderers; the GLSL code in the text
/// of the extension rotates the other way.
pub fn transform_matrix(offset: Vec2, rotation: f32, scale: Vec2) -> Mat3 {
    let (s, c) = maths::sin_cos(rotation);
    Mat3::from_cols(Vec3::new(c, -s, 0.0) * scale.x, Vec3::new(s, c, 0.0) * scale.y, offset.extend(1.0))
}
