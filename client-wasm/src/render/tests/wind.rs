//! Wind, dust and gusts in the shaders.

use super::*;
use prairie_core::scene::{WindDust, WindTiling};
use prairie_core::wire::TurbulenceState;
use prairie_core::wire::quantise::CodeSteps;

/// Wind and dust as the shaders sample them at `places`: X, height above the ground and Z (m).
fn air(gpu: &Gpu, picture: &OffscreenRenderer, places: &[[f32; 4]]) -> Vec<[f32; 4]> {
    probe(gpu, picture, "let air = air_at(at.xz, at.y); return vec4<f32>(air.xyz, dust_of(air));", places)
}

#[test]
fn patches_show_the_box_where_the_server_has_it() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let dust = WindDust { release_per_s: 1.0, ..WindDust::default() };
    let mut mirror = meadow_in(Wind { cells: [8, 2, 4], spacing_m: [2.0, 2.0, 4.0], tiling: WindTiling::Patch, dust, ..Wind::default() });
    // Codes that differ between all cells along X, along Z and in height.
    let plane = |code: fn(usize) -> usize| (0..64).map(move |at| code(at) as i16);
    let codes: Vec<i16> =
        plane(|at| 10 * (at % 8)).chain(plane(|at| at / 8 % 2 * 50)).chain(plane(|at| at / 16 * 30)).chain(plane(|at| at)).collect();
    let payload = codec::encode(Shape::wind(8, true), &codes, None);
    mirror
        .apply(ServerMessage::Wind { tick: 1, seq: 1, key: true, turbulence: TurbulenceState::default(), payload })
        .expect("a sound wind");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    // The centres of all cells of 6 × 6 patches, some beyond the world, and places where patches meet.
    let middles = (0..48 * 24).map(|n| [(n % 48) as f32 * 2.0 - 15.0, 1.0, (n / 48) as f32 * 4.0 - 14.0, 0.0]);
    let seams = (0..40).map(|n| [16.0 * (n % 4) as f32, 3.0, 7.0 + 0.37 * n as f32, 0.0]);
    let places: Vec<_> = middles.chain(seams).collect();
    let decoded = mirror.decoded_scene().expect("a scene");
    let wind = &picture.renderer.scene.as_ref().expect("a scene").textures.wind;
    for (place, found) in places.iter().zip(air(&gpu, &picture, &places)) {
        let wanted = decoded.tiles().blend([place[0], place[2]], |at_m| trilinear(&codes, [at_m[0], place[1], at_m[1]]));
        let CodeSteps { wind_m_per_s: step, dust_root, .. } = CodeSteps::default();
        let [u, v, w, root] = wanted;
        let wanted = [u * step, v * step, w * step, (root * dust_root).powi(2)];
        // Filtering has 8 bits of fraction.
        assert!(wanted.iter().zip(found).all(|(a, b)| (a - b).abs() < 0.15), "{found:?} instead of {wanted:?} at {place:?}");
        let twin = wind.resolved_at(decoded, [place[0], place[1], place[2]]);
        assert!(wanted.iter().zip(twin).all(|(a, b)| (a - b).abs() < 1e-3), "{twin:?} instead of {wanted:?} at {place:?}");
    }
}

/// Streams a wind towards the east whose gusts travel along for 1.2 s.
pub(super) fn blow_gusts(mirror: &mut Mirror, m_per_s: f32) {
    let cells = mirror.decoded_scene().expect("a scene").scene().wind.cells.map(|n| n as usize);
    let count = cells.iter().product::<usize>();
    let codes: Vec<i16> = (0..3 * count).map(|at| if at < count { CodeSteps::default().wind_code(m_per_s) } else { 0 }).collect();
    for frame in 0..6 {
        let travel_m = f64::from(m_per_s) * 0.25 * f64::from(frame);
        let turbulence = TurbulenceState { travel_m: [travel_m, 0.0], path_m: 0.08 * travel_m, friction_m_per_s: 0.08 * m_per_s };
        let payload = codec::encode(Shape::wind(cells[0], false), &codes, None);
        let message = ServerMessage::Wind { tick: 15 * u64::from(frame), seq: frame, key: true, turbulence, payload };
        mirror.apply(message).expect("a sound wind");
    }
}

