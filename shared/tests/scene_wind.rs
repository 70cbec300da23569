//! The wind in scene files: defaults follow from the method, valid combinations are accepted, others rejected.

use prairie_core::scene::{
    Primitive, PrimitiveIntensity, PrimitiveKind, Scene, Wind, WindAdvection, WindBoundary, WindDust, WindMethod, WindPressure, parse,
};

fn scene(more: &str) -> Result<Scene, Vec<String>> {
    let maps = "summary = 's'\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n";
    parse(&format!("{maps}{more}")).map_err(|faults| faults.iter().map(ToString::to_string).collect())
}

fn wind(more: &str) -> Wind {
    scene(more).unwrap_or_else(|faults| panic!("{more}: {faults:?}")).wind
}

/// The only fault of a scene.
fn fault(more: &str) -> String {
    let mut faults = scene(more).expect_err(more);
    assert_eq!(faults.len(), 1, "{more}: {faults:?}");
    faults.remove(0)
}

#[test]
fn defaults_follow_from_the_method() {
    assert_eq!(wind(""), Wind::default());
    assert_eq!(wind("[wind]\nmethod = 'staggered'\n"), Wind::of(WindMethod::Staggered));
    let of_zhang = wind("[wind]\nmethod = 'stable-fluids'\n");
    assert_eq!(of_zhang, Wind::of(WindMethod::StableFluids));
    assert_eq!((of_zhang.advection, of_zhang.pressure), (WindAdvection::SemiLagrangian, WindPressure::GaussSeidel));
    assert_eq!((of_zhang.pressure_sweeps, of_zhang.diffusion_sweeps, of_zhang.canopy_drag_per_m), (20, 20, 0.0));
    assert_eq!(of_zhang.dust, WindDust { advection: WindAdvection::SemiLagrangian, ..WindDust::default() });
}

#[test]
fn stable_fluids_may_be_given_its_own_words() {
    let own = "[wind]\nmethod = 'stable-fluids'\nadvection = 'semi-lagrangian'\ntime = 'split'\ndiffusion = 'gauss-seidel'\n\
               pressure = 'gauss-seidel'\nterrain = 'follow'\ncanopy_drag_per_m = 0\n[wind.faces]\ntop = 'reflect'\n\
               [wind.dust]\nadvection = 'semi-lagrangian'\n";
    assert_eq!(wind(own).faces.top, WindBoundary::Reflect);
    assert_eq!(wind("[wind]\nmethod = 'stable-fluids'\npressure_sweeps = 5\ntiling = 'patch'\n").pressure_sweeps, 5);
}

#[test]
fn an_unknown_method_is_the_only_fault() {
    let unknown = "[wind]\nmethod = 'stable fluids'\nadvection = 'semi-lagrangian'\ntime = 'split'\n";
    assert_eq!(fault(unknown), "`wind.method` is \"stable fluids\"; allowed: \"staggered\" or \"stable-fluids\"");
}

#[test]
fn compatible_faces_are_accepted() {
    for more in [
        "[wind.faces]\nwest = 'inflow'\neast = 'outflow'\nnorth = 'inflow'\nsouth = 'inflow'\ntop = 'outflow'\n",
        "[wind]\nmean_m_per_s = [-4, 0]\n[wind.faces]\nwest = 'outflow'\neast = 'inflow'\nnorth = 'no-slip'\nsouth = 'free-slip'\n",
        "[wind]\nmean_m_per_s = [0, 2.5]\n[wind.faces]\nwest = 'outflow'\neast = 'outflow'\n",
        "[wind]\ncells = [16, 8, 32]\n[wind.faces]\ntop = 'lid'\nbottom = 'no-slip'\nlid_m_per_s = [3, 0, -3]\n",
        "[wind]\nmean_m_per_s = [0, 0]\n[wind.faces]\nwest = 'lid'\neast = 'reflect'\nlid_m_per_s = [0, 1, 1]\n",
        "[wind]\ndiffusion = 'implicit'\n[wind.faces]\nwest = 'inflow'\neast = 'outflow'\n",
    ] {
        wind(more);
    }
    assert_eq!(wind("[wind.faces]\nwest = 'inflow'\neast = 'outflow'\n").faces.wraps(), [false, false, true]);
}

