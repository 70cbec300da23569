//! Textures made in code: tileable noise, tufts of far plants, leaves.

/// Side of the noise texture (px).
pub(super) const NOISE_PX: u32 = 256;
/// Size of the tufts' texture (px).
pub(super) const TUFT_PX: [u32; 2] = [1024, 256];
/// Side of the leaf texture (px).
pub(super) const LEAF_PX: u32 = 128;
/// Size of the texture of blades (px): their shapes side by side; twin of `SHAPES` in `blades.wgsl`.
pub(super) const BLADE_PX: [u32; 2] = [64 * 5, 256];
/// Its mip levels, down to 4 px a shape, so that shapes do not run into each other.
const BLADE_LEVELS: usize = 5;

/// A generator of random numbers in 0..1 (splitmix64), the same on every machine.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(super) fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 24) as f32
    }

    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }
}

/// Four channels of tileable fractal value noise, each stretched to its full range: R from 4 periods, G from 8, B from 16,
/// A from 4 with another seed; with all mip levels.
pub(super) fn noise() -> Vec<Vec<u8>> {
    let side = NOISE_PX as usize;
    let channels = [(4, 1, 5), (8, 2, 4), (16, 3, 3), (4, 4, 5)].map(|(period, seed, octaves)| fractal(side, period, seed, octaves));
    let mut texels = vec![0; side * side * 4];
    for (channel, values) in channels.iter().enumerate() {
        for (i, value) in values.iter().enumerate() {
            texels[i * 4 + channel] = (value * 255.0 + 0.5) as u8;
        }
    }
    halved(texels, [NOISE_PX; 2], NOISE_PX.ilog2() as usize + 1)
}

fn fractal(side: usize, period: usize, seed: u64, octaves: u32) -> Vec<f32> {
    let mut sum = vec![0.0; side * side];
    for octave in 0..octaves {
        let cells = period << octave;
        let mut random = Random::new(seed * 977 + u64::from(octave));
        let lattice: Vec<f32> = (0..cells * cells).map(|_| random.next()).collect();
        let weight = 0.5_f32.powi(octave as i32);
        for z in 0..side {
            for x in 0..side {
                let at = |i: usize| i as f32 * cells as f32 / side as f32;
                let (fx, fz) = (at(x), at(z));
                let (x0, z0) = (fx as usize, fz as usize);
                let smooth = |t: f32| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
                let (tx, tz) = (smooth(fx - x0 as f32), smooth(fz - z0 as f32));
                let value = |i: usize, j: usize| lattice[(j % cells) * cells + i % cells];
                let north = value(x0, z0) * (1.0 - tx) + value(x0 + 1, z0) * tx;
                let south = value(x0, z0 + 1) * (1.0 - tx) + value(x0 + 1, z0 + 1) * tx;
                sum[z * side + x] += weight * (north * (1.0 - tz) + south * tz);
            }
        }
    }
    let (low, high) = sum.iter().fold((f32::MAX, f32::MIN), |(low, high), &v| (low.min(v), high.max(v)));
    sum.iter().map(|v| (v - low) / (high - low)).collect()
}

/// Tufts that repeat sideways, with mip levels that keep their cover: height along the plant, hue, petals' share, cover.
pub(super) fn tufts() -> Vec<Vec<u8>> {
    let [width, height] = TUFT_PX.map(|px| px as usize);
    let mut canvas = Canvas { width, height, texels: vec![0; width * height * 4] };
    let mut random = Random::new(71);
    for i in 0..430 {
        let back = i < 210;
        let foot = random.between(0.0, width as f32);
        let tall = height as f32 * if back { random.between(0.45, 0.80) } else { random.between(0.42, 0.98) };
        let lean = random.between(-0.42, 0.42) * tall * random.next().sqrt();
        let wide = random.between(2.2, 4.2);
        canvas.blade(foot, tall, lean, wide, random.next(), if back { 0.82 } else { 1.0 });
    }
    for _ in 0..26 {
        let foot = random.between(0.0, width as f32);
        let tall = height as f32 * random.between(0.55, 0.85);
        canvas.blade(foot, tall, random.between(-8.0, 8.0), 1.6, 0.2, 0.9);
        canvas.dot(foot, tall, random.between(3.5, 5.5), random.next());
    }
    canvas.with_mips()
}

struct Canvas {
    width: usize,
    height: usize,
    texels: Vec<u8>,
}

