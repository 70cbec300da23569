//! The Prairie server: an authoritative world of wind, grass and vehicles, streamed over WebSocket.
//!
//! A run has three parts that never wait for each other: the world's thread ([`runner`]) steps at a fixed rate and publishes
//! the newest [`snapshot`]; the [`stream`] thread encodes the changes, once for all clients; the sessions in [`net`] send them
//! as fast as each client acknowledges.
//!
//! [`run`] is the whole server; the README shows how to embed it in another program.
//!
//! # Packages
//! `cargo doc --workspace --no-deps --open` documents all of them; this page is the way in.
//! - [`prairie_core`]: scenes, terrain, the bend field of grass, plants, light and the wire format, shared by server and client.
//! - [`prairie_wind`]: the wind solver.
//! - [prairie_charts](../prairie_charts/index.html): methods measured on problems with known solutions.
//! - [prairie_client](../prairie_client/index.html): the mirror of a server's world, and the renderer.
//! - [tests](../tests/index.html): tests, comparisons and pictures.

pub mod batch;
pub mod bend;
#[cfg(feature = "charts")]
pub mod charts;
mod checksum;
mod config;
pub mod detail;
pub mod escaped;
mod file;
pub mod histogram;
pub mod inspect;
pub mod journal;
mod log_limit;
pub mod metrics;
pub mod net;
pub mod objects;
pub mod output;
pub mod plan;
pub mod plants;
pub mod race;
mod reload;
mod run;
pub mod runner;
mod scene_menu;
pub mod scenes;
pub mod settings_error;
pub mod snapshot;
pub mod stream;
#[cfg(feature = "picture")]
pub mod studio;
mod token_bucket;
pub mod weather;
pub mod world;

pub use config::{Config, Limits};
pub use reload::run_and_reload;
pub use run::{RunError, run, run_simulation};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
