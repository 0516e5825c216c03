//! Figures for print, as SVG.
//!
//! Sizes are millimetres on paper: [`Width::Column`] 85 mm, [`Width::Page`] 170 mm, text 6.5 to 8 pt. Curves differ in
//! colour (Okabe and Ito's palette, safe for the colour-blind), dash pattern and marker, so they stay apart in grey; methods
//! look the same in every figure, approximate ones have hollow markers and short dashes.
//! Legends stand outside the data, every axis has its unit. The same data give the same bytes.
//!
//! Text is real SVG text: a program that turns the figure into pixels needs a sans-serif font, otherwise some drop all text
//! without a message.

mod agreement;
mod axis;
mod bands;
mod canvas;
mod chart;
mod colour;
mod contact;
mod contour;
mod cost;
mod curve_direction;
mod curves;
mod errors;
mod field;
mod hysteresis;
mod lattice;
mod legend;
mod marks;
mod method_curves;
mod method_panels;
mod methods;
mod names;
mod opened_solid;
mod outline;
mod profile;
mod rates;
mod solid;
mod stacked;
mod style;
mod surface;

pub use canvas::{Width, italic, subscript};
pub use contact::contact_status;
pub use contour::{displacement_contours, von_mises_contours};
pub use cost::method_cost;
pub use curves::{Curve, CurvePlot, Tier, error_plot, line_plot, residual_history};
pub use errors::{ErrorCurve, ErrorFigure, ErrorPanel, Guide, error_figure};
pub use field::Magnification;
pub use hysteresis::friction_loop;
pub use lattice::{Lattice, SmallPanel, lattice};
pub use method_panels::{MethodCurve, MethodPanel, MethodPanels, method_panels, stairs};
pub use methods::rank as method_rank;
pub use profile::{contact_slip, contact_traction};
pub use rates::success_rates;
pub use solid::{Axis3, solid_displacement, solid_von_mises};
pub use stacked::{Bar, Stacked, stacked};
