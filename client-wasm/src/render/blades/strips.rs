//! Triangles of the instances that single plants are drawn as.

use super::CHUNK;

/// Vertices of a flower head, and of one that is a disc; twins of `VERTICES` and `DISC_VERTICES` in `flowers.wgsl`.
const HEAD_VERTICES: u32 = 67;
const DISC_VERTICES: u32 = 7;

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
pub(super) fn head_indices() -> Vec<u16> {
    let mut indices = Vec::new();
    for head in 0..CHUNK {
        let first = head * HEAD_VERTICES;
        for petal in 0..12 {
            let a = first + petal * 5;
            indices.extend([a, a + 1, a + 2, a + 1, a + 3, a + 2, a + 2, a + 3, a + 4].map(|i| i as u16));
        }
        indices.extend(disc(first + 60));
    }
    indices
}

/// Triangles of 64 flower heads that are but discs.
pub(super) fn disc_indices() -> Vec<u16> {
    (0..CHUNK).flat_map(|head| disc(head * DISC_VERTICES)).collect()
}

/// A disc of six triangles: its centre is the vertex of that number, its rim those that follow.
fn disc(centre: u32) -> impl Iterator<Item = u16> {
    (0..6).flat_map(move |i| [centre, centre + 1 + i, centre + 1 + (i + 1) % 6].map(|i| i as u16))
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
        let lists = [(strip_indices(7), 16), (strip_indices(3), 8), (head_indices(), HEAD_VERTICES), (disc_indices(), DISC_VERTICES)];
        for (list, vertices) in lists {
            let largest = u32::from(*list.iter().max().expect("indices"));
            assert_eq!(largest, CHUNK * vertices - 1);
        }
    }
}
