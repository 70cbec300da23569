//! Grid lines and labels of a logarithmic axis.

/// A grid line of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Value.
    pub value: f64,
    /// Label; `None` for a minor line.
    pub label: Option<String>,
}

/// Multiples of the powers of ten in a range; on the longest axes only the powers. Long axes label the powers, shorter ones also 2 and 5 times them, the
/// shortest every multiple.
pub fn ticks((least, most): (f64, f64)) -> Vec<Tick> {
    let decades = (most / least).log10();
    let labelled: &[i32] = match decades {
        d if d > 2.5 => &[1],
        d if d > 0.9 => &[1, 2, 5],
        _ => &[1, 2, 3, 4, 5, 6, 7, 8, 9],
    };
    let powers = least.log10().floor() as i32..=most.log10().floor() as i32;
    let all = powers.flat_map(|power| {
        (1..if decades > 8.0 { 2 } else { 10 }).map(move |digit| {
            // Parsed, so that each number is the one nearest to its printed form.
            let value = format!("{digit}e{power}").parse().expect("a number");
            Tick { value, label: labelled.contains(&digit).then(|| label(digit, power)) }
        })
    });
    all.filter(|tick| (least..=most).contains(&tick.value)).collect()
}

/// Plain number from 0.001 to below 1000, otherwise like `2·10⁻⁴`.
fn label(digit: i32, power: i32) -> String {
    match power {
        -3..=-1 => format!("0.{}{digit}", "0".repeat((-1 - power) as usize)),
        0..=2 => format!("{digit}{}", "0".repeat(power as usize)),
        _ if digit == 1 => format!("10{}", superscript(power)),
        _ => format!("{digit}·10{}", superscript(power)),
    }
}

fn superscript(power: i32) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    power.to_string().chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(range: (f64, f64)) -> Vec<String> {
        ticks(range).into_iter().filter_map(|tick| tick.label).collect()
    }

    #[test]
    fn the_labels_fit_the_length_of_the_axis() {
        assert_eq!(labels((3e-5, 20.0)), ["10⁻⁴", "0.001", "0.01", "0.1", "1", "10"]);
        assert_eq!(labels((4e-3, 0.11)), ["0.005", "0.01", "0.02", "0.05", "0.1"]);
        assert_eq!(labels((1.5e-5, 3e-4)), ["2·10⁻⁵", "5·10⁻⁵", "10⁻⁴", "2·10⁻⁴"]);
        assert_eq!(labels((250.0, 1100.0)), ["300", "400", "500", "600", "700", "800", "900", "10³"]);
    }

    #[test]
    fn the_longest_axes_have_lines_at_powers_alone() {
        let values: Vec<f64> = ticks((0.5e-9, 2.0)).into_iter().map(|tick| tick.value).collect();
        assert_eq!(values, [1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1.0]);
    }

    #[test]
    fn there_is_a_line_at_every_multiple_in_the_range() {
        let values: Vec<f64> = ticks((0.07, 3.0)).into_iter().map(|tick| tick.value).collect();
        assert_eq!(values, [0.07, 0.08, 0.09, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 2.0, 3.0]);
    }
}
