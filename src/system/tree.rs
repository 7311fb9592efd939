//! The saddle-point system of a forest: bodies and joints eliminated leaf by leaf.
//!
//! ```text
//! M_b x_b + Σ_j G_jbᵀ λ_j = f_b          every body b
//! Σ_b G_jb x_b            = g_j          every joint j
//! ```
//!
//! Without closed loops every body hangs from at most one joint. Eliminating a body b, then its
//! joint j, leaves on the parent p
//!
//! ```text
//! S = G_jb M̂_b⁻¹ G_jbᵀ,     M̂_p += G_jpᵀ S⁻¹ G_jp,     f̂_p −= G_jpᵀ S⁻¹ (G_jb M̂_b⁻¹ f̂_b − g_j)
//! ```
//!
//! The articulated inertia M̂ only grows. Its decomposition cancels where a light body carries heavy
//! ones, by as many digits as their masses differ; beyond five the tree gives way to sparse LU.
//! The cost is linear in the number of bodies (Featherstone 1983, here in absolute coordinates).
//! x_b are the unknowns that the mobility of b leaves it; where no body and no joint has more than
//! three, the blocks are of order three.

use super::constraint::RowGradient;
use super::kkt;
use super::numbering::Numbering;
use super::reduce::{inertia, reduced};
use crate::linalg::SingularMatrix;
use crate::math::Scalar;
use crate::model::Model;

/// Most unknowns of a body and most rows of a joint; and where both are small.
const MOST: usize = 6;
const SMALL: usize = 3;
/// A pivot below this part of its diagonal entry has lost too many digits: where a body carries one
/// that is 1e5 times as heavy, sparse LU with its choice of pivots is more accurate.
const SINGULAR: f64 = 1e-5;

/// A body and the joint that it hangs from.
#[derive(Clone, Copy, Debug)]
struct Link {
    body: usize,
    /// Joint, whether the body is its side A, and the parent (`None` is ground).
    joint: Option<(usize, bool, Option<usize>)>,
}

/// Planned elimination of a model without closed loops.
#[derive(Clone)]
pub enum Tree<S> {
    /// Blocks of order three.
    Small(Elimination<S, SMALL>),
    /// Blocks of up to order six.
    Large(Elimination<S, MOST>),
}

impl<S: Scalar> Tree<S> {
    /// Plans the elimination, or `None` if the joints of `model` close a loop.
    pub fn plan(model: &Model<S>, numbering: &Numbering) -> Option<Self> {
        let links = links(model, numbering)?;
        let small = links
            .iter()
            .all(|link| numbering.mobility(link.body).unknowns() == SMALL)
            && (0..numbering.joints()).all(|joint| numbering.rows(joint).len() <= SMALL);
        Some(match small {
            true => Tree::Small(Elimination::new(links, numbering.bodies())),
            false => Tree::Large(Elimination::new(links, numbering.bodies())),
        })
    }

    /// How the matrix is eliminated. Operations are those of blocks of the sizes at hand: a
    /// decomposition of order k takes k³/3, a solution 2 k², a product of all rows what its
    /// factors say.
    pub fn elimination(&self, numbering: &Numbering) -> kkt::Elimination {
        let links = match self {
            Tree::Small(elimination) => &elimination.links,
            Tree::Large(elimination) => &elimination.links,
        };
        let operations = |link: &Link| {
            let m = numbering.mobility(link.body).unknowns();
            let Some((joint, _, parent)) = link.joint else {
                return m.pow(3) / 3;
            };
            let n = numbering.rows(joint).len();
            let p = parent.map_or(0, |parent| numbering.mobility(parent).unknowns());
            m.pow(3) / 3 + n * 2 * m * m + n * n * m + n.pow(3) / 3 + n * n * p + n * p * p
        };
        kkt::Elimination {
            order: numbering.unknowns() + numbering.constraints(),
            bodies: Some(links.iter().map(|link| link.body).collect()),
            fill: None,
            operations: links.iter().map(operations).sum(),
        }
    }

