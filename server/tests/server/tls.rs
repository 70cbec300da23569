//! TLS.

use crate::stand_in::StandInWorld;
use crate::test_client::TestClient;
use crate::test_server::{Server, within};
use prairie::Limits;
use prairie::net::TlsChoice;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::AsyncReadExt;
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use tokio_rustls::rustls::{self, ClientConfig, DigitallySignedStruct, SignatureScheme};

/// Trusts only the certificate with one fingerprint.
#[derive(Debug)]
struct Fingerprint(String);

impl ServerCertVerifier for Fingerprint {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer<'_>,
        _: &[CertificateDer<'_>],
        _: &ServerName<'_>,
        _: &[u8],
        _: UnixTime,
    ) -> Result<ServerCertVerified, rustls::Error> {
        let digest = ring::digest::digest(&ring::digest::SHA256, certificate);
        let fingerprint = digest.as_ref().iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(":");
        if fingerprint == self.0 {
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

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_stream_runs_over_tls() {
    let limits = Limits { handshake_timeout: Duration::from_millis(500), ..Limits::default() };
    let (server, tls) = Server::start_with(StandInWorld::default(), limits, Some(TlsChoice::SelfSigned)).await;
    let connect = async |fingerprint: String| {
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = ClientConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .unwrap()
            .dangerous()
            .with_custom_certificate_verifier(Arc::new(Fingerprint(fingerprint)))
            .with_no_client_auth();
        let stream = TcpStream::connect(server.address).await.unwrap();
        TlsConnector::from(Arc::new(config)).connect(ServerName::try_from("localhost").unwrap(), stream).await
    };
    let stream = connect(tls.unwrap().fingerprint().to_owned()).await.unwrap();
    let mut client = TestClient::over(stream, "wss://localhost/ws").await;
    client.say_hello("client").await;
    client.frame().await;
    assert!(connect("00".to_owned()).await.is_err(), "a wrong fingerprint is rejected");
    let plain = server.http("GET / HTTP/1.1").await;
    assert!(!plain.starts_with(b"HTTP/1.1 200"), "plain http is not served");
    let mut mute = TcpStream::connect(server.address).await.unwrap();
    assert_eq!(within(mute.read(&mut [0; 16])).await.unwrap_or(0), 0, "a connection without a handshake is closed");
    client.frame().await;
    server.stop().await;
}
