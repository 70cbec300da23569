//! The world: one fixed step after the other. No clock, no input or output; the same commands give the same bits.

use crate::bend::Meadow;
pub use crate::bend::View;
use crate::bend::drawing::Drawings;
use crate::objects::{Objects, Place, SPEED_LIMIT_M_PER_S};
use crate::plants::Plants;
use crate::shown::Shown;
use crate::snapshot::{Health, Snapshot};
use crate::weather::{self, Weather, WeatherError};
use crate::wind::StepError;
use crate::wind::state::MAX_SUBSTEPS;
use shared::bend::{Damping, Scheme, WaveParams, limits};
use shared::grid::{PatchIndex, PatchLayout};
use shared::plant::flora::Flora;
use shared::plant::growth::NutrientMap;
use shared::scene::{
    BallTread, CarTread, DrawnWind, Grass, HelicopterTread, MonsterTread, Patches, Scene, SledTread, VehicleKind, WindShape,
};
use shared::terrain::{CoverMap, HeightMap};
use shared::wire::{Drive, ObjectId, VIEW_RADIUS_LIMIT_M};
use std::sync::Arc;
use thiserror::Error;

/// Most sub-steps that the grass of a scene may need when an object strikes it at its fastest.
const SUBSTEP_LIMIT: u32 = 64;

/// What the world is told between two steps.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Give a client a vehicle; the one held before is given up.
    Spawn {
        /// Whose.
        client: u32,
        /// Which kind.
        kind: VehicleKind,
    },
    /// Take a client's vehicle away.
    Remove {
        /// Whose.
        client: u32,
    },
    /// Hands on the controls; held until the next.
    Drive {
        /// Whose.
        client: u32,
        /// What they do.
        drive: Drive,
    },
    /// All cameras there are.
    Views(Vec<View>),
    /// One client's camera, ahead of the next [`Views`](Self::Views).
    View(View),
}

/// The maps of a scene.
#[derive(Clone, Debug)]
pub struct Maps {
    /// Heights of the land.
    pub height: HeightMap,
    /// What covers it.
    pub cover: CoverMap,
    /// The drawings that the scene's winds name.
    pub drawings: Drawings,
    /// Nutrients of the soil; none where they are generated.
    pub nutrients: Option<Arc<NutrientMap>>,
}

/// Constants of a scene that are each in range and make no world together.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{field}` {message}")]
pub struct WorldError {
    /// Path of the scene's field that is to be mended first, such as `grass.mu_m_per_rad`.
    pub field: &'static str,
    /// What is wrong, with the values and what is allowed; reads on after the path.
    pub message: String,
}

/// What keeps `scene` from being a world, without making one.
pub fn misfits(scene: &Scene) -> Vec<WorldError> {
    let calm = weather::check(scene).map_err(|error| no_wind(scene, error));
    check_stiffness(scene).err().into_iter().chain(calm.err()).collect()
}

/// Objects, wind, grass and underbrush.
pub struct World {
    dt_secs: f32,
    tick: u64,
    height: Arc<HeightMap>,
    extent_m: [f32; 2],
    objects: Objects,
    weather: Weather,
    meadow: Meadow,
    plants: Plants,
    views: Vec<View>,
    shown: Shown,
}

impl World {
    /// The world of a checked scene, at rest but for the wind.
    ///
    /// # Errors
    /// [`WorldError`] when constants that are each in range make no world together.
    pub fn new(scene: &Scene, maps: Maps) -> Result<Self, WorldError> {
        check_stiffness(scene)?;
        check_drawings(scene, &maps.drawings)?;
        let weather = Weather::new(scene, &maps).map_err(|error| no_wind(scene, error))?;
        let height = Arc::new(maps.height);
        let place = Place { height: Arc::clone(&height), cover: Arc::new(maps.cover), extent_m: scene.extent_m() };
        let plants = Plants::new(Flora::new(scene, &place.cover, maps.nutrients.as_deref()), scene.dt_secs());
        let meadow = Meadow::with_drawings(scene, Arc::clone(&height), &place.cover, &maps.drawings);
        Ok(Self {
            dt_secs: scene.dt_secs(),
            tick: 0,
            height,
            extent_m: scene.extent_m(),
            objects: Objects::new(scene, place),
            weather,
            shown: Shown::default(),
            meadow,
            plants,
            views: vec![],
        })
    }

