//! Trusses of least weight under limits of stress and displacement, with the data and the weights
//! that are published for them, in any units of length, force and mass.
//!
//! Schmit & Farshi (1974), *Some approximation concepts for structural synthesis*, AIAA Journal 12;
//! Haug & Arora (1979), *Applied Optimal Design* (10, 25, 72 and 200 bars); the weights are those of
//! Kaveh & Talatahari (2009), Computers & Structures 87, but for rounding of the areas.

use flexbody_optimiser::{Evaluation, EvaluationFailure, Gradients, Jacobian, Nlp};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Units of length, force and mass in an inch, a pound-force and a pound.
#[derive(Clone, Copy, Debug)]
pub struct Units {
    pub name: &'static str,
    pub inch: f64,
    pub pound_force: f64,
    pub pound: f64,
}

/// Inch and pound; metre, newton and kilogram; millimetre, newton and tonne.
pub const UNITS: [Units; 3] = [
    Units {
        name: "lb-in",
        inch: 1.0,
        pound_force: 1.0,
        pound: 1.0,
    },
    Units {
        name: "SI",
        inch: 0.0254,
        pound_force: 4.448_221_6,
        pound: 0.453_592_37,
    },
    Units {
        name: "mm-N-MPa",
        inch: 25.4,
        pound_force: 4.448_221_6,
        pound: 0.453_592_37e-3,
    },
];

struct Bar {
    ends: [usize; 2],
    group: usize,
}

/// Minimise Σ ρ A L over the areas A of groups of bars, subject to limits of the stress in each bar
/// and of displacements, under each load.
pub struct SizedTruss {
    pub name: &'static str,
    /// Published weight, in pounds.
    pub published: f64,
    pub units: Units,
    dimensions: usize,
    nodes: Vec<[f64; 3]>,
    fixed: Vec<usize>,
    bars: Vec<Bar>,
    groups: usize,
    modulus: f64,
    density: f64,
    /// Node, and force.
    loads: Vec<Vec<(usize, [f64; 3])>>,
    /// Largest tension, and largest compression of each group.
    tension: f64,
    compression: Vec<f64>,
    /// Nodes, directions and the limit.
    displaced: Vec<(usize, usize)>,
    largest_displacement: f64,
    least_area: f64,
    start: f64,
    last: Option<(Vec<f64>, Solved)>,
}

#[derive(Clone)]
struct Solved {
    factor: Cholesky<f64, nalgebra::Dyn>,
    moved: Vec<DVector<f64>>,
}

/// All trusses, in inches and pounds.
pub fn trusses() -> Vec<SizedTruss> {
    vec![
        ten_bars("10 bars, one load", 5060.85, &[(1, -1e5), (3, -1e5)]),
        ten_bars(
            "10 bars, two loads",
            4676.93,
            &[(1, -1.5e5), (3, -1.5e5), (0, 5e4), (2, 5e4)],
        ),
        twenty_five_bars(),
        seventy_two_bars("72 bars, areas above 0.1", 379.62, 0.1),
        seventy_two_bars("72 bars, areas above 0.01", 363.82, 0.01),
        two_hundred_bars(),
    ]
}

fn ten_bars(name: &'static str, published: f64, loads: &[(usize, f64)]) -> SizedTruss {
    let ends = [
        [4, 2],
        [2, 0],
        [5, 3],
        [3, 1],
        [2, 3],
        [0, 1],
        [4, 3],
        [5, 2],
        [2, 1],
        [3, 0],
    ];
    let bars = ends.iter().enumerate();
    SizedTruss {
        name,
        published,
        units: UNITS[0],
        dimensions: 2,
        nodes: vec![
            [720.0, 360.0, 0.0],
            [720.0, 0.0, 0.0],
            [360.0, 360.0, 0.0],
            [360.0, 0.0, 0.0],
            [0.0, 360.0, 0.0],
            [0.0, 0.0, 0.0],
        ],
        fixed: vec![4, 5],
        bars: bars.map(|(group, &ends)| Bar { ends, group }).collect(),
        groups: 10,
        modulus: 1e7,
        density: 0.1,
        loads: vec![loads.iter().map(|&(n, p)| (n, [0.0, p, 0.0])).collect()],
        tension: 25e3,
        compression: vec![25e3; 10],
        displaced: (0..8).map(|k| (k / 2, k % 2)).collect(),
        largest_displacement: 2.0,
        least_area: 0.1,
        start: 10.0,
        last: None,
    }
}

