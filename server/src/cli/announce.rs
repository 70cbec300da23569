//! The address of the page, as `prairie serve` prints it.

use super::print::print_exactly;
use prairie::escaped::escaped;
use prairie::net::{Tls, reachable_ip};
use std::fmt::Write as _;
use std::net::{IpAddr, SocketAddr};

/// Prints the address of the page and the certificate's fingerprint and folder, and opens the browser on request.
pub(super) fn announce(address: SocketAddr, tls: Option<&Tls>, open: bool) {
    let scheme = if tls.is_some() { "https" } else { "http" };
    let local = match address.ip() {
        ip if !ip.is_unspecified() => address,
        IpAddr::V4(_) => SocketAddr::new(IpAddr::from([127, 0, 0, 1]), address.port()),
        IpAddr::V6(_) => SocketAddr::new(IpAddr::from([0, 0, 0, 0, 0, 0, 0, 1]), address.port()),
    };
    let page = format!("{scheme}://{local}");
    let mut text = format!("Prairie is at {page}\n");
    if let Some(ip) = reachable_ip(address).filter(|ip| !ip.is_loopback()) {
        let _ = writeln!(text, "  from other machines: {scheme}://{}", SocketAddr::new(ip, address.port()));
        if tls.is_none() {
            tracing::warn!("browsers enable WebGPU only over https or on this machine; for other machines add --tls self");
        }
    }
    if let Some(fingerprint) = tls.and_then(Tls::fingerprint) {
        let _ = writeln!(text, "  certificate SHA-256: {fingerprint}");
    }
    if let Some(folder) = tls.and_then(Tls::folder) {
        let _ = writeln!(text, "  certificate kept in: {}", escaped(folder));
    }
    // Clients need no stdout, so the server goes on without.
    if let Err(error) = print_exactly(text) {
        tracing::warn!(%error, page, "cannot write the address to stdout");
    }
    if open && let Err(error) = open::that_detached(&page) {
        tracing::warn!(%error, "cannot open a browser");
    }
}
