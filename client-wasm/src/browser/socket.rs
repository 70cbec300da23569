//! The WebSocket: whole binary messages in and out.

use super::listener::Listener;
use wasm_bindgen::prelude::*;
use web_sys::{BinaryType, CloseEvent, Event, MessageEvent, WebSocket};

/// What a socket says.
pub(super) enum SocketEvent {
    /// It may be written to.
    Open,
    /// The bytes of one message.
    Message(Vec<u8>),
    /// It is over; the code of its close frame, 1006 when there was none.
    Closed(u16),
}

/// An open or opening socket; closed when it is dropped.
pub(super) struct Socket {
    socket: WebSocket,
    _listeners: [Listener; 3],
}

impl Socket {
    /// Starts to open a socket; `hear` gets its events until it is dropped.
    pub(super) fn open(url: &str, hear: fn(SocketEvent)) -> Result<Self, JsValue> {
        let socket = WebSocket::new(url)?;
        socket.set_binary_type(BinaryType::Arraybuffer);
        let listeners = [
            Listener::new(&socket, "open", move |_: &Event| hear(SocketEvent::Open)),
            Listener::new(&socket, "message", move |event: &MessageEvent| {
                if let Ok(buffer) = event.data().dyn_into::<js_sys::ArrayBuffer>() {
                    hear(SocketEvent::Message(js_sys::Uint8Array::new(&buffer).to_vec()));
                }
            }),
            Listener::new(&socket, "close", move |event: &CloseEvent| hear(SocketEvent::Closed(event.code()))),
        ];
        Ok(Self { socket, _listeners: listeners })
    }

    /// Bytes that wait to be sent.
    pub(super) fn waiting_bytes(&self) -> u32 {
        self.socket.buffered_amount()
    }

    /// Sends one message; what a closed socket cannot send is dropped, its end is told by [`SocketEvent::Closed`].
    pub(super) fn send(&self, bytes: &[u8]) {
        if self.socket.ready_state() == WebSocket::OPEN {
            let _ = self.socket.send_with_u8_array(bytes);
        }
    }
}

impl Drop for Socket {
    fn drop(&mut self) {
        let _ = self.socket.close();
    }
}
