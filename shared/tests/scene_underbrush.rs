//! Underbrush in scene files and underbrush files, and their faults.

use prairie_core::scene::{Component, ComponentKind, Growth, Rain, Scene, SceneFault, Underbrush, parse, parse_underbrush, parse_with};
use proptest::prelude::*;

const MAPS: &str = "summary = 's'\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n";

const REED: &str = "[[underbrush]]\nname = 'reed'\ncover = 5\n[[underbrush.components]]\nname = 'stalk'\nkind = 'branch'\nlength_m = 1.5\n\
                    [[underbrush.components]]\nname = 'blade'\nkind = 'leaf'\non = 'stalk'\ncount = 7\nfrom_share = 0.25\n";

fn told(faults: Vec<SceneFault>) -> Vec<String> {
    faults.iter().map(ToString::to_string).collect()
}

fn scene(more: &str) -> Result<Scene, Vec<String>> {
    parse(&format!("{MAPS}{more}")).map_err(told)
}

/// The only fault of a scene.
fn fault(more: &str) -> String {
    let mut faults = scene(more).expect_err(more);
    assert_eq!(faults.len(), 1, "{more}: {faults:?}");
    faults.remove(0)
}

/// A species with these components: each a name, a kind and further text.
fn species(components: &[(&str, &str, &str)]) -> String {
    let component =
        |(name, kind, more): &(&str, &str, &str)| format!("[[underbrush.components]]\nname = '{name}'\nkind = '{kind}'\n{more}\n");
    format!("[[underbrush]]\nname = 'a'\n{}", components.iter().map(component).collect::<String>())
}

fn reed() -> Underbrush {
    let stalk = Component { length_m: 1.5, ..Component::new("stalk", ComponentKind::Branch) };
    let blade = Component::new("blade", ComponentKind::Leaf);
    let blade = Component { on: "stalk".to_owned(), count: 7, from_share: 0.25, ..blade };
    Underbrush { cover: 5, ..Underbrush::new("reed", vec![stalk, blade]) }
}

#[test]
fn nested_sections_are_read_in_order() {
    let scene = scene(&format!("{REED}[rain]\nrate_mm_per_h = 4\n{}[growth]\nshade = 0.25\n", species(&[("leaf", "leaf", "")]))).unwrap();
    assert_eq!(scene.underbrush, [reed(), Underbrush::new("a", vec![Component::new("leaf", ComponentKind::Leaf)])]);
    assert_eq!((scene.growth, scene.rain), (Growth { shade: 0.25, ..Growth::default() }, Rain { rate_mm_per_h: 4.0 }));
    assert_eq!(scene.underbrush[0].parts(), [1, 7]);
    assert_eq!([0, 1].map(|index| scene.underbrush[0].branch_below(index)), [None, Some(0)]);
}

#[test]
fn a_scene_with_underbrush_round_trips() {
    let scene = scene(REED).unwrap();
    assert_eq!(parse(&scene.to_toml()).unwrap(), scene);
}

#[test]
fn a_species_without_components_is_rejected() {
    for more in ["", "components = []\n"] {
        let told = fault(&format!("[[underbrush]]\nname = 'a'\n{more}"));
        let why = if more.is_empty() {
            "is missing and has no default; expected 1 to 16 sections `[[underbrush.components]]`"
        } else {
            "has 0 sections; allowed: 1 to 16"
        };
        assert_eq!(told, format!("`underbrush[0].components` {why}"));
    }
    let names: Vec<_> = (0..17).map(|i| i.to_string()).collect();
    let many: Vec<_> = names.iter().map(|name| (name.as_str(), "leaf", "")).collect();
    assert_eq!(fault(&species(&many)), "`underbrush[0].components` has 17 sections; allowed: 1 to 16");
    assert_eq!(
        fault("[[underbrush.components]]\nname = 'leaf'\nkind = 'leaf'\n"),
        "`underbrush` is a section; expected at most 16 sections `[[underbrush]]`"
    );
}

