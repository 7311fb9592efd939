//! Elimination of the rows of joints that close loops, after the forest.
//!
//! Let T be the matrix of the forest and L the rows of the closing joints:
//!
//! ```text
//! [T Lᵀ; L 0] (x, μ) = (f, g)      →      L T⁻¹ Lᵀ μ = L T⁻¹ f − g,      T x = f − Lᵀ μ
//! ```
//!
//! A row ℓ involves only the links between its two bodies and ground. It is swept towards ground
//! like a force: it gives body b the force f_ℓb, and its joint j the gap e_ℓj = G_jb M̂_b⁻¹ f_ℓb,
//! so that
//!
//! ```text
//! (L T⁻¹ Lᵀ)_ℓκ = Σ_b f_ℓbᵀ M̂_b⁻¹ f_κb − Σ_j e_ℓjᵀ S_j⁻¹ e_κj
//! ```
//!
//! over the links of both rows. This matrix is positive definite if the rows are independent. It is
//! stored by envelope, so in a chain of loops the cost per loop is constant.

use super::blocks::{Factors, reduced, size, unknowns};
use super::dense::{axpy, block, dot, solve};
use super::envelope::Envelope;
use super::links::Link;
use crate::linalg::SingularMatrix;
use crate::math::Scalar;
use crate::math::slices;
use crate::model::Model;
use crate::system::constraint::RowGradient;
use crate::system::numbering::Numbering;
use crate::system::redundant_rows::RedundantRows;
use std::ops::Range;

/// Largest number of blocks of work per link. If loops are long and overlap, sparse LU has less
/// fill.
const MOST_WORK: usize = 32;

/// A joint that closes a loop.
#[derive(Clone)]
struct Closing {
    joint: usize,
    /// Bodies on which it acts, and whether each is on its side A.
    ends: [Option<(usize, bool)>; 2],
    /// Range of its rows among those of all closing joints.
    rows: Range<usize>,
    /// Its links, leaves first.
    path: Vec<usize>,
    /// First index of the waves of its first row.
    waves: usize,
}

/// Two closing joints, the later one first, with the positions of common links in both paths.
#[derive(Clone)]
struct Pair {
    joints: [usize; 2],
    places: Vec<[usize; 2]>,
}

/// Effect of a row on a link.
#[derive(Clone, Copy)]
struct Wave<S, const N: usize> {
    /// f on the body.
    force: [S; N],
    /// M̂⁻¹ f.
    response: [S; N],
    /// e of its joint.
    gap: [S; N],
    /// S⁻¹ e.
    balance: [S; N],
}

impl<S: Scalar, const N: usize> Wave<S, N> {
    fn none() -> Self {
        let zero = [S::zero(); N];
        Self {
            force: zero,
            response: zero,
            gap: zero,
            balance: zero,
        }
    }
}

/// The closing joints with their waves and the factors of L T⁻¹ Lᵀ.
#[derive(Clone)]
pub(super) struct Loops<S, const N: usize> {
    closing: Vec<Closing>,
    pairs: Vec<Pair>,
    waves: Vec<Wave<S, N>>,
    /// Forces on the bodies of the links, during a sweep.
    forces: Vec<[S; N]>,
    link_of: Vec<usize>,
    matrix: Envelope<S>,
    rhs: Vec<S>,
}

