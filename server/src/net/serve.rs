//! Accepting connections: how many, how long they may take, TLS, then HTTP.

use super::Tls;
use crate::config::Limits;
use axum::Router;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;

/// Rest after a failed accept, which is what running out of file descriptors looks like.
const ACCEPT_REST: Duration = Duration::from_millis(200);

/// Serves connections for ever. At most `limits.connections` are open at once before they become clients; more wait in the system's queue.
pub(crate) async fn serve(listener: TcpListener, tls: Option<Tls>, router: Router, limits: Limits) {
    let seats = Arc::new(Semaphore::new(limits.connections));
    loop {
        let seat = seats.clone().acquire_owned().await.expect("the semaphore is never closed");
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
            connection(stream, tls, router, limits.greeting).await;
            drop(seat);
        });
    }
}

async fn connection(stream: TcpStream, tls: Option<Tls>, router: Router, patience: Duration) {
    // Frames are written whole; waiting for more would only delay them.
    let _ = stream.set_nodelay(true);
    let Some(tls) = tls else { return http(stream, router, patience).await };
    match tokio::time::timeout(patience, tls.acceptor.accept(stream)).await {
        Ok(Ok(stream)) => http(stream, router, patience).await,
        Ok(Err(error)) => tracing::debug!(%error, "TLS handshake failed"),
        Err(_) => tracing::debug!("TLS handshake took too long"),
    }
}

async fn http(io: impl AsyncRead + AsyncWrite + Unpin + Send + 'static, router: Router, patience: Duration) {
    let connection = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(patience)
        .serve_connection(TokioIo::new(io), TowerToHyperService::new(router))
        .with_upgrades();
    if let Err(error) = connection.await {
        tracing::debug!(%error, "a connection ended");
    }
}
