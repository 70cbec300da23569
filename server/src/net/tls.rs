//! Certificates: made on the spot or read from files.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;
use thiserror::Error;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::pki_types::pem::{self, PemObject};
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer};
use tokio_rustls::rustls::{self, ServerConfig};

/// Where the certificate comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TlsChoice {
    /// Made at the start and gone at the end.
    SelfSigned,
    /// Two PEM files.
    Files {
        /// The certificate, with the chain after it.
        certificate: PathBuf,
        /// Its private key.
        key: PathBuf,
    },
}

impl FromStr for TlsChoice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.split_once(',') {
            None if text == "self" => Ok(Self::SelfSigned),
            Some((certificate, key)) if !certificate.is_empty() && !key.is_empty() => {
                Ok(Self::Files { certificate: certificate.into(), key: key.into() })
            }
            _ => Err("expected `self`, or two PEM files as `CERT,KEY`".to_owned()),
        }
    }
}

/// Why there is no TLS.
#[derive(Debug, Error)]
pub enum TlsError {
    /// A file is missing, unreadable or holds something else, or certificate and key do not go together.
    #[error("{} {reason}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Why it is of no use.
        reason: String,
    },
    /// A certificate could not be made.
    #[error("cannot make a certificate: {0}")]
    Make(String),
}

/// A certificate with its key, ready for handshakes.
#[derive(Clone)]
pub struct Tls {
    pub(super) acceptor: TlsAcceptor,
    fingerprint: String,
}

impl std::fmt::Debug for Tls {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tls").field("fingerprint", &self.fingerprint).finish_non_exhaustive()
    }
}

impl Tls {
    /// Reads or makes the certificate; one that is made names localhost and the addresses that `listening` can be reached at.
    ///
    /// # Errors
    /// [`TlsError`], which names the file.
    pub fn new(choice: &TlsChoice, listening: SocketAddr) -> Result<Self, TlsError> {
        match choice {
            TlsChoice::SelfSigned => self_signed(listening),
            TlsChoice::Files { certificate, key } => from_files(certificate, key),
        }
    }

    /// SHA-256 of the certificate, as browsers show it: `AB:CD:…`.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    fn from_parts(chain: Vec<CertificateDer<'static>>, key: PrivateKeyDer<'static>) -> Result<Self, rustls::Error> {
        let digest = ring::digest::digest(&ring::digest::SHA256, &chain[0]);
        let fingerprint = digest.as_ref().iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(":");
        let mut config = ServerConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
            .with_safe_default_protocol_versions()?
            .with_no_client_auth()
            .with_single_cert(chain, key)?;
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(Self { acceptor: TlsAcceptor::from(Arc::new(config)), fingerprint })
    }
}

fn self_signed(listening: SocketAddr) -> Result<Tls, TlsError> {
    let mut names = vec!["localhost".to_owned(), "127.0.0.1".to_owned(), "::1".to_owned()];
    names.extend(reachable_ip(listening).map(|ip| ip.to_string()));
    let make = |error: rcgen::Error| TlsError::Make(error.to_string());
    let made = rcgen::generate_simple_self_signed(names).map_err(make)?;
    let key = PrivatePkcs8KeyDer::from(made.signing_key.serialize_der()).into();
    Tls::from_parts(vec![made.cert.der().clone()], key).map_err(|error| TlsError::Make(error.to_string()))
}

fn from_files(certificate: &Path, key: &Path) -> Result<Tls, TlsError> {
    let unusable = |file: &Path, reason: String| TlsError::File { file: file.to_owned(), reason };
    let in_chain = |error| unusable(certificate, fault("certificate", &error));
    let chain: Vec<_> = CertificateDer::pem_file_iter(certificate).map_err(in_chain)?.collect::<Result<_, _>>().map_err(in_chain)?;
    if chain.is_empty() {
        return Err(in_chain(pem::Error::NoItemsFound));
    }
    let key = PrivateKeyDer::from_pem_file(key).map_err(|error| unusable(key, fault("private key", &error)))?;
    Tls::from_parts(chain, key).map_err(|error| unusable(certificate, format!("cannot be served with that key: {error}")))
}

/// What is wrong with a file that should hold `what`.
fn fault(what: &str, error: &pem::Error) -> String {
    match error {
        pem::Error::Io(error) => format!("cannot be read: {error}"),
        pem::Error::NoItemsFound => format!("holds no {what} in PEM form (`-----BEGIN …`)"),
        damaged => format!("holds a damaged {what}: {damaged}"),
    }
}

/// The address at which other machines reach a listener, if they can: its own, or, if it listens on all, that of the
/// interface towards the network (nothing is sent to find out).
pub fn reachable_ip(listening: SocketAddr) -> Option<IpAddr> {
    if !listening.ip().is_unspecified() {
        return Some(listening.ip());
    }
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).ok()?;
    socket.local_addr().ok().map(|address| address.ip()).filter(|ip| !ip.is_unspecified())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LISTENING: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0);

    #[test]
    fn choices_are_read() {
        assert_eq!("self".parse(), Ok(TlsChoice::SelfSigned));
        assert_eq!("a.pem,b.pem".parse(), Ok(TlsChoice::Files { certificate: "a.pem".into(), key: "b.pem".into() }));
        for wrong in ["", "auto", ",", "a.pem,", ",b.pem"] {
            assert!(wrong.parse::<TlsChoice>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn every_certificate_made_is_another() {
        let make = || Tls::new(&TlsChoice::SelfSigned, LISTENING).unwrap();
        let (one, other) = (make(), make());
        assert_eq!(one.fingerprint().len(), 32 * 3 - 1);
        assert_ne!(one.fingerprint(), other.fingerprint());
    }

    #[test]
    fn bad_files_are_named() {
        let folder = std::env::temp_dir().join(format!("prairie-tls-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let write = |name: &str, text: &str| {
            let path = folder.join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let one = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
        let other = rcgen::generate_simple_self_signed(vec!["localhost".to_owned()]).unwrap();
        let certificate = write("good.pem", &one.cert.pem());
        let key = write("good.key", &one.signing_key.serialize_pem());
        let strange_key = write("other.key", &other.signing_key.serialize_pem());
        let text = write("text.pem", "no certificate");
        let missing = folder.join("missing.pem");
        let try_with = |certificate: &PathBuf, key: &PathBuf| {
            Tls::new(&TlsChoice::Files { certificate: certificate.clone(), key: key.clone() }, LISTENING).map(|_| ())
        };
        assert!(try_with(&certificate, &key).is_ok());
        for (bad_certificate, bad_key, named) in [
            (&missing, &key, &missing),
            (&text, &key, &text),
            (&certificate, &text, &text),
            (&certificate, &missing, &missing),
            (&certificate, &strange_key, &certificate),
        ] {
            let message = try_with(bad_certificate, bad_key).unwrap_err().to_string();
            assert!(message.starts_with(&named.display().to_string()), "{message}");
        }
        std::fs::remove_dir_all(folder).unwrap();
    }
}
