//! Viewpoint of a frame.

use crate::render::inputs::frustum::Frustum;
use crate::render::options::detail::Detail;
use crate::render::options::render_options::RenderOptions;
use glam::Vec3;

/// Camera position, frustum and options that the drawn plants depend on.
pub(crate) struct Viewpoint<'a> {
    pub(crate) eye_m: Vec3,
    /// Elevation of the ground below the camera (m).
    pub(crate) ground_m: f32,
    pub(crate) frustum: &'a Frustum,
    pub(crate) detail: &'a Detail,
    pub(crate) options: RenderOptions,
    pub(crate) dt_secs: f32,
    /// Solid angle of the picture (sr).
    pub(crate) picture_sr: f32,
}
