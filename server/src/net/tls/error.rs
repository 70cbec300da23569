//! Reasons why TLS cannot be set up.

use crate::escaped::escaped;
use std::path::PathBuf;
use thiserror::Error;

/// Reasons why TLS cannot be set up.
#[derive(Debug, Error)]
pub enum TlsError {
    /// A file is missing, unreadable or of another kind, or certificate and key do not match.
    #[error("{} {reason}", escaped(file))]
    File {
        /// The file.
        file: PathBuf,
        /// Reason why it cannot be used.
        reason: String,
    },
    /// The folder in which certificates are kept, or a file of it, cannot be created, read or written.
    #[error("{} {reason}", escaped(file))]
    Store {
        /// The folder or file.
        file: PathBuf,
        /// Reason why it cannot be used.
        reason: String,
    },
    /// A certificate could not be generated.
    #[error("cannot generate a certificate: {0}")]
    Generate(String),
    /// The system names no data folder of the user.
    #[error("the user has no data folder to keep certificates in; choose one with --tls-dir")]
    NoFolder,
    /// This build lacks the ACME client.
    #[error("this binary was built without ACME; build it with `--features acme`")]
    NoAcme,
    /// The ACME client cannot start.
    #[error("cannot start the ACME client: {0}")]
    Acme(String),
}
