//! Branch functions of the coordinates ahead of a tip and across its crack: of one tip, of both ends of a crack.

/// √r times sin θ/2, cos θ/2, sin θ/2 sin θ, cos θ/2 sin θ. Without branches, so that several points go at once.
#[inline(always)]
pub(super) fn root_values(psi: f64, phi: f64) -> [f64; 4] {
    let r = (psi * psi + phi * phi).sqrt();
    let ([sin, _], [s, c]) = (polar(psi, phi, r), half_polar(psi, phi, r));
    [s, c, s * sin, c * sin].map(|f| r.sqrt() * f)
}

/// The same with their derivatives ahead and across; these are 0 at the tip, for want of a limit.
#[inline(always)]
pub(super) fn root_functions(psi: f64, phi: f64) -> ([f64; 4], [[f64; 2]; 4]) {
    let r = (psi * psi + phi * phi).sqrt();
    let root = r.sqrt();
    let inverse = if r > 0.0 { 1.0 / root } else { 0.0 };
    let ([sin, cos], [s, c]) = (polar(psi, phi, r), half_polar(psi, phi, r));
    let angular = [s, c, s * sin, c * sin];
    let slope = [
        0.5 * c,
        -0.5 * s,
        0.5 * c * sin + s * cos,
        -0.5 * s * sin + c * cos,
    ];
    let mut slopes = [[0.0; 2]; 4];
    for l in 0..4 {
        // ∂g/∂r = f/(2√r), (1/r) ∂g/∂θ = f'/√r, turned into space
        let (gr, gt) = (0.5 * angular[l] * inverse, slope[l] * inverse);
        slopes[l] = [gr * cos - gt * sin, gr * sin + gt * cos];
    }
    (angular.map(|f| root * f), slopes)
}

/// sin θ and cos θ of a point at distance r from the tip; those of θ = 0 at the tip itself.
#[inline(always)]
fn polar(psi: f64, phi: f64, r: f64) -> [f64; 2] {
    let (sin, cos) = (phi / r, psi / r);
    if r > 0.0 { [sin, cos] } else { [0.0, 1.0] }
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

/// Functions of both ends ± a of a straight crack and their derivatives along and across it (Westergaard 1939).
///
/// ```text
///   z = x + i y,   ζ = √(z² − a²) ~ z far away, cut between the ends only,   Z = dζ/dz = z/ζ
///   g = { Im (ζ − z), Re (ζ − z), y Re (Z − 1), y Im Z }        [[g₁]] = 2 √(a² − x²), the others are continuous
/// ```
///
/// They hold the displacement of a crack in an infinite plane under uniform load, less its linear part.
pub(super) fn pair_functions(a: f64, x: f64, y: f64) -> ([f64; 4], [[f64; 2]; 4]) {
    let root = |x: f64| {
        let r = x.hypot(y);
        let [s, c] = half_polar(x, y, r);
        [r.sqrt() * c, r.sqrt() * s]
    };
    let product = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a * c - b * d, a * d + b * c];
    let [re, im] = product(root(x - a), root(x + a));
    let square = re * re + im * im;
    let values = |z: [f64; 2]| [im - y, re - x, y * (z[0] - 1.0), y * z[1]];
    if square == 0.0 {
        return (values([1.0, 0.0]), [[0.0; 2]; 4]);
    }
    let inverse = [re / square, -im / square];
    let z = product([x, y], inverse);
    // dZ/dz = (1 − Z²)/ζ
    let [z2, z2i] = product(z, z);
    let dz = product([1.0 - z2, -z2i], inverse);
    // f analytic: ∂x Re f = Re f', ∂y Re f = −Im f', ∂x Im f = Im f', ∂y Im f = Re f'
    let slopes = [
        [z[1], z[0] - 1.0],
        [z[0] - 1.0, -z[1]],
        [y * dz[0], z[0] - 1.0 - y * dz[1]],
        [y * dz[1], z[1] + y * dz[0]],
    ];
    (values(z), slopes)
}
