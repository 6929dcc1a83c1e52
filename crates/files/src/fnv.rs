//! Hash that is equal on every machine and for every compiler, unlike std's.

/// Hash FNV-1a, 64 bits [Fowler, Noll, Vo 1991].
#[derive(Debug, Clone, Copy)]
pub struct Fnv(u64);

impl Default for Fnv {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv {
    /// Adds bytes.
    pub fn add(&mut self, bytes: impl IntoIterator<Item = u8>) {
        self.0 = bytes.into_iter().fold(self.0, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
    }

    /// Adds one part; its end affects the hash.
    pub fn add_part(&mut self, part: &[u8]) {
        self.add(part.iter().copied().chain([0xff]));
    }

    /// Returns the hash of the added bytes.
    pub fn value(self) -> u64 {
        self.0
    }
}

/// Returns the hash of some bytes.
pub fn fnv(bytes: impl IntoIterator<Item = u8>) -> u64 {
    let mut hash = Fnv::default();
    hash.add(bytes);
    hash.value()
}