impl<S: Scalar, const N: usize> Loops<S, N> {
    /// Plans the rows of the joints `joints`; `None` if sparse LU costs less.
    pub fn plan<M>(
        model: &Model<M>,
        numbering: &Numbering,
        links: &[Link],
        link_of: &[usize],
        joints: &[usize],
    ) -> Option<Self> {
        let (mut closing, mut rows, mut waves) = (Vec::<Closing>::new(), 0, 0);
        for &j in joints {
            let joint = &model.joints[j];
            let sides = [(Some(joint.body_a), true), (joint.body_b, false)];
            let moves = |body: &usize| numbering.unknowns_of(*body) > 0;
            let ends = sides.map(|(body, is_a)| Some((body.filter(moves)?, is_a)));
            let mut path = Vec::new();
            for (body, _) in ends.iter().flatten() {
                let mut next = Some(*body);
                while let Some(body) = next {
                    path.push(link_of[body]);
                    next = links[link_of[body]].joint.and_then(|(_, _, parent)| parent);
                }
            }
            path.sort_unstable();
            path.dedup();
            let count = numbering.rows(j).len();
            let from = waves;
            waves += count * path.len();
            closing.push(Closing {
                joint: j,
                ends,
                rows: rows..rows + count,
                path,
                waves: from,
            });
            rows += count;
        }
        // Redundant rows cost nothing.
        let imposed = |closing: &Closing| model.joints[closing.joint].imposed().count();
        let mut work: usize = closing.iter().map(|c| imposed(c) * c.path.len()).sum();
        let mut pairs = Vec::new();
        let mut first = Vec::new();
        for (c, later) in closing.iter().enumerate() {
            let mut least = later.rows.start;
            for (d, other) in closing[..=c].iter().enumerate() {
                let places = common(&later.path, &other.path);
                if !places.is_empty() {
                    least = least.min(other.rows.start);
                    work += places.len() * imposed(later) * imposed(other) / N;
                    pairs.push(Pair {
                        joints: [c, d],
                        places,
                    });
                }
            }
            work += imposed(later) * (later.rows.end - least) / N;
            first.extend(later.rows.clone().map(|_| least));
        }
        if work > MOST_WORK * links.len() {
            return None;
        }
        Some(Self {
            closing,
            pairs,
            waves: vec![Wave::none(); waves],
            forces: vec![[S::zero(); N]; links.len()],
            link_of: link_of.to_vec(),
            matrix: Envelope::new(first),
            rhs: vec![S::zero(); rows],
        })
    }

