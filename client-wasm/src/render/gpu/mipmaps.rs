//! Mip levels of images with 8 bits per channel.

/// `count` mip levels of rows of texels, finest first, each a box filter of the one before. A side that is odd loses its last row.
pub(crate) fn box_mipmaps<const CHANNELS: usize>(texels: Vec<u8>, size_px: [u32; 2], count: usize) -> Vec<Vec<u8>> {
    let [mut width, mut height] = size_px.map(|side| side as usize);
    let mut levels = vec![texels];
    while levels.len() < count {
        let finer = levels.last().expect("the finest level is there");
        let row = width * CHANNELS;
        (width, height) = (width / 2, height / 2);
        let mean = |at: usize| {
            let (x, y, channel) = (at / CHANNELS % width, at / CHANNELS / width, at % CHANNELS);
            let corner = 2 * y * row + 2 * CHANNELS * x + channel;
            let sum: u32 = [0, CHANNELS, row, row + CHANNELS].map(|beside| u32::from(finer[corner + beside])).iter().sum();
            ((sum + 2) / 4) as u8
        };
        levels.push((0..width * height * CHANNELS).map(mean).collect());
    }
    levels
}

/// Number of mip levels of an image, down to one pixel along its shorter side.
pub(crate) fn all_mipmaps(size_px: [u32; 2]) -> usize {
    size_px[0].min(size_px[1]).ilog2() as usize + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_level_is_the_mean_of_four_texels_of_each_channel() {
        let texels = vec![0, 200, 10, 100, 90, 0, /* second row */ 20, 100, 30, 100, 90, 0];
        let levels = box_mipmaps::<2>(texels, [3, 2], all_mipmaps([3, 2]));
        assert_eq!(levels[1..], [vec![15, 125]]);
    }
}