fn twenty_five_bars() -> SizedTruss {
    let groups: [&[[usize; 2]]; 8] = [
        &[[0, 1]],
        &[[0, 3], [1, 2], [0, 4], [1, 5]],
        &[[1, 3], [1, 4], [0, 2], [0, 5]],
        &[[2, 5], [3, 4]],
        &[[2, 3], [4, 5]],
        &[[2, 9], [5, 6], [3, 8], [4, 7]],
        &[[3, 6], [2, 7], [4, 9], [5, 8]],
        &[[5, 9], [2, 6], [3, 7], [4, 8]],
    ];
    let bars = groups.iter().enumerate();
    let (a, b) = (37.5, 100.0);
    SizedTruss {
        name: "25 bars",
        published: 545.16,
        units: UNITS[0],
        dimensions: 3,
        nodes: vec![
            [-a, 0.0, 200.0],
            [a, 0.0, 200.0],
            [-a, a, 100.0],
            [a, a, 100.0],
            [a, -a, 100.0],
            [-a, -a, 100.0],
            [-b, b, 0.0],
            [b, b, 0.0],
            [b, -b, 0.0],
            [-b, -b, 0.0],
        ],
        fixed: vec![6, 7, 8, 9],
        bars: bars
            .flat_map(|(group, all)| all.iter().map(move |&ends| Bar { ends, group }))
            .collect(),
        groups: 8,
        modulus: 1e7,
        density: 0.1,
        loads: vec![
            vec![(0, [0.0, 2e4, -5e3]), (1, [0.0, -2e4, -5e3])],
            vec![
                (0, [1e3, 1e4, -5e3]),
                (1, [0.0, 1e4, -5e3]),
                (2, [500.0, 0.0, 0.0]),
                (5, [500.0, 0.0, 0.0]),
            ],
        ],
        tension: 40e3,
        compression: vec![
            35092.0, 11590.0, 17305.0, 35092.0, 35092.0, 6759.0, 6959.0, 11082.0,
        ],
        displaced: (0..6).map(|k| (k / 3, k % 3)).collect(),
        largest_displacement: 0.35,
        least_area: 0.01,
        start: 2.0,
        last: None,
    }
}

/// Four storeys. Each has columns, diagonals in its faces, and edges and diagonals of its top.
fn seventy_two_bars(name: &'static str, published: f64, least_area: f64) -> SizedTruss {
    let corners = [[0.0, 0.0], [120.0, 0.0], [120.0, 120.0], [0.0, 120.0]];
    let level = |k: usize| corners.map(|[x, y]| [x, y, 240.0 - 60.0 * k as f64]);
    let mut bars = Vec::new();
    for storey in 0..4 {
        let (top, below) = (4 * storey, 4 * storey + 4);
        let mut add = |kind: usize, ends: [usize; 2]| {
            let group = 4 * storey + kind;
            bars.push(Bar { ends, group });
        };
        for k in 0..4 {
            let next = (k + 1) % 4;
            add(0, [top + k, below + k]);
            add(1, [top + k, below + next]);
            add(1, [top + next, below + k]);
            add(2, [top + k, top + next]);
        }
        add(3, [top, top + 2]);
        add(3, [top + 1, top + 3]);
    }
    SizedTruss {
        name,
        published,
        units: UNITS[0],
        dimensions: 3,
        nodes: (0..5).flat_map(level).collect(),
        fixed: (16..20).collect(),
        bars,
        groups: 16,
        modulus: 1e7,
        density: 0.1,
        loads: vec![
            vec![(0, [5e3, 5e3, -5e3])],
            (0..4).map(|k| (k, [0.0, 0.0, -5e3])).collect(),
        ],
        tension: 25e3,
        compression: vec![25e3; 16],
        displaced: (0..8).map(|k| (k / 2, k % 2)).collect(),
        largest_displacement: 0.25,
        least_area,
        start: 1.0,
        last: None,
    }
}

