//! Texture of the shells: cross-sections of blades whose alpha is their height (Bakay, section 3.1), with mip levels (section 3.4).

use crate::render::gpu::constants::SHELL_BLADE_PX;
use crate::render::inputs::random::Random;

/// Side of the texture (px).
pub(crate) const DOTS_PX: u32 = 512;
/// Blades on the texture.
pub(crate) const DOTS: usize = 4096;
/// Mip levels. On a further one, blades would be thinner than a texel.
pub(crate) const LEVELS: usize = 3;
/// Minimum distance between the centres of two blades, and range of their radii (px).
const APART_PX: f32 = 5.6;
const RADIUS_PX: [f32; 2] = [1.7, 2.5];
const _: () = assert!((0.5 * (RADIUS_PX[0] + RADIUS_PX[1]) - SHELL_BLADE_PX).abs() < 1e-6);
/// Height of the edge of a blade relative to its centre; between them it is a parabola.
const EDGE_HEIGHT: f32 = 0.12;

/// Number of the blade that covers a texel.
type Label = u16;
/// Label of the ground between blades.
const GROUND: Label = Label::MAX;

/// A mip level: label, colour and height of each texel.
struct Level {
    side: usize,
    labels: Vec<Label>,
    rgba: Vec<[u8; 4]>,
}

/// Cross-section of a blade.
struct Dot {
    middle_px: [f32; 2],
    radius_px: f32,
}

impl Dot {
    /// Its texels on a repeating texture of this side, with the squared distance from the centre relative to the edge.
    fn texels(&self, side: usize) -> impl Iterator<Item = (usize, f32)> {
        let reach = self.radius_px.ceil() as i32;
        let [x, y] = self.middle_px;
        let wrapped = move |v: i32| v.rem_euclid(side as i32) as usize;
        let around = (-reach..=reach).flat_map(move |dy| (-reach..=reach).map(move |dx| [x.floor() as i32 + dx, y.floor() as i32 + dy]));
        around.filter_map(move |[i, j]| {
            let away = [i as f32 + 0.5 - x, j as f32 + 0.5 - y].map(|v| v / self.radius_px);
            let fraction = away[0] * away[0] + away[1] * away[1];
            (fraction < 1.0).then(|| (wrapped(j) * side + wrapped(i), fraction))
        })
    }
}

/// All levels, finest first. RGB is half the factor on the colour of the grass, A the height relative to the tallest blade. Heights vary by `variation`
/// around their mean.
pub(crate) fn dots(variation: f32) -> Vec<Vec<u8>> {
    levels(variation).into_iter().map(|level| level.rgba.into_flattened()).collect()
}

fn levels(variation: f32) -> Vec<Level> {
    let mut levels = vec![finest(variation)];
    while levels.len() < LEVELS {
        levels.push(coarser(&levels[levels.len() - 1]));
    }
    levels
}

/// The finest level: blades at random positions with a minimum distance, each visible on all levels.
fn finest(variation: f32) -> Level {
    let side = DOTS_PX as usize;
    let mut level = Level { side, labels: vec![GROUND; side * side], rgba: vec![[0; 4]; side * side] };
    let mut random = Random::new(2003);
    let bin_px = DOTS_PX as f32 / 64.0;
    let mut bins: Vec<Vec<[f32; 2]>> = vec![Vec::new(); 64 * 64];
    let mut claimed: [Vec<bool>; LEVELS - 1] = std::array::from_fn(|n| vec![false; (side >> (n + 1)).pow(2)]);
    let mut count = 0;
    while count < DOTS {
        let middle_px = [random.next(), random.next()].map(|v| v * DOTS_PX as f32);
        let dot = Dot { middle_px, radius_px: random.between(RADIUS_PX[0], RADIUS_PX[1]) };
        let bin = middle_px.map(|v| (v / bin_px) as i32);
        let near = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [bin[0] + dx, bin[1] + dy].map(|v| v.rem_euclid(64) as usize)));
        let is_free = near.flat_map(|[i, j]| &bins[j * 64 + i]).all(|other| {
            let apart = [0, 1].map(|axis| {
                let d = (middle_px[axis] - other[axis]).abs();
                d.min(DOTS_PX as f32 - d)
            });
            apart[0].hypot(apart[1]) >= APART_PX
        });
        if !is_free {
            continue;
        }
        let claims = claims(&dot);
        if claims.iter().zip(&claimed).any(|(own, taken)| own.is_empty() || own.iter().any(|&at| taken[at])) {
            continue;
        }
        for (own, taken) in claims.iter().zip(&mut claimed) {
            own.iter().for_each(|&at| taken[at] = true);
        }
        bins[bin[1] as usize * 64 + bin[0] as usize].push(middle_px);
        level.paint(&dot, count as Label, (1.0 - variation * random.between(-1.0, 1.0)) / (1.0 + variation), color(&mut random));
        count += 1;
    }
    level
}

