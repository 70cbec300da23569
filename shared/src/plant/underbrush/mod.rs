//! Underbrush.
pub mod rest;
pub mod section;
