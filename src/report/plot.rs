//! Drawing for print, as SVG: one frame for lines, markers and bars ([`Figure`]), one heat map, one mesh drawing.
//!
//! Sizes are millimetres on paper: 85 mm for a column, 170 mm for a page, text 6.5 to 8 pt. Curves differ in colour (Okabe
//! and Ito's palette, safe for the colour-blind), dash pattern and marker, so they stay apart in grey. Few methods stand out,
//! the same in every figure; the others are grey. Legends stand outside the data, every axis has its unit. The same data give
//! the same bytes.
//!
//! Text is real SVG text: a program that turns the figure into pixels needs a sans-serif font, otherwise some drop all text
//! without a message.

mod axis;
mod bands;
mod canvas;
mod colour;
mod contact;
mod contour;
mod figure;
mod heatmap;
mod legend;
mod mesh;
mod panel;
mod series;
mod solid;
mod style;

pub use axis::{Axis, prefixed};
pub use canvas::{italic, plain, subscript};
pub use colour::Rgb;
pub use contact::contact_status;
pub use contour::displacement;
pub use figure::Figure;
pub use heatmap::{Cell, HeatMap};
pub use series::{Draw, Guide, Panel, Series};
pub use style::{Marker, Style, base, is_exact, looks, rank, status_marker};
