//! Command line arguments that several programs take.

use clap::builder::{PossibleValuesParser, TypedValueParser};
use prairie_client::render::Quality;

/// Parser of a quality preset by its name.
pub fn quality() -> impl TypedValueParser<Value = Quality> {
    PossibleValuesParser::new(Quality::ALL.map(Quality::name))
        .try_map(|name| Quality::from_name(&name).ok_or_else(|| format!("{name} is not a quality preset")))
}
