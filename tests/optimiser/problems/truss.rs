//! The stiffest truss of a given volume in a ground structure.

use clarabel::algebra::CscMatrix;
use clarabel::qdldl::QDLDLFactorisation;
use flexbody_optimiser::{Curvature, Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp};

/// Minimise the compliance pᵀu with K(x) u = p over the areas x of all bars; their volume is
/// given. The grid is fixed on its left edge and loaded at the middle of its right edge.
pub struct Truss {
    /// Degrees of freedom and direction cosines of each bar, and its length.
    pub bars: Vec<([Option<usize>; 4], [f64; 4], f64)>,
    pub freedoms: usize,
    loaded: usize,
    volume: f64,
    /// Where the entries of each bar go in the matrix.
    pattern: CscMatrix<f64>,
    places: Vec<[usize; 10]>,
    factors: Option<QDLDLFactorisation<f64>>,
    last: Option<(Vec<f64>, Vec<f64>)>,
    /// Whether the program gives its second derivatives.
    pub with_curvature: bool,
}

/// Least area, relative to the mean area.
const LEAST: f64 = 1e-3;

impl Truss {
    /// A grid of `columns` × `rows` nodes; each node is joined to those within three spacings.
    pub fn new(columns: usize, rows: usize) -> Truss {
        let mut offsets = Vec::new();
        for i in 0..=3_i64 {
            for j in -3..=3_i64 {
                let coprime = match (i, j.abs()) {
                    (0, 1) => j == 1,
                    (1, 0) => true,
                    (0, _) | (_, 0) => false,
                    (a, b) => a == 1 || b == 1 || a * b == 6,
                };
                if coprime {
                    offsets.push((i, j));
                }
            }
        }
        let freedom = |c: usize, r: usize, k: usize| (c > 0).then(|| 2 * ((c - 1) * rows + r) + k);
        let mut bars = Vec::new();
        for c in 0..columns {
            for r in 0..rows {
                for &(dc, dr) in &offsets {
                    let (to_c, to_r) = (c + dc as usize, r as i64 + dr);
                    if to_c >= columns || !(0..rows as i64).contains(&to_r) || (c == 0 && dc == 0) {
                        continue;
                    }
                    let to_r = to_r as usize;
                    let length = ((dc * dc + dr * dr) as f64).sqrt();
                    let (a, b) = (dc as f64 / length, dr as f64 / length);
                    let ends = [
                        freedom(c, r, 0),
                        freedom(c, r, 1),
                        freedom(to_c, to_r, 0),
                        freedom(to_c, to_r, 1),
                    ];
                    bars.push((ends, [-a, -b, a, b], length));
                }
            }
        }
        let freedoms = 2 * (columns - 1) * rows;
        let mut all: Vec<(usize, usize)> = Vec::new();
        for (ends, _, _) in &bars {
            all.extend(pairs(ends).flatten().map(|(i, k)| (i.max(k), i.min(k))));
        }
        all.sort_unstable();
        all.dedup();
        let mut pointers = vec![0; freedoms + 1];
        for &(column, _) in &all {
            pointers[column + 1] += 1;
        }
        for k in 0..freedoms {
            pointers[k + 1] += pointers[k];
        }
        let indices = all.iter().map(|e| e.1).collect();
        let place = |pair: Option<(usize, usize)>| match pair {
            Some((i, k)) => all
                .binary_search(&(i.max(k), i.min(k)))
                .expect("the entry exists"),
            None => usize::MAX,
        };
        let places = bars
            .iter()
            .map(|(ends, _, _)| {
                let mut found = [0; 10];
                for (slot, pair) in found.iter_mut().zip(pairs(ends)) {
                    *slot = place(pair);
                }
                found
            })
            .collect();
        let values = vec![0.0; all.len()];
        Truss {
            volume: bars.iter().map(|b| b.2).sum(),
            pattern: CscMatrix::new(freedoms, freedoms, pointers, indices, values),
            bars,
            freedoms,
            loaded: 2 * ((columns - 2) * rows + rows / 2) + 1,
            places,
            factors: None,
            last: None,
            with_curvature: false,
        }
    }

