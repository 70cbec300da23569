//! Pictures joined to one, as rows of tiles.

use anyhow::{Result, bail, ensure};

use super::Picture;

/// Pixels between two tiles, which are white.
const GAP_PX: usize = 6;

impl Picture {
    /// Pictures of one size in rows of `columns`, from the top left on, with white gaps between them and in place of missing ones.
    ///
    /// # Errors
    /// When there is no picture, no column, or the sizes differ.
    pub fn tiled(tiles: &[Self], columns: usize) -> Result<Self> {
        ensure!(!tiles.is_empty() && columns > 0, "{} pictures in {columns} columns", tiles.len());
        let size = |picture: &Self| [picture.width, picture.height];
        if let Some(other) = tiles.iter().find(|tile| size(tile) != size(&tiles[0])) {
            bail!("pictures of {:?} and {:?} px", size(&tiles[0]), size(other));
        }
        let columns = columns.min(tiles.len());
        let [tile_width, tile_height] = size(&tiles[0]).map(|side| side as usize);
        let pitch = [tile_width + GAP_PX, tile_height + GAP_PX];
        let [width, height] = [columns * pitch[0] - GAP_PX, tiles.len().div_ceil(columns) * pitch[1] - GAP_PX];
        let mut rgba = vec![255; 4 * width * height];
        for (n, tile) in tiles.iter().enumerate() {
            let [left, top] = [n % columns * pitch[0], n / columns * pitch[1]];
            for (y, row) in tile.rgba.chunks_exact(4 * tile_width).enumerate() {
                let start = 4 * ((top + y) * width + left);
                rgba[start..start + row.len()].copy_from_slice(row);
            }
        }
        Ok(Self { width: width as u32, height: height as u32, rgba })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_stand_in_rows_with_white_gaps() {
        let grey = |level: u8, width: u32| Picture { width, height: 2, rgba: vec![level; 8 * width as usize] };
        let pair = Picture::tiled(&[grey(9, 3), grey(70, 3)], 2).unwrap();
        assert_eq!([pair.width, pair.height], [12, 2]);
        let levels: Vec<u8> = (0..12).map(|x| pair.pixel(x, 1)[0]).collect();
        assert_eq!(levels, [9, 9, 9, 255, 255, 255, 255, 255, 255, 70, 70, 70]);
        let three = Picture::tiled(&[grey(9, 3), grey(70, 3), grey(30, 3)], 2).unwrap();
        assert_eq!([three.width, three.height], [12, 10]);
        let at = |x, y| three.pixel(x, y)[0];
        assert_eq!([at(0, 1), at(11, 1), at(0, 5), at(0, 8), at(2, 9), at(11, 8)], [9, 70, 255, 30, 30, 255]);
        assert!(Picture::tiled(&[grey(9, 3), grey(9, 4)], 2).is_err());
        assert!(Picture::tiled(&[], 2).is_err() && Picture::tiled(&[grey(9, 3)], 0).is_err());
    }
}