/// Rows of five and of nine nodes in turn. Five columns join them, and diagonals from the columns
/// to the four nodes between these.
fn two_hundred_bars() -> SizedTruss {
    let mut nodes = Vec::new();
    let mut rows: Vec<Vec<usize>> = Vec::new();
    for row in 0..11 {
        let count = if row % 2 == 0 { 5 } else { 9 };
        let pitch = 960.0 / (count - 1) as f64;
        rows.push((nodes.len()..nodes.len() + count).collect());
        let height = 360.0 + 144.0 * (10 - row) as f64;
        nodes.extend((0..count).map(|k| [pitch * k as f64, height, 0.0]));
    }
    let supports = [nodes.len(), nodes.len() + 1];
    nodes.extend([[240.0, 0.0, 0.0], [720.0, 0.0, 0.0]]);
    // Ends, and module and kind, which make the group.
    let mut all: Vec<([usize; 2], [usize; 2])> = Vec::new();
    for module in 0..5 {
        let [top, middle, below] = [0, 1, 2].map(|k| &rows[2 * module + k]);
        let mut add = |a: usize, b: usize, kind: usize| all.push(([a, b], [module, kind]));
        for k in 0..4 {
            add(top[k], top[k + 1], 0);
            for row in [top, below] {
                add(row[k], middle[2 * k + 1], 1);
                add(row[k + 1], middle[2 * k + 1], 1);
            }
        }
        for k in 0..5 {
            add(top[k], middle[2 * k], 2);
            add(below[k], middle[2 * k], 3);
        }
        for k in 1..7 {
            add(middle[k], middle[k + 1], 4);
        }
        for k in [0, 7] {
            all.push(([middle[k], middle[k + 1]], [0, 5]));
        }
    }
    let last = &rows[10];
    for k in 0..4 {
        all.push(([last[k], last[k + 1]], [5, 0]));
    }
    for (k, support) in [(0, 0), (2, 0), (2, 1), (4, 1)] {
        all.push(([last[k], supports[support]], [5, 1]));
    }
    for (k, support) in [(1, 0), (3, 1)] {
        all.push(([last[k], supports[support]], [5, 2]));
    }
    let mut kinds: Vec<[usize; 2]> = all.iter().map(|bar| bar.1).collect();
    kinds.sort_unstable();
    kinds.dedup();
    let bar = |&(ends, kind): &([usize; 2], [usize; 2])| Bar {
        ends,
        group: kinds.iter().position(|k| *k == kind).expect("it is there"),
    };
    let columns: Vec<usize> = rows[..10]
        .iter()
        .map(|row| row[0])
        .chain([last[0]])
        .collect();
    let sideways: Vec<_> = columns.iter().map(|&n| (n, [1e3, 0.0, 0.0])).collect();
    let heavy = rows
        .iter()
        .flat_map(|row| row.iter().step_by(row.len() / 4));
    let down: Vec<_> = heavy.map(|&n| (n, [0.0, -1e4, 0.0])).collect();
    let both = [sideways.clone(), down.clone()].concat();
    SizedTruss {
        name: "200 bars",
        published: 25445.0,
        units: UNITS[0],
        dimensions: 2,
        nodes,
        fixed: supports.to_vec(),
        bars: all.iter().map(bar).collect(),
        groups: kinds.len(),
        modulus: 3e7,
        density: 0.283,
        loads: vec![sideways, down, both],
        tension: 1e4,
        compression: vec![1e4; kinds.len()],
        displaced: Vec::new(),
        largest_displacement: 1.0,
        least_area: 0.1,
        start: 5.0,
        last: None,
    }
}

impl SizedTruss {
    /// The same truss in other units.
    pub fn in_units(mut self, units: Units) -> SizedTruss {
        self.units = units;
        self.last = None;
        self
    }

    fn stress(&self) -> f64 {
        self.units.pound_force / self.units.inch.powi(2)
    }

    /// Length and direction of a bar, in inches.
    fn axis(&self, bar: &Bar) -> (f64, [f64; 3]) {
        let [a, b] = bar.ends.map(|k| self.nodes[k]);
        let way = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
        let length = way.iter().map(|v| v * v).sum::<f64>().sqrt();
        (length, way.map(|v| v / length))
    }

    /// Volume of each group per area, in inches.
    fn lengths(&self) -> Vec<f64> {
        let mut all = vec![0.0; self.groups];
        for bar in &self.bars {
            all[bar.group] += self.axis(bar).0;
        }
        all
    }

    /// Elongation of a bar per length.
    fn strain(&self, bar: &Bar, u: &DVector<f64>) -> f64 {
        let (length, way) = self.axis(bar);
        let [a, b] = bar.ends.map(|k| self.dimensions * k);
        let along = |k: usize| way[k] * (u[b + k] - u[a + k]);
        (0..self.dimensions).map(along).sum::<f64>() / length
    }