#[test]
fn incompatible_faces_are_rejected() {
    let alone = fault("[wind.faces]\nsouth = 'outflow'\n");
    assert!(alone.starts_with("`wind.faces.south` is \"outflow\", and `wind.faces.north` opposite is \"wrap\""), "{alone}");
    let blocked = fault("[wind.faces]\nwest = 'inflow'\neast = 'free-slip'\n");
    assert!(blocked.starts_with("`wind.faces.west` is \"inflow\", and `wind.faces.east` opposite is \"free-slip\""), "{blocked}");
    let sky = fault("[wind.faces]\ntop = 'wrap'\n");
    assert!(sky.starts_with("`wind.faces.top` is \"wrap\"; allowed: \"free-slip\""), "{sky}");
    let backwards = fault("[wind]\nmean_m_per_s = [-1, 0]\n[wind.faces]\nwest = 'inflow'\neast = 'outflow'\n");
    assert!(backwards.starts_with("`wind.mean_m_per_s[0]` is -1, which enters at `wind.faces.east`"), "{backwards}");
    assert!(backwards.contains("allowed: at least 0"), "{backwards}");
    let half_closed = fault("[wind]\nmean_m_per_s = [0, 2]\n[wind.faces]\nnorth = 'no-slip'\nsouth = 'outflow'\n");
    assert!(half_closed.starts_with("`wind.mean_m_per_s[1]` is 2, and `wind.faces.north` is \"no-slip\"; allowed: 0"), "{half_closed}");
    let small = fault("[wind]\ncells = [32, 8, 31]\n[wind.faces]\nnorth = 'inflow'\nsouth = 'outflow'\n");
    assert!(small.starts_with("`wind.faces.north` is \"inflow\", which needs a box that covers the world: 256 m along Z"), "{small}");
}

#[test]
fn compatible_tiling_and_terrain_are_accepted() {
    for more in [
        "[wind]\ntiling = 'patch'\ncells = [8, 8, 16]\nspacing_m = [2, 2, 3]\n",
        "[wind]\ntiling = 'patch'\ncells = [160, 8, 160]\nspacing_m = [0.1, 1, 0.1]\n",
        "[wind]\ntiling = 'follow'\ncells = [8, 8, 8]\n",
        "[wind]\nterrain = 'obstacle'\npressure = 'multigrid'\n",
        "[wind]\nterrain = 'obstacle'\npressure = 'jacobi'\ndiffusion = 'gauss-seidel'\n",
        "[wind]\nadvection = 'bfecc'\ntime = 'reflection'\n",
        "[wind]\nadvection = 'semi-lagrangian'\ntime = 'split'\n[wind.dust]\nadvection = 'mac-cormack'\n",
    ] {
        wind(more);
    }
    let small = fault("[wind]\ntiling = 'patch'\ncells = [4, 8, 4]\nspacing_m = [0.1, 1, 4]\n");
    assert!(small.contains("0.4 m along X; allowed: a whole number of patches of 16 m"), "{small}");
    let ground = fault("[wind]\nterrain = 'obstacle'\ntiling = 'follow'\npressure = 'sor'\n");
    assert!(ground.starts_with("`wind.tiling` is \"follow\"; allowed with `terrain = \"obstacle\"`: \"box\""), "{ground}");
}

#[test]
fn primitives_are_read_in_order() {
    let list = "[[wind.primitives]]\nkind = 'vortex'\nat_m = [1, 2, 3]\n\
                [[wind.primitives]]\nkind = 'uniform'\nat_m = [256, 16, 256]\nheading_rad = 1\ndrift_m_per_s = [-1, 0.5]\ndust = 1\n";
    let vortex = Primitive::new(PrimitiveKind::Vortex, [1.0, 2.0, 3.0]);
    let uniform = Primitive {
        heading_rad: 1.0,
        drift_m_per_s: [-1.0, 0.5],
        dust: 1.0,
        ..Primitive::new(PrimitiveKind::Uniform, [256.0, 16.0, 256.0])
    };
    assert_eq!(wind(list).primitives, [vortex.clone(), uniform]);
    assert_eq!(wind("[wind]\nprimitives = [{ kind = 'vortex', at_m = [1, 2, 3] }]\n").primitives, [vortex]);
    assert_eq!(wind("[wind]\nprimitives = []\n").primitives, []);
    let written = scene(list).unwrap().to_toml();
    assert_eq!(parse(&written).unwrap(), scene(list).unwrap());
    let sent = postcard::to_stdvec(&scene(list).unwrap()).unwrap();
    assert_eq!(postcard::from_bytes::<Scene>(&sent).unwrap(), scene(list).unwrap());
}

