use super::*;
use crate::intensity::{Pulse, Spline};
use crate::{Boundary, Location};

const SHAPES: [Shape; 5] = [Shape::Uniform, Shape::Source, Shape::Sink, Shape::Vortex, Shape::Cyclone];
const CENTRE_M: [f64; 3] = [8.25, 4.0, 7.5];
const RADIUS_M: f64 = 6.0;
const DT_SECS: f64 = 0.1;

fn grid<R: Real>() -> Grid<R> {
    Grid { cells: [16, 8, 16], spacing_m: [R::one(); 3], boundary: [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]] }
}

fn primitive(shape: Shape, intensity: Intensity, front: Front) -> Primitive {
    Primitive {
        shape,
        position_m: CENTRE_M.map(|x| x as f32),
        drift_m_per_s: [0.0; 2],
        radius_m: RADIUS_M as f32,
        speed_m_per_s: 5.0,
        direction: [0.6, 0.8],
        dust: 0.75,
        intensity,
        front,
    }
}

fn gust() -> Intensity {
    Intensity::Gust(Pulse { attack_secs: 0.5, hold_secs: 0.25, fall_secs: 1.0, period_secs: 0.0 })
}

/// Values with their offsets (m) from the centre.
type Values<R> = Vec<([f64; 3], R)>;

/// What a primitive does in a step to air at 0.5 m/s along each axis.
struct Effect<R> {
    velocity: [Values<R>; 3],
    dust: Values<R>,
    inflow: Values<R>,
}

fn effect<R: Real>(primitive: &Primitive, intensity_secs: f64) -> Effect<R> {
    let (grid, moment) = (grid::<R>(), Moment { secs: 3.0, intensity_secs });
    let mut footprint = Footprint::new(&grid);
    let mut velocity = Velocity::zeros(&grid);
    velocity.0.iter_mut().for_each(|field| field.fill(&grid, |_| R::of(0.5)));
    primitive.drive(&grid, moment, DT_SECS, &mut velocity, &mut footprint);
    let mut dust = Field::zeros(&grid, Location::Centre);
    primitive.release(&grid, moment, 2.0, DT_SECS, &mut dust, &mut footprint);
    let mut inflow = vec![0.0; grid.len()];
    primitive.add_volume_source(&grid, moment, &mut inflow, &mut footprint);
    let offset = |at_m: [R; 3]| [0, 1, 2].map(|axis| at_m[axis].wide() - CENTRE_M[axis]);
    let values = |field: &Field<R>| field.samples(&grid).map(|(at_m, value)| (offset(at_m), value)).collect::<Vec<_>>();
    let dust = values(&dust);
    let inflow = dust.iter().zip(inflow).map(|(&(offset_m, _), value)| (offset_m, R::of(value))).collect();
    Effect { velocity: velocity.0.each_ref().map(values), dust, inflow }
}

/// FNV-1a of the bits of all that each shape does.
fn bits(intensity: &Intensity, front: Front, intensity_secs: f64) -> [u64; 5] {
    SHAPES.map(|shape| {
        let Effect { velocity, dust, inflow } = effect::<f32>(&primitive(shape, intensity.clone(), front), intensity_secs);
        let values = velocity.iter().flatten().chain(&dust).chain(&inflow);
        values.fold(0xcbf2_9ce4_8422_2325, |sum, (_, value)| (sum ^ u64::from(value.to_bits())).wrapping_mul(0x0100_0000_01b3))
    })
}

/// The bits of the same primitives before intensities were introduced.
const STEADY_BITS: [u64; 5] =
    [0x6855_0637_c260_6111, 0x6c7c_39c4_1c4c_27d1, 0x7279_a331_20e3_acc8, 0xa78d_2349_9b4f_8779, 0x14bf_0f22_3440_efc6];

#[test]
fn a_steady_primitive_and_one_of_intensity_1_have_the_bits_of_old() {
    let one = Intensity::Spline(Spline::new(9.0, vec![[0.0, 1.0], [4.0, 1.0]]));
    let front = Front { speed_m_per_s: 40.0, step_m: 0.0 };
    let steady = bits(&Intensity::Steady, front, -1.0);
    assert_eq!(steady, STEADY_BITS);
    assert_eq!(bits(&one, Front::default(), 1.0), STEADY_BITS);
    assert_eq!(bits(&one, front, 1.0), STEADY_BITS, "the front has passed");
    let arriving = bits(&one, front, 0.05);
    assert!(arriving.iter().zip(STEADY_BITS).all(|(arriving, steady)| *arriving != steady), "before it has passed it shows");
}

#[test]
fn a_primitive_of_intensity_0_leaves_the_air_alone() {
    let is_alone = |intensity_secs: f64, front: Front| {
        SHAPES.map(|shape| {
            let Effect { velocity, dust, inflow } = effect::<f64>(&primitive(shape, gust(), front), intensity_secs);
            velocity.iter().flatten().all(|(_, speed)| *speed == 0.5) && dust.iter().chain(&inflow).all(|(_, value)| *value == 0.0)
        })
    };
    let front = Front { speed_m_per_s: 10.0, step_m: 0.0 };
    assert_eq!(is_alone(-0.1, Front::default()), [true; 5]);
    assert_eq!(is_alone(-0.1, front), [true; 5]);
    assert_eq!(is_alone(9.0, front), [true; 5], "after its fall");
    assert_eq!(is_alone(0.3, front), [false; 5]);
}

