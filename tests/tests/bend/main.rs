//! The bend field: accuracy, order, limits, seams, and contact.

mod contact;
mod footsteps;
mod ground;
mod limits;
mod random;
mod rotation;
mod seams;
mod sweep;
mod tracks;
mod varying_speed;
mod waves;
mod winds;
