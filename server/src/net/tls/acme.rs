//! Certificates from an ACME service, such as Let's Encrypt: obtained, renewed and kept by a task.

use super::acceptor::{ACME_CHALLENGE, Certificate, Renewal, Tls};
use super::error::TlsError;
use super::settings::AcmeService;
use crate::file;
use crate::net::host_name::HostName;
use futures_util::StreamExt as _;
use rustls_acme::caches::DirCache;
use rustls_acme::{AcmeConfig, AcmeState, EventOk};
use std::fs::DirBuilder;
use std::io;
use std::path::Path;
use std::sync::Arc;
use tokio::runtime::Handle;
use tokio_rustls::TlsAcceptor;
use tokio_rustls::rustls::pki_types::CertificateDer;
use tokio_rustls::rustls::pki_types::pem::PemObject as _;
use tokio_rustls::rustls::{self, ClientConfig, RootCertStore, ServerConfig};

/// Folder of accounts and certificates, below that of all certificates.
const FOLDER: &str = "acme";

/// Largest size of the file with the root certificate (bytes).
const ROOT_LIMIT: u64 = 1 << 20;

/// Begins to obtain a certificate for `domains`, unless `folder` has a valid one. Until there is one, handshakes fail.
pub(super) fn start(domains: &[HostName], service: &AcmeService, folder: &Path) -> Result<Tls, TlsError> {
    let runtime = Handle::try_current().map_err(|error| TlsError::Acme(error.to_string()))?;
    let folder = folder.join(FOLDER);
    create(&folder).map_err(|error| TlsError::Store { file: folder.clone(), reason: format!("cannot be created: {error}") })?;
    let config = match &service.root {
        None => AcmeConfig::new(domains.iter().map(HostName::as_str)),
        Some(root) => AcmeConfig::new_with_client_config(domains.iter().map(HostName::as_str), trusting(root)?),
    };
    let contact = service.email.iter().map(|email| format!("mailto:{email}"));
    let state = config.contact(contact).directory(&service.directory).cache(DirCache::new(folder.clone())).state();
    let mut server = ServerConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(|error| TlsError::Acme(error.to_string()))?
        .with_no_client_auth()
        .with_cert_resolver(state.resolver());
    server.alpn_protocols = vec![b"http/1.1".to_vec(), ACME_CHALLENGE.to_vec()];
    let task = runtime.spawn(renew(state, names(domains), service.directory.clone())).abort_handle();
    let renewal = Renewal { domains: domains.to_vec(), task };
    Ok(Tls { acceptor: TlsAcceptor::from(Arc::new(server)), certificate: Certificate::Renewed(Arc::new(renewal)), folder: Some(folder) })
}

fn names(domains: &[HostName]) -> String {
    domains.iter().map(HostName::as_str).collect::<Vec<_>>().join(", ")
}

/// Creates a folder that only the user may enter: the client writes its keys there with the default permissions.
fn create(folder: &Path) -> io::Result<()> {
    if let Some(parent) = folder.parent() {
        std::fs::create_dir_all(parent)?;
    }
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    match builder.create(folder) {
        Err(error) if !folder.is_dir() => Err(error),
        _ => Ok(()),
    }
}

/// Configuration of a client that trusts only the root certificate in a file.
fn trusting(root: &Path) -> Result<Arc<ClientConfig>, TlsError> {
    let fault = |reason: String| TlsError::File { file: root.to_owned(), reason };
    let pem = file::read(root, ROOT_LIMIT).map_err(|reason| fault(format!("cannot be read: {reason}")))?;
    let mut roots = RootCertStore::empty();
    CertificateDer::from_pem_slice(&pem)
        .map_err(|error| error.to_string())
        .and_then(|certificate| roots.add(certificate).map_err(|error| error.to_string()))
        .map_err(|error| fault(format!("contains no certificate in PEM format that can be used: {error}")))?;
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let config = ClientConfig::builder_with_provider(provider)
        .with_safe_default_protocol_versions()
        .map_err(|error| TlsError::Acme(error.to_string()))?;
    Ok(Arc::new(config.with_root_certificates(roots).with_no_client_auth()))
}

/// Obtains and renews the certificate until the server stops, and logs the results.
async fn renew(mut state: AcmeState<io::Error>, domains: String, directory: String) {
    while let Some(event) = state.next().await {
        match event {
            Ok(EventOk::DeployedCachedCert) => tracing::info!(domains, "serving the stored certificate"),
            Ok(EventOk::DeployedNewCert) => tracing::info!(domains, directory, "obtained a certificate"),
            Ok(EventOk::CertCacheStore | EventOk::AccountCacheStore) => {}
            Err(error) => tracing::warn!(%error, domains, directory, "no new certificate yet; trying again"),
        }
    }
}
