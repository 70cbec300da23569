//! A plain HTTP server on a free local port, for pages that need no Prairie server.

use std::io::Result;
use std::net::SocketAddr;

use tokio::io::{AsyncBufReadExt as _, AsyncWriteExt as _, BufReader};
use tokio::net::{TcpListener, TcpStream};
use tokio::task::JoinHandle;

/// A page: its content type and its bytes.
pub type Page = (&'static str, &'static [u8]);

/// Serves pages until it is dropped.
#[derive(Debug)]
pub struct Pages {
    /// Listening address.
    pub addr: SocketAddr,
    task: JoinHandle<()>,
}

impl Pages {
    /// Answers each `GET` with the page that `find` returns for its path, or 404.
    ///
    /// # Errors
    /// When this machine has no free port.
    pub async fn serve(find: fn(&str) -> Option<Page>) -> Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0").await?;
        let addr = listener.local_addr()?;
        let task = tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                // A browser that hangs up midway is not an error of the page.
                tokio::spawn(async move { answer(stream, find).await.unwrap_or_default() });
            }
        });
        Ok(Self { addr, task })
    }
}

impl Drop for Pages {
    fn drop(&mut self) {
        self.task.abort();
    }
}

async fn answer(stream: TcpStream, find: fn(&str) -> Option<Page>) -> Result<()> {
    let mut stream = BufReader::new(stream);
    let mut request = String::new();
    stream.read_line(&mut request).await?;
    let mut header = String::new();
    while stream.read_line(&mut header).await? > 2 {
        header.clear();
    }
    let path = request.split(' ').nth(1).and_then(|target| target.split('?').next()).unwrap_or("/");
    let (status, (content_type, bytes)) = match find(path) {
        Some(page) => ("200 OK", page),
        None => ("404 Not Found", ("text/plain", b"no such page".as_slice())),
    };
    let head = format!("HTTP/1.1 {status}\r\nContent-Type: {content_type}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n", bytes.len());
    stream.write_all(head.as_bytes()).await?;
    stream.write_all(bytes).await?;
    stream.shutdown().await
}
