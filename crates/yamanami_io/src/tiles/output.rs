//! Where tiles go: a folder that appears whole under its name, and goes on where a killed run stopped.

use crate::IoError;
use std::fs;
use std::io::ErrorKind;
use std::path::{Component, Path, PathBuf};

/// Receives the files of a tile tree, from several threads.
pub trait TileOutput: Sync {
    /// Writes one file; `path` is relative, its parts divided by `/`. The file appears whole or not at all.
    fn put(&self, path: &str, bytes: &[u8]) -> Result<(), IoError>;

    /// Whether the file is there already: then it need not be made again.
    fn has(&self, path: &str) -> bool;
}

/// In an unfinished tree: what it is made of.
const JOB: &str = ".job";

/// In a finished tree: that it is one of ours, so that it may be replaced.
const MARK: &str = ".yamanami";

/// A folder of tiles. Until [`finish`](Self::finish) they are in `TARGET.part`, and an older `TARGET` stays as it is.
#[derive(Debug)]
pub struct TileFolder {
    target: PathBuf,
    part: PathBuf,
    resumed: bool,
}

impl TileFolder {
    /// Begins a tree that will be `target`, or goes on with an unfinished one of the same `job` (a text that says all that
    /// the tiles depend on). Refuses a target that holds something else than tiles of ours.
    pub fn create(target: &Path, job: &str) -> Result<Self, IoError> {
        let (part, old) = (beside(target, "part"), beside(target, "old"));
        // a run that was killed while it took the target's place
        if old.join(MARK).is_file() {
            if target.exists() {
                remove(&old)?;
            } else {
                fs::rename(&old, target).map_err(|e| IoError::io(target, e))?;
            }
        }
        check_target(target)?;
        let mut resumed = false;
        match fs::symlink_metadata(&part) {
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            Err(e) => return Err(IoError::io(&part, e)),
            Ok(meta) if meta.is_dir() && (part.join(JOB).is_file() || part.join(MARK).is_file()) => {
                resumed = fs::read(part.join(JOB)).is_ok_and(|known| known == job.as_bytes());
                if !resumed {
                    remove(&part)?;
                }
            }
            Ok(meta) => {
                let empty = meta.is_dir() && is_empty(&part)?;
                if !empty {
                    let what = "is in the way of the unfinished tiles and is none of ours";
                    return Err(IoError::unsupported(&part, what, "move it away or give another name"));
                }
            }
        }
        if !resumed {
            fs::create_dir_all(&part).map_err(|e| IoError::io(&part, e))?;
            write_whole(&part.join(JOB), job.as_bytes())?;
        }
        Ok(Self { target: target.to_owned(), part, resumed })
    }

    /// Whether it goes on with an earlier run's tiles.
    pub fn is_resumed(&self) -> bool {
        self.resumed
    }

    /// Where the tiles are until the tree is finished.
    pub fn part(&self) -> &Path {
        &self.part
    }

    /// Gives the tree its name, in place of an older one.
    pub fn finish(self) -> Result<(), IoError> {
        check_target(&self.target)?;
        write_whole(&self.part.join(MARK), b"tiles written by yamanami\n")?;
        let job = self.part.join(JOB);
        fs::remove_file(&job).map_err(|e| IoError::io(&job, e))?;
        let failed = |e| IoError::io(&self.target, e);
        if !self.target.exists() {
            return fs::rename(&self.part, &self.target).map_err(failed);
        }
        let old = beside(&self.target, "old");
        // an empty folder has no mark, by which a later run would know it
        if is_empty(&self.target)? {
            fs::remove_dir(&self.target).map_err(failed)?;
            return fs::rename(&self.part, &self.target).map_err(failed);
        }
        fs::rename(&self.target, &old).map_err(failed)?;
        if let Err(e) = fs::rename(&self.part, &self.target) {
            // the old tree is better than none; the first failure is the one to report
            let _ = fs::rename(&old, &self.target);
            return Err(failed(e));
        }
        remove(&old)
    }

    fn place(&self, path: &str) -> Option<PathBuf> {
        let relative = Path::new(path);
        let plain = relative.components().all(|part| matches!(part, Component::Normal(_)));
        (plain && !path.is_empty()).then(|| self.part.join(relative))
    }
}

impl TileOutput for TileFolder {
    fn put(&self, path: &str, bytes: &[u8]) -> Result<(), IoError> {
        let place = self.place(path).ok_or_else(|| IoError::BadRequest {
            what: "path of a tile".to_owned(),
            expected: "a relative path within the tree".to_owned(),
            given: path.to_owned(),
        })?;
        write_whole(&place, bytes)
    }

