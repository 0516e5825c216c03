//! Functions carried with their derivatives up to the third, for manufactured fields.

/// A function of one variable and its first three derivatives.
pub type Jet = [f64; 4];

/// A sum of two products f(x₁) g(x₂).
#[derive(Debug, Clone, Copy)]
pub struct Separable(pub [(Jet, Jet); 2]);

impl Separable {
    /// ∂₁^i ∂₂^j
    pub fn d(&self, i: usize, j: usize) -> f64 {
        self.0.iter().map(|(f, g)| f[i] * g[j]).sum()
    }

    /// D ∂₁^i ∂₂^j for D = e·∇.
    pub fn along(&self, e: [f64; 2], i: usize, j: usize) -> f64 {
        e[0] * self.d(i + 1, j) + e[1] * self.d(i, j + 1)
    }
}

/// A function times a number.
pub fn times(factor: f64, f: Jet) -> Jet {
    f.map(|v| factor * v)
}

/// The product of two functions, by Leibniz.
pub fn product(f: Jet, g: Jet) -> Jet {
    [
        f[0] * g[0],
        f[1] * g[0] + f[0] * g[1],
        f[2] * g[0] + 2.0 * f[1] * g[1] + f[0] * g[2],
        f[3] * g[0] + 3.0 * (f[2] * g[1] + f[1] * g[2]) + f[0] * g[3],
    ]
}

/// cos kx.
pub fn cosine(k: f64, x: f64) -> Jet {
    let (sin, cos) = (k * x).sin_cos();
    [cos, -k * sin, -k * k * cos, k.powi(3) * sin]
}

/// max(0, sin θ)³ with θ = kx + `phase`.
pub fn hump(k: f64, x: f64, phase: f64) -> Jet {
    let (s, c) = (k * x + phase).sin_cos();
    if s <= 0.0 {
        return [0.0; 4];
    }
    [
        s.powi(3),
        3.0 * k * s * s * c,
        3.0 * k * k * (2.0 * s * c * c - s.powi(3)),
        3.0 * k.powi(3) * (2.0 * c.powi(3) - 7.0 * s * s * c),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_entry_is_the_derivative_of_the_one_before() {
        let d = 1e-4;
        let functions: [&dyn Fn(f64) -> Jet; 3] =
            [&|x| cosine(1.7, x), &|x| hump(1.7, x, 0.4), &|x| {
                product(hump(1.7, x, 0.4), times(2.0, cosine(0.9, x)))
            }];
        for f in functions {
            // Zeros of the hump at x = −0.24 and 1.61, where its third derivative leaps, are left out.
            for x in [-0.5, -0.1, 0.6, 1.3, 2.0] {
                let (m2, m1, p1, p2) = (f(x - 2.0 * d), f(x - d), f(x + d), f(x + 2.0 * d));
                for k in 0..3 {
                    let slope = (8.0 * (p1[k] - m1[k]) - (p2[k] - m2[k])) / (12.0 * d);
                    assert!(
                        (slope - f(x)[k + 1]).abs() < 1e-9,
                        "{x} {k}: {slope} {}",
                        f(x)[k + 1]
                    );
                }
            }
        }
        assert_eq!(hump(1.7, -0.5, 0.4), [0.0; 4]);
    }
}