    /// One fixed step: commands, objects, wind, bend field, underbrush.
    pub fn step(&mut self, commands: &[Command]) {
        for command in commands {
            self.obey(command);
        }
        self.tick += 1;
        let (weather, height) = (&self.weather, &self.height);
        self.objects.step(self.dt_secs, |[x, y, z]| weather.wind_m_per_s([x, y - height.height_m(x, z), z]));
        let motions = self.objects.motions();
        self.weather.step(self.tick, &motions, &self.height, self.meadow.field());
        self.meadow.step(self.dt_secs, &motions, &self.views, self.weather.ground());
        self.plants.step(self.tick, self.dt_secs, &self.meadow, &self.weather);
    }

    /// Gets one of so many `parts` of the patches ready for the next [`snapshot`](Self::snapshot), which then shows them as they are now.
    pub fn prepare(&mut self, part: [u64; 2]) {
        self.shown.renew_part(self.tick, &mut self.meadow, part);
    }

    /// What the world shows of itself.
    pub fn snapshot(&mut self) -> Snapshot {
        self.show_patches();
        let (wind, bend) = (self.weather.report(), self.meadow.report());
        Snapshot {
            tick: self.tick,
            time_secs: self.tick as f64 * f64::from(self.dt_secs),
            objects: self.objects.poses(),
            object_limit: self.objects.limit(),
            wind: Arc::clone(self.weather.frame()),
            patches: Arc::clone(self.shown.patches()),
            broken: self.plants.broken().clone(),
            health: Health {
                divergence_rms: wind.divergence_rms_rel as f32,
                wind_energy: wind.kinetic_energy_m2_per_s2,
                bend_energy: self.meadow.activity(),
                awake_patches: self.meadow.field().awake_count() as u32,
                evicted_patches: self.meadow.evicted(),
                broken_patches: self.meadow.broken(),
                laid_tiles: self.meadow.laid().tiles() as u32,
                dropped_tracks: self.meadow.laid().dropped(),
                refused_motions: self.meadow.refused_count(),
                wind_resets: self.weather.resets(),
                substeps: bend.substeps,
                courant: bend.courant_share,
                ..Health::default()
            },
        }
    }

    /// Whether nothing but the wind moves: no object is there, and all grass sleeps.
    pub fn is_idle(&self) -> bool {
        self.objects.is_empty() && self.meadow.field().awake_count() == 0
    }

    /// The vehicle of a client.
    pub fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.objects.object_of(client)
    }

    /// The bend field and what drives it.
    pub fn meadow(&self) -> &Meadow {
        &self.meadow
    }

    /// The underbrush, as it grew; none where nothing does.
    pub fn flora(&self) -> Option<&Flora> {
        self.plants.flora()
    }

    /// A number that differs when any bit of the objects', the wind's, the bend field's or the underbrush's state does (FNV-1a).
    pub fn checksum(&self) -> u64 {
        let mut sum = Checksum::default();
        for pose in self.objects.poses() {
            sum.add([pose.id]);
            sum.add(pose.position_m.iter().chain(&pose.rotation).chain(&pose.velocity_m_per_s).map(|v| v.to_bits()));
        }
        sum.add(self.weather.velocities().iter().flat_map(|velocity| velocity.to_array().map(f32::to_bits)));
        for patch in self.meadow.field().awake() {
            sum.add([patch.index()]);
            for row in patch.rows().chain(patch.rows_before()) {
                sum.add(row.into_iter().flatten().map(|v| v.to_bits()));
            }
        }
        sum.add(self.meadow.laid().words());
        sum.add(self.plants.broken().iter().flat_map(|plant| [plant.site, plant.fall.get().into()]));
        sum.0
    }

    fn obey(&mut self, command: &Command) {
        match command {
            Command::Spawn { client, kind } => {
                // A refusal shows in `object_of`.
                self.objects.spawn(*client, *kind, self.middle_for(*client));
            }
            Command::Remove { client } => self.objects.remove(*client),
            Command::Drive { client, drive } => self.objects.drive(*client, *drive),
            Command::Views(views) => self.views.clone_from(views),
            Command::View(view) => {
                self.views.retain(|other| other.client != view.client);
                self.views.push(*view);
            }
        }
    }

    /// Where a client's objects appear: below its camera, or in the middle of the world.
    fn middle_for(&self, client: u32) -> [f32; 2] {
        let eye = self.views.iter().find(|view| view.client == client).map(|view| [view.eye_m[0], view.eye_m[2]]);
        eye.filter(|eye| (0..2).all(|axis| (0.0..=self.extent_m[axis]).contains(&eye[axis])))
            .unwrap_or(self.extent_m.map(|extent| 0.5 * extent))
    }

    /// Quantises the patches that changed: those that are awake, and near the cameras those that are only laid.
    fn show_patches(&mut self) {
        let (layout, views) = (*self.meadow.field().layout(), &self.views);
        self.shown.renew(self.tick, &mut self.meadow, |patch| is_in_sight(&layout, views, patch));
    }
}

