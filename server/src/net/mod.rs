//! Network: sockets, TLS, HTTP and the sessions on `/ws`. The only part that depends on axum.
//!
//! All input is untrusted: connections, handshakes, headers, hellos, sizes and rates are bounded before anything is parsed. A client that
//! violates the protocol is disconnected with a code ([`prairie_core::wire::Close`]), a reason and a log line.

mod app;
pub mod assets;
mod bind;
mod health;
mod routes;
mod serve;
mod session;
mod tls;

pub(crate) use app::App;
pub use bind::{BindError, bind};
pub(crate) use routes::router;
pub(crate) use serve::serve;
pub use tls::{Tls, TlsChoice, TlsError, reachable_ip};