    fn has(&self, path: &str) -> bool {
        self.place(path).is_some_and(|place| place.is_file())
    }
}

/// `target.ending`, beside the target.
fn beside(target: &Path, ending: &str) -> PathBuf {
    // the name of "tiles/" is that of "tiles"
    let mut name = target.components().as_path().as_os_str().to_owned();
    name.push(".");
    name.push(ending);
    PathBuf::from(name)
}

fn check_target(target: &Path) -> Result<(), IoError> {
    let meta = match fs::symlink_metadata(target) {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(()),
        other => other.map_err(|e| IoError::io(target, e))?,
    };
    let hint = "give another name with -o";
    if !meta.is_dir() {
        return Err(IoError::unsupported(target, "is no folder", hint));
    }
    if target.join(MARK).is_file() || is_empty(target)? {
        return Ok(());
    }
    Err(IoError::unsupported(target, "is a folder with something else than tiles of ours in it", hint))
}

fn is_empty(folder: &Path) -> Result<bool, IoError> {
    Ok(fs::read_dir(folder).map_err(|e| IoError::io(folder, e))?.next().is_none())
}

fn remove(folder: &Path) -> Result<(), IoError> {
    fs::remove_dir_all(folder).map_err(|e| IoError::io(folder, e))
}

/// Writes beside the place and takes the name when all is written; makes the folders on the way.
fn write_whole(place: &Path, bytes: &[u8]) -> Result<(), IoError> {
    let part = beside(place, "tmp");
    let written = fs::write(&part, bytes).or_else(|e| match (e.kind(), place.parent()) {
        (ErrorKind::NotFound, Some(folder)) => {
            fs::create_dir_all(folder)?;
            fs::write(&part, bytes)
        }
        _ => Err(e),
    });
    written.and_then(|()| fs::rename(&part, place)).map_err(|e| {
        // the first failure is the one to report
        let _ = fs::remove_file(&part);
        IoError::io(place, e)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tree_appears_when_it_is_whole() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("tiles");
        let first = TileFolder::create(&target, "a").unwrap();
        first.put("0/1/2.terrain", b"x").unwrap();
        assert!(first.has("0/1/2.terrain") && !first.has("0/1/3.terrain") && !target.exists());
        first.finish().unwrap();
        assert_eq!(fs::read(target.join("0/1/2.terrain")).unwrap(), b"x");

        let second = TileFolder::create(&target, "b").unwrap();
        second.put("0/0/0.terrain", b"y").unwrap();
        assert!(target.join("0/1/2.terrain").exists(), "the old tree is there until the new one is");
        second.finish().unwrap();
        assert!(target.join("0/0/0.terrain").exists() && !target.join("0/1/2.terrain").exists());
        assert_eq!(fs::read_dir(root.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_killed_run_goes_on_only_with_the_same_job() {
        let root = tempfile::tempdir().unwrap();
        let target = root.path().join("tiles");
        let killed = TileFolder::create(&target, "a").unwrap();
        killed.put("1.terrain", b"x").unwrap();
        let again = TileFolder::create(&target, "a").unwrap();
        assert!(again.is_resumed() && again.has("1.terrain"));
        let other = TileFolder::create(&target, "b").unwrap();
        assert!(!other.is_resumed() && !other.has("1.terrain"));
    }

    #[test]
    fn what_is_not_ours_stays() {
        let root = tempfile::tempdir().unwrap();
        for name in ["tiles", "tiles.part"] {
            let folder = root.path().join(name);
            fs::create_dir(&folder).unwrap();
            assert!(TileFolder::create(&root.path().join("tiles"), "a").is_ok(), "an empty folder is nobody's");
            fs::remove_dir_all(root.path().join("tiles.part")).unwrap();
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join("letter.txt"), "x").unwrap();
            let line = TileFolder::create(&root.path().join("tiles"), "a").unwrap_err().to_string();
            assert!(line.contains("ours"), "{line}");
            fs::remove_dir_all(&folder).unwrap();
        }
        fs::write(root.path().join("file"), "x").unwrap();
        assert!(TileFolder::create(&root.path().join("file"), "a").is_err());
    }

    #[test]
    fn no_path_leads_out() {
        let root = tempfile::tempdir().unwrap();
        let folder = TileFolder::create(&root.path().join("tiles"), "a").unwrap();
        for path in ["", "../x", "/x", "a/../../x"] {
            assert!(folder.put(path, b"x").is_err(), "{path}");
        }
    }
}