/// Texels of a blade on each of the coarser levels.
fn claims(dot: &Dot) -> [Vec<usize>; LEVELS - 1] {
    let mut side = DOTS_PX as usize;
    let mut own: Vec<usize> = dot.texels(side).map(|(at, _)| at).collect();
    std::array::from_fn(|_| {
        let parents: Vec<usize> = own.iter().map(|at| at / side / 2 * (side / 2) + at % side / 2).collect();
        side /= 2;
        own = parents.iter().copied().filter(|at| parents.iter().filter(|other| *other == at).count() >= 2).collect();
        own.sort_unstable();
        own.dedup();
        own.clone()
    })
}

/// Random factors on the colour of the grass: fresh or dry, light or dark, and sometimes straw.
fn color(random: &mut Random) -> [f32; 3] {
    let light = random.between(0.70, 1.22);
    let dry = if random.next() < 0.06 { [1.55, 1.18, 0.95] } else { [0.84, 0.98, 0.70] };
    let fresh = [1.02, 1.02, 0.92];
    let fraction = random.next();
    std::array::from_fn(|channel| light * (fresh[channel] + (dry[channel] - fresh[channel]) * fraction))
}

impl Level {
    fn paint(&mut self, dot: &Dot, label: Label, height: f32, color: [f32; 3]) {
        let rgb = color.map(|factor| (factor * 127.5).min(255.0) as u8);
        // The ground around it takes its colour, so that filtering adds no other colour.
        let about = Dot { middle_px: dot.middle_px, radius_px: dot.radius_px + 2.0 };
        for (at, _) in about.texels(self.side).filter(|&(at, _)| self.labels[at] == GROUND).collect::<Vec<_>>() {
            self.rgba[at][..3].copy_from_slice(&rgb);
        }
        for (at, fraction) in dot.texels(self.side) {
            let alpha = (height * (1.0 - (1.0 - EDGE_HEIGHT) * fraction) * 255.0).clamp(1.0, 255.0);
            self.labels[at] = label;
            self.rgba[at] = [rgb[0], rgb[1], rgb[2], alpha as u8];
        }
    }
}

/// The next level by Bakay's filter: a texel belongs to a blade if at least two of its four texels do, with their mean colour and maximum height;
/// otherwise it is ground in the mean colour of all four.
fn coarser(finer: &Level) -> Level {
    let side = finer.side / 2;
    let mut level = Level { side, labels: Vec::with_capacity(side * side), rgba: Vec::with_capacity(side * side) };
    for at in 0..side * side {
        let first = at / side * 2 * finer.side + at % side * 2;
        let four = [first, first + 1, first + finer.side, first + finer.side + 1];
        let label = four
            .iter()
            .map(|&at| finer.labels[at])
            .find(|&label| label != GROUND && four.iter().filter(|&&at| finer.labels[at] == label).count() >= 2);
        let own: Vec<[u8; 4]> =
            four.iter().filter(|&&at| label.is_none_or(|label| finer.labels[at] == label)).map(|&at| finer.rgba[at]).collect();
        let mean = |channel: usize| (own.iter().map(|texel| u32::from(texel[channel])).sum::<u32>() / own.len() as u32) as u8;
        let height = own.iter().map(|texel| texel[3]).max().filter(|_| label.is_some()).unwrap_or(0);
        level.labels.push(label.unwrap_or(GROUND));
        level.rgba.push([mean(0), mean(1), mean(2), height]);
    }
    level
}

