//! The client's files, embedded in the binary by `build.rs`.

/// One embedded file.
#[derive(Clone, Copy, Debug)]
pub struct Asset {
    /// Value of the `Content-Type` header.
    pub content_type: &'static str,
    /// The uncompressed file.
    pub bytes: &'static [u8],
    /// The gzip-compressed file, for requests that accept `gzip`.
    pub gzip: &'static [u8],
    /// Value of the `ETag` header, quotes included: a hash of [`bytes`](Self::bytes).
    pub etag: &'static str,
}

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
mod tests {
    use super::*;

    #[test]
    fn the_root_path_is_the_page() {
        let page = asset("/").expect("every build embeds a page");
        assert_eq!(page.content_type, "text/html; charset=utf-8");
        assert_eq!(page.etag, asset("/index.html").expect("the same page").etag);
    }

    #[test]
    fn only_embedded_files_are_served() {
        for path in ["/nothing", "/../Cargo.toml", "/index.html.gz", "/index.html/"] {
            assert!(asset(path).is_none(), "{path}");
        }
    }

    #[test]
    fn every_file_is_complete_and_has_a_unique_tag() {
        for (name, asset) in ASSETS {
            assert!(!asset.bytes.is_empty(), "{name}");
            assert_eq!(asset.gzip[..2], [0x1f, 0x8b], "{name}: gzip magic");
            assert_eq!(ASSETS.iter().filter(|(_, other)| other.etag == asset.etag).count(), 1, "{name}");
        }
    }
}
