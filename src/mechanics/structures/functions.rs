//! Functions of a structure and of its static solutions, and their partial derivatives.

use super::assembly::add_energy_transpose;
use super::inertia::{
    add_mass_moments_transpose, inertia, inertia_transpose, mass_moments, second_weights,
};
use super::loads::{Load, add_work_transpose};
use super::mesh::UnknownSet;
use super::reactions::{Reaction, State};
use super::shell::{MassMoments, Motion, STRESS_POINTS, ShellCotangent, ShellKind, Terms};
use super::state::{Configuration, Cotangent, NodalMotion};
use super::statics::StaticProblem;
use super::structure::Structure;
use crate::math::soft_max::SoftMax;
use crate::math::{Complex64, Scalar, Vec3};

/// A function of a structure. Load cases are numbered as they were solved.
#[derive(Clone, Debug, PartialEq)]
pub enum Function {
    /// Mass \[kg\].
    Mass,
    /// Place of the centre of mass along a direction \[m\].
    Centre(Vec3<f64>),
    /// Second moment ∫ (a·x)(b·x) dm of the mass about the origin [kg m²].
    SecondMoment(Vec3<f64>, Vec3<f64>),
    /// Inertia a·J b about the centre of mass [kg m²].
    Inertia(Vec3<f64>, Vec3<f64>),
    /// Force of the supports on a set of nodes, along a direction \[N\].
    Reaction {
        /// The case.
        case: usize,
        /// Set of nodes.
        nodes: String,
        /// Direction.
        direction: Vec3<f64>,
    },
    /// Moment of the supports on a set of nodes about an axis [N m]. Loads on a smooth surface about its
    /// director do no work and count as taken by the supports.
    ReactionMoment {
        /// The case.
        case: usize,
        /// Set of nodes.
        nodes: String,
        /// Direction of the axis.
        axis: Vec3<f64>,
        /// A point of the axis \[m\].
        about: Vec3<f64>,
    },
    /// Strain energy of a load case \[J\].
    StrainEnergy {
        /// The case.
        case: usize,
    },
    /// Work of the loads of a case in its displacements, f·x \[J\].
    Compliance {
        /// The case.
        case: usize,
    },
    /// Mean displacement of the nodes of a set along a direction \[m\].
    Displacement {
        /// The case.
        case: usize,
        /// Set of nodes.
        nodes: String,
        /// Direction.
        direction: Vec3<f64>,
    },
    /// Aggregate of σ_v / σ_yield over both faces of all Gauss points of a set of faces, in some load
    /// cases together [-].
    Stress {
        /// The cases.
        cases: Vec<usize>,
        /// Set of faces.
        faces: String,
        /// Sharpness ρ of the aggregate.
        rho: f64,
        /// Which aggregate.
        aggregate: Aggregate,
    },
}

/// An aggregate of values g_k, with m the largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aggregate {
    /// (1/ρ) ln Σ e^{ρ g_k} ≥ m (Kreisselmeier & Steinhauser 1979).
    Ks,
    /// Σ g_k e^{ρ g_k} / Σ e^{ρ g_k} ≤ m (Kennedy & Hicken 2015, eq. 16, with equal weights).
    InducedExponential,
}

/// The largest stress ratio of a function, and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// σ_v / σ_yield.
    pub ratio: f64,
    /// The load case.
    pub case: usize,
    /// The shell.
    pub shell: usize,
    /// Gauss point of the shell, 3j + i of nine nodes and 2j + i of four.
    pub point: usize,
    /// True at the face on the side of the normal.
    pub upper: bool,
}

/// A structure with the solutions of its load cases.
pub struct Solved<'a, S> {
    /// The problem that was solved.
    pub problem: &'a StaticProblem,
    /// The structure.
    pub structure: &'a Structure<S>,
    /// The loads of each case.
    pub cases: &'a [Vec<Load<S>>],
    /// The solution of each case.
    pub solutions: &'a [Vec<S>],
    /// The terms of the strain that were taken.
    pub terms: Terms,
}

/// Partial derivatives while they are collected.
pub(super) struct Partial<S> {
    pub motions: Vec<NodalMotion<S>>,
    pub to: Cotangent<S>,
    pub cases: Vec<Vec<Load<S>>>,
    /// Of reactions: the motion ψ of each case whose product ψ·(F − f) the function is.
    pub virtual_motions: Vec<Option<NodalMotion<S>>>,
}

pub(super) fn zero_load<S: Scalar>(load: &Load<S>) -> Load<S> {
    load.map(|_| S::zero())
}

