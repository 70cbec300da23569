//! Accepting connections: limits on their number and duration, TLS, then HTTP.

use super::tls::Tls;
use crate::config::Limits;
use crate::log_limit::LogLimit;
use axum::Router;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// Pause after a failed accept, the symptom of running out of file descriptors.
const ACCEPT_PAUSE: Duration = Duration::from_millis(200);

/// Serves connections forever. At most `limits.pending` connections that are not clients are open at once; others wait in the system's queue, for at
/// most `limits.http_timeout`.
pub(crate) async fn serve(listener: TcpListener, tls: Option<Tls>, router: Router, limits: Limits) {
    let slots = Slots { free: Arc::new(Semaphore::new(limits.pending)), warning: LogLimit::default() };
    loop {
        let slot = slots.take().await;
        let stream = match listener.accept().await {
            Ok((stream, _)) => stream,
            Err(error) => {
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(ACCEPT_PAUSE).await;
                continue;
            }
        };
        let (tls, router) = (tls.clone(), router.clone());
        tokio::spawn(async move {
            connection(stream, tls, router, limits).await;
            drop(slot);
        });
    }
}

/// Free slots for connections that are not clients yet.
struct Slots {
    free: Arc<Semaphore>,
    warning: LogLimit,
}

impl Slots {
    async fn take(&self) -> OwnedSemaphorePermit {
        if self.free.available_permits() == 0 && self.warning.due().is_some() {
            tracing::warn!("too many connections without a client; new ones wait");
        }
        self.free.clone().acquire_owned().await.expect("the semaphore is never closed")
    }
}

async fn connection(stream: TcpStream, tls: Option<Tls>, router: Router, limits: Limits) {
    // Frames are written as a whole, so Nagle's algorithm would only delay them.
    let _ = stream.set_nodelay(true);
    let Some(tls) = tls else { return http(stream, router, limits).await };
    match timeout(limits.handshake_timeout, tls.accept(stream)).await {
        Ok(Ok(Some(stream))) => http(stream, router, limits).await,
        Ok(Ok(None)) => tracing::debug!("the ACME service checked a domain"),
        Ok(Err(error)) => tracing::debug!(%error, "TLS handshake failed"),
        Err(_) => tracing::debug!("TLS handshake timed out"),
    }
}

/// Serves HTTP requests until the connection ends, becomes a WebSocket, or times out.
async fn http(io: impl AsyncRead + AsyncWrite + Unpin + Send + 'static, router: Router, limits: Limits) {
    let connection = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.handshake_timeout)
        .serve_connection(TokioIo::new(io), TowerToHyperService::new(router))
        .with_upgrades();
    match timeout(limits.http_timeout, connection).await {
        Ok(Ok(())) => {}
        Ok(Err(error)) => tracing::debug!(%error, "a connection failed"),
        Err(_) => tracing::debug!("a connection timed out"),
    }
}
