//! A client's inputs between receipt and execution. Each kind has a rate limit, and a newer input replaces one that waits.

use super::app::App;
use super::end::End;
use super::name::name_for;
use super::newest::Newest;
use crate::config::Limits;
use crate::stream::{AreaOfInterest, Client, Difference};
use crate::token_bucket::TokenBucket;
use crate::world::Command;
use bytes::Bytes;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{self, ClientMessage, Drive, ServerMessage, VIEW_RADIUS_LIMIT_M};
use std::time::{Duration, Instant};
use tokio::sync::mpsc;

/// Largest absolute camera coordinate (m).
const EYE_LIMIT_M: f32 = 1e6;

/// A client's inputs that wait to be carried out.
#[derive(Debug)]
pub(super) struct Inputs {
    /// The newest input that the world has not accepted yet; a world that lags skips older ones.
    drive: Option<(u32, Drive)>,
    view: Newest<AreaOfInterest>,
    choice: Newest<Option<VehicleKind>>,
    name: Newest<String>,
    pings: TokenBucket,
}

impl Inputs {
    pub(super) fn new(limits: &Limits) -> Self {
        let now = Instant::now();
        Self {
            drive: None,
            view: Newest::new(limits.views_per_s, now),
            choice: Newest::new(limits.choices_per_s, now),
            name: Newest::new(limits.renames_per_s, now),
            pings: TokenBucket::new((2.0 * limits.pings_per_s).max(1.0), limits.pings_per_s, now),
        }
    }

    /// Takes in a message, and answers a ping; pings beyond the rate are not answered.
    ///
    /// # Errors
    /// When a value is out of range, or the message is not allowed now.
    pub(super) fn take_in(&mut self, message: ClientMessage, client: &Client, replies: &mpsc::Sender<Bytes>) -> Result<(), End> {
        match message {
            ClientMessage::Hello { .. } | ClientMessage::Return { .. } => return Err(End::bad("a second hello; a session has one")),
            ClientMessage::View { eye_m, radius_m } => {
                if !eye_m.iter().all(|m| m.abs() <= EYE_LIMIT_M) {
                    return Err(End::bad(format!("view: eye_m is {eye_m:?}; allowed: each within ±{EYE_LIMIT_M}")));
                }
                if !(0.0..=VIEW_RADIUS_LIMIT_M).contains(&radius_m) {
                    return Err(End::bad(format!("view: radius_m is {radius_m}; allowed: 0..={VIEW_RADIUS_LIMIT_M}")));
                }
                self.view.put(AreaOfInterest { eye_m, radius_m });
            }
            ClientMessage::Choose { vehicle } => {
                // The input was meant for the previous vehicle.
                self.drive = None;
                self.choice.put(vehicle);
            }
            ClientMessage::Drive { number, drive } => {
                if !drive.is_valid() {
                    return Err(End::bad(format!("drive: {drive:?}; allowed: throttle, steer and lift -1..=1, brake 0..=1")));
                }
                self.drive = Some((number, drive));
            }
            ClientMessage::Ack { frame } => {
                if !client.acknowledge(frame) {
                    return Err(End::bad(format!("ack: frame {frame} was never sent")));
                }
            }
            ClientMessage::Ping { nonce } => {
                self.pings.fill(Instant::now());
                if self.pings.try_take(1.0) {
                    let _ = replies.try_send(wire::encode(&ServerMessage::Pong { nonce }).into());
                }
            }
            ClientMessage::Rename { name } => self.name.put(name_for(client.id, &name)),
            ClientMessage::Replicate { wanted } => client.request_replica(wanted),
            ClientMessage::Differs { tick, patch } => {
                client.report_difference(Difference { tick, patch });
                client.request_replica(true);
            }
        }
        Ok(())
    }

    /// Carries out the waiting inputs that the rate limits allow now.
    pub(super) async fn carry_out(&mut self, app: &App, client: &Client) {
        let (id, now) = (client.id, Instant::now());
        if let Some(area) = self.view.take_due(now) {
            client.set_area_of_interest(area);
        }
        if let Some(name) = self.name.take_due(now) {
            client.rename(name);
        }
        if let Some(vehicle) = self.choice.take_due(now) {
            // A new vehicle appears below the client's newest camera.
            let cameras = vehicle.map(|_| Command::Cameras(app.clients.cameras()));
            let choice = match vehicle {
                Some(kind) => Command::Spawn { client: id, kind },
                None => Command::Remove { client: id },
            };
            // These commands must not be lost, so this waits for a lagging world, which delays only this client's own input.
            for command in cameras.into_iter().chain([choice]) {
                let _ = app.commands.send(command).await;
            }
        }
    }

    /// Time until the rates allow more; `None` if nothing waits for that.
    pub(super) fn wait(&self) -> Option<Duration> {
        [self.view.wait(), self.choice.wait(), self.name.wait()].into_iter().flatten().min()
    }

    /// Whether there is driving input for the world. It waits while a choice of a vehicle waits, since it is for that vehicle.
    pub(super) fn has_drive(&self) -> bool {
        self.drive.is_some() && !self.choice.is_waiting()
    }

    /// The driving input for the world, with its number.
    pub(super) fn take_drive(&mut self) -> Option<(u32, Drive)> {
        self.drive.take()
    }
}
