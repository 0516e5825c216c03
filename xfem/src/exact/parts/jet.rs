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
