//! A plain HTTP server on a free local port, for pages that need no Prairie server.

use std::borrow::Cow;
use std::io::Result;
use std::net::SocketAddr;
use std::path::{Component, Path, PathBuf};

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
        Self::answer_all(move |path| find(path).map(|(content_type, bytes)| (content_type, bytes.into()))).await
    }

    /// Serves the files of a folder; a path that ends in `/` is its `index.html`. A first directory that the folder lacks is left out, since sites are often
    /// built for an address below another.
    ///
    /// # Errors
    /// When this machine has no free port.
    pub async fn serve_folder(folder: PathBuf) -> Result<Self> {
        Self::answer_all(move |path| {
            let index = if path.ends_with('/') { "index.html" } else { "" };
            let wanted = format!("{}{index}", path.trim_start_matches('/'));
            let below = wanted.split_once('/').map_or("", |(_, below)| below);
            [wanted.as_str(), below].into_iter().find_map(|name| file(&folder, name))
        })
        .await
    }

    async fn answer_all(find: impl Fn(&str) -> Option<Answer> + Clone + Send + Sync + 'static) -> Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0").await?;
        let addr = listener.local_addr()?;
        let task = tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                let find = find.clone();
                // A browser that hangs up midway is not an error of the page.
                tokio::spawn(async move { answer(stream, find).await.unwrap_or_default() });
            }
        });
        Ok(Self { addr, task })
    }
}

type Answer = (&'static str, Cow<'static, [u8]>);

/// A file below a folder, with its content type.
fn file(folder: &Path, name: &str) -> Option<Answer> {
    let is_below = !name.is_empty() && Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    let bytes = std::fs::read(folder.join(is_below.then_some(name)?)).ok()?;
    let content_type = match Path::new(name).extension().and_then(|ending| ending.to_str()).unwrap_or_default() {
        "html" => "text/html",
        "js" | "mjs" => "text/javascript",
        "css" => "text/css",
        "json" => "application/json",
        "wasm" => "application/wasm",
        "svg" => "image/svg+xml",
        "png" => "image/png",
        "jpg" | "jpeg" => "image/jpeg",
        "webp" => "image/webp",
        _ => "application/octet-stream",
    };
    Some((content_type, bytes.into()))
}

impl Drop for Pages {
    fn drop(&mut self) {
        self.task.abort();
    }
}

async fn answer(stream: TcpStream, find: impl Fn(&str) -> Option<Answer>) -> Result<()> {
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
        None => ("404 Not Found", ("text/plain", b"no such page".as_slice().into())),
    };
    let head = format!("HTTP/1.1 {status}\r\nContent-Type: {content_type}\r\nContent-Length: {}\r\nConnection: close\r\n\r\n", bytes.len());
    stream.write_all(head.as_bytes()).await?;
    stream.write_all(&bytes).await?;
    stream.shutdown().await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_found_below_the_folder_only() -> Result<()> {
        let folder = tempfile::tempdir()?;
        let site = folder.path().join("site");
        std::fs::create_dir_all(site.join("assets"))?;
        std::fs::write(folder.path().join("secret.txt"), "secret")?;
        std::fs::write(site.join("assets/a.js"), "script")?;
        assert_eq!(file(&site, "assets/a.js"), Some(("text/javascript", b"script".as_slice().into())));
        for name in ["", "b.js", "assets", "../secret.txt", "assets/../../secret.txt", "/etc/hostname"] {
            assert_eq!(file(&site, name), None, "{name}");
        }
        Ok(())
    }
}
