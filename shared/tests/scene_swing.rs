//! Stability limit of a scene's blades: chosen steps are stable, longer ones are not, and too many steps are rejected.

use prairie_core::hash::hash3;
use prairie_core::plant::blade::{Blade, LINKS, Leans, Sway, advance};
use prairie_core::scene::{BladeIntegrator, Scene, parse};
use std::f32::consts::TAU;

fn scene(more: &str) -> Result<Scene, Vec<String>> {
    let maps = "summary = 's'\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n";
    parse(&format!("{maps}{more}")).map_err(|faults| faults.iter().map(ToString::to_string).collect())
}

/// The lowest blade of a scene: soil, tuft and random variation at their least.
fn lowest(scene: &Scene) -> Blade {
    let least = 0.72 * 0.78 * (1.0 - scene.plants.height_variation);
    Blade {
        length_m: scene.plants.height_m * least,
        frequency_rad_per_s: TAU * scene.plants.swing_hz / least,
        damping_ratio: scene.plants.swing_damping,
        lean_per_wind2: 0.01 * scene.grass.wind_bend_rad,
    }
}

/// Largest lean (rad) of a blade in two minutes of gusts of up to 10 m/s.
fn most_rad(blade: &Blade, integrator: BladeIntegrator, dt_secs: f32) -> f32 {
    let mut sway = Sway::default();
    let mut most = 0.0_f32;
    for step in 0..(120.0 / dt_secs) as u32 {
        let beat = (step as f32 * dt_secs * 4.0) as u32;
        let wind: Leans =
            std::array::from_fn(|link| [0, 1].map(|axis| (hash3([beat, axis, link as u32 / 2])[0] >> 8) as f32 / 8_388_608.0 * 7.0 - 7.0));
        sway = advance(&sway, blade, &[[0.0; 2]; LINKS], &wind, integrator, dt_secs);
        most = sway.lean_rad.as_flattened().iter().fold(most, |most, lean| most.max(lean.abs()));
        if most > 1e3 {
            return f32::INFINITY;
        }
    }
    most
}

#[test]
fn blades_are_stable_with_their_steps_and_not_with_much_longer_ones() {
    for more in [
        "[plants]\nintegrator = 'verlet'\n",
        "[grass]\nwind_bend_rad = 1.5\n[plants]\nintegrator = 'verlet'\nswing_damping = 0.02\nheight_m = 0.2\n",
        "[plants]\nintegrator = 'verlet'\nheight_variation = 0.6\nswing_hz = 1.0\n",
        "[plants]\nintegrator = 'euler'\nswing_damping = 0.6\n",
    ] {
        let scene = scene(more).unwrap();
        let (blade, step_secs) = (lowest(&scene), scene.blade_step_secs());
        let [held, exact, longer] = [(scene.plants.integrator, 1.0), (BladeIntegrator::Exact, 1.0), (scene.plants.integrator, 1.5)]
            .map(|(integrator, times)| most_rad(&blade, integrator, times * step_secs));
        assert!(held < 1.5 * exact + 0.1, "{held} rad for {exact} in steps of {step_secs} s: {more}");
        assert!(longer > 3.0 * exact, "{longer} rad for {exact} in steps half as long again: {more}");
    }
    assert_eq!(scene("").unwrap().blade_step_secs(), f32::INFINITY);
}

#[test]
fn blades_that_need_too_many_steps_are_rejected() {
    let told = |more: &str| scene(more).unwrap_err().join("\n");
    let euler = told("[plants]\nintegrator = 'euler'\n");
    assert!(
        euler.starts_with("`plants.integrator` is \"euler\", for which the shortest blades take 35 steps in 1/60 s; allowed: 8,"),
        "{euler}"
    );
    let verlet = scene("[plants]\nintegrator = 'verlet'\n").unwrap();
    assert_eq!((1.0 / 60.0 / verlet.blade_step_secs()).ceil(), 5.0);
    let stiff = told("[plants]\nintegrator = 'verlet'\nswing_hz = 12\n");
    assert!(stiff.starts_with("`plants.integrator` is \"verlet\""), "{stiff}");
    let species = told("[plants]\nintegrator = 'verlet'\n[[species]]\nname = 'wire'\ncover = 7\nswing_hz = 40\n");
    assert!(species.contains("the shortest blades of \"wire\" take") && species.contains("`species[0].swing_hz`"), "{species}");
    assert!(scene("[plants]\nswing_hz = 50\nheight_variation = 0.9\n").is_ok(), "exact ones bear every step");
}
