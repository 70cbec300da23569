//! Parser of scene files: from text to a checked [`Scene`], or to a list of every fault.

use super::checks::{Conflicts, check_underbrush_species, cross_checks};
use super::walk::Walk;
use super::{Positions, Scene, SceneFault, Underbrush, flat, template};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use toml::de::DeTable;
use toml::{Spanned, Table, Value};

/// Parses the text of a scene file and checks every value; `underbrush_file` is only a name here.
///
/// # Errors
/// All faults of the text at once, ordered by line: syntax errors; or else unknown fields (with the nearest known name), missing fields, wrong types,
/// values out of range, and values that conflict with each other.
pub fn parse(text: &str) -> Result<Scene, Vec<SceneFault>> {
    parse_with(text, Vec::new())
}

/// As [`parse`], with the species of its `underbrush_file` put before its own.
///
/// # Errors
/// As [`parse`], and conflicts with those species.
pub fn parse_with(text: &str, underbrush: Vec<Underbrush>) -> Result<Scene, Vec<SceneFault>> {
    let root = root(text)?;
    let mut values = template::scene(root.get_ref());
    let species = template::species(text, &values, root.get_ref());
    let mut walk = Walk::new(text, "a scene", &values).with_species(species);
    walk.table(&mut values, root.get_ref(), root.span(), "");

    flat::nest(&mut values);
    let mut scene: Scene = made_of(values, text)?;
    let from_file = underbrush.len();
    scene.underbrush.splice(0..0, underbrush);
    walk.judge(cross_checks(&scene, from_file))?;
    Ok(scene)
}

/// Parses the text of an underbrush file, which contains only sections `[[underbrush]]`.
///
/// # Errors
/// As [`parse`].
pub fn parse_underbrush(text: &str) -> Result<Vec<Underbrush>, Vec<SceneFault>> {
    /// Contents of the file.
    #[derive(Deserialize)]
    struct File {
        underbrush: Vec<Underbrush>,
    }

    let root = root(text)?;
    let mut values = Table::from_iter([("underbrush".to_owned(), Value::Array(Vec::new()))]);
    let mut walk = Walk::new(text, "an underbrush file", &values);
    walk.table(&mut values, root.get_ref(), root.span(), "");

    let File { underbrush } = made_of(values, text)?;
    let mut conflicts = Conflicts::default();
    check_underbrush_species(&underbrush, 0, &mut conflicts);
    walk.judge(conflicts)?;
    Ok(underbrush)
}

/// Parses TOML into values with their positions.
fn root(text: &str) -> Result<Spanned<DeTable<'_>>, Vec<SceneFault>> {
    let (root, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() { Ok(root) } else { Err(syntax_faults(text, &errors)) }
}

/// The first error of each line; later ones on the same line are seldom more than consequences.
fn syntax_faults(text: &str, errors: &[toml::de::Error]) -> Vec<SceneFault> {
    let positions = Positions::new(text);
    let mut faults: Vec<_> =
        errors.iter().map(|error| positions.spanning(error.span().unwrap_or(0..0), "", format!("not TOML: {}", error.message()))).collect();
    faults.sort_by_key(|fault| (fault.line, fault.column));
    faults.dedup_by_key(|fault| fault.line);
    faults
}

fn made_of<T: DeserializeOwned>(values: Table, text: &str) -> Result<T, Vec<SceneFault>> {
    T::deserialize(values).map_err(|error| vec![Positions::new(text).spanning(0..0, "", error.message())])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const MINIMAL: &str =
        "summary = \"s\"\n[terrain]\nheight_map = \"h.png\"\ncovering_map = \"c.png\"\npixel_m = [0.5, 1]\nlevel_m = 0.1\n";

    fn faults_of(more: &str) -> Vec<(usize, usize, String)> {
        let faults = parse(&format!("{MINIMAL}{more}")).unwrap_err();
        faults.iter().map(|fault| (fault.line, fault.column, fault.to_string())).collect()
    }

    #[test]
    fn a_minimal_scene_has_the_defaults() {
        let scene = parse(MINIMAL).unwrap();
        assert_eq!(scene.terrain.pixel_m, [0.5, 1.0]);
        assert_eq!(scene.extent_m(), [256.0, 256.0]);
        assert_eq!(scene.dt_secs(), 1.0 / 60.0);
    }

    #[test]
    fn all_faults_are_reported_at_once_in_the_order_of_the_lines() {
        let faults = faults_of(
            "[wind]\ncells = [32, 8]\ntiling = \"bix\"\nviscosity_m2_per_s = nan\nsorces = 3\ntree_m = 4\n[objects]\nlimit = 2.5\n",
        );
        let expected = [
            (8, 9, "`wind.cells` is a list of 2; expected a list of 3 numbers, each 2 to 256"),
            (9, 10, "`wind.tiling` is \"bix\"; allowed: \"box\", \"patch\" or \"follow\""),
            (10, 22, "`wind.viscosity_m2_per_s` is nan; allowed: 0 to 100"),
            (11, 1, "`wind.sorces` is not a field of a scene; did you mean `sources`?"),
            (12, 1, "`wind.tree_m` is not a field of a scene; did you mean `plants.tree_m`?"),
            (14, 9, "`objects.limit` is the number 2.5; expected a whole number, 0 to 1024"),
        ];
        assert_eq!(faults, expected.map(|(line, column, text)| (line, column, text.to_owned())));
    }

    #[test]
    fn conflicting_values_are_reported() {
        let only = |more: &str| {
            let faults = faults_of(more);
            assert_eq!(faults.len(), 1, "{faults:?}");
            faults[0].2.clone()
        };
        assert!(only("[patches]\ncells = 60\n").ends_with("a multiple of 8"));
        assert!(only("[patches]\ncount = [2048, 1]\ncell_m = 1.0\n").contains("131072 m"));
        assert!(only("[patches]\ncells = 256\nawake_limit = 4096\n").contains("33554432"));
        assert!(only("[wind]\ncells = [256, 256, 256]\n").contains("2097152"));
        assert!(only("[wind]\ncells = [2, 2, 2]\n").starts_with("`wind.sources` is 24"));
        assert!(only("[wind]\nmean_m_per_s = [30, 30]\n").contains("42.4"));
        assert_eq!(only("[objects]\nself_driving = 65\n"), "`objects.self_driving` is 65; allowed: up to `objects.limit`, 64");
    }

    #[test]
    fn syntax_errors_are_reported_with_their_position() {
        let faults = parse("summary = \"s\"\n[terrain\nheight_map = \"h.png\"\n").unwrap_err();
        assert_eq!(faults[0].line, 2);
        assert!(faults[0].message.starts_with("not TOML"), "{}", faults[0].message);
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "[a-z\\[\\]=\\.\"\n0-9é ]{0,80}") {
            let faults = parse(&text).unwrap_err();
            prop_assert!(!faults.is_empty());
        }

        #[test]
        fn a_scene_survives_being_written_and_read(seed in 0..i64::MAX as u64, tick in 10.0f32..240.0, spacing in 0.1f32..1000.0) {
            let mut scene = parse(MINIMAL).unwrap();
            (scene.seed, scene.tick_hz, scene.wind.spacing_m[1]) = (seed, tick, spacing);
            prop_assert_eq!(parse(&scene.to_toml()).unwrap(), scene);
        }
    }
}
