//! Inputs from seeds: bytes, lines and numbers changed by a random generator with a fixed seed.

use pinwheel_studies::rng::Rng;

/// Random numbers from a seed.
pub struct Random(Rng);

impl Random {
    /// Makes a generator; equal seeds give equal numbers.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(Rng::new(seed))
    }

    /// Returns a number below `most`, or 0 if `most` is 0.
    pub fn below(&mut self, most: usize) -> usize {
        self.0.integer(0, most.max(1) - 1)
    }

    fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }
}

/// Extreme numbers, and texts that are no finite number.
const NUMBERS: &[&str] = &[
    "0",
    "-0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "1e-5",
    "1e-307",
    "1e-320",
    "5e-324",
    "1e300",
    "-1e300",
    "1.7976931348623157e308",
    "1e309",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "9223372036854775807",
    "-9223372036854775808",
    "9223372036854775808",
    "18446744073709551615",
    "4294967296",
    "65535",
    "1e6",
    "1e9",
    "1e-9",
    "1e-12",
    "1e-3",
    "7",
    "16",
    "40",
    "120",
    "1000",
    "0.999999",
    "1_000",
    "0x10",
    "1.",
    ".5",
    "+1",
    "1,5",
    "\"1\"",
    "true",
    "[]",
    "{}",
    "[1, 2]",
    "\"\"",
    "\"\\u0000\"",
    "\"\\u001b[2J\"",
    "1979-05-27",
];

/// Pieces with a meaning for one of the readers.
const WORDS: &[&str] = &[
    "\n",
    "=",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "\"",
    "'",
    "#",
    ",",
    ";",
    ".",
    "*",
    "%%%%",
    "\n%%%%\n",
    "\r\n",
    "\t",
    "\u{feff}",
    "\u{1b}[2J",
    "\u{0}",
    "../",
    "/",
    "base = \"paper\"\n",
    "name = \"..\"\n",
    "[gear]\n",
    "[solver]\n",
    "[contact]\n",
    "[mass]\n",
    "[drive]\n",
    "[vary]\n",
    "[set]\n",
    "[output]\n",
    "[columns]\n",
    "[time]\n",
    "[file]\n",
    "auto",
    "rk4",
    "rodas5p",
    "imex2-adaptive",
    "points",
    "lagrange",
    "equilibrium",
    "from = ",
    "to = ",
    "points = ",
    "time_s",
    "input_torque_n_m",
    "external_sleeve_force_n_0",
    "external_sleeve_force_n_*",
    "n_m",
    "load_changes = [{ time_s = 1e-4, torque_n_m = 1.0 }]\n",
    "channels = [\"*\"]\n",
];

/// Longest input, bytes.
const LONGEST: usize = 1 << 16;

/// Returns the `number`-th input from these seeds.
#[must_use]
pub fn input(seeds: &[Vec<u8>], number: u64) -> Vec<u8> {
    let mut random = Random::new(number.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x5eed);
    if seeds.is_empty() {
        return Vec::new();
    }
    let mut bytes = random.of(seeds).clone();
    // Few changes keep most of an input valid, many explore.
    let changes = [1, 1, 1, 2, 2, 3, 5, 12];
    for _ in 0..*random.of(&changes) {
        change(&mut bytes, seeds, &mut random);
        bytes.truncate(LONGEST);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, seeds: &[Vec<u8>], random: &mut Random) {
    match random.below(12) {
        0..=3 => number(bytes, random),
        4 => {
            let at = random.below(bytes.len());
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
        5 => {
            let at = random.below(bytes.len() + 1);
            let word = random.of(WORDS).bytes();
            bytes.splice(at..at, word);
        }
        6 => {
            let [from, to] = span(bytes, random);
            bytes.drain(from..to);
        }
        7 => {
            let [from, to] = span(bytes, random);
            let piece = bytes[from..to].to_vec();
            let at = random.below(bytes.len() + 1);
            bytes.splice(at..at, piece);
        }
        8..=9 => lines(bytes, random),
        10 => {
            let other = random.of(seeds);
            let [from, to] = span(other, random);
            let at = random.below(bytes.len() + 1);
            bytes.splice(at..at, other[from..to].iter().copied());
        }
        _ => {
            let at = random.below(bytes.len());
            if let Some(byte) = bytes.get_mut(at) {
                *byte = random.below(256) as u8;
            }
        }
    }
}

/// Returns a random range of at most 64 bytes.
fn span(bytes: &[u8], random: &mut Random) -> [usize; 2] {
    let from = random.below(bytes.len() + 1);
    let to = from + random.below(64.min(bytes.len() - from) + 1);
    [from, to]
}

/// Replaces a number by another one.
fn number(bytes: &mut Vec<u8>, random: &mut Random) {
    let digit = |byte: u8| byte.is_ascii_digit();
    let part = |byte: u8| byte.is_ascii_alphanumeric() || b"+-._".contains(&byte);
    // Searches, from a random place on, the beginning of a number: a digit that follows no letter or digit.
    let start = random.below(bytes.len());
    let places = (start..bytes.len()).chain(0..start);
    let mut begins = places
        .filter(|&k| digit(bytes[k]) && (k == 0 || !part(bytes[k - 1]) || bytes[k - 1] == b'-'));
    let Some(from) = begins.next() else { return };
    let to = (from..bytes.len())
        .find(|&k| !part(bytes[k]))
        .unwrap_or(bytes.len());
    let new: Vec<u8> = match random.below(4) {
        // Typing errors: another decimal place, factor or sign.
        0 => match std::str::from_utf8(&bytes[from..to])
            .ok()
            .and_then(|text| text.parse::<f64>().ok())
        {
            Some(value) => {
                let factor = [10.0, 0.1, 1000.0, 1e-3, 2.0, 0.5, -1.0, 1.001][random.below(8)];
                format!("{:?}", value * factor).into_bytes()
            }
            None => random.of(NUMBERS).bytes().collect(),
        },
        _ => random.of(NUMBERS).bytes().collect(),
    };
    bytes.splice(from..to, new);
}

/// Removes, doubles or moves a line.
fn lines(bytes: &mut Vec<u8>, random: &mut Random) {
    let mut lines: Vec<Vec<u8>> = bytes
        .split_inclusive(|&b| b == b'\n')
        .map(<[u8]>::to_vec)
        .collect();
    let at = random.below(lines.len());
    let to = random.below(lines.len());
    if lines.is_empty() {
        return;
    }
    match random.below(3) {
        0 => {
            lines.remove(at);
        }
        1 => lines.insert(to, lines[at].clone()),
        _ => lines.swap(at, to),
    }
    *bytes = lines.concat();
}
