//! Connection metering below TLS, HTTP and WebSocket: limits input, and counts accepted output as progress.

use super::admission::Place;
use crate::token_bucket::TokenBucket;
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::task::{Context, Poll, ready};
use std::time::Instant;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::watch;

/// Bursts of input that are allowed, in seconds of the sustained rate.
const BURST_SECS: f64 = 4.0;

/// State of a connection, shared by its socket, its requests and its session.
#[derive(Debug)]
pub(crate) struct Connection {
    /// Its place among the connections of its address.
    pub(crate) place: Place,
    written_bytes: AtomicU64,
    has_flooded: watch::Sender<bool>,
}

impl Connection {
    pub(crate) fn new(place: Place) -> Self {
        Self { place, written_bytes: AtomicU64::new(0), has_flooded: watch::Sender::new(false) }
    }

    /// Bytes that the socket has accepted for sending.
    pub(crate) fn written_bytes(&self) -> u64 {
        self.written_bytes.load(Relaxed)
    }

    /// Completes when the connection has sent more than it may. From then on its input is discarded.
    pub(crate) async fn flooded(&self) {
        // The sender is part of `self`, so it is never gone.
        let _ = self.has_flooded.subscribe().wait_for(|flooded| *flooded).await;
    }
}

/// The socket of a [`Connection`].
#[derive(Debug)]
pub(crate) struct Metered<S> {
    socket: S,
    connection: Arc<Connection>,
    allowance: TokenBucket,
}

impl<S> Metered<S> {
    /// A socket that may send `bytes_per_s`, with bursts of four times as many.
    pub(crate) fn new(socket: S, connection: Arc<Connection>, bytes_per_s: f64) -> Self {
        Self { socket, connection, allowance: TokenBucket::new(BURST_SECS * bytes_per_s, bytes_per_s, Instant::now()) }
    }
}

impl<S: AsyncRead + Unpin> Metered<S> {
    /// Reads and forgets all input, so that the system does not reset the connection for unread input before the client has read the last messages.
    /// Completes at the end of the stream.
    fn discard(&mut self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        let mut scratch = [0; 4096];
        loop {
            let mut buffer = ReadBuf::new(&mut scratch);
            ready!(Pin::new(&mut self.socket).poll_read(context, &mut buffer))?;
            if buffer.filled().is_empty() {
                return Poll::Ready(Ok(()));
            }
        }
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Metered<S> {
    fn poll_read(self: Pin<&mut Self>, context: &mut Context<'_>, buffer: &mut ReadBuf<'_>) -> Poll<io::Result<()>> {
        let this = self.get_mut();
        if *this.connection.has_flooded.borrow() {
            return this.discard(context);
        }
        let before = buffer.filled().len();
        ready!(Pin::new(&mut this.socket).poll_read(context, buffer))?;
        this.allowance.fill(Instant::now());
        if this.allowance.try_take((buffer.filled().len() - before) as f64) {
            return Poll::Ready(Ok(()));
        }
        buffer.set_filled(before);
        this.connection.has_flooded.send_replace(true);
        this.discard(context)
    }
}

impl<S: AsyncWrite + Unpin> Metered<S> {
    fn count(&self, written: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        if let Poll::Ready(Ok(bytes)) = written {
            self.connection.written_bytes.fetch_add(bytes as u64, Relaxed);
        }
        written
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Metered<S> {
    fn poll_write(self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let this = self.get_mut();
        let written = Pin::new(&mut this.socket).poll_write(context, bytes);
        this.count(written)
    }

    fn poll_write_vectored(self: Pin<&mut Self>, context: &mut Context<'_>, parts: &[io::IoSlice<'_>]) -> Poll<io::Result<usize>> {
        let this = self.get_mut();
        let written = Pin::new(&mut this.socket).poll_write_vectored(context, parts);
        this.count(written)
    }

    fn is_write_vectored(&self) -> bool {
        self.socket.is_write_vectored()
    }

    fn poll_flush(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().socket).poll_flush(context)
    }

    fn poll_shutdown(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().socket).poll_shutdown(context)
    }
}
