//! Rays traced through the strips of the drawn blades.

use super::*;
use crate::render::gpu::constants::{COARSE_LIST, FINE_LIST, SINGLE_LIST};
use prairie_core::plant::blade::backbone::{backbone_m, segment_points_m};

/// Corner of the square with blades (m), its cells along a side, and the size of a cell (m).
const CORNER_M: [f32; 2] = [26.0, 23.0];
const CELLS: usize = 180;
const CELL_M: f32 = 0.1;
/// Numbers in `Blade` of `drawn_blade.wgsl`.
const NUMBERS: usize = blades::BLADE_BYTES as usize / 4;

/// Strips of blades as triangles, in a grid of columns.
pub(super) struct Strips {
    /// Strips turned to the eye, as they are drawn, and as they stand, which cast shadows.
    shown: Triangles,
    standing: Triangles,
}

#[derive(Default)]
struct Triangles {
    /// Corners (m) and number of the blade.
    list: Vec<([Vec3; 3], u32)>,
    /// Triangles above each cell of the ground.
    cells: Vec<Vec<u32>>,
}

impl Strips {
    /// Those of the newest frame.
    pub(super) fn drawn(gpu: &Gpu, picture: &OffscreenRenderer, eye_m: Vec3) -> Self {
        let listed = &picture.renderer.scene.as_ref().and_then(|scene| scene.blades.as_ref()).expect("grass").listed;
        let (bytes, counts) = (read(gpu, &listed.blades), read(gpu, &listed.counters));
        let drawn: &[[f32; NUMBERS]] = bytemuck::cast_slice(&bytes);
        let counts: &[u32] = bytemuck::cast_slice(&counts);
        let [fine, others] = listed.capacities.map(|capacity| capacity as usize);
        let count = |list: u32| counts[list as usize] as usize;
        let mut strips = Self { shown: Triangles::new(), standing: Triangles::new() };
        let lists = [
            (&drawn[..count(FINE_LIST)], listed.segments[0]),
            (&drawn[fine..][..count(COARSE_LIST)], listed.segments[1]),
            (&drawn[fine + others - count(SINGLE_LIST)..fine + others], 1),
        ];
        let mut number = 0;
        for (blades, segments) in lists {
            for blade in blades {
                strips.add(blade, segments, number, eye_m);
                number += 1;
            }
        }
        strips
    }

    fn add(&mut self, blade: &[f32; NUMBERS], segments: u32, number: u32, eye_m: Vec3) {
        let vector = |at: usize| [blade[at], blade[at + 1], blade[at + 2]];
        let (root, width_m, side_rad, points_m) = (Vec3::from(vector(0)), blade[3], blade[7], [vector(4), vector(8), vector(12)]);
        let row = |step: u32| {
            let t = step as f32 / segments as f32;
            let [left, right] = segment_points_m(&points_m, side_rad, t, 1.0).map(Vec3::from);
            let centre = root + Vec3::from(backbone_m(&points_m, t));
            let tangent = tangent(&points_m, t);
            let half_m = 0.5 * width_m * (1.0 - t * t) * (0.80 + 0.55 * t);
            [right - left, turned(right - left, tangent, (centre - eye_m).normalize())]
                .map(|side| [centre - side * half_m, centre + side * half_m].map(|p| p.max(Vec3::new(f32::MIN, 0.0, f32::MIN))))
        };
        for step in 0..segments {
            let (below, above) = (row(step), row(step + 1));
            for ((triangles, [a, b]), [c, d]) in [&mut self.standing, &mut self.shown].into_iter().zip(below).zip(above) {
                triangles.add([a, b, c], number);
                triangles.add([c, b, d], number);
            }
        }
    }

    /// For each pixel, whether the sun is visible from what it shows.
    pub(super) fn sun_visible(&self, camera: &Camera, size_px: [u32; 2], toward_sun: Vec3) -> Vec<bool> {
        let [width, height] = size_px.map(|px| px as f32);
        let scale = (0.5 * camera.fov_rad).tan();
        let (forward, right) = (camera.forward(), camera.right());
        let up = right.cross(forward);
        let pixels = (0..size_px[1]).flat_map(|y| (0..size_px[0]).map(move |x| [x as f32 + 0.5, y as f32 + 0.5]));
        let seen = |[x, y]: [f32; 2]| {
            let aside = scale * (2.0 * x / width - 1.0) * width / height;
            let ray = (forward + right * aside + up * (scale * (1.0 - 2.0 * y / height))).normalize();
            let ground_m = camera.eye_m.y / -ray.y;
            let (way_m, own) = self.shown.first_hit(camera.eye_m, ray, ground_m, None).unwrap_or((ground_m, u32::MAX));
            self.standing.first_hit(camera.eye_m + ray * way_m, toward_sun, 60.0, Some(own)).is_none()
        };
        pixels.map(seen).collect()
    }
}

