//! Accepting connections: how many, how long they may take, TLS, then HTTP.

use super::Tls;
use crate::config::Limits;
use axum::Router;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// Rest after a failed accept, which is what running out of file descriptors looks like.
const ACCEPT_REST: Duration = Duration::from_millis(200);

/// Least time between two log lines about too many connections.
const FULL_LOG_EVERY: Duration = Duration::from_secs(10);

/// Serves connections for ever. At most `limits.connections` are open at once before they become clients; more wait in the system's queue,
/// for no longer than `limits.page`.
pub(crate) async fn serve(listener: TcpListener, tls: Option<Tls>, router: Router, limits: Limits) {
    let mut seats = Seats { free: Arc::new(Semaphore::new(limits.connections)), warned: None };
    loop {
        let seat = seats.take().await;
        let stream = match listener.accept().await {
            Ok((stream, _)) => stream,
            Err(error) => {
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(ACCEPT_REST).await;
                continue;
            }
        };
        let (tls, router) = (tls.clone(), router.clone());
        tokio::spawn(async move {
            connection(stream, tls, router, limits).await;
            drop(seat);
        });
    }
}

/// The connections that may still come before they become clients.
struct Seats {
    free: Arc<Semaphore>,
    warned: Option<Instant>,
}

impl Seats {
    async fn take(&mut self) -> OwnedSemaphorePermit {
        if self.free.available_permits() == 0 && self.warned.is_none_or(|at| at.elapsed() > FULL_LOG_EVERY) {
            tracing::warn!("too many connections that are no clients yet; new ones wait");
            self.warned = Some(Instant::now());
        }
        self.free.clone().acquire_owned().await.expect("the semaphore is never closed")
    }
}

async fn connection(stream: TcpStream, tls: Option<Tls>, router: Router, limits: Limits) {
    // Frames are written whole; waiting for more would only delay them.
    let _ = stream.set_nodelay(true);
    let Some(tls) = tls else { return http(stream, router, limits).await };
    match timeout(limits.greeting, tls.acceptor.accept(stream)).await {
        Ok(Ok(stream)) => http(stream, router, limits).await,
        Ok(Err(error)) => tracing::debug!(%error, "TLS handshake failed"),
        Err(_) => tracing::debug!("TLS handshake took too long"),
    }
}

/// Answers requests until the connection ends, becomes a WebSocket, or has taken too long to do either.
async fn http(io: impl AsyncRead + AsyncWrite + Unpin + Send + 'static, router: Router, limits: Limits) {
    let connection = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.greeting)
        .serve_connection(TokioIo::new(io), TowerToHyperService::new(router))
        .with_upgrades();
    match timeout(limits.page, connection).await {
        Ok(Ok(())) => {}
        Ok(Err(error)) => tracing::debug!(%error, "a connection ended"),
        Err(_) => tracing::debug!("a connection was open for too long"),
    }
}
