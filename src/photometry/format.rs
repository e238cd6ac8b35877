//! The formats of luminaire files. Recognises the format of a file, and reads and writes files of each format.

#[cfg(feature = "xml-luminaires")]
use super::clock::Moment;
use super::luminaire::{File, Luminaire};
#[cfg(feature = "xml-luminaires")]
use super::{gldf, tm33};
use super::{ies, ldt};
use crate::error::{Error, Result};
use std::path::Path;

/// A format of luminaire files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// IES LM-63.
    Ies,
    /// EULUMDAT.
    Ldt,
    /// ANSI/IES TM-33.
    Tm33,
    /// GLDF, a container.
    Gldf,
}

#[cfg(not(feature = "xml-luminaires"))]
fn left_out() -> Error {
    Error::left_out("luminaires in TM-33 and GLDF were", "xml-luminaires")
}

/// Splits a path such as `lamp.gldf#black` into the path of the file and the name of a variant. `#` separates the two
/// only directly after `.gldf`; for any other path, the variant is `None`.
pub fn split_variant(path: &str) -> (&str, Option<&str>) {
    const MARK: &str = ".gldf#";
    match path.to_ascii_lowercase().find(MARK) {
        Some(at) => (&path[..at + MARK.len() - 1], Some(&path[at + MARK.len()..])),
        None => (path, None),
    }
}

impl Format {
    /// Returns the format that a path's extension names.
    ///
    /// # Errors
    /// `InvalidArgument` if the extension names no format.
    pub fn of_path(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
        match extension.as_str() {
            "ies" => Ok(Self::Ies),
            "ldt" => Ok(Self::Ldt),
            "xml" | "iesxml" | "tm33" => Ok(Self::Tm33),
            "gldf" => Ok(Self::Gldf),
            _ => {
                let allowed = ".ies, .ldt, .xml (TM-33) or .gldf";
                Err(Error::argument(format!("{} ends in none of {allowed}", path.display())))
            }
        }
    }

    /// Returns the format of a file's content: a ZIP archive is a GLDF container, XML is TM-33, a text with a line
    /// `TILT=` is IES, and any other text is EULUMDAT, which has no mark of its own.
    pub fn of_content(bytes: &[u8]) -> Self {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
            Self::Gldf
        } else if text.starts_with(b"<") || bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
            Self::Tm33
        } else if text.split(|b| matches!(b, b'\n' | b'\r')).any(|line| line.trim_ascii_start().starts_with(b"TILT=")) {
            Self::Ies
        } else {
            Self::Ldt
        }
    }

    /// Returns the format in which to read a file whose extension names this format. ZIP and XML content is recognised
    /// as GLDF and TM-33 whatever the extension says, because files often have the extension of another format. For any
    /// other content, the extension decides.
    pub fn confirmed(self, bytes: &[u8]) -> Self {
        match Self::of_content(bytes) {
            found @ (Self::Tm33 | Self::Gldf) => found,
            Self::Ies | Self::Ldt => self,
        }
    }

    /// Reads a file of this format. `variant` chooses a variant of a GLDF container by its name, its id or its index
    /// from 0; with `None`, the first variant is read.
    ///
    /// # Errors
    /// The errors of the format's reader; `InvalidArgument` if `variant` is given but the format has no variants.
    pub fn read(self, bytes: &[u8], variant: Option<&str>) -> Result<File> {
        if let (Some(variant), true) = (variant, self != Self::Gldf) {
            return Err(Error::argument(format!("the variant is {variant:?}, but only GLDF containers have variants")));
        }
        let luminaire = match self {
            Self::Ies => ies::read(bytes)?,
            Self::Ldt => ldt::read(bytes)?,
            #[cfg(feature = "xml-luminaires")]
            Self::Tm33 => return tm33::read_file(bytes),
            #[cfg(feature = "xml-luminaires")]
            Self::Gldf => return gldf::read(bytes, variant),
            #[cfg(not(feature = "xml-luminaires"))]
            Self::Tm33 | Self::Gldf => return Err(left_out()),
        };
        Ok(File { luminaire, variants: 1, emitters: 1 })
    }

    /// Writes a luminaire as a file of this format.
    ///
    /// # Errors
    /// The errors of [`Luminaire::check`].
    pub fn write(self, luminaire: &Luminaire) -> Result<Vec<u8>> {
        match self {
            Self::Ies => ies::write(luminaire).map(String::into_bytes),
            Self::Ldt => ldt::write(luminaire).map(String::into_bytes),
            #[cfg(feature = "xml-luminaires")]
            Self::Tm33 => tm33::write(luminaire, Moment::now()).map(String::into_bytes),
            #[cfg(feature = "xml-luminaires")]
            Self::Gldf => gldf::write(luminaire, Moment::now()),
            #[cfg(not(feature = "xml-luminaires"))]
            Self::Tm33 | Self::Gldf => Err(left_out()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_recognised_by_their_content() {
        let l = Luminaire { lamp_flux: 1000.0, ..Luminaire::lambertian("lamp", 1000.0, [0.6, 0.6, 0.0]) };
        for (format, extensions) in [
            (Format::Ies, &["ies", "IES"][..]),
            (Format::Ldt, &["ldt"]),
            (Format::Tm33, &["xml", "iesxml", "tm33"]),
            (Format::Gldf, &["gldf", "Gldf"]),
        ] {
            let bytes = format.write(&l).unwrap();
            assert_eq!(Format::of_content(&bytes), format);
            let file = format.read(&bytes, None).unwrap();
            assert_eq!((file.luminaire.name.as_str(), file.variants, file.emitters), ("lamp", 1, 1));
            assert!((file.luminaire.flux() / l.flux() - 1.0).abs() < 1e-9);
            for extension in extensions {
                assert_eq!(Format::of_path(Path::new(&format!("a.b.{extension}"))).unwrap(), format);
            }
            let refused = format.read(&bytes, Some("red"));
            assert!(refused.unwrap_err().message.contains("\"red\""));
        }
        assert!(Format::of_path(Path::new("lamp.pdf")).unwrap_err().message.contains(".gldf"));
        assert_eq!(Format::of_content(b""), Format::Ldt);
        assert_eq!(Format::Ies.confirmed(b"<a/>"), Format::Tm33);
        assert_eq!(Format::Gldf.confirmed(b"no archive"), Format::Gldf);
        for (path, want) in [
            ("a/b.gldf#white, 3000 K", ("a/b.gldf", Some("white, 3000 K"))),
            ("B.GLDF#a#1", ("B.GLDF", Some("a#1"))),
            ("b.gldf", ("b.gldf", None)),
            ("b#1.ldt", ("b#1.ldt", None)),
        ] {
            assert_eq!(split_variant(path), want);
        }
        assert_eq!(Format::of_content(b"\xef\xbb\xbf <a/>"), Format::Tm33);
    }
}
