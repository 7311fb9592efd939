//! Files that are written whole or not at all, and read with the path in the error.

use super::ReportError;
use std::fs::{File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Beginning and end of the names of incomplete files.
const TEMPORARY: (&str, &str) = (".flexbody-", ".tmp");

/// Writes a file whole or not at all.
///
/// The bytes go to a temporary file of the same directory, are synchronised with the disk, and
/// the file is renamed over `path`: a reader sees the old file or the new one.
///
/// # Errors
/// [`ReportError::Write`] with the path; an existing file is then untouched.
pub fn atomic_write(path: &Path, bytes: &[u8]) -> Result<(), ReportError> {
    finish(prepare(path, bytes)?).map(drop)
}

/// As [`atomic_write`]. Later text is appended to the returned file. Creates its directory if it is
/// missing.
///
/// # Errors
/// As [`atomic_write`].
pub(super) fn atomic_begin(path: &Path, bytes: &[u8]) -> Result<File, ReportError> {
    make_directory(directory(path))?;
    let file = finish(prepare(path, bytes)?)?;
    synchronise_directory(directory(path))?;
    Ok(file)
}

/// Writes a group of files. All of them are on the disk under temporary names before the first one
/// gets its own name. So a full disk or a forbidden directory leaves no mixture.
///
/// Directories that are missing are made.
///
/// # Errors
/// [`ReportError::Write`] with the path of the first file that failed.
pub fn write_all(files: &[(PathBuf, Vec<u8>)]) -> Result<(), ReportError> {
    for (path, _) in files {
        make_directory(directory(path))?;
    }
    let prepared: Vec<Prepared> = files
        .iter()
        .map(|(path, bytes)| prepare(path, bytes))
        .collect::<Result<_, _>>()?;
    for file in prepared {
        finish(file)?;
    }
    for (k, (path, _)) in files.iter().enumerate() {
        let directory = directory(path);
        if files[..k]
            .iter()
            .any(|(path, _)| self::directory(path) == directory)
        {
            continue;
        }
        synchronise_directory(directory)?;
    }
    Ok(())
}

fn make_directory(path: &Path) -> Result<(), ReportError> {
    std::fs::create_dir_all(path).map_err(|source| ReportError::Write {
        path: path.to_path_buf(),
        source,
    })
}

/// The disk has the names of files only after their directory is synchronised.
#[cfg(unix)]
fn synchronise_directory(path: &Path) -> Result<(), ReportError> {
    let synchronised = File::open(path).and_then(|opened| opened.sync_all());
    synchronised.map_err(|source| ReportError::Write {
        path: path.to_path_buf(),
        source,
    })
}

#[cfg(not(unix))]
fn synchronise_directory(_: &Path) -> Result<(), ReportError> {
    Ok(())
}

/// A complete file that still has a temporary name; dropping it removes it.
struct Prepared {
    path: PathBuf,
    file: tempfile::NamedTempFile,
}

fn directory(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

fn prepare(path: &Path, bytes: &[u8]) -> Result<Prepared, ReportError> {
    let fault = |source| ReportError::Write {
        path: path.to_path_buf(),
        source,
    };
    if path.is_dir() {
        return Err(fault(std::io::ErrorKind::IsADirectory.into()));
    }
    let mut file = new_file(directory(path)).map_err(fault)?;
    file.write_all(bytes).map_err(fault)?;
    file.as_file().sync_all().map_err(fault)?;
    Ok(Prepared {
        path: path.to_path_buf(),
        file,
    })
}

/// A temporary file that others may read, like an ordinary new file. (The default of `tempfile` is
/// private to the user, and the rename would keep that.)
fn new_file(directory: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY.0).suffix(TEMPORARY.1);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}

fn finish(prepared: Prepared) -> Result<File, ReportError> {
    let Prepared { path, file } = prepared;
    file.persist(&path).map_err(|error| ReportError::Write {
        path,
        source: error.error,
    })
}

/// A directory in which no other run writes results until this is dropped or the process has ended
/// for any reason.
#[derive(Debug)]
#[must_use]
pub struct HeldDirectory {
    /// Locked while it is open; `None` on a file system without locks.
    _lock: Option<File>,
}

fn hold(path: &Path) -> Result<HeldDirectory, ReportError> {
    // A directory that can be opened can be locked itself.
    #[cfg(unix)]
    let opened = File::open(path);
    #[cfg(not(unix))]
    let opened = File::create(path.join(".flexbody.lock"));
    let file = opened.map_err(|source| ReportError::Write {
        path: path.to_path_buf(),
        source,
    })?;
    match file.try_lock() {
        Ok(()) => Ok(HeldDirectory { _lock: Some(file) }),
        Err(TryLockError::WouldBlock) => Err(ReportError::InUse {
            path: path.to_path_buf(),
        }),
        Err(TryLockError::Error(_)) => Ok(HeldDirectory { _lock: None }),
    }
}

/// Prepares a directory before any work: creates it if it is missing, locks it against other runs,
/// and removes the temporary files of killed runs.
///
/// # Errors
/// [`ReportError::InUse`] if another run holds it; the directory is then unchanged.
/// [`ReportError::Write`] with the path of the directory.
pub fn prepare_directory(path: &Path) -> Result<HeldDirectory, ReportError> {
    let fault = |source| ReportError::Write {
        path: path.to_path_buf(),
        source,
    };
    std::fs::create_dir_all(path).map_err(fault)?;
    let held = hold(path)?;
    for entry in std::fs::read_dir(path).map_err(fault)?.flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(TEMPORARY.0) && name.ends_with(TEMPORARY.1) {
            // A file that cannot be removed does no harm.
            let _ = std::fs::remove_file(entry.path());
        }
    }
    new_file(path).map_err(fault)?;
    Ok(held)
}

/// Reads a text file.
///
/// # Errors
/// [`ReportError::Read`] with the path, also if the file is not UTF-8.
pub fn read_text(path: &Path) -> Result<String, ReportError> {
    std::fs::read_to_string(path).map_err(|source| ReportError::Read {
        path: path.to_path_buf(),
        source,
    })
}

/// The relative path from the directory `from` to the directory `to`, which exist. None if there is
/// none.
pub fn path_between(from: &Path, to: &Path) -> Option<String> {
    let to = if to.as_os_str().is_empty() {
        Path::new(".")
    } else {
        to
    };
    let [from, to] = [from, to].map(|path| std::fs::canonicalize(path).ok());
    let (from, to) = (from?, to?);
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    let shared = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[shared..].iter().map(|_| Path::new(".."));
    let down = to[shared..].iter().map(|part| Path::new(part.as_os_str()));
    let path: std::path::PathBuf = up.chain(down).collect();
    Some(path.to_str()?.to_owned())
}
