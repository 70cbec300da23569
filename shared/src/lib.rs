//! Simulation core of Prairie: scenes, terrain, the bend field of grass, plants, light and the wire format, shared by server and client.
//!
//! # Axes and units
//! SI throughout (m, s, kg, rad). Y is up; X points east and Z south, so that row 0 of a map is its northern edge.
//! The world's north-west corner is the origin; a world of `w × d` metres spans `0..w` in X and `0..d` in Z.
//! A heading is an angle about +Y measured from −Z (north) towards +X (east), so a heading of 0 looks north.
//!
//! # Modules
//! - [`scene`]: scene files, with the default and range of every field.
//! - [`terrain`]: height map, covering map, normals.
//! - [`grid`]: the grid of patches: indices and world coordinates.
//! - [`bend`]: the bend field of the grass, a 2-D continuum (Chen & Johan 2010).
//! - [`grass`] and [`body`]: contact, winds and flattened grass around the bend field; its causes, and replicas; shapes and motions of objects.
//! - [`wind`]: tiling of the wind's box over the world, and trilinear sampling.
//! - [`plant`]: mechanics of blades and underbrush, and where they grow.
//! - [`race`]: gates of a race, and its start light.
//! - [`light`]: position of the sun, sky, lamps, and the shading of grass.
//! - [`lod`]: levels of detail and drawing order of grass grids.
//! - [`outline`]: polygons on the ground and their convex parts.
//! - [`hash`] and [`random`]: random numbers by position and from a seed.
//! - [`wire`]: messages between server and client, and the codec of the fields.
//!
//! # Features
//! - `modal`: the bend field's scheme `modal`, exact in time. Off by default; it needs `rustfft`.
//!
//! # Determinism
//! Nothing here reads a clock, a file or the network, and everything builds for `wasm32`. The hashes, the codec, the growth of underbrush, the motion of
//! blades, the wind with its gusts, the passing of gates, and the [grass] with the bend field's schemes other than `modal` use only integers, `+ − × ÷`, square roots and the crate
//! `libm`: their bits are the same on every machine, so clients can simulate the grass. Headings of broken plants, the scheme `modal`, postures and light use the
//! platform's library: they may differ in the last bits, and the server's results are authoritative.

pub mod bend;
pub mod body;
pub mod escape;
pub mod grass;
pub mod grid;
pub mod hash;
pub mod light;
pub mod lod;
pub mod outline;
pub mod plant;
pub mod race;
pub mod random;
pub mod scene;
pub mod terrain;
pub mod wind;
pub mod wire;

/// Gravitational acceleration (m/s²).
pub const GRAVITY_M_PER_S2: f64 = 9.81;

/// Compiles and runs the examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct ReadmeDoctests;
