//! Version of the wire format, and the encoded bytes of every message in this version.

#[cfg(test)]
mod tests;

/// Version of the wire format; both sides must agree. Changes whenever an encoded byte does; a test compares the bytes with the pinned ones.
pub const PROTOCOL: u8 = 25;

/// Encoded messages in this version, without the version byte: hexadecimal up to 40 bytes, else length and FNV-1a hash.
#[cfg(test)]
const PINS: &[(&str, &str)] = &[
    ("protocol", "25"),
    ("client Hello", "0003416461"),
    ("client View", "010000803f000020c0002474490000c042"),
    ("client Choose", "020102"),
    ("client Drive", "03ac020000803f000000bf0000803e0000003e"),
    ("client Ack", "04f0a204"),
    ("client Ping", "0507"),
    ("client Rename", "06054772616365"),
    ("client Return", "070341646103abababababababababababababababababababababababababababababababab"),
    ("client Replicate", "0801"),
    ("client Differs", "09ac028201"),
    ("server Welcome", "47 bytes, e24a32964020568d"),
    ("server Scene", "1347 bytes, 65a19116ae5d0576"),
    ("server Poses", "51 bytes, e962de2ed87d03d6"),
    ("server Wind", "03ac020201000000000000f03f00000000000000c000000000000008400000003f020908"),
    ("server Patch", "04820103000107"),
    ("server Roster", "0501030341646101c801"),
    ("server Broken", "06018001ff"),
    ("server FrameEnd", "0704ac020000000000001440"),
    ("server Refused", "08000466756c6c"),
    ("server Pong", "0907"),
    ("server ReplicaState", "0aac0201c801020506"),
    ("server Steps", "41 bytes, 0bc60e3432bb92d7"),
    ("server Applied", "0c07ac02"),
    ("server Race", "0d01c801020101000000000000144001010000803f010000003f010000004001000000bf"),
    ("server Ghost", "0e01c801030000a0410000803d0000003e0180800100ff7f000000feff03"),
    ("refusals", "0001020304"),
    ("vehicle kinds", "06000102030405"),
    ("scenes with every word", "145776 bytes, d9e500dee0cca31a"),
];
