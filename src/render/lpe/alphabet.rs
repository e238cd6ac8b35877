//! The alphabet of the light path automaton: the numbered events that can occur in a scene. Objects share events
//! unless an expression distinguishes them by a label.

use super::parse::{Event, kind, mode};
use super::{EmitterAs, Expression};
use crate::error::{Error, ErrorKind, Result};
use crate::image::regions::Regions;
use crate::render::contribution::LightSource;
use crate::scene::{Mesh, Scene, Texture, Wrap, texel_at};
use glam::Vec2;
use std::collections::BTreeSet;
use std::collections::btree_map::{BTreeMap, Entry};
use std::sync::Arc;

/// The kinds of scattering at a surface. The discriminants index [`SCATTERS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scatter {
    Diffuse,
    Glossy,
    Mirror,
    Pane,
    /// Refraction by the smooth surface of a solid.
    Refraction,
    RoughRefraction,
}

pub struct Alphabet {
    /// Scattering events: one of each kind for each class of meshes, in the order of [`Scatter`]. Meshes belong to one
    /// class if no expression distinguishes them.
    pub scatters: Vec<Event>,
    /// Light events, at the light end of a path.
    pub lights: Vec<Event>,
    /// For each mesh, the index of its class. The light event of the class has the same index in `lights`.
    class_of_mesh: Vec<u32>,
    /// For each mesh, the lamps of its emission texture; `None` if no expression names one of them.
    lamps: Vec<Option<LampEvents>>,
    punctual: Vec<u32>,
    environment: u32,
}

/// The lamps of an emission texture: each connected region of emissive texels has its own light event.
struct LampEvents {
    texture: Arc<LampTexture>,
    /// Indices in [`Alphabet::lights`]: first of the light event of the texels outside all regions, then of the light
    /// event of each region.
    lights: Vec<u32>,
}

struct LampTexture {
    size: [usize; 2],
    wrap: [Wrap; 2],
    regions: Regions,
}

impl Alphabet {
    /// Numbers the events of the scene that the expressions distinguish.
    ///
    /// # Errors
    /// An expression names a label that does not exist in the scene.
    pub fn new(scene: &Scene, expressions: &[&Expression], emitter_as: EmitterAs) -> Result<Self> {
        let names = |mesh: &Mesh| names_of(scene, mesh);
        let lamp_textures = lamp_textures(scene, expressions, names)?;
        let existing = existing_labels(scene, &lamp_textures);
        let named_labels = named_labels(expressions, &existing)?;
        let keep_named = |names: &[String]| -> Vec<String> {
            let set: BTreeSet<&String> = names.iter().filter(|n| named_labels.contains(*n)).collect();
            set.into_iter().cloned().collect()
        };
        // Group meshes with equal labels into classes. The class without labels always exists, even if no mesh belongs
        // to it: whether any path can match an expression must not depend on the meshes of the scene.
        let mut classes = BTreeMap::new();
        let (mut scatters, mut lights) = (Vec::new(), Vec::new());
        let mut class = |labels: Vec<String>| {
            *classes.entry(labels.clone()).or_insert_with(|| {
                for (kinds, modes) in SCATTERS {
                    scatters.push(Event { kinds, modes, labels: labels.clone() });
                }
                lights.push(Event { kinds: surface_kinds(emitter_as), modes: 0, labels });
                lights.len() as u32 - 1
            })
        };
        class(Vec::new());
        let class_of_mesh: Vec<u32> = scene.meshes.iter().map(|mesh| class(keep_named(&names(mesh)))).collect();
        // Number the events of the punctual lights, the environment and the named lamps. Lights of equal kinds and
        // labels share an event. Each kind of light has an event without labels, even if no such light exists: whether
        // any path can match an expression must not depend on the lights of the scene.
        let mut by_labels = BTreeMap::new();
        let mut light = |kinds: u8, labels: Vec<String>| {
            *by_labels.entry((kinds, labels.clone())).or_insert_with(|| {
                lights.push(Event { kinds, modes: 0, labels });
                lights.len() as u32 - 1
            })
        };
        for kinds in [kind::LIGHT, kind::OBJECT, kind::BACKGROUND] {
            light(kinds, Vec::new());
        }
        let punctual = (0..scene.lights.len()).map(|i| light(kind::LIGHT, keep_named(&[punctual_label(i)]))).collect();
        let environment = light(environment_kinds(emitter_as), keep_named(&[ENVIRONMENT.to_string()]));
        let lamps = scene.meshes.iter().zip(&class_of_mesh).map(|(mesh, class)| {
            let texture = lamp_textures.get(&mesh.material)?.clone();
            let of_lamp = |i: usize| {
                let of_it = names(mesh).map(|name| lamp_label(&name, i));
                // A lamp that no expression names shares the light event of its mesh's class.
                if of_it.iter().any(|name| named_labels.contains(name)) {
                    light(surface_kinds(emitter_as), keep_named(&[names(mesh), of_it].concat()))
                } else {
                    *class
                }
            };
            let lights = [*class].into_iter().chain((0..texture.regions.count).map(of_lamp)).collect();
            Some(LampEvents { texture, lights })
        });
        let lamps = lamps.collect();
        Ok(Self { scatters, lights, class_of_mesh, lamps, punctual, environment })
    }

    /// Returns the number of classes of meshes.
    #[inline]
    pub fn classes(&self) -> usize {
        self.scatters.len() / SCATTERS.len()
    }

