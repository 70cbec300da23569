//! A scene file, and an underbrush file.

#![no_main]

use libfuzzer_sys::fuzz_target;
use prairie_core::scene::{parse, parse_underbrush};

fuzz_target!(|text: &str| {
    if let Ok(scene) = parse(text) {
        let written = scene.to_toml();
        let again = parse(&written).unwrap_or_else(|faults| panic!("{faults:?}\n{written}"));
        assert_eq!(again, scene);
    }
    let _ = parse_underbrush(text);
});
