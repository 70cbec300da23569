//! Soil nutrients (Endo et al. 2003, §5.2): three concentrations for each site, from a picture or generated.

use super::{Lot, Sites};
use crate::hash::hash3;
use crate::scene::Growth;
use crate::terrain::{Decoded, MapError, decode};
use png::{BitDepth, ColorType};

/// Map of three nutrients, stretched over the world and bilinear between pixel centres.
///
/// Takes 1 byte a pixel if it is grey and 3 if it is RGB, 201 MB at most, and no more while it is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NutrientMap {
    size_px: [u32; 2],
    /// Channels per pixel: 1 for all nutrients alike, or 3.
    channels: usize,
    levels: Vec<u8>,
}

impl NutrientMap {
    /// Reads a PNG of 8 bits: RGB for one nutrient each, or grey for all three alike; 255 is a concentration of 1.
    ///
    /// # Errors
    /// [`MapError`] when the bytes are not a PNG of that kind, or its sides are out of range.
    pub fn from_png(png_bytes: &[u8]) -> Result<Self, MapError> {
        let kinds = [(ColorType::Grayscale, BitDepth::Eight), (ColorType::Rgb, BitDepth::Eight)];
        let Decoded { size_px, kind, bytes } = decode(png_bytes, &kinds, "grey or RGB without alpha, 8 bits")?;
        Ok(Self { size_px, channels: kind.0.samples(), levels: bytes })
    }

    /// Concentrations at a position given as a fraction of the world along X and Z; outside the world those of the edge.
    fn at(&self, fraction: [f64; 2]) -> [u16; 3] {
        let [(x, east), (z, south)] = [0, 1].map(|axis| {
            let pixels = self.size_px[axis];
            let at = (fraction[axis] * f64::from(pixels) - 0.5).clamp(0.0, f64::from(pixels - 1));
            let low = (at as u32).min(pixels - 2);
            // In 256ths, so that the sum below is exact.
            (low as usize, ((at - f64::from(low)) * 256.0) as u32)
        });
        let row = self.size_px[0] as usize;
        let north_west = x + z * row;
        let corners = [north_west, north_west + 1, north_west + row, north_west + row + 1];
        let weights = [(256 - east) * (256 - south), east * (256 - south), (256 - east) * south, east * south];
        std::array::from_fn(|nutrient| {
            let level = |pixel: usize| u32::from(self.levels[pixel * self.channels + nutrient % self.channels]);
            let sum: u32 = corners.iter().zip(weights).map(|(&pixel, weight)| level(pixel) * weight).sum();
            (u64::from(sum) * u64::from(u16::MAX) / (255 << 16)) as u16
        })
    }
}

/// Content of three nutrients in the soil of each site; 65535 is a concentration of 1. 6 bytes a site.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Soil(Vec<[u16; 3]>);

/// Octaves of generated soil, each half as large and half as strong as the one before.
const OCTAVES: u32 = 4;

impl Soil {
    /// Soil from a map over a world of `extent_m` (m, X and Z).
    pub fn of_map(map: &NutrientMap, sites: &Sites, extent_m: [f32; 2]) -> Self {
        let fraction = |at_m: [f32; 2]| [0, 1].map(|axis| f64::from(at_m[axis]) / f64::from(extent_m[axis]));
        Self((0..sites.total() as u32).map(|site| map.at(fraction(sites.place_m(site)))).collect())
    }

    /// Soil from the seed of the sites: value noise of mean `growth.richness`, in patches of `growth.patch_m`.
    ///
    /// A mean up to 0.5 spreads the noise from 0 to twice the mean; a higher mean spreads it up to 1 and as far below the mean.
    pub fn generated(growth: &Growth, sites: &Sites) -> Self {
        let richness = growth.richness.map(f64::from);
        let mut octaves: Vec<_> = (0..OCTAVES).map(|octave| Octave::new(octave, growth.patch_m, sites.seed())).collect();
        let mut concentrations = |site| {
            let at_m = sites.place_m(site).map(f64::from);
            let weight_of_all = f64::from((1_u32 << OCTAVES) - 1);
            let noise = octaves.iter_mut().fold([0.0; 3], |sum, octave| {
                let (value, weight) = (octave.at(at_m), octave.weight / weight_of_all);
                std::array::from_fn(|nutrient| sum[nutrient] + weight * value[nutrient])
            });
            std::array::from_fn(|nutrient| {
                let (mean, noise) = (richness[nutrient], noise[nutrient]);
                level(if mean <= 0.5 { 2.0 * mean * noise } else { 1.0 - 2.0 * (1.0 - mean) * (1.0 - noise) })
            })
        };
        Self((0..sites.total() as u32).map(&mut concentrations).collect())
    }