fn distance_m([x, y, z]: [f64; 3]) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

#[test]
fn dust_and_divergence_are_those_of_the_delayed_intensity() {
    let rings = Front { speed_m_per_s: 8.0, step_m: 2.0 };
    for (front, secs) in
        [Front::default(), Front { step_m: 0.0, ..rings }, rings].into_iter().flat_map(|front| [0.2, 0.6, 1.5].map(|secs| (front, secs)))
    {
        let full = effect::<f64>(&primitive(Shape::Source, Intensity::Steady, front), secs);
        let part = effect::<f64>(&primitive(Shape::Source, gust(), front), secs);
        let both = full.dust.iter().zip(&part.dust).chain(full.inflow.iter().zip(&part.inflow)).filter(|((_, full), _)| *full > 0.0);
        let mut levels = Vec::new();
        for ((offset_m, full), (_, part)) in both {
            let d = distance_m(*offset_m);
            let delay_secs = match front {
                Front { speed_m_per_s: 0.0, .. } => 0.0,
                Front { step_m: 0.0, .. } => d / 8.0,
                _ => (d / 2.0).floor() * 2.0 / 8.0,
            };
            let level = gust().level(secs - delay_secs);
            assert!((part / full - level).abs() < 1e-12, "at {d} m and {secs} s {}, not {level}", part / full);
            levels.push((1e9 * level) as i64);
        }
        assert!(levels.len() > 1000);
        levels.sort_unstable();
        levels.dedup();
        let expected = if front == Front::default() {
            1..=1
        } else if front == rings {
            2..=5
        } else {
            6..=2000
        };
        assert!(expected.contains(&levels.len()), "{front:?} at {secs} s has {} levels", levels.len());
    }
}

#[test]
fn air_is_driven_at_the_delayed_rate_towards_the_delayed_speed() {
    let (front, secs) = (Front { speed_m_per_s: 8.0, step_m: 0.0 }, 0.6);
    let fraction = |level: f64| 2.0 * level * DT_SECS / (1.0 + 2.0 * level * DT_SECS);
    let [steady, gusty] = [Intensity::Steady, gust()].map(|intensity| effect::<f64>(&primitive(Shape::Uniform, intensity, front), secs));
    let target = 5.0 * f64::from(0.6_f32);
    let (mut reached, mut waiting) = (0, 0);
    for ((offset_m, steady), (_, gusty)) in steady.velocity[0].iter().zip(&gusty.velocity[0]) {
        let weight = (steady - 0.5) / (fraction(1.0) * (target - 0.5));
        let level = gust().level(secs - distance_m(*offset_m) / 8.0);
        let expected = 0.5 + weight * fraction(level) * (target * level - 0.5);
        assert!((gusty - expected).abs() < 1e-12, "{offset_m:?}: {gusty}, not {expected}");
        reached += usize::from(level > 0.0 && weight > 0.0);
        waiting += usize::from(level == 0.0 && weight > 0.0);
    }
    assert!(reached > 100 && waiting > 100, "{reached} {waiting}");
}

#[test]
fn an_intensity_above_1_raises_the_speed_but_not_the_rate() {
    let strong = Intensity::Spline(Spline::new(9.0, vec![[0.0, 2.0], [4.0, 2.0]]));
    let [once, twice] =
        [Intensity::Steady, strong].map(|intensity| effect::<f64>(&primitive(Shape::Uniform, intensity, Front::default()), 1.0));
    let target = 5.0 * f64::from(0.6_f32);
    for ((_, once), (_, twice)) in once.velocity[0].iter().zip(&twice.velocity[0]) {
        assert!(((twice - 0.5) * (target - 0.5) - (once - 0.5) * (2.0 * target - 0.5)).abs() < 1e-12, "{once} {twice}");
    }
}

#[test]
fn an_intensity_below_0_reverses_the_flow_and_releases_no_dust() {
    let reversed = Intensity::Spline(Spline::new(9.0, vec![[0.0, -1.0], [4.0, -1.0]]));
    let of = |shape, intensity: &Intensity| effect::<f64>(&primitive(shape, intensity.clone(), Front::default()), 1.0);
    for (shape, opposite) in [(Shape::Source, Shape::Sink), (Shape::Sink, Shape::Source)] {
        let (found, expected) = (of(shape, &reversed), of(opposite, &Intensity::Steady));
        assert_eq!((found.velocity, found.inflow), (expected.velocity, expected.inflow), "{shape:?}");
    }
    for shape in [Shape::Uniform, Shape::Vortex, Shape::Cyclone] {
        let (found, steady) = (of(shape, &reversed), of(shape, &Intensity::Steady));
        // Air at rest would be driven as far the one way as the other; here it moves at 0.5 m/s, and a weight w of the rate changes that alike in both.
        let mut changed = 0;
        for ((offset_m, found), (_, steady)) in found.velocity.iter().flatten().zip(steady.velocity.iter().flatten()) {
            let [forth, back] = [steady - 0.5, found - 0.5];
            let share = -(forth + back) / (2.0 * 0.5);
            assert!((-1e-12..1.0).contains(&share), "{shape:?} at {offset_m:?}: {forth} and {back}");
            changed += usize::from((forth - back).abs() > 0.1);
        }
        assert!(changed > 100, "{shape:?} changes the speed of {changed} faces");
    }
    for shape in SHAPES {
        assert!(of(shape, &reversed).dust.iter().all(|(_, dust)| *dust == 0.0), "{shape:?} releases dust");
    }
}
