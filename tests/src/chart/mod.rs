//! Speed against accuracy: runs of methods on problems, timed, and written so that one sees which method wins where.
//!
//! | module | what it does |
//! |---|---|
//! | [`row`] | one measured figure; CSV and JSON |
//! | [`run`] | what is run, and its timing |
//! | [`wind`] | the runs of the wind |
//! | [`bend`] | the runs of the bend field, and figures of their own kinds |
//! | [`plants`] | those of blades and underbrush |
//! | [`picture`] | ways of drawing: time of a frame against likeness, and figures of their own kinds |
//! | [`gallery`] | a page of pictures with their figures |
//! | [`shells`] | what layers of shells cost |
//! | [`figure`] | lines and fields of colour over two axes as SVG |
//! | [`line`](mod@line) | one line per method, and reading between its points |
//! | [`plot`], [`ticks`] | a log–log chart as SVG |
//! | [`summary`] | which method wins where, on one screen |
//! | [`table`] | Markdown tables, and putting them into a document |
//! | [`tables`] | the tables of the documents: orders and limits |
//! | [`files`] | all files of a model |
//! | [`machine`] | what the figures were measured on |

pub mod bend;
pub mod figure;
pub mod files;
pub mod gallery;
pub mod line;
pub mod machine;
pub mod picture;
pub mod plants;
pub mod plot;
pub mod row;
pub mod run;
pub mod shells;
pub mod summary;
pub mod table;
pub mod tables;
pub mod ticks;
pub mod wind;

pub use row::Row;
pub use run::{Outcome, Problem, Run};
