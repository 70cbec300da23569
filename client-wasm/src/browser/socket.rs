//! The WebSocket, in binary messages.

use super::listener::Listener;
use std::cell::RefCell;
use wasm_bindgen::prelude::*;
use web_sys::{BinaryType, CloseEvent, Event, MessageEvent, WebSocket};

thread_local! {
    /// The newest socket, which [`close`] reaches even while the client is locked.
    static NEWEST: RefCell<Option<WebSocket>> = const { RefCell::new(None) };
}

/// Closes the page's socket, if it has one.
pub(super) fn close() {
    if let Some(socket) = NEWEST.take() {
        let _ = socket.close();
    }
}

/// Events of a socket.
pub(super) enum SocketEvent {
    /// The socket is open for writing.
    Open,
    /// The bytes of one message.
    Message(Vec<u8>),
    /// The socket was closed, with the code of its close frame; 1006 if there was none.
    Closed(u16),
}

/// An open or opening socket. Dropping it closes it.
pub(super) struct Socket {
    socket: WebSocket,
    _listeners: [Listener; 3],
}

impl Socket {
    /// Starts to open a socket. `handle` receives its events until it is dropped.
    pub(super) fn open(url: &str, handle: fn(SocketEvent)) -> Result<Self, JsValue> {
        let socket = WebSocket::new(url)?;
        socket.set_binary_type(BinaryType::Arraybuffer);
        NEWEST.set(Some(socket.clone()));
        let listeners = [
            Listener::new(&socket, "open", move |_: &Event| handle(SocketEvent::Open)),
            Listener::new(&socket, "message", move |event: &MessageEvent| {
                if let Ok(buffer) = event.data().dyn_into::<js_sys::ArrayBuffer>() {
                    handle(SocketEvent::Message(js_sys::Uint8Array::new(&buffer).to_vec()));
                }
            }),
            Listener::new(&socket, "close", move |event: &CloseEvent| handle(SocketEvent::Closed(event.code()))),
        ];
        Ok(Self { socket, _listeners: listeners })
    }

    /// Bytes buffered for sending.
    pub(super) fn buffered_bytes(&self) -> u32 {
        self.socket.buffered_amount()
    }

    /// Sends one message. On a closed socket it is dropped; [`SocketEvent::Closed`] reports the end.
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
