//! Binary arithmetic coder: a 32-bit interval, split by an adaptive probability for each bit.

use serde::{Deserialize, Serialize};

/// Either side of the arithmetic coder: an encoder writes the given bit, a decoder reads it.
pub(super) trait Coder {
    /// Codes one bit with its adaptive probability.
    fn code(&mut self, probability: &mut Probability, bit: Option<bool>) -> bool;
}

/// Probability that a bit is set, in 1/65536: the mean of the bits seen so far, and after [`SETTLED`] bits their exponential moving average.
/// Payloads are short, so the first bits must count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Probability {
    set: u16,
    seen: u8,
}

/// Number of bits after which the adaptation rate stays constant.
const SETTLED: usize = 48;

/// Adaptation rate at the n-th bit, in 1/65536: 1/(n + 1.6).
const RATE: [u32; SETTLED] = {
    let mut rate = [0; SETTLED];
    let mut seen = 0;
    while seen < SETTLED {
        rate[seen] = 655_360 / (10 * seen as u32 + 16);
        seen += 1;
    }
    rate
};

impl Default for Probability {
    fn default() -> Self {
        Self { set: 1 << 15, seen: 0 }
    }
}

impl Probability {
    /// Split point of an interval of `range`; the lower part stands for a set bit. At least 1, less than `range`.
    fn split(self, range: u32) -> u32 {
        let set = u32::from(self.set).clamp(48, (1 << 16) - 48);
        ((u64::from(range) * u64::from(set)) >> 16) as u32
    }

    fn update(&mut self, bit: bool) {
        let rate = RATE[usize::from(self.seen).min(SETTLED - 1)];
        if bit {
            self.set += ((u32::from(u16::MAX - self.set) * rate) >> 16) as u16;
        } else {
            self.set -= ((u32::from(self.set) * rate) >> 16) as u16;
        }
        self.seen = self.seen.saturating_add(1).min(SETTLED as u8 - 1);
    }
}

/// Encoder: narrows the interval `low..=high` by each bit and emits the leading bytes that both ends share.
pub(super) struct Encoder {
    low: u32,
    high: u32,
    bytes: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Self {
        Self { low: 0, high: u32::MAX, bytes: Vec::new() }
    }
}

impl Encoder {
    /// Ends the payload with the fewest bytes that, followed by zeros, are in the interval.
    pub(super) fn finish(mut self) -> Vec<u8> {
        let (value, kept) = shortest(self.low, self.high);
        self.bytes.extend(&value.to_be_bytes()[..kept]);
        self.bytes
    }
}

/// The value within `low..=high` with the fewest leading bytes before zeros, and their number.
fn shortest(low: u32, high: u32) -> (u32, usize) {
    for kept in 0..4 {
        let step = 1_u64 << (32 - 8 * kept);
        let value = u64::from(low).div_ceil(step) * step;
        if value <= u64::from(high) {
            return (value as u32, kept);
        }
    }
    (low, 4)
}

impl Coder for Encoder {
    fn code(&mut self, probability: &mut Probability, bit: Option<bool>) -> bool {
        let bit = bit.expect("an encoder is given every bit");
        let middle = self.low + probability.split(self.high - self.low);
        if bit {
            self.high = middle
        } else {
            self.low = middle + 1
        }
        probability.update(bit);
        while (self.low ^ self.high) >> 24 == 0 {
            self.bytes.push((self.high >> 24) as u8);
            self.low <<= 8;
            self.high = (self.high << 8) | 0xff;
        }
        bit
    }
}

/// Decoder; past the end of the payload it reads zeros.
pub(super) struct Decoder<'a> {
    low: u32,
    high: u32,
    value: u32,
    payload: &'a [u8],
    taken: usize,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(payload: &'a [u8]) -> Self {
        let mut decoder = Self { low: 0, high: u32::MAX, value: 0, payload, taken: 0 };
        for _ in 0..4 {
            decoder.take_byte();
        }
        decoder
    }

    fn take_byte(&mut self) {
        let byte = self.payload.get(self.taken).copied().unwrap_or(0);
        self.value = (self.value << 8) | u32::from(byte);
        self.taken += 1;
    }

    /// Whether the payload ends exactly where an encoder would have ended it.
    pub(super) fn is_exhausted_exactly(&self) -> bool {
        let (value, kept) = shortest(self.low, self.high);
        self.value == value && self.payload.len() == self.taken - 4 + kept
    }
}

impl Coder for Decoder<'_> {
    fn code(&mut self, probability: &mut Probability, _: Option<bool>) -> bool {
        let middle = self.low + probability.split(self.high - self.low);
        let bit = self.value <= middle;
        if bit {
            self.high = middle
        } else {
            self.low = middle + 1
        }
        probability.update(bit);
        while (self.low ^ self.high) >> 24 == 0 {
            self.low <<= 8;
            self.high = (self.high << 8) | 0xff;
            self.take_byte();
        }
        bit
    }
}