/// Whether a patch may be within any camera's reach.
fn is_in_sight(layout: &PatchLayout, views: &[View], patch: PatchIndex) -> bool {
    let center_m = layout.center_m(patch);
    let reach_m = VIEW_RADIUS_LIMIT_M + layout.patch_m();
    views.iter().any(|view| (center_m[0] - view.eye_m[0]).hypot(center_m[1] - view.eye_m[2]) < reach_m)
}

/// All drawings that the winds of `scene` name are there.
fn check_drawings(scene: &Scene, drawings: &Drawings) -> Result<(), WorldError> {
    let winds = scene.drawn_winds.iter().map(|wind| ("drawn_winds", &wind.shape));
    let named = winds.chain([("objects.helicopter.wash_shape", &scene.objects.helicopter.wash_shape)]);
    let mut missing = named.filter_map(|(field, shape)| match shape {
        WindShape::Drawn(name) if !drawings.contains_key(name) => Some((field, name)),
        _ => None,
    });
    match missing.next() {
        Some((field, name)) => Err(WorldError { field, message: format!("names the drawing `{name}`, which is not among the maps") }),
        None => Ok(()),
    }
}

fn check_stiffness(scene: &Scene) -> Result<(), WorldError> {
    let allowed = match scene.bend.scheme {
        Scheme::Verlet => 1,
        Scheme::Substepped => SUBSTEP_LIMIT,
        Scheme::Implicit | Scheme::Modal => return Ok(()),
    };
    let needed = substeps_when_struck(scene);
    if needed <= allowed {
        return Ok(());
    }
    type Mend = fn(&mut Scene);
    let usual: [(&str, Mend); 13] = [
        ("grass.mu_m_per_rad", |scene| scene.grass.mu_m_per_rad = Grass::default().mu_m_per_rad),
        ("grass.c0_m_per_s", |scene| scene.grass.c0_m_per_s = Grass::default().c0_m_per_s),
        ("grass.c_omega_m_per_s", |scene| scene.grass.c_omega_m_per_s = Grass::default().c_omega_m_per_s),
        ("grass.stiffness_per_s2", |scene| scene.grass.stiffness_per_s2 = Grass::default().stiffness_per_s2),
        ("species", |scene| scene.species.clear()),
        ("patches.cell_m", |scene| scene.patches.cell_m = Patches::default().cell_m),
        ("tick_hz", |scene| scene.tick_hz = 60.0),
        ("objects.car.strike_height_m", |scene| scene.objects.car = CarTread::default()),
        ("objects.monster.strike_height_m", |scene| scene.objects.monster = MonsterTread::default()),
        ("objects.helicopter.strike_height_m", |scene| scene.objects.helicopter = HelicopterTread::default()),
        ("objects.sled.strike_height_m", |scene| scene.objects.sled = SledTread::default()),
        ("objects.ball.strike_height_m", |scene| scene.objects.ball = BallTread::default()),
        ("drawn_winds", |scene| scene.drawn_winds.clear()),
    ];
    let needed_with = |mend: Mend| {
        let mut mended = scene.clone();
        mend(&mut mended);
        substeps_when_struck(&mended)
    };
    // To blame is the field whose usual value would help most.
    let (field, _) = usual.into_iter().min_by_key(|&(_, mend)| needed_with(mend)).expect("the list is not empty");
    let stiffest = scene.kinds().into_iter().max_by_key(|grass| substeps_of(scene, &[WaveParams::from(grass)])).unwrap_or(scene.grass);
    let Grass { c0_m_per_s, mu_m_per_rad, c_omega_m_per_s, stiffness_per_s2, .. } = stiffest;
    let (_, by) = hardest_strike(scene);
    let message = format!(
        "makes the grass too stiff: with `bend.scheme` = \"{}\" it needs {needed} sub-steps in a step when {by}; \
         allowed: {allowed}. It has mu_m_per_rad = {mu_m_per_rad}, c0_m_per_s = {c0_m_per_s}, \
         c_omega_m_per_s = {c_omega_m_per_s}, stiffness_per_s2 = {stiffness_per_s2} on cells of {} m at {} Hz; smaller ones, a larger cell_m or a \
         higher tick_hz need fewer",
        scene.bend.scheme.word(),
        scene.patches.cell_m,
        scene.tick_hz
    );
    Err(WorldError { field, message })
}

