//! Where the markers of many curves go that tell which curve is which: few on each curve, at steady distances on paper,
//! not on those of others. On a logarithmic axis steady distances are logarithmically spaced values. They need not stand
//! at points of the data: curves that share all points are still to be told apart.

/// Distance of the markers of one curve along it [mm].
const APART_MM: f64 = 11.0;
/// Distance from all other markers at which one is free [mm].
const FREE_MM: f64 = 2.6;
/// Places that are tried, along the curve [mm].
const STEP_MM: f64 = 0.5;
/// Part of a curve at its first point, where all curves start, that gets no marker [mm].
const START_MM: f64 = 2.0;

/// Golden ratio: multiples of it are spread evenly over the unit interval, however many there are.
const TURN: f64 = 0.618_033_988_749_895;

/// A place on a curve and its distance along it from the first point.
#[derive(Clone, Copy)]
struct Place {
    at: [f64; 2],
    along: f64,
}

/// Places of the markers of each curve, given by its points on paper. Every curve with a point gets at least one.
pub fn spread(curves: &[Vec<Option<[f64; 2]>>]) -> Vec<Vec<[f64; 2]>> {
    let mut placed: Vec<[f64; 2]> = Vec::new();
    let mut chosen = Vec::with_capacity(curves.len());
    for (index, curve) in curves.iter().enumerate() {
        let own = choose(&sampled(curve), index, &placed);
        placed.extend(&own);
        chosen.push(own);
    }
    chosen
}

/// Markers of one curve beside those already placed.
fn choose(places: &[Place], index: usize, placed: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let total = places.last().map_or(0.0, |place| place.along);
    // Coinciding curves start apart.
    let first = APART_MM * (0.5 + TURN * index as f64).fract();
    let count = 1 + ((total - first) / APART_MM).max(0.0) as usize;
    let mut own: Vec<[f64; 2]> = Vec::new();
    for target in (0..count).map(|k| (first + APART_MM * k as f64).min(total)) {
        let free = |place: &Place| {
            let others = placed.iter().chain(&own);
            let distances = others.map(|other| distance(*other, place.at));
            distances.fold(FREE_MM, f64::min)
        };
        // The freest place, of equally free ones the closest to the target.
        let off = |place: &Place| (place.along - target).abs();
        // The first one may go far for room: a curve without a marker has no name.
        let far = if own.is_empty() { 1.0 } else { 0.5 } * APART_MM;
        let near = places.iter().filter(|place| off(place) <= far);
        let best = near.max_by(|a, b| {
            let closer = off(b).total_cmp(&off(a));
            free(a).total_cmp(&free(b)).then(closer)
        });
        if let Some(place) = best.filter(|p| own.is_empty() || free(p) > 0.6 * FREE_MM) {
            own.push(place.at);
        }
    }
    own
}

/// Places along a curve in small steps, without its start where it is long enough.
fn sampled(curve: &[Option<[f64; 2]>]) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    let mut along = 0.0;
    for piece in curve.split(Option::is_none) {
        let points: Vec<[f64; 2]> = piece.iter().flatten().copied().collect();
        places.extend(points.first().map(|at| Place { at: *at, along }));
        for pair in points.windows(2) {
            let length = distance(pair[0], pair[1]);
            let steps = (length / STEP_MM).ceil().max(1.0);
            places.extend((1..=steps as usize).map(|step| {
                let t = step as f64 / steps;
                Place {
                    at: [0, 1].map(|c| pair[0][c] + t * (pair[1][c] - pair[0][c])),
                    along: along + t * length,
                }
            }));
            along += length;
        }
    }
    if along > 2.0 * START_MM {
        places.retain(|place| place.along >= START_MM);
    }
    places
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coinciding_curves_have_markers_of_their_own() {
        let dense = (0..600).map(|i| Some([0.1 * f64::from(i), 0.0])).collect();
        let two_points = vec![Some([0.0, 0.0]), Some([60.0, 0.0])];
        for line in [dense, two_points] {
            let chosen = spread(&vec![line; 4]);
            let places: Vec<[f64; 2]> = chosen.iter().flatten().copied().collect();
            let counts: Vec<usize> = chosen.iter().map(Vec::len).collect();
            assert!(counts.iter().all(|n| (4..=6).contains(n)), "{counts:?}");
            for (i, a) in places.iter().enumerate() {
                let apart = |b: &[f64; 2]| distance(*a, *b) > 0.6 * FREE_MM;
                assert!(places[..i].iter().all(apart), "{chosen:?}");
            }
        }
    }

    #[test]
    fn short_and_broken_curves_have_a_marker() {
        let point = vec![Some([3.0, 4.0])];
        let broken = vec![None, Some([3.0, 4.0]), None, Some([3.1, 4.0])];
        let chosen = spread(&[point.clone(), point, broken, vec![None], Vec::new()]);
        let counts: Vec<usize> = chosen.iter().map(Vec::len).collect();
        assert_eq!(counts, [1, 1, 1, 0, 0]);
    }
}
