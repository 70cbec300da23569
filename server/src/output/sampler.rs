//! Values of the variables in the present state of a world.

use super::error::OutputError;
use super::grids::Grid;
use super::variables::{Field, Variable};
use crate::scenes::LoadedScene;
use crate::world::World;
use prairie_core::bend::{Bend, CHANNELS};
use prairie_core::grass::BendSimulation;
use prairie_core::grass::grass_properties::GrassProperties;
use prairie_core::grass::grass_state::published;
use prairie_core::wind::WindField;
use rayon::prelude::*;

/// Largest number of values of a variable at one time: 256 MiB.
pub const VALUES_LIMIT: usize = 1 << 26;

/// Values of all variables at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Number of steps so far.
    pub tick: u64,
    /// Simulated time (s).
    pub time_secs: f64,
    /// Values of each variable of the sampler in the order of its grid's axes, the last one fastest.
    pub values: Vec<Vec<f32>>,
}

/// Takes the values of chosen fields out of worlds of one scene.
pub struct Sampler {
    fields: Vec<Field>,
    dt_secs: f64,
    air_cells: [usize; 3],
    /// Columns and rows of the cells of grass.
    cells: [usize; 2],
    cell_m: f32,
    /// Centres of the tiles (m: X, height of the grass, Z).
    tiles_m: Vec<[f32; 3]>,
}

impl Sampler {
    /// A sampler of `fields`, in the order of [`Field::ALL`] and each once.
    ///
    /// # Errors
    /// When the scene has no dust that is asked for, or a variable has more than [`VALUES_LIMIT`] values.
    pub fn new(loaded: &LoadedScene, fields: &[Field]) -> Result<Self, OutputError> {
        let scene = &loaded.scene;
        let fields: Vec<_> = Field::ALL.into_iter().filter(|field| fields.contains(field)).collect();
        if fields.contains(&Field::Dust) && !scene.wind.has_dust() {
            return Err(OutputError::NoDust);
        }
        let too_large = fields.iter().map(|field| (field, field.grid().len(scene))).find(|(_, values)| *values > VALUES_LIMIT);
        if let Some((field, values)) = too_large {
            return Err(OutputError::TooLarge { field: field.name(), values, most: VALUES_LIMIT });
        }
        let axes = Grid::Grass.axes(scene);
        Ok(Self {
            tiles_m: if fields.contains(&Field::GroundWind) { tiles_m(loaded) } else { Vec::new() },
            fields,
            dt_secs: f64::from(scene.dt_secs()),
            air_cells: scene.wind.cells.map(|count| count as usize),
            cells: [axes[1].count, axes[0].count],
            cell_m: axes[0].spacing_m,
        })
    }

    /// The variables, in the order of the values of a frame.
    pub fn variables(&self) -> impl Iterator<Item = &'static Variable> + '_ {
        self.fields.iter().flat_map(|field| field.variables())
    }

    /// The present values.
    pub fn sample(&self, world: &World) -> Frame {
        let has_bend = self.fields.iter().any(|field| matches!(field, Field::Bend | Field::BendVelocity));
        let [theta, omega_x, omega_z] = if has_bend { self.bend(world.bend()) } else { Default::default() };
        let (mut theta, mut omega) = (Some(theta), Some([omega_x, omega_z]));
        let mut values = Vec::new();
        for field in &self.fields {
            match field {
                Field::Wind => values.extend(self.wind(world)),
                Field::Dust => values.extend(world.weather().dust().map(|dust| self.by_layers(&dust, |density| *density))),
                Field::GroundWind => values.extend(self.ground_wind(world.weather().field())),
                Field::Bend => values.extend(theta.take()),
                Field::BendVelocity => values.extend(omega.take().into_iter().flatten()),
                Field::Lean => values.extend(self.lean(world)),
            }
        }
        Frame { tick: world.tick(), time_secs: world.tick() as f64 * self.dt_secs, values }
    }

    /// Values of cells with X fastest, then Y, then Z, with Z before Y.
    fn by_layers<T>(&self, cells: &[T], value: impl Fn(&T) -> f32) -> Vec<f32> {
        let [nx, ny, nz] = self.air_cells;
        let rows = (0..ny).flat_map(|j| (0..nz).map(move |k| nx * (j + ny * k)));
        rows.flat_map(|row| cells[row..row + nx].iter().map(&value)).collect()
    }

    fn wind(&self, world: &World) -> [Vec<f32>; 3] {
        let velocities = world.weather().velocities();
        [0, 1, 2].map(|axis| self.by_layers(&velocities, |velocity| velocity[axis]))
    }

    fn ground_wind(&self, wind: &WindField) -> [Vec<f32>; 2] {
        self.tiles_m.par_iter().map(|at_m| wind.wind_at(*at_m)).map(|[u, _, w]| (u, w)).unzip::<_, _, Vec<_>, Vec<_>>().into()
    }

    /// Bend field and flattened grass, as [`published`] to clients, before codes are made of them.
    fn bend(&self, bend: &BendSimulation) -> [Vec<f32>; CHANNELS] {
        let layout = bend.field().layout();
        let ([width, depth], side) = (self.cells, layout.cells as usize);
        let mut planes: [Vec<f32>; CHANNELS] = std::array::from_fn(|_| vec![0.0; width * depth]);
        let corner = |patch| layout.place(patch).map(|place| place as usize * side);
        for patch in bend.field().awake() {
            let [east, south] = corner(patch.index());
            for (j, row) in patch.rows().enumerate() {
                let at = (south + j) * width + east;
                planes.iter_mut().zip(row).for_each(|(plane, values)| plane[at..at + side].copy_from_slice(values));
            }
        }
        for patch in bend.flattened().patches() {
            let [east, south] = corner(patch);
            for ([i, j], lean_rad) in bend.flattened().cells(patch) {
                let at = (south + j) * width + east + i;
                let [theta, x, z] = planes.each_ref().map(|plane| plane[at]);
                let sum = published(Bend { theta, omega: [x, z] }, lean_rad);
                (planes[0][at], planes[1][at], planes[2][at]) = (sum.theta, sum.omega[0], sum.omega[1]);
            }
        }
        planes
    }

    fn lean(&self, world: &World) -> [Vec<f32>; 2] {
        let ([width, depth], cell_m, bend, wind) = (self.cells, self.cell_m, world.bend(), world.weather().field());
        let at_m = |cell: usize| [cell % width, cell / width].map(|n| (n as f32 + 0.5) * cell_m);
        let leans = (0..width * depth).into_par_iter().map(|cell| bend.lean_rad(at_m(cell), wind));
        leans.map(|[x, z]| (x, z)).unzip::<_, _, Vec<_>, Vec<_>>().into()
    }
}

fn tiles_m(loaded: &LoadedScene) -> Vec<[f32; 3]> {
    let [south, east] = Grid::Tiles.axes(&loaded.scene)[..] else { return Vec::new() };
    let properties = GrassProperties::new(&loaded.scene, &loaded.cover);
    let center_m = |cell: usize, spacing_m: f32| (cell as f32 + 0.5) * spacing_m;
    let places = (0..south.count).flat_map(|j| (0..east.count).map(move |i| [center_m(i, east.spacing_m), center_m(j, south.spacing_m)]));
    places.map(|[x, z]| [x, properties.blade_height_m([x, z]), z]).collect()
}
