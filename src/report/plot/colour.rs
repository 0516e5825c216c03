//! Colours: Okabe and Ito's palette for curves, viridis for fields.

/// Red, green, blue.
pub type Rgb = [u8; 3];

pub const BLACK: Rgb = [0, 0, 0];
pub const WHITE: Rgb = [255, 255, 255];
/// Captions and reference lines.
pub const GREY: Rgb = [96, 96, 96];
/// Bands below black lines.
pub const MIDDLE: Rgb = [150, 150, 150];
/// Grid lines, undeformed outlines.
pub const LIGHT: Rgb = [205, 205, 205];

/// Okabe and Ito (2008) without the yellow, which vanishes on white paper.
const CURVES: [Rgb; 7] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    BLACK,
];

/// How many colours methods take turns with: black belongs to what several of them share.
pub const METHOD_COLOURS: usize = CURVES.len() - 1;

/// Colour of the n-th curve.
pub fn curve(index: usize) -> Rgb {
    CURVES[index % CURVES.len()]
}

/// viridis (van der Walt and Smith 2015) at 0, 0.1, …, 1: its lightness rises steadily, so it orders in grey too.
const VIRIDIS: [Rgb; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

/// Colour of a field at `fraction` of its range.
pub fn field(fraction: f64) -> Rgb {
    let last = VIRIDIS.len() - 1;
    let position = fraction.clamp(0.0, 1.0) * last as f64;
    let index = (position.floor() as usize).min(last - 1);
    let weight = position - index as f64;
    std::array::from_fn(|c| {
        let (low, high) = (VIRIDIS[index][c], VIRIDIS[index + 1][c]);
        (f64::from(low) + weight * (f64::from(high) - f64::from(low))).round() as u8
    })
}
