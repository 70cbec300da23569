//! Accepting connections: limits on their number and duration, TLS, then HTTP.

use super::admission::Admission;
use super::connection::{Connection, Metered};
use super::tls::Tls;
use crate::config::Limits;
use crate::log_limit::LogLimit;
use axum::{Extension, Router};
use futures_util::future::BoxFuture;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use socket2::SockRef;
use std::pin::pin;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::timeout;

/// Pause after a failed accept, the symptom of running out of file descriptors.
const ACCEPT_PAUSE: Duration = Duration::from_millis(200);

/// Maximum amount of unsent data in the system's buffers (bytes). With the system's own limit of megabytes, a slow client would use that much memory, get
/// states that are seconds old, and seem to accept nothing until a third of it was sent.
const UNSENT_BYTES: u32 = 64 << 10;

/// Serves connections forever. At most `limits.pending` connections that are not clients are open at once; others wait in the system's queue, for at
/// most `limits.http_timeout`. Those of an address that has too many are closed at once.
///
/// The future is boxed so that the whole network stack is compiled once, in this crate, and not again in every program that polls it.
pub(crate) fn serve(
    listener: TcpListener,
    tls: Option<Tls>,
    router: Router,
    limits: Limits,
    admission: Arc<Admission>,
) -> BoxFuture<'static, ()> {
    Box::pin(accept_connections(listener, tls, router, limits, admission))
}

async fn accept_connections(listener: TcpListener, tls: Option<Tls>, router: Router, limits: Limits, admission: Arc<Admission>) {
    let slots = Slots { free: Arc::new(Semaphore::new(limits.pending)), warning: LogLimit::default() };
    let rejection_warning = LogLimit::default();
    loop {
        let slot = slots.take().await;
        let (stream, remote) = match listener.accept().await {
            Ok(accepted) => accepted,
            Err(error) => {
                tracing::warn!(%error, "cannot accept a connection");
                tokio::time::sleep(ACCEPT_PAUSE).await;
                continue;
            }
        };
        let Some(place) = admission.admit(remote.ip()) else {
            if rejection_warning.due().is_some() {
                tracing::warn!(address = %remote.ip(), "too many connections from one address; new ones are closed");
            }
            continue;
        };
        let (tls, router) = (tls.clone(), router.clone());
        tokio::spawn(async move {
            let connection = Arc::new(Connection::new(place));
            tokio::select! {
                () = serve_connection(stream, connection.clone(), tls, router, limits) => {}
                // A WebSocket's session sends the reason; before that, the client is not told.
                () = connection.flooded() => connection.place.count_rate_limited(),
            }
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

async fn serve_connection(stream: TcpStream, connection: Arc<Connection>, tls: Option<Tls>, router: Router, limits: Limits) {
    // Frames are written as a whole, so Nagle's algorithm would only delay them.
    let _ = stream.set_nodelay(true);
    limit_unsent(&stream);
    let stream = Metered::new(stream, connection.clone(), limits.bytes_per_s);
    let router = router.layer(Extension(connection.clone()));
    let Some(tls) = tls else { return http(stream, connection, router, limits).await };
    match timeout(limits.handshake_timeout, tls.accept(stream)).await {
        Ok(Ok(Some(stream))) => http(stream, connection, router, limits).await,
        Ok(Ok(None)) => tracing::debug!("the ACME service checked a domain"),
        Ok(Err(error)) => tracing::debug!(%error, "TLS handshake failed"),
        Err(_) => tracing::debug!("TLS handshake timed out"),
    }
}

/// Bounds the unsent data in the system's buffers. Where the system has no such limit, it bounds all data that is not acknowledged.
fn limit_unsent(stream: &TcpStream) {
    let socket = SockRef::from(stream);
    #[cfg(any(target_os = "android", target_os = "linux"))]
    let limited = socket.set_tcp_notsent_lowat(UNSENT_BYTES);
    #[cfg(not(any(target_os = "android", target_os = "linux")))]
    let limited = socket.set_send_buffer_size(4 * UNSENT_BYTES as usize);
    if let Err(error) = limited {
        tracing::debug!(%error, "cannot limit the send buffer");
    }
}

/// Time limit for completing a response after the connection has timed out.
const RESPONSE_TIMEOUT: Duration = Duration::from_secs(300);

/// Serves HTTP requests until the connection ends, becomes a WebSocket, or times out. A response begun before that is completed as long as the client
/// reads it, so that the page loads over a slow line, too.
async fn http(io: impl AsyncRead + AsyncWrite + Unpin + Send + 'static, connection: Arc<Connection>, router: Router, limits: Limits) {
    let served = hyper::server::conn::http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(limits.handshake_timeout)
        .serve_connection(TokioIo::new(io), TowerToHyperService::new(router))
        .with_upgrades();
    let mut served = pin!(served);
    let mut outcome = timeout(limits.http_timeout, served.as_mut()).await;
    if outcome.is_err() {
        served.as_mut().graceful_shutdown();
        let (patience, begun) = (limits.http_timeout / 2, Instant::now());
        let mut written = None;
        // The first turn finds out how much has been written.
        while outcome.is_err() && written != Some(connection.written_bytes()) && begun.elapsed() < RESPONSE_TIMEOUT {
            written = Some(connection.written_bytes());
            outcome = timeout(patience, served.as_mut()).await;
        }
    }
    match outcome {
        Ok(Ok(())) => {}
        Ok(Err(error)) => tracing::debug!(%error, "a connection failed"),
        Err(_) => tracing::debug!("a connection timed out"),
    }
}