    #[inline]
    pub fn class(&self, mesh: u32) -> usize {
        self.class_of_mesh[mesh as usize] as usize
    }

    #[inline]
    pub fn light(&self, source: LightSource) -> usize {
        (match source {
            LightSource::Surface { mesh, uv, .. } => match &self.lamps[mesh as usize] {
                None => self.class_of_mesh[mesh as usize],
                Some(lamps) => lamps.light(uv),
            },
            LightSource::Punctual(index) => self.punctual[index as usize],
            LightSource::Environment => self.environment,
        }) as usize
    }
}

impl LampEvents {
    fn light(&self, uv: Vec2) -> u32 {
        let LampTexture { size, wrap, regions } = &*self.texture;
        self.lights[regions.labels[texel_at(uv, *size, *wrap)] as usize]
    }
}

/// Returns the names of a mesh and of its material.
fn names_of(scene: &Scene, mesh: &Mesh) -> [String; 2] {
    [mesh.name.clone(), scene.materials.get(mesh.material).map_or(String::new(), |m| m.name.clone())]
}

/// Returns the labels of all meshes, materials, lights and lamps of a scene.
fn existing_labels(scene: &Scene, lamp_textures: &BTreeMap<usize, Arc<LampTexture>>) -> BTreeSet<String> {
    let names = |mesh: &Mesh| names_of(scene, mesh);
    let mut existing: BTreeSet<String> = scene.meshes.iter().flat_map(names).collect();
    existing.extend((0..scene.lights.len()).map(punctual_label));
    existing.insert(ENVIRONMENT.to_string());
    for (mesh, texture) in scene.meshes.iter().filter_map(|m| Some((m, lamp_textures.get(&m.material)?))) {
        existing.extend((0..texture.regions.count).flat_map(|i| names(mesh).map(|name| lamp_label(&name, i))));
    }
    existing
}

/// Finds the emission textures whose lamps an expression may name, as in `'Ceiling#3'`; the name before `#` is the name
/// of a mesh or of a material. Returns the textures by the index of their material.
fn lamp_textures(
    scene: &Scene,
    expressions: &[&Expression],
    names: impl Fn(&Mesh) -> [String; 2],
) -> Result<BTreeMap<usize, Arc<LampTexture>>> {
    let mut named = BTreeSet::new();
    for expression in expressions {
        expression.tree.labels(&mut |name, _| {
            named.extend(name.rsplit_once('#').map(|(owner, _)| owner.to_string()));
        });
    }
    let mut lamp_textures = BTreeMap::new();
    for mesh in scene.meshes.iter().filter(|mesh| names(mesh).iter().any(|name| named.contains(name))) {
        let Some(map) = scene.materials.get(mesh.material).and_then(|m| m.emission_texture) else { continue };
        if let Entry::Vacant(place) = lamp_textures.entry(mesh.material) {
            let Texture { image, wrap, .. } = &scene.textures[map.texture];
            let (size, regions) = ([image.width, image.height], Regions::of(image)?);
            place.insert(Arc::new(LampTexture { size, wrap: *wrap, regions }));
        }
    }
    Ok(lamp_textures)
}

fn lamp_label(owner: &str, index: usize) -> String {
    format!("{owner}#{index}")
}

const ENVIRONMENT: &str = "environment";

fn punctual_label(index: usize) -> String {
    format!("light{index}")
}

/// Types and modes of the scattering events, in the order of [`Scatter`].
pub const SCATTERS: [(u8, u8); 6] = [
    (kind::REFLECT, mode::DIFFUSE),
    (kind::REFLECT, mode::GLOSSY),
    (kind::REFLECT, mode::SINGULAR),
    (kind::TRANSMIT, mode::SINGULAR | mode::STRAIGHT),
    (kind::TRANSMIT, mode::SINGULAR),
    (kind::TRANSMIT, mode::GLOSSY),
];

fn surface_kinds(emitter_as: EmitterAs) -> u8 {
    match emitter_as {
        EmitterAs::Both => kind::LIGHT | kind::OBJECT,
        EmitterAs::Light => kind::LIGHT,
        EmitterAs::Object => kind::OBJECT,
    }
}

fn environment_kinds(emitter_as: EmitterAs) -> u8 {
    match emitter_as {
        EmitterAs::Both => kind::LIGHT | kind::BACKGROUND,
        EmitterAs::Light => kind::LIGHT,
        EmitterAs::Object => kind::BACKGROUND,
    }
}

/// Returns the labels that expressions name. Fails if an expression requires a label that does not exist in the scene.
fn named_labels(expressions: &[&Expression], existing: &BTreeSet<String>) -> Result<BTreeSet<String>> {
    let mut named_labels = BTreeSet::new();
    for expression in expressions {
        let mut missing = None;
        expression.tree.labels(&mut |name, must| {
            if must && !existing.contains(name) {
                missing = missing.take().or(Some(name.to_string()));
            }
            named_labels.insert(name.to_string());
        });
        if let Some(name) = missing {
            let known: Vec<String> =
                existing.iter().filter(|n| !n.is_empty()).take(12).map(|n| format!("'{n}'")).collect();
            return Err(Error::new(
                ErrorKind::NotFound,
                format!(
                    "expression {:?}: no object, material or light is called '{name}'; there are {}{}",
                    expression.text(),
                    known.join(", "),
                    if existing.len() > 12 { ", ..." } else { "" }
                ),
            ));
        }
    }
    Ok(named_labels)
}
