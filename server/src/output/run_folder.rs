//! The folder of a Zarr store, written without waiting for the disk: `zarrs` waits after every file, longer than a world takes for a frame.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use zarrs::filesystem::{FilesystemStore, FilesystemStoreCreateError};
use zarrs::storage::byte_range::ByteRangeIterator;
use zarrs::storage::{
    Bytes, MaybeBytesIterator, OffsetBytesIterator, ReadableStorageTraits, StorageError, StoreKey, StorePrefix, WritableStorageTraits,
    store_set_partial_many,
};

/// Name of the files of metadata.
pub(super) const METADATA: &str = "zarr.json";
/// Ending of the name of a file while it is written: files appear completely or not at all.
const UNFINISHED: &str = ".new";

/// A folder of chunks and metadata.
#[derive(Debug)]
pub(super) struct RunFolder(FilesystemStore);

impl RunFolder {
    /// The store in a folder.
    ///
    /// # Errors
    /// When its path is not UTF-8.
    pub(super) fn new(path: &Path) -> Result<Self, FilesystemStoreCreateError> {
        Ok(Self(FilesystemStore::new(path)?))
    }
}

/// Writes a file, and the folders that it is in.
fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    match (fs::write(path, bytes), path.parent()) {
        (Err(error), Some(folder)) if error.kind() == ErrorKind::NotFound => {
            fs::create_dir_all(folder)?;
            fs::write(path, bytes)
        }
        (written, _) => written,
    }
}

impl WritableStorageTraits for RunFolder {
    fn set(&self, key: &StoreKey, value: Bytes) -> Result<(), StorageError> {
        let path = self.0.key_to_fspath(key);
        let mut temporary = path.clone().into_os_string();
        temporary.push(UNFINISHED);
        let temporary = PathBuf::from(temporary);
        write(&temporary, &value)?;
        Ok(fs::rename(&temporary, &path)?)
    }

    fn set_partial_many(&self, key: &StoreKey, offset_values: OffsetBytesIterator) -> Result<(), StorageError> {
        store_set_partial_many(self, key, offset_values)
    }

    fn erase(&self, key: &StoreKey) -> Result<(), StorageError> {
        match fs::remove_file(self.0.key_to_fspath(key)) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(error.into()),
            _ => Ok(()),
        }
    }

    fn erase_prefix(&self, prefix: &StorePrefix) -> Result<(), StorageError> {
        self.0.erase_prefix(prefix)
    }

    fn supports_set_partial(&self) -> bool {
        false
    }
}

impl ReadableStorageTraits for RunFolder {
    fn get_partial_many<'a>(&'a self, key: &StoreKey, byte_ranges: ByteRangeIterator<'a>) -> Result<MaybeBytesIterator<'a>, StorageError> {
        self.0.get_partial_many(key, byte_ranges)
    }

    fn size_key(&self, key: &StoreKey) -> Result<Option<u64>, StorageError> {
        self.0.size_key(key)
    }

    fn supports_get_partial(&self) -> bool {
        self.0.supports_get_partial()
    }
}
