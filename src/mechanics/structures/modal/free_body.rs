//! A free body by its nodes, its stiffness and its mass matrix, as codes of finite elements write them.
//!
//! An unknown is a displacement (component 0, 1, 2) or a rotation (3, 4, 5) of a node along or about the axes
//! of the body. Unknowns without stiffness and mass are left out.

use super::written::{Entry, WrittenMatrix, deviation};
use crate::linalg::cholesky::{SparseCholesky, SymmetricPattern, fill_reducing_order};
use crate::math::Vec3;

/// Forces of a rigid motion that the stiffness of a free body may have, relative to the forces of
/// all its entries, in addition to the effect of rounding.
const FREE: f64 = 1e-5;
/// Negative mass of a motion relative to that of the diagonal, in addition to the effect of rounding.
const NEGATIVE: f64 = 1e-6;
/// Relative difference of the masses in three directions, in addition to the effect of rounding.
const ONE_MASS: f64 = 1e-5;

/// A component of the motion of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Index of the node.
    pub node: usize,
    /// 0, 1, 2: displacement along x, y, z; 3, 4, 5: rotation about them.
    pub component: usize,
}

/// A body without supports.
#[derive(Clone, Debug)]
pub struct FreeBody {
    /// Positions of the nodes \[m\].
    pub nodes: Vec<Vec3<f64>>,
    /// Component of each row of the matrices.
    pub unknowns: Vec<Unknown>,
    /// The common pattern of both matrices.
    pub pattern: SymmetricPattern,
    /// K.
    pub stiffness: Vec<f64>,
    /// M.
    pub mass: Vec<f64>,
    /// Largest changes of the entries of K and of M by rounding.
    pub rounding: [Vec<f64>; 2],
    /// Components of the nodes without stiffness and mass.
    pub empty: usize,
}

/// Why matrices are not those of a free body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoFreeBody {
    #[error("a stiffness or mass of {value:.3e} on the diagonal of {unknown}")]
    Negative {
        /// "node 3, displacement along x".
        unknown: String,
        /// The entry.
        value: f64,
    },
    #[error(
        "a stiffness that resists a rigid {motion}: {part:.1e} of the forces of its entries remain"
    )]
    Held {
        /// "displacement along x".
        motion: &'static str,
        /// Remaining force, relative to that of the entries.
        part: f64,
    },
    #[error(
        "a mass matrix that is not positive: a motion that is largest in the {unknown} has {part:.1e} times the mass \
         of its diagonal"
    )]
    Indefinite {
        /// "displacement along x of node 3".
        unknown: String,
        /// xᵀ M x, relative to that of the diagonal of M.
        part: f64,
    },
    #[error("masses of {x:.6e}, {y:.6e} and {z:.6e} kg along x, y and z")]
    Masses {
        /// Along x \[kg\].
        x: f64,
        /// Along y \[kg\].
        y: f64,
        /// Along z \[kg\].
        z: f64,
    },
}

/// Names of the components.
pub const COMPONENTS: [&str; 6] = [
    "displacement along x",
    "displacement along y",
    "displacement along z",
    "rotation about x",
    "rotation about y",
    "rotation about z",
];

impl FreeBody {
    /// Assembles exact matrices. Keys are below six times the number of nodes.
    pub fn new(nodes: Vec<Vec3<f64>>, stiffness: &[Entry], mass: &[Entry]) -> Self {
        let exact = |entries: &[Entry]| WrittenMatrix {
            entries: entries.to_vec(),
            rounding: vec![0.0; entries.len()],
        };
        Self::written(nodes, &exact(stiffness), &exact(mass))
    }

