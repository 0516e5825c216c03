//! The only file that knows the drawing library: shapes and text in millimetres become SVG.
//!
//! The library draws on whole pixels and writes the size in pixels. So there are [`PX_PER_MM`] of them per millimetre, and
//! the finished text gets its size in millimetres, a title, and subscripts, which the library does not have.

use super::colour::{BLACK, GREY, Rgb, WHITE};
use crate::report::ReportError;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Resolution of the drawing: 0.05 mm.
pub const PX_PER_MM: f64 = 20.0;
const MM_PER_PT: f64 = 25.4 / 72.0;
/// The library divides font sizes by this.
const FONT_DIVISOR: f64 = 1.24;
/// Sizes of text [pt].
pub const LABEL_PT: f64 = 8.0;
pub const TICK_PT: f64 = 7.0;
pub const SMALL_PT: f64 = 6.5;

/// Size and line distance of captions.
pub const CAPTION_PT: f64 = 6.5;
const CAPTION_MM: f64 = 3.0;
const FONTS: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

// Marks inside text, from Unicode's private use area: they cannot come from data (`plain` removes them).
const SUB: char = '\u{E000}';
const SUB_END: char = '\u{E001}';
const ITALIC: char = '\u{E002}';
const ITALIC_END: char = '\u{E003}';

/// Width of a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Width {
    /// One column of a journal, 85 mm.
    Column,
    /// Both columns, 170 mm.
    Page,
}

impl Width {
    /// In millimetres.
    pub fn mm(self) -> f64 {
        match self {
            Self::Column => 85.0,
            Self::Page => 170.0,
        }
    }
}

/// A subscript inside a label: `format!("p{} [MPa]", subscript("n"))`.
pub fn subscript(text: &str) -> String {
    format!("{SUB}{}{SUB_END}", plain(text))
}

/// A symbol in italics inside a label.
pub fn italic(text: &str) -> String {
    format!("{ITALIC}{}{ITALIC_END}", plain(text))
}

/// Text from data without the marks above.
pub fn plain(text: &str) -> String {
    text.chars()
        .filter(|c| !(SUB..=ITALIC_END).contains(c))
        .collect()
}

/// Which part of the text stands at the given point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

enum Shape {
    Line {
        points: Vec<[i32; 2]>,
        colour: Rgb,
        width: u32,
    },
    Fill {
        points: Vec<[i32; 2]>,
        colour: Rgb,
    },
    Circle {
        centre: [i32; 2],
        radius: i32,
        colour: Rgb,
    },
    Text {
        text: String,
        at: [i32; 2],
        size_pt: f64,
        anchor: Anchor,
        colour: Rgb,
        upwards: bool,
    },
}

/// A drawing; origin at the top left, y downwards, millimetres.
pub struct Canvas {
    size: [f64; 2],
    shapes: Vec<Shape>,
}

/// Millimetres to pixels.
pub fn pixel(point: [f64; 2]) -> [i32; 2] {
    point.map(|c| (c * PX_PER_MM).round() as i32)
}

impl Canvas {
    pub fn new(width: f64, height: f64) -> Self {
        Self {
            size: [width, height],
            shapes: Vec::new(),
        }
    }

    /// An open line; `width` in millimetres.
    pub fn line(&mut self, points: &[[f64; 2]], colour: Rgb, width: f64) {
        self.pixel_line(points.iter().map(|p| pixel(*p)).collect(), colour, width);
    }

    /// An open line through pixels.
    pub fn pixel_line(&mut self, points: Vec<[i32; 2]>, colour: Rgb, width: f64) {
        let width = (width * PX_PER_MM).round().max(1.0) as u32;
        if points.len() > 1 {
            self.shapes.push(Shape::Line {
                points,
                colour,
                width,
            });
        }
    }

