//! The network side: sockets, TLS, HTTP and the sessions on `/ws`. The only part that knows axum.
//!
//! What comes in is hostile until proven otherwise: connections, handshakes, headers, hellos, sizes and rates are bounded before anything
//! is parsed, and whoever breaks a rule is closed with a code ([`shared::wire::Close`]), a reason and a log line.

pub mod assets;
mod bind;
mod routes;
mod serve;
mod session;
mod tls;

pub use bind::{BindError, bind};
pub(crate) use routes::{App, router};
pub(crate) use serve::serve;
pub use tls::{Tls, TlsChoice, TlsError, reachable_ip};
