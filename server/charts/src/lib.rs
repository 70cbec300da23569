//! Speed against accuracy: timed runs of methods on problems with known solutions, and charts that show which method wins where.
//!
//! Numerical methods only: wind, bend field, and plants. Charts of a whole world and of the picture are in the package `prairie`, which runs all of them as
//! `prairie chart` and `prairie stability`.
//!
//! | module | what it does |
//! |---|---|
//! | [`problems`] | exact solutions and published tables |
//! | [`orders`], [`limits`] | fitted orders of accuracy, and stability limits by bisection |
//! | [`wind`] | the runs of the wind |
//! | [`bend`] | the runs of the bend field, and figures of other kinds |
//! | [`plants`] | the runs of blades, underbrush and the force field |
//! | [`model`] | the list of these |
//! | [`run`] | a run and its timing |
//! | [`row`] | one measured figure; CSV and JSON |
//! | [`figure`] | line charts and coloured fields as SVG |
//! | [`line`](mod@line) | a line per method, with interpolation |
//! | [`plot`], [`ticks`] | a log–log chart as SVG |
//! | [`summary`] | the fastest method per problem and error, as text |
//! | [`table`] | Markdown tables and their insertion into a document |
//! | [`tables`] | the tables of the documents: orders and limits |
//! | [`files`] | all files of a model |
//! | [`page`] | all charts as data, for a page that is looked at in a browser |
//! | [`machine`] | description of the machine |
//! | [`air`], [`norms`], [`random_winds`], [`turntable`] | airs, norms of errors, and flows that several of these share |

pub mod air;
pub mod bend;
pub mod figure;
pub mod files;
mod inline;
pub mod limits;
pub mod line;
pub mod machine;
mod memory_limit;
pub mod model;
pub mod norms;
pub mod orders;
pub mod page;
pub mod plants;
pub mod plot;
pub mod problems;
pub mod random_winds;
pub mod row;
pub mod run;
pub mod summary;
pub mod table;
pub mod tables;
pub mod ticks;
pub mod turntable;
pub mod wind;

pub use model::{MODELS, Model};
pub use row::Row;
pub use run::{Outcome, Problem, Run};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
