//! How much large rotations spoil solutions whose strains are those of small ones.
//!
//! The slope of a line is sin θ of its rotation; the strains take θ. Where shear forces Q do work, the energy lacks
//!
//! ```text
//! ΔU = ∫ Q θ³/6 ds = ∫ θ² u ds − Σ M_a θ_a³/6,   u the density of the energy of bending,
//! ```
//!
//! M_a moments of the load at nodes. Of an energy ½ U of the load's work, to which ΔU is of fourth order, displacements
//! err by the part 2 ΔU / U. Where no force does work, as in a beam bent by a moment, they err by the part of the slope
//! itself, ∫ θ³/6 ds / ∫ θ ds. The estimate is the larger of both. A cantilever with a force at its end has
//! 0.114 (P L²/EI)² (the elastica: 0.026 at 0.5, 0.095 at 1, 0.26 at 2), one with a moment 0.083 (M L/EI)² (0.081 at 1).
//!
//! Other energies count likewise: that of a membrane by the square of the rotation in its surface and half that of
//! its slope (tension along a slope: ⅛ N θ⁴), that of twist by the slope, that of bending by a third of the
//! square of the twist.

use super::shell::basis::Basis;
use super::shell::{Motion, NODES, Shell, ShellKind, Terms};
use super::state::NodalMotion;
use super::statics::StaticProblem;
use super::structure::Structure;
use crate::math::{Scalar, Vec3};

/// Estimated part of the displacements above which a result is warned of.
pub const LARGE_ERROR: f64 = 0.01;

/// A part of a body that is turned.
pub struct TurnedPart {
    /// Its length \[m\], area \[m²\] or volume; one measure for all parts of a kind.
    pub size: f64,
    /// Mean squares of its rotations out of its own line or surface, and about its tangent or normal \[rad²\].
    pub squares: [f64; 2],
    /// Its strain energy, and the part of it that large rotations miss \[J\].
    pub energies: [f64; 2],
}

/// Sums over the parts of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turned {
    /// U \[J\].
    pub energy: f64,
    /// ΔU \[J\].
    pub missed: f64,
    /// ∫ θ and ∫ θ³/6.
    pub slopes: [f64; 2],
    /// The largest root mean square of the rotations of a part \[rad\], and the part.
    pub most: (f64, usize),
}

impl Turned {
    /// The larger of the sums that errors are judged by.
    pub fn raise(&mut self, other: &Self) {
        self.energy = self.energy.max(other.energy);
        self.slopes[0] = self.slopes[0].max(other.slopes[0]);
    }

    /// Adds part `index`.
    pub fn add(&mut self, index: usize, part: &TurnedPart) {
        let [out, about] = part.squares;
        self.energy += part.energies[0];
        self.missed += part.energies[1];
        let slope = out.sqrt();
        self.slopes[0] += part.size * slope;
        self.slopes[1] += part.size * slope * out / 6.0;
        let angle = (out + about).sqrt();
        if angle > self.most.0 {
            self.most = (angle, index);
        }
    }

    /// The estimated part by which displacements err; beside `most`, the sums at the instant where each is largest.
    pub fn error(&self, most: &Self) -> f64 {
        let part = |x: f64, of: f64| if of > 0.0 { x / of } else { 0.0 };
        let of_energy = 2.0 * part(self.missed.max(0.0), most.energy);
        of_energy.max(part(self.slopes[1], most.slopes[0]))
    }
}

/// Squares of the rotation of a surface out of it and about its normal, to first order in displacements: by its tangents
/// X,r and X,s and the derivatives u,r and u,s.
///
/// ```text
/// t = a^r × u,r + a^s × u,s,   θ = t − ½ (n · t) n
/// ```
///
/// a^r and a^s are the reciprocal tangents, n is the normal.
pub fn surface_turn<S: Scalar>([r, s]: &[Vec3<S>; 2], by: &[Vec3<S>; 2]) -> [f64; 2] {
    let normal = r.cross(s);
    let square = normal.dot(&normal);
    let along = [s.cross(&normal), normal.cross(r)];
    let turned = (along[0].cross(&by[0]) + along[1].cross(&by[1])) * (S::one() / square);
    let twice = turned.dot(&normal);
    let about = twice * twice / square;
    let out = turned.dot(&turned) - about;
    [out.re().max(0.0), about.re() * 0.25]
}

