//! A test client.

use crate::common::Replica;
use crate::test_server::{Server, within};
use futures_util::{SinkExt, StreamExt};
use prairie_core::wire::{ClientMessage, ObjectId, ObjectPose, Refusal, ServerMessage, encode};
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::{TcpSocket, TcpStream};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::Message;

/// A client's end of a connection, with the state that it has received.
pub(crate) struct TestClient<S> {
    pub(crate) socket: WebSocketStream<S>,
    pub(crate) replica: Replica,
    pub(crate) id: u32,
    pub(crate) peers: Vec<(u32, String, Option<ObjectId>)>,
    pub(crate) objects: Vec<ObjectPose>,
    pub(crate) refusals: Vec<Refusal>,
    /// The reasons of the refusals, as text.
    pub(crate) reasons: Vec<String>,
}

pub(crate) type PlainClient = TestClient<TcpStream>;

impl PlainClient {
    /// Opens the WebSocket without a hello.
    pub(crate) async fn connect(server: &Server) -> Self {
        Self::over(TcpStream::connect(server.address).await.unwrap(), &format!("ws://{}/ws", server.address)).await
    }

    /// Opens the WebSocket from another address of this machine, with a small receive buffer.
    pub(crate) async fn connect_from(server: &Server, source: [u8; 4]) -> Self {
        let socket = TcpSocket::new_v4().unwrap();
        socket.set_recv_buffer_size(4096).unwrap();
        socket.bind((source, 0).into()).unwrap();
        let stream = socket.connect(server.address).await.unwrap();
        Self::over(stream, &format!("ws://{}/ws", server.address)).await
    }

    /// Opens the WebSocket, sends the hello and waits for the scene.
    pub(crate) async fn join(server: &Server, name: &str) -> Self {
        let mut client = Self::connect(server).await;
        client.say_hello(name).await;
        client
    }
}

impl<S: AsyncRead + AsyncWrite + Unpin> TestClient<S> {
    pub(crate) async fn over(stream: S, url: &str) -> Self {
        let (socket, _) = within(tokio_tungstenite::client_async(url, stream)).await.unwrap();
        Self {
            socket,
            replica: Replica::default(),
            id: 0,
            peers: Vec::new(),
            objects: Vec::new(),
            refusals: Vec::new(),
            reasons: Vec::new(),
        }
    }

    pub(crate) async fn say_hello(&mut self, name: &str) {
        self.ask_to_join(name).await;
        self.welcome().await;
    }

    /// Sends the hello.
    pub(crate) async fn ask_to_join(&mut self, name: &str) {
        self.send_message(&ClientMessage::Hello { name: name.to_owned() }).await;
    }

    /// Waits for welcome and scene, then sends a view.
    pub(crate) async fn welcome(&mut self) {
        let welcome = self.receive().await.unwrap();
        let ServerMessage::Welcome { client, scene_name, .. } = welcome else { panic!("{welcome:?}") };
        assert!(!scene_name.is_empty());
        self.id = client;
        assert!(matches!(self.receive().await, Ok(ServerMessage::Scene { .. })));
        self.send_message(&ClientMessage::View { eye_m: [12.0, 2.0, 12.0], radius_m: 100.0 }).await;
    }

    pub(crate) async fn send_message(&mut self, message: &ClientMessage) {
        self.send(Message::Binary(encode(message).into())).await;
    }

    pub(crate) async fn send(&mut self, message: Message) {
        // The server may have closed the connection already; reading reports that.
        let _ = within(self.socket.send(message)).await;
    }

    /// The next message, or the code and reason of the close.
    pub(crate) async fn receive(&mut self) -> Result<ServerMessage, (u16, String)> {
        loop {
            match within(self.socket.next()).await {
                Some(Ok(Message::Binary(bytes))) => {
                    let message = self.replica.apply(&bytes);
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
            if let ServerMessage::FrameEnd { frame, tick, .. } = self.receive().await.expect("the connection stays open") {
                self.send_message(&ClientMessage::Ack { frame }).await;
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

    /// Reads without acknowledging until the server closes; returns code and reason.
    pub(crate) async fn closed(&mut self) -> (u16, String) {
        loop {
            if let Err(close) = self.receive().await {
                return close;
            }
        }
    }
}
