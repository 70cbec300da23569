//! Natural wind as noise (Chen & Johan, §5.3): direction, travel, size, strength and reach of its gusts.

use prairie_core::bend::{Bend, Edges, HALO, Patch, Serial, WaveParams};
use prairie_core::grass::BendSimulation;
use prairie_core::grass::Camera;
use prairie_core::grass::wind_drawing::WindDrawings;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{NaturalWind, Patches, Scene, TerrainMaps};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap, grey_png};
use prairie_core::wind::WindField;
use std::sync::Arc;

const DT_SECS: f32 = 1.0 / 30.0;
/// Time (s) after which the grass has forgotten that it was at rest: four times its slow time constant k/κ.
const SETTLED_SECS: f32 = 20.0;
/// Camera in the middle of 64 m of land.
const MIDDLE: [f32; 2] = [32.0, 32.0];
const WIND: NaturalWind = NaturalWind { strength_rad_per_s2: 1.0, scale_m: 10.0, drift_m_per_s: [4.0, 3.0], reach_m: 100.0 };

/// 4 × 4 patches of 16 m of flat grassland, 64 m a side, in still air but for the natural wind. Its waves have a constant speed, so that leans are
/// proportional to pushes.
struct Land {
    grass: BendSimulation,
    still: WindField,
    cameras: Vec<Camera>,
}

impl Land {
    fn new(natural_wind: NaturalWind, seed: u64) -> Self {
        Self::with(32, WaveParams::default(), natural_wind, seed)
    }

    /// Patches of `cells × cells` cells, whose tiles of 8 × 8 get one push at each corner.
    fn with(cells: u32, waves: WaveParams, natural_wind: NaturalWind, seed: u64) -> Self {
        let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [64.0; 2], level_m: 0.1, base_m: 0.0 };
        let mut scene = Scene { natural_wind, seed, ..Scene::new(terrain) };
        scene.patches = Patches { count: [4; 2], cells, cell_m: 16.0 / cells as f32, ..Patches::default() };
        scene.bend.edges = Edges::Wrapped;
        scene.grass.waves = WaveParams { mu_m_per_rad: 0.0, ..waves };
        let height = Arc::new(HeightMap::from_heights(2, 2, [64.0; 2], vec![0.0; 4]));
        let cover = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
        let grass = BendSimulation::new(&scene, height, &cover, &[], &WindDrawings::new());
        Self { grass, still: WindField::still(&scene, Arc::new(KindMap::uniform())), cameras: vec![camera(0, MIDDLE)] }
    }

    fn step(&mut self) {
        self.grass.step(DT_SECS, &[], &self.cameras, &self.still, &Serial);
    }

    fn run(mut self, secs: f32) -> Self {
        (0..(secs / DT_SECS) as usize).for_each(|_| self.step());
        self
    }

    fn layout(&self) -> PatchLayout {
        *self.grass.field().layout()
    }

    fn bend(&self, [x, z]: [f32; 2]) -> Bend {
        self.grass.field().bend_at(x, z)
    }

    /// Bits of θ of all awake grass.
    fn bits(&self) -> Vec<u32> {
        self.grass.field().awake().flat_map(Patch::rows).flat_map(|[theta, _, _]| theta).map(|theta| theta.to_bits()).collect()
    }
}

fn camera(client: u32, [x, z]: [f32; 2]) -> Camera {
    Camera { client, eye_m: [x, 2.0, z] }
}

fn correlation(a: &[f32], b: &[f32]) -> f32 {
    let n = a.len().min(b.len());
    let (a, b) = (&a[..n], &b[..n]);
    let mean = |values: &[f32]| values.iter().sum::<f32>() / n as f32;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let product = |x: &[f32], mean_x: f32, y: &[f32], mean_y: f32| x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum::<f32>();
    product(a, mean_a, b, mean_b) / (product(a, mean_a, a, mean_a) * product(b, mean_b, b, mean_b)).sqrt()
}

