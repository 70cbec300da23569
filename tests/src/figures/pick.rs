//! Finding a figure in the output of a command.

use anyhow::{Context as _, Result, ensure};

/// Place of a figure in the output of a command.
#[derive(Clone, Copy, Debug)]
pub enum Pick {
    /// The rest of every line that contains this text, from behind the text.
    After(&'static str),
    /// Criterion's estimate of the benchmark of this name.
    Estimate(&'static str),
    /// Criterion's estimate of the first benchmark over that of the second: how many times faster the second is.
    Ratio(&'static str, &'static str),
}

impl Pick {
    /// The figure, as it was printed.
    ///
    /// # Errors
    /// When the output does not contain it.
    pub fn find(self, output: &str) -> Result<String> {
        match self {
            Self::After(text) => {
                let rests = output.lines().filter_map(|line| line.split_once(text)).map(|(_, rest)| tidied(rest));
                let found = rests.collect::<Vec<_>>();
                ensure!(!found.is_empty(), "no line contains `{text}`");
                Ok(found.join("; "))
            }
            Self::Estimate(name) => estimate(output, name).map(str::to_owned),
            Self::Ratio(slow, fast) => {
                let secs = |name| estimate(output, name).and_then(secs_of);
                Ok(format!("{:.1} times faster", secs(slow)? / secs(fast)?))
            }
        }
    }
}

/// A line without repeated spaces and the borders of tables.
fn tidied(line: &str) -> String {
    let cells = line.split('|').map(|cell| cell.split_whitespace().collect::<Vec<_>>().join(" "));
    cells.filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(", ")
}

/// The middle of criterion's `time: [low estimate high]` behind the name of a benchmark.
fn estimate<'a>(output: &'a str, name: &str) -> Result<&'a str> {
    let missing = || format!("there is no estimate of the benchmark `{name}`");
    let is_named = |line: &&str| line.trim_start().strip_prefix(name).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '));
    let start = output.lines().position(|line| is_named(&line) && !line.contains("Benchmarking")).with_context(missing)?;
    let times = output.lines().skip(start).take(2).find_map(|line| line.split_once("time:")).with_context(missing)?.1;
    let inner = times.split(['[', ']']).nth(1).with_context(missing)?;
    // Three times, each a number and its unit.
    let (second, third) = inner.match_indices(' ').nth(1).zip(inner.match_indices(' ').nth(3)).with_context(missing)?;
    Ok(inner[second.0..third.0].trim())
}

/// Seconds of `12.3 µs`.
fn secs_of(time: &str) -> Result<f64> {
    let (number, unit) = time.split_once(' ').with_context(|| format!("`{time}` is not a time"))?;
    let unit_secs = match unit {
        "ps" => 1e-12,
        "ns" => 1e-9,
        "µs" | "us" => 1e-6,
        "ms" => 1e-3,
        "s" => 1.0,
        _ => anyhow::bail!("`{unit}` is not a unit of time"),
    };
    Ok(number.parse::<f64>()? * unit_secs)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUTPUT: &str = "\
triad on 1 threads: 20.1 GB/s
Benchmarking wind step/conservative, 1 threads/8x8x8
wind step/conservative, 1 threads/8x8x8
                        time:   [65.0 µs 66.5 µs 67.2 µs]
codec/encode            time:   [1.0 ms 1.33 ms 2.0 ms]
|     225 | Substepped, 4 sub-steps |       1 |     8.000 |
|     225 | Substepped, 4 sub-steps |       2 |     4.100 |
";

    #[test]
    fn lines_and_estimates_are_found() -> Result<()> {
        assert_eq!(Pick::After("triad on 1 threads: ").find(OUTPUT)?, "20.1 GB/s");
        assert_eq!(Pick::After("| Substepped, 4 sub-steps").find(OUTPUT)?, "1, 8.000; 2, 4.100");
        assert_eq!(Pick::Estimate("wind step/conservative, 1 threads/8x8x8").find(OUTPUT)?, "66.5 µs");
        assert_eq!(Pick::Ratio("codec/encode", "wind step/conservative, 1 threads/8x8x8").find(OUTPUT)?, "20.0 times faster");
        Ok(())
    }

    #[test]
    fn missing_figures_are_named() {
        let error = |pick: Pick| pick.find(OUTPUT).expect_err("it is not there").to_string();
        assert_eq!(error(Pick::After("nothing")), "no line contains `nothing`");
        assert_eq!(error(Pick::Estimate("codec/enc")), "there is no estimate of the benchmark `codec/enc`");
    }
}
