//! Whole numbers as values of options.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Parser of a whole number in `allowed`. Its error always states the allowed range.
pub(super) fn whole<N: FromStr + PartialOrd + Display>(allowed: RangeInclusive<N>) -> impl Fn(&str) -> Result<N, String> + Clone
where
    RangeInclusive<N>: Clone,
{
    move |text| {
        let number = text.parse().ok().filter(|number| allowed.contains(number));
        number.ok_or_else(|| format!("allowed: a whole number from {} to {}", allowed.start(), allowed.end()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_out_of_range_and_other_words_are_refused_alike() {
        let parse = whole::<u16>(1..=60);
        assert_eq!((parse("1"), parse("60")), (Ok(1), Ok(60)));
        for wrong in ["0", "61", "70000", "-1", "1.5", "x", ""] {
            assert_eq!(parse(wrong), Err("allowed: a whole number from 1 to 60".to_owned()), "{wrong}");
        }
    }
}
