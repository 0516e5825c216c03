//! Colours that mean nothing.

/// Red, green, blue.
pub type Rgb = [u8; 3];

pub const BLACK: Rgb = [0, 0, 0];
pub const WHITE: Rgb = [255, 255, 255];
/// Captions and reference lines.
pub const GREY: Rgb = [96, 96, 96];
/// Curves that stand behind: bands of agreeing methods, methods that do not stand out.
pub const MIDDLE: Rgb = [165, 165, 165];
/// Grid lines, undeformed outlines.
pub const LIGHT: Rgb = [215, 215, 215];
