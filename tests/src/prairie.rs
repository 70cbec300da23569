//! A complete server in the test's own process.

use crate::browser::Browser;
use anyhow::Result;
use prairie::runner::Simulation;
use prairie::scenes::LoadedScene;
use prairie::world::World;
use prairie::{Config, Limits, RunError, run_and_reload, run_simulation};
use std::net::SocketAddr;
use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;

/// A server; it stops when dropped.
#[derive(Debug)]
pub struct Prairie {
    /// Listening address.
    pub addr: SocketAddr,
    stop: oneshot::Sender<()>,
    server: JoinHandle<Result<(), RunError>>,
}

impl Prairie {
    /// Serves a scene with `simulation` as its world on a free port.
    ///
    /// # Errors
    /// When no port is free.
    pub async fn serve(scene: LoadedScene, simulation: impl Simulation) -> Result<Self> {
        Self::serve_within(scene, simulation, Limits::default()).await
    }

    /// The same within limits.
    ///
    /// # Errors
    /// When no port is free.
    pub async fn serve_within(scene: LoadedScene, simulation: impl Simulation, limits: Limits) -> Result<Self> {
        Self::serve_at(SocketAddr::from(([127, 0, 0, 1], 0)), scene, simulation, limits).await
    }

    /// The same at an address.
    ///
    /// # Errors
    /// When the port is not free.
    pub async fn serve_at(addr: SocketAddr, scene: LoadedScene, simulation: impl Simulation, limits: Limits) -> Result<Self> {
        let listener = TcpListener::bind(addr).await?;
        let addr = listener.local_addr()?;
        let (stop, stopped) = oneshot::channel::<()>();
        let server = tokio::spawn(run_simulation(simulation, Config { limits, ..Config::new(scene) }, listener, async {
            let _ = stopped.await;
        }));
        Ok(Self { addr, stop, server })
    }

    /// Serves a scene whose pages may change to another one.
    ///
    /// # Errors
    /// When the world cannot be built, or no port is free.
    pub async fn serve_with_menu(scene: LoadedScene) -> Result<Self> {
        let listener = TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await?;
        let addr = listener.local_addr()?;
        let world = World::new(&scene.scene, scene.maps())?;
        let (stop, stopped) = oneshot::channel::<()>();
        let config = Config { pages_change_scene: true, ..Config::new(scene) };
        let server = tokio::spawn(run_and_reload(world, config, listener, async {
            let _ = stopped.await;
        }));
        Ok(Self { addr, stop, server })
    }

    /// Stops the server, and waits until its world has ended.
    ///
    /// # Errors
    /// When the server has failed.
    pub async fn stop(self) -> Result<()> {
        drop(self.stop);
        Ok(self.server.await??)
    }

    /// Opens a browser and waits until it has the scene, the first frames and a GPU device. It draws only on request: continuous software rendering would
    /// occupy all of a small machine.
    ///
    /// # Errors
    /// When the browser does not start, or the page does not connect or draw.
    pub async fn visitor(&self, name: &str) -> Result<Browser> {
        self.visitor_at(&format!("?quality=low&panel=0&name={name}")).await
    }

    /// The same with another query string, from its `?` on.
    ///
    /// # Errors
    /// As [`visitor`](Self::visitor).
    pub async fn visitor_at(&self, address: &str) -> Result<Browser> {
        let browser = Browser::open(&self.url(address)).await?;
        browser.until("(s => s && s.connected && s.time_secs > 0)(window.prairie.state())").await?;
        browser.until("document.getElementById('message').hidden").await?;
        Ok(browser)
    }

    /// Address of a page that draws only on request, with this query string (from its `?` on).
    #[must_use]
    pub fn url(&self, address: &str) -> String {
        let query = address.trim_start_matches('?');
        format!("http://{}/?paused=1&{query}", self.addr)
    }
}
