//! Arguments of TLS, and the folder of the made certificate.

use crate::program::{command, prairie, text};
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::Stdio;

#[test]
fn wrong_arguments_of_tls_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.pem").display().to_string();
    let file = folder.path().join("file").display().to_string();
    std::fs::write(&file, "text").unwrap();
    for (arguments, expected) in [
        (&["--tls", "on"][..], "'on' for '--tls <self|CERT,KEY|acme:DOMAIN[,DOMAIN]>': expected `self`, two PEM files"),
        (&["--tls", "acme:192.168.1.5"], "`192.168.1.5`: expected a name"),
        (&["--tls", &format!("{missing},{file}")], &format!("error: --tls: {missing} cannot be read: ")),
        (&["--tls", "self", "--tls-dir", &file], &format!("error: --tls-dir: {file} cannot be created: ")),
        (&["--tls-dir", &file], "error: --tls-dir needs --tls self or --tls acme:DOMAIN"),
        (&["--tls", "cert.pem,key.pem", "--tls-dir", &file], "error: --tls-dir needs --tls self or --tls acme:DOMAIN"),
        (&["--tls", "self", "--acme-email", "me@play.example"], "error: --acme-email needs --tls acme:DOMAIN"),
        (&["--acme-root", &file], "error: --acme-root needs --tls acme:DOMAIN"),
        (&["--acme-email", "me"], "'me' for '--acme-email <ADDRESS>': expected an e-mail address"),
        (&["--acme-directory", "acme.example"], "'acme.example' for '--acme-directory <URL>': expected the URL"),
        (&["--allow-origin", "play.example"], "'play.example' for '--allow-origin <ORIGIN>': expected scheme, host and port"),
        (&["--allow-host", "play.example:8443"], "'play.example:8443' for '--allow-host <NAME>': expected a name without a port"),
    ] {
        let failed = prairie(&[&["serve", "--addr", "127.0.0.1:0"], arguments].concat());
        assert!(!failed.status.success() && failed.stdout.is_empty(), "{arguments:?}: {failed:?}");
        assert!(text(&failed.stderr).contains(expected), "{arguments:?}: {}", text(&failed.stderr));
    }
}

const SCENE: &str = "summary = 'a test'\npatches = { count = [1, 1], cells = 8, cell_m = 1.0 }\n[terrain]\nheight_map = 'land.png'\n\
    covering_map = 'land.png'\npixel_m = [8, 8]\nlevel_m = 0.1\n[wind]\ncells = [8, 4, 8]\n";

#[test]
fn a_certificate_is_kept_in_the_folder_that_the_start_names() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, kept) = (folder.path().join("scene.toml"), folder.path().join("kept"));
    std::fs::write(&scene, SCENE).unwrap();
    std::fs::write(folder.path().join("land.png"), prairie_core::terrain::grey_png([2; 2], &[255; 4])).unwrap();
    let fingerprint = || {
        let mut server = command()
            .args(["serve", "--addr", "127.0.0.1:0", "--tls", "self", "--tls-dir"])
            .args([&kept, Path::new("--scene"), &scene])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(server.stdout.take().unwrap());
        let kept_in = format!("  certificate kept in: {}\n", kept.display());
        let mut text = String::new();
        while !text.ends_with(&kept_in) && output.read_line(&mut text).unwrap() > 0 {}
        server.kill().unwrap();
        server.wait().unwrap();
        assert!(text.ends_with(&kept_in), "{text}");
        text.lines().find(|line| line.starts_with("  certificate SHA-256: ")).expect("a fingerprint").to_owned()
    };
    assert_eq!(fingerprint(), fingerprint());
}
