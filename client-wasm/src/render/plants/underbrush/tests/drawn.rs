//! Drawn rows: how spheres and rain move them, and the capacity for them.

use super::*;

/// A square full of the shipped species, seen by a camera, without wind.
fn garden(change: impl FnOnce(&mut Scene)) -> (Mirror, Camera) {
    let covering: Vec<u8> = (0..256).map(|at| if at % 16 < 8 { 20 } else { 21 }).collect();
    let mirror = meadow_of(
        |scene| {
            scene.wind.mean_m_per_s = [0.0; 2];
            scene.growth.richness = [1.0; 3];
            scene.underbrush = species().into_iter().filter(|species| species.cover > 0).collect();
            change(scene);
        },
        &covering,
    );
    (mirror, Camera { eye_m: Vec3::new(32.0, 1.2, 60.0), ..Camera::default() })
}

fn underbrush(picture: &OffscreenRenderer) -> &Underbrush {
    picture.renderer.scene.as_ref().and_then(|scene| scene.underbrush.as_ref()).expect("underbrush")
}

/// Left borders of the rows of each plant that the newest frame drew (m), by its root and its list.
fn left_borders(gpu: &Gpu, picture: &OffscreenRenderer) -> HashMap<([u32; 2], usize), Vec<[f32; 3]>> {
    let brush = underbrush(picture);
    let words = |buffer: &wgpu::Buffer| bytemuck::pod_collect_to_vec::<u8, u32>(&read(gpu, buffer));
    let (visible, borders) = (read(gpu, &brush.seen.visible_plants), read(gpu, &brush.seen.borders));
    let (visible, borders): (&[VisiblePlant], &[[f32; 8]]) = (bytemuck::cast_slice(&visible), bytemuck::cast_slice(&borders));
    let (listed, counters, owners) = (words(&brush.seen.listed), words(brush.counters()), words(&brush.seen.owners));
    let of_list = |list: usize| {
        let BrushList { rows, first_listed: first, .. } = brush.seen.lists[list];
        let blocks = listed[first as usize..(first + counters[list]) as usize].to_vec();
        blocks.into_iter().map(move |block| (list, block, rows))
    };
    let plant = |(list, block, rows): (usize, u32, u32)| {
        assert!(block + rows.div_ceil(BLOCK) <= brush.room[1], "block {block} is beyond the room");
        let [x, _, z] = visible[owners[block as usize] as usize].root_m;
        let first = 2 * (block * BLOCK) as usize;
        let own = borders[first..first + 2 * rows as usize].iter().step_by(2).map(|&[x, y, z, ..]| [x, y, z]);
        (([x.to_bits(), z.to_bits()], list), own.collect())
    };
    (0..LISTS).flat_map(of_list).map(plant).collect()
}

#[test]
fn leaves_tremble_only_in_rain() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let trembling = |rate_mm_per_h: f32| {
        let (mut mirror, camera) = garden(|scene| scene.rain.rate_mm_per_h = rate_mm_per_h);
        let mut picture = OffscreenRenderer::new(&gpu, [320, 640], Quality::Low);
        let [before, after] = [2.0, 2.3].map(|time_secs| {
            picture.draw(&mut mirror, &camera, time_secs, 0.0);
            left_borders(&gpu, &picture)
        });
        assert!(before.len() > 100 && before.len() == after.len(), "{} and {} plants", before.len(), after.len());
        before.iter().filter(|(plant, rows)| after[*plant] != **rows).count()
    };
    assert_eq!(trembling(0.0), 0);
    assert!(trembling(30.0) > 10);
}

#[test]
fn plants_beside_an_object_are_pushed_aside_and_others_are_not() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    const MONSTERS_M: [[f32; 3]; 3] = [[29.0, 1.0, 54.0], [32.0, 1.0, 56.0], [35.0, 1.0, 53.0]];
    let rows = |monsters_m: &[[f32; 3]]| {
        let (mut mirror, camera) = garden(|_| ());
        show(&mut mirror, monsters_m);
        let mut picture = OffscreenRenderer::new(&gpu, [320, 640], Quality::Low);
        picture.draw(&mut mirror, &camera, 2.0, 0.0);
        left_borders(&gpu, &picture)
    };
    let (alone, beside) = (rows(&[]), rows(&MONSTERS_M));
    let pushed = |is_near: bool| {
        let own = alone.iter().filter(|((root, _), _)| {
            let [x, z] = root.map(f32::from_bits);
            MONSTERS_M.iter().any(|at_m| (x - at_m[0]).hypot(z - at_m[2]) < 6.0) == is_near
        });
        let is_apart = |a: &[f32; 3], b: &[f32; 3]| Vec3::from(*a).distance(Vec3::from(*b)) > 1e-4;
        let is_pushed = |plant, rows: &[[f32; 3]]| beside.get(plant).is_none_or(|then| rows.iter().zip(then).any(|(a, b)| is_apart(a, b)));
        own.filter(|(plant, rows)| is_pushed(*plant, rows)).count()
    };
    assert!(pushed(true) > 10, "{} of {} plants", pushed(true), alone.len());
    assert_eq!(pushed(false), 0);
}

#[test]
fn reserved_blocks_suffice_for_every_request() {
    assert!((0..2000).all(|blocks| room_for(blocks) - room_for(blocks) / 4 >= blocks));
}

#[test]
fn without_room_for_rows_plants_are_drawn_coarsely_or_left_out() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (mut mirror, camera) = garden(|_| ());
    let mut picture = OffscreenRenderer::new(&gpu, [640, 1280], Quality::Low);
    let mut drawn = |room: Option<u32>| {
        let brush = picture.renderer.scene.as_mut().and_then(|scene| scene.underbrush.as_mut());
        brush.into_iter().zip(room).for_each(|(brush, room)| brush.room[1] = room);
        picture.draw(&mut mirror, &camera, 2.0, 0.0);
        let plants = left_borders(&gpu, &picture);
        let asked = bytemuck::pod_collect_to_vec::<u8, u32>(&read(&gpu, underbrush(&picture).counters()))[LISTS];
        let levels: [usize; LEVELS] = std::array::from_fn(|level| plants.keys().filter(|(_, list)| list % LEVELS == level).count());
        (plants.len(), levels, asked)
    };
    let (all, levels, asked) = drawn(None);
    assert!(all > 200 && levels.iter().all(|&count| count > 10), "{levels:?}");
    // A quarter of the capacity is reserved for plants that find no room in the rest.
    let (as_many, coarser, _) = drawn(Some(asked * 6 / 5));
    assert_eq!(as_many, all);
    assert!(coarser[..3].iter().sum::<usize>() < levels[..3].iter().sum() && coarser[3] > levels[3], "{coarser:?} instead of {levels:?}");
    let (few, ..) = drawn(Some(20));
    assert!((1..=20).contains(&few), "{few} plants in 20 blocks");
    assert_eq!(drawn(Some(asked * 4 / 3 + 4)).1, levels);
}
