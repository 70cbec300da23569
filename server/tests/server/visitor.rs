//! A visitor's end of a connection.

use crate::common::Picture;
use crate::running::{Server, within};
use futures_util::{SinkExt, StreamExt};
use shared::wire::{ClientMessage, ObjectId, ObjectPose, Refusal, ServerMessage, encode};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::Message;

/// A visitor's end of a connection.
pub(crate) struct Visitor<S> {
    pub(crate) socket: WebSocketStream<S>,
    pub(crate) picture: Picture,
    pub(crate) client: u32,
    pub(crate) peers: Vec<(u32, String, Option<ObjectId>)>,
    pub(crate) objects: Vec<ObjectPose>,
    pub(crate) refusals: Vec<Refusal>,
    /// Why, for the person.
    pub(crate) reasons: Vec<String>,
}

pub(crate) type Plain = Visitor<TcpStream>;

impl Plain {
    /// Opens the socket and says nothing yet.
    pub(crate) async fn connect(server: &Server) -> Self {
        Self::over(TcpStream::connect(server.address).await.unwrap(), &format!("ws://{}/ws", server.address)).await
    }

    /// Opens the socket, says hello and waits for the scene.
    pub(crate) async fn join(server: &Server, name: &str) -> Self {
        let mut visitor = Self::connect(server).await;
        visitor.greet(name).await;
        visitor
    }
}

impl<S: AsyncRead + AsyncWrite + Unpin> Visitor<S> {
    pub(crate) async fn over(stream: S, url: &str) -> Self {
        let (socket, _) = within(tokio_tungstenite::client_async(url, stream)).await.unwrap();
        Self {
            socket,
            picture: Picture::default(),
            client: 0,
            peers: Vec::new(),
            objects: Vec::new(),
            refusals: Vec::new(),
            reasons: Vec::new(),
        }
    }

    pub(crate) async fn greet(&mut self, name: &str) {
        self.say(&ClientMessage::Hello { name: name.to_owned() }).await;
        let welcome = self.hear().await.unwrap();
        let ServerMessage::Welcome { client, scene_name, .. } = welcome else { panic!("{welcome:?}") };
        assert!(!scene_name.is_empty());
        self.client = client;
        assert!(matches!(self.hear().await, Ok(ServerMessage::Scene { .. })));
        self.say(&ClientMessage::View { eye_m: [12.0, 2.0, 12.0], radius_m: 100.0 }).await;
    }

    pub(crate) async fn say(&mut self, message: &ClientMessage) {
        self.send(Message::Binary(encode(message).into())).await;
    }

    pub(crate) async fn send(&mut self, message: Message) {
        // The server may have hung up already; that is seen when reading.
        let _ = within(self.socket.send(message)).await;
    }

    /// The next message, or the code and reason of the close.
    pub(crate) async fn hear(&mut self) -> Result<ServerMessage, (u16, String)> {
        loop {
            match within(self.socket.next()).await {
                Some(Ok(Message::Binary(bytes))) => {
                    let message = self.picture.apply(&bytes);
                    match &message {
                        ServerMessage::Roster { peers } => {
                            self.peers = peers.iter().map(|peer| (peer.client, peer.name.clone(), peer.object)).collect();
                        }
                        ServerMessage::Poses { objects, .. } => self.objects.clone_from(objects),
                        ServerMessage::Refused { refusal, reason } => {
                            self.refusals.push(*refusal);
                            self.reasons.push(reason.clone());
                        }
                        _ => {}
                    }
                    return Ok(message);
                }
                Some(Ok(Message::Close(Some(close)))) => return Err((close.code.into(), close.reason.to_string())),
                Some(Ok(_)) => {}
                other => panic!("the connection ended without a close: {other:?}"),
            }
        }
    }

    /// Reads to the end of the next frame and acknowledges it.
    pub(crate) async fn frame(&mut self) -> u64 {
        loop {
            if let ServerMessage::FrameEnd { frame, tick, .. } = self.hear().await.expect("the connection stays") {
                self.say(&ClientMessage::Ack { frame }).await;
                return tick;
            }
        }
    }

    pub(crate) async fn frames_until(&mut self, mut reached: impl FnMut(&Self) -> bool) {
        within(async {
            while !reached(self) {
                self.frame().await;
            }
        })
        .await;
    }

    /// Reads, acknowledging nothing, until the server closes.
    pub(crate) async fn closed(&mut self) -> (u16, String) {
        loop {
            if let Err(close) = self.hear().await {
                return close;
            }
        }
    }
}
