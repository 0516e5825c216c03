//! The direction in which a curve is run through: arrowheads on it, and the numbers of the points where it turns.

use super::canvas::{Anchor, Canvas, SMALL_PT, text_width};
use super::colour::{BLACK, WHITE};

/// Pieces shorter than this get no arrowhead [mm].
const LONG_MM: f64 = 5.0;
/// Points with fewer others get a number each.
const FEW: usize = 8;
/// Numbers nearer than this share a label [mm].
const SAME_MM: f64 = 2.5;
/// Distance of a label from its point [mm].
const OFF_MM: f64 = 2.6;
/// Distance of a label from the frame, which has ticks inside [mm].
const CLEAR_MM: f64 = 1.6;
/// Changes below this fraction of the range are no turn.
pub const NO_CHANGE: f64 = 1e-6;

/// Indices of the points behind which a coordinate changes the other way than before. Points that repeat a coordinate
/// change nothing: on a hysteresis loop the force turns after it has rested.
pub fn turns(points: &[[f64; 2]]) -> Vec<usize> {
    let mut turns = Vec::new();
    for c in 0..2 {
        let values = || points.iter().map(|p| p[c]);
        let range =
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
        let mut before = 0.0;
        for (index, pair) in points.windows(2).enumerate() {
            let change = pair[1][c] - pair[0][c];
            if change.abs() > NO_CHANGE * range {
                if change * before < 0.0 {
                    turns.push(index);
                }
                before = change;
            }
        }
    }
    turns.sort_unstable();
    turns.dedup();
    turns
}

/// Draws them for a curve on paper, whose points are numbered from 0; `low` and `high` are corners of the frame.
pub fn draw(canvas: &mut Canvas, [low, high]: [[f64; 2]; 2], points: &[[f64; 2]]) {
    for pair in points.windows(2) {
        let d = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
        let length = d[0].hypot(d[1]);
        if length >= LONG_MM {
            let at = |mm: f64| [0, 1].map(|c| pair[0][c] + (0.5 + mm / length) * d[c]);
            canvas.arrow(at(-1.1), at(1.1));
        }
    }
    let mut numbered = match points.len() {
        0 => return,
        n if n <= FEW => (0..n).collect(),
        _ => turns(points),
    };
    numbered.extend([0, points.len() - 1]);
    numbered.sort_unstable();
    numbered.dedup();
    let mut labels: Vec<([f64; 2], String)> = Vec::new();
    for index in numbered {
        let at = points[index];
        let near = |label: &&mut ([f64; 2], String)| {
            (label.0[0] - at[0]).hypot(label.0[1] - at[1]) < SAME_MM
        };
        match labels.iter_mut().find(near) {
            Some((_, text)) => *text += &format!(", {index}"),
            None => labels.push((at, index.to_string())),
        }
    }
    let count = points.len() as f64;
    let middle = [0, 1].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / count);
    for (at, text) in labels {
        let half = [0.5 * text_width(&text, SMALL_PT), 1.1];
        let away = [at[0] - middle[0], at[1] - middle[1]];
        let length = away[0].hypot(away[1]).max(f64::MIN_POSITIVE);
        let wanted = [0, 1].map(|c| at[c] + (OFF_MM + half[c] - 1.1) * away[c] / length);
        let place = [0, 1].map(|c| {
            let inside = [low[c] + half[c] + CLEAR_MM, high[c] - half[c] - CLEAR_MM];
            // On the other side of the point where the frame leaves no room.
            let place = if (inside[0]..=inside[1]).contains(&wanted[c]) {
                wanted[c]
            } else {
                2.0 * at[c] - wanted[c]
            };
            place.clamp(inside[0], inside[1].max(inside[0]))
        });
        let corner = |x: f64, y: f64| [place[0] + x * half[0], place[1] + y * half[1]];
        let box_around = [
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(1.0, 1.0),
            corner(-1.0, 1.0),
        ];
        canvas.fill(&box_around, WHITE);
        canvas.text(&text, place, SMALL_PT, Anchor::Middle, BLACK);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_turns_where_a_coordinate_runs_back() {
        // A hysteresis loop: up, along the top, down, along the bottom, up.
        let path = [
            [0.0, 0.0],
            [0.0, 1.0],
            [1.0, 1.0],
            [2.0, 1.0],
            [2.0, -1.0],
            [1.0, -1.0],
            [1.0, 0.0],
        ];
        assert_eq!(turns(&path), [3, 4, 5]);
        assert!(turns(&path[..4]).is_empty());
        // Round-off of a resting force is no turn.
        let rest = [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0 - 1e-9], [3.0, 2.0]];
        assert!(turns(&rest).is_empty());
    }
}