#[cfg(test)]
mod tests {
    use super::*;

    fn height(level: &Level, label: Label) -> Option<u8> {
        level.labels.iter().zip(&level.rgba).filter(|(found, _)| **found == label).map(|(_, texel)| texel[3]).max()
    }

    #[test]
    fn blades_keep_their_height_on_every_level() {
        let levels = levels(0.4);
        assert_eq!(levels.iter().map(|level| level.side).collect::<Vec<_>>(), [512, 256, 128]);
        let tops = |level: &Level| {
            let mut tops = vec![0; DOTS];
            for (label, texel) in level.labels.iter().zip(&level.rgba).filter(|(label, _)| **label != GROUND) {
                tops[usize::from(*label)] = texel[3].max(tops[usize::from(*label)]);
            }
            tops
        };
        let found: Vec<_> = levels.iter().map(tops).collect();
        assert!(found[0].iter().all(|&top| f32::from(top) > 0.8 * 255.0 * 0.6 / 1.4));
        for coarse in &found[1..] {
            for (fine, coarse) in found[0].iter().zip(coarse) {
                // A blade may lose its central, highest texel.
                assert!(coarse <= fine && f32::from(*coarse) > 0.6 * f32::from(*fine), "{coarse} of {fine}");
            }
            let same = found[0].iter().zip(coarse).filter(|(fine, coarse)| fine == coarse).count();
            assert!(same > DOTS * 9 / 10, "{same} are as high");
        }
    }

    #[test]
    fn a_further_level_would_lose_blades() {
        let last = coarser(&levels(0.4)[LEVELS - 1]);
        let lost = (0..DOTS as Label).filter(|&label| height(&last, label).is_none()).count();
        assert!(lost > DOTS / 4, "{lost}");
    }

    #[test]
    fn alpha_is_zero_only_on_ground_and_blades_do_not_overlap() {
        for level in levels(0.9) {
            assert!(level.labels.iter().zip(&level.rgba).all(|(&label, texel)| (label == GROUND) == (texel[3] == 0)));
        }
        // No blade covers another: the thinnest has nine texels.
        let finest = finest(0.3);
        let mut counts = vec![0; DOTS];
        finest.labels.iter().filter(|label| **label != GROUND).for_each(|&label| counts[usize::from(label)] += 1);
        assert!(counts.iter().all(|count| (6..=24).contains(count)), "{:?}", counts.iter().min());
    }

    #[test]
    fn four_texels_are_filtered_as_bakay_describes() {
        let blade = |height: u8| [100, 50, 10, height];
        let four = |labels: [Label; 4], rgba: [[u8; 4]; 4]| {
            let level = coarser(&Level { side: 2, labels: labels.to_vec(), rgba: rgba.to_vec() });
            (level.labels[0], level.rgba[0])
        };
        let ground = [0, 10, 20, 0];
        assert_eq!(four([3, GROUND, 3, GROUND], [blade(80), ground, [50, 60, 20, 200], ground]), (3, [75, 55, 15, 200]));
        assert_eq!(four([3, GROUND, GROUND, GROUND], [blade(80), ground, ground, ground]), (GROUND, [25, 20, 17, 0]));
        // Two blades with one texel each are both lost.
        assert_eq!(four([3, 4, GROUND, GROUND], [blade(80), blade(90), ground, ground]).0, GROUND);
    }
}