    /// Entries of the stiffness matrix K(x).
    fn matrix(&self, x: &[f64]) -> Vec<f64> {
        let mut values = vec![0.0; self.pattern.nzval.len()];
        for (k, (_, cosines, length)) in self.bars.iter().enumerate() {
            let mut slot = 0;
            for a in 0..4 {
                for b in a..4 {
                    let place = self.places[k][slot];
                    slot += 1;
                    if place != usize::MAX {
                        values[place] += x[k] / length * cosines[a] * cosines[b];
                    }
                }
            }
        }
        values
    }

    /// Displacements under the load.
    fn solve(&mut self, x: &[f64]) -> Vec<f64> {
        if let Some((at, u)) = &self.last
            && at == x
        {
            return u.clone();
        }
        let values = self.matrix(x);
        match &mut self.factors {
            Some(factors) => {
                let all: Vec<usize> = (0..values.len()).collect();
                factors.update_values(&all, &values);
                factors.refactor().expect("the truss is stiff");
            }
            None => {
                self.pattern.nzval = values;
                let factors = QDLDLFactorisation::new(&self.pattern, None);
                self.factors = Some(factors.expect("the truss is stiff"));
            }
        }
        let mut u = vec![0.0; self.freedoms];
        u[self.loaded] = 1.0;
        if let Some(factors) = &mut self.factors {
            factors.solve(&mut u);
        }
        self.last = Some((x.to_vec(), u.clone()));
        u
    }
}

/// Elongation of a bar under the displacements `u`.
fn strain((ends, cosines, _): &([Option<usize>; 4], [f64; 4], f64), u: &[f64]) -> f64 {
    let parts = ends.iter().zip(cosines);
    parts.map(|(end, c)| end.map_or(0.0, |i| c * u[i])).sum()
}

/// The ten pairs of degrees of freedom of a bar, without the fixed ones.
fn pairs(ends: &[Option<usize>; 4]) -> impl Iterator<Item = Option<(usize, usize)>> + '_ {
    (0..4).flat_map(move |a| (a..4).map(move |b| ends[a].zip(ends[b])))
}

impl Nlp for Truss {
    fn variables(&self) -> usize {
        self.bars.len()
    }

    fn constraints(&self) -> usize {
        1
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![LEAST; self.bars.len()], vec![100.0; self.bars.len()])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        (vec![f64::NEG_INFINITY], vec![1.0])
    }

    fn start(&self) -> Vec<f64> {
        vec![0.9; self.bars.len()]
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let u = self.solve(x);
        let volume: f64 = self.bars.iter().zip(x).map(|(b, x)| b.2 * x).sum();
        Ok(Evaluation {
            objective: u[self.loaded],
            constraints: vec![volume / self.volume],
        })
    }

    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let u = self.solve(x);
        let objective = self.bars.iter().map(|b| -strain(b, &u).powi(2) / b.2);
        let volume = self.bars.iter().map(|b| b.2 / self.volume);
        Ok(Gradients {
            objective: objective.collect(),
            jacobian: Jacobian::dense(1, self.bars.len(), volume.collect()),
        })
    }

    /// The compliance has the derivatives 2 (∂K/∂x_i u)ᵀ K⁻¹ ∂K/∂x_j u.
    fn curvature(&mut self, x: &[f64], _y: &[f64]) -> Option<Curvature> {
        if !self.with_curvature {
            return None;
        }
        let u = self.solve(x);
        let forces = self.bars.iter().enumerate().flat_map(|(k, bar)| {
            let force = strain(bar, &u) / bar.2;
            let ends = bar.0.iter().zip(bar.1);
            ends.filter_map(move |(end, c)| end.map(|i| (i, k, c * force)))
        });
        let coupling = Jacobian::sparse(self.freedoms, self.bars.len(), forces);
        let values = self.matrix(x);
        let pattern = &self.pattern;
        let column = |j: usize| {
            let part = pattern.colptr[j]..pattern.colptr[j + 1];
            part.map(move |p| (j, pattern.rowval[p], p))
        };
        let half = (0..self.freedoms).flat_map(column);
        let half = half.map(|(j, i, p)| (j, i, 0.5 * values[p]));
        Some(Curvature {
            diagonal: vec![0.0; self.bars.len()],
            coupling,
            stiffness: Jacobian::sparse(self.freedoms, self.freedoms, half),
        })
    }
}
