//! A TCP line that is slow: bytes arrive later.

use std::net::SocketAddr;
use std::time::Duration;

use anyhow::Result;
use tokio::io::{AsyncRead, AsyncReadExt as _, AsyncWrite, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until};

/// Chunks on their way in one direction, of at most 16 KiB each; a line that holds more lets the sender wait.
const CHUNKS: usize = 1024;
const CHUNK_BYTES: usize = 16 << 10;

/// Opens a port from which every connection is passed on to `to`, later by `delay` in each direction. Returns its address; it lives as long as the runtime.
///
/// # Errors
/// When no port is free.
pub async fn slow_line(to: SocketAddr, delay: Duration) -> Result<SocketAddr> {
    line(to, move |_| delay).await
}

/// The same with a delay that depends on the time since the line was opened. Bytes stay in order.
///
/// # Errors
/// When no port is free.
pub async fn line(to: SocketAddr, delay: impl Fn(Duration) -> Duration + Clone + Send + 'static) -> Result<SocketAddr> {
    let opened = Instant::now();
    let due = move || Instant::now() + delay(opened.elapsed());
    let listener = TcpListener::bind("127.0.0.1:0").await?;
    let address = listener.local_addr()?;
    tokio::spawn(async move {
        while let Ok((near, _)) = listener.accept().await {
            let Ok(far) = TcpStream::connect(to).await else { continue };
            for stream in [&near, &far] {
                let _ = stream.set_nodelay(true);
            }
            let ((near_in, near_out), (far_in, far_out)) = (near.into_split(), far.into_split());
            tokio::spawn(pass_on(near_in, far_out, due.clone()));
            tokio::spawn(pass_on(far_in, near_out, due.clone()));
        }
    });
    Ok(address)
}

/// Passes on all bytes, each when it is due, until either side closes.
async fn pass_on(
    mut from: impl AsyncRead + Unpin + Send + 'static,
    mut to: impl AsyncWrite + Unpin,
    due: impl Fn() -> Instant + Send + 'static,
) {
    let (sender, mut chunks) = mpsc::channel(CHUNKS);
    tokio::spawn(async move {
        let mut buffer = vec![0; CHUNK_BYTES];
        while let Ok(count @ 1..) = from.read(&mut buffer).await {
            if sender.send((due(), buffer[..count].to_vec())).await.is_err() {
                break;
            }
        }
    });
    while let Some((due, bytes)) = chunks.recv().await {
        sleep_until(due).await;
        if to.write_all(&bytes).await.is_err() {
            break;
        }
    }
    let _ = to.shutdown().await;
}
