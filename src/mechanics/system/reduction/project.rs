//! Shells in a basis of their unknowns: integrals of the vectors over mass and stiffness, for each group of
//! elements of one thickness and material. Design variables are factors of these parts, so all numbers of the
//! body have exact derivatives with the basis as it is.

use crate::math::slices::{add_scaled, dot};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::finite::{
    ElementMesh, FiniteElements, NODES, POINTS, Part, QUADRATIC, SLOPES, STRAINS, ShellElement,
    other_slope,
};
use crate::model::flexible::Modal;
use crate::model::reduced::{NodalBasis, PairEnergy, ReducedShells};
use crate::model::shapes::{ModalInertia, ModalStiffness, Quadratic, Strain};
use crate::structures::floating::PointMotion;
use crate::system::finite::{factors, per_area};
use nalgebra::SMatrix;
use std::sync::Arc;

/// A body of shells in a basis.
#[derive(Clone, Debug)]
pub struct ProjectedShells {
    /// V.
    pub basis: Arc<NodalBasis>,
    /// The coordinates that bend.
    pub bending: Vec<usize>,
    /// Parts of the groups of elements.
    groups: Vec<Group>,
}

/// The part of the elements of one thickness and material.
#[derive(Clone, Debug)]
struct Group {
    /// One of the elements.
    element: usize,
    /// Per mass per area, and per rotary inertia per area.
    inertia: [ModalInertia<f64>; 2],
    /// K per E h, and per E h³.
    stiffness: [Vec<f64>; 2],
    /// C and G per E h.
    pairs: PairEnergy<f64>,
}

impl Group {
    fn zero(element: usize, modes: usize, bending: &[usize]) -> Self {
        let inertia = || ModalInertia {
            centre: Vec3::zeros(),
            static_moments: vec![Vec3::zeros(); modes],
            with_position: vec![Mat3::zeros(); modes],
            products: vec![Mat3::zeros(); modes * (modes + 1) / 2],
        };
        let square = || vec![0.0; modes * modes];
        let mut pairs = PairEnergy {
            of: bending.to_vec(),
            cubic: Vec::new(),
            quartic: Vec::new(),
        };
        let n = pairs.count();
        pairs.cubic = vec![0.0; modes * n];
        pairs.quartic = vec![0.0; n * (n + 1) / 2];
        Self {
            element,
            inertia: [inertia(), inertia()],
            stiffness: [square(), square()],
            pairs,
        }
    }

    /// Adds the integrals of an element over its points; `shapes` are the motions of the points.
    fn add_inertia(&mut self, element: &ShellElement, shapes: &[[Vec3<f64>; POINTS]]) {
        for (kind, own) in self.inertia.iter_mut().enumerate() {
            let points = kind * NODES..(kind + 1) * NODES;
            let share = |x: &[Vec3<f64>]| -> [Vec3<f64>; NODES] {
                let row = |a: usize| {
                    let all = element.shares[a].iter().zip(x);
                    all.fold(Vec3::zeros(), |sum: Vec3<f64>, (&share, x)| sum + x * share)
                };
                std::array::from_fn(row)
            };
            let product = |x: &[Vec3<f64>], y: &[Vec3<f64>; NODES]| {
                let all = x.iter().zip(y);
                all.fold(Mat3::zeros(), |sum, (x, y)| sum + x * y.transpose())
            };
            let sum = |x: &[Vec3<f64>; NODES]| x.iter().fold(Vec3::zeros(), |sum, x| sum + x);
            let place = &element.points[points.clone()];
            if kind == 0 {
                own.centre += sum(&share(place));
            }
            let mut at = 0;
            let shared: Vec<[Vec3<f64>; NODES]> =
                shapes.iter().map(|x| share(&x[points.clone()])).collect();
            for (i, (shape, weighed)) in shapes.iter().zip(&shared).enumerate() {
                if kind == 0 {
                    own.static_moments[i] += sum(weighed);
                }
                own.with_position[i] += product(place, weighed);
                for other in &shared[i..] {
                    own.products[at] += product(&shape[points.clone()], other);
                    at += 1;
                }
            }
        }
    }

