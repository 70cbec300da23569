//! Films: a folder of numbered PNG files, or one file encoded by ffmpeg.

use super::image_file::write_picture;
use anyhow::{Context as _, Result, bail, ensure};
use std::ffi::OsString;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// A film that is being written. Without [`finish`](Self::finish), an unfinished file is removed.
pub struct Film {
    size_px: [u32; 2],
    output: Output,
}

enum Output {
    /// Numbered PNG files.
    Folder { folder: PathBuf, frames: u32 },
    /// A pipe to ffmpeg, which writes `part`.
    Encoder { child: Child, part: PathBuf, path: PathBuf },
}

/// Formats that ffmpeg writes: ending, name of its container, and arguments of its encoder.
const FORMATS: [(&str, &str, &[&str]); 4] = [
    ("webm", "webm", &["-c:v", "libvpx-vp9", "-crf", "32", "-b:v", "0", "-row-mt", "1", "-pix_fmt", "yuv420p"]),
    ("mp4", "mp4", &["-c:v", "libx264", "-crf", "20", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]),
    ("webp", "webp", &["-c:v", "libwebp", "-quality", "60", "-compression_level", "6", "-loop", "0"]),
    ("gif", "gif", &["-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0"]),
];

impl Film {
    /// Starts a film of `size_px` at `path`: a file if its name ends in `.webm`, `.mp4`, `.webp` or `.gif`, which needs the program ffmpeg; otherwise a
    /// folder of PNG files named by the number of their frame, which is created.
    ///
    /// # Errors
    /// When the folder is not empty, the ending is that of another format, ffmpeg is missing, or it cannot encode this size.
    pub fn create(path: &Path, size_px: [u32; 2], frames_per_s: u32) -> Result<Self> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let format = FORMATS.iter().find(|(known, ..)| ending.as_deref() == Some(*known));
        let output = match (format, ending) {
            (Some((ending, container, encoder)), _) => {
                let subsampled = encoder.contains(&"yuv420p");
                ensure!(
                    !subsampled || size_px.iter().all(|side| side.is_multiple_of(2)),
                    "{}: a .{ending} film needs an even width and height, not {} × {} pixels",
                    path.display(),
                    size_px[0],
                    size_px[1]
                );
                encode(path, size_px, frames_per_s, container, encoder)?
            }
            (None, Some(ending)) => bail!(
                "{}: `.{ending}` is not a film format; allowed: .webm, .mp4, .webp, .gif, or a folder (a name without an ending) for PNG files",
                path.display()
            ),
            (None, None) => {
                fs::create_dir_all(path).with_context(|| path.display().to_string())?;
                let is_empty = fs::read_dir(path).with_context(|| path.display().to_string())?.next().is_none();
                ensure!(is_empty, "{} is not empty; frames are written to a new or empty folder", path.display());
                Output::Folder { folder: path.to_owned(), frames: 0 }
            }
        };
        Ok(Self { size_px, output })
    }

    /// Adds a frame of 8-bit RGBA rows from the top.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn add(&mut self, rgba: &[u8]) -> Result<()> {
        match &mut self.output {
            Output::Folder { folder, frames } => {
                *frames += 1;
                write_picture(&folder.join(format!("{frames:05}.png")), self.size_px, rgba)
            }
            Output::Encoder { child, path, .. } => {
                let expected = 4 * self.size_px[0] as usize * self.size_px[1] as usize;
                ensure!(rgba.len() == expected, "the graphics device was lost");
                let pipe = child.stdin.as_mut().context("ffmpeg has no input")?;
                pipe.write_all(rgba).with_context(|| format!("{}: ffmpeg stopped early", path.display()))
            }
        }
    }

    /// Completes the film.
    ///
    /// # Errors
    /// When ffmpeg fails or the file cannot be moved to its place.
    pub fn finish(mut self) -> Result<()> {
        let Output::Encoder { child, part, path } = &mut self.output else { return Ok(()) };
        drop(child.stdin.take());
        let status = child.wait().context("ffmpeg")?;
        ensure!(status.success(), "{}: ffmpeg failed ({status}); its message is above", path.display());
        fs::rename(part, &*path).with_context(|| path.display().to_string())
    }
}

