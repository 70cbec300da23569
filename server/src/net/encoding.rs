//! Choice of a content encoding from an `Accept-Encoding` header (RFC 9110, section 12.5.3).

/// Encodings of the embedded files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Brotli,
    Gzip,
    Identity,
}

impl Encoding {
    /// All encodings, the smallest result first.
    const ALL: [Self; 3] = [Self::Brotli, Self::Gzip, Self::Identity];

    /// Its name in HTTP headers.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Brotli => "br",
            Self::Gzip => "gzip",
            Self::Identity => "identity",
        }
    }
}

/// The offered encoding that the header prefers; among equals, the one with the smallest result. A client that accepts nothing gets
/// [`Encoding::Identity`], as one without the header does.
pub(super) fn choose(accepted: Option<&str>, is_offered: impl Fn(Encoding) -> bool) -> Encoding {
    let Some(accepted) = accepted else { return Encoding::Identity };
    let mut best = (Encoding::Identity, 0.0);
    for encoding in Encoding::ALL.into_iter().filter(|encoding| is_offered(*encoding)) {
        let weight = weight(accepted, encoding);
        if weight > best.1 {
            best = (encoding, weight);
        }
    }
    best.0
}

/// Weight that a header gives to an encoding, 0 to 1. One that it does not mention has the weight of `*`, or else 0, except
/// [`Encoding::Identity`], which is always accepted but never preferred to a mentioned one.
fn weight(accepted: &str, encoding: Encoding) -> f32 {
    let mut other = if encoding == Encoding::Identity { f32::MIN_POSITIVE } else { 0.0 };
    for entry in accepted.split(',') {
        let mut parts = entry.split(';').map(str::trim);
        let name = parts.next().unwrap_or_default();
        let quality = parts.find_map(|part| part.strip_prefix("q=").or_else(|| part.strip_prefix("Q=")));
        // A malformed weight excludes the encoding: the client gets a form that every client understands.
        let quality = quality.map_or(1.0, |text| text.trim().parse().ok().filter(|weight| (0.0..=1.0).contains(weight)).unwrap_or(0.0));
        let names_it = name.eq_ignore_ascii_case(encoding.name()) || (encoding == Encoding::Gzip && name.eq_ignore_ascii_case("x-gzip"));
        if names_it {
            return quality;
        }
        if name == "*" {
            other = quality;
        }
    }
    other
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_decides_and_size_breaks_ties() {
        for (header, chosen) in [
            ("gzip, deflate, br, zstd", Encoding::Brotli),
            ("gzip", Encoding::Gzip),
            ("GZIP ; q=0.5 , BR;q=0.4", Encoding::Gzip),
            ("x-gzip", Encoding::Gzip),
            ("gzip;q=0", Encoding::Identity),
            ("gzip; q=0.000, br;q=0", Encoding::Identity),
            ("*", Encoding::Brotli),
            ("*, br;q=0", Encoding::Gzip),
            ("*;q=0.1, identity;q=0.5", Encoding::Identity),
            ("identity, gzip;q=0.3", Encoding::Identity),
            ("gzip;q=0.3", Encoding::Gzip),
            ("gzip;q=nonsense", Encoding::Identity),
            ("gzip;q=7", Encoding::Identity),
            ("not-gzip, brotli", Encoding::Identity),
            ("*;q=0", Encoding::Identity),
            ("", Encoding::Identity),
        ] {
            assert_eq!(choose(Some(header), |_| true), chosen, "{header}");
        }
        assert_eq!(choose(None, |_| true), Encoding::Identity);
    }

    #[test]
    fn only_offered_encodings_are_chosen() {
        assert_eq!(choose(Some("br, gzip;q=0.1"), |encoding| encoding != Encoding::Brotli), Encoding::Gzip);
        assert_eq!(choose(Some("br"), |encoding| encoding == Encoding::Identity), Encoding::Identity);
    }
}
