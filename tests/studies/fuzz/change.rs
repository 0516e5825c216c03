//! Changes of valid files, of texts and of binary ones.

use prop::sample::{Index, select};
use proptest::prelude::*;

/// Stumbling blocks of readers of texts: numbers at their limits, signs of the format, characters without a width.
#[rustfmt::skip]
const WORDS: [&str; 38] = [
    "nan", "-inf", "1e309", "1e-400", "-0", "0", "-1", "0.5", "1e25", "4294967296", "9223372036854775808",
    "99999999999999999999999999", "0x10", "1_000_000", "١٢", "[[crack]]", "[[cells]]", "{", "}", "[", "]", "=", "\"", "'''",
    "\"\"\"", "#", "\n", "\r\n", "\t", ",", "a.", "(", "\\u001b", "\u{1b}[31m", "\0", "true", "1979-05-27", "exact",
];

/// Numbers of binary files that no file can mean: sizes, counts and addresses.
const SIZES: [u64; 8] = [0, 1, 2, 255, 1 << 31, 1_000_000_000_000, 1 << 63, u64::MAX];

/// One change; lengths beyond the end stop there.
#[derive(Debug, Clone)]
enum Change {
    /// So many bytes become others.
    Replace(Index, usize, Vec<u8>),
    /// The next number becomes another text.
    Number(Index, Vec<u8>),
    /// So many bytes come so many times more.
    Repeat(Index, usize, usize),
    /// The rest is gone.
    Cut(Index),
}

impl Change {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let len = bytes.len();
        let range = |at: &Index, most: usize| {
            let start = at.index(len + 1);
            start..(start + most).min(len)
        };
        match self {
            Change::Replace(at, most, new) => {
                bytes.splice(range(at, *most), new.iter().copied());
            }
            Change::Number(at, new) => {
                let start = at.index(len + 1);
                let Some(skipped) = bytes[start..].iter().position(u8::is_ascii_digit) else {
                    return;
                };
                let start = start + skipped;
                let of_number = |b: &&u8| b.is_ascii_digit() || b"+-.e_".contains(b);
                let end = start + bytes[start..].iter().take_while(of_number).count();
                bytes.splice(start..end, new.iter().copied());
            }
            Change::Repeat(at, most, times) => {
                let range = range(at, *most);
                let copy = bytes[range.clone()].repeat(*times);
                bytes.splice(range.end..range.end, copy);
            }
            Change::Cut(at) => bytes.truncate(at.index(len + 1)),
        }
    }
}

/// One of the files after some changes, mostly few: what is wrong in one place only is read furthest.
fn changed(
    files: Vec<Vec<u8>>,
    change: impl Strategy<Value = Change>,
) -> impl Strategy<Value = Vec<u8>> {
    let changes = prop::collection::vec(change, 1..8);
    let most = prop_oneof![3 => 1..3usize, 1 => 3..8usize];
    (select(files), changes, most).prop_map(|(mut bytes, changes, most)| {
        changes
            .iter()
            .take(most)
            .for_each(|change| change.apply(&mut bytes));
        bytes
    })
}

/// Any bytes, or one of the texts, changed; a megabyte at most, which is what readers of texts take.
pub fn any_text(files: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let word = || select(&WORDS[..]).prop_map(|word| word.as_bytes().to_vec());
    let bytes = prop::collection::vec(any::<u8>(), 0..4);
    let change = prop_oneof![
        3 => (any::<Index>(), word()).prop_map(|(at, new)| Change::Number(at, new)),
        3 => (any::<Index>(), 0..12usize, prop_oneof![word(), bytes])
            .prop_map(|(at, most, new)| Change::Replace(at, most, new)),
        1 => (any::<Index>(), 1..60usize, prop_oneof![9 => 1..20usize, 1 => Just(15_000)])
            .prop_map(|(at, most, times)| Change::Repeat(at, most, times)),
        1 => any::<Index>().prop_map(Change::Cut),
    ];
    prop_oneof![9 => changed(files, change), 1 => any_bytes()]
}

/// Any bytes, or one of the binary files, changed.
pub fn any_binary(files: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let size = (select(&SIZES[..]), select(&[1usize, 2, 4, 8][..]))
        .prop_map(|(size, width)| size.to_le_bytes()[..width].to_vec());
    let bytes = prop::collection::vec(any::<u8>(), 1..3);
    let change = prop_oneof![
        6 => (any::<Index>(), prop_oneof![size, bytes])
            .prop_map(|(at, new)| Change::Replace(at, new.len(), new)),
        1 => (any::<Index>(), 1..60usize, 1..4usize)
            .prop_map(|(at, most, times)| Change::Repeat(at, most, times)),
        1 => any::<Index>().prop_map(Change::Cut),
    ];
    prop_oneof![9 => changed(files, change), 1 => any_bytes()]
}

fn any_bytes() -> impl Strategy<Value = Vec<u8>> {
    prop::collection::vec(any::<u8>(), 0..300)
}