    /// Adds the stiffness of an element; `local` are its unknowns in each vector.
    fn add_stiffness(&mut self, element: &ShellElement, local: &[Vec<f64>]) {
        let m = local.len();
        // Bending goes with E h³, shear with E h.
        for (kind, linear) in element.linear.iter().enumerate() {
            let to = &mut self.stiffness[1 - kind];
            for (j, y) in local.iter().enumerate() {
                let mut force = vec![0.0; y.len()];
                linear.add_product(1.0, y, &mut force);
                for (i, x) in local.iter().enumerate() {
                    to[i * m + j] += dot(x, &force);
                }
            }
        }
        // Strains of the vectors and of their pairs, each with the stresses.
        let strains: Vec<[f64; STRAINS]> =
            local.iter().map(|x| element.membrane.times(x)).collect();
        let slopes: Vec<[f64; SLOPES]> = (self.pairs.of.iter())
            .map(|&i| element.slopes.times(&local[i]))
            .collect();
        let mut of_pairs: Vec<[f64; STRAINS]> = Vec::with_capacity(self.pairs.count());
        for (i, x) in slopes.iter().enumerate() {
            for (j, y) in slopes.iter().enumerate().skip(i) {
                let mut e = [0.0; STRAINS];
                for p in 0..QUADRATIC {
                    let q = other_slope(p);
                    let ([rx, sx], [ry, sy]) = ([x[p], x[q]], [y[p], y[q]]);
                    e[p] = if i == j {
                        0.5 * rx * sx
                    } else {
                        0.5 * (rx * sy + ry * sx)
                    };
                }
                of_pairs.push(e);
            }
        }
        let stress = |e: &[f64; STRAINS]| -> [f64; STRAINS] {
            std::array::from_fn(|p| dot(&element.plane[p], e))
        };
        let inner = |x: &[f64; STRAINS], y: &[f64; STRAINS]| dot(x, y);
        for (i, e) in strains.iter().enumerate() {
            let s = stress(e);
            for (j, other) in strains.iter().enumerate() {
                self.stiffness[0][i * m + j] += inner(&s, other);
            }
            let row = &mut self.pairs.cubic[i * of_pairs.len()..(i + 1) * of_pairs.len()];
            for (to, pair) in row.iter_mut().zip(&of_pairs) {
                *to += inner(&s, pair);
            }
        }
        let mut quartic = self.pairs.quartic.iter_mut();
        for (k, e) in of_pairs.iter().enumerate() {
            let s = stress(e);
            for (other, to) in of_pairs[k..].iter().zip(&mut quartic) {
                *to += inner(&s, other);
            }
        }
    }
}

/// Projects shells on a basis; `slots` is the group of each element.
pub fn project(
    mesh: &ElementMesh,
    slots: &[usize],
    basis: Vec<Vec<f64>>,
    bending: Vec<usize>,
) -> ProjectedShells {
    let mut names: Vec<usize> = slots.to_vec();
    names.sort_unstable();
    names.dedup();
    let modes = basis.len();
    let mut groups: Vec<Option<Group>> = vec![None; names.len()];
    for (i, (element, slot)) in mesh.elements.iter().zip(slots).enumerate() {
        let at = names.binary_search(slot).unwrap_or(0);
        let group = groups[at].get_or_insert_with(|| Group::zero(i, modes, &bending));
        let local = |vector: &Vec<f64>| -> Vec<f64> {
            let value = |c: &Option<usize>| c.map_or(0.0, |c| vector[c]);
            element.coordinates.iter().map(value).collect()
        };
        let local: Vec<Vec<f64>> = basis.iter().map(local).collect();
        let shape = |x: &Vec<f64>| {
            let mut points = [Vec3::zeros(); POINTS];
            for (&x, (point, along)) in x.iter().zip(&element.moves) {
                points[*point] += along * x;
            }
            points
        };
        let shapes: Vec<[Vec3<f64>; POINTS]> = local.iter().map(shape).collect();
        group.add_inertia(element, &shapes);
        group.add_stiffness(element, &local);
    }
    ProjectedShells {
        basis: Arc::new(NodalBasis { vectors: basis }),
        bending,
        groups: groups.into_iter().flatten().collect(),
    }
}