    /// Assembles the matrices of files.
    pub fn written(nodes: Vec<Vec3<f64>>, stiffness: &WrittenMatrix, mass: &WrittenMatrix) -> Self {
        let roundings = [stiffness, mass].map(WrittenMatrix::roundings);
        let (stiffness, mass) = (&stiffness.entries, &mass.entries);
        let both = || stiffness.iter().chain(mass).filter(|entry| entry.2 != 0.0);
        let mut there = vec![false; 6 * nodes.len()];
        let mut neighbours = vec![Vec::new(); nodes.len()];
        for &(i, j, _) in both() {
            there[i] = true;
            there[j] = true;
            let (a, b) = (i / 6, j / 6);
            if a != b {
                neighbours[a.min(b)].push(a.max(b));
            }
        }
        for list in &mut neighbours {
            list.sort_unstable();
            list.dedup();
        }
        let mut unknowns = Vec::new();
        let mut number = vec![usize::MAX; there.len()];
        for node in fill_reducing_order(&neighbours) {
            for component in (0..6).filter(|k| there[6 * node + k]) {
                number[6 * node + component] = unknowns.len();
                unknowns.push(Unknown { node, component });
            }
        }
        let mut columns: Vec<Vec<usize>> = (0..unknowns.len()).map(|j| vec![j]).collect();
        for &(i, j, _) in both() {
            let (i, j) = (number[i], number[j]);
            columns[i.min(j)].push(i.max(j));
        }
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
        }
        let pattern = SymmetricPattern::new(&columns);
        let scatter = |entries: &[Entry]| {
            let mut values = vec![0.0; pattern.entries()];
            for &(i, j, value) in entries.iter().filter(|entry| entry.2 != 0.0) {
                let (i, j) = (number[i], number[j]);
                let slot = pattern.slot(i.max(j), i.min(j));
                values[slot.expect("the pattern has all entries")] += value;
            }
            values
        };
        Self {
            stiffness: scatter(stiffness),
            mass: scatter(mass),
            rounding: roundings.each_ref().map(|all| scatter(all)),
            empty: there.iter().filter(|there| !**there).count(),
            nodes,
            unknowns,
            pattern,
        }
    }

    /// A motion in which every node moves with `u + θ × X` and turns with θ.
    pub fn rigid(&self, u: &Vec3<f64>, turn: &Vec3<f64>) -> Vec<f64> {
        let value = |unknown: &Unknown| match unknown.component {
            k @ 0..3 => u[k] + turn.cross(&self.nodes[unknown.node])[k],
            k => turn[k - 3],
        };
        self.unknowns.iter().map(value).collect()
    }

    /// The six rigid motions: displacements, and rotations about an axis through `about`.
    pub fn rigid_motions(&self, about: &Vec3<f64>) -> [Vec<f64>; 6] {
        std::array::from_fn(|k| {
            let axis = Vec3::ith(k % 3, 1.0);
            match k {
                0..3 => self.rigid(&axis, &Vec3::zeros()),
                _ => self.rigid(&-axis.cross(about), &axis),
            }
        })
    }

    /// Mean position of the nodes \[m\].
    pub fn middle(&self) -> Vec3<f64> {
        self.nodes.iter().sum::<Vec3<f64>>() / self.nodes.len().max(1) as f64
    }

    /// The motion of the most negative mass, and that mass relative to that of the diagonal of M; none if no
    /// motion has a negative mass beyond rounding.
    fn negative_mass(&self) -> Option<(Unknown, f64)> {
        if self.unknowns.is_empty() {
            return None;
        }
        let mut coupled = vec![false; self.unknowns.len()];
        for j in 0..coupled.len() {
            let beside = self.pattern.column(j).skip(1);
            for (_, i) in beside.filter(|(at, _)| self.mass[*at] != 0.0) {
                coupled[i] = true;
                coupled[j] = true;
            }
        }
        let mut values = self.mass.clone();
        for (j, coupled) in coupled.into_iter().enumerate() {
            let slot = self.pattern.slot(j, j)?;
            // An unknown without mass.
            if values[slot] == 0.0 && !coupled {
                values[slot] = 1.0;
            }
        }
        let failure = SparseCholesky::new(&self.pattern)
            .factorise(&self.pattern, &values)
            .err()?;
        let x = &failure.direction;
        let mut product = vec![0.0; x.len()];
        self.pattern.multiply(&self.mass, x, &mut product);
        let mass: f64 = x.iter().zip(&product).map(|(x, y)| x * y).sum();
        let diagonal = (0..x.len()).filter_map(|j| {
            let slot = self.pattern.slot(j, j)?;
            Some(self.mass[slot] * x[j] * x[j])
        });
        let diagonal = diagonal.sum::<f64>().max(f64::MIN_POSITIVE);
        let rounding = 3.0 * deviation(&self.pattern, &self.rounding[1], x);
        let sizes = x.iter().map(|x| x.abs()).enumerate();
        let (most, _) = sizes.max_by(|a, b| a.1.total_cmp(&b.1))?;
        // A mass that is no number is that of entries of very different sizes.
        let sound = mass >= -(NEGATIVE * diagonal + rounding);
        (!sound).then(|| (self.unknowns[most], mass / diagonal))
    }

    /// Checks that these can be the matrices of a free body; `name` tells a node.
    ///
    /// # Errors
    /// [`NoFreeBody`]: a negative diagonal, a mass matrix that is not positive, supports, or masses that differ
    /// along the axes.
    pub fn check(&self, name: impl Fn(usize) -> String) -> Result<(), NoFreeBody> {
        let order = self.unknowns.len();
        let diagonal = |values: &[f64], j: usize| {
            let slot = self.pattern.slot(j, j);
            slot.map_or(0.0, |slot| values[slot])
        };
        for (j, unknown) in self.unknowns.iter().enumerate() {
            for values in [&self.stiffness, &self.mass] {
                let value = diagonal(values, j);
                if value < 0.0 {
                    let unknown = format!(
                        "node {}, {}",
                        name(unknown.node),
                        COMPONENTS[unknown.component]
                    );
                    return Err(NoFreeBody::Negative { unknown, value });
                }
            }
        }
        if let Some((unknown, part)) = self.negative_mass() {
            let unknown = format!(
                "{} of node {}",
                COMPONENTS[unknown.component],
                name(unknown.node)
            );
            return Err(NoFreeBody::Indefinite { unknown, part });
        }
        let scale: Vec<f64> = (0..order)
            .map(|j| diagonal(&self.stiffness, j))
            .map(|k| if k > 0.0 { 1.0 / k.sqrt() } else { 0.0 })
            .collect();
        let sizes: Vec<f64> = self.stiffness.iter().map(|x| x.abs()).collect();
        let norm = |values: &[f64], x: &[f64]| {
            let mut y = vec![0.0; order];
            self.pattern.multiply(values, x, &mut y);
            let squares = y.iter().zip(&scale).map(|(y, s)| (y * s).powi(2));
            squares.sum::<f64>().sqrt()
        };
        for (k, motion) in self.rigid_motions(&self.middle()).iter().enumerate() {
            let all: Vec<f64> = motion.iter().map(|x| x.abs()).collect();
            let size = norm(&sizes, &all).max(f64::MIN_POSITIVE);
            let part = norm(&self.stiffness, motion) / size;
            if part > FREE + norm(&self.rounding[0], &all) / size {
                let motion = COMPONENTS[k];
                return Err(NoFreeBody::Held { motion, part });
            }
        }
        let masses: [f64; 3] = std::array::from_fn(|k| {
            let axis = Vec3::ith(k, 1.0);
            let motion = self.rigid(&axis, &Vec3::zeros());
            let mut product = vec![0.0; order];
            self.pattern.multiply(&self.mass, &motion, &mut product);
            motion.iter().zip(&product).map(|(a, b)| a * b).sum()
        });
        let [x, y, z] = masses;
        let (least, most) = (x.min(y).min(z), x.max(y).max(z));
        let rounded: f64 = 2.0 * self.rounding[1].iter().sum::<f64>();
        if !(least > 0.0 && most - least <= ONE_MASS * most + rounded) {
            return Err(NoFreeBody::Masses { x, y, z });
        }
        Ok(())
    }
}
