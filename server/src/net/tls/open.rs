//! Opens the certificate that the settings choose.

use super::acceptor::Tls;
#[cfg(feature = "acme")]
use super::acme;
use super::error::TlsError;
use super::settings::{TlsChoice, TlsSettings};
use super::{files, self_signed, store};
use crate::net::addresses::{own_addresses, own_names};
use std::net::SocketAddr;
use std::path::PathBuf;
use time::OffsetDateTime;

impl Tls {
    /// Reads, generates or begins to obtain the certificate. A generated one is valid for the names and addresses of this machine, including the
    /// address of `listening`, and for `settings.names`.
    ///
    /// A self-signed certificate is kept in the folder and generated anew when it expires within 30 days, lacks a name or address, or is damaged. If
    /// no folder was chosen and the user's data folder is not writable, it is not kept. A certificate from an ACME service is
    /// obtained and renewed by a task of the current Tokio runtime until the last clone of this value is dropped.
    ///
    /// # Errors
    /// [`TlsError`], which names the file.
    pub fn new(settings: &TlsSettings, listening: SocketAddr) -> Result<Self, TlsError> {
        let folder = || settings.folder.clone().or_else(data_folder).ok_or(TlsError::NoFolder);
        match &settings.choice {
            TlsChoice::Files { certificate, key } => files::read(certificate, key),
            TlsChoice::SelfSigned => {
                let names =
                    self_signed::Names::new(own_names().into_iter().chain(settings.names.clone()), &own_addresses(), listening.ip());
                let now = OffsetDateTime::now_utc();
                let kept = folder().and_then(|folder| store::open(&folder, &names, now));
                match kept {
                    Err(error) if settings.folder.is_none() => {
                        tracing::warn!(%error, "the certificate is not kept, so browsers will ask again after the next start; choose a folder with --tls-dir");
                        self_signed::generate(&names, now)?.into_tls()
                    }
                    kept => kept,
                }
            }
            #[cfg(feature = "acme")]
            TlsChoice::Acme { domains } => acme::start(domains, &settings.acme, &folder()?),
            #[cfg(not(feature = "acme"))]
            TlsChoice::Acme { .. } => Err(TlsError::NoAcme),
        }
    }
}

/// Prairie's folder among the user's data, such as `~/.local/share/prairie`.
fn data_folder() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "prairie").map(|folders| folders.data_dir().to_owned())
}

#[cfg(all(test, not(feature = "acme")))]
mod tests {
    use super::*;

    #[test]
    fn without_the_acme_client_the_error_says_how_to_build_it() {
        let settings = TlsSettings::new("acme:play.example".parse().unwrap());
        let error = Tls::new(&settings, ([127, 0, 0, 1], 0).into()).unwrap_err().to_string();
        assert!(error.contains("--features acme"), "{error}");
    }
}
