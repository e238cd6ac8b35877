//! Materials, textures and images of a file.

use super::Budget;
use super::container::{File, missing};
use crate::error::{Error, ErrorKind, Result};
use crate::image::Image;
use crate::image::io::{self, Encoding, MAX_PIXELS};
use crate::scene::{AlphaMode, Material, Texture, TextureRef, Wrap};
use glam::{Mat3, Vec2, Vec3};
use gltf::json::validation::Checked;
use gltf::json::{Index, extensions, material, texture};

/// Location of an image's bytes. Exporters that do not share images often share their bytes.
#[derive(Clone, Copy, PartialEq)]
enum Source {
    View(usize),
    Image(usize),
}

/// The properties by which two texture uses share one texture.
type Key = (Source, Encoding, [Wrap; 2]);

/// Reads materials in order and collects their textures.
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

    /// Reads a material, clamping factors that lie slightly outside their range, as some exporters write.
    pub fn read(&mut self, index: usize, json: &material::Material) -> Result<Material> {
        let pbr = &json.pbr_metallic_roughness;
        let [r, g, b, alpha] = pbr.base_color_factor.0;
        let extensions = json.extensions.as_ref();
        let transmission = extensions.and_then(|e| e.transmission.as_ref()).map_or(0.0, |t| t.transmission_factor.0);
        let strength = extensions.and_then(|e| e.emissive_strength.as_ref()).map_or(1.0, |s| s.emissive_strength.0);
        // The extension allows 0 for surfaces that reflect everything; treat these as ordinary glass.
        let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |i| i.ior.0);
        Ok(Material {
            name: json.name.clone().unwrap_or_else(|| format!("Material {index}")),
            base_color: Vec3::new(r, g, b).clamp(Vec3::ZERO, Vec3::ONE),
            base_color_texture: self.optional(pbr.base_color_texture.as_ref(), Encoding::Srgb)?,
            alpha: alpha.clamp(0.0, 1.0),
            alpha_mode: match &json.alpha_mode {
                Checked::Valid(material::AlphaMode::Opaque) => AlphaMode::Opaque,
                Checked::Valid(material::AlphaMode::Mask) => AlphaMode::Mask(json.alpha_cutoff.map_or(0.5, |c| c.0)),
                Checked::Valid(material::AlphaMode::Blend) => AlphaMode::Blend,
                Checked::Invalid => return Err(Error::format("its alphaMode is unknown")),
            },
            metallic: pbr.metallic_factor.0.clamp(0.0, 1.0),
            roughness: pbr.roughness_factor.0.clamp(0.0, 1.0),
            metallic_roughness_texture: self.optional(pbr.metallic_roughness_texture.as_ref(), Encoding::Linear)?,
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
        })
    }

    fn optional(&mut self, info: Option<&texture::Info>, encoding: Encoding) -> Result<Option<TextureRef>> {
        let Some(info) = info else { return Ok(None) };
        let transform = info.extensions.as_ref().and_then(|e| e.texture_transform.as_ref());
        self.reference(info.index, info.tex_coord, transform, encoding)
    }

    fn reference(
        &mut self,
        index: Index<texture::Texture>,
        uv_set: u32,
        transform: Option<&extensions::texture::TextureTransform>,
        encoding: Encoding,
    ) -> Result<Option<TextureRef>> {
        let uv_set = transform.and_then(|t| t.tex_coord).unwrap_or(uv_set) as usize;
        if uv_set > 1 {
            let message = format!("texCoord is {uv_set}; only the sets 0 and 1 are read");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let texture = self.texture(index, encoding).map_err(|e| e.within(format_args!("texture {}", index.value())))?;
        let transform = transform.map_or(Mat3::IDENTITY, matrix);
        Ok(texture.map(|texture| TextureRef { texture, uv_set, transform }))
    }

    /// The index of a texture in the scene, unless it has no image; decodes it at its first use.
    fn texture(&mut self, index: Index<texture::Texture>, encoding: Encoding) -> Result<Option<usize>> {
        let root = &self.file.root;
        let json = root.get(index).ok_or_else(|| missing("texture", index.value(), root.textures.len()))?;
        let wrap = match json.sampler {
            None => [Wrap::Repeat; 2],
            Some(index) => {
                let sampler = root.get(index).ok_or_else(|| missing("sampler", index.value(), root.samplers.len()))?;
                [wrapping(&sampler.wrap_s)?, wrapping(&sampler.wrap_t)?]
            }
        };
        // The crate `gltf` stores this index for a texture without an image.
        if json.source.value() == u32::MAX as usize {
            return Ok(None);
        }
        let image = root.get(json.source).ok_or_else(|| missing("image", json.source.value(), root.images.len()))?;
        let source = image.buffer_view.map_or(Source::Image(json.source.value()), |view| Source::View(view.value()));
        let key = (source, encoding, wrap);
        if let Some(known) = self.keys.iter().position(|k| *k == key) {
            return Ok(Some(known));
        }

        // An image decoded with another encoding or wrapping becomes a separate texture.
        let decoded = match (image.buffer_view, &image.uri) {
            (Some(view), _) => self.decode(self.file.view(view)?, encoding),
            (None, Some(uri)) => self.file.resolve(uri).and_then(|bytes| self.decode(&bytes, encoding)),
            (None, None) => Err(Error::format("it has neither a buffer view nor a URI")),
        };
        let decoded = decoded.map_err(|e| e.within(format_args!("image {}", json.source.value())))?;
        let name = [&image.name, &json.name, &image.uri].into_iter().flatten().find(|n| !n.starts_with("data:"));
        let name = name.cloned().unwrap_or_else(|| format!("Image {}", json.source.value()));
        self.textures.push(Texture { name, image: decoded, wrap });
        self.keys.push(key);
        Ok(Some(self.textures.len() - 1))
    }

    /// Decodes an image after checking the size in its header against the budget.
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
        self.pixels += pixels;
        if self.pixels > MAX_PIXELS {
            let message = format!("the textures have more than {MAX_PIXELS} pixels in all");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        self.budget.keep(pixels * (channels * size_of::<f32>()) as u64)?;
        io::decode(bytes, encoding)
    }
}

fn wrapping(mode: &Checked<texture::WrappingMode>) -> Result<Wrap> {
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

/// `translation × rotation × scale`; a positive angle rotates counter-clockwise with v running down, as in the prose
/// of `KHR_texture_transform` and in renderers (the GLSL in its text rotates the other way).
pub fn transform_matrix(offset: Vec2, rotation: f32, scale: Vec2) -> Mat3 {
    let (s, c) = rotation.sin_cos();
    Mat3::from_cols(Vec3::new(c, -s, 0.0) * scale.x, Vec3::new(s, c, 0.0) * scale.y, offset.extend(1.0))
}
