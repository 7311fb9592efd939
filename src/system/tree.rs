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
//! The articulated inertia M̂ only grows, so nothing cancels whatever the ratio of the masses, and
//! the cost is linear in the number of bodies (Featherstone 1983, here in absolute coordinates).

use super::constraint::RowGradient;
use super::numbering::Numbering;
use crate::linalg::SingularMatrix;
use crate::math::{Mat3, Scalar};
use crate::model::Model;

/// A joint has at most as many rows.
const ROWS: usize = 6;
/// A pivot below this part of its diagonal entry is singular.
const SINGULAR: f64 = 1e-13;

/// A body and the joint that it hangs from.
#[derive(Clone, Copy, Debug)]
struct Link {
    body: usize,
    /// Joint, whether the body is its side A, and the parent (`None` is ground).
    joint: Option<(usize, bool, Option<usize>)>,
}

/// Factors of one link.
#[derive(Clone)]
struct Factors<S> {
    /// Articulated inertia, then its Cholesky factor L D Lᵀ (D inverted on the diagonal).
    inertia: [[S; 6]; 6],
    /// G_jb M̂⁻¹, row by row.
    lever: [[S; 6]; ROWS],
    /// L D Lᵀ of S.
    schur: [[S; ROWS]; ROWS],
}

/// Planned elimination of a model without closed loops.
#[derive(Clone)]
pub struct Tree<S> {
    /// Leaves first.
    links: Vec<Link>,
    factors: Vec<Factors<S>>,
    /// Link of each body.
    link_of: Vec<usize>,
}

