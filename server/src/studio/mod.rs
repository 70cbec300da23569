//! Pictures and films of a scene without a window (feature `picture`): a world, a client's mirror of it and the client's renderer in one process.
//!
//! This is the only part of the server that uses `prairie_client`. `prairie picture`, `prairie film` and the picture tests share it.

mod act;
mod chase;
mod film;
mod image_file;
mod stage;

pub use act::{Act, play};
pub use chase::chase;
pub use film::Film;
pub use image_file::{to_jpeg, to_png, write_picture};
pub use stage::Stage;
