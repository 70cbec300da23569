//! What the page has to say instead of, or above, the prairie.

use super::app::App;
use super::connection::Standing;
use super::page;
use shared::wire::Close;

impl App {
    /// The scene that the address names and the one that the server runs, where these are two.
    pub(super) fn other_scene(&self) -> Option<(&str, &str)> {
        let (linked, running) = (self.options.scene.as_deref()?, self.scene_name.as_deref()?);
        (linked != running).then_some((linked, running))
    }

    /// Shows the page's message for where things stand, when that has changed.
    pub(super) fn tell(&mut self) {
        let now = self.message();
        if self.told != now {
            match &now {
                Some((kind, detail)) => page::message(kind, detail),
                None => page::clear(),
            }
            self.told = now;
        }
    }

    fn message(&self) -> Option<(&'static str, String)> {
        let words = |kind, detail: &str| Some((kind, detail.to_owned()));
        if let Some(failure) = &self.failure {
            return words(failure.kind, &failure.reason);
        }
        if let Some((linked, running)) = self.other_scene().filter(|_| self.connection.client().is_some()) {
            let linked: String = linked.chars().take(64).collect();
            let what = format!("The link names the scene {linked}; this server runs {running}.");
            let how = format!("To see the link, start the server with that scene, or its file: prairie serve --scene {linked}");
            return words("other-scene", &format!("{what} {how}"));
        }
        match self.connection.standing() {
            Standing::Over(Close::Version) => return words("version", ""),
            Standing::Over(_) => return words("refused", self.notice.as_ref().map_or("", |(reason, _)| reason)),
            Standing::Away { why: Some(Close::ServerFull), .. } => return words("full", ""),
            Standing::Away { attempts: 1.., .. } if self.welcomed_once => return words("server-gone", ""),
            Standing::Away { attempts: 1.., .. } => return words("connecting", "The server does not answer yet; trying again…"),
            Standing::Away { .. } if !self.welcomed_once => return words("connecting", ""),
            _ => {}
        }
        match (&self.stage, self.mirror.land()) {
            (None, _) if self.losses > 0 => words("device-back", ""),
            (None, _) => words("preparing", "Asking for the graphics device…"),
            (_, None) => words("preparing", "The land is on its way…"),
            _ if self.meter.frames() == 0 && !self.options.paused => words("preparing", "Drawing the first picture…"),
            _ => None,
        }
    }
}
