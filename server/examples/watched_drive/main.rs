//! Measures the data rate of a client whose camera follows a driving car, by kind of message, without a network.
//!
//! `cargo run --release -p prairie --example watched_drive -- [SCENE] [RADIUS_M] [SECONDS] [patches|replica] [car|none] [VIEWERS]`: with patches or with a replica
//! of the grass, with or without the car, and with other viewers beside the measured client.

mod measure;

use anyhow::Context;
use measure::{Measured, STEPS_PER_PUBLISH, WatchedDrive};

fn main() -> anyhow::Result<()> {
    let drive = arguments()?;
    let Measured { sums, publishing, tick_hz } = drive.measure()?;
    let WatchedDrive { scene, radius_m, measured_secs, viewers, .. } = drive;
    println!(
        "{scene}, radius {radius_m} m, {measured_secs} s at {} Hz, {viewers} other viewers; {:.3} ms per publication",
        tick_hz / STEPS_PER_PUBLISH as f32,
        publishing.as_secs_f64() * 1e3
    );
    for (kind, (count, sum)) in &sums {
        println!(
            "{kind:12} {:8.1} messages/s {:8.1} bytes each {:9.1} kbit/s",
            *count as f32 / measured_secs,
            *sum as f32 / *count as f32,
            *sum as f32 * 8e-3 / measured_secs
        );
    }
    println!("total {:.0} kbit/s", sums.values().map(|(_, sum)| *sum as f32).sum::<f32>() * 8e-3 / measured_secs);
    Ok(())
}

fn arguments() -> anyhow::Result<WatchedDrive> {
    let mut arguments = std::env::args().skip(1);
    Ok(WatchedDrive {
        scene: arguments.next().unwrap_or_else(|| "meadow".to_owned()),
        radius_m: arguments.next().map_or(Ok(48.0), |text| text.parse()).context("RADIUS_M")?,
        measured_secs: arguments.next().map_or(Ok(20.0), |text| text.parse()).context("SECONDS")?,
        has_replica: arguments.next().is_some_and(|way| way == "replica"),
        has_car: arguments.next().is_none_or(|car| car == "car"),
        viewers: arguments.next().map_or(Ok(0), |text| text.parse()).context("VIEWERS")?,
    })
}
