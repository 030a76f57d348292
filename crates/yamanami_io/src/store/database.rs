//! The SQLite file around a surface: written all or nothing, and opened only when it is whole.
//!
//! Everything goes to a file beside the target, named `<target>.part`, which takes the target's place at the end. A build
//! that is killed leaves the old file as it was; one that fails also removes its part.

use super::rows::row_crc32;
use super::schema::{APPLICATION_ID, CHUNK_BYTES, Content, Table};
use crate::IoError;
use rusqlite::limits::Limit;
use rusqlite::{Connection, MAIN_DB, OpenFlags, OptionalExtension, params};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A file in the making.
#[derive(Debug)]
pub(super) struct PartFile {
    target: PathBuf,
    part: PathBuf,
    /// `None` once closed.
    db: Option<Connection>,
    /// The chunk being filled, and its number.
    chunk: Vec<u8>,
    chunk_id: i64,
}

impl PartFile {
    /// Begins a file; nothing at `target` changes before [`Self::finish`].
    pub(super) fn create(target: &Path, page_bytes: u32, tables: &[Table]) -> Result<Self, IoError> {
        let target = target.to_owned();
        let mut part = target.clone().into_os_string();
        part.push(".part");
        let part = PathBuf::from(part);
        match std::fs::remove_file(&part) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(IoError::io(&part, e)),
            _ => {}
        }
        // made here, so that a missing folder or permission is told in the system's words
        std::fs::File::create_new(&part).map_err(|e| IoError::io(&part, e))?;
        let mut file = Self { target, part, db: None, chunk: Vec::new(), chunk_id: 0 };
        let db = Connection::open(&file.part).map_err(|e| file.failed(e))?;
        let db = file.db.insert(db);
        let begun = begin(db, page_bytes, tables);
        begun.map_err(|e| file.failed(e))?;
        Ok(file)
    }

    /// The name that the file is to have.
    pub(super) fn target(&self) -> &Path {
        &self.target
    }

    /// Does something with the database.
    pub(super) fn with<T>(&self, action: impl FnOnce(&Connection) -> rusqlite::Result<T>) -> Result<T, IoError> {
        let db = self.db.as_ref().ok_or_else(|| closed(&self.part))?;
        action(db).map_err(|e| self.failed(e))
    }

    /// Stores a page's bytes under its row number.
    pub(super) fn insert_page(&mut self, row: i64, bytes: &[u8]) -> Result<(), IoError> {
        if !self.chunk.is_empty() && self.chunk.len() + bytes.len() > CHUNK_BYTES {
            self.with(|db| insert_chunk(db, self.chunk_id, &self.chunk))?;
            self.chunk.clear();
            self.chunk_id += 1;
        }
        self.with(|db| {
            let mut into_page =
                db.prepare_cached("INSERT INTO page(id, chunk, start, length, crc32) VALUES(?1, ?2, ?3, ?4, ?5)")?;
            let place = [row, self.chunk_id, self.chunk.len() as i64, bytes.len() as i64];
            let [row, chunk, start, length] = place;
            into_page.execute(params![row, chunk, start, length, row_crc32(row, bytes)])
        })?;
        self.chunk.extend_from_slice(bytes);
        Ok(())
    }

    /// Closes the file, whose rows are all there but what `complete` adds, and puts it in its place.
    pub(super) fn finish(
        mut self,
        content: Content,
        complete: impl FnOnce(&Connection) -> rusqlite::Result<()>,
    ) -> Result<(), IoError> {
        let Some(db) = self.db.take() else { return Err(closed(&self.part)) };
        let done = insert_chunk(&db, self.chunk_id, &self.chunk).and_then(|()| complete(&db)).and_then(|()| {
            db.flush_prepared_statement_cache();
            db.execute_batch(&format!("PRAGMA user_version = {}; COMMIT", content as u32))
        });
        done.map_err(|e| self.failed(e))?;
        db.close().map_err(|(_, e)| self.failed(e))?;
        let file = std::fs::File::open(&self.part).map_err(|e| IoError::io(&self.part, e))?;
        file.sync_all().map_err(|e| IoError::io(&self.part, e))?;
        std::fs::rename(&self.part, &self.target).map_err(|e| IoError::io(&self.target, e))?;
        // the folder's entry too; not every system can
        if let Some(Ok(folder)) = self.target.parent().map(std::fs::File::open) {
            let _ = folder.sync_all();
        }
        Ok(())
    }

    /// What the database says, as this crate's error.
    fn failed(&self, error: rusqlite::Error) -> IoError {
        write_error(&self.part, error)
    }
}

