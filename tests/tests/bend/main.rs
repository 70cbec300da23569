//! The bend field: accuracy, order, limits, seams, and contact.

mod contact;
mod limits;
mod random;
mod rotation;
mod seams;
mod sweep;
mod tracks;
mod waves;
mod winds;