impl ProjectedShells {
    /// Number of coordinates.
    pub fn modes(&self) -> usize {
        self.basis.vectors.len()
    }

    /// The body at the thickness and material of `elements`.
    pub fn modal<S: Scalar>(&self, elements: FiniteElements<S>) -> Modal<S> {
        let m = self.modes();
        let mut pairs = PairEnergy {
            of: self.bending.clone(),
            cubic: Vec::new(),
            quartic: Vec::new(),
        };
        let n = pairs.count();
        pairs.cubic = vec![S::zero(); m * n];
        pairs.quartic = vec![S::zero(); n * (n + 1) / 2];
        let mut inertia = ModalInertia {
            centre: Vec3::zeros(),
            static_moments: vec![Vec3::zeros(); m],
            with_position: vec![Mat3::zeros(); m],
            products: vec![Mat3::zeros(); m * (m + 1) / 2],
        };
        let mut stiffness = vec![S::zero(); m * m];
        for group in &self.groups {
            let weights = per_area(&elements, group.element);
            for (own, weight) in group.inertia.iter().zip(weights) {
                inertia.centre += own.centre.map(S::from) * weight;
                let vectors = inertia.static_moments.iter_mut();
                for (to, own) in vectors.zip(&own.static_moments) {
                    *to += own.map(S::from) * weight;
                }
                let with = inertia.with_position.iter_mut().zip(&own.with_position);
                let products = inertia.products.iter_mut().zip(&own.products);
                for (to, own) in with.chain(products) {
                    *to += own.map(S::from) * weight;
                }
            }
            let both = factors(&elements, group.element);
            for (own, factor) in group.stiffness.iter().zip(both) {
                add_lifted(&mut stiffness, factor, own);
            }
            add_lifted(&mut pairs.cubic, both[0], &group.pairs.cubic);
            add_lifted(&mut pairs.quartic, both[0], &group.pairs.quartic);
        }
        let mut strains = Vec::new();
        for (part, coordinates) in elements.parts.iter().zip(&elements.mesh.parts) {
            let own = self.part(part, coordinates);
            inertia.centre += own.inertia.centre;
            let vectors = inertia.static_moments.iter_mut();
            for (to, own) in vectors.zip(&own.inertia.static_moments) {
                *to += own;
            }
            let with = inertia.with_position.iter_mut();
            let with = with.zip(&own.inertia.with_position);
            let products = inertia.products.iter_mut().zip(&own.inertia.products);
            for (to, own) in with.chain(products) {
                *to += own;
            }
            add_scaled(&mut stiffness, S::one(), &own.stiffness.linear);
            strains.extend(own.stiffness.strains);
        }
        let heavy = elements.damping.map(|[alpha, _]| {
            let trace = |k: usize| inertia.products[inertia.place(k / m, k % m).0].trace();
            (0..m * m).map(|k| alpha * trace(k)).collect()
        });
        // Round-off leaves the sums unsymmetric.
        for i in 0..m {
            for j in 0..i {
                let mean = (stiffness[i * m + j] + stiffness[j * m + i]) * S::from(0.5);
                stiffness[i * m + j] = mean;
                stiffness[j * m + i] = mean;
            }
        }
        Modal {
            inertia,
            stiffness: ModalStiffness {
                linear: stiffness,
                strains,
            },
            damping: heavy.unwrap_or_else(|| vec![S::zero(); m * m]),
            viscosity: None,
            shells: Some(ReducedShells {
                basis: self.basis.clone(),
                pairs,
                elements,
            }),
            sections: [].into(),
        }
    }

