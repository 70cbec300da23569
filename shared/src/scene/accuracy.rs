//! Tolerances and budgets from which the server plans the settings that a scene leaves open: the sections `[accuracy]` and `[budget]`.

use serde::{Deserialize, Serialize};

/// Largest allowed errors. With any of them, or a [budget](Budget), the server plans the settings that the scene file does not state; without, nothing is planned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Accuracy {
    /// Relative rms error of the wind that the grass feels, over a pilot run of 2 s: 0.1 to 50 with `%`, such as "5 %". Default empty, no demand.
    pub wind: String,
    /// Error of the bending angle at the clients: 0.05 to 20 with `deg`, such as "1 deg". Default empty, no demand.
    pub bend: String,
    /// Error of a blade relative to its length: of its tip as it swings, and of the strip that is drawn from its curve: 0.1 to 50 with `%`, such as "2 %". Default
    /// empty, no demand.
    pub blades: String,
    /// Mean FLIP error of the picture against the same view in full detail (Andersson et al. 2020), in the worst of ten views of built-in scenes. Default 0, no
    /// demand; allowed 0..=1.
    pub picture: f32,
    /// Cells of the wind where the file states them: `stated` keeps them, `planned` lets the plan divide the same box otherwise. Default `stated`.
    pub cells: String,
}

/// Words of [`Accuracy::cells`].
pub(super) const CELLS: &[&str] = &["stated", "planned"];

impl Default for Accuracy {
    fn default() -> Self {
        let empty = String::new;
        Self { wind: empty(), bend: empty(), blades: empty(), picture: 0.0, cells: CELLS[0].to_owned() }
    }
}

/// Largest allowed costs of the planned settings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Budget {
    /// Mean time of a tick on the server (ms). The plan lets the wind's solver take no more, and details of a run give way where ticks take longer. Default 0, no limit for the plan and half a tick for the run; allowed 0..=1000.
    pub server_ms: f32,
    /// Frame time that automatic quality keeps on clients (ms), at least 1; the page's address wins with `budget`. Default 0: 16.7 on a graphics card, 100 on a
    /// software renderer; allowed 0..=1000.
    pub client_ms: f32,
    /// Mean data to each client (kbit/s), beside the limit of the server: the plan makes the codes of the wind as coarse as its frames need, and in the run wind and
    /// grass get no more; poses of vehicles, and the steps of clients that simulate the grass themselves, go out in any case. Default 0, no limit; allowed
    /// 0..=1000000.
    pub kbit_per_s: f32,
}

/// Tolerances of [`Accuracy`] as numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// Of the wind, relative.
    pub wind: Option<f64>,
    /// Of the bending angle (degrees).
    pub bend_deg: Option<f64>,
    /// Of a blade, relative to its length.
    pub blades: Option<f64>,
    /// Of the picture, mean FLIP.
    pub picture: Option<f64>,
}

/// Range of a relative tolerance (%), and of one of an angle (degrees).
const PERCENT: [f64; 2] = [0.1, 50.0];
const DEGREES: [f64; 2] = [0.05, 20.0];

impl Accuracy {
    /// The tolerances as numbers; a text that is not valid counts as none, which the checks of a scene do not let pass.
    pub fn tolerances(&self) -> Tolerances {
        let of = |text: &str, unit: &str, range| quantity(text, unit, range).ok().flatten();
        Tolerances {
            wind: of(&self.wind, "%", PERCENT).map(|percent| percent / 100.0),
            bend_deg: of(&self.bend, "deg", DEGREES),
            blades: of(&self.blades, "%", PERCENT).map(|percent| percent / 100.0),
            picture: (self.picture > 0.0).then(|| self.picture.into()),
        }
    }

    /// Whether the plan may change cells that the scene file states.
    pub fn plans_cells(&self) -> bool {
        self.cells == CELLS[1]
    }

    /// Fields whose text is not a tolerance, with the message.
    pub(super) fn faults(&self) -> Vec<(&'static str, String)> {
        let texts = [
            ("accuracy.wind", &self.wind, "%", PERCENT),
            ("accuracy.bend", &self.bend, "deg", DEGREES),
            ("accuracy.blades", &self.blades, "%", PERCENT),
        ];
        texts.into_iter().filter_map(|(path, text, unit, range)| Some((path, quantity(text, unit, range).err()?))).collect()
    }
}

impl Budget {
    /// The limits that are set: server (ms), client (ms) and data (kbit/s).
    pub fn limits(&self) -> [Option<f64>; 3] {
        [self.server_ms, self.client_ms, self.kbit_per_s].map(|limit| (limit > 0.0).then(|| limit.into()))
    }
}

/// The number before `unit` in a text, `None` for an empty one.
///
/// # Errors
/// The text and what is allowed, if it is not a plain number in the range, one space or none, and the unit.
fn quantity(text: &str, unit: &str, [low, high]: [f64; 2]) -> Result<Option<f64>, String> {
    if text.is_empty() {
        return Ok(None);
    }
    let number = text.strip_suffix(unit).map(|rest| rest.strip_suffix(' ').unwrap_or(rest));
    let is_plain = |number: &&str| number.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.');
    match number.filter(is_plain).and_then(|number| number.parse().ok()).filter(|value| (low..=high).contains(value)) {
        Some(value) => Ok(Some(value)),
        None => {
            Err(format!("is \"{text}\"; allowed: a number from {low} to {high} with the unit {unit}, such as \"{} {unit}\"", 10.0 * low))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_numbers_with_their_unit() {
        let accuracy = |wind: &str, bend: &str| Accuracy { wind: wind.to_owned(), bend: bend.to_owned(), ..Accuracy::default() };
        let read = accuracy("5 %", "1.5deg").tolerances();
        assert_eq!((read.wind, read.bend_deg, read.blades, read.picture), (Some(0.05), Some(1.5), None, None));
        assert_eq!(Accuracy::default().tolerances(), Tolerances::default());
        for text in
            ["5", "%", "5 deg", "-5 %", "+5 %", "1e1 %", "0.05 %", "51 %", "5  %", "5 % ", " 5 %", "five %", "nan %", "inf %", "٥ %"]
        {
            let faults = accuracy(text, "1 deg").faults();
            assert_eq!(faults.len(), 1, "{text}");
            assert_eq!(faults[0].0, "accuracy.wind");
            assert!(faults[0].1.ends_with("allowed: a number from 0.1 to 50 with the unit %, such as \"1 %\""), "{}", faults[0].1);
        }
    }
}
