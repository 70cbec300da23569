//! Summary of the measurements as text.

use std::fmt::Write as _;

use super::files::means;
use super::{Shot, bought};
use crate::charts::texture::Texture;

/// Frame budgets of the summary (ms): 60, 30, 15, 10, 5 and 2 frames per second.
const BUDGETS_MS: [f64; 6] = [16.7, 33.3, 66.7, 100.0, 200.0, 500.0];

/// Means over the views for each method and quality, then the level of detail within each frame budget for the first method.
pub fn summary(shots: &[Shot]) -> String {
    let mut views: Vec<&str> = shots.iter().map(|shot| shot.view.as_str()).collect();
    views.dedup();
    let means = means(shots, views.len());
    let width = means.iter().map(|shot| shot.method.chars().count()).fold(8, usize::max);
    let mut text = format!(
        "{:<width$}  {:<8} {:>9} {:>7} {:>7} {:>7} {:>10} {:>8} {:>9}\n",
        "method", "quality", "ms", "FLIP", "worst", "SSIM", "brightness", "contrast", "gradients"
    );
    for Shot { method, quality, ms, flip, flip_worst, ssim, texture: Texture { brightness, contrast, gradients }, .. } in &means {
        write!(text, "{method:<width$}  {quality:<8} {ms:>9.1} {flip:>7.4} {flip_worst:>7.4} {ssim:>7.4}").expect("a string takes all");
        writeln!(text, " {brightness:>10.4} {contrast:>8.4} {gradients:>9.4}").expect("a string takes all");
    }
    let Some(first) = shots.first() else { return text };
    writeln!(text, "\n{}, mean of the views: what a frame budget buys", first.method).expect("a string takes all");
    for budget_ms in BUDGETS_MS {
        let found: Vec<_> = views
            .iter()
            .filter_map(|view| {
                let of_view: Vec<&Shot> = shots.iter().filter(|shot| shot.view == *view && shot.method == first.method).collect();
                bought(&of_view, budget_ms)
            })
            .collect();
        let count = found.len() as f64;
        let line = if found.is_empty() {
            "kept in no view".to_owned()
        } else {
            let level = found.iter().map(|bought| bought.level).sum::<f64>() / count;
            let flip = found.iter().map(|bought| bought.flip).sum::<f64>() / count;
            let worst = found.iter().map(|bought| bought.flip).fold(0.0, f64::max);
            format!("kept in {} of {} views: level {level:.2}, FLIP {flip:.4}, {worst:.4} at most", found.len(), views.len())
        };
        writeln!(text, "{budget_ms:>6} ms  {line}").expect("a string takes all");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::shot::made_up;
    use super::*;

    #[test]
    fn the_summary_lists_means_and_budgets() {
        let of = |view| [made_up(view, "clumps, cut", 0, 20.0, 0.1), made_up(view, "clumps, cut", 1, 80.0, 0.05)];
        let text = summary(&[of("ant"), of("hill")].concat());
        let line =
            |start: &str| text.lines().find(|line| line.trim_start().starts_with(start)).unwrap_or_else(|| panic!("{start}: {text}"));
        assert_eq!(
            line("clumps, cut  low").split_whitespace().collect::<Vec<_>>()[3..],
            ["20.0", "0.1000", "0.2000", "0.9000", "0.0100", "0.0200", "0.3000"]
        );
        assert_eq!(line("16.7 ms"), "  16.7 ms  kept in no view");
        assert_eq!(line("500 ms"), "   500 ms  kept in 2 of 2 views: level 1.00, FLIP 0.0500, 0.0500 at most");
    }
}
