//! Ten fixed views, from an ant's to an aircraft's height, in calm air and in a storm, for comparing render options.

use crate::studio::{Act, Stage, chase, play};
use anyhow::{Context as _, Result};
use glam::Vec3;
use prairie_client::camera::Camera;

/// A view of a scene after an act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Its name, such as `ant-calm`.
    pub name: &'static str,
    /// Built-in scene.
    pub scene: &'static str,
    /// Events before the picture.
    pub act: Act,
    /// Camera position.
    pub eye: Eye,
    /// Caption.
    pub shows: &'static str,
    /// Figures in the literature that it corresponds to.
    pub answers: &'static str,
}

/// Where a camera is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Eye {
    /// The starting view of the scene.
    Start,
    /// A fixed position above the terrain.
    Over {
        /// X and Z (m).
        at_m: [f32; 2],
        /// Above the ground (m).
        height_m: f32,
        /// From north towards east.
        heading_deg: f32,
        /// Negative looks down.
        pitch_deg: f32,
    },
    /// Looking at the act's vehicle from a distance behind, above and to the right of it (m).
    Chase([f32; 3]),
}

/// A camera at a height above a position (m), heading and pitch in degrees.
pub const fn over(at_m: [f32; 2], height_m: f32, heading_deg: f32, pitch_deg: f32) -> Eye {
    Eye::Over { at_m, height_m, heading_deg, pitch_deg }
}

/// All views, the lowest first.
pub const VIEWS: [View; 10] = [
    View {
        name: "ant-calm",
        scene: "underbrush",
        act: Act::Wind,
        eye: over([145.1, 140.12], 0.09, 60.0, 6.0),
        shows: "an ant's view between stems and flowers",
        answers: "Bakay 2003, Figure 3.3; Endo et al. 2003, Figure 9",
    },
    View {
        name: "ant-storm",
        scene: "storm",
        act: Act::Wind,
        eye: over([128.0, 158.72], 0.3, 200.0, 16.0),
        shows: "blades against a stormy sky, from 0.3 m",
        answers: "Bakay 2003, Figure 1.1",
    },
    View {
        name: "walking-calm",
        scene: "meadow",
        act: Act::Walk,
        eye: Eye::Chase([6.0, 1.2, 1.5]),
        shows: "a monster wades through the grass",
        answers: "Zhang, Figures 22 and 23 (a, height 1)",
    },
    View {
        name: "walking-storm",
        scene: "storm",
        act: Act::Wind,
        eye: over([128.0, 158.72], 1.7, 20.0, -6.0),
        shows: "gusts press the grass, rain drives across it",
        answers: "Endo et al. 2003, Figure 8",
    },
    View {
        name: "driving-calm",
        scene: "meadow",
        act: Act::Track,
        eye: Eye::Chase([7.0, 2.2, 0.0]),
        shows: "a car at speed and the track that it leaves",
        answers: "Chen & Johan 2010, Figure 10",
    },
    View {
        name: "driving-storm",
        scene: "storm",
        act: Act::Drag,
        eye: Eye::Chase([8.0, 3.0, 0.0]),
        shows: "a sled, a concave object, through flattened grass",
        answers: "Chen & Johan 2010, Figure 12",
    },
    View {
        name: "hill-calm",
        scene: "meadow",
        act: Act::Wind,
        eye: over([124.0, 197.0], 10.0, 20.0, -12.0),
        shows: "the valley from 10 m",
        answers: "Zhang, Figure 23 (c, height 10); Bakay 2003, Figure 1.2",
    },
    View {
        name: "hill-storm",
        scene: "storm",
        act: Act::Wash,
        eye: Eye::Chase([16.0, 6.0, 4.0]),
        shows: "a helicopter's wash in wind-blown grass",
        answers: "Chen & Johan 2010, Figure 11",
    },
    View {
        name: "aircraft-calm",
        scene: "continuum",
        act: Act::Track,
        eye: Eye::Chase([90.0, 60.0, 20.0]),
        shows: "cars and drifts of four grasses from 60 m",
        answers: "Chen & Johan 2010, Figure 13",
    },
    View {
        name: "aircraft-storm",
        scene: "storm",
        act: Act::Wind,
        eye: over([216.0, 60.0], 60.0, 225.0, -24.0),
        shows: "waves of wind over the valley from 60 m",
        answers: "Bakay 2003, Figure 4.1",
    },
];

impl View {
    /// The view of that name.
    ///
    /// # Errors
    /// When no view has this name.
    pub fn find(name: &str) -> Result<&'static Self> {
        let known = || VIEWS.map(|view| view.name).join(", ");
        VIEWS.iter().find(|view| view.name == name).with_context(|| format!("no view is called `{name}`; allowed: {}", known()))
    }

    /// Plays the act; returns the stage at its end and the camera.
    ///
    /// # Errors
    /// When the scene is invalid or the act fails.
    pub fn play(&self) -> Result<(Stage, Camera)> {
        let mut stage = Stage::load(self.scene)?;
        let camera = self.eye.watch(&mut stage, self.act).context(self.name)?;
        Ok((stage, camera))
    }
}

impl Eye {
    /// Plays an act on a stage; returns the camera at its end.
    ///
    /// # Errors
    /// When the act fails, or has no vehicle to follow.
    pub fn watch(self, stage: &mut Stage, act: Act) -> Result<Camera> {
        let start = Camera::start(&stage.scene().camera, stage.scene().extent_m(), |x, z| stage.ground_m(x, z));
        let fixed = match self {
            Self::Over { at_m: [x, z], height_m, heading_deg, pitch_deg } => Camera {
                eye_m: Vec3::new(x, stage.ground_m(x, z) + height_m, z),
                heading_rad: heading_deg.to_radians(),
                pitch_rad: pitch_deg.to_radians(),
                ..start
            },
            Self::Start | Self::Chase(_) => start,
        };
        let pose = play(stage, act, fixed.eye_m.to_array())?;
        match self {
            Self::Chase(offset_m) => {
                let pose = pose.context("the act has no vehicle to follow")?;
                Ok(chase(&pose, offset_m, |x, z| stage.ground_m(x, z)))
            }
            Self::Start | Self::Over { .. } => Ok(fixed),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_have_names_of_their_own_and_built_in_scenes() -> Result<()> {
        for view in &VIEWS {
            assert_eq!(View::find(view.name)?, view);
            assert!(crate::scenes::list().any(|(name, _)| name == view.scene), "{}", view.scene);
        }
        for place in ["ant", "walking", "driving", "hill", "aircraft"] {
            assert!(["calm", "storm"].iter().all(|air| View::find(&format!("{place}-{air}")).is_ok()), "{place}");
        }
        let error = View::find("moon").expect_err("there is no such view").to_string();
        assert!(error.starts_with("no view is called `moon`; allowed: ant-calm, ant-storm, "), "{error}");
        Ok(())
    }
}
