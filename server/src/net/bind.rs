//! Taking a port, with an error that says what to do.

use std::io;
use std::net::SocketAddr;
use thiserror::Error;
use tokio::net::{TcpListener, lookup_host};

/// Why an address cannot be listened on.
#[derive(Debug, Error)]
pub enum BindError {
    /// Not of the form `HOST:PORT`, or an unknown host.
    #[error("`{address}` is no address to listen on ({reason}); give HOST:PORT, such as 127.0.0.1:8080 or 0.0.0.0:8080")]
    Address {
        /// The address given.
        address: String,
        /// What the resolver says.
        reason: io::Error,
    },
    /// Another program listens there.
    #[error(
        "{address} is in use by another program, perhaps another prairie; stop that one, or choose another port with \
         --addr {host}:{next} (port 0 takes any free one)"
    )]
    InUse {
        /// The address given.
        address: String,
        /// Its host.
        host: String,
        /// A port to try.
        next: u16,
    },
    /// The system refuses.
    #[error("cannot listen on {address}: {reason}; ports below 1024 need privileges, and the host must be an address of this machine")]
    Refused {
        /// The address given.
        address: String,
        /// What the system says.
        reason: io::Error,
    },
}

/// Listens on `address` (`HOST:PORT`); the first of its addresses that can be had.
///
/// # Errors
/// [`BindError`], fit to be shown to whoever gave the address.
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
    fn a_port_in_use_is_named_with_a_way_out() {
        block_on(async {
            let first = bind("127.0.0.1:0").await.unwrap();
            let address = first.local_addr().unwrap().to_string();
            let message = bind(&address).await.unwrap_err().to_string();
            assert!(message.contains(&address) && message.contains("--addr 127.0.0.1:"), "{message}");
        });
    }

    #[test]
    fn nonsense_is_no_address() {
        block_on(async {
            for nonsense in ["", "8080", "127.0.0.1", "127.0.0.1:80800"] {
                assert!(matches!(bind(nonsense).await, Err(BindError::Address { .. })), "{nonsense}");
            }
        });
    }
}
