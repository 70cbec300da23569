//! `prairie chart` and `prairie stability`.

use std::process::{Command, Output};

fn prairie(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_prairie")).args(arguments).output().expect("prairie starts")
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[cfg(not(feature = "charts"))]
#[test]
fn without_the_charts_the_commands_say_how_to_get_them() {
    for command in ["chart", "stability"] {
        let refused = prairie(&[command, "wind", "--quick"]);
        assert_eq!(refused.status.code(), Some(1));
        assert!(stderr(&refused).contains("build it with `--features charts`"), "{refused:?}");
    }
}

#[cfg(feature = "charts")]
mod with_the_charts {
    use super::*;
    use serde_json::Value;
    use std::fs;
    use std::path::Path;

    fn run(arguments: &[&str], out: &Path) -> Output {
        prairie(&[arguments, &["--quick", "--out", out.to_str().expect("UTF-8")]].concat())
    }

    fn data(folder: &Path) -> Value {
        serde_json::from_str(&fs::read_to_string(folder.join("charts.json")).unwrap()).unwrap()
    }

    #[test]
    fn models_measured_one_after_the_other_are_on_one_page() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("new");
        let charted = run(&["chart", "blades"], &out);
        assert!(charted.status.success(), "{charted:?}");
        assert!(String::from_utf8_lossy(&charted.stdout).contains("the fastest method for an error"), "{charted:?}");
        assert!(run(&["stability", "bend"], &out).status.success());
        let names: Vec<_> = fs::read_dir(&out).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
        for name in ["charts.html", "blades.csv", "blades.json", "blades-tip-in-a-gust.svg", "bend-failures.svg", "bend-failures.csv"] {
            assert!(names.iter().any(|other| other == name), "{name} is missing among {names:?}");
        }
        let data = data(&out);
        assert_eq!((data["charts"].as_array().unwrap().len(), data["maps"].as_array().unwrap().len()), (1, 1));
        assert!(data["is_quick"] == true && data["charts"][0]["default"] == "exact", "{data}");
        assert!(data["charts"][0]["rows"].as_array().unwrap().iter().all(|row| row["l2"].as_f64().unwrap() > 0.0));
    }

    #[test]
    fn what_is_not_there_is_named_with_what_is_allowed() {
        let folder = tempfile::tempdir().unwrap();
        let unknown = prairie(&["chart", "wnd"]);
        assert!(unknown.status.code() == Some(2) && stderr(&unknown).contains("wind, bend, blades"), "{unknown:?}");
        let none = run(&["chart", "blades", "--only", "xyzzy"], folder.path());
        assert!(none.status.code() == Some(1) && stderr(&none).contains("--only xyzzy: no problem"), "{none:?}");
        fs::write(folder.path().join("charts.json"), "{}[").unwrap();
        let foreign = run(&["chart", "blades"], folder.path());
        assert!(foreign.status.code() == Some(1) && stderr(&foreign).contains("move it away, or name another folder"), "{foreign:?}");
        assert_eq!(fs::read_to_string(folder.path().join("charts.json")).unwrap(), "{}[", "a file of another kind is overwritten");
    }
}
