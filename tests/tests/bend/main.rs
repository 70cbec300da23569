//! The bend field: accuracy, order, limits, seams, and what presses the grass.

mod contact;
mod limits;
mod random;
mod rotation;
mod seams;
mod sweep;
mod tracks;
mod waves;
mod winds;