impl Drop for PartFile {
    fn drop(&mut self) {
        // after `finish` the part has become the target and there is nothing to remove
        drop(self.db.take());
        let _ = std::fs::remove_file(&self.part);
    }
}

fn closed(part: &Path) -> IoError {
    IoError::io(part, std::io::Error::other("already closed"))
}

pub(crate) fn write_error(part: &Path, error: rusqlite::Error) -> IoError {
    use rusqlite::ErrorCode;
    let kind = match error.sqlite_error_code() {
        Some(ErrorCode::DiskFull) => std::io::ErrorKind::StorageFull,
        Some(ErrorCode::PermissionDenied | ErrorCode::ReadOnly) => std::io::ErrorKind::PermissionDenied,
        _ => std::io::ErrorKind::Other,
    };
    let message = match kind {
        std::io::ErrorKind::StorageFull => "the disk is full".to_owned(),
        _ => format!("could not be written ({error})"),
    };
    IoError::io(part, std::io::Error::new(kind, message))
}

fn begin(db: &Connection, page_bytes: u32, tables: &[Table]) -> rusqlite::Result<()> {
    // a part that breaks off is thrown away: it needs no journal
    db.execute_batch(&format!(
        "PRAGMA page_size = {page_bytes}; PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF;
         PRAGMA locking_mode = EXCLUSIVE; PRAGMA cache_size = -4096; PRAGMA application_id = {APPLICATION_ID}; BEGIN",
    ))?;
    tables.iter().try_for_each(|(_, statement)| db.execute_batch(statement))
}

fn insert_chunk(db: &Connection, id: i64, bytes: &[u8]) -> rusqlite::Result<()> {
    db.prepare_cached("INSERT INTO chunk(id, data) VALUES(?1, ?2)")?.execute(params![id, bytes]).map(|_| ())
}

/// A whole file, open for reading from any thread.
#[derive(Debug)]
pub(super) struct WholeFile {
    path: PathBuf,
    db: Mutex<Connection>,
}

impl WholeFile {
    /// Opens a file and checks that it is whole, of a version that is understood, and holds this content.
    pub(super) fn open(path: &Path, content: Content, tables: &[Table], max_row_bytes: i32) -> Result<Self, IoError> {
        let found = content_of(path)?;
        if found != content {
            let place = "bytes 60 to 63";
            return Err(IoError::malformed(path, place, content.in_words(), found.in_words()));
        }
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let db = Connection::open_with_flags(path, flags).map_err(|e| read_error(path, "database", e))?;
        check_tables(&db, tables, max_row_bytes)
            .map_err(|e| read_error(path, "database", e))?
            .map_err(|found| IoError::malformed(path, "facts", format!("{} surface", content.in_words()), found))?;
        Ok(Self { path: path.to_owned(), db: Mutex::new(db) })
    }

    /// The file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Reads from the database; `place` is told when it cannot be done.
    pub(super) fn with<T>(
        &self,
        place: &str,
        action: impl FnOnce(&Connection) -> rusqlite::Result<T>,
    ) -> Result<T, IoError> {
        action(&lock(&self.db)).map_err(|e| read_error(&self.path, place, e))
    }