    /// Content of each site, in the order of the sites.
    pub fn levels(&self) -> &[[u16; 3]] {
        &self.0
    }

    pub(super) fn levels_mut(&mut self) -> &mut [[u16; 3]] {
        &mut self.0
    }

    /// Total content of each nutrient over all sites.
    pub fn total(&self) -> [u64; 3] {
        self.0.iter().fold([0; 3], |sum, levels| std::array::from_fn(|nutrient| sum[nutrient] + u64::from(levels[nutrient])))
    }
}

/// A concentration in units of 1/65535, rounded.
pub(super) fn level(concentration: f64) -> u16 {
    (concentration * f64::from(u16::MAX) + 0.5) as u16
}

/// Three smooth noises of one scale, each 0..=1 with a mean of 0.5.
struct Octave {
    weight: f64,
    size_m: f64,
    seed: u32,
    /// The most recently used cell, and the noises at its corners.
    cell: [u32; 2],
    corners: [[f64; 3]; 4],
}

impl Octave {
    fn new(octave: u32, patch_m: f32, seed: u64) -> Self {
        let halvings = f64::from(1 << octave);
        let seed = Lot::Soil.seed(seed).wrapping_add(octave << 8);
        let weight = f64::from(1 << (OCTAVES - 1 - octave));
        Self { weight, size_m: f64::from(patch_m) / halvings, seed, cell: [u32::MAX; 2], corners: [[0.0; 3]; 4] }
    }

