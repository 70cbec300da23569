//! Environment variables: wrong values, and empty ones.

use crate::program::{command, prairie, text};
use std::process::Output;

fn run(arguments: &[&str], environment: &[(&str, &str)]) -> Output {
    command().args(arguments).envs(environment.iter().copied()).output().unwrap()
}

#[test]
fn a_wrong_value_is_wrong_usage_and_named_with_its_variable() {
    for (variable, value, message) in [
        ("PRAIRIE_ADDR", "nowhere", "'nowhere' for '--addr <HOST:PORT>': expected HOST:PORT, such as"),
        ("PRAIRIE_PUBLISH_HZ", "61", "'61' for '--publish-hz <HZ>': allowed: a whole number from 1 to 60"),
        ("PRAIRIE_ACME_EMAIL", "me@play.example", "error: PRAIRIE_ACME_EMAIL needs --tls acme:DOMAIN"),
        ("PRAIRIE_TLS_DIR", "kept", "error: PRAIRIE_TLS_DIR needs --tls self or --tls acme:DOMAIN"),
        ("RUST_LOG", "prairie=nolevel", "error: RUST_LOG is `prairie=nolevel`; allowed: levels (off, error, "),
    ] {
        let wrong = run(&["serve", "no-scene"], &[(variable, value)]);
        let told = text(&wrong.stderr);
        assert_eq!((wrong.status.code(), text(&wrong.stdout)), (Some(2), String::new()), "{variable}: {told}");
        assert!(told.contains(message) && told.contains(variable), "{variable}: {told}");
    }
}

#[test]
fn an_address_that_cannot_be_listened_on_is_named_with_its_variable() {
    let refused = run(&["blades"], &[("PRAIRIE_ADDR", "192.0.2.1:0")]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).starts_with("error: PRAIRIE_ADDR: cannot listen on 192.0.2.1:0: "), "{refused:?}");
}

#[test]
fn an_empty_variable_counts_as_unset() {
    let help = text(&prairie(&["serve", "--help"]).stdout);
    let variables: Vec<_> = help.split("[env:").skip(1).filter_map(|rest| rest.trim_start().split('=').next()).collect();
    assert!(variables.len() > 15 && variables.contains(&"PRAIRIE_SCENE") && variables.contains(&"PRAIRIE_ACME_ROOT"), "{variables:?}");
    let empty: Vec<_> = variables.iter().copied().chain(["RUST_LOG"]).map(|variable| (variable, "")).collect();
    for arguments in [["--tls", "no-cert.pem,no-key.pem"].as_slice(), &["serve", "--tls", "no-cert.pem,no-key.pem"]] {
        let failed = run(&[arguments, &["--addr", "127.0.0.1:0"]].concat(), &empty);
        assert!(text(&failed.stderr).starts_with("error: --tls: no-cert.pem cannot be read: "), "{arguments:?}: {failed:?}");
    }
    // Every one by itself, since the first wrong one hides the others.
    for (variable, value) in empty {
        let failed = run(&["no-scene"], &[(variable, value)]);
        assert_eq!(failed.status.code(), Some(1), "{variable}: {}", text(&failed.stderr));
    }
    assert_eq!(text(&run(&["serve", "--help"], &[("PRAIRIE_TLS", "")]).stdout), help, "the help names empty variables, too");
}
