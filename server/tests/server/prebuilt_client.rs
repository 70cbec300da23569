//! `PRAIRIE_CLIENT=FOLDER`: the page of an earlier build, or an error that names the folder and the missing file.

use std::fs;
use std::path::Path;

#[path = "../../build/prebuilt.rs"]
mod prebuilt;

const PAGE: &str =
    "<link rel=\"icon\" href=\"icon.svg\">\n<a href=\"https://example.org\" href=\"#top\">\n<script src=\"start.js\"></script>";

fn write_page(folder: &Path, names: &[&str]) {
    for name in names {
        fs::write(folder.join(name), if *name == "index.html" { PAGE } else { name }).unwrap();
    }
}

#[test]
fn a_complete_page_is_copied() {
    let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let names = ["icon.svg", "index.html", "prairie_client.js", "prairie_client_bg.wasm", "start.js"];
    write_page(folder.path(), &names);
    prebuilt::copy(folder.path(), out.path()).unwrap();
    for name in names {
        assert_eq!(fs::read(out.path().join(name)).unwrap(), fs::read(folder.path().join(name)).unwrap(), "{name}");
    }
}

#[test]
fn an_incomplete_page_is_reported_with_folder_and_file() {
    let out = tempfile::tempdir().unwrap();
    let names = ["index.html", "prairie_client.js", "prairie_client_bg.wasm", "icon.svg", "start.js"];
    for missing in names {
        let folder = tempfile::tempdir().unwrap();
        write_page(folder.path(), &names.into_iter().filter(|name| *name != missing).collect::<Vec<_>>());
        let error = prebuilt::copy(folder.path(), out.path()).unwrap_err();
        assert!(error.contains(&format!("the folder {} has no {missing}", folder.path().display())), "{missing}: {error}");
    }
    assert_eq!(fs::read_dir(out.path()).unwrap().count(), 0, "nothing is copied from an incomplete page");
}

#[test]
fn a_missing_folder_and_one_inside_are_reported() {
    let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let nowhere = folder.path().join("nowhere");
    let error = prebuilt::copy(&nowhere, out.path()).unwrap_err();
    assert!(error.contains(nowhere.to_str().unwrap()) && error.contains("allowed: `skip`"), "{error}");

    fs::create_dir(&nowhere).unwrap();
    let error = prebuilt::copy(folder.path(), out.path()).unwrap_err();
    assert!(error.contains("holds nowhere"), "{error}");
}
