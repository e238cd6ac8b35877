//! The identity of a render: the settings that all its parts must share, as readable texts for the headers of files.

use crate::render::lpe::EmitterAs;
use crate::render::params::Params;
use crate::scene::{Camera, Scene};

pub struct Identity {
    /// Width and height of the whole image in pixels.
    pub size: [usize; 2],
    /// Name and value of each setting.
    pub texts: Vec<(&'static str, String)>,
}

impl Identity {
    pub fn new(scene: &Scene, camera: &Camera, params: &Params) -> Self {
        let Camera { position, forward, up, fov_y, name: _ } = camera;
        let outputs = &params.outputs;
        let light = outputs.expressions.iter().map(|(name, expression)| format!("{name}={}", expression.text()));
        let layers: Vec<String> = light.chain(outputs.aovs.iter().map(|a| a.name().to_string())).collect();
        let emitter_as = match outputs.emitter_as {
            EmitterAs::Both => "both",
            EmitterAs::Light => "light",
            EmitterAs::Object => "object",
        };
        // Include the version of the library, because a new version may trace different paths.
        let texts = vec![
            ("version", env!("CARGO_PKG_VERSION").to_string()),
            ("scene", format!("{:016x}", scene.fingerprint())),
            ("camera", format!("{position} {forward} {up} {fov_y}")),
            ("samples", params.samples.to_string()),
            ("seed", params.seed.to_string()),
            ("emitter_as", emitter_as.to_string()),
            ("layers", layers.join(", ")),
        ];
        Self { size: [params.width, params.height], texts }
    }
}
