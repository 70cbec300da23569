//! TLS certificates: self-signed or read from files.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;
use thiserror::Error;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::pki_types::pem::{self, PemObject};
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer, PrivatePkcs8KeyDer};
use tokio_rustls::rustls::{self, ServerConfig};

/// Source of the certificate.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TlsChoice {
    /// A self-signed certificate, generated at the start and never stored.
    SelfSigned,
    /// Two PEM files.
    Files {
        /// The certificate, followed by its chain.
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

/// Reasons why TLS cannot be set up.
#[derive(Debug, Error)]
pub enum TlsError {
    /// A file is missing, unreadable or of another kind, or certificate and key do not match.
    #[error("{} {reason}", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// Reason why it cannot be used.
        reason: String,
    },
    /// A certificate could not be generated.
    #[error("cannot generate a certificate: {0}")]
    Generate(String),
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
    /// Reads or generates the certificate; a generated one is valid for localhost and the address at which `listening` is reachable.
    ///
    /// # Errors
    /// [`TlsError`], which names the file.
    pub fn new(choice: &TlsChoice, listening: SocketAddr) -> Result<Self, TlsError> {
        match choice {
            TlsChoice::SelfSigned => self_signed(listening),
            TlsChoice::Files { certificate, key } => from_files(certificate, key),
        }
    }

    /// SHA-256 fingerprint of the certificate, as browsers show it: `AB:CD:…`.
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
    let failed = |error: rcgen::Error| TlsError::Generate(error.to_string());
    let generated = rcgen::generate_simple_self_signed(names).map_err(failed)?;
    let key = PrivatePkcs8KeyDer::from(generated.signing_key.serialize_der()).into();
    Tls::from_parts(vec![generated.cert.der().clone()], key).map_err(|error| TlsError::Generate(error.to_string()))
}

fn from_files(certificate: &Path, key: &Path) -> Result<Tls, TlsError> {
    let unusable = |file: &Path, reason: String| TlsError::File { file: file.to_owned(), reason };
    let in_chain = |error| unusable(certificate, fault("certificate", &error));
    let chain: Vec<_> = CertificateDer::pem_file_iter(certificate).map_err(in_chain)?.collect::<Result<_, _>>().map_err(in_chain)?;
    if chain.is_empty() {
        return Err(in_chain(pem::Error::NoItemsFound));
    }
    let key = PrivateKeyDer::from_pem_file(key).map_err(|error| unusable(key, fault("private key", &error)))?;
    Tls::from_parts(chain, key).map_err(|error| unusable(certificate, format!("cannot be used with that key: {error}")))
}

/// Description of the fault in a file that should contain a `what`.
fn fault(what: &str, error: &pem::Error) -> String {
    match error {
        pem::Error::Io(error) => format!("cannot be read: {error}"),
        pem::Error::NoItemsFound => format!("contains no {what} in PEM format (`-----BEGIN …`)"),
        damaged => format!("contains a damaged {what}: {damaged}"),
    }
}

/// The address at which other machines can reach a listener: its own, or, if it listens on all addresses, that of the interface
/// towards the network. Sends no packets.
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
    fn tls_choices_are_parsed() {
        assert_eq!("self".parse(), Ok(TlsChoice::SelfSigned));
        assert_eq!("a.pem,b.pem".parse(), Ok(TlsChoice::Files { certificate: "a.pem".into(), key: "b.pem".into() }));
        for wrong in ["", "auto", ",", "a.pem,", ",b.pem"] {
            assert!(wrong.parse::<TlsChoice>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn generated_certificates_differ() {
        let make = || Tls::new(&TlsChoice::SelfSigned, LISTENING).unwrap();
        let (one, other) = (make(), make());
        assert_eq!(one.fingerprint().len(), 32 * 3 - 1);
        assert_ne!(one.fingerprint(), other.fingerprint());
    }

    #[test]
    fn errors_name_the_bad_file() {
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
