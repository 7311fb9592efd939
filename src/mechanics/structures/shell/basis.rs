//! Shape functions of the nine-node element, its tying points and its Gauss points.
//!
//! Node k = 3j + i is at (r, s) = (i − 1, j − 1). The shape functions are products of the quadratic
//! Lagrange polynomials of {−1, 0, 1}. Tying points, p = 1/√3, c = √(3/5) (Bucalem & Bathe 1993,
//! MITC9):
//!
//! | set | points (r, s) | covariant components tied there |
//! |---|---|---|
//! | A | r = ±p, s ∈ {−c, 0, c} | ε_rr, κ_rr, γ_r |
//! | B | r ∈ {−c, 0, c}, s = ±p | ε_ss, κ_ss, γ_s |
//! | C | r = ±p, s = ±p | ε_rs, κ_rs |
//!
//! Between the points a component is linear where two points are in a row and quadratic where three
//! are. The Gauss points share the coordinates c with the tying points, so a component rr or ss at
//! a Gauss point follows from two tying points, and rs from four.

use std::sync::LazyLock;

/// Nodes of an element.
pub const NODES: usize = 9;
/// Gauss points of an element, 3 × 3; point g = 3j + i like the nodes.
pub const GAUSS_POINTS: usize = 9;
/// The Gauss point in the middle, r = s = 0.
pub const MIDDLE: usize = 4;
/// Tying points of membrane and bending: six A, six B, four C.
pub const TYING_POINTS: usize = 16;
/// Tying points of shear: those of A and B.
pub const SHEAR_POINTS: usize = 12;

/// The shape functions N_a and their derivatives N_a,r and N_a,s at a point.
#[derive(Clone, Copy, Debug, Default)]
pub struct Basis {
    pub n: [f64; NODES],
    pub by: [[f64; NODES]; 2],
}

impl Basis {
    /// At (r, s).
    pub fn at(r: f64, s: f64) -> Self {
        let (lr, ls) = (quadratic(r), quadratic(s));
        let (dr, ds) = (quadratic_slope(r), quadratic_slope(s));
        let product = |f: [f64; 3], g: [f64; 3]| std::array::from_fn(|k| f[k % 3] * g[k / 3]);
        Self {
            n: product(lr, ls),
            by: [product(dr, ls), product(lr, ds)],
        }
    }
}

/// Lagrange polynomials of {−1, 0, 1}.
fn quadratic(x: f64) -> [f64; 3] {
    [0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)]
}

fn quadratic_slope(x: f64) -> [f64; 3] {
    [x - 0.5, -2.0 * x, x + 0.5]
}

/// Interpolation from the tying points to a Gauss point: indices and weights.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tied {
    /// Component rr (and γ_r) from two points A.
    pub rr: [(usize, f64); 2],
    /// Component ss (and γ_s) from two points B.
    pub ss: [(usize, f64); 2],
    /// Component rs from four points C.
    pub rs: [(usize, f64); 4],
}

/// Shape functions at every point that the element evaluates.
pub struct Tables {
    pub tying: [Basis; TYING_POINTS],
    pub gauss: [Basis; GAUSS_POINTS],
    pub weights: [f64; GAUSS_POINTS],
    pub tied: [Tied; GAUSS_POINTS],
    /// At the nodes, for their normals.
    pub nodes: [Basis; NODES],
}

/// Covariant components (rr, ss, rs) by the two directions that they pair.
pub const COMPONENTS: [[usize; 2]; 3] = [[0, 0], [1, 1], [0, 1]];

/// The component (0 = rr, 1 = ss, 2 = rs) that is tied at tying point `p`.
pub fn component(p: usize) -> usize {
    if p < 6 { 0 } else { usize::from(p >= 12) + 1 }
}

/// The tables, made once.
pub static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let (p, c) = (1.0 / 3.0_f64.sqrt(), 0.6_f64.sqrt());
    let (pair, triple) = ([-p, p], [-c, 0.0, c]);
    let weight = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];
    let linear = |x: f64| [0.5 * (1.0 - x / p), 0.5 * (1.0 + x / p)];
    let tying = std::array::from_fn(|k| match component(k) {
        0 => Basis::at(pair[k % 2], triple[k / 2]),
        1 => Basis::at(triple[(k - 6) / 2], pair[k % 2]),
        _ => Basis::at(pair[k % 2], pair[(k - 12) / 2]),
    });
    let tied = std::array::from_fn(|g| {
        let (i, j) = (g % 3, g / 3);
        let (lr, ls) = (linear(triple[i]), linear(triple[j]));
        Tied {
            rr: std::array::from_fn(|k| (2 * j + k, lr[k])),
            ss: std::array::from_fn(|k| (6 + 2 * i + k, ls[k])),
            rs: std::array::from_fn(|k| (12 + k, lr[k % 2] * ls[k / 2])),
        }
    });
    Tables {
        tying,
        gauss: std::array::from_fn(|g| Basis::at(triple[g % 3], triple[g / 3])),
        weights: std::array::from_fn(|g| weight[g % 3] * weight[g / 3]),
        tied,
        nodes: std::array::from_fn(|k| Basis::at((k % 3) as f64 - 1.0, (k / 3) as f64 - 1.0)),
    }
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tied_components_reproduce_the_polynomials_between_their_points() {
        let (p, c) = (1.0 / 3.0_f64.sqrt(), 0.6_f64.sqrt());
        let (pair, triple) = ([-p, p], [-c, 0.0, c]);
        for g in 0..GAUSS_POINTS {
            let (r, s) = (triple[g % 3], triple[g / 3]);
            let value = |r: f64, s: f64| (1.0 + 0.3 * r) * (0.2 + s - 0.7 * s * s);
            let sum = |list: &[(usize, f64)], f: &dyn Fn(usize) -> f64| -> f64 {
                list.iter().map(|&(k, w)| w * f(k)).sum()
            };
            let tied = &TABLES.tied[g];
            let rr = sum(&tied.rr, &|k| value(pair[k % 2], triple[k / 2]));
            assert!((rr - value(r, s)).abs() < 1e-15);
            let ss = sum(&tied.ss, &|k| value(pair[k % 2], triple[(k - 6) / 2]));
            assert!((ss - value(s, r)).abs() < 1e-15);
            let bilinear = |r: f64, s: f64| (1.0 + 0.3 * r) * (0.2 + s);
            let rs = sum(&tied.rs, &|k| bilinear(pair[k % 2], pair[(k - 12) / 2]));
            assert!((rs - bilinear(r, s)).abs() < 1e-15);
        }
    }

    #[test]
    fn shape_functions_sum_to_one_and_their_slopes_to_nothing() {
        let all = TABLES
            .tying
            .iter()
            .chain(&TABLES.gauss)
            .chain(&TABLES.nodes);
        for basis in all {
            assert!((basis.n.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            for by in basis.by {
                assert!(by.iter().sum::<f64>().abs() < 1e-15);
            }
        }
    }
}
