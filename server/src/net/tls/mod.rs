//! TLS: certificates from files, self-signed ones that are kept between starts, and ones from an ACME service.

mod acceptor;
#[cfg(feature = "acme")]
mod acme;
mod error;
mod files;
mod open;
mod self_signed;
mod settings;
mod store;

pub use acceptor::Tls;
pub use error::TlsError;
pub use settings::{AcmeService, LETS_ENCRYPT, TlsChoice, TlsSettings};
