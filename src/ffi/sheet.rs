//! Print sheets
//!
//! For artists who paint on paper: draws a sheet to print, which shows the exemplar in pale colours between alignment
//! marks, and aligns a photo or scan of the painted sheet with the exemplar by these marks. The paper may be bent, and
//! the lens may distort. These calls are synchronous: they do their work before they return.

use super::guard::enter;
use super::handle::{self, Owned};
use super::image::{Pixels, luxfer_image};
use super::params::{self, Report, Versioned, versioned};
use super::pointer::Out;
use super::status::luxfer_status;
use crate::error::{Error, check_range};
use crate::image::MAX_SIDE;
use crate::sheet;
use glam::DVec2;

/// Settings of a print sheet. Fill them with luxfer_sheet_params_init; use equal settings for printing and for
/// aligning.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_sheet_params {
    /// sizeof(luxfer_sheet_params), set by luxfer_sheet_params_init.
    pub struct_size: u32,
    /// 1, the default: correct uneven lighting of the photo by the brightness of the white in the marks, so that paper
    /// gets the value 1; 0: no correction.
    pub even_light: u32,
    /// Width of the paper in millimetres, in [60, 2000]; default 297.
    pub paper_width: f64,
    /// Height of the paper in millimetres, in [60, 2000]; default 210.
    pub paper_height: f64,
    /// Dots per inch of the sheet, in [20, 1200]; default 300.
    pub dpi: f64,
    /// Distance of the marks from the edge of the paper in millimetres, in [0, 50]; default 8.
    pub margin: f64,
    /// Contrast of the printed picture, in [0, 1]; default 0.25; 1 prints the picture unchanged.
    pub contrast: f64,
}

versioned!(luxfer_sheet_params, [48], {
    let d = sheet::Params::default();
    Self {
        struct_size: 48,
        even_light: u32::from(d.even_light),
        paper_width: d.paper.x,
        paper_height: d.paper.y,
        dpi: d.dpi,
        margin: d.margin,
        contrast: f64::from(d.contrast),
    }
});

impl luxfer_sheet_params {
    fn params(&self) -> crate::error::Result<sheet::Params> {
        if self.even_light > 1 {
            return Err(Error::argument(format!("even_light is {}; it must be 0 or 1", self.even_light)));
        }
        Ok(sheet::Params {
            paper: DVec2::new(self.paper_width, self.paper_height),
            dpi: self.dpi,
            contrast: self.contrast as f32,
            margin: self.margin,
            even_light: self.even_light == 1,
        })
    }
}

/// Quality of the alignment of a photo with its picture.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct luxfer_sheet_report {
    /// sizeof(luxfer_sheet_report), set by the function that fills the struct.
    pub struct_size: u32,
    /// Number of marks found, of 10; at least 6 are needed.
    pub marks: u32,
    /// Root mean square distance, in pixels of the photo, between the marks and dots found and the positions that the
    /// model of the sheet predicts for them: paper that is flat or bent in one direction, and a lens with radial
    /// distortion. If it is more than about half a pixel, the paper has waves or creases, or is bent in two directions.
    pub residual: f64,
    /// Standard deviation of the alignment in pixels of the picture: the root mean square distance, over the picture,
    /// between true and found positions is below 1.96 times this value with a probability of about 95 %. It grows with
    /// what the model of the sheet does not hold.
    pub error: f64,
    /// The homography from pixels of the picture to pixels of the photo that is nearest to the alignment, 3 x 3, row by
    /// row. The alignment itself also follows the bent paper and the distortion of the lens.
    pub to_photo: [f64; 9],
    /// Root mean square distance, in pixels of the picture, between the alignment and to_photo: the error that an
    /// alignment by a homography would have. It is 0 for flat paper and a lens without distortion.
    pub bend: f64,
    /// Number of dots found between the marks. Sheets printed by versions before 0.2 have none.
    pub dots: u32,
    /// 0.
    pub reserved: u32,
}

versioned!(luxfer_sheet_report, [96, 112], {
    Self { struct_size: 112, marks: 0, residual: 0.0, error: 0.0, to_photo: [0.0; 9], bend: 0.0, dots: 0, reserved: 0 }
});

/// Draws the sheet to print for a picture (linear, 1 is white; 1, 3 or 4 channels). The sheet shows the picture in
/// pale colours, as large as the paper allows, with ten marks and small dots around it. Save it as PNG and print it at
/// params->dpi without scaling. params may be NULL for the defaults. The caller releases *sheet. Any thread.
/// LUXFER_INVALID_ARGUMENT if a setting is out of range or the paper is too small; LUXFER_OUT_OF_MEMORY beyond the
/// memory budget.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_sheet_print(
    picture: *mut luxfer_image,
    params: *const luxfer_sheet_params,
    sheet: *mut *mut luxfer_image,
) -> luxfer_status {
    enter(picture, |object| {
        let out = Out::new(sheet, "sheet")?;
        let params = params::read(params)?.params()?;
        let (context, picture) = (object.context(), object.image());
        let (width, height) = sheet::size(&params)?;
        let image = Pixels::counted(context, width, height, 3, || {
            let monitor = context.monitor();
            context.quick.run(|| sheet::print(picture, &params, monitor.job()))
        })?;
        out.set(handle::give(image));
        Ok(())
    })
}

/// Aligns a photo or scan (linear RGB) of a painted sheet with the picture of width x height pixels for which the
/// sheet was printed. The call finds the marks in the photo and resamples the photo to the pixels of the picture: the
/// result is the artwork, in linear RGB. params must be equal to the settings given to luxfer_sheet_print; NULL stands
/// for the defaults. The photo may be rotated and in perspective, the paper may be bent, and the lens may have radial
/// distortion about the centre of the photo. Sheets without dots, printed by versions before 0.2, are aligned too, less
/// exactly if they are bent. size is sizeof *report; report may be NULL, then size does not matter. The call takes up
/// to a few seconds. The caller releases *artwork. Any thread.
/// LUXFER_DEGENERATE if fewer than six marks are found; LUXFER_INVALID_ARGUMENT if a setting is out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn luxfer_sheet_align(
    photo: *mut luxfer_image,
    width: u32,
    height: u32,
    params: *const luxfer_sheet_params,
    artwork: *mut *mut luxfer_image,
    report: *mut luxfer_sheet_report,
    size: usize,
) -> luxfer_status {
    enter(photo, |object| {
        let out = Out::new(artwork, "artwork")?;
        let report = if report.is_null() { None } else { Some(Report::new(report, size)?) };
        let params = params::read(params)?.params()?;
        let (width, height) = (width as usize, height as usize);
        check_range("width", width, 1, MAX_SIDE)?;
        check_range("height", height, 1, MAX_SIDE)?;
        let (context, photo) = (object.context(), object.image());
        let mut numbers = luxfer_sheet_report::defaults();
        let image = Pixels::counted(context, width, height, 3, || {
            let monitor = context.monitor();
            let aligned = context.quick.run(|| sheet::align(photo, width, height, &params, monitor.job()))?;
            (numbers.marks, numbers.dots) = (aligned.marks as u32, aligned.dots as u32);
            (numbers.residual, numbers.error, numbers.bend) = (aligned.residual, aligned.error, aligned.bend);
            numbers.to_photo = aligned.to_photo.0.transpose().to_cols_array();
            Ok(aligned.image)
        })?;
        out.set(handle::give(image));
        if let Some(report) = report {
            report.set(numbers);
        }
        Ok(())
    })
}
