//! Converts a screenshot for the documents: a JPEG no wider than their text.

use std::path::PathBuf;

use anyhow::Result;
use clap::Parser;
use prairie::charts::image::Picture;

/// Shrinks a PNG to the width that documents show, and writes it as JPEG (or PNG, by the ending of OUT).
#[derive(Parser)]
struct Arguments {
    /// PNG to read, such as a screenshot of the page
    picture: PathBuf,
    /// File to write: .jpg or .png
    out: PathBuf,
    /// Largest width (px)
    #[arg(long, default_value_t = 960, value_parser = clap::value_parser!(u32).range(1..))]
    width: u32,
}

fn main() -> Result<()> {
    let Arguments { picture, out, width } = Arguments::parse();
    Picture::load(&picture)?.shrunk_to_width(width).save(&out)
}