#[test]
fn primitives_have_a_limit_and_are_sections() {
    let many = |n| "[[wind.primitives]]\nkind = 'sink'\nat_m = [1, 2, 3]\n".repeat(n);
    assert_eq!(wind(&many(64)).primitives.len(), 64);
    assert_eq!(fault(&many(65)), "`wind.primitives` has 65 sections; allowed: at most 64");
    let number = fault("[wind]\nprimitives = [3]\n");
    assert_eq!(number, "`wind.primitives[0]` is the number 3; expected at most 64 sections `[[wind.primitives]]`");
    let text = fault("[wind]\nprimitives = 'vortex'\n");
    assert_eq!(text, "`wind.primitives` is text; expected at most 64 sections `[[wind.primitives]]`");
    let outside = fault("[[wind.primitives]]\nkind = 'sink'\nat_m = [1, 2, 256.5]\n");
    assert_eq!(outside, "`wind.primitives[0].at_m[2]` is 256.5; allowed: 0 to 256, the world's extent along Z");
}

#[test]
fn faces_at_the_bottom_and_the_top_are_limited_to_the_listed_conditions() {
    for (face, is_allowed) in [
        ("bottom", WindBoundary::blocks_flow as fn(WindBoundary) -> bool),
        ("top", |condition| condition.blocks_flow() || condition == WindBoundary::Outflow),
    ] {
        let allowed: Vec<_> =
            WindBoundary::ALL.iter().filter(|condition| is_allowed(**condition)).map(|condition| condition.word()).collect();
        for condition in WindBoundary::ALL {
            let faults = scene(&format!("[wind.faces]\n{face} = '{}'\n", condition.word())).err().unwrap_or_default();
            let found = faults.iter().find(|fault| fault.contains(&format!("`wind.faces.{face}` is")));
            assert_eq!(found.is_none(), allowed.contains(&condition.word()), "{face} = {}: {faults:?}", condition.word());
            if let Some(fault) = found {
                let listed: Vec<_> = fault.split_once("allowed: ").unwrap().1.split('"').skip(1).step_by(2).collect();
                assert_eq!(listed, allowed, "{fault}");
            }
        }
    }
}

/// A section of a primitive with these fields.
fn primitive(fields: &str) -> String {
    format!("[[wind.primitives]]\nkind = 'source'\nat_m = [1, 2, 3]\n{fields}\n")
}

#[test]
fn intensities_are_read_and_sent() {
    let steady = Primitive::new(PrimitiveKind::Source, [1.0, 2.0, 3.0]);
    assert_eq!(wind(&primitive("")).primitives, std::slice::from_ref(&steady));
    let gust = Primitive {
        intensity: PrimitiveIntensity::Gust,
        attack_secs: 0.6,
        hold_secs: 0.4,
        fall_secs: 3.0,
        period_secs: 4.0,
        front_m_per_s: 8.0,
        step_m: 2.0,
        ..steady.clone()
    };
    let of_gust = "attack_secs = 0.6\nhold_secs = 0.4\nfall_secs = 3\nperiod_secs = 4\nfront_m_per_s = 8\nstep_m = 2";
    assert_eq!(
        wind(&primitive(&format!("intensity = 'gust'\n{of_gust}"))).primitives,
        std::slice::from_ref(&gust),
        "decimal fractions fill a period"
    );
    let cubic = Primitive { intensity: PrimitiveIntensity::Cubic, ..gust };
    assert_eq!(wind(&primitive(&format!("intensity = 'cubic'\n{of_gust}"))).primitives, [cubic]);
    assert_eq!(wind(&primitive("intensity = 'gust'\nfall_secs = 1")).primitives[0].period_secs, 0.0, "it happens once");
    assert_eq!(wind(&primitive("intensity = 'periodic'\nperiod_secs = 7")).primitives[0].period_secs, 7.0);
    let spline = Primitive {
        intensity: PrimitiveIntensity::Spline,
        period_secs: 9.0,
        intensity_points: vec![[0.0, 0.0], [1.5, 2.0], [8.9, 0.5]],
        ..steady
    };
    let of_spline = primitive("intensity = 'spline'\nperiod_secs = 9\nintensity_points = [[0, 0], [1.5, 2], [8.9, 0.5]]");
    assert_eq!(wind(&of_spline).primitives, [spline]);
    let read = scene(&of_spline).unwrap();
    assert_eq!(parse(&read.to_toml()).unwrap(), read);
    assert_eq!(postcard::from_bytes::<Scene>(&postcard::to_stdvec(&read).unwrap()).unwrap(), read);
}

