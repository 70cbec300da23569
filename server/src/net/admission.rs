//! Limits per remote address: one address cannot take every place of a server.

use std::collections::HashMap;
use std::net::{IpAddr, Ipv6Addr};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Maximum number of pending connections (not clients yet) of an address, for each client that it may have. A browser opens up to six connections to load
/// the page, and keeps them for seconds: all clients of an address may load it at the same time.
pub(crate) const PENDING_PER_CLIENT: usize = 8;

/// The open connections of each address, and counters of rejected ones.
#[derive(Debug)]
pub(crate) struct Admission {
    clients_per_address: usize,
    open: Mutex<HashMap<IpAddr, Open>>,
    /// Connections that were closed because of too many from their address.
    pub(crate) rejected_connections: AtomicU64,
    /// Connections that were closed because they sent too much.
    pub(crate) rate_limited_connections: AtomicU64,
}

/// Open connections of one address.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Open {
    pending: usize,
    clients: usize,
}

impl Admission {
    /// At most `clients_per_address` clients and [`PENDING_PER_CLIENT`] times as many other connections for each address.
    pub(crate) fn new(clients_per_address: usize) -> Self {
        Self {
            clients_per_address,
            open: Mutex::default(),
            rejected_connections: AtomicU64::new(0),
            rate_limited_connections: AtomicU64::new(0),
        }
    }

    /// A place for a new connection; `None` if its address has too many.
    pub(crate) fn admit(self: &Arc<Self>, address: IpAddr) -> Option<Place> {
        let network = network(address);
        let mut table = self.table();
        let pending = table.get(&network).map_or(0, |open| open.pending);
        if pending >= self.clients_per_address.saturating_mul(PENDING_PER_CLIENT) {
            self.rejected_connections.fetch_add(1, Relaxed);
            return None;
        }
        table.entry(network).or_default().pending += 1;
        Some(Place { admission: self.clone(), network, is_client: Mutex::new(false) })
    }

    fn table(&self) -> MutexGuard<'_, HashMap<IpAddr, Open>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The place of one connection, free again when it is dropped.
#[derive(Debug)]
pub(crate) struct Place {
    admission: Arc<Admission>,
    network: IpAddr,
    is_client: Mutex<bool>,
}

impl Place {
    /// Makes the connection a client.
    ///
    /// # Errors
    /// The reason, when the address has too many clients.
    pub(crate) fn become_client(&self) -> Result<(), String> {
        let mut is_client = self.is_client.lock().unwrap_or_else(PoisonError::into_inner);
        let limit = self.admission.clients_per_address;
        let mut table = self.admission.table();
        let open = table.entry(self.network).or_default();
        if open.clients >= limit {
            self.admission.rejected_connections.fetch_add(1, Relaxed);
            return Err(format!("your address has {} clients, and the server allows {limit}; try again later", open.clients));
        }
        open.clients += 1;
        open.pending -= 1;
        *is_client = true;
        Ok(())
    }

    /// Counts that the connection was closed because it sent too much.
    pub(crate) fn count_rate_limited(&self) {
        self.admission.rate_limited_connections.fetch_add(1, Relaxed);
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let is_client = *self.is_client.get_mut().unwrap_or_else(PoisonError::into_inner);
        let mut table = self.admission.table();
        if let Some(open) = table.get_mut(&self.network) {
            *(if is_client { &mut open.clients } else { &mut open.pending }) -= 1;
            if *open == Open::default() {
                table.remove(&self.network);
            }
        }
    }
}

/// Network counted as one address: an IPv4 address, or the /64 of an IPv6 address, since a single user often has a whole /64.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => Ipv6Addr::from_bits(address.to_bits() >> 64 << 64).into(),
        v4 => v4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ipv6_addresses_of_one_network_count_as_one() {
        let network = |text: &str| network(text.parse().unwrap()).to_string();
        assert_eq!(network("2001:db8:1:2:3:4:5:6"), network("2001:db8:1:2::9"));
        assert_ne!(network("2001:db8:1:2::1"), network("2001:db8:1:3::1"));
        assert_eq!(network("::ffff:192.0.2.7"), "192.0.2.7");
    }

    #[test]
    fn places_are_free_again_when_their_connections_end() {
        let admission = Arc::new(Admission::new(1));
        let [ada, bob] = ["192.0.2.1", "192.0.2.2"].map(|text| text.parse::<IpAddr>().unwrap());
        let mut places: Vec<Place> = (0..PENDING_PER_CLIENT).map(|_| admission.admit(ada).unwrap()).collect();
        assert!(admission.admit(ada).is_none(), "too many connections");
        assert!(admission.admit(bob).is_some(), "another address");
        places[0].become_client().unwrap();
        places.push(admission.admit(ada).expect("a client is not pending"));
        assert!(places[1].become_client().unwrap_err().contains("1 clients"), "too many clients");
        assert_eq!(admission.rejected_connections.load(Relaxed), 2);
        places.remove(0);
        places[0].become_client().unwrap();
        places.clear();
        assert!(admission.table().is_empty(), "nothing is remembered of addresses without connections");
    }

    #[test]
    fn a_class_behind_one_router_loads_the_page_at_the_same_time() {
        let admission = Arc::new(Admission::new(32));
        let router = IpAddr::from([192, 0, 2, 1]);
        let places: Vec<_> = (0..32 * 6).map(|_| admission.admit(router).expect("a browser opens six connections")).collect();
        assert_eq!(places.len(), 192);
    }
}