impl<S: Scalar> Solved<'_, S> {
    pub(super) fn configuration(&self) -> Configuration<'_, S> {
        self.problem.assembly.configuration(self.structure)
    }

    pub(super) fn state(&self, case: usize) -> State<'_, S> {
        State {
            x: &self.solutions[case],
            case: &self.cases[case],
            terms: self.terms,
        }
    }

    /// The value of a function.
    ///
    /// # Errors
    /// [`UnknownSet`] if the function names no set of the mesh.
    fn value_in(&self, function: &Function) -> Result<S, UnknownSet> {
        let configuration = self.configuration();
        let mesh = &self.structure.topology.mesh;
        let motion = |case: usize| configuration.spread(&self.solutions[case]);
        Ok(match function {
            Function::Mass => mass_moments(&configuration).mass,
            Function::Centre(direction) => {
                let all = mass_moments(&configuration);
                all.first.dot(&direction.map(S::from)) / all.mass
            }
            Function::SecondMoment(a, b) => {
                let all = mass_moments(&configuration);
                let weights = second_weights(a, b);
                let terms = all.second.iter().zip(weights);
                terms.fold(S::zero(), |sum, (&x, w)| sum + x * w)
            }
            Function::Inertia(a, b) => inertia(&mass_moments(&configuration), a, b),
            Function::Reaction { .. } | Function::ReactionMoment { .. } => {
                let reaction = reaction(function);
                reaction.value(&configuration, &self.state(reaction.case))?
            }
            Function::StrainEnergy { case } => {
                configuration.strain_energy(&motion(*case), self.terms)
            }
            Function::Compliance { case } => {
                let load = self
                    .problem
                    .load_vector(self.structure, &self.cases[*case])?;
                let pairs = load.iter().zip(&self.solutions[*case]);
                pairs.fold(S::zero(), |sum, (&f, &x)| sum + f * x)
            }
            Function::Displacement {
                case,
                nodes,
                direction,
            } => {
                let (motion, set) = (motion(*case), mesh.node_set(nodes)?);
                let sum = set
                    .iter()
                    .fold(Vec3::zeros(), |sum, &node| sum + motion.displacement[node]);
                sum.dot(&direction.map(S::from)) / set.len() as f64
            }
            Function::Stress {
                cases,
                faces,
                rho,
                aggregate,
            } => {
                let ratios = self.ratios(&configuration, cases, mesh.face_set(faces)?);
                let soft = SoftMax::new(&ratios, |_| S::one(), *rho);
                match aggregate {
                    Aggregate::Ks => soft.ks,
                    Aggregate::InducedExponential => soft.induced_exponential(&ratios),
                }
            }
        })
    }

    /// The largest stress ratio over a set of faces in some load cases.
    ///
    /// # Errors
    /// [`UnknownSet`] if there is no such set.
    ///
    /// # Panics
    /// If the set or the list of cases is empty.
    pub fn peak(&self, cases: &[usize], faces: &str) -> Result<Peak, UnknownSet> {
        let set = self.structure.topology.mesh.face_set(faces)?;
        let ratios = self.ratios(&self.configuration(), cases, set);
        let soft = SoftMax::new(&ratios, |_| S::one(), 1.0);
        let (mut place, mut k) = (0, soft.peak);
        while k >= self.stress_points(set[place % set.len()]) {
            k -= self.stress_points(set[place % set.len()]);
            place += 1;
        }
        Ok(Peak {
            ratio: soft.maximum,
            case: cases[place / set.len()],
            shell: set[place % set.len()],
            point: k / 2,
            upper: k % 2 == 0,
        })
    }

    /// Number of places of a shell whose stress is evaluated.
    fn stress_points(&self, shell: usize) -> usize {
        ShellKind::of(&self.structure.topology.mesh.shells[shell]).stress_points()
    }

    /// Stress ratios case by case, shell by shell.
    fn ratios(&self, configuration: &Configuration<S>, cases: &[usize], set: &[usize]) -> Vec<S> {
        let shells = &self.structure.topology.mesh.shells;
        let mut all = Vec::with_capacity(cases.len() * set.len() * STRESS_POINTS);
        for &case in cases {
            let motion = configuration.spread(&self.solutions[case]);
            for &index in set {
                let v = motion.of_element(&shells[index]);
                let ratios = configuration.shell(index).stress_ratios(&v, self.terms);
                all.extend(&ratios[..self.stress_points(index)]);
            }
        }
        all
    }
}

impl Solved<'_, Complex64> {
    /// The value of a function.
    ///
    /// # Errors
    /// [`UnknownSet`] if the function names no set of the mesh.
    pub fn value(&self, function: &Function) -> Result<Complex64, UnknownSet> {
        self.value_in(function)
    }
}

