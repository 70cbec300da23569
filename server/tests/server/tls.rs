//! TLS.

use crate::stand_in::StandInWorld;
use crate::test_client::TestClient;
use crate::test_server::{Server, within};
use prairie::Limits;
use prairie::net::{TlsChoice, TlsSettings};
use std::io;
use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::client::TlsStream;
use tokio_rustls::rustls::client::WebPkiServerVerifier;
use tokio_rustls::rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use tokio_rustls::rustls::pki_types::pem::PemObject;
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use tokio_rustls::rustls::{self, ClientConfig, DigitallySignedStruct, RootCertStore, SignatureScheme};

/// Trusts the certificates for which a function is true.
pub(crate) struct Trust<F>(pub(crate) F);

impl<F> std::fmt::Debug for Trust<F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Trust")
    }
}

impl<F: Fn(&[u8]) -> bool + Send + Sync> ServerCertVerifier for Trust<F> {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer<'_>,
        _: &[CertificateDer<'_>],
        _: &ServerName<'_>,
        _: &[u8],
        _: UnixTime,
    ) -> Result<ServerCertVerified, rustls::Error> {
        if (self.0)(certificate) {
            Ok(ServerCertVerified::assertion())
        } else {
            Err(rustls::Error::General("another certificate".to_owned()))
        }
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = rustls::crypto::ring::default_provider().signature_verification_algorithms;
        rustls::crypto::verify_tls12_signature(message, certificate, signature, &algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = rustls::crypto::ring::default_provider().signature_verification_algorithms;
        rustls::crypto::verify_tls13_signature(message, certificate, signature, &algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        rustls::crypto::ring::default_provider().signature_verification_algorithms.supported_schemes()
    }
}

fn fingerprint(certificate: &[u8]) -> String {
    let digest = ring::digest::digest(&ring::digest::SHA256, certificate);
    digest.as_ref().iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(":")
}

/// Connects with a client that trusts what `verifier` accepts.
pub(crate) async fn handshake(address: SocketAddr, name: &str, verifier: Arc<dyn ServerCertVerifier>) -> io::Result<TlsStream<TcpStream>> {
    handshake_with(address, name, verifier, "http/1.1").await
}

/// [`handshake`] for another protocol than HTTP.
pub(crate) async fn handshake_with(
    address: SocketAddr,
    name: &str,
    verifier: Arc<dyn ServerCertVerifier>,
    protocol: &str,
) -> io::Result<TlsStream<TcpStream>> {
    let mut config = ClientConfig::builder_with_provider(Arc::new(rustls::crypto::ring::default_provider()))
        .with_safe_default_protocol_versions()
        .unwrap()
        .dangerous()
        .with_custom_certificate_verifier(verifier)
        .with_no_client_auth();
    config.alpn_protocols = vec![protocol.into()];
    let stream = TcpStream::connect(address).await.unwrap();
    TlsConnector::from(Arc::new(config)).connect(ServerName::try_from(name.to_owned()).unwrap(), stream).await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_stream_runs_over_tls() {
    let limits = Limits { handshake_timeout: Duration::from_millis(500), ..Limits::default() };
    let folder = tempfile::tempdir().unwrap();
    let settings = TlsSettings { folder: Some(folder.path().to_owned()), ..TlsSettings::new(TlsChoice::SelfSigned) };
    let (server, tls) = Server::start_with(StandInWorld::default(), limits, Some(settings)).await;
    let connect = async |expected: &str| {
        let expected = expected.to_owned();
        handshake(server.address, "localhost", Arc::new(Trust(move |certificate: &[u8]| fingerprint(certificate) == expected))).await
    };
    let stream = connect(tls.unwrap().fingerprint().unwrap()).await.unwrap();
    let mut client = TestClient::over(stream, "wss://localhost/ws").await;
    client.say_hello("client").await;
    client.frame().await;
    assert!(connect("00").await.is_err(), "a wrong fingerprint is rejected");
    let plain = server.http("GET / HTTP/1.1").await;
    assert!(!plain.starts_with(b"HTTP/1.1 200"), "plain http is not served");
    let mut mute = TcpStream::connect(server.address).await.unwrap();
    assert_eq!(within(mute.read(&mut [0; 16])).await.unwrap_or(0), 0, "a connection without a handshake is closed");
    client.frame().await;
    server.stop().await;
}

/// A verifier that trusts one certificate, as a browser trusts those of its system.
pub(crate) fn trusting(certificate: CertificateDer<'static>) -> Arc<dyn ServerCertVerifier> {
    let mut roots = RootCertStore::empty();
    roots.add(certificate).unwrap();
    WebPkiServerVerifier::builder_with_provider(Arc::new(roots), Arc::new(rustls::crypto::ring::default_provider())).build().unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn names_in_the_certificate_are_served() {
    let folder = tempfile::tempdir().unwrap();
    let [certificate, key] = ["cert.pem", "key.pem"].map(|name| folder.path().join(name));
    let generated = rcgen::generate_simple_self_signed(["play.example".to_owned(), "*.meadow.example".to_owned()]).unwrap();
    std::fs::write(&certificate, generated.cert.pem()).unwrap();
    std::fs::write(&key, generated.signing_key.serialize_pem()).unwrap();
    let settings = TlsSettings::new(TlsChoice::Files { certificate, key });
    let (server, tls) = Server::start_with(StandInWorld::default(), Limits::default(), Some(settings)).await;
    assert_eq!(tls.unwrap().folder(), None, "the server keeps nothing");
    let trusted = trusting(generated.cert.der().clone());
    for (name, status) in [("play.example", "200"), ("a.meadow.example", "200"), ("elsewhere.example", "421")] {
        let mut stream = handshake(server.address, "play.example", trusted.clone()).await.unwrap();
        stream.write_all(format!("GET / HTTP/1.0\r\nhost: {name}\r\n\r\n").as_bytes()).await.unwrap();
        let mut response = [0; 12];
        within(stream.read_exact(&mut response)).await.unwrap();
        assert_eq!(&response[9..], status.as_bytes(), "{name}");
    }
    server.stop().await;
}

#[tokio::test]
async fn a_generated_certificate_names_the_machine_and_the_names_given() {
    let folder = tempfile::tempdir().unwrap();
    let settings = TlsSettings {
        folder: Some(folder.path().to_owned()),
        names: vec!["play.example".parse().unwrap()],
        ..TlsSettings::new(TlsChoice::SelfSigned)
    };
    let (server, _) = Server::start_with(StandInWorld::default(), Limits::default(), Some(settings)).await;
    let pem = std::fs::read(folder.path().join("self-signed.pem")).unwrap();
    let verifier = trusting(CertificateDer::from_pem_slice(&pem).unwrap());
    let mut names = vec!["localhost".to_owned(), "play.example".to_owned(), hostname::get().unwrap().into_string().unwrap()];
    let interfaces = if_addrs::get_if_addrs().unwrap();
    names.extend(interfaces.iter().map(if_addrs::Interface::ip).filter(IpAddr::is_ipv4).map(|ip| ip.to_string()));
    for name in names {
        handshake(server.address, &name, verifier.clone()).await.unwrap_or_else(|error| panic!("{name}: {error}"));
    }
    assert!(handshake(server.address, "elsewhere.example", verifier).await.is_err());
    server.stop().await;
}
