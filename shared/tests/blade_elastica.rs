//! Blades at rest in drag compared with the elastica, solved by shooting.

use prairie_core::plant::blade::deflection::{DRAG_LEANS, MEAN_LEAN, SILHOUETTES, WIND_SHAPE};
use prairie_core::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};
use prairie_core::plant::underbrush::elastica;
use prairie_core::plant::underbrush::rest::Load;
use std::f64::consts::FRAC_PI_2;

/// Steps along the elastica: a multiple of the number of links.
const STEPS: usize = 300;

/// Level load on an upright beam in units of EI/L²: a density that is a polynomial of the fraction s of its length, and a force at the tip.
#[derive(Clone, Copy, Debug)]
struct Along {
    constant: f64,
    linear: f64,
    square: f64,
    tip: f64,
}

const AT_TIP: Along = Along { constant: 0.0, linear: 0.0, square: 0.0, tip: 1.0 };
const EVEN: Along = Along { constant: 1.0, tip: 0.0, ..AT_TIP };
const GROWING: Along = Along { linear: 1.0, tip: 0.0, ..AT_TIP };
/// Silhouettes of 1 : 0.8 : 0.3 at the control points, as [`Along::on_points`] has them.
const SILHOUETTE: Along = Along { constant: 97.0 / 90.0, square: -0.6, tip: 0.0, ..AT_TIP };

impl Along {
    fn times(self, by: f64) -> Self {
        Self { constant: by * self.constant, linear: by * self.linear, square: by * self.square, tip: by * self.tip }
    }

    /// Force above the fraction `s`.
    fn above(self, s: f64) -> f64 {
        self.constant * (1.0 - s) + self.linear * (1.0 - s * s) / 2.0 + self.square * (1.0 - s.powi(3)) / 3.0 + self.tip
    }

    /// Moment at the fraction `s` while the beam is upright: the integral of [`Self::above`] from there, exact by Simpson's rule.
    fn moment(self, s: f64) -> f64 {
        let middle = 0.5 * (s + 1.0);
        (1.0 - s) / 6.0 * (self.above(s) + 4.0 * self.above(middle) + self.above(1.0))
    }

    /// Forces on the control points with the same moments at the joints.
    fn on_points(self) -> [f64; LINKS] {
        let [low, middle, high] = [0.0, 1.0, 2.0].map(|joint| 3.0 * self.moment(joint / 3.0));
        [low - 2.0 * middle + high, middle - 2.0 * high, high]
    }

    /// Deflection of a cantilever's tip under a small load: the integral of its density times s²·(3 − s)/6, and the force's 1/3.
    fn deflection(self) -> f64 {
        self.constant / 8.0 + self.linear * 11.0 / 120.0 + self.square * 13.0 / 180.0 + self.tip / 3.0
    }

    /// Mean lean of a blade under a small load (rad).
    fn mean_lean_rad(self) -> f64 {
        let forces = self.on_points();
        (0..LINKS).map(|point| f64::from(MEAN_LEAN[point]) / f64::from(SILHOUETTES[point]) * forces[point]).sum()
    }
}

/// Shape of an elastica: its points at each third of its length, X and height, and its mean lean (rad).
#[derive(Clone, Copy, Debug)]
struct Bent {
    points: [[f64; 2]; LINKS],
    mean_rad: f64,
}

