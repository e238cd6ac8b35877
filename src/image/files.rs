//! Reads and writes whole files. If a regular file cannot be written, its old content remains, with the exceptions
//! below.
//!
//! A regular file is replaced as a whole: the bytes are written to a new file in the same folder, which takes over the
//! mode and the owner of the old file and is then renamed to replace it. Symbolic links are followed. Targets that
//! cannot be replaced in this way are written in place: a device, a FIFO, a file with several names (hard links), or a
//! file in a folder that accepts no new files. A failed write may then leave part of the new content.

use crate::error::{Error, ErrorKind, Result};
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Reads a whole file. Devices and FIFOs are refused, because reading them may never end.
pub fn read_file(path: &Path) -> Result<Vec<u8>> {
    check_regular(path)?;
    fs::read(path).map_err(|e| failed(path, &e))
}

/// Returns an error unless the path leads to a regular file.
pub fn check_regular(path: &Path) -> Result<()> {
    if fs::metadata(path).map_err(|e| failed(path, &e))?.is_file() {
        return Ok(());
    }
    Err(Error::new(ErrorKind::Io, format!("{} is not a regular file", path.display())))
}

/// Writes a whole file. After an error the old content remains, except if the file had to be written in place.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<()> {
    Target::new(path)?.write(bytes)
}

fn failed(path: &Path, e: &io::Error) -> Error {
    let is_memory = e.kind() == io::ErrorKind::OutOfMemory;
    let kind = if is_memory { ErrorKind::OutOfMemory } else { ErrorKind::Io };
    Error::new(kind, format!("{}: {e}", path.display()))
}

/// A file that will be written. Its path is checked before the content is computed, so that a missing folder is
/// reported early.
pub struct Target {
    path: PathBuf,
    way: Way,
}

enum Way {
    /// The file does not exist yet: its path with all symbolic links resolved.
    Create(PathBuf),
    /// The file is regular and can be replaced: its path with all symbolic links resolved, and its metadata.
    Replace(PathBuf, Metadata),
    InPlace,
}

impl Target {
    /// Checks the path and chooses the way of writing; returns an error if no file can be written there.
    pub fn new(path: &Path) -> Result<Self> {
        let way = match fs::metadata(path) {
            Ok(old) if old.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
            Ok(old) if old.is_file() => existing(path, old),
            Ok(_) => Ok(Way::InPlace),
            Err(e) if e.kind() == io::ErrorKind::NotFound => new(path),
            // On Windows, metadata cannot be read for devices such as NUL: write to them in place.
            Err(_) if cfg!(windows) => Ok(Way::InPlace),
            Err(e) => Err(e),
        };
        Ok(Self { path: path.to_path_buf(), way: way.map_err(|e| failed(path, &e))? })
    }

    pub fn write(&self, bytes: &[u8]) -> Result<()> {
        let written = match &self.way {
            Way::Create(file) => replace(file, None, bytes),
            Way::Replace(file, old) => match replace(file, Some(old), bytes) {
                Err(e) if is_refusal(&e) => overwrite(file, bytes),
                result => result,
            },
            Way::InPlace => overwrite(&self.path, bytes),
        };
        written.map_err(|e| failed(&self.path, &e))
    }
}

fn existing(path: &Path, old: Metadata) -> io::Result<Way> {
    // Refuse a write-protected file, even if the folder would allow its replacement.
    OpenOptions::new().write(true).open(path)?;
    let file = follow(path)?;
    Ok(if system::is_replaceable(&file, &old) { Way::Replace(file, old) } else { Way::InPlace })
}

fn new(path: &Path) -> io::Result<Way> {
    let file = follow(path)?;
    let folder = folder_of(&file);
    match fs::metadata(folder) {
        Ok(found) if found.is_dir() => Ok(Way::Create(file)),
        Ok(_) => Err(io::Error::other(format!("{} is not a folder", folder.display()))),
        Err(e) => Err(io::Error::new(e.kind(), format!("the folder {}: {e}", folder.display()))),
    }
}

/// Maximum number of symbolic links in a chain. A longer chain counts as a loop, as in Linux. [convention]
const MAX_LINKS: usize = 40;

/// Follows a chain of symbolic links and returns the path of its target, which need not exist.
fn follow(path: &Path) -> io::Result<PathBuf> {
    let mut file = path.to_path_buf();
    for _ in 0..MAX_LINKS {
        match fs::read_link(&file) {
            Ok(link) => file = folder_of(&file).join(link),
            Err(_) => return Ok(file),
        }
    }
    Err(io::Error::other("too many symbolic links"))
}

fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes a new file in the folder of `file`, and renames it to `file`. `old` is the metadata of the file that is
/// replaced, if there is one. After an error, the new file is removed, and `file` is unchanged.
fn replace(file: &Path, old: Option<&Metadata>, bytes: &[u8]) -> io::Result<()> {
    let (path, mut neighbour) = create_neighbour(file, old.is_some())?;
    let written = fill(&mut neighbour, old, bytes);
    drop(neighbour);
    let done = written.and_then(|()| fs::rename(&path, file));
    if done.is_err() {
        let _ = fs::remove_file(&path);
    }
    done
}

/// Maximum number of names to try for the new file. Other threads, and earlier processes with the same id, may have
/// taken some names.
const MAX_NEIGHBOURS: usize = 10_000;

/// Creates a new file in the folder of `file`; returns its path and the open file. If `is_private`, only the owner may
/// read it.
fn create_neighbour(file: &Path, is_private: bool) -> io::Result<(PathBuf, File)> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    if is_private {
        system::make_private(&mut options);
    }
    for number in 0..MAX_NEIGHBOURS {
        let path = folder_of(file).join(format!(".luxfer-{}-{number}.part", std::process::id()));
        match options.open(&path) {
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            result => return result.map(|file| (path, file)),
        }
    }
    Err(io::ErrorKind::AlreadyExists.into())
}

/// Writes the content of the new file to disk. `old` is the metadata of the file that will be replaced, if there is
/// one; the new file gets the mode and the owner of that file.
fn fill(neighbour: &mut File, old: Option<&Metadata>, bytes: &[u8]) -> io::Result<()> {
    if let Some(old) = old {
        system::keep_owner(neighbour, old)?;
    }
    neighbour.write_all(bytes)?;
    if let Some(old) = old {
        neighbour.set_permissions(old.permissions())?;
    }
    flush(neighbour)
}

/// Flushes a file to disk, if the file system supports this.
fn flush(file: &File) -> io::Result<()> {
    match file.sync_all() {
        Err(e) if matches!(e.kind(), io::ErrorKind::Unsupported | io::ErrorKind::InvalidInput) => Ok(()),
        result => result,
    }
}

/// Whether an error means that a file cannot be replaced by renaming: its folder accepts no new files, its owner
/// cannot be kept, or it is a mount point.
fn is_refusal(e: &io::Error) -> bool {
    use io::ErrorKind::{CrossesDevices, PermissionDenied, ReadOnlyFilesystem, ResourceBusy};
    matches!(e.kind(), CrossesDevices | PermissionDenied | ReadOnlyFilesystem | ResourceBusy)
}

/// Overwrites a file in place. If it is a regular file, it is then cut to the new length.
fn overwrite(path: &Path, bytes: &[u8]) -> io::Result<()> {
    system::check_reader(path)?;
    let mut file = OpenOptions::new().write(true).open(path)?;
    file.write_all(bytes)?;
    if file.metadata().is_ok_and(|found| found.is_file()) {
        file.set_len(bytes.len() as u64)?;
        flush(&file)?;
    }
    file.flush()
}

#[cfg(unix)]
mod system {
    use std::fs::{self, File, Metadata, OpenOptions};
    use std::io;
    use std::os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt, fchown};
    use std::path::Path;

    /// Whether a file has only one name (hard link), and `file` is that name. (Links in /proc may lead to a file
    /// without a name.)
    pub fn is_replaceable(file: &Path, old: &Metadata) -> bool {
        old.nlink() <= 1 && fs::metadata(file).is_ok_and(|found| found.is_file())
    }

    /// Lets only the owner read the new file until it receives the mode of the old file.
    pub fn make_private(options: &mut OpenOptions) {
        options.mode(0o600);
    }

    pub fn keep_owner(file: &File, old: &Metadata) -> io::Result<()> {
        let new = file.metadata()?;
        let is_same = (new.uid(), new.gid()) == (old.uid(), old.gid());
        if is_same { Ok(()) } else { fchown(file, Some(old.uid()), Some(old.gid())) }
    }

    /// Returns an error if `path` is a FIFO without a reader: opening it to write would wait for one.
    pub fn check_reader(path: &Path) -> io::Result<()> {
        if fs::metadata(path)?.file_type().is_fifo() {
            OpenOptions::new().write(true).custom_flags(libc::O_NONBLOCK).open(path)?;
        }
        Ok(())
    }
}

/// On systems other than Unix, the new file gets the owner and the access rights that its folder gives it.
#[cfg(not(unix))]
mod system {
    use std::fs::{File, Metadata, OpenOptions};
    use std::io;
    use std::path::Path;

    pub fn is_replaceable(_: &Path, _: &Metadata) -> bool {
        true
    }

    pub fn make_private(_: &mut OpenOptions) {}

    pub fn keep_owner(_: &File, _: &Metadata) -> io::Result<()> {
        Ok(())
    }