    /// Eliminates with the given masses and inertias (the model's) and gradients of the rows.
    ///
    /// # Errors
    /// [`SingularMatrix`] with a velocity coordinate that has no inertia or a constraint
    /// (n_v + row) that follows from the others.
    pub fn factorise(
        &mut self,
        model: &Model<S>,
        numbering: &Numbering,
        gradients: &[RowGradient<S>],
    ) -> Result<(), SingularMatrix> {
        match self {
            Tree::Small(elimination) => elimination.factorise(model, numbering, gradients),
            Tree::Large(elimination) => elimination.factorise(model, numbering, gradients),
        }
    }

    /// Solves in place for (u, λ) given (Bᵀ f, g), with the factors made last.
    pub fn solve(&self, numbering: &Numbering, rhs: &mut [S]) {
        match self {
            Tree::Small(elimination) => elimination.solve(numbering, rhs),
            Tree::Large(elimination) => elimination.solve(numbering, rhs),
        }
    }
}

/// Links of the tree, leaves first, or `None` if the joints of `model` close a loop.
/// Bodies without unknowns are ground.
fn links<S>(model: &Model<S>, numbering: &Numbering) -> Option<Vec<Link>> {
    let bodies = model.bodies.len();
    let mut parent: Vec<Option<(usize, bool, Option<usize>)>> = vec![None; bodies];
    let mut used = vec![false; model.joints.len()];
    // Bodies in the order in which they are reached from ground or a free root.
    let mut reached: Vec<usize> = Vec::with_capacity(bodies);
    let mut seen = vec![false; bodies];
    let moves = |body: usize| numbering.mobility(body).unknowns() > 0;
    let ends = |j: usize| {
        let joint = &model.joints[j];
        let b = joint.body_b.filter(|&b| moves(b));
        (Some(joint.body_a).filter(|&a| moves(a)), b)
    };
    for j in 0..model.joints.len() {
        let (body, is_a) = match ends(j) {
            (Some(a), None) => (a, true),
            (None, Some(b)) => (b, false),
            (None, None) | (Some(_), Some(_)) => continue,
        };
        if std::mem::replace(&mut seen[body], true) {
            return None;
        }
        used[j] = true;
        parent[body] = Some((j, is_a, None));
        reached.push(body);
    }
    let mut next = 0;
    let mut adjacent = vec![Vec::new(); bodies];
    for j in 0..model.joints.len() {
        if let (Some(a), Some(b)) = ends(j) {
            adjacent[a].push((j, b, false));
            adjacent[b].push((j, a, true));
        }
    }
    for root in 0..=bodies {
        while next < reached.len() {
            let from = reached[next];
            next += 1;
            for &(j, to, is_a) in &adjacent[from] {
                if std::mem::replace(&mut used[j], true) {
                    continue;
                }
                if std::mem::replace(&mut seen[to], true) {
                    return None;
                }
                parent[to] = Some((j, is_a, Some(from)));
                reached.push(to);
            }
        }
        if root < bodies && moves(root) && !std::mem::replace(&mut seen[root], true) {
            reached.push(root);
        }
    }
    let link = |&body: &usize| Link {
        body,
        joint: parent[body],
    };
    Some(reached.iter().rev().map(link).collect())
}

/// Factors of one link in blocks of up to order N.
#[derive(Clone)]
struct Factors<S, const N: usize> {
    /// Articulated inertia, then its Cholesky factor L D Lᵀ (D inverted on the diagonal).
    inertia: [[S; N]; N],
    /// G_jb M̂⁻¹, row by row.
    lever: [[S; N]; N],
    /// G_jp, row by row.
    above: [[S; N]; N],
    /// L D Lᵀ of S.
    schur: [[S; N]; N],
}

/// Elimination in blocks of up to order N.
#[derive(Clone)]
pub struct Elimination<S, const N: usize> {
    /// Leaves first.
    links: Vec<Link>,
    factors: Vec<Factors<S, N>>,
    /// Link of each body.
    link_of: Vec<usize>,
}

/// Unknowns of a body: known beforehand where all have three.
fn size<const N: usize>(numbering: &Numbering, body: usize) -> usize {
    match N {
        SMALL => SMALL,
        _ => numbering.mobility(body).unknowns(),
    }
}

impl<S: Scalar, const N: usize> Elimination<S, N> {
    fn new(links: Vec<Link>, bodies: usize) -> Self {
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
        Self {
            factors: vec![zero; links.len()],
            links,
            link_of,
        }
    }

