//! Luminous intensity distributions
//!
//! A distribution gives the luminous intensity of a luminaire in each direction. It is read from IES (LM-63) or
//! EULUMDAT files, and can be written to both formats. These calls are synchronous: they do their work before they
//! return.

use super::context::{Context, luxfer_context};
use super::guard::enter;
use super::handle::{self, Handle, Owned, tag};
use super::params::{Report, Versioned, versioned};
use super::pointer::{Out, bytes, copy_text, text};
use super::status::luxfer_status;
use crate::error::{Error, Result};
use crate::image::io;
use crate::photometry::{Luminaire, ies, ldt};
use std::ffi::{c_char, c_void};
use std::path::Path;
use std::sync::Arc;

/// A luminous intensity distribution. See luxfer_distribution_load.
pub struct luxfer_distribution {
    _opaque: [u8; 0],
}

/// A file format of distributions: a LUXFER_DISTRIBUTION_ value.
pub type luxfer_distribution_format = i32;
/// IES LM-63 (.ies), with type C photometry.
pub const LUXFER_DISTRIBUTION_IES: luxfer_distribution_format = 0;
/// EULUMDAT (.ldt).
pub const LUXFER_DISTRIBUTION_LDT: luxfer_distribution_format = 1;

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
    /// length, width and height; EULUMDAT files name them width, length and height.
    pub size: [f64; 3],
}

versioned!(luxfer_distribution_report, [64], {
    Self { struct_size: 64, planes: 0, angles: 0, reserved: 0, flux: 0.0, lamp_flux: 0.0, watts: 0.0, size: [0.0; 3] }
});

pub(super) struct Distribution {
    context: Arc<Context>,
    luminaire: Arc<Luminaire>,
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

/// Returns the format that a path's extension names: .ies or .ldt.
fn format_of(path: &Path) -> Result<luxfer_distribution_format> {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    match extension.as_str() {
        "ies" => Ok(LUXFER_DISTRIBUTION_IES),
        "ldt" => Ok(LUXFER_DISTRIBUTION_LDT),
        _ => Err(Error::argument(format!("{} ends neither in .ies nor in .ldt", path.display()))),
    }
}

fn read(bytes: &[u8], format: luxfer_distribution_format) -> Result<Luminaire> {
    match format {
        LUXFER_DISTRIBUTION_IES => ies::read(bytes),
        LUXFER_DISTRIBUTION_LDT => ldt::read(bytes),
        _ => Err(Error::argument(format!("format is {format}; it must be a LUXFER_DISTRIBUTION_ value"))),
    }
}

/// Loads a distribution from an .ies or .ldt file; path is UTF-8. The caller releases *distribution. Any thread.
/// LUXFER_IO if the file cannot be read; LUXFER_FORMAT if it is malformed (the message names the line);
/// LUXFER_UNSUPPORTED for IES photometry of types A and B; LUXFER_INVALID_ARGUMENT if the path has another extension.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_load(
    context: *mut luxfer_context,
    path: *const c_char,
    distribution: *mut *mut luxfer_distribution,
) -> luxfer_status {
    enter(context, |object| {
        let out = Out::new(distribution, "distribution")?;
        let path = text(path, "path")?;
        let format = format_of(Path::new(path))?;
        let luminaire = read(&io::read_file(Path::new(path))?, format).map_err(|e| e.context(path))?;
        out.set(handle::give(Arc::new(Distribution {
            context: object.context().clone(),
            luminaire: Arc::new(luminaire),
        })));
        Ok(())
    })
}

/// Loads a distribution from a file in memory of size bytes at data; format is a LUXFER_DISTRIBUTION_ value.
/// Ownership, threads and errors are as for luxfer_distribution_load.
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
        let luminaire = read(bytes(data.cast(), size, "data")?, format)?;
        out.set(handle::give(Arc::new(Distribution {
            context: object.context().clone(),
            luminaire: Arc::new(luminaire),
        })));
        Ok(())
    })
}

/// Saves a distribution to an .ies or .ldt file; path is UTF-8. An existing file is replaced only once the new one is
/// complete. Any thread.
/// LUXFER_INVALID_ARGUMENT if the path has another extension, LUXFER_IO if the file cannot be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_distribution_save(
    distribution: *mut luxfer_distribution,
    path: *const c_char,
) -> luxfer_status {
    enter(distribution, |object| {
        let path = Path::new(text(path, "path")?);
        let file = match format_of(path)? {
            LUXFER_DISTRIBUTION_IES => ies::write(&object.luminaire)?,
            _ => ldt::write(&object.luminaire)?,
        };
        io::write_file(path, file.as_bytes())
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
            ..luxfer_distribution_report::defaults()
        });
        Ok(())
    })
}

/// Copies the luminaire's name into buffer as zero-terminated text, truncated to capacity bytes including the zero.
/// *needed, unless NULL, receives the capacity that the whole name needs. Any thread.
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
/// (180). The intensity is interpolated linearly between the angles of the file, and is 0 for gamma outside them. Any
/// thread.
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
