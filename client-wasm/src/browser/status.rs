//! Page status messages, which cover the picture or appear above it.

use super::app::App;
use super::connection::ConnectionState;
use super::page;
use prairie_core::wire::Close;

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
                Some((kind, detail)) => page::message(kind, detail),
                None => page::clear(),
            }
            self.status = now;
        }
    }

    fn current_status(&self) -> Option<(&'static str, String)> {
        if let Some(failure) = &self.failure {
            return Some((failure.kind, failure.reason.clone()));
        }
        self.scene_status().or_else(|| self.connection_status()).or_else(|| self.drawing_status())
    }

    fn scene_status(&self) -> Option<(&'static str, String)> {
        let (linked, running) = self.other_scene().filter(|_| self.connection.client().is_some())?;
        let linked: String = linked.chars().take(NAME_LIMIT).collect();
        let problem = format!("This link is for the scene {linked}, but the server runs {running}.");
        let remedy =
            format!("To see the linked scene, start the server with it: prairie serve --scene {linked} (or the path of its file).");
        Some(("other-scene", format!("{problem} {remedy}")))
    }

    fn connection_status(&self) -> Option<(&'static str, String)> {
        let (kind, detail) = match self.connection.state() {
            ConnectionState::Closed(Close::Version) => ("version", ""),
            ConnectionState::Closed(_) => ("refused", self.notice.as_ref().map_or("", |(reason, _)| reason)),
            ConnectionState::Connecting { reason: Some(Close::ServerFull), .. } => {
                ("full", self.notice.as_ref().map_or("", |(reason, _)| reason))
            }
            ConnectionState::Connecting { attempts: 1.., .. } if self.was_welcomed => ("server-gone", ""),
            ConnectionState::Connecting { attempts: 1.., .. } => ("connecting", "The server has not responded yet. Trying again…"),
            ConnectionState::Connecting { .. } if !self.was_welcomed => ("connecting", ""),
            _ => return None,
        };
        Some((kind, detail.to_owned()))
    }

    fn drawing_status(&self) -> Option<(&'static str, String)> {
        let (kind, detail) = match (&self.gpu, self.mirror.decoded_scene()) {
            (None, _) if self.losses > 0 => ("device-back", ""),
            (None, _) => ("preparing", "Requesting the graphics device…"),
            (_, None) => ("preparing", "Receiving the scene…"),
            _ if self.meter.frames() == 0 && !self.options.paused => ("preparing", "Drawing the first frame…"),
            _ => return None,
        };
        Some((kind, detail.to_owned()))
    }
}
