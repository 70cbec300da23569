//! `prairie schema`: prints the JSON Schema of scene files.

use super::print::print;
use clap::Args;
use prairie_core::scene::SCHEMA;

pub(super) const EXAMPLES: &str = "\
Example:
  prairie schema > scene.schema.json         beside a scene file whose first line is `#:schema ./scene.schema.json`

Editors that know Taplo, such as VS Code with Even Better TOML, then complete and check its fields. `prairie new` writes both.";

/// Arguments of `prairie schema`.
#[derive(Debug, Args)]
pub(super) struct Schema {}

impl Schema {
    pub(super) fn run(self) -> anyhow::Result<()> {
        print(SCHEMA.trim_end())
    }
}
