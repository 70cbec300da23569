//! Mip levels of RGBA images with 8 bits per channel.

/// `count` mip levels, finest first, each a box filter of the one before.
pub(crate) fn box_mipmaps(texels: Vec<u8>, [mut width, mut height]: [u32; 2], count: usize) -> Vec<Vec<u8>> {
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
