//! The kinds of shell elements: shape functions, tying points and Gauss points.
//!
//! An element of order m (MITC4: 1, MITC9: 2) has nodes k = (m + 1) j + i at r = 2i/m − 1, s = 2j/m − 1. The shape
//! functions are products of the Lagrange polynomials of a row of nodes. A component of strain is taken at the points
//! where it is tied, and carried from there to the Gauss points. With p = 1/√3, c = √(3/5):
//!
//! | kind | points (r, s) | covariant components tied there |
//! |---|---|---|
//! | MITC9 (Bucalem & Bathe 1993) | r = ±p, s ∈ {−c, 0, c} | ε_rr, κ_rr, γ_r |
//! | | r ∈ {−c, 0, c}, s = ±p | ε_ss, κ_ss, γ_s |
//! | | r = ±p, s = ±p | ε_rs, κ_rs |
//! | MITC4 (Dvorkin & Bathe 1984) | r = 0, s = ±1 | γ_r |
//! | | r = ±1, s = 0 | γ_s |
//! | | r = 0, s = ±p | ε_rr, κ_rr |
//! | | r = ±p, s = 0 | ε_ss, κ_ss |
//! | | r = ±p, s = ±p | ε_rs, κ_rs |
//!
//! Between the points a component is linear where two points are in a row and quadratic where three
//! are. The Gauss points share coordinates with the tying points, so a component rr or ss at
//! a Gauss point follows from two tying points, and rs from four.
//!
//! The linear strains ε and κ of MITC4 are those of its displacements: rr does not change with r, ss not with s, and
//! the points of rs are the Gauss points. In von Karman's terms the slopes d·u,r and d·u,s are taken where the shear
//! γ_r or γ_s vanishes in a thin shell.

use crate::model::shell_kind::{PerNode, SHELL_NODES, ShellKind};
use std::sync::LazyLock;

/// Nodes of an element at most.
pub const NODES: usize = SHELL_NODES;
/// Gauss points of an element at most.
pub const GAUSS_POINTS: usize = 9;
/// Tying points at most, of membrane and bending: six of rr, six of ss, four of rs.
pub const TYING_POINTS: usize = 16;
/// Those of rr and ss, where shear is tied too.
pub const SHEAR_POINTS: usize = 12;

impl ShellKind {
    /// Shape functions at every point that the element evaluates.
    #[inline]
    pub fn tables(self) -> &'static Tables {
        match self {
            Self::Mitc9 => &MITC9,
            Self::Mitc4 => &MITC4,
        }
    }

    /// The shape functions at (r, s).
    pub fn basis(self, r: f64, s: f64) -> Basis {
        let wide = self.order() + 1;
        let (lr, ls) = (self.row(r), self.row(s));
        let product =
            |f: [f64; 3], g: [f64; 3]| PerNode::from_fn(wide * wide, |k| f[k % wide] * g[k / wide]);
        Basis {
            n: product(lr[0], ls[0]),
            by: [product(lr[1], ls[0]), product(lr[0], ls[1])],
        }
    }

    /// Lagrange polynomials of a row of nodes, and their slopes.
    fn row(self, x: f64) -> [[f64; 3]; 2] {
        match self {
            Self::Mitc9 => [
                [0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)],
                [x - 0.5, -2.0 * x, x + 0.5],
            ],
            Self::Mitc4 => [[0.5 * (1.0 - x), 0.5 * (1.0 + x), 0.0], [-0.5, 0.5, 0.0]],
        }
    }
}

/// The shape functions N_a and their derivatives N_a,r and N_a,s at a point.
#[derive(Clone, Copy, Debug)]
pub struct Basis {
    pub n: PerNode<f64>,
    pub by: [PerNode<f64>; 2],
}

/// A point where components are tied. [`component`] of its number says which of membrane and bending; shear is tied
/// in the direction of rr or ss.
pub struct Tying {
    /// Its number, below [`TYING_POINTS`].
    pub index: usize,
    pub basis: Basis,
    /// Whether membrane and bending are tied there.
    pub in_plane: bool,
    /// Whether shear is.
    pub shear: bool,
}

/// Interpolation from the tying points to a Gauss point: numbers and weights.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tied {
    /// Component rr.
    pub rr: [(usize, f64); 2],
    /// Component ss.
    pub ss: [(usize, f64); 2],
    /// Component rs.
    pub rs: [(usize, f64); 4],
    /// γ_r and γ_s.
    pub shear: [[(usize, f64); 2]; 2],
}

