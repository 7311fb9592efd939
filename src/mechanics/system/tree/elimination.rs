//! Elimination of bodies and joints, leaves first, in blocks of up to order N.

use super::blocks::{Factors, inertia, reduced, size, unknowns};
use super::dense::{axpy, block, decompose, dot, solve};
use super::links::{Forest, Link};
use super::loops::Loops;
use crate::linalg::SingularMatrix;
use crate::math::Scalar;
use crate::model::Model;
use crate::system::constraint::RowGradient;
use crate::system::numbering::Numbering;
use crate::system::redundant_rows::RedundantRows;

/// A row moves its body by turning it more than so many times as by shifting it: the angular acceleration of a bob, which
/// has hardly any inertia of its own, loses as many digits.
const MOST_LEVER: f64 = 1e6;

/// Elimination in blocks of up to order N.
#[derive(Clone)]
pub struct Elimination<S, const N: usize> {
    /// Leaves first.
    pub(super) links: Vec<Link>,
    factors: Vec<Factors<S, N>>,
    /// Link of each body.
    link_of: Vec<usize>,
    /// Whether all bodies have N unknowns.
    full: bool,
    /// The joints that close loops, if any.
    pub(super) loops: Option<Loops<S, N>>,
}

impl<S: Scalar, const N: usize> Elimination<S, N> {
    /// Plans the elimination; `None` if there are so many loops that sparse LU costs less.
    pub(super) fn plan<M>(model: &Model<M>, numbering: &Numbering, forest: Forest) -> Option<Self> {
        let Forest { links, closing } = forest;
        let bodies = numbering.bodies();
        let mut link_of = vec![0; bodies];
        for (l, link) in links.iter().enumerate() {
            link_of[link.body] = l;
        }
        let zero = [[S::zero(); N]; N];
        let zero = Factors {
            inertia: zero,
            lever: zero,
            above: zero,
            schur: zero,
        };
        let loops = match closing.is_empty() {
            true => None,
            false => Some(Loops::plan(model, numbering, &links, &link_of, &closing)?),
        };
        Some(Self {
            factors: vec![zero; links.len()],
            full: links
                .iter()
                .all(|link| numbering.unknowns_of(link.body) == N),
            links,
            link_of,
            loops,
        })
    }

    /// The links, the joints that close loops, and the number of operations for these.
    pub(super) fn parts(&self, numbering: &Numbering) -> (&[Link], Vec<usize>, usize) {
        let closing = self.loops.iter().flat_map(Loops::joints).collect();
        let operations = (self.loops.iter()).map(|loops| loops.operations(numbering, &self.links));
        (&self.links, closing, operations.sum())
    }

