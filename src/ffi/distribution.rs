//! Luminous intensity distributions
//!
//! A distribution gives the luminous intensity of a luminaire in each direction. It is read from IES (LM-63), EULUMDAT,
//! TM-33 or GLDF files, and can be written to all these formats. These calls are synchronous: they do their work before
//! they return.

use super::context::{Context, luxfer_context};
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, bytes, copy_text, text};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::image::io;
use crate::photometry::{File, Format, Luminaire, split_variant};
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::sync::Arc;

/// A luminous intensity distribution. See luxfer_distribution_load.
pub struct luxfer_distribution {
    _opaque: [u8; 0],
}

/// A file format of distributions: a LUXFER_DISTRIBUTION_ value.
pub type luxfer_distribution_format = i32;
/// IES LM-63 (.ies) with photometry of type C. Files with photometry of type B are converted to type C when they are
/// loaded.
pub const LUXFER_DISTRIBUTION_IES: luxfer_distribution_format = 0;
/// EULUMDAT (.ldt).
pub const LUXFER_DISTRIBUTION_LDT: luxfer_distribution_format = 1;
/// ANSI/IES TM-33-18 and TM-33-23 (.xml). The distributions of all emitters are added up. Saved files are TM-33-23.
pub const LUXFER_DISTRIBUTION_TM33: luxfer_distribution_format = 2;
/// GLDF container (.gldf): a product with variants, of which one is read.
pub const LUXFER_DISTRIBUTION_GLDF: luxfer_distribution_format = 3;
/// Any of these formats; the library recognises the format by the content of the file.
pub const LUXFER_DISTRIBUTION_ANY: luxfer_distribution_format = 4;

/// Summary of a luminous intensity distribution.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_distribution_report {
    /// sizeof(luxfer_distribution_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of C planes, the half-planes through the axis in which the intensities are given. Planes that the file
    /// leaves out because of symmetry are included. A single plane holds for all directions around the axis.
    pub planes: u32,
    /// Number of vertical angles gamma in each C plane.
    pub angles: u32,
    /// Reserved; always 0.
    pub reserved: u32,
    /// Luminous flux in lumens: the integral of the intensity over all directions.
    pub flux: f64,
    /// Rated flux of the lamps in lumens; 0 if the file does not state it (absolute photometry).
    pub lamp_flux: f64,
    /// Electric power in watts; 0 if unknown.
    pub watts: f64,
    /// Size of the luminous opening in metres: along C = 0°, along C = 90° and along the axis. As in IES files,
    /// negative values stand for a round opening: the absolute value is the diameter. IES files name the three values
    /// length, width and height; EULUMDAT and TM-33 files name them width, length and height.
    pub size: [f64; 3],
    /// Correlated colour temperature of the lamps in kelvin; 0 if unknown.
    pub temperature: f64,
    /// General colour rendering index Ra of the lamps; 0 if unknown.
    pub rendering: f64,
    /// Number of variants of the product in a GLDF container; 1 for all other formats.
    pub variants: u32,
    /// Number of emitters whose distributions were added up. For TM-33, it counts the emitters of the file; for GLDF,
    /// the emitters of the variant that was read. 1 for IES and EULUMDAT.
    pub emitters: u32,
}

versioned!(luxfer_distribution_report, [64, 88], {
    Self {
        struct_size: 88,
        planes: 0,
        angles: 0,
        reserved: 0,
        flux: 0.0,
        lamp_flux: 0.0,
        watts: 0.0,
        size: [0.0; 3],
        temperature: 0.0,
        rendering: 0.0,
        variants: 0,
        emitters: 0,
    }
});

pub(super) struct Distribution {
    context: Arc<Context>,
    luminaire: Arc<Luminaire>,
    variants: usize,
    emitters: usize,
}

impl Distribution {
    pub(super) fn luminaire(&self) -> &Arc<Luminaire> {
        &self.luminaire
    }
}

impl Owned for Distribution {
    fn context(&self) -> &Arc<Context> {
        &self.context
    }
}

impl Handle for luxfer_distribution {
    type Object = Distribution;
    const TAG: u64 = tag(b"lux.dist");
    const NAME: &'static str = "luxfer_distribution";
}

/// Returns the format that a value of the interface stands for. The content decides for LUXFER_DISTRIBUTION_ANY.
fn format_of(value: luxfer_distribution_format, bytes: &[u8]) -> Result<Format> {
    match value {
        LUXFER_DISTRIBUTION_IES => Ok(Format::Ies),
        LUXFER_DISTRIBUTION_LDT => Ok(Format::Ldt),
        LUXFER_DISTRIBUTION_TM33 => Ok(Format::Tm33),
        LUXFER_DISTRIBUTION_GLDF => Ok(Format::Gldf),
        LUXFER_DISTRIBUTION_ANY => Ok(Format::of_content(bytes)),
        _ => Err(Error::argument(format!("format is {value}; it must be a LUXFER_DISTRIBUTION_ value"))),
    }
}

