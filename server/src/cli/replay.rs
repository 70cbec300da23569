//! `prairie replay`: plays what happened in a world.

use super::announce::announce;
use super::print::print;
use super::serve::address;
use super::stop_signal::StopSignal;
use super::world::default_folder;
use anyhow::Context as _;
use clap::{Args, ValueHint};
use prairie::inspect::{EntityRate, Target};
use prairie::journal::{Player, Replay, recorded};
use prairie::net::bind;
use prairie::scenes::LoadedScene;
use prairie::{Config, run_simulation};
use std::path::PathBuf;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie replay worlds/meadow-0f3c52a19b7de684
                                             all that is kept of a world, on http://127.0.0.1:8080
  prairie replay worlds --from 3600          from one hour after the beginning of the world
  prairie replay worlds --speed 4 --rerun save=run.rrd
                                             four times as fast, recorded for the rerun viewer
  prairie replay worlds --addr none          as fast as possible, unseen; prints its checksum

`prairie serve` keeps worlds in the user's data folder, or in that of --world; the log names the sub-folder at the start.
A replay is exact to the last bit. Viewers can look around but not drive. A running server is not disturbed.";

/// Arguments of `prairie replay`.
#[derive(Debug, Args)]
pub(super) struct ReplayArguments {
    /// Folder of a world, or one with only one world in it [default: the user's data folder]
    #[arg(value_name = "DIR", value_hint = ValueHint::DirPath)]
    world: Option<PathBuf>,
    /// Simulated time at which to begin (s) [default: the oldest that is kept]
    #[arg(long, value_name = "SECS", value_parser = from_zero)]
    from: Option<f64>,
    /// Speed relative to real time, 0.01 to 100
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = speed)]
    speed: f64,
    /// Address to listen on; port 0 picks a free port; `none` serves nothing
    #[arg(long, value_name = "HOST:PORT|none", default_value = "127.0.0.1:8080", value_parser = address_or_none)]
    addr: String,
    /// Record for the rerun viewer: serve it to viewers, save it to a file, or send it to a running viewer
    #[arg(long, value_name = "serve|save=FILE.rrd|connect=URL")]
    rerun: Option<Target>,
    /// Largest rate of an entity of the recording (1/s of simulated time), 0 to 60, where 0 turns it off; may be repeated. The README lists the entities
    #[arg(long, value_name = "PATH=HZ", requires = "rerun")]
    rerun_rate: Vec<EntityRate>,
}

impl ReplayArguments {
    pub(super) fn run(self) -> anyhow::Result<()> {
        anyhow::ensure!(
            self.rerun.is_none() || cfg!(feature = "rerun"),
            "--rerun: this binary was built without the recording for rerun; build it with `--features rerun`"
        );
        let path = self.world.clone().or_else(default_folder).context("name the folder of a world")?;
        let (scene, player) = recorded(&path, self.from)?;
        player.recording.faults.iter().for_each(|fault| tracing::warn!("{fault}"));
        let dt_secs = f64::from(scene.scene.dt_secs());
        let [now, end] = [player.world.tick(), player.recording.end];
        tracing::info!(scene = scene.name, from_secs = now as f64 * dt_secs, to_secs = end as f64 * dt_secs, "replaying");
        if self.addr == "none" {
            return unseen(player);
        }
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
        runtime.block_on(self.serve(scene, player))
    }

    async fn serve(self, scene: LoadedScene, player: Player) -> anyhow::Result<()> {
        let mut stop = StopSignal::install()?;
        let listener = bind(&self.addr).await.context("--addr")?;
        let address = listener.local_addr()?;
        let config = Config { rerun: self.rerun, rerun_rates: self.rerun_rate, ..Config::new(scene) };
        let shutdown = async {
            announce(address, None, false);
            stop.received().await;
        };
        Ok(run_simulation(Replay::new(player, self.speed), config, listener, shutdown).await?)
    }
}

/// Plays to the end as fast as possible.
fn unseen(mut player: Player) -> anyhow::Result<()> {
    let start = player.world.tick();
    player.advance(u64::MAX);
    let (end, sum) = (player.world.tick(), player.world.checksum());
    print(format!("steps {start} to {end}, checksum {sum:016x}"))?;
    Ok(())
}

/// Parser of a time from zero on (s).
pub(super) fn from_zero(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|secs: &f64| secs.is_finite() && *secs >= 0.0).ok_or_else(|| "allowed: 0 or more".to_owned())
}

fn speed(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|speed| (0.01..=100.0).contains(speed)).ok_or_else(|| "allowed: 0.01 to 100".to_owned())
}

fn address_or_none(text: &str) -> Result<String, String> {
    if text == "none" { Ok(text.to_owned()) } else { address(text) }
}
