//! Species of grass in scene files.

use prairie_core::bend::WaveParams;
use prairie_core::scene::{Grass, Plants, Scene, Species, parse};
use prairie_core::terrain::Cover;

fn scene(more: &str) -> Result<Scene, Vec<String>> {
    let maps = "summary = 's'\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n";
    parse(&format!("{maps}{more}")).map_err(|faults| faults.iter().map(ToString::to_string).collect())
}

const TWO: &str = "[[species]]\nname = 'buffalo grass'\ncover = 7\nstiffness_per_s2 = 9\nsegments = 1\n\
                   [[species]]\nname = 'bluestem'\ncover = 3\nheight_m = 1.6\nswing_hz = 0.7\nlag_secs = 0.3\n";

#[test]
fn omitted_fields_of_a_species_are_as_in_grass_and_plants() {
    // Wherever in the file those sections are.
    for more in [
        format!("{TWO}[grass]\nc0_m_per_s = 4\n[plants]\ntip_rgb = [1, 1, 0]\nswing_hz = 2\n"),
        format!("[plants]\ntip_rgb = [1, 1, 0]\nswing_hz = 2\n[grass]\nc0_m_per_s = 4\n{TWO}"),
    ] {
        let scene = scene(&more).unwrap();
        let (grass, plants) = (
            Grass { waves: WaveParams { c0_m_per_s: 4.0, ..WaveParams::default() }, ..Grass::default() },
            Plants { tip_rgb: [1.0, 1.0, 0.0], swing_hz: 2.0, ..Plants::default() },
        );
        assert_eq!((scene.grass, scene.plants), (grass, plants));
        let mut buffalo = Species::new("buffalo grass", 7, &grass, &plants);
        (buffalo.grass.waves.stiffness_per_s2, buffalo.grass.segments) = (9.0, 1);
        assert_eq!(scene.species[0], buffalo);
        let kinds = [grass, buffalo.grass, Grass { lag_secs: 0.3, ..grass }];
        assert_eq!(scene.kinds(), kinds);
        assert_eq!(scene.kinds_of_plants(), [plants, plants, Plants { height_m: 1.6, swing_hz: 0.7, ..plants }]);
    }
}

#[test]
fn an_id_has_the_kind_of_the_species_that_claims_it() {
    let with = scene(TWO).unwrap();
    assert_eq!([7, 3, 0, 253, 254, 255, 8].map(|id| with.kind_of_cover(id)), [1, 2, 0, 0, 0, 0, 0]);
    assert_eq!([7, 3, 0, 253, 254, 255, 8].map(|id| with.is_grass(Cover::from(id))), [true, true, false, false, false, true, false]);
    let painted = "[[underbrush]]\nname = 'reed'\ncover = 8\n[[underbrush.components]]\nname = 'stalk'\nkind = 'branch'\n";
    let grown = scene(&format!("{TWO}{painted}")).unwrap();
    assert_eq!([7, 8, 9].map(|id| grown.kind_of_cover(id)), [1, 0, 0]);
    assert_eq!([0, 7, 8, 9].map(|id| grown.is_grass(Cover::from(id))), [false, true, true, false]);
    let without = scene("").unwrap();
    assert_eq!(without.kinds(), [Grass::default()]);
    assert!(!without.is_grass(Cover::from(7)));
}

#[test]
fn species_with_the_same_name_or_id_are_rejected() {
    let same = "[[species]]\nname = 'a'\ncover = 7\n[[species]]\nname = 'b'\ncover = 7\n[[species]]\nname = 'a'\ncover = 8\n";
    let told = [
        "`species[1].cover` is 7, already used by `species[0]`, \"a\"; allowed: a unique ID, 1 to 252",
        "`species[2].name` is \"a\", already used by `species[0]`; allowed: a unique name",
    ];
    assert_eq!(scene(same).unwrap_err(), told);
    let many: String = (1..=17).map(|id| format!("[[species]]\nname = '{id}'\ncover = {id}\n")).collect();
    assert_eq!(scene(&many).unwrap_err(), ["`species` has 17 sections; allowed: at most 16"]);
}