impl Solved<'_, f64> {
    /// The value of a function.
    ///
    /// # Errors
    /// [`UnknownSet`] if the function names no set of the mesh.
    pub fn value(&self, function: &Function) -> Result<f64, UnknownSet> {
        self.value_in(function)
    }

    /// Partial derivatives of a function by the motions, the structure and the loads.
    pub(super) fn partial(
        &self,
        configuration: &Configuration<f64>,
        function: &Function,
    ) -> Result<Partial<f64>, UnknownSet> {
        let mesh = &self.structure.topology.mesh;
        let mut all = Partial {
            motions: vec![NodalMotion::zeros(mesh.nodes); self.cases.len()],
            to: configuration.cotangent(),
            virtual_motions: vec![None; self.cases.len()],
            cases: self
                .cases
                .iter()
                .map(|case| case.iter().map(zero_load).collect())
                .collect(),
        };
        let motion = |case: usize| configuration.spread(&self.solutions[case]);
        match function {
            Function::Mass => {
                let mut bar = MassMoments::zeros();
                bar.mass = 1.0;
                add_mass_moments_transpose(configuration, &bar, &mut all.to);
            }
            Function::Centre(direction) => {
                let moments = mass_moments(configuration);
                let mut bar = MassMoments::zeros();
                bar.first = direction / moments.mass;
                bar.mass = -(moments.first.dot(direction) / (moments.mass * moments.mass));
                add_mass_moments_transpose(configuration, &bar, &mut all.to);
            }
            Function::SecondMoment(a, b) => {
                let mut bar = MassMoments::zeros();
                bar.second = second_weights(a, b);
                add_mass_moments_transpose(configuration, &bar, &mut all.to);
            }
            Function::Inertia(a, b) => {
                let bar = inertia_transpose(&mass_moments(configuration), a, b);
                add_mass_moments_transpose(configuration, &bar, &mut all.to);
            }
            Function::Reaction { .. } | Function::ReactionMoment { .. } => {
                let reaction = reaction(function);
                let state = self.state(reaction.case);
                let psi = reaction.add_transpose(configuration, &state, &mut all.to)?;
                all.virtual_motions[reaction.case] = Some(psi);
            }
            Function::StrainEnergy { case } => add_energy_transpose(
                configuration,
                &motion(*case),
                self.terms,
                &mut all.motions[*case],
                &mut all.to,
            ),
            Function::Compliance { case } => {
                let motion = motion(*case);
                for (load, load_to) in self.cases[*case].iter().zip(&mut all.cases[*case]) {
                    add_work_transpose(
                        configuration,
                        load,
                        &motion,
                        &mut all.motions[*case],
                        &mut all.to,
                        load_to,
                    )?;
                }
            }
            Function::Displacement {
                case,
                nodes,
                direction,
            } => {
                let set = mesh.node_set(nodes)?;
                for &node in set {
                    all.motions[*case].displacement[node] += direction / set.len() as f64;
                }
            }
            Function::Stress {
                cases,
                faces,
                rho,
                aggregate,
            } => {
                let set = mesh.face_set(faces)?;
                let ratios = self.ratios(configuration, cases, set);
                let soft = SoftMax::new(&ratios, |_| 1.0, *rho);
                let mut weights = soft.weights.clone();
                if *aggregate == Aggregate::InducedExponential {
                    let value = soft.induced_exponential(&ratios);
                    for (w, &g) in weights.iter_mut().zip(&ratios) {
                        *w *= (g - value) * *rho + 1.0;
                    }
                }
                let mut rest = weights.as_slice();
                for &case in cases {
                    let motion = motion(case);
                    for &index in set {
                        let (chunk, others) = rest.split_at(self.stress_points(index));
                        rest = others;
                        let mut bar = [0.0; STRESS_POINTS];
                        bar[..chunk.len()].copy_from_slice(chunk);
                        let element = &mesh.shells[index];
                        let (mut force, mut part) = (Motion::zeros(), ShellCotangent::zeros());
                        configuration.shell(index).add_stress_ratios_transpose(
                            &motion.of_element(element),
                            self.terms,
                            &bar,
                            &mut force,
                            &mut part,
                        );
                        all.motions[case].add_of_element_transpose(element, &force);
                        configuration.add_shell_transpose(index, &part, &mut all.to);
                    }
                }
            }
        }
        Ok(all)
    }
}

/// The reaction that a function stands for.
fn reaction(function: &Function) -> Reaction<'_> {
    match function {
        Function::Reaction {
            case,
            nodes,
            direction,
        } => Reaction {
            case: *case,
            nodes,
            force: *direction,
            moment: Vec3::zeros(),
            about: Vec3::zeros(),
        },
        Function::ReactionMoment {
            case,
            nodes,
            axis,
            about,
        } => Reaction {
            case: *case,
            nodes,
            force: Vec3::zeros(),
            moment: *axis,
            about: *about,
        },
        _ => unreachable!("no other function is a reaction"),
    }
}