impl Canvas {
    fn put(&mut self, x: i64, y: i64, texel: [u8; 3]) {
        if y >= 0 && y < self.height as i64 {
            let at = (y as usize * self.width + x.rem_euclid(self.width as i64) as usize) * 4;
            self.texels[at..at + 3].copy_from_slice(&texel);
            self.texels[at + 3] = 255;
        }
    }

    fn blade(&mut self, foot: f32, tall: f32, lean: f32, wide: f32, hue: f32, bright: f32) {
        let steps = tall as i64 * 2;
        for step in 0..steps {
            let t = step as f32 / steps as f32;
            let x = foot + lean * t * t;
            let y = self.height as f32 - 1.0 - tall * (t - 0.12 * (lean / tall).powi(2) * t * t);
            let half = 0.5 * wide * (1.0 - t * t) * (0.8 + 0.5 * t) + 0.25;
            let low = (x - half).round() as i64;
            for px in low..=(x + half).round() as i64 {
                let across = ((px as f32 - x) / half).clamp(-1.0, 1.0);
                let shade = bright * (1.0 + 0.12 * across);
                let level = (tall / self.height as f32 * t * 255.0 * 1.1 * shade).clamp(0.0, 255.0);
                self.put(px, y as i64, [level as u8, (hue * 255.0) as u8, 0]);
            }
        }
    }

    fn dot(&mut self, x: f32, tall: f32, radius: f32, hue: f32) {
        let y = self.height as f32 - 1.0 - tall;
        let reach = radius.ceil() as i64;
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                if ((dx * dx) as f32 + (dy * dy) as f32 * 2.2) < radius * radius {
                    self.put(x as i64 + dx, y as i64 + dy, [255, (hue * 255.0) as u8, 255]);
                }
            }
        }
    }

    /// Box-filtered levels; alpha is scaled so that the share of texels above one half stays that of the finest level.
    fn with_mips(self) -> Vec<Vec<u8>> {
        let share = |texels: &[u8], scale: f32| {
            texels.chunks_exact(4).filter(|t| f32::from(t[3]) * scale >= 127.5).count() as f32 / (texels.len() / 4) as f32
        };
        let cover = share(&self.texels, 1.0);
        let mut levels = vec![self.texels];
        let (mut width, mut height) = (self.width, self.height);
        while width > 8 && height > 8 {
            let finer = levels.last().expect("the finest level is there");
            let (w, h) = (width / 2, height / 2);
            let mut coarse = vec![0; w * h * 4];
            for y in 0..h {
                for x in 0..w {
                    let mut sum = [0_u32; 4];
                    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                        let at = ((2 * y + dy) * width + 2 * x + dx) * 4;
                        let alpha = u32::from(finer[at + 3]);
                        for channel in 0..3 {
                            sum[channel] += u32::from(finer[at + channel]) * alpha;
                        }
                        sum[3] += alpha;
                    }
                    let texel = &mut coarse[(y * w + x) * 4..][..4];
                    for channel in 0..3 {
                        texel[channel] = (sum[channel] / sum[3].max(1)) as u8;
                    }
                    texel[3] = (sum[3] / 4) as u8;
                }
            }
            levels.push(coarse);
            (width, height) = (w, h);
        }
        for level in &mut levels[1..] {
            let (mut low, mut high) = (0.5_f32, 4.0);
            for _ in 0..12 {
                let middle = 0.5 * (low + high);
                if share(level, middle) < cover { low = middle } else { high = middle }
            }
            for texel in level.chunks_exact_mut(4) {
                texel[3] = (f32::from(texel[3]) * low).min(255.0) as u8;
            }
        }
        levels
    }
}

/// The five blades of 000 Fig. 5 b: R light, A where there is one. Tips are above.
pub(super) fn blades() -> Vec<Vec<u8>> {
    let [width, height] = BLADE_PX.map(|px| px as usize);
    let tile = width / 5;
    let mut texels = vec![0; width * height * 4];
    for y in 0..height {
        let up = 1.0 - (y as f32 + 0.5) / height as f32;
        for x in 0..width {
            let across = 2.0 * ((x % tile) as f32 + 0.5) / tile as f32 - 1.0;
            if let Some(light) = blade(x / tile, up, across) {
                let at = (y * width + x) * 4;
                texels[at..at + 4].copy_from_slice(&[(light.clamp(0.0, 1.0) * 255.0) as u8, 0, 0, 255]);
            }
        }
    }
    halved(texels, BLADE_PX, BLADE_LEVELS)
}

