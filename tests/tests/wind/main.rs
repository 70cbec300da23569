//! The wind: accuracy, order, limits, conservation.

mod canopy;
mod cavity;
mod conservation;
mod dust;
mod ethier_steinman;
mod honami;
mod moving_walls;
mod outflow;
mod projection;
mod random_scenes;
mod stability;
mod taylor_green;