    /// A beam or a lumped mass by the coordinates of the body.
    fn part<S: Scalar>(&self, part: &Part<S>, coordinates: &[usize]) -> Part<S> {
        let vectors = &self.basis.vectors;
        // The coordinates of the part in each vector.
        let local: Vec<Vec<f64>> = (vectors.iter())
            .map(|vector| coordinates.iter().map(|&i| vector[i]).collect())
            .collect();
        let (m, inertia) = (local.len(), &part.inertia);
        let product = |k: usize, l: usize| match inertia.place(k, l) {
            (at, false) => inertia.products[at],
            (at, true) => inertia.products[at].transpose(),
        };
        // Σ_l S_kl V_lJ.
        let half = |x: &Vec<f64>| -> Vec<Mat3<S>> {
            let of = |k: usize| {
                let all = x.iter().enumerate();
                all.fold(Mat3::zeros(), |sum, (l, &x)| {
                    sum + product(k, l) * S::from(x)
                })
            };
            (0..coordinates.len()).map(of).collect()
        };
        let halves: Vec<Vec<Mat3<S>>> = local.iter().map(half).collect();
        let mut products = Vec::with_capacity(m * (m + 1) / 2);
        for (i, x) in local.iter().enumerate() {
            for other in &halves[i..] {
                products.push(weighted(x, other, Mat3::zeros()));
            }
        }
        let row = |row: &Vec<S>| -> Vec<S> {
            let all = local.iter();
            all.map(|x| {
                row.iter()
                    .zip(x)
                    .fold(S::zero(), |sum, (&a, &x)| sum + a * x)
            })
            .collect()
        };
        let n = coordinates.len().max(1);
        let forces: Vec<Vec<S>> = (part.stiffness.linear.chunks_exact(n))
            .map(|own| row(&own.to_vec()))
            .collect();
        let mut linear = vec![S::zero(); m * m];
        for (i, x) in local.iter().enumerate() {
            for (&x, force) in x.iter().zip(&forces) {
                add_scaled(&mut linear[i * m..(i + 1) * m], S::from(x), force);
            }
        }
        let strains = part.stiffness.strains.iter().map(|own| Strain {
            weight: own.weight,
            axial: own.axial,
            strain: Quadratic {
                linear: row(&own.strain.linear),
                // A basis has nothing that would relieve shears and curvatures of products: they would lock.
                squares: (own.strain.squares.iter().filter(|_| own.axial))
                    .map(|(c, g)| (*c, row(g)))
                    .collect(),
            },
        });
        Part {
            mass: part.mass,
            second: part.second,
            inertia: ModalInertia {
                centre: inertia.centre,
                static_moments: (local.iter())
                    .map(|x| weighted(x, &inertia.static_moments, Vec3::zeros()))
                    .collect(),
                with_position: (local.iter())
                    .map(|x| weighted(x, &inertia.with_position, Mat3::zeros()))
                    .collect(),
                products,
            },
            stiffness: ModalStiffness {
                linear,
                strains: strains.collect(),
            },
        }
    }

    /// The motion of a point by the coordinates; `point` is that by the unknowns of the nodes.
    pub fn point(&self, point: &PointMotion) -> PointMotion {
        let project = |motions: &[Vec3<f64>]| -> Vec<Vec3<f64>> {
            let of = |vector: &Vec<f64>| {
                let all = point.coordinates.iter().zip(motions);
                all.fold(Vec3::zeros(), |sum: Vec3<f64>, (&i, x)| sum + x * vector[i])
            };
            self.basis.vectors.iter().map(of).collect()
        };
        let moved = !point.coordinates.is_empty();
        PointMotion {
            place: point.place,
            coordinates: (0..self.modes()).filter(|_| moved).collect(),
            displacement: project(&point.displacement),
            rotation: project(&point.rotation),
        }
    }
}

/// Σ x_k a_k.
fn weighted<S: Scalar, const C: usize>(
    x: &[f64],
    all: &[SMatrix<S, 3, C>],
    zero: SMatrix<S, 3, C>,
) -> SMatrix<S, 3, C> {
    let both = x.iter().zip(all);
    both.fold(zero, |sum, (&x, own)| sum + own * S::from(x))
}

/// Adds a factor times constants.
fn add_lifted<S: Scalar>(to: &mut [S], factor: S, own: &[f64]) {
    for (to, &own) in to.iter_mut().zip(own) {
        *to += factor * own;
    }
}
