//! The server as its clients see it, on a free port. Misbehaving clients are closed with a reason and do not disturb the others.

#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "acme")]
mod acme;
mod adaptation;
mod addresses;
mod charts;
mod drawing;
mod floods;
mod http;
mod killed;
mod misbehaving_clients;
mod monitoring;
mod page;
mod pause;
mod prebuilt_client;
mod python;
mod reload;
mod scene_menu;
mod shared_world;
#[cfg(unix)]
mod signals;
mod slow_clients;
mod stand_in;
mod test_client;
mod test_server;
mod tls;