/// `θ'' = −V(s)·cos θ` from the root, upright there, without a moment at the tip: Runge–Kutta steps down from the tip, whose lean is bisected.
fn bent(load: Along, steps: usize) -> Bent {
    let h = 1.0 / steps as f64;
    // Lean, curvature, position below the tip and integral of the lean.
    let rate = |below: f64, [lean, curve, ..]: [f64; 5]| [-curve, load.above(1.0 - below) * lean.cos(), lean.sin(), lean.cos(), lean];
    let shot = |tip_rad: f64| {
        let mut y = [tip_rad, 0.0, 0.0, 0.0, 0.0];
        let mut thirds = vec![y];
        for step in 0..steps {
            let below = step as f64 * h;
            let at = |k: [f64; 5], by: f64| std::array::from_fn(|n| y[n] + by * k[n]);
            let first = rate(below, y);
            let second = rate(below + h / 2.0, at(first, h / 2.0));
            let third = rate(below + h / 2.0, at(second, h / 2.0));
            let fourth = rate(below + h, at(third, h));
            y = std::array::from_fn(|n| y[n] + h / 6.0 * (first[n] + 2.0 * second[n] + 2.0 * third[n] + fourth[n]));
            if (step + 1) % (steps / LINKS) == 0 {
                thirds.push(y);
            }
        }
        thirds
    };
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if shot(middle)[LINKS][0] > 0.0 { high = middle } else { low = middle }
    }
    let thirds = shot(0.5 * (low + high));
    let root = thirds[LINKS];
    Bent { points: [2, 1, 0].map(|third| [root[2] - thirds[third][2], root[3] - thirds[third][3]]), mean_rad: root[4] }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[test]
fn shooting_gives_published_values_and_those_of_the_other_solver() {
    // Bisshopp & Drucker 1945: deflection and shortening under a load at the tip.
    for (load, deflection, shortening) in
        [(1.0, 0.30172, 0.05643), (2.0, 0.49346, 0.16064), (5.0, 0.71379, 0.38763), (10.0, 0.81061, 0.55500)]
    {
        let [.., [x, height]] = bent(AT_TIP.times(load), STEPS).points;
        assert!(distance([x, 1.0 - height], [deflection, shortening]) < 8e-6, "{x}, {height} at {load}");
    }
    for load in [AT_TIP.times(19.0), EVEN.times(32.0), GROWING.times(50.0), SILHOUETTE.times(40.0)] {
        let (coarse, fine) = (bent(load, STEPS), bent(load, 3 * STEPS));
        let apart = coarse.points.into_iter().zip(fine.points).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
        assert!(apart < 1e-6 && (coarse.mean_rad - fine.mean_rad).abs() < 1e-6, "{apart} under {load:?}");
        if load.linear == 0.0 && load.square == 0.0 {
            let [height, back] = elastica::tip(1.0, Load { spread: load.constant, tip: load.tip }, FRAC_PI_2);
            assert!(distance(coarse.points[LINKS - 1], [-back, height]) < 1e-6);
        }
    }
}

/// Factor from the forces on a blade to its drag: an even wind holds the mean lean of the elastica with the blade's silhouette, and that of another load
/// counts for as much as the load that holds this lean in linear theory.
fn drag_per_force(load: Along) -> f64 {
    let linear_rad = load.mean_lean_rad();
    bent(SILHOUETTE.times(linear_rad / SILHOUETTE.deflection()), STEPS).mean_rad / linear_rad
}

/// Drag on the control points (rad) under a load.
fn drag_rad(load: Along) -> [f64; LINKS] {
    let (forces, factor) = (load.on_points(), drag_per_force(load));
    std::array::from_fn(|point| factor * forces[point] / f64::from(SILHOUETTES[point]))
}

/// Control points of a blade of 1 m, X and height, in a steady wind with such a drag.
fn blown(drag_rad: [f64; LINKS]) -> [[f64; 2]; LINKS] {
    let blade = Blade { length_m: 1.0, frequency_rad_per_s: 9.74, damping_ratio: 0.3, lean_per_wind2: 0.005 };
    let wind: Leans = drag_rad.map(|rad| [(rad.max(0.0) / f64::from(blade.lean_per_wind2)).sqrt() as f32, 0.0]);
    let sway = (0..1500).fold(Sway::default(), |sway, _| advance(&sway, &blade, &Leans::default(), &wind, Integrator::Exact, 1.0 / 60.0));
    sway.points_m(blade.length_m).map(|[x, height, _]| [f64::from(x), f64::from(height)])
}