    /// The closing joints.
    pub fn joints(&self) -> impl Iterator<Item = usize> + '_ {
        self.closing.iter().map(|closing| closing.joint)
    }

    /// Number of operations of a factorisation.
    pub fn operations(&self, numbering: &Numbering, links: &[Link]) -> usize {
        let sweep = |closing: &Closing| {
            let link = |&l: &usize| {
                let m = numbering.unknowns_of(links[l].body);
                let n = (links[l].joint).map_or(0, |(joint, ..)| numbering.rows(joint).len());
                2 * (m * m + 2 * m * n + n * n)
            };
            closing.rows.len() * closing.path.iter().map(link).sum::<usize>()
        };
        let product = |pair: &Pair| {
            let [c, d] = pair.joints.map(|c| self.closing[c].rows.len());
            4 * N * c * d * pair.places.len()
        };
        let sweeps: usize = self.closing.iter().map(sweep).sum();
        sweeps + self.pairs.iter().map(product).sum::<usize>() + self.matrix.operations()
    }

    /// Sweeps the rows through the factors of the forest and decomposes L T⁻¹ Lᵀ.
    ///
    /// # Errors
    /// [`SingularMatrix`] with the index (n_v + row) of a dependent row.
    pub fn factorise(
        &mut self,
        numbering: &Numbering,
        (gradients, left_out): (&[RowGradient<S>], &RedundantRows),
        (links, factors): (&[Link], &[Factors<S, N>]),
    ) -> Result<(), SingularMatrix> {
        for closing in &self.closing {
            let length = closing.path.len();
            for (i, row) in numbering.rows(closing.joint).enumerate() {
                for &l in &closing.path {
                    self.forces[l] = [S::zero(); N];
                }
                for &(body, is_a) in closing.ends.iter().flatten() {
                    let mobility = numbering.mobility(body);
                    self.forces[self.link_of[body]] = reduced(&gradients[row], is_a, mobility);
                }
                let from = closing.waves + i * length;
                if left_out.contains(row) {
                    self.waves[from..from + length].fill(Wave::none());
                    continue;
                }
                for (wave, &l) in self.waves[from..from + length]
                    .iter_mut()
                    .zip(&closing.path)
                {
                    let (link, factors) = (&links[l], &factors[l]);
                    let force = self.forces[l];
                    let m = size::<N>(numbering, link.body);
                    wave.force = force;
                    wave.response = force;
                    solve(&factors.inertia, &mut wave.response, m);
                    let Some((joint, _, parent)) = link.joint else {
                        continue;
                    };
                    let n = numbering.rows(joint).len();
                    for (gap, lever) in wave.gap[..n].iter_mut().zip(&factors.lever) {
                        *gap = dot(lever, &force);
                    }
                    wave.balance = wave.gap;
                    solve(&factors.schur, &mut wave.balance, n);
                    if let Some(parent) = parent {
                        let to = &mut self.forces[self.link_of[parent]];
                        for (&e, above) in wave.balance[..n].iter().zip(&factors.above) {
                            axpy(to, -e, above);
                        }
                    }
                }
            }
        }
        self.assemble(numbering, left_out);
        let row = self.matrix.decompose();
        row.map_err(|row| SingularMatrix {
            column: numbering.velocities() + self.row(numbering, row),
        })
    }

    /// The constraint row with the number `row` among the closing ones.
    fn row(&self, numbering: &Numbering, row: usize) -> usize {
        let closing = self.closing.iter().find(|c| c.rows.contains(&row));
        closing.map_or(0, |c| numbering.rows(c.joint).start + row - c.rows.start)
    }

    /// Assembles L T⁻¹ Lᵀ, with the unit matrix in redundant rows.
    fn assemble(&mut self, numbering: &Numbering, left_out: &RedundantRows) {
        self.matrix.clear();
        let out = |c: &Closing, i: usize| left_out.contains(numbering.rows(c.joint).start + i);
        for closing in &self.closing {
            for (i, row) in closing.rows.clone().enumerate() {
                if out(closing, i) {
                    self.matrix.set(row, row, S::one(), 1.0);
                }
            }
        }
        for Pair { joints, places } in &self.pairs {
            let [c, d] = joints.map(|c| &self.closing[c]);
            for (i, row) in c.rows.clone().enumerate() {
                if out(c, i) {
                    continue;
                }
                for (k, column) in d.rows.clone().enumerate() {
                    if column > row {
                        break;
                    }
                    if out(d, k) {
                        continue;
                    }
                    let (mut sum, mut size) = (S::zero(), 0.0);
                    for &[p, q] in places {
                        let a = &self.waves[c.waves + i * c.path.len() + p];
                        let b = &self.waves[d.waves + k * d.path.len() + q];
                        let inertial = dot(&a.force, &b.response);
                        size += inertial.re();
                        sum += inertial - dot(&a.gap, &b.balance);
                    }
                    self.matrix.set(row, column, sum, size);
                }
            }
        }
    }

    /// Computes μ from `x` and `multipliers` after the forward sweep of the forest (f̂_b, and S⁻¹
    /// ê_j; g in the closing rows), and subtracts the swept Lᵀ μ from both.
    pub fn close<const FULL: bool>(
        &mut self,
        numbering: &Numbering,
        links: &[Link],
        x: &mut [S],
        multipliers: &mut [S],
    ) {
        for closing in &self.closing {
            let rows = numbering.rows(closing.joint);
            for (i, row) in rows.enumerate() {
                let mut sum = -multipliers[row];
                let waves = &self.waves[closing.waves + i * closing.path.len()..];
                for (wave, &l) in waves.iter().zip(&closing.path) {
                    let link = &links[l];
                    let m = unknowns::<N, FULL>(numbering, link.body);
                    sum += dot(
                        &wave.response,
                        &block(&x[numbering.unknown(link.body)..], m),
                    );
                    if let Some((joint, ..)) = link.joint {
                        sum -= slices::dot(&multipliers[numbering.rows(joint)], &wave.gap);
                    }
                }
                self.rhs[closing.rows.start + i] = sum;
            }
        }
        self.matrix.solve(&mut self.rhs);
        for closing in &self.closing {
            let rows = numbering.rows(closing.joint);
            for (i, row) in rows.enumerate() {
                let mu = self.rhs[closing.rows.start + i];
                multipliers[row] = mu;
                let waves = &self.waves[closing.waves + i * closing.path.len()..];
                for (wave, &l) in waves.iter().zip(&closing.path) {
                    let link = &links[l];
                    let m = unknowns::<N, FULL>(numbering, link.body);
                    let at = numbering.unknown(link.body);
                    axpy(&mut x[at..at + m], -mu, &wave.force);
                    if let Some((joint, ..)) = link.joint {
                        let own = multipliers[numbering.rows(joint)].iter_mut();
                        own.zip(&wave.balance).for_each(|(e, &b)| *e -= b * mu);
                    }
                }
            }
        }
    }
}

/// Pairs of positions of the common entries of two ascending lists.
fn common(a: &[usize], b: &[usize]) -> Vec<[usize; 2]> {
    let mut found = Vec::new();
    let (mut p, mut q) = (0, 0);
    while let (Some(x), Some(y)) = (a.get(p), b.get(q)) {
        if x == y {
            found.push([p, q]);
        }
        (p, q) = (p + usize::from(x <= y), q + usize::from(y <= x));
    }
    found
}
