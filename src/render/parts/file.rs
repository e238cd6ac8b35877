//! Files that hold the sums of a rendered part, in the format of `image::numbers`, with the part's place in the image
//! and the identity of the render.

use super::Part;
use super::identity::Identity;
use crate::error::{Error, Result};
use crate::image::numbers::{self, FileHeader};
use crate::image::{Image, io};
use crate::render::film::Sums;
use crate::render::layers::Layers;
use crate::render::params::Params;
use std::path::{Path, PathBuf};

/// Prefix of the names of all header attributes that this module writes.
const PREFIX: &str = "luxfer.part.";

/// A file that holds a rendered part: its header, without the sums.
#[derive(Clone, Debug)]
pub struct File {
    path: PathBuf,
    header: FileHeader,
    pub part: Part,
    discarded: u64,
}

impl File {
    /// Opens a file and reads its header, without the sums.
    pub fn open(path: &Path) -> Result<Self> {
        let header = numbers::read_header(path)?;
        let attribute = |name: &str| {
            let text = header.attribute(&format!("{PREFIX}{name}")).and_then(|text| text.parse::<u64>().ok());
            text.ok_or_else(|| Error::format(format!("{}: it is no part of a rendering: no {name}", path.display())))
        };
        let paths = |name: &str| {
            let text = attribute(name)?;
            u32::try_from(text).map_err(|_| Error::format(format!("{}: its {name} is {text}", path.display())))
        };
        let ([x, y], [width, height]) = (header.corner, header.size);
        let part = Part { x, y, width, height, first: paths("first_path")?, samples: paths("paths")? };
        let discarded = attribute("discarded")?;
        Ok(Self { path: path.into(), header, part, discarded })
    }

    /// Returns the path of the file, for error messages.
    pub fn name(&self) -> impl std::fmt::Display {
        self.path.display()
    }

    /// Returns an error unless the part belongs to the render `identity`, has `numbers` sums per pixel, and lies
    /// within the image.
    pub fn check(&self, identity: &Identity, numbers: usize, params: &Params) -> Result<()> {
        let differs = |what: &str, theirs: &str, ours: &str| {
            Err(Error::argument(format!(
                "{}: its {what} is {theirs}, and {ours} in this rendering; only parts of one rendering can be merged",
                self.name()
            )))
        };
        let size = |[width, height]: [usize; 2]| format!("{width} x {height}");
        if self.header.whole != identity.size {
            return differs("size", &size(self.header.whole), &size(identity.size));
        }
        for (what, ours) in &identity.texts {
            let theirs = self.header.attribute(&format!("{PREFIX}{what}")).unwrap_or("unknown");
            if theirs != ours {
                return differs(what, &format!("{theirs:?}"), &format!("{ours:?}"));
            }
        }
        if self.header.numbers != numbers {
            let (theirs, ours) = (self.header.numbers, numbers);
            return Err(Error::format(format!("{}: it has {theirs} sums per pixel, not {ours}", self.name())));
        }
        self.part.check(params).map_err(|e| e.context(self.name()))
    }

    /// Reads the sums of a part that has been checked.
    pub fn read(&self, layers: Option<&Layers>) -> Result<Sums> {
        let mut sums = Sums::new(&self.part, layers)?;
        let Part { x, y, .. } = self.part;
        let bytes = io::read_file(&self.path)?;
        numbers::decode(&bytes, &self.header, |at, numbers| {
            sums.numbers_mut([x + at[0], y + at[1]]).copy_from_slice(numbers);
        })
        .map_err(|e| e.context(self.name()))?;
        sums.set_discarded(self.discarded);
        Ok(sums)
    }
}

pub fn save(path: &Path, sums: &Sums, identity: &Identity, picture: &Image) -> Result<()> {
    let Part { x, y, width, height, first, samples } = *sums.part();
    let paths = [
        ("first_path", first.to_string()),
        ("paths", samples.to_string()),
        ("discarded", sums.discarded().to_string()),
    ];
    let attributes = identity.texts.iter().cloned().chain(paths).map(|(name, text)| (format!("{PREFIX}{name}"), text));
    let header = FileHeader {
        whole: identity.size,
        corner: [x, y],
        size: [width, height],
        numbers: sums.numbers_per_pixel(),
        attributes: attributes.collect(),
    };
    let bytes = numbers::encode(&header, picture, |at, k| sums.numbers([x + at[0], y + at[1]])[k])?;
    io::write_file(path, &bytes)
}