/// A shell with its area, energies of the membrane and of all else, and the squares of its turns at Gauss points.
pub fn turned_shell(size: f64, [membrane, bent]: [f64; 2], squares: [f64; 2]) -> TurnedPart {
    let [out, about] = squares;
    TurnedPart {
        size,
        squares,
        energies: [
            membrane + bent,
            bent * (out + about) + membrane * (0.5 * out + about),
        ],
    }
}

/// A length of a line with the squares of its slope and twist, and its energies of stretch, of bending and shear, and
/// of torsion.
pub fn turned_line(size: f64, squares: [f64; 2], energies: [f64; 3]) -> TurnedPart {
    let ([out, twist], [stretch, bent, twisted]) = (squares, energies);
    TurnedPart {
        size,
        squares,
        energies: [
            stretch + bent + twisted,
            out * (0.5 * stretch + bent + twisted) + twist * bent / 3.0,
        ],
    }
}

/// Means over the Gauss points of an element.
pub fn at_points(kind: ShellKind, of: impl Fn(&Basis) -> [f64; 2]) -> [f64; 2] {
    let (mut sum, points) = ([0.0; 2], &kind.tables().gauss);
    for basis in points {
        let own = of(basis);
        sum[0] += own[0];
        sum[1] += own[1];
    }
    sum.map(|x| x / points.len() as f64)
}

/// Area of a shell, and its turned part.
fn shell(own: &Shell<f64>, motion: &Motion<f64>, terms: Terms) -> TurnedPart {
    let parts = own.energy(motion, terms);
    let along = |basis: &Basis, k: usize, of: &[Vec3<f64>; NODES]| -> Vec3<f64> {
        let all = of.iter().zip(&basis.by[k]);
        all.fold(Vec3::zeros(), |sum, (x, &by)| sum + x * by)
    };
    let tangents = |basis: &Basis| [0, 1].map(|k| along(basis, k, &own.geometry.points));
    let squares = at_points(own.kind, |basis| {
        let by = [0, 1].map(|k| along(basis, k, &motion.displacement));
        surface_turn(&tangents(basis), &by)
    });
    let area = at_points(own.kind, |basis| {
        let [r, s] = tangents(basis);
        [4.0 * r.cross(&s).norm(), 0.0]
    });
    let bent = parts.bending + parts.shear + parts.drilling;
    turned_shell(area[0], [parts.membrane, bent], squares)
}

/// How far a solution of a load case is turned. Elements are counted as in the mesh, beams after shells.
pub fn turned(
    problem: &StaticProblem,
    structure: &Structure<f64>,
    (x, load): (&[f64], &[f64]),
    terms: Terms,
) -> Turned {
    let configuration = problem.assembly.configuration(structure);
    let motion: NodalMotion<f64> = configuration.spread(x);
    let shells = &structure.topology.mesh.shells;
    let mut sum = Turned::default();
    for (index, element) in shells.iter().enumerate() {
        let own = configuration.shell(index);
        sum.add(index, &shell(&own, &motion.of_element(element), terms));
    }
    for (index, element) in configuration.beams() {
        let beam = configuration.beam(index);
        for section in beam.turned(&motion.of_beam(element), terms.von_karman) {
            // Beside surfaces a line has no size.
            let size = if shells.is_empty() {
                section.length
            } else {
                0.0
            };
            let squares = [section.slope, section.twist].map(|x| x * x);
            let part = turned_line(size, squares, section.energies);
            sum.add(shells.len() + index, &part);
        }
    }
    for node in 0..structure.nodes.len() {
        let square = motion.rotation[node].norm_squared();
        for i in problem.assembly.unknowns.rotations_of(node) {
            sum.missed -= (load[i] * x[i]).abs() * square / 6.0;
        }
    }
    sum
}