    /// A line of dashes: `pattern` holds lengths drawn and left out in turn [mm]; empty for a solid line, 0 first for one
    /// that begins with a gap.
    pub fn dashed(&mut self, points: &[[f64; 2]], colour: Rgb, width: f64, pattern: &[f64]) {
        if pattern.is_empty() {
            self.line(points, colour, width);
            return;
        }
        let mut piece = 0;
        let mut left = pattern[0];
        let mut dash: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            let mut done = 0.0;
            while length - done > left {
                done += left;
                let t = done / length;
                let at = [
                    from[0] + t * (to[0] - from[0]),
                    from[1] + t * (to[1] - from[1]),
                ];
                dash.push(at);
                if piece % 2 == 0 && pattern[piece] > 0.0 {
                    self.line(&dash, colour, width);
                }
                dash = vec![at];
                piece = (piece + 1) % pattern.len();
                left = pattern[piece];
            }
            left -= length - done;
            dash.push(to);
        }
        if piece % 2 == 0 {
            self.line(&dash, colour, width);
        }
    }

    /// A filled polygon.
    pub fn fill(&mut self, points: &[[f64; 2]], colour: Rgb) {
        let points = points.iter().map(|p| pixel(*p)).collect();
        self.shapes.push(Shape::Fill { points, colour });
    }

    /// A filled region bounded by oriented loops of pixels, holes running the other way round.
    ///
    /// The library has polygons only, so the loops are joined by bridges that are walked there and back: they enclose
    /// nothing, and the non-zero rule of SVG leaves the holes empty.
    pub fn fill_region(&mut self, loops: &[Vec<[i32; 2]>], colour: Rgb) {
        let mut points = Vec::new();
        for ring in loops {
            points.extend(ring);
            points.extend(ring.first());
        }
        points.extend(loops.iter().rev().skip(1).filter_map(|ring| ring.first()));
        if !points.is_empty() {
            self.shapes.push(Shape::Fill { points, colour });
        }
    }

    /// A filled circle.
    pub fn disc(&mut self, centre: [f64; 2], radius: f64, colour: Rgb) {
        let radius = (radius * PX_PER_MM).round() as i32;
        self.shapes.push(Shape::Circle {
            centre: pixel(centre),
            radius,
            colour,
        });
    }

    /// Text whose middle height is at the point.
    pub fn text(&mut self, text: &str, at: [f64; 2], size_pt: f64, anchor: Anchor, colour: Rgb) {
        let text = text.to_owned();
        self.shapes.push(Shape::Text {
            text,
            at: pixel(at),
            size_pt,
            anchor,
            colour,
            upwards: false,
        });
    }

    /// Text that reads upwards, centred at the point.
    pub fn text_upwards(&mut self, text: &str, at: [f64; 2], size_pt: f64, colour: Rgb) {
        let text = text.to_owned();
        let anchor = Anchor::Middle;
        self.shapes.push(Shape::Text {
            text,
            at: pixel(at),
            size_pt,
            anchor,
            colour,
            upwards: true,
        });
    }

    /// Small grey lines at the top left; they end at [`caption_height`].
    pub fn caption(&mut self, lines: &[String]) {
        for (index, line) in lines.iter().enumerate() {
            let at = [1.5, 2.8 + CAPTION_MM * index as f64];
            self.text(line, at, CAPTION_PT, Anchor::Start, GREY);
        }
    }

    /// The SVG text; `title` is for screen readers and file browsers.
    pub fn finish(&self, title: &str) -> Result<String, ReportError> {
        let size = pixel(self.size);
        let mut svg = String::new();
        {
            let pixels = (size[0] as u32, size[1] as u32);
            let area = SVGBackend::with_string(&mut svg, pixels).into_drawing_area();
            area.fill(&rgb(WHITE)).map_err(drawing)?;
            for shape in &self.shapes {
                draw(&area, shape)?;
            }
            area.present().map_err(drawing)?;
        }
        Ok(finish_svg(&svg, self.size, title))
    }

    /// A line with a filled head.
    pub fn arrow(&mut self, from: [f64; 2], to: [f64; 2]) {
        const HEAD: [f64; 2] = [1.5, 0.5];
        let d = [to[0] - from[0], to[1] - from[1]];
        let length = d[0].hypot(d[1]);
        if length <= 0.0 {
            return;
        }
        let [x, y] = d.map(|c| c / length);
        // A short arrow is all head.
        let [long, half] = HEAD.map(|c| c * (length / HEAD[0]).min(1.0));
        let neck = [to[0] - long * x, to[1] - long * y];
        let side = |s: f64| [neck[0] - s * half * y, neck[1] + s * half * x];
        self.line(&[from, neck], BLACK, 0.25);
        self.fill(&[to, side(1.0), side(-1.0)], BLACK);
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;

fn draw(area: &Area<'_>, shape: &Shape) -> Result<(), ReportError> {
    let pairs =
        |points: &[[i32; 2]]| -> Vec<(i32, i32)> { points.iter().map(|[x, y]| (*x, *y)).collect() };
    match shape {
        Shape::Line {
            points,
            colour,
            width,
        } => area.draw(&PathElement::new(
            pairs(points),
            rgb(*colour).stroke_width(*width),
        )),
        Shape::Fill { points, colour } => area.draw(&Polygon::new(pairs(points), rgb(*colour))),
        Shape::Circle {
            centre,
            radius,
            colour,
        } => area.draw(&Circle::new(
            (centre[0], centre[1]),
            *radius,
            rgb(*colour).filled(),
        )),
        Shape::Text {
            text,
            at,
            size_pt,
            anchor,
            colour,
            upwards,
        } => {
            let size = size_pt * MM_PER_PT * PX_PER_MM * FONT_DIVISOR;
            let horizontal = match anchor {
                Anchor::Start => HPos::Left,
                Anchor::Middle => HPos::Center,
                Anchor::End => HPos::Right,
            };
            let mut font = (FONTS, size).into_font();
            if *upwards {
                font = font.transform(FontTransform::Rotate270);
            }
            let style = font
                .color(&rgb(*colour))
                .pos(Pos::new(horizontal, VPos::Center));
            area.draw_text(text, &style, (at[0], at[1]))
        }
    }
    .map_err(drawing)
}

fn drawing<E: std::error::Error + Send + Sync>(error: DrawingAreaErrorKind<E>) -> ReportError {
    ReportError::Drawing(error.to_string())
}

fn rgb(colour: Rgb) -> RGBColor {
    RGBColor(colour[0], colour[1], colour[2])
}

/// Size in millimetres, a title, text elements on one line each (a line end would count as a space), subscripts.
fn finish_svg(svg: &str, size: [f64; 2], title: &str) -> String {
    let title = title
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;");
    let mut out = String::with_capacity(svg.len());
    let mut lines = svg.lines();
    while let Some(line) = lines.next() {
        if line.starts_with("<svg ") {
            let view = line.find("viewBox").map_or("", |at| &line[at..]);
            out += &format!(
                "<svg width=\"{:.2}mm\" height=\"{:.2}mm\" stroke-linejoin=\"round\" {view}\n<title>{}</title>\n",
                size[0],
                size[1],
                plain(&title)
            );
        } else if line.starts_with("<text ") {
            // Without this a viewer drops the space behind a subscript.
            out += &line.replacen("<text ", "<text xml:space=\"preserve\" ", 1);
            out += &styled(lines.next().unwrap_or(""), font_size(line));
        } else {
            out += line;
            out.push('\n');
        }
    }
    // Opaque is what SVG does anyway.
    out.replace(" opacity=\"1\"", "")
}

fn font_size(element: &str) -> f64 {
    element
        .split_once("font-size=\"")
        .and_then(|(_, rest)| rest.split_once('"'))
        .and_then(|(size, _)| size.parse().ok())
        .unwrap_or(PX_PER_MM)
}

/// Marks become `tspan` elements; a shift holds for all that follows, so it is taken back behind a subscript.
fn styled(text: &str, size: f64) -> String {
    let shift = 0.22 * size;
    let mut open = 0;
    let mut out = String::new();
    for c in text.chars() {
        match c {
            SUB => {
                out += &format!("<tspan dy=\"{shift:.1}\" font-size=\"{:.1}\">", 0.75 * size);
                open += 1;
            }
            SUB_END => out += &format!("</tspan><tspan dy=\"{:.1}\">", -shift),
            ITALIC => {
                out += "<tspan font-style=\"italic\">";
                open += 1;
            }
            ITALIC_END => {
                out += "</tspan>";
                open -= 1;
            }
            _ => out.push(c),
        }
    }
    // One is open per subscript, and where a text was cut inside a mark.
    out + &"</tspan>".repeat(open)
}

/// Estimated width of a text [mm]; a little generous, since the font is the reader's.
pub fn text_width(text: &str, size_pt: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            SUB..=ITALIC_END => 0.0,
            'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.3,
            ' ' | 't' | 'f' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 0.38,
            'm' | 'w' | 'M' | 'W' | '=' | '×' | '−' => 0.85,
            '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' => 0.42,
            _ => 0.62,
        })
        .sum();
    em * size_pt * MM_PER_PT
}

