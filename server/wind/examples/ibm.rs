use prairie_wind::{Boundary, Config, Gusts, Profile, Solver};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let n: f64 = a[1].parse().unwrap(); // cells per diameter
    let re: f64 = a[2].parse().unwrap();
    let (len, wid): (f64, f64) = (a[3].parse().unwrap(), a[4].parse().unwrap());
    let end: f64 = a[5].parse().unwrap();
    let cfl: f64 = a[6].parse().unwrap();
    let shift: f64 = a.get(7).map_or(0.0, |s| s.parse().unwrap());
    let h = 1.0 / n;
    let config = Config {
        cells: [(len * n) as usize, (wid * n) as usize, 1],
        spacing_m: [h as f32, h as f32, 1.0],
        boundary: [
            [Boundary::Inflow, Boundary::Outflow],
            [if a.get(8).is_some() { Boundary::Outflow } else { Boundary::FreeSlip }; 2],
            [Boundary::Wrap; 2],
        ],
        viscosity_m2_per_s: (1.0 / re) as f32,
        mean_wind_m_per_s: [1.0, 0.0, 0.0],
        profile: Profile::Uniform,
        relaxation_per_s: 0.0,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    };
    let mut air = Solver::<f32>::new(&config).unwrap();
    let c = [len * 0.35 + shift * h, 0.5 * wid + shift * 0.7 * h];
    air.set_walls(|[x, y, _]| ((x - c[0]).powi(2) + (y - c[1]).powi(2)).sqrt() - 0.5, |_| [0.0; 3]).unwrap();
    // a kick
    if re > 50.0 {
        air.set_velocity(|[x, y, _]| {
            let r2 = (x as f64 - c[0] - 1.0).powi(2) + (y as f64 - c[1]).powi(2);
            [1.0, (0.5 * (-r2).exp()) as f32, 0.0]
        });
    }
    let dt = (cfl * h).min(0.2 * h * h * re);
    let t0 = std::time::Instant::now();
    let (mut s, mut cross, mut last, mut cd, mut ncd, mut cl2) = (0u64, vec![], 0.0, 0.0, 0, 0.0f64);
    let mut sweeps = 0;
    let (mut cds, mut start) = (0.0, 0.0);
    while air.time_secs() < end {
        let r = air.step(dt, &[]).unwrap();
        s += 1;
        sweeps += r.pressure_sweeps;
        let f = air.wall_force_m4_per_s2().map(|f| 2.0 * f);
        let t = air.time_secs();
        if last < 0.0 && f[1] >= 0.0 {
            cross.push(t - dt * f[1] / (f[1] - last));
            if t > 0.5 * end {
                if start == 0.0 {
                    start = t;
                    cds = 0.0;
                    ncd = 0;
                    cl2 = 0.0;
                }
                cd = cds / f64::from(ncd.max(1));
            }
        }
        last = f[1];
        cds += f[0];
        ncd += 1;
        cl2 = cl2.max(f[1].abs());
        if s % ((5.0 / dt) as u64) == 0 {
            println!(
                "t {t:.1} cd {:.4} cl {:.4} sweeps {} slip {:.1e} div {:.1e} per step {:.1} ms, mean sweeps {:.1}",
                f[0],
                f[1],
                r.pressure_sweeps,
                r.pressure_residual,
                r.divergence_rms_rel,
                t0.elapsed().as_secs_f64() * 1e3 / s as f64,
                f64::from(sweeps) / s as f64
            );
        }
    }
    let late: Vec<_> = cross.iter().filter(|&&t| t > 0.5 * end).collect();
    if late.len() > 1 {
        println!(
            "St {:.4} mean cd {cd:.4} cl max {cl2:.3} periods {}",
            (late.len() - 1) as f64 / (late[late.len() - 1] - late[0]),
            late.len() - 1
        );
    } else {
        // recirculation length: last negative u behind
        let mut l = 0.0;
        for i in 0..(10.0 * n) as usize {
            let x = 0.5 + (i as f64 + 0.5) * 0.25 * h;
            if air.velocity_at([(c[0] + x) as f32, c[1] as f32, 0.5])[0] < 0.0 {
                l = x - 0.5;
            }
        }
        println!("recirculation {l:.3} D");
    }
}
