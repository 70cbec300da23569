//! Help texts and messages equal the stored ones in `snapshots`; `TRYCMD=overwrite` rewrites them.

use crate::program::{prairie, text};
use std::path::Path;

#[test]
fn help_texts_and_messages_equal_the_stored_ones() {
    let cases = trycmd::TestCases::new();
    cases.register_bin("prairie", Path::new(env!("CARGO_BIN_EXE_prairie")));
    cases.case("tests/cli/snapshots/*.trycmd");
    if cfg!(feature = "rerun") {
        cases.skip("tests/cli/snapshots/without_rerun.trycmd");
    }
    if !cfg!(feature = "charts") {
        cases.skip("tests/cli/snapshots/charts.trycmd");
    }
    if !cfg!(feature = "picture") {
        cases.skip("tests/cli/snapshots/picture.trycmd");
    }
}

#[test]
fn the_help_of_every_command_is_stored() {
    let help = text(&prairie(&["--help"]).stdout);
    let (_, commands) = help.split_once("Commands:\n").unwrap();
    let names: Vec<_> = commands.lines().map_while(|line| line.split_whitespace().next()).filter(|name| *name != "help").collect();
    assert!(names.contains(&"serve") && names.contains(&"man"), "{names:?}");
    let stored =
        ["help", "picture", "charts"].map(|file| std::fs::read_to_string(format!("tests/cli/snapshots/{file}.trycmd")).unwrap()).concat();
    for name in names {
        assert!(stored.contains(&format!("\n$ prairie {name} --help\n")), "{name}");
    }
}
