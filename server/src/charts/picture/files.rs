//! The files of all measurements.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};

use super::Shot;
use crate::charts::texture::Texture;
use prairie_charts::Row;
use prairie_charts::line::lines;
use prairie_charts::plot::{Labels, svg};

/// The chart of all views: means over them.
pub(super) const ALL: &str = "all views";

/// Writes `picture.csv`, `picture.json` and a chart of FLIP against time for each view and of the means over all, to a folder, which is created if
/// needed; `about` states the size of the pictures and the machine.
///
/// # Errors
/// When the folder or a file cannot be written.
pub fn write_all(shots: &[Shot], about: &str, out: &Path) -> Result<Vec<PathBuf>> {
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be made", out.display()))?;
    let json: Vec<String> = shots.iter().map(serde_json::to_string).collect::<Result<_, _>>()?;
    let mut files = vec![("picture.csv".to_owned(), csv(shots)), ("picture.json".to_owned(), format!("[\n{}\n]\n", json.join(",\n")))];
    let mut views: Vec<&str> = Vec::new();
    shots.iter().for_each(|shot| {
        if !views.contains(&shot.view.as_str()) {
            views.push(&shot.view)
        }
    });
    let mut rows: Vec<Row> = shots.iter().map(row).collect();
    if views.len() > 1 {
        rows.extend(means(shots, views.len()).iter().map(row));
        views.push(ALL);
    }
    for view in views {
        let lines = lines(&rows, view, NORM);
        if lines.is_empty() {
            continue;
        }
        let title = format!("{view}: cost of similarity");
        let labels = Labels {
            title: &title,
            error: "mean FLIP to the reference",
            time: "frame time (s)",
            caption: about,
            default_method: Some("land, cut"),
            limit: &[],
        };
        files.push((format!("picture-{}.svg", view.replace(' ', "-")), svg(&lines, labels)?));
    }
    let write = |(name, text): (String, String)| {
        let path = out.join(name);
        std::fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

const NORM: &str = "mean FLIP";

fn row(shot: &Shot) -> Row {
    Row {
        model: "picture".to_owned(),
        problem: shot.view.clone(),
        method: shot.method.clone(),
        cells: [0; 3],
        dt_secs: 0.0,
        norm: NORM.to_owned(),
        error: shot.flip,
        wall_secs: shot.ms * 1e-3,
    }
}

/// Means over the views, for each method and quality measured on all of them.
pub(super) fn means(shots: &[Shot], views: usize) -> Vec<Shot> {
    let mut means: Vec<Shot> = Vec::new();
    for shot in shots {
        if means.iter().any(|mean| mean.method == shot.method && mean.level == shot.level) {
            continue;
        }
        let same: Vec<&Shot> = shots.iter().filter(|other| other.method == shot.method && other.level == shot.level).collect();
        let mean = |of: fn(&Shot) -> f64| same.iter().map(|shot| of(shot)).sum::<f64>() / same.len() as f64;
        if same.len() == views {
            means.push(Shot {
                view: ALL.to_owned(),
                ms: mean(|shot| shot.ms),
                flip: mean(|shot| shot.flip),
                flip_worst: mean(|shot| shot.flip_worst),
                ssim: mean(|shot| shot.ssim),
                texture: Texture {
                    brightness: mean(|shot| shot.texture.brightness),
                    contrast: mean(|shot| shot.texture.contrast),
                    gradients: mean(|shot| shot.texture.gradients),
                },
                blades: mean(|shot| shot.blades.into()) as u32,
                clumps: mean(|shot| shot.clumps.into()) as u32,
                ..shot.clone()
            });
        }
    }
    means
}

/// Measurements as CSV (RFC 4180).
fn csv(shots: &[Shot]) -> String {
    let mut text = String::from("view,method,quality,level,ms,flip,flip_worst,ssim,brightness,contrast,gradients,blades,clumps\n");
    for Shot { view, method, quality, level, ms, flip, flip_worst, ssim, texture, blades, clumps } in shots {
        let Texture { brightness, contrast, gradients } = texture;
        writeln!(text, "{view},\"{method}\",{quality},{level},{ms:.3},{flip:.5},{flip_worst:.5},{ssim:.5},{brightness:.5},{contrast:.5},{gradients:.5},{blades},{clumps}")
            .expect("a string takes all");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::shot::made_up;
    use super::*;

    #[test]
    fn means_only_cover_methods_measured_in_all_views() {
        let shots = [made_up("a", "m", 0, 10.0, 0.1), made_up("b", "m", 0, 30.0, 0.2), made_up("a", "m", 1, 50.0, 0.1)];
        let [mean] = means(&shots, 2).try_into().unwrap();
        assert_eq!((mean.view.as_str(), mean.ms, mean.level), (ALL, 20.0, 0.0));
        assert!((mean.flip - 0.15).abs() < 1e-12);
    }

    #[test]
    fn a_chart_per_view_and_one_of_all() {
        let folder = tempfile::tempdir().unwrap();
        let shots = ["ant", "hill"].map(|view| made_up(view, "clumps, cut", 0, 10.0, 0.1));
        let files = write_all(&shots, "made-up machine", &folder.path().join("new")).unwrap();
        let names: Vec<&str> = files.iter().filter_map(|path| path.file_name()?.to_str()).collect();
        assert_eq!(names, ["picture.csv", "picture.json", "picture-ant.svg", "picture-hill.svg", "picture-all-views.svg"]);
        let text = std::fs::read_to_string(&files[0]).unwrap();
        assert_eq!(text.lines().nth(1), Some("ant,\"clumps, cut\",low,0,10.000,0.10000,0.20000,0.90000,0.01000,0.02000,0.30000,7,3"));
        let read: serde_json::Value = serde_json::from_slice(&std::fs::read(&files[1]).unwrap()).unwrap();
        assert_eq!(read[1]["view"], "hill");
        assert!(std::fs::read_to_string(&files[4]).unwrap().contains("made-up machine"));
    }
}
