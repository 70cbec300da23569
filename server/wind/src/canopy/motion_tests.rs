use super::super::super::Boundary;
use super::*;

const MOTION: CanopyMotion = CanopyMotion { frequency_hz: 1.3, damping_ratio: 0.04, mass_kg_per_m2: 0.8 };
/// Ends at two thirds of the fourth layer.
const CANOPY: Canopy = Canopy { height_m: 1.1, drag_per_m: 0.7, motion: Some(MOTION) };
const LAYER_M: f64 = 0.3;
/// Largest error of a balance over its largest terms: a few hundred roundings of f64.
const ROUNDING: f64 = 1e-13;

/// Air over a canopy of which a different fraction stands in each column of cells, some of it none.
struct Meadow {
    grid: Grid<f64>,
    stems: Stems<f64>,
    cover: Vec<f64>,
    velocity: Velocity<f64>,
}

impl Meadow {
    /// Any velocity (m/s) up to `fastest_m_per_s` on every face, ghosts included; it need not be free of divergence.
    fn new(side: Boundary, fastest_m_per_s: f64) -> Self {
        let grid = Grid { cells: [3, 6, 4], spacing_m: [0.5, LAYER_M, 0.4], boundary: [[side; 2], [Boundary::FreeSlip; 2], [side; 2]] };
        let mut velocity = Velocity::zeros(&grid);
        for (axis, field) in velocity.0.iter_mut().enumerate() {
            let wave = |n: usize| (1.7 * n as f64 + axis as f64).sin();
            field.data.iter_mut().enumerate().for_each(|(n, speed)| *speed = fastest_m_per_s * wave(n));
        }
        let mut stems = Stems::new(&grid, Some(&CANOPY)).expect("a canopy that moves");
        for (values, size) in stems.values.iter_mut().zip([0.2, 0.2, 1.0, 1.0]) {
            values.iter_mut().enumerate().for_each(|(n, value)| *value = size * (0.9 * n as f64 + size).cos());
        }
        let cover = (0..12).map(|n| n as f64 / 11.0).collect();
        Self { grid, stems, cover, velocity }
    }

    /// Middle height over that of the canopy of the layers of faces across x and z.
    fn shapes() -> impl Iterator<Item = f64> {
        let height_m = f64::from(CANOPY.height_m);
        (0..4).map(move |j| 0.5 * (j as f64 * LAYER_M + ((j + 1) as f64 * LAYER_M).min(height_m)) / height_m)
    }

    /// Modal mass (kg/m²): `m/h·∫χ² dy`.
    fn modal_mass() -> f64 {
        let height_m = f64::from(CANOPY.height_m);
        let parts_m = (0..4).map(|j| (height_m - j as f64 * LAYER_M).min(LAYER_M));
        f64::from(MOTION.mass_kg_per_m2) / height_m * Self::shapes().zip(parts_m).map(|(shape, part_m)| shape * shape * part_m).sum::<f64>()
    }

    /// Terms of the momentum balance (kg/(m·s)) of every column of faces in a step of `dt_secs` (s): gain of the stems by the change of their velocity, by
    /// friction and by stiffness, then gain of the air in each layer, all weighted by the mode shape. `standing` is their cover.
    fn balances(&mut self, dt_secs: f64) -> Vec<(f64, Vec<f64>)> {
        let (air, stems) = (self.velocity.clone(), self.stems.values.clone());
        let mut rates = Velocity::zeros(&self.grid);
        self.stems.sway(&self.grid, &self.cover, dt_secs, &mut self.velocity, &mut rates);
        let (mass, rad_per_s) = (Self::modal_mass(), std::f64::consts::TAU * f64::from(MOTION.frequency_hz));
        let mut balances = vec![];
        for (sway, axis) in [(0, 0), (1, 2)] {
            let location = Location::Face(axis);
            for [k, i] in self.grid.free(location, 2).flat_map(|k| self.grid.free(location, 0).map(move |i| [k, i])) {
                let column = i + self.stems.row * k;
                let [places_m, speeds] = [sway, 2 + sway].map(|n| [stems[n][column], self.stems.values[n][column]]);
                let [middle_m, mean] = [places_m, speeds].map(|[old, new]| 0.5 * (old + new));
                let standing = standing(&self.grid, &self.cover, i, k);
                let damping = 2.0 * f64::from(MOTION.damping_ratio) * rad_per_s * mean;
                let gains = [speeds[1], -speeds[0], dt_secs * damping, dt_secs * rad_per_s * rad_per_s * middle_m];
                let of_air = |(j, shape): (usize, f64)| {
                    let at = self.grid.at([i, j, k]);
                    [self.velocity.0[axis].data[at], -air.0[axis].data[at]].map(|speed| AIR_KG_PER_M3 * LAYER_M * shape * speed)
                };
                let terms = gains.map(|gain| standing * mass * gain).into_iter().chain(Self::shapes().enumerate().flat_map(of_air));
                balances.push((standing, terms.collect()));
            }
        }
        balances
    }
}

/// The sum of all terms is 0. Drag that gives stems more or less than it takes from the air, layer by layer, leaves a part of it over.
#[test]
fn stems_gain_the_momentum_that_the_air_loses_by_drag() {
    for (side, columns) in [(Boundary::Wrap, [12, 12]), (Boundary::FreeSlip, [8, 9])] {
        for (dt_secs, fastest_m_per_s) in
            [0.001, 0.02, 0.1, 0.7, 5.0].into_iter().flat_map(|dt| [0.01, 1.0, 30.0].map(|fastest| (dt, fastest)))
        {
            let mut meadow = Meadow::new(side, fastest_m_per_s);
            for step in 0..5 {
                let balances = meadow.balances(dt_secs);
                assert_eq!(balances.len(), columns[0] + columns[1]);
                for (n, (standing, terms)) in balances.iter().enumerate() {
                    let (left, largest) = (terms.iter().sum::<f64>(), terms.iter().fold(0.0_f64, |largest, term| largest.max(term.abs())));
                    let context =
                        format!("{side:?}, steps of {dt_secs} s, {fastest_m_per_s} m/s, step {step}, column {n}, {standing} standing");
                    assert!(left.abs() <= ROUNDING * largest, "{context}: {left} of {largest} kg/(m·s) are left over");
                }
            }
        }
    }
}
