//! A whole server in the test's own process.

use crate::browser::Browser;
use anyhow::Result;
use server::runner::Simulation;
use server::scenes::LoadedScene;
use server::{Config, run_simulation};
use std::net::SocketAddr;
use tokio::net::TcpListener;
use tokio::sync::oneshot;

/// A server on a free port; it stops when dropped.
#[derive(Debug)]
pub struct Prairie {
    /// Where it listens.
    pub addr: SocketAddr,
    _stop: oneshot::Sender<()>,
}

impl Prairie {
    /// Serves a scene with `simulation` as its world.
    ///
    /// # Errors
    /// When no port is free.
    pub async fn serve(scene: LoadedScene, simulation: impl Simulation) -> Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0").await?;
        let addr = listener.local_addr()?;
        let (stop, stopped) = oneshot::channel::<()>();
        tokio::spawn(run_simulation(simulation, Config::new(scene), listener, async {
            let _ = stopped.await;
        }));
        Ok(Self { addr, _stop: stop })
    }

    /// A browser that has the scene, the first frames and a device to draw with. It draws only when asked: software rendering would take all of a small machine.
    ///
    /// # Errors
    /// When no browser can be started, or the page does not get that far.
    pub async fn visitor(&self, name: &str) -> Result<Browser> {
        self.visitor_at(&format!("?quality=low&panel=0&name={name}")).await
    }

    /// The same at an address of one's own, from its `?` on.
    ///
    /// # Errors
    /// As [`visitor`](Self::visitor).
    pub async fn visitor_at(&self, address: &str) -> Result<Browser> {
        let browser = Browser::open(&self.url(address)).await?;
        browser.until("(s => s && s.connected && s.time_secs > 0)(window.prairie.state())").await?;
        browser.until("document.getElementById('message').hidden").await?;
        Ok(browser)
    }

    /// An address on this server, from its `?` on, for a page that draws only when asked.
    #[must_use]
    pub fn url(&self, address: &str) -> String {
        let query = address.trim_start_matches('?');
        format!("http://{}/?paused=1&{query}", self.addr)
    }
}
