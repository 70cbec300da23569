//! Speed against accuracy: timed runs of methods on problems, and charts that show which method wins where.
//!
//! | module | what it does |
//! |---|---|
//! | [`dial`] | one storm at three settings of its accuracy; planned settings beside those of the literature |
//! | [`features`] | what parts of a scene cost: step, causes on the wire, frame |
//! | [`gallery`] | the gallery page |
//! | [`gpu`] | the renderer on a graphics card, beside its aims |
//! | [`heights`] | one view from four heights in one picture |
//! | [`need`] | what a prairie costs in which more and more happens: processor, line, frame |
//! | [`peers`] | frame rates of other programs and ours in a browser |
//! | [`pictures`] | draws the pictures of a document again |
//! | [`plates`] | figures of the literature, as tiled pictures |
//! | [`start`] | times of the first pictures of a page in a browser |
//! | [`versions`] | the same views with two versions of Prairie in a browser |
//! | [`zhang`] | the platform and the scene of Zhang's thesis, measured |

pub mod dial;
pub mod features;
pub mod gallery;
pub mod gpu;
pub mod heights;
pub mod need;
pub mod peers;
pub mod pictures;
pub mod plates;
pub mod start;
pub mod versions;
pub mod zhang;
