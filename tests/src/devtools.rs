//! Commands of the Chrome DevTools protocol, which chromedriver passes on.

use anyhow::{Context as _, Result, ensure};
use serde_json::{Value, json};
use tokio::io::{AsyncBufReadExt as _, AsyncWriteExt as _, BufReader};
use tokio::net::TcpStream;

/// Carries out a command in a session of the driver at `driver_url`.
///
/// # Errors
/// When the driver does not answer, or refuses the command.
pub(crate) async fn devtools(driver_url: &str, session: &str, command: &str, parameters: &Value) -> Result<()> {
    let host = driver_url.trim_start_matches("http://").trim_end_matches('/');
    let body = json!({ "cmd": command, "params": parameters }).to_string();
    let head = format!(
        "POST /session/{session}/goog/cdp/execute HTTP/1.1\r\nHost: {host}\r\nContent-Type: application/json\r\nContent-Length: {}\r\n\r\n",
        body.len()
    );
    let mut stream = BufReader::new(TcpStream::connect(host).await.with_context(|| format!("no driver at {host}"))?);
    stream.write_all((head + &body).as_bytes()).await?;
    let mut status = String::new();
    stream.read_line(&mut status).await?;
    ensure!(status.starts_with("HTTP/1.1 200"), "{command}: {status}");
    Ok(())
}
