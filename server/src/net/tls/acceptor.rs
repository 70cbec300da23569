//! A certificate with its key, ready for handshakes.

use crate::net::host_name::HostName;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tokio::io::{AsyncRead, AsyncWrite};
#[cfg(feature = "acme")]
use tokio::task::AbortHandle;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::pki_types::{CertificateDer, PrivateKeyDer};
use tokio_rustls::rustls::{self, ServerConfig};
use tokio_rustls::server::TlsStream;

/// Protocol name of the connections by which an ACME service checks a domain (TLS-ALPN-01, RFC 8737).
pub(super) const ACME_CHALLENGE: &[u8] = b"acme-tls/1";

/// A certificate with its key, ready for handshakes.
#[derive(Clone)]
pub struct Tls {
    pub(super) acceptor: TlsAcceptor,
    pub(super) certificate: Certificate,
    /// Folder in which the server keeps the certificate.
    pub(super) folder: Option<PathBuf>,
}

#[derive(Clone)]
pub(super) enum Certificate {
    Fixed {
        der: CertificateDer<'static>,
        fingerprint: String,
    },
    #[cfg(feature = "acme")]
    Renewed(Arc<Renewal>),
}

/// The task that obtains and renews a certificate; it ends when this is dropped.
#[cfg(feature = "acme")]
pub(super) struct Renewal {
    pub(super) domains: Vec<HostName>,
    pub(super) task: AbortHandle,
}

#[cfg(feature = "acme")]
impl Drop for Renewal {
    fn drop(&mut self) {
        self.task.abort();
    }
}

impl std::fmt::Debug for Tls {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Tls").field("fingerprint", &self.fingerprint()).field("folder", &self.folder).finish_non_exhaustive()
    }
}

impl Tls {
    /// SHA-256 fingerprint of the certificate, as browsers show it: `AB:CD:…`; `None` if the certificate comes from an ACME service.
    pub fn fingerprint(&self) -> Option<&str> {
        match &self.certificate {
            Certificate::Fixed { fingerprint, .. } => Some(fingerprint),
            #[cfg(feature = "acme")]
            Certificate::Renewed(_) => None,
        }
    }

    /// Folder in which the server keeps the certificate; `None` if it does not.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Whether the certificate names a host.
    pub(in crate::net) fn names(&self, host: &HostName) -> bool {
        match &self.certificate {
            Certificate::Fixed { der, .. } => webpki::EndEntityCert::try_from(der)
                .is_ok_and(|certificate| certificate.verify_is_valid_for_subject_name(&host.server_name()).is_ok()),
            #[cfg(feature = "acme")]
            Certificate::Renewed(renewal) => renewal.domains.contains(host),
        }
    }

    /// Performs the handshake; `None` for a connection by which an ACME service checked a domain.
    pub(in crate::net) async fn accept<S: AsyncRead + AsyncWrite + Unpin>(&self, stream: S) -> io::Result<Option<TlsStream<S>>> {
        let stream = self.acceptor.accept(stream).await?;
        let is_challenge = stream.get_ref().1.alpn_protocol() == Some(ACME_CHALLENGE);
        Ok((!is_challenge).then_some(stream))
    }

    /// A certificate with its chain, and its key.
    pub(super) fn from_parts(chain: Vec<CertificateDer<'static>>, key: PrivateKeyDer<'static>) -> Result<Self, rustls::Error> {
        let der = chain.first().ok_or(rustls::Error::NoCertificatesPresented)?.clone();
        let digest = ring::digest::digest(&ring::digest::SHA256, &der);
        let fingerprint = digest.as_ref().iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(":");
        let mut config = ServerConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
            .with_safe_default_protocol_versions()?
            .with_no_client_auth()
            .with_single_cert(chain, key)?;
        config.alpn_protocols = vec![b"http/1.1".to_vec()];
        Ok(Self { acceptor: TlsAcceptor::from(Arc::new(config)), certificate: Certificate::Fixed { der, fingerprint }, folder: None })
    }
}