    /// The noises at a position (m), cubic between the corners of cells.
    fn at(&mut self, at_m: [f64; 2]) -> [f64; 3] {
        let at = at_m.map(|m| m / self.size_m);
        let cell = at.map(|at| at as u32);
        if cell != self.cell {
            let [x, z] = cell;
            let corner = |[x, z]: [u32; 2]| hash3([x, z, self.seed]).map(|bits| f64::from(bits) / f64::from(u32::MAX));
            self.corners = [[x, z], [x + 1, z], [x, z + 1], [x + 1, z + 1]].map(corner);
            self.cell = cell;
        }
        let [east, south] = [0, 1].map(|axis| {
            let past = at[axis] - f64::from(cell[axis]);
            past * past * (3.0 - 2.0 * past)
        });
        let [nw, ne, sw, se] = self.corners;
        std::array::from_fn(|nutrient| {
            let north = nw[nutrient] + (ne[nutrient] - nw[nutrient]) * east;
            north + (sw[nutrient] + (se[nutrient] - sw[nutrient]) * east - north) * south
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::grey_png;

    fn rgb_png(size_px: [u32; 2], levels: &[u8], kind: ColorType) -> Vec<u8> {
        let mut bytes = vec![];
        let mut encoder = png::Encoder::new(&mut bytes, size_px[0], size_px[1]);
        encoder.set_color(kind);
        encoder.set_depth(BitDepth::Eight);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(levels).unwrap();
        writer.finish().unwrap();
        bytes
    }

    #[test]
    fn grey_stands_for_all_three_and_rgb_for_one_each() {
        let grey = NutrientMap::from_png(&grey_png([2, 2], &[0, 255, 51, 102])).unwrap();
        assert_eq!([grey.at([0.0, 0.0]), grey.at([1.0, 0.0]), grey.at([0.0, 1.0])], [[0; 3], [65535; 3], [13107; 3]]);
        assert_eq!(grey.at([0.5, 0.0])[0], 32767, "half way between the pixels");
        assert_eq!(grey.at([9.0, -9.0]), [65535; 3], "the edge holds outside");
        let rgb = NutrientMap::from_png(&rgb_png([2, 2], &[255, 0, 51, 0, 0, 0, 0, 0, 0, 0, 0, 0], ColorType::Rgb)).unwrap();
        assert_eq!(rgb.at([0.1, 0.1]), [65535, 0, 13107]);
    }

    #[test]
    fn a_fault_names_what_is_wrong_and_what_is_allowed() {
        let fault = |bytes: &[u8]| NutrientMap::from_png(bytes).unwrap_err().to_string();
        let rgba = rgb_png([2, 2], &[0; 16], ColorType::Rgba);
        assert_eq!(fault(&rgba), "is a PNG of kind Rgba 8 bits; allowed: grey or RGB without alpha, 8 bits");
        assert_eq!(fault(&grey_png([1, 4], &[0; 4])), "is 1 × 4 pixels; allowed: 2 × 2 to 8192 × 8192");
        assert!(fault(b"P6").starts_with("is not a readable PNG: "));
        assert!(fault(&crate::terrain::grey_png_16([2, 2], &[0; 4])).starts_with("is a PNG of kind Grayscale 16 bits"));
    }

    #[test]
    fn sides_are_refused_before_any_pixel_is_read() {
        // A file that ends where its pixels begin.
        let told = |width: u32, height: u32| {
            let mut bytes = vec![];
            let mut encoder = png::Encoder::new(&mut bytes, width, height);
            encoder.set_color(ColorType::Rgb);
            let mut writer = encoder.write_header().unwrap();
            writer.write_chunk(png::chunk::IDAT, &[]).unwrap();
            drop(writer);
            NutrientMap::from_png(&bytes).unwrap_err().to_string()
        };
        for (width, height) in [(8193, 2), (2, 8193), (1, 8192), (0x7fff_ffff, 0x7fff_ffff)] {
            assert_eq!(told(width, height), format!("is {width} × {height} pixels; allowed: 2 × 2 to 8192 × 8192"));
        }
        assert!(told(8192, 2).starts_with("is not a readable PNG: "));
    }

    /// Mean concentrations, and the lowest and highest of all.
    fn measure(soil: &Soil) -> ([f64; 3], [u16; 2]) {
        let mean = soil.total().map(|total| total as f64 / 65535.0 / soil.levels().len() as f64);
        let all = soil.levels().iter().flatten();
        (mean, [*all.clone().min().unwrap(), *all.max().unwrap()])
    }

    #[test]
    fn generated_soil_has_the_mean_that_is_asked_for() {
        let sites = Sites::new([400.0, 400.0], 1.0, 3);
        let growth = Growth { richness: [0.2, 0.5, 0.9], patch_m: 4.0, ..Growth::default() };
        let (mean, [low, high]) = measure(&Soil::generated(&growth, &sites));
        for (mean, asked) in mean.into_iter().zip(growth.richness) {
            assert!((mean - f64::from(asked)).abs() < 0.01, "{mean} for {asked}");
        }
        assert!(low < 2000 && high > 64000, "{low}..{high}");
        let none = Growth { richness: [0.0, 0.0, 1.0], ..growth };
        assert!(Soil::generated(&none, &sites).levels().iter().all(|levels| *levels == [0, 0, 65535]));
    }

    #[test]
    fn patches_are_as_large_as_asked() {
        let likeness = |patch_m: f32| {
            let sites = Sites::new([300.0, 300.0], 1.0, 3);
            let soil = Soil::generated(&Growth { patch_m, ..Growth::default() }, &sites);
            let at = |x: usize, z: usize| f64::from(soil.levels()[x + z * 300][0]) / 65535.0 - 0.5;
            let sum = |dx: usize| (0..300).flat_map(|z| (0..290).map(move |x| (x, z))).map(|(x, z)| at(x, z) * at(x + dx, z)).sum::<f64>();
            sum(8) / sum(0)
        };
        let [fine, coarse] = [4.0, 40.0].map(likeness);
        assert!(fine < 0.2 && coarse > 0.7, "8 m apart: {fine} in patches of 4 m, {coarse} in patches of 40 m");
    }
}
