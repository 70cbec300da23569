//! The Prairie client: mirrors a Prairie server's world and draws it with [wgpu], on WebGPU in a browser or natively without a window.
//!
//! - [`state`]: the mirror of the server's world, to which its messages are applied.
//! - [`render`]: the renderer.
//! - [`camera`]: the camera; [`rig`]: its motion, free or behind a vehicle; [`sight`]: its line of sight; [`damped`]: critically damped smoothing.
//! - [`vehicle`]: table of vehicle kinds; [`bindings`]: keys and gamepad buttons; [`controls`]: control input and its meaning for a vehicle.
//! - [`prediction`]: the own vehicle, ahead of the server.
//! - [`hearing`]: sound levels at the camera.
//! - [`budget`] and [`ladder`]: automatic quality; [`redraw`]: detection of frames that need not be drawn.
//! - `browser` (wasm only): page, socket, input devices and frame loop.

pub mod automatic;
pub mod bindings;
#[cfg(target_arch = "wasm32")]
pub mod browser;
pub mod budget;
pub mod camera;
pub mod controls;
pub mod damped;
pub mod hearing;
pub mod ladder;
pub mod prediction;
pub mod redraw;
pub mod render;
pub mod replica_budget;
pub mod rig;
pub mod sight;
pub mod state;
pub mod vehicle;

/// Runs the example of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct ReadmeDocTests;
