//! The server as its visitors meet it, on a free port: what good ones get, and that bad ones are closed with a reason and disturb nobody.

#[path = "../common/mod.rs"]
mod common;

mod bad_visitors;
mod command_line;
mod encrypted;
mod pages;
mod reloading;
mod running;
mod sharing;
mod small_world;
mod visitor;
