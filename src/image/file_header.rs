//! The header of the files of `numbers`.

/// The header of a file that stores `f64` values per pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct FileHeader {
    /// Width and height of the whole picture, in pixels.
    pub whole: [usize; 2],
    /// Column and row of the window's top-left pixel in the whole picture.
    pub corner: [usize; 2],
    /// Width and height of the window, in pixels.
    pub size: [usize; 2],
    /// Number of `f64` values per pixel.
    pub numbers: usize,
    /// The text attributes: name and text of each.
    pub attributes: Vec<(String, String)>,
}

impl FileHeader {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, text)| text.as_str())
    }
}
