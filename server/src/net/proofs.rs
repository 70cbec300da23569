//! Proofs that a client has its number from this server.

use prairie_core::wire::PROOF_BYTES;
use ring::hmac::{HMAC_SHA256, Key, sign, verify};
use ring::rand::{SecureRandom as _, SystemRandom};

/// Issues and checks proofs: HMAC-SHA256 of the number.
#[derive(Debug)]
pub(crate) struct Proofs(Key);

impl Proofs {
    /// Proofs with a key that stays the same over restarts, or with a new one.
    pub(crate) fn new(key: Option<[u8; 32]>) -> Self {
        let key = key.unwrap_or_else(|| {
            let mut key = [0; 32];
            SystemRandom::new().fill(&mut key).expect("the system has random numbers");
            key
        });
        Self(Key::new(HMAC_SHA256, &key))
    }

    /// The proof of a client's number.
    pub(super) fn issue(&self, client: u32) -> [u8; PROOF_BYTES] {
        sign(&self.0, &client.to_le_bytes()).as_ref().try_into().expect("SHA-256 has 32 bytes")
    }

    /// Whether a proof is that of the number; takes the same time for every wrong one.
    pub(super) fn accepts(&self, client: u32, proof: &[u8; PROOF_BYTES]) -> bool {
        verify(&self.0, &client.to_le_bytes(), proof).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_proof_is_that_of_one_client_and_one_key() {
        let (proofs, other) = (Proofs::new(None), Proofs::new(None));
        let proof = proofs.issue(7);
        assert!(proofs.accepts(7, &proof) && !proofs.accepts(8, &proof) && !other.accepts(7, &proof));
        for bit in 0..8 * PROOF_BYTES {
            let mut changed = proof;
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(!proofs.accepts(7, &changed), "bit {bit}");
        }
        assert_eq!(Proofs::new(Some([1; 32])).issue(7), Proofs::new(Some([1; 32])).issue(7));
    }
}
