//! The tables of the README list every scheme.

use prairie_wind::{Advection, TimeScheme};

const README: &str = include_str!("../../README.md");

/// The cells of the row that begins with a scheme.
fn row(scheme: &str) -> Vec<&'static str> {
    let start = format!("| `{scheme}`");
    let row = README.lines().find(|line| line.starts_with(&start)).unwrap_or_else(|| panic!("the README has no row for {scheme}"));
    row.split(" | ").map(|cell| cell.trim_matches(['|', ' '])).collect()
}

#[test]
fn every_advection_scheme_is_listed_with_name_and_order() {
    for &scheme in Advection::ALL {
        assert_eq!(row(&format!("{scheme:?}"))[1..3], [format!("`{}`", scheme.name()), scheme.order().to_string()]);
    }
}

#[test]
fn every_time_scheme_is_listed_with_its_order() {
    for &scheme in TimeScheme::ALL {
        assert_eq!(row(&format!("{scheme:?}"))[1], scheme.order().to_string());
    }
}

#[test]
fn names_are_those_of_one_variant() {
    assert!(Advection::ALL.iter().all(|scheme| Advection::from_name(scheme.name()) == Some(*scheme)));
    assert!(TimeScheme::ALL.iter().all(|scheme| TimeScheme::from_name(scheme.name()) == Some(*scheme)));
    assert_eq!(Advection::from_name("upwind"), None);
}
