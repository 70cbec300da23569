//! Page status messages, which cover the picture or appear above it.

use super::app::App;
use super::connection::ConnectionState;
use super::page;
use crate::render::Stage;
use prairie_core::wire::Close;

/// Fractions of the start, after the client itself is loaded, that are done when a message appears.
const CONNECTING: f64 = 0.5;
const REQUESTING_DEVICE: f64 = 0.6;
const RECEIVING: f64 = 0.7;
const DRAWING: f64 = 0.8;

/// A status message of `messages.js`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Status {
    kind: &'static str,
    detail: String,
    /// Fraction of the start that is done, if known.
    progress: Option<f64>,
}

impl Status {
    fn new(kind: &'static str, detail: impl Into<String>) -> Self {
        Self { kind, detail: detail.into(), progress: None }
    }

    fn at(self, progress: f64) -> Self {
        Self { progress: Some(progress), ..self }
    }
}

/// Maximum length of a scene name from the address in a message (characters).
const NAME_LIMIT: usize = 64;

impl App {
    /// The scene in the address and the scene of the server, if they differ.
    pub(super) fn other_scene(&self) -> Option<(&str, &str)> {
        let (linked, running) = (self.options.scene.as_deref()?, self.scene_name.as_deref()?);
        (linked != running).then_some((linked, running))
    }

    /// Shows the current status message if it has changed.
    pub(super) fn update_status(&mut self) {
        let now = self.current_status();
        if self.status != now {
            match &now {
                Some(Status { kind, detail, progress }) => page::message(kind, detail, *progress),
                None => page::clear(),
            }
            self.status = now;
        }
    }

    fn current_status(&self) -> Option<Status> {
        if let Some(failure) = &self.failure {
            return Some(Status::new(failure.kind, failure.reason.clone()));
        }
        self.scene_status().or_else(|| self.connection_status()).or_else(|| self.drawing_status())
    }

    fn scene_status(&self) -> Option<Status> {
        let (linked, running) = self.other_scene().filter(|_| self.connection.client().is_some())?;
        let linked: String = linked.chars().take(NAME_LIMIT).collect();
        let problem = format!("This link is for the scene {linked}, but the server runs {running}.");
        let remedy = format!(
            "To see the linked scene, choose it in the menu of scenes (O) if the server offers it, or start the server with it: prairie serve --scene {linked} (or the path of its file)."
        );
        Some(Status::new("other-scene", format!("{problem} {remedy}")))
    }

    fn connection_status(&self) -> Option<Status> {
        let reason = || self.notice.as_ref().map_or("", |(reason, _)| reason);
        Some(match self.connection.state() {
            ConnectionState::Closed(Close::Version) => Status::new("version", ""),
            ConnectionState::Closed(_) => Status::new("refused", reason()),
            ConnectionState::Connecting { reason: Some(Close::ServerFull), .. } => Status::new("full", reason()),
            ConnectionState::Connecting { attempts: 1.., .. } if self.was_welcomed => Status::new("server-gone", ""),
            ConnectionState::Connecting { attempts: 1.., .. } => {
                Status::new("connecting", "The server has not responded yet. Trying again…")
            }
            ConnectionState::Connecting { .. } if !self.was_welcomed => Status::new("connecting", "").at(CONNECTING),
            _ => return None,
        })
    }

    fn drawing_status(&self) -> Option<Status> {
        let preparing = |detail| Some(Status::new("preparing", detail));
        let (gpu, decoded) = match (&self.gpu, self.mirror.decoded_scene()) {
            (None, _) if self.losses > 0 => return Some(Status::new("device-back", "")),
            (None, _) => return preparing("Requesting the graphics device…").map(|status| status.at(REQUESTING_DEVICE)),
            (_, None) => return preparing("Receiving the scene…").map(|status| status.at(RECEIVING)),
            (Some(gpu), Some(decoded)) => (gpu, decoded),
        };
        let is_complete = gpu.is_complete(&self.mirror);
        if self.options.paused {
            return preparing("Drawing the land…").map(|status| status.at(DRAWING)).filter(|_| !is_complete);
        }
        let Some((newest, _)) = self.times.drawn().last() else {
            return preparing("Drawing the land…").map(|status| status.at(DRAWING));
        };
        if is_complete && self.times.complete_secs().is_some() {
            return None;
        }
        // A later renderer loads what the first one had.
        let shown = gpu.stage(&self.mirror).map_or(Stage::Land, |(stage, _)| stage.min(newest));
        shown.next(decoded).map(|next| Status::new("adding", addition(next)))
    }
}

/// Text about a stage that is being loaded.
fn addition(stage: Stage) -> &'static str {
    match stage {
        Stage::Land => "Land and sky…",
        Stage::Grass => "Grass…",
        Stage::Solids => "Trees, stones and vehicles…",
        Stage::Underbrush => "Underbrush…",
        Stage::Weather => "Rain and dust…",
    }
}