#[test]
fn the_shaders_have_the_wind_of_the_core() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(4.0);
    let cells = mirror.decoded_scene().expect("a scene").scene().wind.cells.map(|n| n as usize);
    let count = cells.iter().product::<usize>();
    let codes: Vec<i16> =
        (0..3 * count).map(|at| CodeSteps::default().wind_code([4.0, 0.1, -1.0][at / count] + (at % 7) as f32 * 0.25)).collect();
    let turbulence = TurbulenceState { travel_m: [123_456.7, -4321.1], path_m: 9876.5, friction_m_per_s: 0.8 };
    let payload = codec::encode(Shape::wind(cells[0], false), &codes, None);
    mirror.apply(ServerMessage::Wind { tick: 1, seq: 1, key: true, turbulence, payload }).expect("a sound wind");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera::default(), 0.0, 0.0);
    let wind = mirror.wind_field().expect("a wind");
    let places: Vec<_> = (0..2000).map(|n| [n as f32 * 2.37, 0.01 * (n % 400) as f32, 4800.0 - n as f32 * 1.71, 0.0]).collect();
    let gusts = probe(&gpu, &picture, "return vec4<f32>(gust_at(at.xz), 0.0, 0.0);", &places);
    let winds = probe(&gpu, &picture, "return vec4<f32>(wind_at(vec3<f32>(at.x, 0.0, at.z), at.y), 0.0);", &places);
    let (mut worst_gust, mut strongest, mut worst_wind) = (0.0_f32, 0.0_f32, 0.0_f32);
    for ((&[x, above, z, _], gust), found) in places.iter().zip(gusts).zip(winds) {
        let wanted = wind.gust_at([x, z]);
        worst_gust = (0..2).map(|axis| (wanted[axis] - gust[axis]).abs()).fold(worst_gust, f32::max);
        strongest = strongest.max(wanted[0].abs());
        let wanted = wind.wind_at([x, above, z]);
        worst_wind = (0..3).map(|axis| (wanted[axis] - found[axis]).abs()).fold(worst_wind, f32::max);
    }
    println!("gusts up to {strongest} m/s along X; apart by at most {worst_gust} m/s, the whole wind by {worst_wind} m/s");
    // The wind's texture is filtered with 8 bits of fraction.
    assert!(strongest > 1.0 && worst_gust < 0.002 && worst_wind < 0.03, "{worst_gust}, {worst_wind}");
}

/// Codes (u, v, w, dust) of 8 × 2 × 4 cells of 2 × 2 × 4 m, interpolated at a place like a sampler does.
fn trilinear(codes: &[i16], place_m: [f32; 3]) -> [f32; 4] {
    let at: [f32; 3] = std::array::from_fn(|axis| place_m[axis] / [2.0, 2.0, 4.0][axis] - 0.5);
    let mut sum = [0.0; 4];
    for corner in 0..8 {
        let (mut cell, mut fraction) = ([0; 3], 1.0);
        for axis in 0..3 {
            let (far, count) = (corner >> axis & 1, [8, 2, 4][axis]);
            let part = at[axis] - at[axis].floor();
            fraction *= if far == 1 { part } else { 1.0 - part };
            let index = at[axis].floor() as i32 + far;
            cell[axis] = if axis == 1 { index.clamp(0, 1) } else { index.rem_euclid(count) };
        }
        let index = (cell[0] + 8 * (cell[1] + 2 * cell[2])) as usize;
        sum.iter_mut().enumerate().for_each(|(plane, sum)| *sum += f32::from(codes[64 * plane + index]) * fraction);
    }
    sum
}