/// Sub-steps of the grass when it is struck at its hardest.
fn substeps_when_struck(scene: &Scene) -> u32 {
    let waves: Vec<_> = scene.kinds().iter().map(WaveParams::from).collect();
    substeps_of(scene, &waves)
}

fn substeps_of(scene: &Scene, waves: &[WaveParams]) -> u32 {
    let (omega_rad_per_s, _) = hardest_strike(scene);
    let damping = if scene.bend.scheme == Scheme::Verlet { Damping::Plain } else { Damping::Exact };
    let needed = limits::substeps(waves, scene.patches.cell_m, scene.dt_secs(), omega_rad_per_s, damping);
    needed.unwrap_or(limits::SUBSTEPS_LIMIT)
}

/// The most that grass is made to bend (rad/s), and what does it.
fn hardest_strike(scene: &Scene) -> (f32, String) {
    let object = |kind| {
        (SPEED_LIMIT_M_PER_S / scene.objects.tread(kind).strike_height_m, format!("an object strikes it at {SPEED_LIMIT_M_PER_S} m/s"))
    };
    let wind =
        |wind: &DrawnWind| (wind.speed_m_per_s / wind.strike_height_m, format!("a drawn wind of {} m/s strikes it", wind.speed_m_per_s));
    let strikes = VehicleKind::ALL.map(object).into_iter().chain(scene.drawn_winds.iter().map(wind));
    strikes.max_by(|a, b| a.0.total_cmp(&b.0)).expect("there are kinds of objects")
}

fn no_wind(scene: &Scene, error: WeatherError) -> WorldError {
    match error {
        WeatherError::Step(StepError::TooLong { what: "viscosity_m2_per_s", dt_secs, needed, .. }) => {
            let (viscosity, [x, y, z]) = (scene.wind.viscosity_m2_per_s, scene.wind.spacing_m);
            let message = format!(
                "is {viscosity}, which needs {needed:.0} sub-steps of diffusion in the wind's step of {dt_secs:.3} s on cells of {x} × {y} × {z} m; \
                 allowed: {MAX_SUBSTEPS}. Take a smaller value or a larger `wind.spacing_m`"
            );
            WorldError { field: "wind.viscosity_m2_per_s", message }
        }
        other => WorldError { field: "wind", message: format!("makes no wind: {other}") },
    }
}

struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    fn add(&mut self, words: impl IntoIterator<Item = u32>) {
        for word in words {
            self.0 = (self.0 ^ u64::from(word)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
