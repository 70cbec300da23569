//! Map of the kinds of grass.

use super::{Cover, CoverMap};
use crate::scene::Scene;

/// Kinds of grass over the whole world, as indices in [`Scene::kinds`], one per pixel of the covering map; nearest pixel.
///
/// Painted underbrush has the kind of `[grass]`. Bare ground, trees and stones take the kind of the grass beside them, so that grass leaning over
/// their border is of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct KindMap {
    size_px: [u32; 2],
    kinds: Vec<u8>,
    /// Pixels for each metre along X and Z.
    px_per_m: [f32; 2],
}

/// Distance that a kind extends into bare ground (pixels).
const FRINGE_PX: u32 = 2;

impl KindMap {
    /// The kinds of a scene over its covering map; a single pixel if there is only one kind.
    pub fn new(scene: &Scene, cover: &CoverMap) -> Self {
        if scene.species.is_empty() {
            return Self::uniform();
        }
        let size_px = cover.size_px();
        let kind = |id: u8| scene.is_grass(Cover::from(id)).then(|| scene.kind_of_cover(id));
        let table: [Option<u8>; 256] = std::array::from_fn(|id| kind(id as u8));
        let mut kinds: Vec<_> = cover.ids().iter().map(|&id| table[usize::from(id)]).collect();
        for _ in 0..FRINGE_PX {
            kinds = spread(&kinds, size_px);
        }
        let extent_m = scene.extent_m();
        let px_per_m = [0, 1].map(|axis| size_px[axis] as f32 / extent_m[axis]);
        Self { size_px, kinds: kinds.into_iter().map(Option::unwrap_or_default).collect(), px_per_m }
    }

    /// The kind of `[grass]` everywhere.
    pub fn uniform() -> Self {
        Self { size_px: [1; 2], kinds: vec![0], px_per_m: [0.0; 2] }
    }

    /// Pixels along X and Z.
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Kinds row by row from the north.
    pub fn kinds(&self) -> &[u8] {
        &self.kinds
    }

    /// The kind at `(x_m, z_m)`; beyond the world's edge that of the edge.
    pub fn at(&self, x_m: f32, z_m: f32) -> u8 {
        // Casts saturate at 0.
        let pixel = |axis: usize, m: f32| ((m * self.px_per_m[axis]) as usize).min(self.size_px[axis] as usize - 1);
        self.kinds[pixel(1, z_m) * self.size_px[0] as usize + pixel(0, x_m)]
    }
}

/// Extends the kinds by one pixel into free ones; of several neighbours the first counts, direct ones before diagonal ones.
fn spread(kinds: &[Option<u8>], [width, depth]: [u32; 2]) -> Vec<Option<u8>> {
    const AROUND: [[i64; 2]; 8] = [[0, -1], [-1, 0], [1, 0], [0, 1], [-1, -1], [1, -1], [-1, 1], [1, 1]];
    let (width, depth) = (i64::from(width), i64::from(depth));
    let at = |x: i64, z: i64| {
        let is_inside = (0..width).contains(&x) && (0..depth).contains(&z);
        if is_inside { kinds[(z * width + x) as usize] } else { None }
    };
    let grown = |(i, kind): (usize, &Option<u8>)| {
        let (x, z) = (i as i64 % width, i as i64 / width);
        kind.or_else(|| AROUND.iter().find_map(|[dx, dz]| at(x + dx, z + dz)))
    };
    kinds.iter().enumerate().map(grown).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::parse;
    use crate::terrain::grey_png;

    const MAPS: &str = "summary = 's'\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n";
    const TWO: &str = "[[species]]\nname = 'a'\ncover = 7\n[[species]]\nname = 'b'\ncover = 9\n";

    /// The kinds of a map of 4 × 4 pixels over a world of 256 m.
    fn kinds(species: &str, ids: [u8; 16]) -> KindMap {
        let cover = CoverMap::from_png(&grey_png([4; 2], &ids)).unwrap();
        KindMap::new(&parse(&format!("{MAPS}{species}")).unwrap(), &cover)
    }

    #[test]
    fn bare_ground_and_trees_are_of_a_kind_with_what_grows_beside_them() {
        let map = kinds(TWO, [7, 7, 9, 9, 7, 253, 9, 0, 255, 255, 0, 0, 0, 255, 0, 0]);
        assert_eq!(map.kinds(), [1, 1, 2, 2, 1, 1, 2, 2, 0, 0, 2, 2, 0, 0, 0, 2]);
        assert_eq!([map.at(1.0, 1.0), map.at(130.0, 1.0), map.at(63.0, 129.0)], [1, 2, 0]);
        assert_eq!([map.at(-9.0, -9.0), map.at(999.0, -1.0), map.at(999.0, 999.0)], [1, 2, 2]);
    }

    #[test]
    fn pixels_far_from_any_grass_are_of_the_first_kind() {
        let map = kinds(TWO, [7, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(map.kinds(), [1, 1, 1, 0, 1, 1, 1, 0, 1, 1, 1, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn between_painted_underbrush_grows_the_first_kind() {
        let reed = "[[underbrush]]\nname = 'reed'\ncover = 5\n[[underbrush.components]]\nname = 'stalk'\nkind = 'branch'\n";
        let map = kinds(&format!("{TWO}{reed}"), [7, 7, 5, 5, 7, 5, 5, 0, 9, 9, 0, 0, 9, 9, 0, 0]);
        assert_eq!(map.kinds(), [1, 1, 0, 0, 1, 0, 0, 0, 2, 2, 0, 0, 2, 2, 2, 0]);
    }

    #[test]
    fn a_scene_without_species_has_one_kind() {
        let map = kinds("", [7; 16]);
        assert_eq!((map.size_px(), map.at(200.0, -5.0)), ([1, 1], 0));
    }
}