#[test]
fn a_component_is_on_a_branch_before_it() {
    let (stem, twig) = (("stem", "branch", ""), ("twig", "branch", "on = 'stem'"));
    assert!(scene(&species(&[stem, twig, ("leaf", "leaf", "on = 'twig'")])).is_ok());
    let cases = [
        (
            vec![("leaf", "leaf", "on = 'stem'")],
            0,
            "\"stem\", which is not a component of its plant; allowed: \"\", the ground; no branch comes before it",
        ),
        (
            vec![stem, twig, ("leaf", "leaf", "on = 'twg'")],
            2,
            "\"twg\", which is not a component of its plant; allowed: \"\", the ground, or a branch before it, \"stem\", \"twig\"",
        ),
        (
            vec![("leaf", "leaf", "on = 'stem'"), stem],
            0,
            "\"stem\", which comes later; allowed: \"\", the ground; no branch comes before it",
        ),
        (
            vec![stem, ("twig", "branch", "on = 'twig'")],
            1,
            "\"twig\", which is itself; allowed: \"\", the ground, or a branch before it, \"stem\"",
        ),
        (
            vec![("blade", "leaf", ""), ("leaf", "leaf", "on = 'blade'")],
            1,
            "\"blade\", which is a leaf; allowed: \"\", the ground; no branch comes before it",
        ),
        (
            vec![stem, ("bloom", "flower", ""), ("leaf", "leaf", "on = 'bloom'")],
            2,
            "\"bloom\", which is a flower; allowed: \"\", the ground, or a branch before it, \"stem\"",
        ),
    ];
    for (components, index, why) in cases {
        assert_eq!(fault(&species(&components)), format!("`underbrush[0].components[{index}].on` is {why}"));
    }
    // A branch whose own name or kind is at fault causes no second fault.
    assert_eq!(scene(&species(&[("stem", "brunch", ""), ("leaf", "leaf", "on = 'stem'")])).unwrap_err().len(), 1);
}

#[test]
fn conflicting_values_are_reported() {
    assert_eq!(
        fault(&species(&[("leaf", "leaf", "from_share = 0.8\nto_share = 0.5")])),
        "`underbrush[0].components[0].from_share` is 0.8; allowed: up to its `to_share`, 0.5"
    );
    assert_eq!(
        fault(&species(&[("leaf", "leaf", ""), ("leaf", "flower", "")])),
        "`underbrush[0].components[1].name` is \"leaf\", already used by `underbrush[0].components[0]`; allowed: a unique name within the plant"
    );
    let spread = |more: &str| format!("[[underbrush]]\nname = 'a'\n{more}\n[[underbrush.components]]\nname = 'leaf'\nkind = 'leaf'\n");
    for (more, reach, room) in [("reach_m = 0.3", 0.3, 0.5), ("room_m = 1.5", 1.5, 1.5), ("reach_m = 2\nroom_m = 2.5", 2.0, 2.5)] {
        assert_eq!(
            fault(&spread(more)),
            format!("`underbrush[0].reach_m` is {reach}; allowed: 0 (does not spread) or more than its `room_m`, {room}")
        );
    }
    assert!(scene(&spread("reach_m = 0")).is_ok() && scene(&spread("reach_m = 0.501")).is_ok());
    let other = REED.replace("cover = 5", "cover = 6");
    assert_eq!(
        fault(&format!("{REED}{other}")),
        "`underbrush[1].name` is \"reed\", already used by `underbrush[0]`; allowed: a unique name"
    );
    let other = REED.replace("'reed'", "'cane'");
    assert_eq!(
        fault(&format!("{REED}{other}")),
        "`underbrush[1].cover` is 5, already used by `underbrush[0]`, \"reed\"; allowed: 0, not painted, or a unique ID, 1 to 252"
    );
    assert_eq!(
        fault(&format!("[[species]]\nname = 'bluestem'\ncover = 5\n{REED}")),
        "`underbrush[0].cover` is 5, already used by `species[0]`, \"bluestem\"; allowed: 0, not painted, or a unique ID, 1 to 252"
    );
    // Species that are not painted need no ID.
    assert!(scene(&format!("{}{}", species(&[("leaf", "leaf", "")]), REED.replace("cover = 5", "cover = 0"))).is_ok());
}

#[test]
fn every_species_and_component_needs_a_name() {
    let told = "is \"\"; allowed: a name in quotes, not empty";
    assert_eq!(fault(&species(&[("stem", "branch", ""), ("", "leaf", "")])), format!("`underbrush[0].components[1].name` {told}"));
    assert_eq!(fault(&REED.replace("'reed'", "''")), format!("`underbrush[0].name` {told}"));
    assert_eq!(fault("[[species]]\nname = ''\ncover = 5\n"), format!("`species[0].name` {told}"));
    assert!(fault(&REED.replace("'reed'", "' '")).contains("is \" \"; allowed"));
    // A component on the ground is not on a branch without a name.
    assert_eq!(scene(&species(&[("", "branch", ""), ("leaf", "leaf", "on = ''")])).unwrap_err().len(), 1);
}

