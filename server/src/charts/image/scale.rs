//! Shrinking pictures in linear light.

use super::Picture;

impl Picture {
    /// The picture at a smaller width (px) with the same proportions, or unchanged if it is no wider. Each pixel is the mean, in linear light, of the
    /// area it covers.
    #[must_use]
    pub fn shrunk_to_width(self, width: u32) -> Self {
        if width == 0 || self.width <= width {
            return self;
        }
        let height = (f64::from(self.height) * f64::from(width) / f64::from(self.width)).round().max(1.0) as u32;
        let [columns, rows] = [covered(self.width, width), covered(self.height, height)];
        let linear: Vec<f32> = (0..=255_u8).map(linear_of).collect();
        let mean = |row: &[(u32, f32)], column: &[(u32, f32)], channel: usize| {
            let light = row.iter().map(|(y, weight_y)| {
                let along = column.iter().map(|(x, weight_x)| weight_x * linear[usize::from(self.pixel(*x, *y)[channel])]);
                weight_y * along.sum::<f32>()
            });
            level_of(light.sum())
        };
        let pixels = rows.iter().flat_map(|row| columns.iter().map(move |column| (row, column)));
        let rgba = pixels.flat_map(|(row, column)| [mean(row, column, 0), mean(row, column, 1), mean(row, column, 2), 255]).collect();
        Self { width, height, rgba }
    }

    /// A picture `factor` times smaller on each side; each pixel is the mean of `factor`² in linear light.
    #[must_use]
    pub fn averaged(&self, factor: u32) -> Self {
        let linear: Vec<f32> = (0..=255_u8).map(linear_of).collect();
        let [width, height] = [self.width / factor, self.height / factor];
        let mean = |x: u32, y: u32, channel: usize| {
            let levels = (0..factor * factor).map(|n| self.pixel(x * factor + n % factor, y * factor + n / factor)[channel]);
            level_of(levels.map(|level| linear[usize::from(level)]).sum::<f32>() / (factor * factor) as f32)
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| [x, y]));
        Self { width, height, rgba: pixels.flat_map(|[x, y]| [mean(x, y, 0), mean(x, y, 1), mean(x, y, 2), 255]).collect() }
    }
}

/// For each of `to` equal intervals over `from` pixels: the pixels that it covers, each with its fraction of the interval.
fn covered(from: u32, to: u32) -> Vec<Vec<(u32, f32)>> {
    let length = f64::from(from) / f64::from(to);
    let interval = |n: u32| {
        let [start, end] = [f64::from(n) * length, f64::from(n + 1) * length];
        let pixels = start as u32..from.min(end.ceil() as u32);
        pixels.map(|x| (x, ((end.min(f64::from(x + 1)) - start.max(f64::from(x))) / length) as f32)).collect()
    };
    (0..to).map(interval).collect()
}

/// Linear light, 0 to 1, of an sRGB level (IEC 61966-2-1).
fn linear_of(level: u8) -> f32 {
    let level = f32::from(level) / 255.0;
    if level <= 0.04045 { level / 12.92 } else { ((level + 0.055) / 1.055).powf(2.4) }
}

/// sRGB level of linear light: the inverse of [`linear_of`].
fn level_of(linear: f32) -> u8 {
    let level = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (255.0 * level).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_survive_linear_light() {
        assert!((0..=255).all(|level| level_of(linear_of(level)) == level));
    }

    #[test]
    fn pixels_are_averaged_in_linear_light() {
        let rgba = [[0, 255, 40, 255], [255, 255, 40, 255], [255, 0, 40, 255], [0, 0, 40, 255]].concat();
        let two = Picture { width: 2, height: 2, rgba };
        // Half of the light of white is level 188.
        let one = Picture { width: 1, height: 1, rgba: vec![188, 188, 40, 255] };
        assert_eq!(two.averaged(2), one);
        assert_eq!(two.shrunk_to_width(1), one);
    }

    #[test]
    fn every_pixel_counts_once_in_a_shrunk_picture() {
        for (from, to) in [(1280, 960), (1600, 960), (7, 3), (5, 5)] {
            let mut weights = vec![0.0; from as usize];
            for (x, weight) in covered(from, to).iter().flatten() {
                weights[*x as usize] += weight * from as f32 / to as f32;
            }
            assert!(weights.iter().all(|weight| (weight - 1.0).abs() < 1e-3), "{from} to {to}: {weights:?}");
        }
        let grey = Picture { width: 8, height: 4, rgba: [90, 90, 90, 255].repeat(32) };
        assert_eq!(grey.clone().shrunk_to_width(3), Picture { width: 3, height: 2, rgba: [90, 90, 90, 255].repeat(6) });
        assert_eq!(grey.clone().shrunk_to_width(8), grey, "a picture is never enlarged");
    }
}
