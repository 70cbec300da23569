//! Half-precision numbers.

/// Bits of an `f32` as half precision, rounded towards zero. Subnormal values become zero; overflow becomes the largest finite value.
pub(crate) fn half(value: f32) -> u16 {
    let bits = value.to_bits();
    let sign = (bits >> 16 & 0x8000) as u16;
    let exponent = (bits >> 23 & 0xff) as i32 - 112;
    match exponent {
        ..=0 => sign,
        31.. => sign | 0x7bff,
        _ => sign | (exponent as u16) << 10 | (bits >> 13 & 0x3ff) as u16,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_numbers_have_their_half_bits() {
        let known = [
            (0.0, 0),
            (1.0, 0x3c00),
            (-2.0, 0xc000),
            (0.333_26, 0x3555),
            (65_504.0, 0x7bff),
            (1e9, 0x7bff),
            (-1e-9, 0x8000),
            (104.0, 0x5680),
        ];
        for (value, wanted) in known {
            assert_eq!(half(value), wanted, "{value}");
        }
    }
}