/// Control points of a blade with these leans (rad).
fn leaning(leans_rad: [f64; LINKS]) -> [[f64; 2]; LINKS] {
    let mut at = [0.0; 2];
    leans_rad.map(|lean_rad| {
        at = [at[0] + lean_rad.sin() / LINKS as f64, at[1] + lean_rad.cos() / LINKS as f64];
        at
    })
}

/// Loads, each with the largest whose elastica has a mean lean of 1.2 rad.
const LOADS: [(&str, Along, f64); 4] =
    [("tip", AT_TIP, 19.2), ("even", EVEN, 31.9), ("silhouette", SILHOUETTE, 41.0), ("growing", GROWING, 48.0)];

#[test]
fn the_tip_of_a_blade_is_within_a_hundredth_of_the_elastica_up_to_a_mean_lean_of_1_2_rad() {
    for (name, load, largest) in LOADS {
        let (mut tip, mut any) = (0.0_f64, 0.0_f64);
        for step in 1..=24 {
            let load = load.times(largest * (f64::from(step) / 24.0).powi(3));
            let (exact, found) = (bent(load, STEPS), blown(drag_rad(load)));
            println!("{name} {:.3}: {:.4}", exact.mean_rad, distance(found[2], exact.points[2]));
            tip = tip.max(distance(found[LINKS - 1], exact.points[LINKS - 1]));
            any = (0..LINKS).map(|point| distance(found[point], exact.points[point])).fold(any, f64::max);
            assert!(step < 24 || (1.195..1.2).contains(&exact.mean_rad), "{name}: {}", exact.mean_rad);
        }
        println!("{name}: tip {tip:.4}, control points {any:.4}");
        assert!(tip <= 0.01, "{name}: tip {tip} of the length away");
        assert!(any <= 0.037, "{name}: control points {any} of the length away");
    }
}

#[test]
fn leans_take_the_forces_that_the_readme_says() {
    for (lean_rad, times) in [(0.5, 1.15), (1.0, 1.97), (1.2, 3.13)] {
        let found_rad = bent(SILHOUETTE.times(times * lean_rad / SILHOUETTE.deflection()), STEPS).mean_rad;
        assert!((found_rad - lean_rad).abs() < 0.003, "{found_rad} rad at {times} times the load of {lean_rad} rad in linear theory");
    }
}

#[test]
fn linear_leans_leave_the_elastica() {
    for (name, load, largest) in LOADS {
        let load = load.times(largest);
        let (exact, drag_rad) = (bent(load, STEPS), drag_rad(load));
        let linear = |drag_rad: [f64; LINKS]| {
            leaning(DRAG_LEANS.map(|row| row.iter().zip(drag_rad).map(|(&lean, rad)| f64::from(lean) * rad).sum()))
        };
        // Without the terms that follow the elastica; then with a force that grows with the square of the wind as well.
        let without = distance(linear(drag_rad)[LINKS - 1], exact.points[LINKS - 1]);
        let by_square = drag_rad.map(|rad| rad / drag_per_force(load));
        let square = distance(linear(by_square)[LINKS - 1], exact.points[LINKS - 1]);
        println!("{name}: {without:.4} {square:.4}");
        assert!(without > 0.02 && square > 0.2, "{name}: {without}, {square}");
    }
}

#[test]
fn small_loads_move_the_tip_as_a_cantilevers() {
    // Simpson's rule is exact for moments of third order.
    for (name, load, bound) in [("tip", AT_TIP, 0.002), ("even", EVEN, 0.002), ("silhouette", SILHOUETTE, 0.01), ("growing", GROWING, 0.01)]
    {
        let small = load.times(0.01);
        let [.., [x, _]] = blown(drag_rad(small));
        let ratio = x / small.deflection();
        println!("{name}: {ratio}");
        assert!((ratio - 1.0).abs() < bound, "{name}: {ratio}");
    }
    assert!((WIND_SHAPE.iter().sum::<f32>() / LINKS as f32 - 1.0).abs() < 1e-6);
}
