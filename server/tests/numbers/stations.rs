//! The file of the stations.

use crate::{DRIVE, drivers, ran, scene, world};
use prairie::output::{HEADER, OutputError, Outputs, Station, StationFile};

fn stations(list: &[&str]) -> Vec<Station> {
    list.iter().map(|text| text.parse().unwrap()).collect()
}

#[test]
fn rows_have_the_values_of_each_step() {
    let folder = tempfile::tempdir().unwrap();
    let (path, loaded) = (folder.path().join("masts.csv"), scene());
    let watched = stations(&["near=24,32", "far=5.3,60.1"]);
    let file = StationFile::create(&path, &loaded, &watched, false).unwrap();
    ran(DRIVE, 60, 60, Outputs::default().with_stations(file));
    let written = std::fs::read_to_string(&path).unwrap();
    let mut lines = written.lines();
    assert_eq!(lines.next(), Some(HEADER));

    let (mut world, mut drivers) = (world(), drivers(DRIVE));
    let mut pressed = 0;
    for tick in 0..=60 {
        if tick > 0 {
            let commands = drivers.commands(&world);
            world.step(&commands);
        }
        for Station { name, at_m: [x, z] } in &watched {
            let row: Vec<_> = lines.next().unwrap().split(',').collect();
            assert_eq!((row.len(), row[1]), (HEADER.split(',').count(), name.as_str()));
            let number = |column: usize| row[column].parse::<f32>().unwrap();
            assert_eq!(row[0].parse::<f64>().unwrap().to_bits(), (tick as f64 * f64::from(loaded.scene.dt_secs())).to_bits());
            let height_m = loaded.scene.plants.height_m;
            let place = [*x, *z, loaded.height.height_m(*x, *z), height_m];
            assert_eq!([number(2), number(3), number(4), number(5)], place);
            let wind = world.weather().field();
            assert_eq!([number(6), number(7), number(8)].map(f32::to_bits), wind.wind_at([*x, height_m, *z]).map(f32::to_bits));
            let [east, south] = world.bend().lean_rad([*x, *z], wind);
            assert_eq!(number(9).to_bits(), east.hypot(south).to_bits());
            let heading_rad = f64::from(number(10)).to_radians();
            let along = [heading_rad.sin(), -heading_rad.cos()].map(|part| part * f64::from(number(9)));
            assert!((along[0] - f64::from(east)).abs() < 1e-6 && (along[1] - f64::from(south)).abs() < 1e-6, "{row:?}");
            let bend = crate::bend(&world, [*x, *z].map(|m| (m / loaded.scene.patches.cell_m) as usize));
            assert_eq!(
                [number(11), number(12), number(13)].map(f32::to_bits),
                [bend.theta, bend.omega[0], bend.omega[1]].map(f32::to_bits)
            );
            pressed += u32::from(name == "near" && bend.theta > 0.3);
        }
    }
    assert!(lines.next().is_none() && pressed > 0, "the car passes the first station: {pressed}");
}

#[test]
fn stations_off_the_land_and_with_the_same_name_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let create = |list: &[&str]| StationFile::create(&folder.path().join("a.csv"), &scene(), &stations(list), false).err().unwrap();
    assert_eq!(create(&["a=-1,2"]).to_string(), "station `a` is at [-1.0, 2.0]; allowed: 0 to 64 m along X and 0 to 64 m along Z");
    assert_eq!(create(&["a=1,64.5"]).to_string(), "station `a` is at [1.0, 64.5]; allowed: 0 to 64 m along X and 0 to 64 m along Z");
    assert_eq!(create(&["a=1,2", "a=2,3"]).to_string(), "two stations are called `a`; each needs a name of its own");
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none(), "nothing is written");
    std::fs::write(folder.path().join("a.csv"), "mine").unwrap();
    assert!(matches!(create(&["a=1,2"]), OutputError::NotOurs { .. }));
}