    fn factorise(
        &mut self,
        model: &Model<S>,
        numbering: &Numbering,
        gradients: &[RowGradient<S>],
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
            let mut own = [[S::zero(); N]; N];
            for (i, g) in gradients[rows.clone()].iter().enumerate() {
                own[i] = reduced(g, is_a, mobility);
                let mut lever = own[i];
                solve(&factors.inertia, &mut lever, m);
                factors.lever[i] = lever;
                for (k, other) in own[..=i].iter().enumerate() {
                    factors.schur[i][k] = dot(&lever, other);
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
        Ok(())
    }

    fn solve(&self, numbering: &Numbering, rhs: &mut [S]) {
        let (x, multipliers) = rhs.split_at_mut(numbering.unknowns());
        for (link, factors) in self.links.iter().zip(&self.factors) {
            let Some((joint, _, parent)) = link.joint else {
                continue;
            };
            let rows = numbering.rows(joint);
            let m = size::<N>(numbering, link.body);
            let own: [S; N] = block(&x[numbering.unknown(link.body)..], m);
            let e = &mut multipliers[rows.clone()];
            for (e, lever) in e.iter_mut().zip(&factors.lever) {
                *e = dot(lever, &own) - *e;
            }
            solve(&factors.schur, e, rows.len());
            if let Some(parent) = parent {
                let at = numbering.unknown(parent);
                let m = size::<N>(numbering, parent);
                for (&e, above) in e.iter().zip(&factors.above) {
                    axpy(&mut x[at..at + m], -e, above);
                }
            }
        }
        for (link, factors) in self.links.iter().zip(&self.factors).rev() {
            let at = numbering.unknown(link.body);
            let m = size::<N>(numbering, link.body);
            let mut own: [S; N] = block(&x[at..], m);
            solve(&factors.inertia, &mut own, m);
            if let Some((joint, _, parent)) = link.joint {
                let rows = numbering.rows(joint);
                let mut more = [S::zero(); N];
                if let Some(parent) = parent {
                    let m = size::<N>(numbering, parent);
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

/// The first m entries of `x`, then zeros.
fn block<S: Scalar, const N: usize>(x: &[S], m: usize) -> [S; N] {
    std::array::from_fn(|i| if i < m { x[i] } else { S::zero() })
}

fn dot<S: Scalar, const N: usize>(a: &[S; N], b: &[S; N]) -> S {
    // Pairs three apart, which do not wait for each other.
    let pair = |i: usize| match N {
        SMALL => a[i] * b[i],
        _ => a[i] * b[i] + a[i + 3] * b[i + 3],
    };
    pair(0) + pair(1) + pair(2)
}

fn axpy<S: Scalar, const N: usize>(out: &mut [S], scale: S, x: &[S; N]) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out += scale * x;
    }
}

/// Replaces the lower triangle by L (unit, strictly below) and D⁻¹ (diagonal) of A = L D Lᵀ.
///
/// # Errors
/// The row whose pivot is not positive beside its diagonal entry.
fn decompose<S: Scalar, const N: usize>(a: &mut [[S; N]; N], n: usize) -> Result<(), usize> {
    for j in 0..n {
        let before = a[j][j].re();
        let mut pivot = a[j][j];
        let mut row = a[j];
        for k in 0..j {
            // row[k] holds L_jk D_k until now.
            let l = row[k] * a[k][k];
            pivot -= row[k] * l;
            row[k] = l;
        }
        if pivot.re() <= SINGULAR * before || !pivot.is_finite() {
            return Err(j);
        }
        a[j] = row;
        a[j][j] = S::one() / pivot;
        for i in j + 1..n {
            let mut sum = a[i][j];
            for k in 0..j {
                sum -= a[i][k] * row[k];
            }
            a[i][j] = sum;
        }
    }
    Ok(())
}

/// Solves L D Lᵀ x = b in place.
fn solve<S: Scalar, const N: usize>(a: &[[S; N]; N], b: &mut [S], n: usize) {
    for i in 1..n {
        let mut sum = b[i];
        for k in 0..i {
            sum -= a[i][k] * b[k];
        }
        b[i] = sum;
    }
    for i in (0..n).rev() {
        let mut sum = b[i] * a[i][i];
        for k in i + 1..n {
            sum -= a[k][i] * b[k];
        }
        b[i] = sum;
    }
}
