//! The events that can happen in a scene, numbered. Objects whose labels no expression tells apart share their events.

use super::parse::{Event, kind, mode};
use super::{EmitterAs, Expression};
use crate::error::{Error, ErrorKind, Result};
use crate::render::LightSource;
use crate::scene::Scene;
use std::collections::{BTreeMap, BTreeSet};

/// The ways a surface scatters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scatter {
    Diffuse,
    Glossy,
    Mirror,
    Pane,
}

pub struct Alphabet {
    /// Events of scattering, four to a class of meshes, in the order of [`Scatter`].
    pub scatters: Vec<Event>,
    /// Events at a light's end of a path.
    pub lights: Vec<Event>,
    /// Number of a mesh's class, which is that of its light too.
    class_of_mesh: Vec<u32>,
    punctual: Vec<u32>,
    environment: u32,
}

impl Alphabet {
    /// # Errors
    /// A label that nothing bears.
    pub fn new(scene: &Scene, expressions: &[&Expression], emitter_as: EmitterAs) -> Result<Self> {
        let names = |mesh: &crate::scene::Mesh| {
            [mesh.name.clone(), scene.materials.get(mesh.material).map_or(String::new(), |m| m.name.clone())]
        };
        let mut borne: BTreeSet<String> = scene.meshes.iter().flat_map(names).collect();
        borne.extend((0..scene.lights.len()).map(punctual_label));
        borne.insert(ENVIRONMENT.to_string());
        let wanted = wanted(expressions, &borne)?;
        let told = |names: &[String]| -> Vec<String> {
            let set: BTreeSet<&String> = names.iter().filter(|n| wanted.contains(*n)).collect();
            set.into_iter().cloned().collect()
        };
        // Meshes of the same labels are one class; that of none is always there, so that what an expression can match
        // does not depend on what a scene happens to have.
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
        let class_of_mesh: Vec<u32> = scene.meshes.iter().map(|mesh| class(told(&names(mesh)))).collect();
        // So with lights without a surface.
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
        let punctual = (0..scene.lights.len()).map(|i| light(kind::LIGHT, told(&[punctual_label(i)]))).collect();
        let environment = light(environment_kinds(emitter_as), told(&[ENVIRONMENT.to_string()]));
        Ok(Self { scatters, lights, class_of_mesh, punctual, environment })
    }

    /// How many classes of meshes there are.
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
            LightSource::Surface { mesh, .. } => self.class_of_mesh[mesh as usize],
            LightSource::Punctual(index) => self.punctual[index as usize],
            LightSource::Environment => self.environment,
        }) as usize
    }
}

const ENVIRONMENT: &str = "environment";

fn punctual_label(index: usize) -> String {
    format!("light{index}")
}

/// Types and modes in the order of [`Scatter`].
pub const SCATTERS: [(u8, u8); 4] = [
    (kind::REFLECT, mode::DIFFUSE),
    (kind::REFLECT, mode::GLOSSY),
    (kind::REFLECT, mode::SINGULAR),
    (kind::TRANSMIT, mode::SINGULAR | mode::STRAIGHT),
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

/// The labels that expressions name; those that an event must bear have to be borne by something.
fn wanted(expressions: &[&Expression], borne: &BTreeSet<String>) -> Result<BTreeSet<String>> {
    let mut wanted = BTreeSet::new();
    for expression in expressions {
        let mut missing = None;
        expression.tree.labels(&mut |name, must| {
            if must && !borne.contains(name) {
                missing = missing.take().or(Some(name.to_string()));
            }
            wanted.insert(name.to_string());
        });
        if let Some(name) = missing {
            let known: Vec<String> =
                borne.iter().filter(|n| !n.is_empty()).take(12).map(|n| format!("'{n}'")).collect();
            return Err(Error::new(
                ErrorKind::NotFound,
                format!(
                    "expression {:?}: no object, material or light is called '{name}'; there are {}{}",
                    expression.text(),
                    known.join(", "),
                    if borne.len() > 12 { ", ..." } else { "" }
                ),
            ));
        }
    }
    Ok(wanted)
}
