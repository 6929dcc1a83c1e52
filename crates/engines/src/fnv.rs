//! A hash that is the same on every machine and for every compiler, unlike std's.

/// FNV-1a, 64 bits [Fowler, Noll, Vo 1991], of several parts.
pub(crate) struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// One more part; where it ends counts.
    pub(crate) fn add(&mut self, part: &[u8]) {
        let bytes = part.iter().chain(&[0xff]);
        self.0 = bytes.fold(self.0, |hash, byte| {
            (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
        });
    }

    pub(crate) fn value(&self) -> u64 {
        self.0
    }
}
