//! The codec of grids: a payload over a base, and back.
//!
//! Input: width − 1 (low four bits) and the number of planes (bit 4), rows − 1, a value that varies the base, payload.

#![no_main]

use libfuzzer_sys::fuzz_target;
use prairie_core::wire::quantise::CODE_LIMIT;
use prairie_core::wire::{Shape, codec};

fuzz_target!(|bytes: &[u8]| {
    let Some((&[columns, rows, slope], payload)) = bytes.split_first_chunk() else { return };
    let shape = Shape::wind(usize::from(columns & 15) + 1, columns & 16 != 0);
    let len = shape.planes * shape.width * (usize::from(rows & 31) + 1);
    let base: Vec<i16> =
        (0..len).map(|at| ((at * usize::from(slope) * 257) % 65_535) as u16 as i16).map(|code| code.max(-CODE_LIMIT)).collect();
    let mut codes = base.clone();
    if codec::decode(shape, payload, &mut codes).is_ok() {
        let encoded = codec::encode(shape, &codes, Some(&base));
        let mut again = base.clone();
        codec::decode(shape, &encoded, &mut again).expect("an encoded grid can be decoded");
        assert_eq!(again, codes);
    }
});
