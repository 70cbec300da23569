//! Speed against accuracy: timed runs of methods on problems, and charts that show which method wins where.
//!
//! | module | what it does |
//! |---|---|
//! | [`row`] | one measured figure; CSV and JSON |
//! | [`run`] | a run and its timing |
//! | [`wind`] | the runs of the wind |
//! | [`bend`] | the runs of the bend field, and figures of other kinds |
//! | [`plants`] | the runs of blades and underbrush |
//! | [`picture`] | render options: frame time against similarity, and figures of other kinds |
//! | [`gallery`] | the gallery page |
//! | [`gpu`] | the renderer on a graphics card, beside its aims |
//! | [`heights`] | one view from four heights in one picture |
//! | [`peers`] | frame rates of other programs and ours in a browser |
//! | [`pictures`] | draws the pictures of a document again |
//! | [`plates`] | figures of the literature, as tiled pictures |
//! | [`shells`] | cost of shell layers and of lamps on them |
//! | [`start`] | times of the first pictures of a page in a browser |
//! | [`stream`] | bits on the wire against the error of the grass |
//! | [`versions`] | the same views with two versions of Prairie in a browser |
//! | [`zhang`] | the platform and the scene of Zhang's thesis, measured |
//! | [`figure`] | line charts and coloured fields as SVG |
//! | [`line`](mod@line) | a line per method, with interpolation |
//! | [`plot`], [`ticks`] | a log–log chart as SVG |
//! | [`summary`] | the fastest method per problem and error, as text |
//! | [`table`] | Markdown tables and their insertion into a document |
//! | [`tables`] | the tables of the documents: orders and limits |
//! | [`files`] | all files of a model |
//! | [`machine`] | description of the machine |

pub mod bend;
pub mod figure;
pub mod files;
pub mod gallery;
pub mod gpu;
pub mod heights;
pub mod line;
pub mod machine;
pub mod peers;
pub mod picture;
pub mod pictures;
pub mod plants;
pub mod plates;
pub mod plot;
pub mod row;
pub mod run;
pub mod shells;
pub mod start;
pub mod stream;
pub mod summary;
pub mod table;
pub mod tables;
pub mod ticks;
pub mod versions;
pub mod wind;
pub mod zhang;

pub use row::Row;
pub use run::{Outcome, Problem, Run};