/// Shape functions at every point that the element evaluates.
pub struct Tables {
    pub tying: Vec<Tying>,
    /// Point g = w j + i like the nodes, w the number in a row.
    pub gauss: Vec<Basis>,
    pub weights: Vec<f64>,
    pub tied: Vec<Tied>,
    /// At the nodes, for their normals.
    pub nodes: Vec<Basis>,
    /// At r = s = 0.
    pub middle: Basis,
    /// Whether tying changes constant strains of distorted elements, which is corrected then.
    pub corrected: bool,
}

/// Covariant components (rr, ss, rs) by the two directions that they pair.
pub const COMPONENTS: [[usize; 2]; 3] = [[0, 0], [1, 1], [0, 1]];

/// The component (0 = rr, 1 = ss, 2 = rs) that is tied at tying point `p`.
pub fn component(p: usize) -> usize {
    if p < 6 { 0 } else { usize::from(p >= 12) + 1 }
}

/// The points ∓1/√3 of Gauss's rule of two points.
fn pair() -> [f64; 2] {
    let p = 1.0 / 3.0_f64.sqrt();
    [-p, p]
}

/// Weights of linear interpolation between ∓`end` at x.
fn linear(end: f64, x: f64) -> [f64; 2] {
    [0.5 * (1.0 - x / end), 0.5 * (1.0 + x / end)]
}

/// The basis at each of the nodes.
fn at_nodes(kind: ShellKind) -> Vec<Basis> {
    let (order, wide) = (kind.order() as f64, kind.order() + 1);
    let place = |i: usize| 2.0 * i as f64 / order - 1.0;
    let nodes = 0..wide * wide;
    nodes
        .map(|k| kind.basis(place(k % wide), place(k / wide)))
        .collect()
}

static MITC9: LazyLock<Tables> = LazyLock::new(|| {
    let (kind, pair, c) = (ShellKind::Mitc9, pair(), 0.6_f64.sqrt());
    let (end, triple) = (pair[1], [-c, 0.0, c]);
    let weight = [5.0 / 9.0, 8.0 / 9.0, 5.0 / 9.0];
    let tying = |k: usize| Tying {
        index: k,
        basis: match component(k) {
            0 => kind.basis(pair[k % 2], triple[k / 2]),
            1 => kind.basis(triple[(k - 6) / 2], pair[k % 2]),
            _ => kind.basis(pair[k % 2], pair[(k - 12) / 2]),
        },
        in_plane: true,
        shear: k < SHEAR_POINTS,
    };
    let tied = |g: usize| {
        let (i, j) = (g % 3, g / 3);
        let (lr, ls) = (linear(end, triple[i]), linear(end, triple[j]));
        let (rr, ss) = (
            [0, 1].map(|k| (2 * j + k, lr[k])),
            [0, 1].map(|k| (6 + 2 * i + k, ls[k])),
        );
        Tied {
            rr,
            ss,
            rs: std::array::from_fn(|k| (12 + k, lr[k % 2] * ls[k / 2])),
            shear: [rr, ss],
        }
    };
    let gauss = 0..9;
    Tables {
        tying: (0..TYING_POINTS).map(tying).collect(),
        gauss: gauss
            .clone()
            .map(|g| kind.basis(triple[g % 3], triple[g / 3]))
            .collect(),
        weights: gauss
            .clone()
            .map(|g| weight[g % 3] * weight[g / 3])
            .collect(),
        tied: gauss.map(tied).collect(),
        nodes: at_nodes(kind),
        middle: kind.basis(0.0, 0.0),
        corrected: true,
    }
});