#[test]
fn masses_and_sections_must_be_above_zero() {
    let told = |more: &str| fault(&species(&[("leaf", "leaf", more)]));
    for mass in ["0", "0.0", "-0.001", "nan", "-inf", "1e-7"] {
        assert_eq!(told(&format!("mass_kg = {mass}")), format!("`underbrush[0].components[0].mass_kg` is {mass}; allowed: 0.000001 to 10"));
    }
    for sections in ["0", "-1", "17"] {
        assert_eq!(
            told(&format!("sections = {sections}")),
            format!("`underbrush[0].components[0].sections` is {sections}; allowed: 1 to 16")
        );
    }
    assert!(scene(&species(&[("leaf", "leaf", "sections = 16\nmass_kg = 0.000001")])).is_ok());
}

#[test]
fn the_number_of_components_of_a_plant_is_limited() {
    let shrub = |leaves: u32| {
        let (on_stem, on_twig) = ("on = 'stem'\ncount = 5", format!("on = 'twig'\ncount = {leaves}"));
        species(&[("stem", "branch", "count = 3"), ("twig", "branch", on_stem), ("leaf", "leaf", &on_twig)])
    };
    assert_eq!(scene(&shrub(3)).unwrap().underbrush[0].parts(), [3, 15, 45]);
    assert_eq!(
        fault(&shrub(4)),
        "`underbrush[0].components[2].count` is 4 on each of what it stands on, which makes 78 leaves, branches and flowers of a plant with those before \
         it; allowed: 64"
    );
    // Sixteen generations of 32 overflow a counter.
    let names: Vec<_> = (0..16).map(|i| i.to_string()).collect();
    let below: Vec<_> =
        (0..16).map(|i| format!("count = 32\n{}", if i == 0 { String::new() } else { format!("on = '{}'", i - 1) })).collect();
    let tower: Vec<_> = names.iter().zip(&below).map(|(name, on)| (name.as_str(), "branch", on.as_str())).collect();
    assert!(fault(&species(&tower)).starts_with("`underbrush[0].components[1].count` is 32 on each"));
}

#[test]
fn the_number_of_sites_is_limited_where_there_is_underbrush() {
    assert_eq!(
        fault(&format!("{REED}[growth]\nspacing_m = 0.1\n")),
        "`growth.spacing_m` is 0.1, which makes 2560 × 2560 sites, 6553600 in all; allowed: 4194304 in all"
    );
    assert!(scene("[growth]\nspacing_m = 0.1\n").is_ok());
    assert_eq!(scene(&format!("{REED}[growth]\nspacing_m = 0.125\n")).unwrap().growth.sites([256.0; 2]), [2048; 2]);
}

#[test]
fn an_underbrush_file_comes_before_the_scenes_own() {
    let shared = parse_underbrush(REED).unwrap();
    assert_eq!(shared, [reed()]);
    let own = species(&[("leaf", "leaf", "")]);
    let text = format!("underbrush_file = 'species.toml'\n{MAPS}{own}");
    let scene = parse_with(&text, shared.clone()).unwrap();
    assert_eq!(scene.underbrush.iter().map(|species| species.name.as_str()).collect::<Vec<_>>(), ["reed", "a"]);
    assert_eq!(scene.underbrush_file, "species.toml");
    assert_eq!(parse_underbrush("").unwrap(), []);

    let faults = |own: &str| {
        let faults = parse_with(&format!("underbrush_file = 'species.toml'\n{MAPS}{own}"), shared.clone()).unwrap_err();
        faults.iter().map(|fault| format!("{}:{}: {fault}", fault.line, fault.column)).collect::<Vec<_>>()
    };
    assert_eq!(
        faults(&format!("{own}{REED}")),
        [
            "15:8: `underbrush[1].name` is \"reed\", already used by `underbrush[0]` in `underbrush_file`; allowed: a unique name",
            "16:9: `underbrush[1].cover` is 5, already used by `underbrush[0]` in `underbrush_file`, \"reed\"; allowed: 0, not painted, or a unique ID, 1 to 252",
        ]
    );
    assert_eq!(
        faults("[[species]]\nname = 'bluestem'\ncover = 5\n"),
        ["10:9: `species[0].cover` is 5, already used by `underbrush[0]` in `underbrush_file`, \"reed\"; allowed: a unique ID, 1 to 252"]
    );
    assert_eq!(
        faults("[growth]\nspacing_m = 0.05\n"),
        ["9:13: `growth.spacing_m` is 0.05, which makes 5120 × 5120 sites, 26214400 in all; allowed: 4194304 in all"]
    );
    let many: String = (0..16).map(|i| own.replace("'a'", &format!("'{i}'"))).collect();
    assert_eq!(faults(&many), ["8:1: `underbrush` makes 17 species with those of `underbrush_file`; allowed: at most 16"]);
}

