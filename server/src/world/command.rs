//! Commands from clients, and from the server itself, to the world.

use crate::detail::Decision;
use prairie_core::grass::Camera;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;
use serde::{Deserialize, Serialize};

/// A request from outside the world, carried out before the next step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Command {
    /// Gives a client a vehicle in place of its previous one, near its camera.
    Spawn {
        /// Number of the client.
        client: u32,
        /// Kind of the vehicle.
        kind: VehicleKind,
    },
    /// Removes a client's vehicle.
    Remove {
        /// Number of the client.
        client: u32,
    },
    /// Sets the input of a client's vehicle, which stays until the next one.
    Drive {
        /// Number of the client.
        client: u32,
        /// Number of the input, which the client gave it.
        number: u32,
        /// The driver's input.
        drive: Drive,
    },
    /// Replaces the cameras of all clients.
    Cameras(Vec<Camera>),
    /// A new client has connected. Its number is not given to another, also after a restart.
    Join {
        /// Number of the client.
        client: u32,
    },
    /// The connection of a client has ended. Its vehicle stops, and is removed after [`KEPT_SECS`](super::KEPT_SECS) unless the client returns; without a
    /// vehicle, its times in the race are forgotten at once.
    Leave {
        /// Number of the client.
        client: u32,
    },
    /// A client is back, and drives the vehicle that was kept for it.
    Return {
        /// Number of the client.
        client: u32,
    },
    /// The server changes the detail. What the scene does not allow is left out.
    Adapt(Decision),
}
