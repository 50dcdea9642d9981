//! Files that are whole or not there: written beside under another name, and renamed at the end. What is no regular
//! file, as `/dev/stdout`, is written as it is. Errors name the file as it was asked for.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file under way. Dropping it leaves nothing.
#[derive(Debug)]
pub(crate) struct Whole {
    named: PathBuf,
    file: BufWriter<File>,
    /// Where it is until it is whole, and where it then belongs; none for what is no regular file.
    move_to: Option<(PathBuf, PathBuf)>,
}

impl Whole {
    /// Begins a file.
    ///
    /// # Errors
    /// A folder that is not there, or may not be written.
    pub(crate) fn begin(named: &Path) -> io::Result<Whole> {
        // A link is followed: what it points to is replaced.
        let path = std::fs::canonicalize(named).unwrap_or_else(|_| named.to_owned());
        let is_special = path.metadata().is_ok_and(|of| !of.is_file());
        let beside = path.with_added_extension("part");
        let file =
            File::create(if is_special { &path } else { &beside }).map_err(|error| at(named, &error))?;
        let move_to = (!is_special).then_some((beside, path));
        Ok(Whole { named: named.to_owned(), file: BufWriter::new(file), move_to })
    }

    /// Makes it a file under its own name.
    ///
    /// # Errors
    /// A disk that is full or fails: then there is no file, and one that was there before stays as it was.
    pub(crate) fn end(mut self) -> io::Result<()> {
        self.flush()?;
        if let Some((beside, path)) = &self.move_to {
            let moved = self.file.get_ref().sync_all().and_then(|()| std::fs::rename(beside, path));
            moved.map_err(|error| at(&self.named, &error))?;
            self.move_to = None;
        }
        Ok(())
    }
}

impl Write for Whole {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes).map_err(|error| at(&self.named, &error))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush().map_err(|error| at(&self.named, &error))
    }
}

impl Drop for Whole {
    fn drop(&mut self) {
        if let Some((beside, _)) = &self.move_to {
            // What failed before is what is told.
            let _ = std::fs::remove_file(beside);
        }
    }
}

/// Writes a file at once.
///
/// # Errors
/// As [`Whole::begin`] and [`Whole::end`].
pub(crate) fn write(named: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut whole = Whole::begin(named)?;
    whole.write_all(bytes)?;
    whole.end()
}

fn at(named: &Path, error: &io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", named.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        entries.map(|name| name.into_string().unwrap()).collect()
    }

    #[test]
    fn a_file_that_was_not_ended_is_not_there_and_the_one_before_stays() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.txt");
        let mut whole = Whole::begin(&file).unwrap();
        whole.write_all(b"half").unwrap();
        drop(whole);
        assert_eq!(names(folder.path()), [""; 0]);
        write(&file, b"before").unwrap();
        drop(Whole::begin(&file).unwrap());
        assert_eq!(std::fs::read(&file).unwrap(), b"before");
        write(&file, b"after").unwrap();
        assert_eq!(
            (std::fs::read(&file).unwrap(), names(folder.path())),
            (b"after".to_vec(), vec!["a.txt".into()])
        );
    }

    #[test]
    fn a_full_disk_and_a_missing_folder_are_named_with_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = write(&folder.path().join("nowhere/a.txt"), b"").unwrap_err().to_string();
        assert!(error.contains("nowhere/a.txt: No such file or directory"), "{error}");
        let error = write(Path::new("/dev/full"), b"text").unwrap_err();
        assert!(error.to_string().starts_with("/dev/full: No space left"), "{error}");
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(!Path::new("/dev/full.part").exists());
    }

    #[test]
    fn a_link_stays_and_what_it_points_to_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let [link, file] = ["link", "file"].map(|name| folder.path().join(name));
        write(&file, b"before").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        write(&link, b"after").unwrap();
        assert!(link.is_symlink() && std::fs::read(&file).unwrap() == b"after");
    }
}
