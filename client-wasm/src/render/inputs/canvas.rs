//! Canvas for procedural textures that repeat sideways.

/// An RGBA image with 8 bits per channel. Alpha is coverage.
pub(crate) struct Canvas {
    width: usize,
    height: usize,
    texels: Vec<u8>,
}

impl Canvas {
    /// An empty canvas.
    pub(crate) fn new([width, height]: [u32; 2]) -> Self {
        let [width, height] = [width as usize, height as usize];
        Self { width, height, texels: vec![0; width * height * 4] }
    }

    /// Sets an opaque texel; `x` wraps around, rows outside are ignored.
    pub(crate) fn put(&mut self, x: i64, y: i64, texel: [u8; 3]) {
        if y >= 0 && y < self.height as i64 {
            let at = (y as usize * self.width + x.rem_euclid(self.width as i64) as usize) * 4;
            self.texels[at..at + 3].copy_from_slice(&texel);
            self.texels[at + 3] = 255;
        }
    }

    /// Draws a blade of grass that stands on the lower edge. Red is height, green the hue.
    pub(crate) fn blade(&mut self, foot: f32, tall: f32, lean: f32, wide: f32, hue: f32, bright: f32) {
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

    /// Draws a flower head, flagged in blue.
    pub(crate) fn dot(&mut self, x: f32, tall: f32, radius: f32, hue: f32) {
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

    /// Box-filtered mip levels. Alpha is scaled so that the fraction of texels above one half stays that of the finest level.
    pub(crate) fn with_mips(self) -> Vec<Vec<u8>> {
        let fraction = |texels: &[u8], scale: f32| {
            texels.chunks_exact(4).filter(|t| f32::from(t[3]) * scale >= 127.5).count() as f32 / (texels.len() / 4) as f32
        };
        let cover = fraction(&self.texels, 1.0);
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
                if fraction(level, middle) < cover { low = middle } else { high = middle }
            }
            for texel in level.chunks_exact_mut(4) {
                texel[3] = (f32::from(texel[3]) * low).min(255.0) as u8;
            }
        }
        levels
    }
}
