//! A certificate from an ACME service: here a minimal one in this process, which checks the domain as Let's Encrypt does (TLS-ALPN-01).

use crate::stand_in::StandInWorld;
use crate::test_client::TestClient;
use crate::test_server::{Server, within};
use crate::tls::{Trust, handshake, handshake_with, trusting};
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::{Router, routing};
use data_encoding::BASE64URL_NOPAD;
use prairie::Limits;
use prairie::net::{AcmeService, TlsChoice, TlsSettings};
use rcgen::{BasicConstraints, CertificateParams, CertifiedIssuer, IsCa, KeyPair, PublicKeyData, SignatureAlgorithm};
use ring::digest::{SHA256, digest};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::path::Path as FilePath;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::watch;
use tokio::task::JoinHandle;
use x509_parser::prelude::{FromDer as _, X509CertificationRequest};

const DOMAIN: &str = "play.example";
const TOKEN: &str = "token";

/// An ACME service for one domain and one order.
struct Service {
    url: String,
    issuer: CertifiedIssuer<'static, KeyPair>,
    /// Address at which it checks the domain.
    domain_at: watch::Receiver<Option<SocketAddr>>,
    order: Mutex<Order>,
}

#[derive(Default)]
struct Order {
    contact: Value,
    thumbprint: String,
    is_checked: bool,
    certificate: Option<String>,
}

/// The public key of a certificate signing request.
struct RequestedKey(Vec<u8>);

impl PublicKeyData for RequestedKey {
    fn der_bytes(&self) -> &[u8] {
        &self.0
    }

    fn algorithm(&self) -> &'static SignatureAlgorithm {
        &rcgen::PKCS_ECDSA_P256_SHA256
    }
}

impl Service {
    async fn start(domain_at: watch::Receiver<Option<SocketAddr>>) -> (Arc<Self>, JoinHandle<()>) {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let mut params = CertificateParams::default();
        params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        let issuer = CertifiedIssuer::self_signed(params, KeyPair::generate().unwrap()).unwrap();
        let url = format!("http://{}", listener.local_addr().unwrap());
        let service = Arc::new(Self { url, issuer, domain_at, order: Mutex::default() });
        let routes = Router::new().route("/{request}", routing::get(get).post(post)).with_state(service.clone());
        let task = tokio::spawn(async { axum::serve(listener, routes).await.unwrap() });
        (service, task)
    }

    fn state(&self) -> Value {
        let (url, order) = (&self.url, self.order.lock().unwrap());
        let status = match (order.is_checked, &order.certificate) {
            (false, _) => "pending",
            (true, None) => "ready",
            (true, Some(_)) => "valid",
        };
        json!({ "status": status, "authorizations": [format!("{url}/authorization")], "finalize": format!("{url}/finalize"),
            "certificate": format!("{url}/certificate") })
    }

    /// Connects to the domain as the protocol says, and looks for the proof in the certificate.
    async fn check_domain(&self) {
        let address = self.domain_at.clone().wait_for(Option::is_some).await.unwrap().unwrap();
        let proof = digest(&SHA256, format!("{TOKEN}.{}", self.order.lock().unwrap().thumbprint).as_bytes());
        let has_proof = Arc::new(AtomicBool::new(false));
        let seen = has_proof.clone();
        let look = Trust(move |certificate: &[u8]| {
            seen.store(certificate.windows(32).any(|bytes| bytes == proof.as_ref()), Relaxed);
            true
        });
        // It fails after that, because this client does not know the critical extension with the proof.
        let _ = handshake_with(address, DOMAIN, Arc::new(look), "acme-tls/1").await;
        self.order.lock().unwrap().is_checked = has_proof.load(Relaxed);
    }

    fn sign(&self, request: &str) {
        let der = BASE64URL_NOPAD.decode(request.as_bytes()).unwrap();
        let (_, request) = X509CertificationRequest::from_der(&der).unwrap();
        let key = RequestedKey(request.certification_request_info.subject_pki.subject_public_key.data.to_vec());
        let signed = CertificateParams::new([DOMAIN.to_owned()]).unwrap().signed_by(&key, &self.issuer).unwrap();
        self.order.lock().unwrap().certificate = Some(signed.pem());
    }
}

/// The directory, and for any other path a nonce without content, which the client would wait for in the answer to HEAD.
async fn get(State(service): State<Arc<Service>>, Path(request): Path<String>) -> impl IntoResponse {
    let url = &service.url;
    let directory =
        json!({ "newNonce": format!("{url}/nonce"), "newAccount": format!("{url}/account"), "newOrder": format!("{url}/order") });
    ([("replay-nonce", "nonce")], if request == "directory" { directory.to_string() } else { String::new() })
}

