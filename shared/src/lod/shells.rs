//! Shells (Bakay §3): cross-section layers of a blade of grass, and their tilt, which preserves its length.
//!
//! A blade of height `H` between the ground and the topmost of `N` layers is `N` segments of `S = H/N`. Segment `j`, of 1..=N, is tilted from the normal
//! towards the wind by `θ_j = θ₀ + (j/N)^(1 + p)·(π/2)·I`; layer `i` is the sum of the segments below it. Bakay has `θ₀ = 0`, so that trodden grass would
//! keep at least 64 % of its height; the tilt θ₀ of the root lays it flat.
//!
//! The increment `θ_j − θ_{j−1}` is constant at `p = 0`, as in Bakay, who notes that it need not be: stiff grass bends further up the stalk, floppy grass
//! in its first segments. A power law does both with one number, and for any `p` the increments add up to the same tilt `(π/2)·I` of the tip: with
//! `p = 2` a blade of 16 segments has bent by an eighth of that at half its length, with `p = −0.9` by three quarters of it in its first segment.

use std::f32::consts::FRAC_PI_2;

/// Largest number of layers, including the ground (Bakay §4.1).
pub const LAYERS_LIMIT: u32 = 65;

/// Tilt of a blade's segments.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tilt {
    /// Tilt of the root, θ₀ (rad); 0 for Bakay.
    pub root_rad: f32,
    /// Wind intensity I, 0..=1; the topmost segment is tilted by a right angle more than the root at 1.
    pub intensity: f32,
    /// Stiffness profile p, greater than −1; 0 for Bakay.
    pub stiffness_profile: f32,
}

impl Tilt {
    /// Tilt of a blade whose segments lean by `lean_rad` on average, 0..=1.5 rad: Bakay's up to π/4, where the tip is horizontal; beyond that the tip
    /// stays horizontal and the root tilts. The mean is that at a stiffness profile of 0; another profile keeps the tilts of root and tip.
    ///
    /// ```
    /// use prairie_core::lod::shells::Tilt;
    /// assert_eq!(Tilt::of_lean(0.0), Tilt { root_rad: 0.0, intensity: 0.0, stiffness_profile: 0.0 });
    /// let laid = Tilt::of_lean(1.5);
    /// assert!(laid.root_rad > 1.4 && laid.intensity < 0.1);
    /// ```
    pub fn of_lean(lean_rad: f32) -> Self {
        let twice = 2.0 * lean_rad.clamp(0.0, 1.5);
        let root_rad = (twice - FRAC_PI_2).max(0.0);
        Self { root_rad, intensity: (twice.min(FRAC_PI_2) - root_rad) / FRAC_PI_2, stiffness_profile: 0.0 }
    }

    /// Tilt of segment `j` of `segments` (rad), θ_j of Bakay §3.2.
    ///
    /// ```
    /// use prairie_core::lod::shells::Tilt;
    /// let stiff = Tilt { intensity: 1.0, stiffness_profile: 2.0, ..Tilt::default() };
    /// assert_eq!(stiff.of_segment_rad(16, 16), std::f32::consts::FRAC_PI_2);
    /// assert!((stiff.of_segment_rad(8, 16) - std::f32::consts::FRAC_PI_2 / 8.0).abs() < 1e-6);
    /// ```
    pub fn of_segment_rad(&self, j: u32, segments: u32) -> f32 {
        let up = j as f32 / segments as f32;
        let share = if self.stiffness_profile == 0.0 { up } else { up.powf(1.0 + self.stiffness_profile) };
        self.root_rad + share * FRAC_PI_2 * self.intensity
    }

    /// Position of layer `i` of `segments` relative to the root along the normal and along the wind, n_i and w_i of Bakay §3.2, in heights of the
    /// blade. With a stiffness profile of 0 the sums are in closed form (Dirichlet's kernel),
    /// `Σ_{j=1..i} cos(θ₀ + jφ) = sin(iφ/2)/sin(φ/2) · cos(θ₀ + (i+1)φ/2)`, so that a layer costs the same at any height; with another one the segments
    /// are added up.
    ///
    /// Its twin on the GPU is `layer_place` in the shells' shader.
    pub fn layer(&self, i: u32, segments: u32) -> [f32; 2] {
        if self.stiffness_profile != 0.0 {
            let tilts = (1..=i).map(|j| self.of_segment_rad(j, segments));
            let [n, w] = tilts.fold([0.0, 0.0], |[n, w], tilt_rad| [n + tilt_rad.cos(), w + tilt_rad.sin()]);
            return [n, w].map(|sum| sum / segments as f32);
        }
        let i = i as f32;
        let half = 0.5 * FRAC_PI_2 * self.intensity / segments as f32;
        let sum = if half > 1e-4 { (i * half).sin() / half.sin() } else { i };
        let middle = self.root_rad + (i + 1.0) * half;
        [middle.cos(), middle.sin()].map(|part| sum * part / segments as f32)
    }
}

