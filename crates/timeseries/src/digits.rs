//! Shortest decimal digits that read back bit for bit, of numbers of usual size in integers alone.
//!
//! A number is `x = n 2^-s` with n of 53 bits, and reads back from any decimal within half of its gap 2^-s. With p places, of
//! `10^p < 2^s < 10^(p + 1)`, the gap is 0.1 to 1 units of the last place:
//!
//! ```text
//! x 10^p = n 10^p 2^-s = w + r 2^-64,    half of the gap: 10^p 2^(63 - s) of r
//! ```
//! If an integer is that close, w or w + 1, there is only one, without its last zeros the shortest decimal. Otherwise one more
//! digit, the nearest, is close enough. The product is exact: `10^p 2^(64 - s)` has 64 bits. No decimal of p places is just half
//! a gap away, as p < s. Powers of two, with a smaller gap below, have fewer than p places. All other numbers are left to `zmij`,
//! which tests take as the truth.

/// Smallest s: x is below 2^26. The largest is 63: x is at least 2^-11.
const LEAST: usize = 27;
/// Numbers `10^p 2^(64 - s)` by s.
const SCALES: [u64; 64 - LEAST] = {
    let mut scales = [0; 64 - LEAST];
    let mut k = 0;
    while k < scales.len() {
        scales[k] = 10_u64.pow(places(LEAST + k) as u32) << (64 - LEAST - k);
        k += 1;
    }
    scales
};

/// Returns the number p of places for s up to 63.
const fn places(s: usize) -> usize {
    (s * 1233) >> 12
}

/// Returns the eight digits of a number below 10^8, two halves at a time.
#[inline(always)]
fn eight(x: u64) -> [u8; 8] {
    let fours = x + ((1 << 32) - 10_000) * ((x * 109_951_163) >> 40);
    let twos = fours + ((1 << 16) - 100) * (((fours * 5243) >> 19) & 0x7f_0000_007f);
    let ones = twos + ((1 << 8) - 10) * (((twos * 103) >> 10) & 0xf_000f_000f_000f);
    (ones + 0x3030_3030_3030_3030).to_be_bytes()
}

/// Appends the shortest digits of a number; integers have no point.
#[inline(always)]
pub(crate) fn append(text: &mut Vec<u8>, value: f64) {
    const IMPLICIT: u64 = 1 << 52;
    let bits = value.to_bits();
    let k = (1075 - LEAST).wrapping_sub((bits >> 52 & 0x7ff) as usize);
    let scale = SCALES.get(k).copied().unwrap_or(0);
    if scale == 0 {
        return append_any(text, value);
    }
    if value < 0.0 {
        text.push(b'-');
    }
    let n = (bits & (IMPLICIT - 1)) | IMPLICIT;
    let product = u128::from(n) * u128::from(scale);
    let (whole, rest) = ((product >> 64) as u64, product as u64);
    let is_near = rest.wrapping_add(scale / 2) < scale;
    let tenths = (10 * u128::from(rest) + (1 << 63)) >> 64;
    // Of two digits as near the even one.
    let tenths = tenths as u8 - u8::from(rest == 1 << 62);
    let (whole, last) = match is_near {
        true => (whole + (rest >> 63), b'0'),
        false => (whole, b'0' + tenths),
    };
    let (high, low) = (eight(whole / 100_000_000), eight(whole % 100_000_000));
    let mut all = [[b'0'; 8], high, low, [last; 8], [b'0'; 8], [b'0'; 8]];
    let all = all.as_flattened_mut();
    let (point, mut end) = (24 - places(k + LEAST), 25);
    while end > point && all[end - 1] == b'0' {
        end -= 1;
    }
    let begin = (8 + usize::from(high[0] == b'0')).min(point - 1);
    // The point is put before its digits. Lengths are known, because copies of others are calls.
    let length = text.len() + end - begin + usize::from(end > point);
    all.copy_within(point..point + 24, point + 1);
    all[point] = b'.';
    text.extend_from_slice(&all[begin..begin + 32]);
    text.truncate(length);
}

#[inline(never)]
fn append_any(text: &mut Vec<u8>, value: f64) {
    let mut digits = zmij::Buffer::new();
    let number = digits.format(value);
    let number = number.strip_suffix(".0").unwrap_or(number);
    text.extend_from_slice(number.as_bytes());
}
