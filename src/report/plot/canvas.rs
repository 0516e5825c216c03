//! The only file that knows the drawing library: shapes and text in millimetres become SVG.
//!
//! The library draws on whole pixels and writes the size in pixels. So there are [`PX_PER_MM`] of them per millimetre, and
//! the finished text gets its size in millimetres, a title, and subscripts, which the library does not have.

use super::colour::{BLACK, GREY, Rgb, WHITE};
use crate::report::ReportError;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Resolution of the drawing: 0.05 mm.
const PX_PER_MM: f64 = 20.0;
const MM_PER_PT: f64 = 25.4 / 72.0;
/// The library divides font sizes by this.
const FONT_DIVISOR: f64 = 1.24;
/// Sizes of text [pt]: titles and labels, ticks and legends, captions.
pub const LABEL_PT: f64 = 8.0;
pub const TICK_PT: f64 = 7.0;
pub const SMALL_PT: f64 = 6.5;
/// Distance of text from the edge of the paper [mm].
pub const MARGIN_MM: f64 = 1.5;
/// Distances of lines in titles and captions [mm].
const TITLE_MM: f64 = 3.7;
const CAPTION_MM: f64 = 2.9;
const FONTS: &str = "Helvetica, Arial, Liberation Sans, DejaVu Sans, sans-serif";

// Marks inside text, from Unicode's private use area: they cannot come from data (`plain` removes them).
const SUB: char = '\u{E000}';
const SUB_END: char = '\u{E001}';
const ITALIC: char = '\u{E002}';
const ITALIC_END: char = '\u{E003}';

/// Width of a figure in one column of a journal [mm].
pub const COLUMN: f64 = 85.0;
/// Width of a figure across both columns [mm].
pub const PAGE: f64 = 170.0;

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
    /// Reads upwards, centred.
    Upwards,
}

enum Shape {
    Line(Vec<[i32; 2]>, u32),
    Fill(Vec<[i32; 2]>),
    Disc([i32; 2], i32),
    Text(String, [i32; 2], f64, Anchor),
}

/// A place in pixels.
pub type Pixel = [i32; 2];

/// Millimetres to pixels.
pub fn pixel(point: [f64; 2]) -> Pixel {
    point.map(|c| (c * PX_PER_MM).round() as i32)
}

/// A drawing; origin at the top left, y downwards, millimetres.
pub struct Canvas {
    size: [f64; 2],
    shapes: Vec<(Shape, Rgb)>,
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
    pub fn pixel_line(&mut self, points: Vec<Pixel>, colour: Rgb, width: f64) {
        let width = (width * PX_PER_MM).round().max(1.0) as u32;
        if points.len() > 1 {
            self.shapes.push((Shape::Line(points, width), colour));
        }
    }

    /// A line of dashes: `pattern` holds lengths drawn and left out in turn [mm]; empty for a solid line.
    pub fn dashed(&mut self, points: &[[f64; 2]], colour: Rgb, width: f64, pattern: &[f64]) {
        if pattern.is_empty() {
            return self.line(points, colour, width);
        }
        let (mut piece, mut left) = (0, pattern[0]);
        let mut dash: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            let mut done = 0.0;
            while length - done > left {
                done += left;
                let at = [0, 1].map(|c| from[c] + done / length * (to[c] - from[c]));
                dash.push(at);
                if piece % 2 == 0 {
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
        self.shapes.push((Shape::Fill(points), colour));
    }

    /// A filled rectangle between two corners with a black outline of this width, 0 for none [mm].
    pub fn boxed(&mut self, [x0, y0]: [f64; 2], [x1, y1]: [f64; 2], colour: Rgb, line: f64) {
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]];
        self.fill(&corners[..4], colour);
        if line > 0.0 {
            self.line(&corners, BLACK, line);
        }
    }

    /// A filled region bounded by oriented loops of pixels, holes running the other way round.
    ///
    /// The library has polygons only, so the loops are joined by bridges that are walked there and back: they enclose
    /// nothing, and the non-zero rule of SVG leaves the holes empty.
    pub fn fill_region(&mut self, loops: &[Vec<Pixel>], colour: Rgb) {
        let mut points = Vec::new();
        for ring in loops {
            points.extend(ring);
            points.extend(ring.first());
        }
        points.extend(loops.iter().rev().skip(1).filter_map(|ring| ring.first()));
        if !points.is_empty() {
            self.shapes.push((Shape::Fill(points), colour));
        }
    }