impl<S: Scalar> Tree<S> {
    /// Plans the elimination, or `None` if the joints of `model` close a loop.
    pub fn plan(model: &Model<S>) -> Option<Self> {
        let bodies = model.bodies.len();
        let mut parent: Vec<Option<(usize, bool, Option<usize>)>> = vec![None; bodies];
        let mut used = vec![false; model.joints.len()];
        // Bodies in the order in which they are reached from ground or a free root.
        let mut reached: Vec<usize> = Vec::with_capacity(bodies);
        let mut seen = vec![false; bodies];
        for (j, joint) in model.joints.iter().enumerate() {
            if joint.body_b.is_none() {
                if std::mem::replace(&mut seen[joint.body_a], true) {
                    return None;
                }
                used[j] = true;
                parent[joint.body_a] = Some((j, true, None));
                reached.push(joint.body_a);
            }
        }
        let mut next = 0;
        let mut adjacent = vec![Vec::new(); bodies];
        for (j, joint) in model.joints.iter().enumerate() {
            if let Some(b) = joint.body_b {
                adjacent[joint.body_a].push((j, b, false));
                adjacent[b].push((j, joint.body_a, true));
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
            if root < bodies && !std::mem::replace(&mut seen[root], true) {
                reached.push(root);
            }
        }
        let links: Vec<Link> = reached
            .iter()
            .rev()
            .map(|&body| Link {
                body,
                joint: parent[body],
            })
            .collect();
        let mut link_of = vec![0; bodies];
        for (l, link) in links.iter().enumerate() {
            link_of[link.body] = l;
        }
        let zero = Factors {
            inertia: [[S::zero(); 6]; 6],
            lever: [[S::zero(); 6]; ROWS],
            schur: [[S::zero(); ROWS]; ROWS],
        };
        Some(Self {
            factors: vec![zero; links.len()],
            links,
            link_of,
        })
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
        for (l, link) in self.links.iter().enumerate() {
            let body = &model.bodies[link.body];
            set_inertia(&mut self.factors[l].inertia, body.mass, &body.inertia);
        }
        for l in 0..self.links.len() {
            let link = self.links[l];
            let factors = &mut self.factors[l];
            decompose(&mut factors.inertia, 6).map_err(|i| SingularMatrix {
                column: numbering.velocity(link.body) + i,
            })?;
            let Some((joint, is_a, parent)) = link.joint else {
                continue;
            };
            let rows = numbering.rows(joint);
            let n = rows.len();
            for (i, g) in gradients[rows.clone()].iter().enumerate() {
                let own = six(g, is_a);
                let mut lever = own;
                solve(&factors.inertia, &mut lever, 6);
                factors.lever[i] = lever;
                for (k, other) in gradients[rows.clone()][..=i].iter().enumerate() {
                    factors.schur[i][k] = dot(&factors.lever[i], &six(other, is_a));
                }
            }
            decompose(&mut factors.schur, n).map_err(|i| SingularMatrix {
                column: numbering.velocities() + rows.start + i,
            })?;
            let Some(parent) = parent else { continue };
            // G_jpᵀ S⁻¹ G_jp = Yᵀ D⁻¹ Y with Y = L⁻¹ G_jp.
            let mut y = [[S::zero(); 6]; ROWS];
            let schur = factors.schur;
            for i in 0..n {
                let mut row = six(&gradients[rows.start + i], !is_a);
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

    /// Solves in place for (x, λ) given (f, g), velocities first.
    pub fn solve(&self, numbering: &Numbering, gradients: &[RowGradient<S>], rhs: &mut [S]) {
        let (x, multipliers) = rhs.split_at_mut(numbering.velocities());
        for (link, factors) in self.links.iter().zip(&self.factors) {
            let Some((joint, is_a, parent)) = link.joint else {
                continue;
            };
            let rows = numbering.rows(joint);
            let own = six_of(x, numbering.velocity(link.body));
            let e = &mut multipliers[rows.clone()];
            for (e, lever) in e.iter_mut().zip(&factors.lever) {
                *e = dot(lever, &own) - *e;
            }
            solve(&factors.schur, e, rows.len());
            if let Some(parent) = parent {
                let at = numbering.velocity(parent);
                for (&e, g) in e.iter().zip(&gradients[rows]) {
                    axpy(&mut x[at..at + 6], -e, &six(g, !is_a));
                }
            }
        }
        for (link, factors) in self.links.iter().zip(&self.factors).rev() {
            let at = numbering.velocity(link.body);
            let mut own = six_of(x, at);
            solve(&factors.inertia, &mut own, 6);
            if let Some((joint, is_a, parent)) = link.joint {
                let rows = numbering.rows(joint);
                let mut more = [S::zero(); ROWS];
                if let Some(parent) = parent {
                    let above = six_of(x, numbering.velocity(parent));
                    for (more, g) in more.iter_mut().zip(&gradients[rows.clone()]) {
                        *more = dot(&six(g, !is_a), &above);
                    }
                    solve(&factors.schur, &mut more, rows.len());
                }
                for (i, row) in rows.enumerate() {
                    multipliers[row] += more[i];
                    axpy(&mut own, -multipliers[row], &factors.lever[i]);
                }
            }
            x[at..at + 6].copy_from_slice(&own);
        }
    }
}

fn set_inertia<S: Scalar>(out: &mut [[S; 6]; 6], mass: S, inertia: &Mat3<S>) {
    *out = [[S::zero(); 6]; 6];
    for i in 0..3 {
        out[i][i] = mass;
        for k in 0..3 {
            out[3 + i][3 + k] = inertia[(i, k)];
        }
    }
}

/// The six entries of a row of G on its side A or B.
fn six<S: Scalar>(g: &RowGradient<S>, side_a: bool) -> [S; 6] {
    let (f, t) = (&g.force, if side_a { &g.torque_a } else { &g.torque_b });
    if side_a {
        [f.x, f.y, f.z, t.x, t.y, t.z]
    } else {
        [-f.x, -f.y, -f.z, t.x, t.y, t.z]
    }
}

fn six_of<S: Scalar>(x: &[S], at: usize) -> [S; 6] {
    std::array::from_fn(|i| x[at + i])
}

fn dot<S: Scalar>(a: &[S; 6], b: &[S; 6]) -> S {
    let pair = |i: usize| a[i] * b[i] + a[i + 3] * b[i + 3];
    pair(0) + pair(1) + pair(2)
}

fn axpy<S: Scalar>(out: &mut [S], scale: S, x: &[S; 6]) {
    for (out, &x) in out.iter_mut().zip(x) {
        *out += scale * x;
    }
}

/// Replaces the lower triangle by L (unit, strictly below) and D⁻¹ (diagonal) of A = L D Lᵀ.
///
/// # Errors
/// The row whose pivot is not positive beside its diagonal entry.
fn decompose<S: Scalar>(a: &mut [[S; 6]; 6], n: usize) -> Result<(), usize> {
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
fn solve<S: Scalar>(a: &[[S; 6]; 6], b: &mut [S], n: usize) {
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