async fn post(State(service): State<Arc<Service>>, Path(request): Path<String>, body: String) -> Response {
    let body: Value = serde_json::from_str(&body).unwrap();
    let part = |name: &str| -> Value {
        let bytes = BASE64URL_NOPAD.decode(body[name].as_str().unwrap().as_bytes()).unwrap();
        serde_json::from_slice(&bytes).unwrap_or_default()
    };
    let (protected, payload) = (part("protected"), part("payload"));
    let mut headers = HeaderMap::new();
    headers.insert(header::LOCATION, format!("{}/{request}", service.url).parse().unwrap());
    let answer = match request.as_str() {
        "account" => {
            // RFC 7638: the members in this order, without spaces.
            let key = &protected["jwk"];
            let thumbprint = format!(r#"{{"crv":{},"kty":{},"x":{},"y":{}}}"#, key["crv"], key["kty"], key["x"], key["y"]);
            let mut order = service.order.lock().unwrap();
            order.thumbprint = BASE64URL_NOPAD.encode(digest(&SHA256, thumbprint.as_bytes()).as_ref());
            order.contact = payload["contact"].clone();
            json!({})
        }
        "authorization" => {
            let status = if service.order.lock().unwrap().is_checked { "valid" } else { "pending" };
            let challenge = json!({ "type": "tls-alpn-01", "url": format!("{}/challenge", service.url), "token": TOKEN });
            json!({ "status": status, "identifier": { "type": "dns", "value": DOMAIN }, "challenges": [challenge] })
        }
        "challenge" => {
            service.check_domain().await;
            json!({})
        }
        "order" => service.state(),
        "finalize" => {
            service.sign(payload["csr"].as_str().unwrap());
            service.state()
        }
        "certificate" => return service.order.lock().unwrap().certificate.clone().unwrap().into_response(),
        _ => return StatusCode::NOT_FOUND.into_response(),
    };
    (headers, answer.to_string()).into_response()
}

fn settings(service: &Service, folder: &FilePath) -> TlsSettings {
    TlsSettings {
        folder: Some(folder.to_owned()),
        acme: AcmeService { directory: format!("{}/directory", service.url), email: Some("me@play.example".to_owned()), root: None },
        ..TlsSettings::new(TlsChoice::Acme { domains: vec![DOMAIN.parse().unwrap()] })
    }
}

/// Waits until the server has a certificate that a browser trusts, and plays over it.
async fn play(server: &Server, service: &Service) {
    let verifier = trusting(service.issuer.as_ref().der().clone());
    let stream = within(async {
        loop {
            match handshake(server.address, DOMAIN, verifier.clone()).await {
                Ok(stream) => return stream,
                Err(_) => tokio::time::sleep(Duration::from_millis(20)).await,
            }
        }
    });
    let mut client = TestClient::over(stream.await, &format!("wss://{DOMAIN}/ws")).await;
    client.say_hello("client").await;
    client.frame().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_certificate_is_obtained_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let (address, domain_at) = watch::channel(None);
    let (service, task) = Service::start(domain_at).await;
    let start = || Server::start_with(StandInWorld::default(), Limits::default(), Some(settings(&service, folder.path())));
    let (server, tls) = start().await;
    address.send_replace(Some(server.address));
    play(&server, &service).await;
    server.stop().await;
    assert_eq!(service.order.lock().unwrap().contact, json!(["mailto:me@play.example"]));
    let kept = tls.unwrap().folder().unwrap().to_owned();
    assert!(kept.starts_with(folder.path()));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        assert_eq!(std::fs::metadata(&kept).unwrap().permissions().mode() & 0o777, 0o700, "only the user may read the keys");
    }
    // The next start needs no service.
    task.abort();
    let (server, _) = start().await;
    play(&server, &service).await;
    server.stop().await;
}

#[tokio::test]
async fn an_unusable_root_certificate_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("root.pem");
    for (text, reason) in [(None, "cannot be read"), (Some("text"), "contains no certificate")] {
        if let Some(text) = text {
            std::fs::write(&root, text).unwrap();
        }
        let mut settings = TlsSettings::new(TlsChoice::Acme { domains: vec![DOMAIN.parse().unwrap()] });
        settings.folder = Some(folder.path().to_owned());
        settings.acme.root = Some(root.clone());
        let error = prairie::net::Tls::new(&settings, ([127, 0, 0, 1], 0).into()).unwrap_err().to_string();
        assert!(error.starts_with(&format!("{} {reason}", root.display())), "{error}");
    }
}
