//! The pure core of Prairie: what the server computes with and the browser draws from.
//!
//! # Axes and units
//! SI throughout (m, s, kg, rad). Y is up; X grows east and Z grows south, so that row 0 of a map is its northern edge.
//! The world's north-west corner is the origin; a world of `w × d` metres spans `0..w` in X and `0..d` in Z.
//! A heading is an angle about +Y measured from −Z (north) towards +X (east), so a heading of 0 looks north.
//!
//! # Rooms
//! - [`scene`]: what a scene file can say, with defaults and ranges.
//! - [`terrain`]: height map, covering map, normals.
//! - [`grid`]: shapes, spacing, index and world coordinates, fields with a halo.
//! - [`bend`]: the bend field of the grass, a 2-D continuum (Chen & Johan).
//! - [`wind`]: which place of the wind's box blows where.
//! - [`hash`]: random numbers by place.
//! - [`light`]: where the sun stands, the sky, lamps, and how grass is lit.
//! - [`lod`]: which grass grid is drawn how.
//! - [`plant`]: blades and underbrush, how they bend, and where they grow.
//! - [`outline`]: polygons on the ground and their convex parts.
//! - [`wire`]: the messages between server and client, and the codec of the fields.
//!
//! Everything here builds for `wasm32` and is deterministic: only `+ − × ÷` and square roots where both sides must agree.

pub mod bend;
pub mod grid;
pub mod hash;
pub mod light;
pub mod lod;
pub mod outline;
pub mod plant;
pub mod scene;
pub mod terrain;
pub mod wind;
pub mod wire;