impl Distribution {
    pub(super) fn new(context: &Arc<Context>, file: File) -> Arc<Self> {
        let File { luminaire, variants, emitters } = file;
        Arc::new(Self { context: context.clone(), luminaire: Arc::new(luminaire), variants, emitters })
    }
}

/// Loads a distribution from an .ies, .ldt, .xml (TM-33) or .gldf file; path is UTF-8. TM-33 and GLDF are recognised by
/// their content, whichever of these extensions the path has. After .gldf, the path may go on with # and the name, the
/// id or the index from 0 of a variant, such as "lamp.gldf#black"; without such an addition, the first variant is read.
/// The caller releases *distribution. Any thread.
/// LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is malformed (the message names the line);
/// LUXFER_UNSUPPORTED for photometry of type A, for photometry of type B in TM-33 files, for a GLDF container that
/// gives only the web address of its photometry, and for files without luminous intensities, for example with radiant
/// intensities only;
/// LUXFER_NOT_FOUND if a container lacks the variant or a file; LUXFER_INVALID_ARGUMENT if the path has another
/// extension.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_load(
    context: *mut luxfer_context,
    path: *const c_char,
    distribution: *mut *mut luxfer_distribution,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(distribution, "distribution")?;
        let (path, variant) = split_variant(text(path, "path")?);
        let format = Format::of_path(Path::new(path))?;
        let bytes = io::read_file(Path::new(path))?;
        let file = format.confirmed(&bytes).read(&bytes, variant).map_err(|e| e.context(path))?;
        out.set(handle::give(Distribution::new(object.context(), file)));
        Ok(())
    })
}

/// Loads a distribution from a file in memory of size bytes at data; format is a LUXFER_DISTRIBUTION_ value. Of a GLDF
/// container, the first variant is read. Ownership, threads and errors are as for luxfer_distribution_load.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_load_memory(
    context: *mut luxfer_context,
    data: *const c_void,
    size: usize,
    format: luxfer_distribution_format,
    distribution: *mut *mut luxfer_distribution,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(distribution, "distribution")?;
        let data = bytes(data.cast(), size, "data")?;
        let file = format_of(format, data)?.read(data, None)?;
        out.set(handle::give(Distribution::new(object.context(), file)));
        Ok(())
    })
}

/// Saves a distribution to an .ies, .ldt, .xml (TM-33) or .gldf file; path is UTF-8. A GLDF container has one variant,
/// with the photometry as EULUMDAT and the opening as a simple geometry. An existing file is replaced only once the new
/// one is complete. Any thread.
/// LUXFER_INVALID_ARGUMENT if the path has another extension, LUXFER_IO if the file cannot be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_save(
    distribution: *mut luxfer_distribution,
    path: *const c_char,
) -> luxfer_status {
    enter(distribution, |object| {
        let path = Path::new(text(path, "path")?);
        io::write_file(path, &Format::of_path(path)?.write(&object.luminaire)?)
    })
}

/// Gets the summary of a distribution. size is sizeof *report. Any thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_get_report(
    distribution: *mut luxfer_distribution,
    report: *mut luxfer_distribution_report,
    size: usize,
) -> luxfer_status {
    enter(distribution, |object| {
        let l = &object.luminaire;
        Report::new(report, size)?.set(luxfer_distribution_report {
            planes: l.planes.len() as u32,
            angles: l.gammas.len() as u32,
            flux: l.flux(),
            lamp_flux: l.lamp_flux,
            watts: l.watts,
            size: l.size,
            temperature: l.temperature,
            rendering: l.rendering,
            variants: object.variants as u32,
            emitters: object.emitters as u32,
            ..luxfer_distribution_report::defaults()
        });
        Ok(())
    })
}

/// Copies the luminaire's name into buffer as zero-terminated UTF-8, truncated to capacity bytes including the zero.
/// *needed, unless NULL, receives the capacity that the whole name needs. buffer may be NULL if capacity is 0. Any
/// thread.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_get_name(
    distribution: *mut luxfer_distribution,
    buffer: *mut c_char,
    capacity: usize,
    needed: *mut usize,
) -> luxfer_status {
    enter(distribution, |object| copy_text(&object.luminaire.name, buffer, capacity, needed))
}

/// Gets the luminous intensity in candela in one direction. Both angles are in degrees and finite: c is the angle of
/// the C plane, which turns around the axis of the luminaire; gamma is the angle from straight down (0) to straight up
/// (180). The intensity is interpolated linearly between the angles of the file, and is 0 if gamma lies outside the
/// angles of the file. Any thread.
/// LUXFER_INVALID_ARGUMENT if an angle is not finite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_get_intensity(
    distribution: *mut luxfer_distribution,
    c: f64,
    gamma: f64,
    candela: *mut f64,
) -> luxfer_status {
    enter(distribution, |object| {
        let out = Out::new(candela, "candela")?;
        if !(c.is_finite() && gamma.is_finite()) {
            return Err(Error::argument(format!("the direction is ({c}, {gamma}); both angles must be finite")));
        }
        out.set(object.luminaire.intensity(c, gamma));
        Ok(())
    })
}
