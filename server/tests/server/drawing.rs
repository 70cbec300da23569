//! `prairie picture` and `prairie film`, by a software Vulkan driver where there is no other.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Runs a small drawing command that writes to `out`.
fn draw(arguments: &[&str], out: &Path) -> Output {
    let mut prairie = Command::new(env!("CARGO_BIN_EXE_prairie"));
    prairie.args(arguments).arg("--out").arg(out).output().expect("prairie starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[cfg(not(feature = "picture"))]
#[test]
fn without_the_renderer_the_commands_say_how_to_get_it() {
    let folder = tempfile::tempdir().unwrap();
    for command in ["picture", "film"] {
        let refused = draw(&[command, "--scene", "shells"], &folder.path().join("a.png"));
        assert_eq!(refused.status.code(), Some(1));
        assert!(stderr(&refused).contains("build it with `--features picture`"), "{refused:?}");
    }
}

#[cfg(feature = "picture")]
mod with_the_renderer {
    use super::*;

    const SMALL: [&str; 6] = ["--scene", "blades", "--size", "64x36", "--quality", "low"];

    fn size_px(png: &Path) -> [u32; 2] {
        let decoder = png::Decoder::new(std::io::BufReader::new(fs::File::open(png).unwrap()));
        let reader = decoder.read_info().unwrap();
        [reader.info().width, reader.info().height]
    }

    #[test]
    fn a_picture_is_drawn_with_its_figures() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/blades.png");
        let drawn = draw(&[&["picture"], &SMALL[..], &["--frames", "2", "--stats", "--compare", "low,sorted"]].concat(), &path);
        assert!(drawn.status.success(), "{}", stderr(&drawn));
        assert_eq!(size_px(&path), [64, 36]);
        let printed = String::from_utf8_lossy(&drawn.stdout).into_owned();
        assert!(printed.contains("ms per frame") && printed.contains("GPU time: ") && printed.contains("camera "), "{printed}");
    }

    #[test]
    fn a_film_follows_the_scene_in_numbered_frames() {
        let folder = tempfile::tempdir().unwrap();
        let frames = folder.path().join("frames");
        let film = [&["film"], &SMALL[..], &["--act", "track", "--chase", "7,2,0", "--seconds", "1", "--frames-per-second", "3"]].concat();
        let drawn = draw(&film, &frames);
        assert!(drawn.status.success(), "{}", stderr(&drawn));
        let pictures: Vec<_> = (1..=3).map(|number| fs::read(frames.join(format!("{number:05}.png"))).unwrap()).collect();
        assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2], "the car drives");
        assert_eq!(fs::read_dir(&frames).unwrap().count(), 3);

        let again = draw(&film, &frames);
        assert_eq!(again.status.code(), Some(1));
        assert!(stderr(&again).contains("is not empty"), "{again:?}");
    }

    /// An encoder that keeps its input in the file it is to write.
    #[cfg(unix)]
    fn encoder(folder: &Path) -> std::path::PathBuf {
        use std::os::unix::fs::PermissionsExt as _;
        let program = folder.join("encoder");
        fs::write(&program, "#!/bin/sh\nfor file; do :; done\nexec cat > \"$file\"\n").unwrap();
        fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        program
    }

    #[cfg(unix)]
    #[test]
    fn a_signal_ends_a_film_and_leaves_no_part_of_it() {
        let folder = tempfile::tempdir().unwrap();
        let (film, part) = (folder.path().join("film.gif"), folder.path().join("film.gif.part"));
        let mut prairie = Command::new(env!("CARGO_BIN_EXE_prairie"));
        prairie.arg("film").args(SMALL).args(["--seconds", "3600", "--out"]).arg(&film);
        let child = prairie.env("PRAIRIE_FFMPEG", encoder(folder.path())).stderr(std::process::Stdio::piped()).spawn().unwrap();
        while !fs::metadata(&part).is_ok_and(|part| part.len() > 0) {
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        assert!(Command::new("sh").arg("-c").arg(format!("kill -INT {}", child.id())).status().unwrap().success());
        let stopped = child.wait_with_output().unwrap();
        assert_eq!(stopped.status.code(), Some(1), "{}", stderr(&stopped));
        assert!(stderr(&stopped).contains("film.gif: stopped by a signal"), "{}", stderr(&stopped));
        assert!(!part.exists() && !film.exists());
    }

    #[test]
    fn wrong_options_name_the_option_and_what_is_allowed() {
        let folder = tempfile::tempdir().unwrap();
        for (option, value, allowed) in [
            ("--size", "0x9", "WIDTHxHEIGHT, each 1 to 8192"),
            ("--camera", "1,2", "five numbers"),
            ("--sun", "10,91", "elevation from -90 to 90"),
            ("--hour", "25", "0 to 24"),
            ("--chase", "0,0,0", "not all 0"),
            ("--compare", "low", "two of"),
            ("--quality", "best", "low, medium, high, ultra"),
            ("--frames", "0", "a whole number from 1 to 100000"),
            ("--out", "a.bmp", "ends in .png, .jpg or .jpeg"),
        ] {
            let path = folder.path().join("a.png");
            // The last of two values of an option would be refused for being the second.
            let usual = [("--scene", "blades"), ("--frames", "1"), ("--size", "8x8"), ("--out", path.to_str().unwrap())];
            let arguments =
                usual.into_iter().filter(|(name, _)| *name != option).chain([(option, value)]).flat_map(|(name, value)| [name, value]);
            let refused = Command::new(env!("CARGO_BIN_EXE_prairie")).arg("picture").args(arguments).output().unwrap();
            assert!(!refused.status.success(), "{option}");
            let message = stderr(&refused);
            assert!(message.contains(allowed) && message.contains(option), "{option}: {message}");
            assert!(!path.exists(), "{option}: nothing is written");
        }
    }
}