impl Drop for Film {
    fn drop(&mut self) {
        if let Output::Encoder { child, part, .. } = &mut self.output {
            // After `finish` the process has ended and the part is moved: both calls then do nothing.
            let _ = child.kill();
            let _ = child.wait();
            let _ = fs::remove_file(part);
        }
    }
}

/// Starts ffmpeg, which reads frames from a pipe and writes them beside `path`.
fn encode(path: &Path, [width, height]: [u32; 2], frames_per_s: u32, container: &str, encoder: &[&str]) -> Result<Output> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    let part = path.with_added_extension("part");
    let program = std::env::var_os("PRAIRIE_FFMPEG").unwrap_or_else(|| OsString::from("ffmpeg"));
    let started = Command::new(&program)
        .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba"])
        .args(["-s", &format!("{width}x{height}"), "-r", &frames_per_s.to_string(), "-i", "-"])
        .args(encoder)
        .args(["-f", container])
        // ffmpeg takes a name that begins with a hyphen for an option.
        .arg(if part.is_relative() { Path::new(".").join(&part) } else { part.clone() })
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .spawn();
    let child = started.with_context(|| {
        format!(
            "{}: the program ffmpeg encodes films, and `{}` did not start; install ffmpeg, name it in PRAIRIE_FFMPEG, or give a folder for PNG files",
            path.display(),
            program.to_string_lossy()
        )
    })?;
    Ok(Output::Encoder { child, part, path: path.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(path: &Path, size_px: [u32; 2]) -> String {
        Film::create(path, size_px, 10).err().map(|error| format!("{error:#}")).unwrap_or_default()
    }

    #[test]
    fn a_folder_gets_numbered_pictures() -> Result<()> {
        let dir = tempfile::tempdir()?;
        let folder = dir.path().join("frames");
        let mut film = Film::create(&folder, [2, 1], 10)?;
        film.add(&[9; 8])?;
        film.add(&[200; 8])?;
        film.finish()?;
        assert!(folder.join("00001.png").exists() && folder.join("00002.png").exists());
        assert!(refused(&folder, [2, 1]).contains("is not empty"), "frames of another film stay");
        Ok(())
    }

    #[test]
    fn unsuitable_formats_and_sizes_are_refused() {
        assert!(refused(Path::new("film.avi"), [2, 2]).contains("`.avi` is not a film format; allowed: .webm"));
        assert!(refused(Path::new("film.webm"), [3, 2]).contains("needs an even width and height, not 3 × 2"));
    }

    #[test]
    fn an_unfinished_film_leaves_no_file() -> Result<()> {
        let dir = tempfile::tempdir()?;
        let path = dir.path().join("film.gif");
        // Stands for an encoder: it keeps its input in a part, as ffmpeg does.
        let output = |command: &str| -> Result<Film> {
            let part = path.with_added_extension("part");
            let child = Command::new("sh").args(["-c", command]).arg(&part).stdin(Stdio::piped()).spawn()?;
            Ok(Film { size_px: [2, 1], output: Output::Encoder { child, part, path: path.clone() } })
        };
        let mut left = output("cat > \"$0\"")?;
        left.add(&[1; 8])?;
        drop(left);
        assert_eq!(fs::read_dir(dir.path())?.count(), 0);

        let failed = output("cat > \"$0\"; exit 3")?.finish().expect_err("the encoder failed").to_string();
        assert!(failed.contains("film.gif: ffmpeg failed"), "{failed}");
        assert_eq!(fs::read_dir(dir.path())?.count(), 0);

        let mut whole = output("cat > \"$0\"")?;
        whole.add(&[1; 8])?;
        whole.finish()?;
        assert_eq!(fs::read(&path)?, [1; 8]);
        assert_eq!(fs::read_dir(dir.path())?.count(), 1);
        Ok(())
    }
}
