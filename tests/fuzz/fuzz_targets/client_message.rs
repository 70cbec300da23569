//! A message from a client, as the server decodes it.

#![no_main]

use libfuzzer_sys::fuzz_target;
use prairie_core::wire::{CLIENT_MESSAGE_LIMIT, ClientMessage, decode, encode};

fuzz_target!(|bytes: &[u8]| {
    if let Ok(message) = decode::<ClientMessage>(bytes, CLIENT_MESSAGE_LIMIT) {
        // Bytes are compared, since a NaN does not equal itself.
        let encoded = encode(&message);
        let again: ClientMessage = decode(&encoded, CLIENT_MESSAGE_LIMIT).expect("an encoded message can be decoded");
        assert_eq!(encode(&again), encoded);
    }
});