    pub(super) fn factorise(
        &mut self,
        model: &Model<S>,
        numbering: &Numbering,
        (gradients, left_out): (&[RowGradient<S>], &RedundantRows),
    ) -> Result<(), SingularMatrix> {
        for (link, factors) in self.links.iter().zip(&mut self.factors) {
            let mobility = numbering.mobility(link.body);
            factors.inertia = inertia(&model.bodies[link.body], mobility);
        }
        for l in 0..self.links.len() {
            let link = self.links[l];
            let factors = &mut self.factors[l];
            let m = size::<N>(numbering, link.body);
            decompose(&mut factors.inertia, m).map_err(|i| SingularMatrix {
                column: numbering.velocity(link.body) + i,
            })?;
            let Some((joint, is_a, parent)) = link.joint else {
                continue;
            };
            let rows = numbering.rows(joint);
            let n = rows.len();
            let mobility = numbering.mobility(link.body);
            let (linear, mass) = (
                mobility.translation.free(),
                model.bodies[link.body].mass.re(),
            );
            let mut own = [[S::zero(); N]; N];
            for (i, g) in gradients[rows.clone()].iter().enumerate() {
                own[i] = reduced(g, is_a, mobility);
                let mut lever = own[i];
                solve(&factors.inertia, &mut lever, m);
                factors.lever[i] = lever;
                for (k, other) in own[..=i].iter().enumerate() {
                    factors.schur[i][k] = dot(&lever, other);
                }
                let at_rest = own[i][..linear]
                    .iter()
                    .map(|x| x.re() * x.re())
                    .sum::<f64>()
                    / mass;
                if at_rest > 0.0 && factors.schur[i][i].re() > MOST_LEVER * at_rest {
                    return Err(SingularMatrix {
                        column: numbering.velocities() + rows.start + i,
                    });
                }
                if left_out.contains(rows.start + i) {
                    factors.schur[i][i] = S::one();
                }
            }
            decompose(&mut factors.schur, n).map_err(|i| SingularMatrix {
                column: numbering.velocities() + rows.start + i,
            })?;
            let Some(parent) = parent else { continue };
            // G_jpᵀ S⁻¹ G_jp = Yᵀ D⁻¹ Y with Y = L⁻¹ G_jp.
            let mobility = numbering.mobility(parent);
            let mut y = [[S::zero(); N]; N];
            let schur = factors.schur;
            for i in 0..n {
                let mut row = reduced(&gradients[rows.start + i], !is_a, mobility);
                factors.above[i] = row;
                for k in 0..i {
                    axpy(&mut row, -schur[i][k], &y[k]);
                }
                y[i] = row;
            }
            let target = &mut self.factors[self.link_of[parent]].inertia;
            for (i, y) in y[..n].iter().enumerate() {
                for (r, target) in target.iter_mut().enumerate() {
                    let scaled = y[r] * schur[i][i];
                    for (target, &y) in target[..=r].iter_mut().zip(y) {
                        *target += scaled * y;
                    }
                }
            }
        }
        if let Some(loops) = &mut self.loops {
            let tree = (&self.links[..], &self.factors[..]);
            loops.factorise(numbering, (gradients, left_out), tree)?;
        }
        Ok(())
    }

    pub(super) fn solve(&mut self, numbering: &Numbering, rhs: &mut [S]) {
        match self.full {
            true => self.solve_sized::<true>(numbering, rhs),
            false => self.solve_sized::<false>(numbering, rhs),
        }
    }

    fn solve_sized<const FULL: bool>(&mut self, numbering: &Numbering, rhs: &mut [S]) {
        let (x, multipliers) = rhs.split_at_mut(numbering.unknowns());
        for (link, factors) in self.links.iter().zip(&self.factors) {
            let Some((joint, _, parent)) = link.joint else {
                continue;
            };
            let rows = numbering.rows(joint);
            let m = unknowns::<N, FULL>(numbering, link.body);
            let own: [S; N] = block(&x[numbering.unknown(link.body)..], m);
            let e = &mut multipliers[rows.clone()];
            for (e, lever) in e.iter_mut().zip(&factors.lever) {
                *e = dot(lever, &own) - *e;
            }
            solve(&factors.schur, e, rows.len());
            if let Some(parent) = parent {
                let at = numbering.unknown(parent);
                let m = unknowns::<N, FULL>(numbering, parent);
                for (&e, above) in e.iter().zip(&factors.above) {
                    axpy(&mut x[at..at + m], -e, above);
                }
            }
        }
        if let Some(loops) = &mut self.loops {
            loops.close::<FULL>(numbering, &self.links, x, multipliers);
        }
        for (link, factors) in self.links.iter().zip(&self.factors).rev() {
            let at = numbering.unknown(link.body);
            let m = unknowns::<N, FULL>(numbering, link.body);
            let mut own: [S; N] = block(&x[at..], m);
            solve(&factors.inertia, &mut own, size::<N>(numbering, link.body));
            if let Some((joint, _, parent)) = link.joint {
                let rows = numbering.rows(joint);
                let mut more = [S::zero(); N];
                if let Some(parent) = parent {
                    let m = unknowns::<N, FULL>(numbering, parent);
                    let known: [S; N] = block(&x[numbering.unknown(parent)..], m);
                    for (more, above) in more[..rows.len()].iter_mut().zip(&factors.above) {
                        *more = dot(above, &known);
                    }
                    solve(&factors.schur, &mut more, rows.len());
                }
                for (i, row) in rows.enumerate() {
                    multipliers[row] += more[i];
                    axpy(&mut own, -multipliers[row], &factors.lever[i]);
                }
            }
            x[at..at + m].copy_from_slice(&own[..m]);
        }
    }
}