#[test]
fn an_underbrush_file_contains_nothing_else() {
    let told = |text: &str| told(parse_underbrush(text).unwrap_err());
    assert_eq!(told("[wind]\nsources = 3\n"), ["`wind` is not a field of an underbrush file; known here: `underbrush`"]);
    assert_eq!(told("underbush = 3\n"), ["`underbush` is not a field of an underbrush file; did you mean `underbrush`?"]);
    assert_eq!(
        told(&format!("{REED}light_need = 0.5\n")),
        ["`underbrush[0].components[1].light_need` is not a field of an underbrush file; did you mean `underbrush.light_need`?"]
    );
    // Fields of a scene are not suggested.
    let elsewhere = told(&format!("{REED}haze_m = 2\n"));
    assert!(elsewhere[0].contains("is not a field of an underbrush file; known here: `angle_rad`, "), "{elsewhere:?}");
    assert!(told("[[underbrush]\n")[0].starts_with("not TOML"));
    assert_eq!(told(&format!("{REED}{REED}")).len(), 2);
}

proptest! {
    /// A fault deep in nested sections is reported by its path and at its line and column, whatever is around it.
    #[test]
    fn a_fault_in_nested_sections_has_its_place(counts in prop::collection::vec(1..6usize, 1..6), pick in any::<prop::sample::Index>(), indent in 0..5usize, blank in 0..3usize) {
        let places: Vec<_> = counts.iter().enumerate().flat_map(|(i, &count)| (0..count).map(move |j| (i, j))).collect();
        let (species, component) = places[pick.index(places.len())];
        let margin = " ".repeat(indent);
        let (mut text, mut place) = (String::new(), 0);
        for (i, &count) in counts.iter().enumerate() {
            text += &format!("[[underbrush]] # é\nname = '{i}'\n");
            for j in 0..count {
                text += &format!("{}{margin}[[underbrush.components]]\nname = '{j}'\nkind = 'leaf'\n", "\n".repeat(blank));
                if (i, j) == (species, component) {
                    place = text.lines().count() + 1;
                    text += &format!("{margin}mass_kg = -0.5\n");
                }
            }
        }
        let faults = parse_underbrush(&text).unwrap_err();
        prop_assert_eq!(faults.len(), 1);
        prop_assert_eq!((faults[0].line, faults[0].column, faults[0].length), (place, indent + 11, 4));
        let told = format!("`underbrush[{species}].components[{component}].mass_kg` is -0.5; allowed: 0.000001 to 10");
        prop_assert_eq!(faults[0].to_string(), told);
        // Conflicts are located by another search through the text.
        let faults = parse_underbrush(&text.replace("mass_kg = -0.5", "on = 'none'")).unwrap_err();
        prop_assert_eq!((faults[0].line, faults[0].column, faults[0].length), (place, indent + 6, 6));
    }

    #[test]
    fn no_text_panics(text in "(\\[\\[underbrush(\\.components)?\\]\\]\n|[a-z]{1,5} = ('[a-z]'|-?[0-9]{1,3}|\\[\\])\n|(count|on|kind|cover|name) = ('leaf'|'branch'|'a'|[0-9]{1,4})\n){0,12}") {
        let scene = format!("{MAPS}{text}");
        for faults in [parse(&scene).err(), parse_underbrush(&text).err()].into_iter().flatten() {
            prop_assert!(faults.iter().all(|fault| fault.line > 0 && fault.column > 0 && fault.length > 0));
        }
    }
}
