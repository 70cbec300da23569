//! Opening the listening socket, with errors that suggest a remedy.

use std::io;
use std::net::SocketAddr;
use thiserror::Error;
use tokio::net::{TcpListener, lookup_host};

/// Reasons why the server cannot listen on an address.
#[derive(Debug, Error)]
pub enum BindError {
    /// Not of the form `HOST:PORT`, or an unknown host.
    #[error("cannot listen on `{address}` ({reason}); give HOST:PORT, such as 127.0.0.1:8080 or 0.0.0.0:8080")]
    Address {
        /// The requested address.
        address: String,
        /// The resolver's reason.
        reason: io::Error,
    },
    /// Another program listens on this address.
    #[error(
        "{address} is in use by another program, perhaps another prairie; stop it, or choose another port with \
         --addr {host}:{next} (port 0 picks a free one)"
    )]
    InUse {
        /// The requested address.
        address: String,
        /// The host of the address.
        host: String,
        /// Another port to try.
        next: u16,
    },
    /// The system refused.
    #[error("cannot listen on {address}: {reason}; ports below 1024 need privileges, and the host must belong to this machine")]
    Refused {
        /// The requested address.
        address: String,
        /// The system's reason.
        reason: io::Error,
    },
}

/// Listens on `address` (`HOST:PORT`); if the host has several addresses, on the first free one.
///
/// # Errors
/// [`BindError`], worded for the user who gave the address.
pub async fn bind(address: &str) -> Result<TcpListener, BindError> {
    let unknown = |reason| BindError::Address { address: address.to_owned(), reason };
    let candidates: Vec<SocketAddr> = lookup_host(address).await.map_err(unknown)?.collect();
    TcpListener::bind(candidates.as_slice()).await.map_err(|reason| {
        let port = candidates.first().map_or(0, SocketAddr::port);
        let host = address.rsplit_once(':').map_or(address, |(host, _)| host).to_owned();
        match reason.kind() {
            io::ErrorKind::AddrInUse => BindError::InUse { address: address.to_owned(), host, next: port.checked_add(1).unwrap_or(8080) },
            _ => BindError::Refused { address: address.to_owned(), reason },
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block_on<T>(future: impl Future<Output = T>) -> T {
        tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(future)
    }

    #[test]
    fn the_error_for_a_port_in_use_suggests_another() {
        block_on(async {
            let first = bind("127.0.0.1:0").await.unwrap();
            let address = first.local_addr().unwrap().to_string();
            let message = bind(&address).await.unwrap_err().to_string();
            assert!(message.contains(&address) && message.contains("--addr 127.0.0.1:"), "{message}");
        });
    }

    #[test]
    fn invalid_addresses_are_errors() {
        block_on(async {
            for nonsense in ["", "8080", "127.0.0.1", "127.0.0.1:80800"] {
                assert!(matches!(bind(nonsense).await, Err(BindError::Address { .. })), "{nonsense}");
            }
        });
    }
}