#[test]
fn grass_bends_in_the_direction_of_the_drift() {
    for drift_m_per_s in [[4.0, 3.0], [-5.0, 0.0], [1.0, -6.0]] {
        let land = Land::new(NaturalWind { drift_m_per_s, ..WIND }, 1).run(SETTLED_SECS);
        let speed = drift_m_per_s[0].hypot(drift_m_per_s[1]);
        let mut bent = 0;
        for at_m in (0..28).flat_map(|i| (0..28).map(move |j| [4.0 + 2.0 * i as f32, 4.0 + 2.0 * j as f32])) {
            let [x, z] = land.bend(at_m).lean_rad();
            let lean = x.hypot(z);
            if lean > 0.02 {
                bent += 1;
                let along = (x * drift_m_per_s[0] + z * drift_m_per_s[1]) / (lean * speed);
                assert!(along > 0.99, "{drift_m_per_s:?}: grass at {at_m:?} leans by {x}, {z} rad");
            }
        }
        assert!(bent > 28 * 28 / 2, "only {bent} of 784 places are bent");
    }
}

/// Lag (s) at which the motion at later places is most similar to that at the first ones, and the correlation there: the means over the pairs of series.
fn best_lag_secs(first: &[Vec<f32>], later: &[Vec<f32>]) -> (f32, f32) {
    let mean = |lag: usize| first.iter().zip(later).map(|(a, b)| correlation(a, &b[lag..])).sum::<f32>() / first.len() as f32;
    let lags = (0..(6.0 / DT_SECS) as usize).map(|lag| (lag as f32 * DT_SECS, mean(lag)));
    lags.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
}

#[test]
fn gusts_travel_with_the_drift() {
    // Places 7.5 m apart, along the drift and across it. Gusts pass in a small part of the time in which they change, so that the change doesn't shift the
    // lag; and grass moves as it is pushed, while its lean remembers older gusts.
    let moved = |series: &[f32]| series.windows(16).map(|thetas| thetas[15] - thetas[0]).collect::<Vec<f32>>();
    let starts: Vec<_> = (0..4).flat_map(|i| (0..4).map(move |j| [12.0 + 12.0 * i as f32, 12.0 + 12.0 * j as f32])).collect();
    for speed in [6.0, 12.0] {
        let mut land = Land::new(NaturalWind { scale_m: 8.0, drift_m_per_s: [0.8 * speed, 0.6 * speed], ..WIND }, 3).run(SETTLED_SECS);
        let mut series = [[0.0, 0.0], [6.0, 4.5], [-4.5, 6.0]].map(|offset_m| (offset_m, vec![vec![]; starts.len()]));
        for _ in 0..(120.0 / DT_SECS) as usize {
            land.step();
            for (offset_m, series) in &mut series {
                let at_m = |start: &[f32; 2]| [start[0] + offset_m[0], start[1] + offset_m[1]];
                series.iter_mut().zip(&starts).for_each(|(series, start)| series.push(land.bend(at_m(start)).theta));
            }
        }
        let [first, along, across] = series.map(|(_, series)| series.iter().map(|series| moved(series)).collect::<Vec<_>>());
        let ((lag_secs, height), (_, height_across)) = (best_lag_secs(&first, &along), best_lag_secs(&first, &across));
        let expected_secs = 7.5 / speed;
        println!("at {speed} m/s: {lag_secs:.2} s instead of {expected_secs:.2} s, correlation {height:.2}; across {height_across:.2}");
        assert!((lag_secs / expected_secs - 1.0).abs() < 0.1, "at {speed} m/s: {lag_secs} s instead of {expected_secs}");
        assert!(height > 0.6 && height_across < height - 0.3, "correlations of {height} along and {height_across} across the drift");
    }
}

/// Distance (m) across the drift at which the correlation of θ falls to a half.
fn half_width_m(scale_m: f32) -> f32 {
    let places = |n: usize| (0..n).map(|n| 8.0 + 2.0 * n as f32);
    let distances_m: Vec<f32> = (1..=24).map(|n| 0.5 * n as f32).collect();
    let (mut near, mut far) = (vec![], vec![vec![]; distances_m.len()]);
    for seed in 1..=4 {
        let cells = if scale_m < 16.0 { 64 } else { 32 };
        let mut land = Land::with(cells, WaveParams::default(), NaturalWind { scale_m, drift_m_per_s: [5.0, 0.0], ..WIND }, seed).run(5.0);
        for _ in 0..8 {
            land = land.run(5.0);
            for [x, z] in places(24).flat_map(|x| places(18).map(move |z| [x, z])) {
                near.push(land.bend([x, z]).theta);
                far.iter_mut().zip(&distances_m).for_each(|(far, distance_m)| far.push(land.bend([x, z + distance_m]).theta));
            }
        }
    }
    let below = far.iter().position(|far| correlation(&near, far) < 0.5);
    below.map_or(f32::INFINITY, |n| distances_m[n])
}

