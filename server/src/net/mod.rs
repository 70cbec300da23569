//! Network: sockets, TLS, HTTP and the sessions on `/ws`. The only part that depends on axum.
//!
//! All input is untrusted: connections, handshakes, headers, hellos, sizes and rates are bounded before anything is parsed. A client that
//! violates the protocol is disconnected with a code ([`prairie_core::wire::Close`]), a reason and a log line.

mod addresses;
mod admission;
mod api;
mod app;
pub mod assets;
mod bind;
mod connection;
mod encoding;
mod end;
mod field_sampler;
mod files;
mod health;
mod host_name;
mod inputs;
mod name;
mod newest;
mod origin;
mod page_errors;
mod plan;
mod proofs;
mod reader;
mod routes;
mod scenes;
mod security;
mod serve;
mod session;
mod tls;
mod upgrade;
mod writer;

pub use addresses::reachable_ip;
pub(crate) use admission::Admission;
pub(crate) use app::{App, SessionLog};
pub use bind::{BindError, bind};
pub(crate) use field_sampler::FieldSampler;
pub use host_name::{HostName, Origin};
pub(crate) use origin::Access;
pub(crate) use page_errors::PageErrors;
pub(crate) use proofs::Proofs;
pub(crate) use routes::router;
pub(crate) use serve::serve;
pub use tls::{AcmeService, LETS_ENCRYPT, Tls, TlsChoice, TlsError, TlsSettings};
