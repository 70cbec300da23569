//! Opening the stream of a recording.
//!
//! The SDK reports a port in use or an absent viewer late or never, so both are tried before it is called.

use super::error::InspectError;
use super::target::Target;
use rerun::external::re_uri::ProxyUri;
use rerun::{MemoryLimit, RecordingStream, RecordingStreamBuilder, ServerOptions};
use std::fmt::Display;
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::time::Duration;

/// Name of the program in the viewer's list of recordings.
pub(super) const APPLICATION: &str = "prairie";

/// History kept for viewers that connect later (bytes).
const HISTORY_LIMIT_BYTES: u64 = 256 << 20;

/// Time limit for a viewer to accept the connection, and to receive the last frames at the end.
pub(super) const VIEWER_TIMEOUT: Duration = Duration::from_secs(2);

/// An error of the SDK.
pub(super) fn sdk(error: impl Display) -> InspectError {
    InspectError::Sdk(error.to_string())
}

/// Opens the stream; returns it with its address: a file's path, or the URL for viewers.
pub(super) fn open_stream(target: &Target) -> Result<(RecordingStream, String), InspectError> {
    let builder = RecordingStreamBuilder::new(APPLICATION);
    let (stream, address) = match target {
        Target::Serve(addr) => {
            let in_use = |reason| InspectError::Address { addr: *addr, reason };
            let free = TcpListener::bind(addr).and_then(|listener| listener.local_addr()).map_err(in_use)?;
            let options = ServerOptions { memory_limit: MemoryLimit::from_bytes(HISTORY_LIMIT_BYTES), ..ServerOptions::default() };
            let ip = if free.is_ipv6() { format!("[{}]", free.ip()) } else { free.ip().to_string() };
            (builder.serve_grpc_opts(ip, free.port(), options), format!("rerun+http://{free}/proxy"))
        }
        Target::Save(path) => {
            std::fs::File::create(path).map_err(|reason| InspectError::File { path: path.clone(), reason })?;
            (builder.save(path), path.display().to_string())
        }
        Target::Connect(url) => {
            let uri: ProxyUri = url.parse().map_err(sdk)?;
            check_viewer(&uri).map_err(|reason| InspectError::NoViewer { url: url.clone(), reason })?;
            (builder.connect_grpc_opts(url.as_str()), url.clone())
        }
    };
    let stream = stream.map_err(sdk)?;
    stream.set_log_time_enabled(false);
    Ok((stream, address))
}

/// Checks that a viewer accepts connections at its address.
fn check_viewer(uri: &ProxyUri) -> std::io::Result<()> {
    let mut last = std::io::Error::other("the host name has no address");
    for addr in (uri.origin.host.to_string(), uri.origin.port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&addr, VIEWER_TIMEOUT) {
            Ok(_) => return Ok(()),
            Err(error) => last = error,
        }
    }
    Err(last)
}
