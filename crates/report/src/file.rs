//! Files that appear under their names only when they are whole.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use kinstep::robot::names::shown;

/// What is gathered before it is handed to the system [bytes].
const BUFFER: usize = 1 << 18;

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// There is one of that name.
    #[error("{} is already there; give --force to replace it, or name another place", shown(.0))]
    Exists(PathBuf),
    /// There is a folder of that name.
    #[error("{} is a folder; name a file", shown(.0))]
    Folder(PathBuf),
    /// The system refused.
    #[error("{} can not be written: {}", shown(.path), plain(.source))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

fn plain(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::PermissionDenied => "permission is denied".to_owned(),
        io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        io::ErrorKind::QuotaExceeded => "the quota of the disk is used up".to_owned(),
        io::ErrorKind::FileTooLarge => "it would be larger than files may be".to_owned(),
        io::ErrorKind::ReadOnlyFilesystem => "the file system is read-only".to_owned(),
        io::ErrorKind::NotADirectory => "a file is in the place of a folder".to_owned(),
        _ => error.to_string(),
    }
}

/// Writes a file through `content` under a temporary name in the same folder, and gives it its own name at the end.
/// Whatever goes wrong, no half-written file is left.
///
/// What is replaced keeps its place: a symbolic link goes on pointing where it points, at the new file. A pipe or a device
/// is no file that could be replaced: it is written to.
///
/// # Errors
/// [`WriteError::Exists`] where something is there and `replace` is not set, [`WriteError::Folder`] where it is a folder,
/// [`WriteError::Io`] otherwise.
pub fn write_whole(
    path: &Path,
    replace: bool,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let refuse = |source| WriteError::Io { path: path.to_owned(), source };
    if path.is_dir() {
        return Err(WriteError::Folder(path.to_owned()));
    }
    if path.symlink_metadata().is_ok() && !replace {
        return Err(WriteError::Exists(path.to_owned()));
    }
    let is_special = path.metadata().is_ok_and(|found| !found.is_file());
    let written = if is_special {
        write_to(path, content)
    } else {
        target(path).and_then(|target| write_beside(&target, content))
    };
    written.map_err(refuse)
}

/// Where a path leads: through symbolic links, to what is there or would be.
fn target(path: &Path) -> io::Result<PathBuf> {
    /// As many links in a row as systems follow.
    const LINKS: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..LINKS {
        if !target.is_symlink() {
            return Ok(target);
        }
        let link = fs::read_link(&target)?;
        // A relative link is meant from its own folder; an absolute one replaces the whole path.
        target.pop();
        target.push(link);
    }
    Err(io::Error::other("its links lead in a circle"))
}

fn write_to(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::new(File::options().write(true).open(path)?);
    content(&mut out)?;
    out.flush()
}

fn write_beside(target: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let name = target.file_name().unwrap_or_default().to_string_lossy();
    let part = target.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let written = write_part(&part, content).and_then(|()| fs::rename(&part, target));
    if written.is_err() {
        // The part may not have been made; then there is nothing to take away.
        let _ = fs::remove_file(&part);
    }
    written
}

fn write_part(part: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER, File::create(part)?);
    content(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_whole_or_not_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let failing = write_whole(&path, false, |out| {
            out.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        });
        assert!(failing.unwrap_err().to_string().ends_with("can not be written: the disk is full"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        write_whole(&path, false, |out| out.write_all(b"whole")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
    }

    #[test]
    fn a_file_is_replaced_only_when_asked() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        fs::write(&path, "old").unwrap();
        assert!(matches!(write_whole(&path, false, |_| Ok(())), Err(WriteError::Exists(_))));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        write_whole(&path, true, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }

    #[test]
    fn a_folder_is_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let refused = write_whole(folder.path(), true, |_| Ok(())).unwrap_err();
        assert!(refused.to_string().ends_with(" is a folder; name a file"), "{refused}");
    }

    #[cfg(unix)]
    #[test]
    fn a_link_goes_on_pointing_at_what_is_replaced() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        fs::create_dir(place("far")).unwrap();
        fs::write(place("far/real.csv"), "old").unwrap();
        symlink("far/real.csv", place("near.csv")).unwrap();
        symlink("near.csv", place("again.csv")).unwrap();
        let write = |name: &str, replace| write_whole(&place(name), replace, |out| out.write_all(b"new"));
        assert!(matches!(write("again.csv", false), Err(WriteError::Exists(_))));
        write("again.csv", true).unwrap();
        assert!(place("again.csv").is_symlink() && place("near.csv").is_symlink());
        assert_eq!(fs::read(place("far/real.csv")).unwrap(), b"new");
        // A link that leads nowhere yet, and one that leads nowhere ever.
        symlink("far/later.csv", place("later.csv")).unwrap();
        write("later.csv", true).unwrap();
        assert_eq!(fs::read(place("far/later.csv")).unwrap(), b"new");
        symlink("round.csv", place("round.csv")).unwrap();
        assert!(write("round.csv", true).unwrap_err().to_string().contains("in a circle"));
        assert_eq!(fs::read_dir(place("far")).unwrap().count(), 2, "no part is left");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_written_to_and_stays_a_pipe() {
        use std::os::unix::fs::FileTypeExt;
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        assert!(matches!(write_whole(&pipe, false, |_| Ok(())), Err(WriteError::Exists(_))));
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).unwrap()
        });
        write_whole(&pipe, true, |out| out.write_all(b"through")).unwrap();
        assert_eq!(reader.join().unwrap(), b"through");
        assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
