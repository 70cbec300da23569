//! Names and addresses of this machine.

use super::host_name::HostName;
use std::net::{IpAddr, Ipv4Addr, SocketAddr, UdpSocket};

/// The names of this machine: `localhost`, its host name, and that name in the local network (`HOST.local`).
pub(super) fn own_names() -> Vec<HostName> {
    let host = hostname::get().ok().and_then(|host| host.into_string().ok()).unwrap_or_default();
    names_of(&host)
}

fn names_of(host: &str) -> Vec<HostName> {
    let label = host.split('.').next().unwrap_or_default();
    let mut names: Vec<HostName> = Vec::new();
    for name in ["localhost", host, label, &format!("{label}.local")] {
        // A host name that is not a DNS name cannot be reached.
        if let Ok(name) = name.parse()
            && !names.contains(&name)
        {
            names.push(name);
        }
    }
    names
}

/// The addresses of the interfaces of this machine, the loopback addresses first; without link-local IPv6 addresses, which browsers cannot open.
pub(super) fn own_addresses() -> Vec<IpAddr> {
    let mut addresses = vec![IpAddr::from(Ipv4Addr::LOCALHOST), IpAddr::from(std::net::Ipv6Addr::LOCALHOST)];
    let interfaces = if_addrs::get_if_addrs().unwrap_or_else(|error| {
        tracing::warn!(%error, "the addresses of this machine cannot be listed");
        Vec::new()
    });
    for address in
        interfaces.iter().filter(|interface| !(interface.ip().is_ipv6() && interface.is_link_local())).map(if_addrs::Interface::ip)
    {
        if !addresses.contains(&address) {
            addresses.push(address);
        }
    }
    addresses
}

/// The address at which other machines can reach a listener: its own, or, if it listens on all addresses, that of the interface
/// towards the network. Sends no packets.
pub fn reachable_ip(listening: SocketAddr) -> Option<IpAddr> {
    if !listening.ip().is_unspecified() {
        return Some(listening.ip());
    }
    let socket = UdpSocket::bind((Ipv4Addr::UNSPECIFIED, 0)).ok()?;
    socket.connect((Ipv4Addr::new(192, 0, 2, 1), 9)).ok()?;
    socket.local_addr().ok().map(|address| address.ip()).filter(|ip| !ip.is_unspecified())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_known_by_its_host_name() {
        let names = |host| names_of(host).iter().map(ToString::to_string).collect::<Vec<_>>();
        assert_eq!(names("Laptop"), ["localhost", "laptop", "laptop.local"]);
        assert_eq!(names("laptop.home.example"), ["localhost", "laptop.home.example", "laptop", "laptop.local"]);
        assert_eq!(names("Küche"), ["localhost"]);
        assert_eq!(names(""), ["localhost"]);
    }

    #[test]
    fn addresses_are_listed_once() {
        let addresses = own_addresses();
        assert!(addresses.iter().all(|address| addresses.iter().filter(|other| *other == address).count() == 1), "{addresses:?}");
    }
}
