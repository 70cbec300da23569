//! The page of figures: speeds, memory and data rates, each with the command that measures it.

mod measure;
mod page;
mod pick;
mod table;

pub use measure::{Measured, measure};
pub use page::Page;
pub use pick::Pick;
pub use table::FIGURES;

/// A figure of the page.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// The measured quantity, with its unit where the figure lacks it.
    pub quantity: &'static str,
    /// Aim that was set before measuring; empty if there is none.
    pub aim: &'static str,
    /// Command that measures it, run in the workspace; several figures may share one.
    pub command: &'static str,
    /// Place of the figure in the command's output.
    pub pick: Pick,
}