#[test]
fn gusts_are_as_large_as_their_scale() {
    let widths_m = [8.0, 16.0, 24.0].map(half_width_m);
    println!("half widths of {widths_m:?} m");
    let growth = widths_m.map(|width_m| width_m / widths_m[0]);
    assert!((growth[1] / 2.0 - 1.0).abs() < 0.2 && (growth[2] / 3.0 - 1.0).abs() < 0.2, "half widths of {widths_m:?} m");
}

#[test]
fn the_bend_is_proportional_to_the_strength_and_below_that_of_a_steady_push() {
    let strongest = |strength_rad_per_s2: f32| {
        let land = Land::new(NaturalWind { strength_rad_per_s2, ..WIND }, 1).run(SETTLED_SECS);
        land.grass.field().awake().map(Patch::theta_max_rad).fold(0.0, f32::max)
    };
    let kappa_per_s2 = WaveParams::default().stiffness_per_s2;
    let [weak, strong] = [0.5, 1.0].map(strongest);
    println!("{weak} and {strong} rad");
    assert!((strong / weak - 2.0).abs() < 2e-3, "{weak} and {strong} rad");
    assert!(strong > 0.1 / kappa_per_s2 && strong < 1.0 / kappa_per_s2, "{strong} rad");
    assert_eq!(strongest(0.0), 0.0);
}

/// Waves of 50 m/s need more sub-steps than a patch takes between two exchanges with its neighbours. They spread a gust, but don't change the mean bend.
#[test]
fn gusts_move_grass_whatever_the_number_of_sub_steps() {
    let mean_theta_rad = |c0_m_per_s: f32| {
        let waves = WaveParams { c0_m_per_s, ..WaveParams::default() };
        let land = Land::with(32, waves, WIND, 1).run(SETTLED_SECS);
        let thetas = land.grass.field().awake().flat_map(Patch::rows).flat_map(|[theta, _, _]| theta);
        let (sum, count) = thetas.fold((0.0, 0.0), |(sum, count), theta| (sum + theta, count + 1.0));
        (land.grass.report().substeps as usize, sum / count)
    };
    let [(few, slow_rad), (many, fast_rad)] = [1.0, 50.0].map(mean_theta_rad);
    println!("{few} and {many} sub-steps, {slow_rad} and {fast_rad} rad");
    assert!(few == 1 && many > HALO, "{few} and {many} sub-steps");
    assert!((fast_rad / slow_rad - 1.0_f32).abs() < 0.1, "{slow_rad} and {fast_rad} rad");
}

#[test]
fn only_grass_within_reach_of_a_camera_is_pushed() {
    let mut land = Land::new(NaturalWind { reach_m: 12.0, ..WIND }, 1);
    land.cameras = vec![camera(0, [8.0, 8.0])];
    let pushed = |land: &Land| land.grass.causes().gusty.clone();
    let corner_only = land.layout().index(0, 0).into_iter().collect::<Vec<_>>();
    land = land.run(SETTLED_SECS);
    assert_eq!(pushed(&land), corner_only);
    assert!(land.bend([8.0, 8.0]).theta > 0.01);
    assert_eq!(land.bend([40.0, 40.0]), Bend::default());
    let beyond = land.bend([17.0, 8.0]).theta;
    assert!(beyond > 0.0 && beyond < land.bend([15.0, 8.0]).theta, "waves carry the bend into the next patch: {beyond} rad");

    land.cameras.clear();
    land = land.run(3.0 * SETTLED_SECS);
    assert_eq!((pushed(&land), land.grass.field().awake_count()), (vec![], 0), "the grass comes to rest when nobody looks");
}

#[test]
fn bits_depend_on_the_seed_and_not_on_the_number_of_cameras() {
    let bits = |seed: u64, cameras: u32| {
        let mut land = Land::new(WIND, seed);
        land.cameras = (0..cameras).map(|client| camera(client, MIDDLE)).collect();
        land.run(3.0).bits()
    };
    let one = bits(1, 1);
    assert_eq!(one, bits(1, 1));
    assert_eq!(one, bits(1, 3));
    assert_ne!(one, bits(2, 1));
}