/// The size, at most `size_pt`, at which a text is at most `width` [mm] wide; never below 5 pt.
pub fn fitting_size(text: &str, size_pt: f64, width: f64) -> f64 {
    (size_pt * width / text_width(text, size_pt)).clamp(5.0, size_pt)
}

/// The text cut with an ellipsis so that it is at most `width` [mm] wide.
pub fn fitted(text: &str, size_pt: f64, width: f64) -> String {
    let mut kept: String = text.to_owned();
    if text_width(&kept, size_pt) <= width {
        return kept;
    }
    while !kept.is_empty() && text_width(&kept, size_pt) + text_width("m", size_pt) > width {
        kept.pop();
    }
    kept + "…"
}

/// Height that a caption takes [mm].
pub fn caption_height(lines: &[String]) -> f64 {
    2.0 + CAPTION_MM * lines.len() as f64
}

/// The text broken at line ends and after commas into lines of at most `width` [mm].
pub fn wrapped(text: &str, size_pt: f64, width: f64) -> Vec<String> {
    let paragraphs = text.split('\n');
    paragraphs
        .flat_map(|paragraph| wrapped_paragraph(paragraph, size_pt, width))
        .collect()
}

fn wrapped_paragraph(text: &str, size_pt: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for part in text.split(", ").filter(|part| !part.is_empty()) {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line}, {part},"), size_pt) <= width => {
                *line += ", ";
                *line += part;
            }
            last => {
                if let Some(line) = last {
                    line.push(',');
                }
                lines.push(part.to_owned());
            }
        }
    }
    lines
        .iter()
        .map(|line| fitted(line, size_pt, width))
        .collect()
}