/// Unit tangent of the backbone.
fn tangent(points_m: &[[f32; 3]; LINKS], t: f32) -> Vec3 {
    let [low, middle, tip] = points_m.map(Vec3::from);
    let s = 1.0 - t;
    (s * s * low + 2.0 * s * t * (middle - low) + t * t * (tip - middle)).normalize()
}

/// Side that is drawn, as `shown_side` in `blades.wgsl`.
fn turned(side: Vec3, tangent: Vec3, view: Vec3) -> Vec3 {
    let facing = tangent.cross(view);
    let toward = facing * (facing.dot(side) + 1e-5).signum() / facing.length().max(1e-3);
    (side * 0.55 + toward * 0.45).normalize()
}

impl Triangles {
    fn new() -> Self {
        Self { list: Vec::new(), cells: vec![Vec::new(); CELLS * CELLS] }
    }

    fn add(&mut self, corners: [Vec3; 3], blade: u32) {
        let number = self.list.len() as u32;
        let [low, high] = [corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2])].map(cell_of);
        for z in low[1].max(0)..=high[1].min(CELLS as i32 - 1) {
            for x in low[0].max(0)..=high[0].min(CELLS as i32 - 1) {
                self.cells[z as usize * CELLS + x as usize].push(number);
            }
        }
        self.list.push((corners, blade));
    }

    /// Distance of the first triangle within `limit_m` that is not of the blade `own`, and its blade; the first found if `own` is given.
    fn first_hit(&self, from: Vec3, toward: Vec3, limit_m: f32, own: Option<u32>) -> Option<(f32, u32)> {
        let mut nearest: Option<(f32, u32)> = None;
        let mut at = cell_of(from);
        let axes = [(from.x, toward.x, CORNER_M[0]), (from.z, toward.z, CORNER_M[1])];
        loop {
            let inside = at.iter().all(|n| (0..CELLS as i32).contains(n));
            for &number in inside.then(|| &self.cells[at[1] as usize * CELLS + at[0] as usize]).into_iter().flatten() {
                let (corners, blade) = &self.list[number as usize];
                let hit = if own == Some(*blade) { None } else { met(corners, from, toward) };
                if let Some(way_m) = hit.filter(|&way_m| way_m < nearest.map_or(limit_m, |(nearest_m, _)| nearest_m)) {
                    nearest = Some((way_m, *blade));
                }
            }
            let exits = [0, 1].map(|axis| {
                let (start, speed, corner) = axes[axis];
                let border = corner + (at[axis] + i32::from(speed > 0.0)) as f32 * CELL_M;
                if speed == 0.0 { f32::MAX } else { (border - start) / speed }
            });
            let axis = usize::from(exits[1] < exits[0]);
            let is_beyond = exits[axis] > limit_m || from.y + toward.y * exits[axis] > 3.0 && toward.y > 0.0;
            if is_beyond || nearest.is_some_and(|(way_m, _)| own.is_some() || way_m < exits[axis]) {
                return nearest;
            }
            at[axis] += if axes[axis].1 > 0.0 { 1 } else { -1 };
        }
    }
}

fn cell_of(p: Vec3) -> [i32; 2] {
    [(p.x, CORNER_M[0]), (p.z, CORNER_M[1])].map(|(m, corner)| ((m - corner) / CELL_M).floor() as i32)
}

/// Distance at which a ray meets a triangle (Möller & Trumbore 1997).
fn met([a, b, c]: &[Vec3; 3], from: Vec3, toward: Vec3) -> Option<f32> {
    let (ab, ac) = (*b - *a, *c - *a);
    let across = toward.cross(ac);
    let scale = ab.dot(across);
    if scale == 0.0 {
        return None;
    }
    let to = (from - *a) / scale;
    let u = to.dot(across);
    let turned = to.cross(ab);
    let v = toward.dot(turned);
    let way_m = ac.dot(turned);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && way_m > 1e-4).then_some(way_m)
}