static MITC4: LazyLock<Tables> = LazyLock::new(|| {
    let (kind, pair) = (ShellKind::Mitc4, pair());
    let ends = [-1.0, 1.0];
    let tying = |(index, [r, s]): (usize, [f64; 2]), shear: bool| Tying {
        index,
        basis: kind.basis(r, s),
        in_plane: !shear,
        shear,
    };
    let in_plane = [0, 1]
        .into_iter()
        .flat_map(|k| [(k, [0.0, pair[k]]), (6 + k, [pair[k], 0.0])]);
    let in_plane = in_plane.chain((0..4).map(|k| (12 + k, [pair[k % 2], pair[k / 2]])));
    let shear = [0, 1]
        .into_iter()
        .flat_map(|k| [(2 + k, [0.0, ends[k]]), (8 + k, [ends[k], 0.0])]);
    let tied = |g: usize| {
        let (i, j) = (g % 2, g / 2);
        let at = |k: usize, of: usize| f64::from(u8::from(k == of));
        let (lr, ls) = (linear(1.0, pair[i]), linear(1.0, pair[j]));
        Tied {
            rr: [0, 1].map(|k| (k, at(k, j))),
            ss: [0, 1].map(|k| (6 + k, at(k, i))),
            rs: std::array::from_fn(|k| (12 + k, at(k, g))),
            shear: [
                [0, 1].map(|k| (2 + k, ls[k])),
                [0, 1].map(|k| (8 + k, lr[k])),
            ],
        }
    };
    let all = in_plane
        .map(|at| tying(at, false))
        .chain(shear.map(|at| tying(at, true)));
    Tables {
        tying: all.collect(),
        gauss: (0..4)
            .map(|g| kind.basis(pair[g % 2], pair[g / 2]))
            .collect(),
        weights: vec![1.0; 4],
        tied: (0..4).map(tied).collect(),
        nodes: at_nodes(kind),
        middle: kind.basis(0.0, 0.0),
        corrected: false,
    }
});

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [ShellKind; 2] = [ShellKind::Mitc9, ShellKind::Mitc4];

    type Polynomial = fn(f64, f64) -> f64;

    /// The value of a polynomial at the Gauss points, by its values at the tying points.
    fn carried(
        tables: &Tables,
        list: &[(usize, f64)],
        shear: bool,
        f: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        // The place of a point is that of its shape functions.
        let at = |p: usize| {
            let own = tables
                .tying
                .iter()
                .find(|own| own.index == p && (if shear { own.shear } else { own.in_plane }));
            let n = &own.expect("a point of this number").basis.n;
            let wide = if n.len() == 4 { 2 } else { 3 };
            let place = |i: usize| 2.0 * i as f64 / (wide - 1) as f64 - 1.0;
            let nodes = || n.iter().enumerate();
            let r: f64 = nodes().map(|(k, n)| n * place(k % wide)).sum();
            let s: f64 = nodes().map(|(k, n)| n * place(k / wide)).sum();
            f(r, s)
        };
        list.iter().map(|&(p, w)| w * at(p)).sum()
    }

    /// The polynomials that ε_rr and γ_r may be, ε_ss and γ_s with r and s exchanged, and ε_rs.
    #[test]
    fn tied_components_reproduce_the_polynomials_between_their_points() {
        let (p, c) = (1.0 / 3.0_f64.sqrt(), 0.6_f64.sqrt());
        for kind in KINDS {
            let tables = kind.tables();
            let places: Vec<f64> = if kind == ShellKind::Mitc9 {
                vec![-c, 0.0, c]
            } else {
                vec![-p, p]
            };
            for (g, tied) in tables.tied.iter().enumerate() {
                let (r, s) = (places[g % places.len()], places[g / places.len()]);
                let (row, shear): (Polynomial, Polynomial) = match kind {
                    ShellKind::Mitc9 => (
                        |r, s| (1.0 + 0.3 * r) * (0.2 + s - 0.7 * s * s),
                        |r, s| (1.0 + 0.3 * r) * (0.2 + s - 0.7 * s * s),
                    ),
                    ShellKind::Mitc4 => (|_, s| 0.2 + s - 0.7 * s * s, |_, s| 0.2 + s),
                };
                let bilinear = |r: f64, s: f64| (1.0 + 0.3 * r) * (0.2 + s);
                let near = |x: f64, y: f64| assert!((x - y).abs() < 1e-15, "{kind:?}: {x} {y}");
                near(carried(tables, &tied.rr, false, row), row(r, s));
                near(
                    carried(tables, &tied.ss, false, |r, s| row(s, r)),
                    row(s, r),
                );
                near(carried(tables, &tied.rs, false, bilinear), bilinear(r, s));
                near(carried(tables, &tied.shear[0], true, shear), shear(r, s));
                near(
                    carried(tables, &tied.shear[1], true, |r, s| shear(s, r)),
                    shear(s, r),
                );
            }
        }
    }

    #[test]
    fn shape_functions_sum_to_one_and_their_slopes_to_nothing() {
        for kind in KINDS {
            let tables = kind.tables();
            let tying = tables.tying.iter().map(|own| &own.basis);
            for basis in tying.chain(&tables.gauss).chain(&tables.nodes) {
                assert_eq!(basis.n.len(), (kind.order() + 1).pow(2));
                assert!((basis.n.iter().sum::<f64>() - 1.0).abs() < 1e-15);
                for by in basis.by {
                    assert!(by.iter().sum::<f64>().abs() < 1e-15);
                }
            }
            for (k, basis) in tables.nodes.iter().enumerate() {
                let one = |(a, n): (usize, &f64)| *n == f64::from(u8::from(a == k));
                assert!(basis.n.iter().enumerate().all(one));
            }
            assert_eq!(tables.weights.iter().sum::<f64>().round(), 4.0);
        }
    }
}
