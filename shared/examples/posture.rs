//! Postures of a leaf under growing load, as an SVG on standard output: a chain of sections in balance, and the exact elastica's tip as a dot.
//!
//! ```sh
//! cargo run --release -p prairie-core --example posture > posture.svg
//! ```

use prairie_core::plant::underbrush::elastica;
use prairie_core::plant::underbrush::rest::{Load, balanced, joints};

/// Angle of the unbent leaf from upright (rad).
const UNBENT_RAD: f64 = 0.3;

/// Rigidity at the tip as a fraction of that at the base.
const TIP_FRACTION: f64 = 0.5;

/// Pixels per length of the leaf.
const SCALE_PX: f64 = 300.0;

fn main() {
    println!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="-60 -340 420 580" width="420" height="580" font-family="sans-serif" font-size="12">"#
    );
    println!(r##"<rect x="-60" y="-340" width="420" height="580" fill="#fdfcf7"/><path d="M-60 0H360" stroke="#8a7a55"/>"##);
    for (i, weight) in [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0].into_iter().enumerate() {
        let load = Load { spread: weight, tip: 0.0 };
        let points = posture(16, load);
        let path: Vec<String> = points.iter().map(|[x, y]| format!("{:.1} {:.1}", SCALE_PX * x, -SCALE_PX * y)).collect();
        let color = format!("hsl({} 60% 33%)", 130 - 13 * i);
        println!(r#"<path d="M{}" fill="none" stroke="{color}" stroke-width="2"/>"#, path.join("L"));
        let [x, y] = elastica::tip(TIP_FRACTION, load, UNBENT_RAD).map(|length| SCALE_PX * length);
        println!(r#"<circle cx="{x:.1}" cy="{:.1}" r="4" fill="none" stroke="{color}"/>"#, -y);
        println!(r#"<text x="{:.1}" y="{:.1}" fill="{color}">Λ = {weight}</text>"#, x + 8.0, 4.0 - y);
    }
    println!("</svg>");
}

/// Joints of a leaf of length 1 from its foot to its tip, in balance with `load`.
fn posture(sections: usize, load: Load) -> Vec<[f64; 2]> {
    let mut bends_rad = vec![0.0; sections];
    balanced(&joints(sections, TIP_FRACTION), load, UNBENT_RAD, &mut bends_rad);
    let length = 1.0 / sections as f64;
    let tips = bends_rad.iter().scan([0.0; 2], |[x, y], bend_rad| {
        (*x, *y) = (*x + length * (UNBENT_RAD + bend_rad).sin(), *y + length * (UNBENT_RAD + bend_rad).cos());
        Some([*x, *y])
    });
    std::iter::once([0.0; 2]).chain(tips).collect()
}
