//! Branch functions of the coordinates ahead of a tip and across its crack: of one tip, of both ends of a crack.

use std::array::from_fn;

/// √r times sin θ/2, cos θ/2, sin θ/2 sin θ, cos θ/2 sin θ at L points.
#[inline(always)]
pub(super) fn root_values<const L: usize>(psi: &[f64; L], phi: &[f64; L]) -> [[f64; L]; 4] {
    let [r, sin, _, s, c] = polar(psi, phi);
    [s, c, times(&s, &sin), times(&c, &sin)].map(|f| times(&r.map(f64::sqrt), &f))
}

/// The same with their derivatives ahead and across; these are 0 at the tip, for want of a limit.
#[inline(always)]
pub(super) fn root_functions<const L: usize>(psi: &[f64; L], phi: &[f64; L]) -> [[[f64; L]; 3]; 4] {
    let [r, sin, cos, s, c] = polar(psi, phi);
    let root = r.map(f64::sqrt);
    let over = root.map(|root| 1.0 / root);
    let inverse = from_fn(|q| if r[q] > 0.0 { over[q] } else { 0.0 });
    let angular = [s, c, times(&s, &sin), times(&c, &sin)];
    let slopes: [[f64; L]; 4] = [
        c.map(|c| 0.5 * c),
        s.map(|s| -0.5 * s),
        from_fn(|q| 0.5 * c[q] * sin[q] + s[q] * cos[q]),
        from_fn(|q| -0.5 * s[q] * sin[q] + c[q] * cos[q]),
    ];
    from_fn(|l| {
        // ∂g/∂r = f/(2√r), (1/r) ∂g/∂θ = f'/√r, turned into space
        let gr = times(&angular[l].map(|f| 0.5 * f), &inverse);
        let gt = times(&slopes[l], &inverse);
        let ahead = from_fn(|q| gr[q] * cos[q] - gt[q] * sin[q]);
        let across = from_fn(|q| gr[q] * sin[q] + gt[q] * cos[q]);
        [times(&root, &angular[l]), ahead, across]
    })
}

#[inline(always)]
fn times<const L: usize>(x: &[f64; L], y: &[f64; L]) -> [f64; L] {
    from_fn(|q| x[q] * y[q])
}

/// r, sin θ, cos θ, sin θ/2 and cos θ/2; those of θ = 0 at the tip itself. Without branches, so that several points go at once.
#[inline(always)]
fn polar<const L: usize>(psi: &[f64; L], phi: &[f64; L]) -> [[f64; L]; 5] {
    let r: [f64; L] = from_fn(|q| (psi[q] * psi[q] + phi[q] * phi[q]).sqrt());
    let [sin, cos]: [[f64; L]; 2] = [phi, psi].map(|x| from_fn(|q| x[q] / r[q]));
    let half: [[f64; 2]; L] = from_fn(|q| half_polar(psi[q], phi[q], r[q]));
    let [s, c] = [0, 1].map(|k| half.map(|half| half[k]));
    let sin = from_fn(|q| if r[q] > 0.0 { sin[q] } else { 0.0 });
    [
        r,
        sin,
        from_fn(|q| if r[q] > 0.0 { cos[q] } else { 1.0 }),
        s,
        c,
    ]
}

/// sin θ/2 and cos θ/2, −π <= θ <= π, the larger of both from (1 ± cos θ)/2, which cancels nothing, and the other from
/// their product sin θ/2.
#[inline(always)]
fn half_polar(psi: f64, phi: f64, r: f64) -> [f64; 2] {
    let larger = (0.5 * (1.0 + psi.abs() / r)).sqrt();
    let other = 0.5 * phi / (r * larger);
    // −0 is the lower face.
    let behind = [larger.copysign(phi), other.abs()];
    let [s, c] = if psi >= 0.0 { [other, larger] } else { behind };
    if r == 0.0 { [0.0, 1.0] } else { [s, c] }
}

/// Functions of both ends ± a of a straight crack, each with its derivatives along and across it (Westergaard 1939).
///
/// ```text
///   z = x + i y,   ζ = √(z² − a²) ~ z far away, cut between the ends only,   Z = dζ/dz = z/ζ
///   g = { Im (ζ − z), Re (ζ − z), y Re (Z − 1), y Im Z }        [[g₁]] = 2 √(a² − x²), the others are continuous
/// ```
///
/// They hold the displacement of a crack in an infinite plane under uniform load, less its linear part. Between a bent crack and the
/// line between its ends ζ has the other sign, so that it is cut along the crack.
pub(super) fn pair_functions(a: f64, x: f64, y: f64, between: bool) -> [[f64; 3]; 4] {
    let root = |x: f64| {
        let r = x.hypot(y);
        let [s, c] = half_polar(x, y, r);
        [r.sqrt() * c, r.sqrt() * s]
    };
    let product = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
    let sign = if between { -1.0 } else { 1.0 };
    let [re, im] = product(root(x - a), root(x + a)).map(|v| sign * v);
    let square = re * re + im * im;
    // ζ − z = −a²/(ζ + z): far from a short crack that cancels nothing.
    let same = re * x + im * y > 0.0;
    let [p, q] = [re + x, im + y];
    let less = if same {
        let scale = a * a / (p * p + q * q);
        [-scale * p, scale * q]
    } else {
        [re - x, im - y]
    };
    if square == 0.0 {
        return [less[1], less[0], 0.0, 0.0].map(|value| [value, 0.0, 0.0]);
    }
    let inverse = [re / square, -im / square];
    // Z − 1 = (z − ζ)/ζ,   dZ/dz = (1 − Z)(1 + Z)/ζ
    let one_less = product(less.map(|v| -v), inverse);
    let dz = product(
        product(less, inverse),
        product([2.0 + one_less[0], one_less[1]], inverse),
    );
    // f analytic: ∂x Re f = Re f', ∂y Re f = −Im f', ∂x Im f = Im f', ∂y Im f = Re f'
    let [u, v] = one_less;
    [
        [less[1], v, u],
        [less[0], u, -v],
        [y * u, y * dz[0], u - y * dz[1]],
        [y * v, y * dz[1], v + y * dz[0]],
    ]
}