/// Mip levels of a picture, each the mean of the one before.
fn halved(texels: Vec<u8>, [mut width, mut height]: [u32; 2], count: usize) -> Vec<Vec<u8>> {
    let mut levels = vec![texels];
    while levels.len() < count {
        let finer = levels.last().expect("the finest level is there");
        let row = width as usize * 4;
        (width, height) = (width / 2, height / 2);
        let mean = |at: usize| {
            let (x, y, channel) = (at / 4 % width as usize, at / 4 / width as usize, at % 4);
            let corner = 2 * y * row + 8 * x + channel;
            let sum: u32 = [0, 4, row, row + 4].map(|beside| u32::from(finer[corner + beside])).iter().sum();
            ((sum + 2) / 4) as u8
        };
        levels.push((0..(width * height * 4) as usize).map(mean).collect());
    }
    levels
}

/// Light of a blade of a shape at a height and a place across, both as shares; none beside it.
fn blade(shape: usize, up: f32, across: f32) -> Option<f32> {
    let taper = (1.0 - up * up).max(0.0);
    // Middle and half-width of each of its leaves.
    let leaf = |middle: f32, half: f32| {
        let off = (across - middle).abs() / half.max(1e-4);
        (off < 1.0).then(|| 0.92 - 0.22 * off * off - if off < 0.09 { 0.2 } else { 0.0 } + 0.05 * (across * 40.0).sin())
    };
    match shape {
        // A plain lance.
        0 => leaf(0.0, 0.55 * taper * (0.7 + 0.6 * up)),
        // Toothed at its edges.
        1 => leaf(0.0, 0.6 * taper * (0.75 + 0.25 * (1.0 - (up * 14.0).fract()))),
        // A fork of two.
        2 => leaf(-0.32 * up, 0.30 * (1.0 - up).sqrt()).or_else(|| leaf(0.42 * up * up, 0.26 * (1.0 - 0.9 * up))),
        // Three slender ones from one foot.
        3 => leaf(-0.62 * up, 0.15 * (1.0 - up * 1.15).max(0.0).sqrt())
            .or_else(|| leaf(0.05 * up, 0.18 * (1.0 - up).sqrt()))
            .or_else(|| leaf(0.66 * up, 0.15 * (1.0 - up * 1.3).max(0.0).sqrt())),
        // A thin stalk with an ear.
        _ if up < 0.7 => leaf(0.0, 0.12),
        _ => leaf(0.0, 0.34 * (1.0 - ((up - 0.85) / 0.15).powi(2)).max(0.0).sqrt() * (0.6 + 0.4 * (up * 60.0).sin().abs())),
    }
}

/// A spray of leaves: light in R, cover in A.
pub(super) fn leaves() -> Vec<Vec<u8>> {
    let side = LEAF_PX as usize;
    let mut canvas = Canvas { width: side, height: side, texels: vec![0; side * side * 4] };
    let mut random = Random::new(5);
    for _ in 0..110 {
        let (angle, radius) = (random.between(0.0, std::f32::consts::TAU), random.next().sqrt() * 48.0);
        let centre = [64.0 + radius * angle.cos(), 64.0 + radius * angle.sin()];
        let turn = random.between(0.0, std::f32::consts::TAU);
        let (long, wide) = (random.between(7.0, 11.0), random.between(3.0, 4.6));
        let light = random.between(90.0, 230.0);
        for y in -12_i64..=12 {
            for x in -12_i64..=12 {
                let (fx, fy) = (x as f32, y as f32);
                let along = fx * turn.cos() + fy * turn.sin();
                let across = -fx * turn.sin() + fy * turn.cos();
                let taper = 1.0 - (along / long).powi(2);
                if taper > 0.0 && across.abs() < wide * taper {
                    let rib = if across.abs() < 0.5 { 0.85 } else { 1.0 };
                    let px = [(centre[0] + fx) as i64, (centre[1] + fy) as i64];
                    if px.iter().all(|&p| p > 0 && p < side as i64 - 1) {
                        canvas.put(px[0], px[1], [(light * rib) as u8, 0, 0]);
                    }
                }
            }
        }
    }
    canvas.with_mips()
}
