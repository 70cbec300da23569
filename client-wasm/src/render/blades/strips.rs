//! Triangles of the instances that single plants are drawn as.

use super::CHUNK;

/// Vertices of a flower head; twin of `VERTICES` in `flowers.wgsl`.
const FLOWER_VERTICES: u32 = 67;

/// Triangles of 64 blades of so many rectangles.
pub(super) fn strip_indices(segments: u32) -> Vec<u16> {
    let mut indices = Vec::new();
    for blade in 0..CHUNK {
        for segment in 0..segments {
            let a = 2 * (blade * (segments + 1) + segment);
            indices.extend([a, a + 1, a + 2, a + 2, a + 1, a + 3].map(|i| i as u16));
        }
    }
    indices
}

/// Triangles of 64 flower heads: twelve petals of three triangles and a disc of six.
pub(super) fn flower_indices() -> Vec<u16> {
    let mut indices = Vec::new();
    for head in 0..CHUNK {
        let first = head * FLOWER_VERTICES;
        for petal in 0..12 {
            let a = first + petal * 5;
            indices.extend([a, a + 1, a + 2, a + 1, a + 3, a + 2, a + 2, a + 3, a + 4].map(|i| i as u16));
        }
        let centre = first + 60;
        for i in 0..6 {
            indices.extend([centre, centre + 1 + i, centre + 1 + (i + 1) % 6].map(|i| i as u16));
        }
    }
    indices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_textured_blade_is_of_rectangles_up_to_its_tip() {
        for segments in [3, 7] {
            let list = strip_indices(segments);
            assert_eq!(list.len() as u32, CHUNK * segments * 6);
            let tip = [2 * segments, 2 * segments + 1].map(|i| i as u16);
            assert!(tip.iter().all(|corner| list[..segments as usize * 6].contains(corner)));
        }
    }

    #[test]
    fn indices_stay_within_their_chunk() {
        for (list, vertices) in [(strip_indices(7), 16), (strip_indices(3), 8), (flower_indices(), FLOWER_VERTICES)] {
            let largest = u32::from(*list.iter().max().expect("indices"));
            assert_eq!(largest, CHUNK * vertices - 1);
        }
    }
}