    /// Displacements under each load, in inches, for areas in square inches.
    fn solve(&mut self, areas: &[f64]) -> Solved {
        if let Some((at, found)) = &self.last
            && at == areas
        {
            return found.clone();
        }
        let d = self.dimensions;
        let n = d * self.nodes.len();
        let mut k = DMatrix::zeros(n, n);
        for bar in &self.bars {
            let (length, way) = self.axis(bar);
            let stiffness = self.modulus * areas[bar.group] / length;
            for (a, b, sign) in [(0, 0, 1.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 1.0)] {
                let (a, b) = (d * bar.ends[a], d * bar.ends[b]);
                for i in 0..d {
                    for j in 0..d {
                        k[(a + i, b + j)] += sign * stiffness * way[i] * way[j];
                    }
                }
            }
        }
        for i in self.fixed.iter().flat_map(|&node| d * node..d * node + d) {
            k.row_mut(i).fill(0.0);
            k.column_mut(i).fill(0.0);
            k[(i, i)] = self.modulus;
        }
        let factor = Cholesky::new(k).expect("the truss is stiff");
        let moved = self.loads.iter().map(|load| {
            let mut p = DVector::zeros(n);
            for (node, force) in load {
                for i in 0..d {
                    p[d * node + i] += force[i];
                }
            }
            factor.solve(&p)
        });
        let moved = moved.collect();
        let found = Solved { factor, moved };
        self.last = Some((areas.to_vec(), found.clone()));
        found
    }

    fn areas(&self, x: &[f64]) -> Vec<f64> {
        let unit = self.units.inch.powi(2);
        x.iter().map(|v| v / unit).collect()
    }

    /// Stresses and limited displacements for the displacements `u`, or their derivatives.
    fn limited(&self, u: &DVector<f64>) -> Vec<f64> {
        let stress = self.modulus * self.stress();
        let mut all: Vec<f64> = self
            .bars
            .iter()
            .map(|b| stress * self.strain(b, u))
            .collect();
        let place = |&(node, k): &(usize, usize)| self.dimensions * node + k;
        all.extend(
            self.displaced
                .iter()
                .map(|at| self.units.inch * u[place(at)]),
        );
        all
    }
}

impl Nlp for SizedTruss {
    fn variables(&self) -> usize {
        self.groups
    }

    fn constraints(&self) -> usize {
        self.loads.len() * (self.bars.len() + self.displaced.len())
    }

    fn variable_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let least = self.least_area * self.units.inch.powi(2);
        (vec![least; self.groups], vec![f64::INFINITY; self.groups])
    }

    fn constraint_bounds(&self) -> (Vec<f64>, Vec<f64>) {
        let moved = vec![self.largest_displacement * self.units.inch; self.displaced.len()];
        let stress = self.stress();
        let compression = self
            .bars
            .iter()
            .map(|b| -self.compression[b.group] * stress);
        let lower: Vec<f64> = compression.chain(moved.iter().map(|v| -v)).collect();
        let upper = [vec![self.tension * stress; self.bars.len()], moved].concat();
        (
            lower.repeat(self.loads.len()),
            upper.repeat(self.loads.len()),
        )
    }

    fn start(&self) -> Vec<f64> {
        vec![self.start * self.units.inch.powi(2); self.groups]
    }

    fn evaluate(&mut self, x: &[f64]) -> Result<Evaluation, EvaluationFailure> {
        let areas = self.areas(x);
        let found = self.solve(&areas);
        let volume: f64 = self.lengths().iter().zip(&areas).map(|(l, a)| l * a).sum();
        Ok(Evaluation {
            objective: volume * self.density * self.units.pound,
            constraints: found.moved.iter().flat_map(|u| self.limited(u)).collect(),
        })
    }

    /// K du/dA = −dK/dA u.
    fn gradients(&mut self, x: &[f64]) -> Result<Gradients, EvaluationFailure> {
        let areas = self.areas(x);
        let found = self.solve(&areas);
        let unit = self.units.inch.powi(2);
        let weight = self.density * self.units.pound / unit;
        let (m, n, d) = (self.constraints(), self.groups, self.dimensions);
        let mut jacobian = vec![0.0; m * n];
        for (load, u) in found.moved.iter().enumerate() {
            for group in 0..n {
                let mut force = DVector::zeros(u.len());
                for bar in self.bars.iter().filter(|b| b.group == group) {
                    let pull = self.modulus * self.strain(bar, u);
                    let (_, way) = self.axis(bar);
                    for i in 0..d {
                        force[d * bar.ends[0] + i] += pull * way[i];
                        force[d * bar.ends[1] + i] -= pull * way[i];
                    }
                }
                for i in self.fixed.iter().flat_map(|&node| d * node..d * node + d) {
                    force[i] = 0.0;
                }
                let slopes = self.limited(&found.factor.solve(&force));
                for (j, slope) in slopes.iter().enumerate() {
                    jacobian[(load * slopes.len() + j) * n + group] = slope / unit;
                }
            }
        }
        Ok(Gradients {
            objective: self.lengths().iter().map(|l| l * weight).collect(),
            jacobian: Jacobian::dense(m, n, jacobian),
        })
    }
}
