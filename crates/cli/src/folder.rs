//! The folder that a command writes its files to.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::arguments::OutArguments;
use super::failure::{Exit, Failure};
use kinstep::robot::names::shown;
use kinstep_report::{WriteError, write_whole};

/// A folder for results, and whether files in it may be replaced. One that was made for them and in which nothing was written is
/// taken away again.
pub(super) struct Folder {
    path: PathBuf,
    replace: bool,
    interrupted: Arc<AtomicBool>,
    /// What was made, the innermost first.
    made: Vec<PathBuf>,
}

impl Folder {
    /// Makes the folder, unless it is there, and refuses before anything is computed if one of `names` is in it.
    pub(super) fn open(path: &Path, replace: bool, names: &[&str]) -> Result<Self, Failure> {
        Self::named_by("--out", path, replace, names)
    }

    /// As [`Folder::open`], for the folder that another option names.
    pub(super) fn named_by(
        option: &str,
        path: &Path,
        replace: bool,
        names: &[&str],
    ) -> Result<Self, Failure> {
        if path.exists() && !path.is_dir() {
            let message = format!("{}: this is a file; {option} names a folder", shown(path));
            return Err(Failure::new(Exit::File, message).in_file(&path.display().to_string()));
        }
        let made = path.ancestors().take_while(|folder| !folder.exists()).map(Path::to_owned).collect();
        let folder = Self { path: path.to_owned(), replace, interrupted: Arc::default(), made };
        std::fs::create_dir_all(path)
            .map_err(|source| failure(&WriteError::Io { path: path.to_owned(), source }))?;
        match names.iter().map(|name| folder.path.join(name)).find(|file| file.symlink_metadata().is_ok()) {
            Some(file) if !replace => Err(failure(&WriteError::Exists(file))),
            _ => Ok(folder),
        }
    }

    /// The same folder, where writing is given up once the flag is set.
    #[must_use]
    pub(super) fn interruptible(mut self, interrupted: Arc<AtomicBool>) -> Self {
        self.interrupted = interrupted;
        self
    }

    /// Where it is.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file that is whole or not there.
    pub(super) fn write(
        &self,
        name: &str,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let content =
            |out: &mut dyn Write| content(&mut Interruptible { out, interrupted: &self.interrupted });
        write_whole(&self.path.join(name), self.replace, content).map_err(|e| failure(&e))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        for made in &self.made {
            // A folder that is not empty stays.
            let _ = std::fs::remove_dir(made);
        }
    }
}

impl OutArguments {
    /// [Opens](Folder::open) the folder that was asked for, if one was.
    pub(super) fn folder(&self, names: &[&str]) -> Result<Option<Folder>, Failure> {
        self.out.as_deref().map(|path| Folder::open(path, self.force, names)).transpose()
    }
}

/// A writer that fails once a flag is set.
struct Interruptible<'a> {
    out: &'a mut dyn Write,
    interrupted: &'a AtomicBool,
}

impl Write for Interruptible<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.interrupted.load(Ordering::Relaxed) {
            return Err(io::Error::other("it was interrupted"));
        }
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Writes one file that is whole or not there.
pub(super) fn write_file(path: &Path, replace: bool, text: &str) -> Result<(), Failure> {
    write_whole(path, replace, |out| out.write_all(text.as_bytes())).map_err(|e| failure(&e))
}

fn failure(error: &WriteError) -> Failure {
    let file = match error {
        WriteError::Exists(path) | WriteError::Folder(path) | WriteError::Io { path, .. } => {
            path.display().to_string()
        }
    };
    Failure::new(Exit::File, error.to_string()).in_file(&file)
}