/// Drawn layers of `segments`, from the topmost down, if only each `stride`-th is drawn, and the number of segments from each down to the next.
///
/// ```
/// let drawn: Vec<_> = prairie_core::lod::shells::drawn_layers(16, 8).collect();
/// assert_eq!(drawn, [(16, 8), (8, 8)]);
/// ```
pub fn drawn_layers(segments: u32, stride: u32) -> impl Iterator<Item = (u32, u32)> {
    (1..=segments).rev().step_by(stride.max(1) as usize).map(move |layer| (layer, stride.max(1).min(layer)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bakay's profile, floppy and stiff ones.
    const PROFILES: [f32; 5] = [0.0, -0.9, -0.5, 1.0, 4.0];

    fn tilts() -> impl Iterator<Item = Tilt> {
        let over = (0..=40).map(|n| Tilt { intensity: n as f32 / 40.0, ..Tilt::default() });
        let all = over.chain((0..=30).map(|n| Tilt::of_lean(n as f32 * 0.05)));
        all.flat_map(|tilt| PROFILES.map(|stiffness_profile| Tilt { stiffness_profile, ..tilt }))
    }

    #[test]
    fn closed_sums_are_the_sums_and_keep_the_length_of_each_segment() {
        for tilt in tilts() {
            for segments in [1, 2, 3, 8, 16, 32, 64] {
                let [mut n, mut w] = [0.0_f64; 2];
                for i in 1..=segments {
                    let theta = f64::from(tilt.of_segment_rad(i, segments));
                    n += theta.cos() / f64::from(segments);
                    w += theta.sin() / f64::from(segments);
                    let [found_n, found_w] = tilt.layer(i, segments).map(f64::from);
                    assert!((found_n - n).abs() < 1e-6 && (found_w - w).abs() < 1e-6, "{tilt:?}, {i} of {segments}: {found_n}, {found_w}");
                }
                let places: Vec<_> = (0..=segments).map(|i| tilt.layer(i, segments)).collect();
                let length: f32 = places.windows(2).map(|pair| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1])).sum();
                assert!((length - 1.0).abs() < 1e-5, "{tilt:?}: {length} with {segments}");
            }
        }
    }

    #[test]
    fn increments_add_up_to_the_tilt_of_the_tip_and_grow_or_shrink_upwards() {
        for stiffness_profile in PROFILES {
            let tilt = Tilt { intensity: 0.8, stiffness_profile, ..Tilt::default() };
            for segments in [2, 16, 64] {
                let tilts: Vec<_> =
                    std::iter::once(tilt.root_rad).chain((1..=segments).map(|j| tilt.of_segment_rad(j, segments))).collect();
                let increments: Vec<_> = tilts.windows(2).map(|pair| pair[1] - pair[0]).collect();
                let sum: f32 = increments.iter().sum();
                assert!((sum - 0.8 * FRAC_PI_2).abs() < 1e-6, "{stiffness_profile}, {segments} segments: {sum} rad");
                assert!(increments.iter().all(|increment| *increment > 0.0), "{stiffness_profile}: {increments:?}");
                let growth = increments.windows(2).map(|pair| pair[1] - pair[0]);
                let is_as_named = |growth: f32| match stiffness_profile {
                    0.0 => growth.abs() < 1e-6,
                    floppy if floppy < 0.0 => growth < 0.0,
                    _ => growth > 0.0,
                };
                assert!(growth.clone().all(is_as_named), "{stiffness_profile}: {increments:?}");
            }
        }
    }

    #[test]
    fn stiff_grass_bends_up_the_stalk_and_floppy_grass_at_its_foot() {
        let half = |stiffness_profile| Tilt { intensity: 1.0, stiffness_profile, ..Tilt::default() }.of_segment_rad(8, 16) / FRAC_PI_2;
        for (stiffness_profile, share) in
            [(0.0, 0.5), (2.0, 0.125), (4.0, 0.031_25), (-0.5, std::f32::consts::FRAC_1_SQRT_2), (-0.9, 0.933_033)]
        {
            assert!((half(stiffness_profile) - share).abs() < 1e-5, "{stiffness_profile}: {}", half(stiffness_profile));
        }
        // The stiffer, the higher the tip stands in the same wind.
        let high = |stiffness_profile| Tilt { intensity: 1.0, stiffness_profile, ..Tilt::default() }.layer(16, 16)[0];
        assert!([-0.9, -0.5, 0.0, 1.0, 4.0].windows(2).all(|pair| high(pair[0]) + 0.05 < high(pair[1])));
    }

    /// Component of the wind `W` along ground with the unit normal `N`: `W − (W·N)·N` (Bakay §3.2).
    fn along_ground(wind: [f32; 3], normal: [f32; 3]) -> [f32; 3] {
        let across: f32 = (0..3).map(|axis| wind[axis] * normal[axis]).sum();
        std::array::from_fn(|axis| wind[axis] - across * normal[axis])
    }

    #[test]
    fn blades_on_slopes_keep_their_length_in_space() {
        let unit = |v: [f32; 3]| {
            let length = v.iter().map(|x| x * x).sum::<f32>().sqrt();
            v.map(|x| x / length)
        };
        for normal in [[0.0, 1.0, 0.0], [0.6, 0.8, 0.0], [-0.3, 0.9, 0.4]].map(unit) {
            for wind in [[1.0, 0.0, 0.0], [0.3, -0.2, 0.9], [-0.8, 0.1, 0.1]].map(unit) {
                let along = along_ground(wind, normal);
                let across: f32 = (0..3).map(|axis| along[axis] * normal[axis]).sum();
                assert!(across.abs() < 1e-6, "{across}");
                let along = unit(along);
                for tilt in tilts() {
                    let place = |i: u32| -> [f32; 3] {
                        let [n, w] = tilt.layer(i, 16);
                        std::array::from_fn(|axis| n * normal[axis] + w * along[axis])
                    };
                    let of_segment = |i: u32| {
                        let (a, b) = (place(i), place(i + 1));
                        (0..3).map(|axis| (b[axis] - a[axis]).powi(2)).sum::<f32>().sqrt()
                    };
                    assert!((0..16).all(|i| (of_segment(i) * 16.0 - 1.0).abs() < 1e-4), "{tilt:?}");
                    let length: f32 = (0..16).map(of_segment).sum();
                    assert!((length - 1.0).abs() < 2e-6, "{tilt:?}: {length}");
                }
            }
        }
    }

    #[test]
    fn grass_lies_level_at_the_tip_in_a_full_wind_and_wholly_where_it_is_trodden() {
        let full = Tilt::of_lean(std::f32::consts::FRAC_PI_4);
        assert!(full.root_rad.abs() < 1e-6 && (full.of_segment_rad(64, 64) - FRAC_PI_2).abs() < 1e-6);
        // A quarter of a circle is 2/π of its arc high.
        assert!((full.layer(64, 64)[0] - std::f32::consts::FRAC_2_PI).abs() < 0.01);
        assert!(Tilt::of_lean(1.45).layer(64, 64)[0] < 0.13);
        for lean_rad in [0.1, 0.5, 0.8, 1.2, 1.5] {
            let tilt = Tilt::of_lean(lean_rad);
            let mean = (1..=64).map(|j| tilt.of_segment_rad(j, 64)).sum::<f32>() / 64.0;
            assert!((mean - lean_rad).abs() < 0.015, "{mean} instead of {lean_rad}");
        }
    }

    #[test]
    fn drawn_layers_reach_from_the_tips_to_the_ground_without_a_gap() {
        for segments in [1, 8, 16, 21, 64] {
            for stride in [1, 2, 4, 8, 64] {
                let layers: Vec<_> = drawn_layers(segments, stride).collect();
                assert_eq!(layers[0].0, segments);
                assert!(layers.windows(2).all(|pair| pair[0].0 - pair[0].1 == pair[1].0));
                let (lowest, below) = layers[layers.len() - 1];
                assert_eq!(lowest, below);
            }
        }
    }
}
