//! The client's files, embedded in the binary by `build.rs`.

use super::encoding::Encoding;

/// One embedded file.
#[derive(Clone, Copy, Debug)]
pub struct Asset {
    /// Value of the `Content-Type` header.
    pub content_type: &'static str,
    /// Whether its name contains a hash of its contents, so that browsers may keep it forever.
    pub is_immutable: bool,
    /// The uncompressed file.
    pub bytes: &'static [u8],
    /// The file compressed with brotli; `None` if that does not make it smaller.
    pub brotli: Option<&'static [u8]>,
    /// The file compressed with gzip; `None` if that does not make it smaller.
    pub gzip: Option<&'static [u8]>,
    /// Hash of [`bytes`](Self::bytes).
    pub hash: &'static str,
}

impl Asset {
    /// The file in an encoding, if it exists in that.
    pub(super) fn encoded(&self, encoding: Encoding) -> Option<&'static [u8]> {
        match encoding {
            Encoding::Brotli => self.brotli,
            Encoding::Gzip => self.gzip,
            Encoding::Identity => Some(self.bytes),
        }
    }
}

/// The page of charts.
pub(super) const CHARTS: &str = "charts.html";

const ASSETS: &[(&str, Asset)] = include!(concat!(env!("OUT_DIR"), "/client.rs"));

/// The embedded file at the path of a request, with or without its leading slash; `/` is `index.html`.
#[must_use]
pub fn asset(path: &str) -> Option<&'static Asset> {
    let name = match path.strip_prefix('/').unwrap_or(path) {
        "" => "index.html",
        name => name,
    };
    ASSETS.iter().find(|(known, _)| *known == name).map(|(_, asset)| asset)
}

#[cfg(test)]
#[path = "../../build/fingerprint.rs"]
mod fingerprint;

#[cfg(test)]
mod tests {
    use super::fingerprint::{Files, fingerprinted};
    use super::*;

    #[test]
    fn the_root_path_is_the_page() {
        let page = asset("/").expect("every build embeds a page");
        assert_eq!(page.content_type, "text/html; charset=utf-8");
        assert_eq!(page.hash, asset("/index.html").expect("the same page").hash);
        assert!(!page.is_immutable);
    }

    #[test]
    fn only_embedded_files_are_served() {
        for path in ["/nothing", "/../Cargo.toml", "/index.html.gz", "/index.html/"] {
            assert!(asset(path).is_none(), "{path}");
        }
    }

    #[test]
    fn every_file_is_complete_and_has_a_unique_hash() {
        for (name, asset) in ASSETS {
            assert!(!asset.bytes.is_empty(), "{name}");
            assert!(asset.gzip.is_none_or(|gzip| gzip[..2] == [0x1f, 0x8b]), "{name}: gzip magic");
            assert!(asset.brotli.is_none_or(|brotli| brotli.len() < asset.bytes.len()), "{name}");
            assert_eq!(ASSETS.iter().filter(|(_, other)| other.hash == asset.hash).count(), 1, "{name}");
            assert_eq!(asset.is_immutable, !["index.html", CHARTS].contains(name), "{name}");
            assert!(!asset.is_immutable || name.contains(asset.hash), "{name} is named after other contents");
        }
    }

    fn files(texts: &[(&str, &str)]) -> Files {
        texts.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec())).collect()
    }

    /// Name and text of the only file whose name begins with `stem`.
    fn named<'a>(files: &'a Files, stem: &str) -> (&'a str, &'a str) {
        let mut found = files.iter().filter(|(name, _)| name.starts_with(stem));
        let (name, bytes) = found.next().expect(stem);
        assert!(found.next().is_none(), "{stem} exists twice");
        (name, str::from_utf8(bytes).expect("text"))
    }

    #[test]
    fn every_reference_names_the_contents_of_its_file() {
        let before = files(&[
            ("index.html", "<link href=\"look.css\"><script src='start.js'></script>"),
            ("look.css", "body { background: url(icon.svg) }"),
            ("icon.svg", "<svg/>"),
            ("start.js", "import { a } from \"./part.js\"; fetch('part_bg.wasm'); const other = \"apart.js.\" + x.png;"),
            ("part.js", "export const a = 'part';"),
            ("part_bg.wasm", "\0asm"),
        ]);
        let after = fingerprinted(&before).expect("all references exist");
        assert_eq!(after.len(), before.len());
        let [(css, look), (js, start), (svg, _), (part, _), (wasm, _)] =
            ["look.", "start.", "icon.", "part.", "part_bg."].map(|stem| named(&after, stem));
        assert_eq!(named(&after, "index.html"), ("index.html", &*format!("<link href=\"{css}\"><script src='{js}'></script>")));
        assert_eq!(look, format!("body {{ background: url({svg}) }}"));
        assert_eq!(start, format!("import {{ a }} from \"./{part}\"; fetch('{wasm}'); const other = \"apart.js.\" + x.png;"));

        let mut changed = before;
        changed.insert("part.js".to_owned(), b"export const a = 2;".to_vec());
        let changed = fingerprinted(&changed).expect("all references exist");
        for (stem, is_changed) in [("part.", true), ("start.", true), ("look.", false), ("part_bg.", false)] {
            assert_eq!(named(&changed, stem).0 != named(&after, stem).0, is_changed, "{stem}");
        }
    }

    #[test]
    fn references_that_cannot_be_rewritten_are_errors() {
        let missing = fingerprinted(&files(&[("index.html", "<script src=\"strat.js\">"), ("start.js", "")]));
        // As bindings of WebAssembly name their imports.
        assert!(fingerprinted(&files(&[("index.html", ""), ("start.js", "imports = { './start_bg.js': { } }")])).is_ok());
        assert_eq!(missing, Err("client-wasm/web/index.html refers to `strat.js`, which does not exist".to_owned()));
        let circle = fingerprinted(&files(&[("a.js", "import './b.js'"), ("b.js", "import './a.js'")])).expect_err("a circle");
        assert!(circle.contains("a.js, b.js and a.js refer to each other"), "{circle}");
    }
}
