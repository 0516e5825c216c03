//! Changes of valid files, of texts and of binary ones.

use stickslip_xfem::mesh::stream::Stream;

/// Numbers that readers stumble over.
const NUMBERS: [&str; 24] = [
    "nan",
    "inf",
    "-inf",
    "1e309",
    "-1e309",
    "1e-400",
    "-0",
    "0",
    "-1",
    "1",
    "2",
    "0.5",
    "1e25",
    "4294967296",
    "2147483648",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551615",
    "18446744073709551616",
    "99999999999999999999999999",
    "1e",
    "0x10",
    "1_000_000",
    "١٢",
];

/// Words that mean something where texts are read, and what must not pass into tables and terminals.
const WORDS: [&str; 30] = [
    "[[crack]]",
    "[[cells]]",
    "[mesh]",
    "{",
    "}",
    "[",
    "]",
    "=",
    "\"",
    "'''",
    "\"\"\"",
    "#",
    "\n",
    "\r\n",
    "\t",
    ",",
    ".",
    "\\u001b",
    "\u{1b}[31m",
    "\u{202e}",
    "=1+1",
    "../",
    "%",
    "null",
    "true",
    "1979-05-27",
    "free",
    "exact",
    "symmetric",
    "array",
];

/// Numbers of binary files: sizes, counts and addresses.
fn word(stream: &mut Stream, len: usize) -> u64 {
    let powers = 1u64 << stream.whole(0, 63);
    match stream.whole(0, 7) {
        0 => 0,
        1 => u64::MAX,
        2 => powers,
        3 => powers - 1,
        4 => u64::MAX - stream.whole(0, 64) as u64,
        5 => stream.whole(0, len) as u64,
        6 => 1_000_000_000_000,
        _ => stream.whole(0, 300) as u64,
    }
}

/// Where a slice begins and ends.
fn slice(stream: &mut Stream, len: usize) -> std::ops::Range<usize> {
    let start = stream.whole(0, len);
    // Short ones break one thing, long ones move whole parts.
    let most = if stream.chance(0.8) { 16 } else { len };
    start..(start + stream.whole(0, most)).min(len)
}

/// One change that suits any file.
fn change(bytes: &mut Vec<u8>, other: &[u8], stream: &mut Stream) {
    let len = bytes.len();
    let at = stream.whole(0, len);
    match stream.whole(0, 9) {
        0 if len > 0 => bytes[at.min(len - 1)] ^= 1 << stream.whole(0, 7),
        1 if len > 0 => bytes[at.min(len - 1)] = stream.whole(0, 255) as u8,
        2 => {
            bytes.drain(slice(stream, len));
        }
        3 => {
            let copy = bytes[slice(stream, len)].to_vec();
            bytes.splice(at..at, copy);
        }
        4 => {
            let copy = bytes[slice(stream, len)].to_vec();
            let end = (at + copy.len()).min(len);
            bytes[at..end].copy_from_slice(&copy[..end - at]);
        }
        5 if stream.chance(0.3) => bytes.truncate(at),
        6 => {
            // The beginning of one file, the rest of another.
            let from = stream.whole(0, other.len());
            if stream.chance(0.3) {
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            } else {
                let copy = other[slice(stream, other.len())].to_vec();
                bytes.splice(at..at, copy);
            }
        }
        7 => {
            let invalid: [&[u8]; 5] = [&[0xff], &[0xc3], &[0], &[0xed, 0xa0, 0x80], &[0xf4, 0x90]];
            bytes.splice(at..at, invalid[stream.whole(0, 4)].iter().copied());
        }
        8 => {
            let byte = stream.whole(0, 255) as u8;
            let count = stream.whole(1, 300);
            bytes.splice(at..at, vec![byte; count]);
        }
        _ => {
            let range = slice(stream, len);
            for byte in &mut bytes[range] {
                *byte = stream.whole(0, 255) as u8;
            }
        }
    }
}

/// One change of a number, a word or the nesting of a text.
fn change_text(bytes: &mut Vec<u8>, stream: &mut Stream) {
    let at = stream.whole(0, bytes.len());
    let digit = |b: &u8| b.is_ascii_digit();
    match stream.whole(0, 4) {
        0..=2 => {
            // The next number after a place, whole.
            let Some(start) = bytes[at..].iter().position(digit).map(|n| at + n) else {
                return;
            };
            let number = |b: &&u8| b.is_ascii_digit() || b"+-.e_".contains(b);
            let end = start + bytes[start..].iter().take_while(number).count();
            let new = NUMBERS[stream.whole(0, NUMBERS.len() - 1)];
            bytes.splice(start..end, new.bytes());
        }
        3 => {
            let new = WORDS[stream.whole(0, WORDS.len() - 1)];
            bytes.splice(at..at, new.bytes());
        }
        _ => {
            let open = [&b"["[..], b"{a=", b"(", b"[[", b"a."][stream.whole(0, 4)];
            let deep = open.repeat(stream.whole(1, 2000));
            bytes.splice(at..at, deep);
        }
    }
}

/// One change of a number or an address of a binary file.
fn change_binary(bytes: &mut [u8], stream: &mut Stream) {
    let width = [1, 2, 4, 8][stream.whole(0, 3)];
    if bytes.len() < 16 {
        return;
    }
    let place = |stream: &mut Stream| {
        let at = stream.whole(0, bytes.len() - width);
        // Headers are aligned, and lie before the data.
        if stream.chance(0.7) {
            at / width * width
        } else {
            at
        }
    };
    let (to, from) = (place(stream), place(stream));
    if stream.chance(0.3) {
        bytes.copy_within(from..from + width, to);
    } else {
        let new = word(stream, bytes.len()).to_le_bytes();
        bytes[to..to + width].copy_from_slice(&new[..width]);
    }
}

/// What a file holds.
#[derive(Clone, Copy, PartialEq)]
pub enum Kind {
    Text,
    Binary,
}

/// One of the files after some changes, mostly few: what is wrong in one place only is read furthest.
pub fn changed(seeds: &[Vec<u8>], kind: Kind, stream: &mut Stream) -> Vec<u8> {
    let mut bytes = seeds[stream.whole(0, seeds.len() - 1)].clone();
    let other = &seeds[stream.whole(0, seeds.len() - 1)];
    let changes = if stream.chance(0.7) {
        stream.whole(1, 2)
    } else {
        stream.whole(1, 12)
    };
    for _ in 0..changes {
        match kind {
            Kind::Text if stream.chance(0.5) => change_text(&mut bytes, stream),
            Kind::Binary if stream.chance(0.6) => change_binary(&mut bytes, stream),
            _ => change(&mut bytes, other, stream),
        }
    }
    bytes
}