    /// A page's bytes by its row number, at most `max_bytes`; an inner error says what is wrong with them.
    pub(super) fn page_bytes(&self, row: i64, max_bytes: usize) -> Result<Result<Vec<u8>, &'static str>, IoError> {
        let place = self.with("table `page`", |db| {
            db.prepare_cached("SELECT chunk, start, length, crc32 FROM page WHERE id = ?1")?
                .query_row([row], |row| Ok([row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?]))
                .optional()
        })?;
        let Some([chunk, start, length, crc32]) = place else { return Ok(Err("it is not there")) };
        let bytes = self.with("table `chunk`", |db| {
            let blob = db.blob_open(MAIN_DB, "chunk", "data", chunk, true)?;
            let within =
                |start: usize, length: usize| length <= max_bytes && start.saturating_add(length) <= blob.len();
            let place = usize::try_from(start).ok().zip(usize::try_from(length).ok());
            let Some((start, length)) = place.filter(|&(s, n)| within(s, n)) else { return Ok(None) };
            let mut bytes = vec![0; length];
            blob.read_at_exact(&mut bytes, start)?;
            Ok(Some(bytes))
        })?;
        let Some(bytes) = bytes else { return Ok(Err("it lies outside its chunk")) };
        if i64::from(row_crc32(row, &bytes)) != crc32 {
            return Ok(Err("its checksum does not match"));
        }
        Ok(Ok(bytes))
    }

    /// Lets the database check its own structure.
    pub(super) fn check_structure(&self) -> Result<(), IoError> {
        let ok: String = self.with("database", |db| db.query_row("PRAGMA quick_check(1)", [], |row| row.get(0)))?;
        if ok == "ok" { Ok(()) } else { Err(IoError::malformed(&self.path, "database", "a sound structure", ok)) }
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // nothing in here leaves half a change behind
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What SQLite says while reading, as this crate's error.
fn read_error(path: &Path, place: &str, error: rusqlite::Error) -> IoError {
    IoError::malformed(path, place, "a whole .yama file", error.to_string())
}

/// What a file holds, by its first bytes; the commonest mistakes get a plain answer.
pub(super) fn content_of(path: &Path) -> Result<Content, IoError> {
    let mut file = std::fs::File::open(path).map_err(|e| IoError::io(path, e))?;
    let metadata = file.metadata().map_err(|e| IoError::io(path, e))?;
    if metadata.is_dir() {
        return Err(IoError::io(path, std::io::ErrorKind::IsADirectory.into()));
    }
    let mut head = Vec::with_capacity(100);
    file.by_ref().take(100).read_to_end(&mut head).map_err(|e| IoError::io(path, e))?;
    let word = |at: usize| head.get(at..at + 4).map(|b| u32::from_be_bytes([b[0], b[1], b[2], b[3]]));
    let (Some(page_words), Some(db_pages), Some(version), Some(application)) = (word(16), word(28), word(60), word(68))
    else {
        return Err(IoError::malformed(path, "file", "at least 100 bytes", format!("{}", head.len())));
    };
    if !head.starts_with(b"SQLite format 3\0") {
        return Err(IoError::malformed(path, "bytes 0 to 15", "\"SQLite format 3\" (a .yama file)", "something else"));
    }
    if application != APPLICATION_ID {
        let found = format!("{application:#010x}: another program's database, or a build that broke off");
        return Err(IoError::malformed(path, "bytes 68 to 71", format!("{APPLICATION_ID:#010x}"), found));
    }
    if version == 0 {
        return Err(IoError::malformed(
            path,
            "bytes 60 to 63",
            "a finished file",
            "a build that broke off; build it again",
        ));
    }
    let content = Content::ALL.into_iter().find(|&content| content as u32 == version).ok_or_else(|| {
        let known = Content::ALL.map(|content| (content as u32).to_string()).join(" and ");
        let hint =
            format!("this program reads versions {known}: build the file again, or use the program that made it");
        IoError::unsupported(path, format!("version {version} of the format"), hint)
    })?;
    // a page size of 1 stands for 65536
    let page_bytes = match page_words >> 16 {
        1 => 65_536,
        n => u64::from(n),
    };
    let expected = page_bytes * u64::from(db_pages);
    if metadata.len() < expected {
        return Err(IoError::malformed(
            path,
            "file",
            format!("{expected} bytes"),
            format!("{}: cut short", metadata.len()),
        ));
    }
    Ok(content)
}

fn check_tables(db: &Connection, tables: &[Table], max_row_bytes: i32) -> rusqlite::Result<Result<(), String>> {
    db.set_limit(Limit::SQLITE_LIMIT_LENGTH, max_row_bytes)?;
    db.execute_batch("PRAGMA trusted_schema = OFF; PRAGMA cell_size_check = ON; PRAGMA cache_size = -2048")?;
    for (name, statement) in tables {
        let found: Option<String> = db
            .query_row("SELECT sql FROM sqlite_schema WHERE type = 'table' AND name = ?1", [name], |row| row.get(0))
            .optional()?;
        if found.as_deref() != Some(*statement) {
            return Ok(Err(format!("no table `{name}` of the expected kind")));
        }
    }
    Ok(Ok(()))
}