    /// A filled circle.
    pub fn disc(&mut self, centre: [f64; 2], radius: f64, colour: Rgb) {
        let radius = (radius * PX_PER_MM).round() as i32;
        self.shapes
            .push((Shape::Disc(pixel(centre), radius), colour));
    }

    /// Text whose middle height is at the point.
    pub fn text(&mut self, text: &str, at: [f64; 2], size_pt: f64, anchor: Anchor, colour: Rgb) {
        if !text.is_empty() {
            let text = Shape::Text(text.to_owned(), pixel(at), size_pt, anchor);
            self.shapes.push((text, colour));
        }
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

    /// The SVG text; `title` is for screen readers and file browsers.
    pub fn finish(&self, title: &str) -> Result<String, ReportError> {
        let mut svg = String::new();
        {
            let [width, height] = pixel(self.size).map(|c| c as u32);
            let area = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
            area.fill(&rgb(WHITE)).map_err(drawing)?;
            for (shape, colour) in &self.shapes {
                draw(&area, shape, rgb(*colour)).map_err(drawing)?;
            }
            area.present().map_err(drawing)?;
        }
        Ok(finish_svg(&svg, self.size, title))
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
type Failure<'a> = DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>;

fn draw<'a>(area: &Area<'a>, shape: &Shape, colour: RGBColor) -> Result<(), Failure<'a>> {
    let pairs =
        |points: &[Pixel]| -> Vec<(i32, i32)> { points.iter().map(|p| (p[0], p[1])).collect() };
    match shape {
        Shape::Line(points, width) => {
            let line = PathElement::new(pairs(points), colour.stroke_width(*width));
            area.draw(&line)
        }
        Shape::Fill(points) => area.draw(&Polygon::new(pairs(points), colour)),
        Shape::Disc([x, y], radius) => area.draw(&Circle::new((*x, *y), *radius, colour.filled())),
        Shape::Text(text, at, size_pt, anchor) => {
            let (place, turn) = match anchor {
                Anchor::Start => (HPos::Left, FontTransform::None),
                Anchor::Middle => (HPos::Center, FontTransform::None),
                Anchor::End => (HPos::Right, FontTransform::None),
                Anchor::Upwards => (HPos::Center, FontTransform::Rotate270),
            };
            let size = size_pt * MM_PER_PT * PX_PER_MM * FONT_DIVISOR;
            let font = (FONTS, size).into_font().transform(turn);
            let style = font.color(&colour).pos(Pos::new(place, VPos::Center));
            area.draw_text(text, &style, (at[0], at[1]))
        }
    }
}

fn drawing<E: std::error::Error + Send + Sync>(error: DrawingAreaErrorKind<E>) -> ReportError {
    ReportError::Drawing(error.to_string())
}

fn rgb([r, g, b]: Rgb) -> RGBColor {
    RGBColor(r, g, b)
}

/// Size in millimetres, a title, text elements on one line each (a line end would count as a space), subscripts; successive
/// lines of one style as one path, because dashes are lines of their own.
fn finish_svg(svg: &str, [width, height]: [f64; 2], title: &str) -> String {
    let escaped = [('&', "&amp;"), ('<', "&lt;"), ('>', "&gt;")];
    let title = escaped
        .iter()
        .fold(plain(title), |text, (c, name)| text.replace(*c, name));
    let mut out = String::with_capacity(svg.len());
    let mut lines = svg.lines();
    let mut path = None;
    while let Some(line) = lines.next() {
        let drawn = polyline(line);
        if let Some((style, points)) = drawn {
            if path != Some(style) {
                out += if path.is_some() { PATH_END } else { "" };
                out += &format!("<path {style} d=\"");
                path = Some(style);
            }
            out.push('M');
            out += points;
            continue;
        }
        if path.take().is_some() {
            out += PATH_END;
        }
        if line.starts_with("<svg ") {
            let view = line.find("viewBox").map_or("", |at| &line[at..]);
            let size = format!("width=\"{width:.2}mm\" height=\"{height:.2}mm\"");
            out +=
                &format!("<svg {size} stroke-linejoin=\"round\" {view}\n<title>{title}</title>\n");
        } else if line.starts_with("<text ") {
            // Without this a viewer drops the space behind a subscript.
            out += &line.replacen("<text ", "<text xml:space=\"preserve\" ", 1);
            let size = line
                .split("font-size=\"")
                .nth(1)
                .and_then(|rest| rest.split('"').next());
            let size = size.and_then(|size| size.parse().ok()).unwrap_or(PX_PER_MM);
            out += &styled(lines.next().unwrap_or(""), size);
        } else {
            out += line;
            out.push('\n');
        }
    }
    // Opaque is what SVG does anyway.
    out.replace(" opacity=\"1\"", "")
}

/// The end of a path.
const PATH_END: &str = "\"/>\n";

/// Style and points of a line as plotters writes it.
fn polyline(line: &str) -> Option<(&str, &str)> {
    let (style, points) = line.strip_prefix("<polyline ")?.split_once(" points=\"")?;
    Some((style, points.strip_suffix("\"/>")?.trim_end()))
}

/// Marks become `tspan` elements; a shift holds for all that follows, so it is taken back behind a subscript.
fn styled(text: &str, size: f64) -> String {
    let (shift, small) = (0.22 * size, 0.75 * size);
    let down = format!("<tspan dy=\"{shift:.1}\" font-size=\"{small:.1}\">");
    let up = format!("</tspan><tspan dy=\"{:.1}\">", -shift);
    // A path that goes back up is open to the end of the text.
    let open = text.matches(SUB_END).count();
    let text = text.replace(SUB, &down).replace(SUB_END, &up);
    let text = text.replace(ITALIC, "<tspan font-style=\"italic\">");
    text.replace(ITALIC_END, "</tspan>") + &"</tspan>".repeat(open)
}

/// Estimated width of a text [mm]; a little generous, since the font is the reader's.
pub fn text_width(text: &str, size_pt: f64) -> f64 {
    let em = text.chars().map(|c| match c {
        SUB..=ITALIC_END => 0.0,
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.3,
        ' ' | 't' | 'f' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 0.38,
        'm' | 'w' | 'M' | 'W' | '=' | '×' | '−' => 0.85,
        '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' | '⁻' => 0.42,
        _ => 0.62,
    });
    em.sum::<f64>() * size_pt * MM_PER_PT
}

/// The size, at most `size_pt`, at which a text is at most `width` [mm] wide; never below 5 pt.
pub fn fitting_size(text: &str, size_pt: f64, width: f64) -> f64 {
    (size_pt * width / text_width(text, size_pt)).clamp(5.0, size_pt)
}

/// The text broken at its line ends and at spaces into lines of at most `width` [mm].
pub fn wrapped(text: &str, size_pt: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.split('\n').filter(|p| !p.is_empty()) {
        let mut words = paragraph.split(' ');
        lines.extend(words.next().map(str::to_owned));
        for word in words {
            match lines.last_mut() {
                Some(line) if text_width(&format!("{line} {word}"), size_pt) <= width => {
                    *line += " ";
                    *line += word;
                }
                _ => lines.push(word.to_owned()),
            }
        }
    }
    lines
}

/// Title and caption above a figure.
pub struct Head {
    title: Vec<String>,
    caption: Vec<String>,
}

impl Head {
    /// Broken into lines for a figure of this width [mm].
    pub fn new(title: &str, caption: &str, width: f64) -> Self {
        let lines = |text, size| wrapped(text, size, width - 2.0 * MARGIN_MM);
        Self {
            title: lines(title, LABEL_PT),
            caption: lines(caption, SMALL_PT),
        }
    }

    /// Room that it takes [mm].
    pub fn height(&self) -> f64 {
        1.5 + TITLE_MM * self.title.len() as f64 + CAPTION_MM * self.caption.len() as f64
    }

    pub fn draw(&self, canvas: &mut Canvas) {
        let mut y = 2.8;
        for line in &self.title {
            canvas.text(line, [MARGIN_MM, y], LABEL_PT, Anchor::Start, BLACK);
            y += TITLE_MM;
        }
        for line in &self.caption {
            canvas.text(line, [MARGIN_MM, y - 0.3], SMALL_PT, Anchor::Start, GREY);
            y += CAPTION_MM;
        }
    }
}