#[test]
fn fields_that_do_not_fit_an_intensity_are_rejected() {
    for (fields, message) in [
        ("attack_secs = 1", "attack_secs` is 1; allowed with `intensity = \"steady\"`: 0, since that has no use for it"),
        ("front_m_per_s = 8", "front_m_per_s` is 8; allowed with `intensity = \"steady\"`: 0, since that has no use for it"),
        (
            "intensity = 'gust'",
            "attack_secs` is 0, and so are `hold_secs` and `fall_secs`; allowed with `intensity = \"gust\"`: one of them above 0",
        ),
        (
            "intensity = 'cubic'\nattack_secs = 1\nhold_secs = 1\nfall_secs = 3\nperiod_secs = 4",
            "period_secs` is 4; allowed: 0, or at least attack_secs + hold_secs + fall_secs, which is 5",
        ),
        ("intensity = 'gust'\nfall_secs = 1\nstep_m = 2", "step_m` is 2; allowed with `front_m_per_s = 0`: 0, since nothing is delayed"),
        ("intensity = 'periodic'", "period_secs` is 0; allowed with `intensity = \"periodic\"`: above 0, since it repeats"),
        (
            "intensity = 'periodic'\nperiod_secs = 1\nhold_secs = 1",
            "hold_secs` is 1; allowed with `intensity = \"periodic\"`: 0, since that has no use for it",
        ),
        (
            "intensity = 'periodic'\nperiod_secs = 2\nintensity_points = [[0, 0], [1, 1]]",
            "intensity_points` is a list of 2; allowed with `intensity = \"periodic\"`: an empty one, since only \"spline\" has points",
        ),
        (
            "intensity = 'spline'\nperiod_secs = 2",
            "intensity_points` is a list of 0; allowed with `intensity = \"spline\"`: 2 to 32 points",
        ),
        (
            "intensity = 'spline'\nperiod_secs = 2\nintensity_points = [[0, 0], [1, 1], [1, 2]]",
            "intensity_points[2]` is at 1 s; allowed: after 1 s, the time of the point before",
        ),
        (
            "intensity = 'spline'\nperiod_secs = 2\nintensity_points = [[0, 0], [2, 1]]",
            "intensity_points[1]` is at 2 s; allowed: before `period_secs`, 2 s, when the first point comes again",
        ),
    ] {
        assert_eq!(fault(&primitive(fields)), format!("`wind.primitives[0].{message}"), "{fields}");
    }
}

#[test]
fn single_points_are_checked() {
    let spline = |points: &str| fault(&primitive(&format!("intensity = 'spline'\nperiod_secs = 99\nintensity_points = {points}")));
    for (points, message) in [
        ("[[0, nan], [1, 1]]", "intensity_points[0][1]` is nan; allowed: -2 to 2"),
        ("[[0, 0], [1, 2.5]]", "intensity_points[1][1]` is 2.5; allowed: -2 to 2"),
        ("[[0, 0], [-1, 1]]", "intensity_points[1][0]` is -1; allowed: 0 to 86400"),
        ("[[0, 0], [3]]", "intensity_points[1]` is a list of 1; expected a point [secs, intensity]"),
        ("[[0, 0], 3]", "intensity_points[1]` is the number 3; expected a point [secs, intensity]"),
        (
            "3",
            "intensity_points` is the number 3; expected a list of 0 to 32 points [secs, intensity], seconds 0 to 86400 and intensity -2 to 2",
        ),
    ] {
        assert_eq!(spline(points), format!("`wind.primitives[0].{message}"), "{points}");
    }
    let many = format!("[{}]", (0..33).map(|n| format!("[{n}, 1]")).collect::<Vec<_>>().join(", "));
    assert_eq!(spline(&many), "`wind.primitives[0].intensity_points` has 33 points; allowed: 0 to 32");
}
