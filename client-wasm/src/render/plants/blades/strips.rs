//! Index lists of the instances of single plants.

use super::layout::CHUNK;
use crate::render::gpu::constants::{DISC_VERTICES, HEAD_VERTICES, PETAL_VERTICES, PETALS, SQUARE_VERTICES};

/// Triangles of 64 blades with `segments` rectangles each; the last one of a pointed blade is a triangle.
pub(super) fn strip_indices(segments: u32, are_pointed: bool) -> Vec<u16> {
    let point = u32::from(are_pointed);
    let mut indices = Vec::new();
    for blade in 0..CHUNK {
        let first = blade * (2 * (segments + 1) - point);
        let triangles = (0..segments).flat_map(|segment| {
            let a = first + 2 * segment;
            [[a, a + 1, a + 2], [a + 2, a + 1, a + 3]]
        });
        indices.extend(triangles.take((2 * segments - point) as usize).flatten().map(|i| i as u16));
    }
    indices
}

/// Triangles of a chunk of flower heads: petals of three triangles, and a disc.
pub(super) fn head_indices() -> Vec<u16> {
    let mut indices = Vec::new();
    for head in 0..CHUNK {
        let first = head * HEAD_VERTICES;
        for petal in 0..PETALS {
            let a = first + petal * PETAL_VERTICES;
            indices.extend([a, a + 1, a + 2, a + 1, a + 3, a + 2, a + 2, a + 3, a + 4].map(|i| i as u16));
        }
        indices.extend(disc(first + PETALS * PETAL_VERTICES));
    }
    indices
}

/// Triangles of 64 disc-shaped flower heads.
pub(super) fn disc_indices() -> Vec<u16> {
    (0..CHUNK).flat_map(|head| disc(head * DISC_VERTICES)).collect()
}

/// Triangles of 64 square flower heads.
pub(super) fn square_indices() -> Vec<u16> {
    (0..CHUNK).flat_map(|head| [0, 1, 2, 2, 1, 3].map(|corner| (head * SQUARE_VERTICES + corner) as u16)).collect()
}

/// Triangles of a disc around vertex `centre`; its rim are the following vertices.
fn disc(centre: u32) -> impl Iterator<Item = u16> {
    let rim = DISC_VERTICES - 1;
    (0..rim).flat_map(move |i| [centre, centre + 1 + i, centre + 1 + (i + 1) % rim].map(|i| i as u16))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textured_blades_have_rectangles_up_to_the_tip() {
        for segments in [3, 7] {
            let list = strip_indices(segments, false);
            assert_eq!(list.len() as u32, CHUNK * segments * 6);
            let tip = [2 * segments, 2 * segments + 1].map(|i| i as u16);
            assert!(tip.iter().all(|corner| list[..segments as usize * 6].contains(corner)));
        }
    }

    #[test]
    fn pointed_blades_omit_the_degenerate_triangle() {
        for segments in [1, 3, 7] {
            let [pointed, whole] = [true, false].map(|are_pointed| strip_indices(segments, are_pointed));
            let own = (6 * segments - 3) as usize;
            assert_eq!(pointed[..own], whole[..own]);
            assert_eq!(pointed.len(), CHUNK as usize * own);
            assert_eq!(u32::from(pointed[own]), 2 * segments + 1, "the next one's first vertex");
        }
    }

    #[test]
    fn indices_stay_within_their_chunk() {
        let strips = [(strip_indices(7, false), 16), (strip_indices(3, false), 8), (strip_indices(7, true), 15)];
        let heads = [(head_indices(), HEAD_VERTICES), (disc_indices(), DISC_VERTICES), (square_indices(), SQUARE_VERTICES)];
        for (list, vertices) in strips.into_iter().chain(heads) {
            let largest = u32::from(*list.iter().max().expect("indices"));
            assert_eq!(largest, CHUNK * vertices - 1);
        }
    }
}
