//! Audience of the grass: the patches whose codes somebody takes.

use crate::grid::{PatchIndex, PatchLayout};
use std::sync::Arc;

/// Patches whose codes somebody takes; others aren't encoded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Audience(
    /// By patch; `None` for all patches.
    Option<Arc<[bool]>>,
);

impl Audience {
    /// These patches of a world.
    pub fn of(patches: impl Iterator<Item = PatchIndex>, layout: &PatchLayout) -> Self {
        let mut takes = vec![false; layout.patches()];
        patches.for_each(|patch| takes[patch as usize] = true);
        Self(Some(takes.into()))
    }

    /// Whether it takes all patches of any world.
    pub fn takes_all(&self) -> bool {
        self.0.is_none()
    }

    /// Whether somebody takes the codes of a patch.
    pub fn takes(&self, patch: PatchIndex) -> bool {
        self.0.as_ref().is_none_or(|takes| takes.get(patch as usize).copied().unwrap_or(false))
    }
}