    pub fn check_reader(_: &Path) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};

    /// Creates an empty folder for one test.
    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("luxfer-files-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir(&folder).unwrap();
        folder
    }

    fn names(folder: &Path) -> usize {
        fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn links_stay_links_and_their_targets_are_written() {
        let folder = folder("links");
        let (real, link, second, dangling) =
            (folder.join("real"), folder.join("link"), folder.join("second"), folder.join("dangling"));
        fs::write(&real, "old").unwrap();
        symlink("real", &link).unwrap();
        symlink(&link, &second).unwrap();
        symlink("made", &dangling).unwrap();
        write_file(&second, b"new").unwrap();
        write_file(&dangling, b"made").unwrap();
        assert!([&link, &second, &dangling].iter().all(|path| path.is_symlink()));
        assert_eq!((fs::read(&real).unwrap(), fs::read(folder.join("made")).unwrap()), (b"new".into(), b"made".into()));
        symlink("loop", folder.join("loop")).unwrap();
        assert_eq!(write_file(&folder.join("loop"), b"").unwrap_err().kind, ErrorKind::Io);
        // A file with two names (hard links) keeps both.
        fs::hard_link(&real, folder.join("name")).unwrap();
        write_file(&real, b"both").unwrap();
        write_file(&real, b"two").unwrap();
        assert_eq!(fs::read(folder.join("name")).unwrap(), b"two");
        assert_eq!(names(&folder), 7, "no neighbour is left");
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn mode_and_owner_are_kept() {
        let folder = folder("mode");
        let file = folder.join("file");
        for mode in [0o600, 0o640, 0o755] {
            fs::write(&file, "old").unwrap();
            fs::set_permissions(&file, fs::Permissions::from_mode(mode)).unwrap();
            // Only an administrator may change the owner of a file, so this may fail.
            let given = std::os::unix::fs::chown(&file, Some(12_345), Some(54_321)).is_ok();
            let before = fs::metadata(&file).unwrap();
            write_file(&file, b"new").unwrap();
            let after = fs::metadata(&file).unwrap();
            assert_eq!((after.mode(), after.uid(), after.gid()), (before.mode(), before.uid(), before.gid()));
            assert!(!given || after.uid() == 12_345);
            assert_ne!(after.ino(), before.ino(), "replaced as a whole");
            assert_eq!(fs::read(&file).unwrap(), b"new");
        }
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn devices_and_fifos_stay_and_are_not_read() {
        let folder = folder("devices");
        let fifo = folder.join("fifo");
        let made = std::process::Command::new("mkfifo").arg(&fifo).status();
        assert!(made.unwrap().success());
        assert_eq!(read_file(&fifo).unwrap_err().message, format!("{} is not a regular file", fifo.display()));
        // Writing to a FIFO without a reader gives an error and does not wait forever.
        assert_eq!(write_file(&fifo, b"lost").unwrap_err().kind, ErrorKind::Io);
        let mut reader = OpenOptions::new().read(true).write(true).open(&fifo).unwrap();
        write_file(&fifo, b"through").unwrap();
        let mut read = [0; 7];
        io::Read::read_exact(&mut reader, &mut read).unwrap();
        assert_eq!(&read, b"through");
        assert!(fs::metadata(&fifo).unwrap().file_type().is_fifo());
        // Writing to a device must not replace it by a file. Write through a link to the device: if `write_file`
        // wrongly replaced the path that it is given, only the link would be lost.
        let null = folder.join("null");
        symlink("/dev/null", &null).unwrap();
        write_file(&null, b"away").unwrap();
        assert!(null.is_symlink() && fs::metadata(&null).unwrap().file_type().is_char_device());
        for device in ["/dev/zero", "/dev/null"] {
            assert_eq!(read_file(Path::new(device)).unwrap_err().kind, ErrorKind::Io);
        }
        assert_eq!(names(&folder), 2);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn missing_folders_are_found_before_the_work() {
        let folder = folder("missing");
        let error = Target::new(&folder.join("no/file")).err().unwrap();
        assert!(error.kind == ErrorKind::Io && error.message.contains("the folder "), "{error}");
        fs::write(folder.join("file"), "old").unwrap();
        assert_eq!(Target::new(&folder.join("file/file")).err().unwrap().kind, ErrorKind::Io);
        assert_eq!(Target::new(&folder).err().unwrap().kind, ErrorKind::Io);
        assert_eq!(names(&folder), 1);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn threads_that_save_to_one_path_leave_one_whole_file() {
        let folder = folder("threads");
        let file = folder.join("file");
        std::thread::scope(|scope| {
            for letter in *b"abcdefgh" {
                let file = &file;
                scope.spawn(move || (0..20).for_each(|_| write_file(file, &[letter; 100_000]).unwrap()));
            }
        });
        let bytes = fs::read(&file).unwrap();
        assert!(bytes.len() == 100_000 && bytes.iter().all(|&b| b == bytes[0]));
        assert_eq!(names(&folder), 1);
        fs::remove_dir_all(folder).unwrap();
    }
}
