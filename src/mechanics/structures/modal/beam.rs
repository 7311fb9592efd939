//! A straight uniform beam by assumed modes: bending in two planes, torsion, stretch.
//!
//! Axes: origin at the start of the beam, x along it, y along the section's axis 3 (its height) and z along
//! its axis 2 (its width). With ξ = x/L and a function f of bending, deflection w, rotation ψ and shear γ of a section are
//!
//! ```text
//! w = f − c f'' + a + b ξ,   ψ = (f' + b)/L,   γ = w'/L − ψ = −c f'''/L,   c = EI / (GA L²)
//! ```
//!
//! so the shear force GA γ is the slope of the moment EI f''/L² (Timoshenko 1921), and shear costs no
//! coordinates. a and b put the deflection back where the axes are. The strain of the line of centres is
//! von Karman's with Wagner's term of the twist, e = u' + ½ v'² + ½ w'² + ½ (I_p/A) φ'² (derivatives by x). Twist and
//! curvatures of beams that bend in both planes are in [`super::twist`].
//!
//! **Companions.** The squares of m slopes of bending are polynomials of degree 2m. With 2m + 1 functions of
//! stretch u' is any such polynomial, so a bent beam can shorten and stay free of strain. With fewer it locks.

use super::damping::ratio_damping;
use super::shapes::{BeamFrame, BendingFunctions, bending, stretch};
use super::{ModalNumbers, PointModes};
use crate::math::legendre::gauss;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::flexible::{ModalInertia, ModalStiffness, Quadratic, Strain};
use crate::structures::beam::{Section, SectionValues};
use crate::structures::material::Material;

/// Numbers of functions of each kind. Coordinates have this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BeamModes {
    /// Bending along y and along z.
    pub bending: [usize; 2],
    /// Torsion.
    pub torsion: usize,
    /// Stretch.
    pub stretch: usize,
}

/// Strains of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrainMeasure {
    /// e = u' + ½ v'² + ½ w'² + ½ (I_p/A) φ'², and twist and curvatures with products of rotations.
    VonKarman,
    /// e = u': the beam does not stiffen when it is stretched, and does not buckle.
    Linear,
}

/// Damping of the elastic coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamDamping<S> {
    /// Ratio ζ of critical damping for all modes of bending, of torsion, of stretch.
    pub ratios: [S; 3],
    /// α of the additional damping α M \[1/s\].
    pub mass: S,
    /// β \[s\]: strains are damped β times their stiffness, so large bending without stretch meets no
    /// damping of the stretch.
    pub viscosity: Option<S>,
}

/// A straight uniform beam with elastic coordinates.
#[derive(Clone, Debug)]
pub struct FlexibleBeam<S> {
    /// Length \[m\].
    pub length: S,
    /// Cross section.
    pub section: Section<S>,
    /// Material.
    pub material: Material<S>,
    /// What holds the axes.
    pub frame: BeamFrame,
    /// Functions of bending.
    pub functions: BendingFunctions,
    /// How many functions.
    pub modes: BeamModes,
    /// Strain of the line of centres.
    pub strain: StrainMeasure,
    /// Whether sections shear.
    pub shear: bool,
    /// Damping.
    pub damping: BeamDamping<S>,
}

/// Effect of one coordinate on a section.
#[derive(Clone, Copy, Debug)]
pub(super) struct SectionMode<S> {
    /// Displacement of its centre.
    pub displacement: Vec3<S>,
    /// Its rotation.
    pub rotation: Vec3<S>,
    /// u'.
    pub stretch: S,
    /// v', w'.
    pub slopes: [S; 2],
    /// κ1, κ2, κ3: twist, and curvatures about axes 2 and 3.
    pub curvature: [S; 3],
    /// V2 / EI3 and V3 / EI2: the slopes of the moments.
    pub moment_slopes: [S; 2],
}

impl<S: Scalar> SectionMode<S> {
    fn nothing() -> Self {
        let zero = S::zero();
        Self {
            displacement: Vec3::zeros(),
            rotation: Vec3::zeros(),
            stretch: zero,
            slopes: [zero; 2],
            curvature: [zero; 3],
            moment_slopes: [zero; 2],
        }
    }
}

impl BeamModes {
    /// All functions.
    pub fn count(&self) -> usize {
        self.bending[0] + self.bending[1] + self.torsion + self.stretch
    }

    /// Functions of stretch that keep a beam with these functions of bending and torsion from locking.
    pub fn companions(bending: [usize; 2], torsion: usize) -> usize {
        (2 * bending[0].max(bending[1])).max(2 * torsion.max(1) - 2) + 1
    }

    /// The coordinates of each kind: bending along y, along z, torsion, stretch.
    pub fn ranges(&self) -> [std::ops::Range<usize>; 4] {
        let y = self.bending[0];
        let z = y + self.bending[1];
        let torsion = z + self.torsion;
        [0..y, y..z, z..torsion, torsion..torsion + self.stretch]
    }
}

impl<S: Scalar> FlexibleBeam<S> {
    /// Stiffnesses and masses of the section with y as its axis 2 and z as its axis 3.
    pub fn values(&self) -> SectionValues<S> {
        let SectionValues { stiffness, inertia } = self.section.values(&self.material);
        let [ea, ga2, ga3, gj, ei2, ei3] = stiffness;
        let [mass, i2, i3] = inertia;
        SectionValues {
            stiffness: [ea, ga3, ga2, gj, ei3, ei2],
            inertia: [mass, i3, i2],
        }
    }

    /// Effect of each coordinate on the section at ξ.
    pub(super) fn section_modes(&self, xi: S) -> Vec<SectionMode<S>> {
        let [_, ga2, ga3, _, ei2, ei3] = self.values().stiffness;
        let length = self.length;
        let mut all = Vec::with_capacity(self.modes.count());
        // Bending along y turns sections about axis 3 and shears along axis 2; along z about axis 2, along 3.
        for (plane, ei, ga) in [(0, ei3, ga2), (1, ei2, ga3)] {
            let c = match self.shear {
                true => ei / (ga * length * length),
                false => S::zero(),
            };
            let count = self.modes.bending[plane];
            let at = |xi: S| bending(self.functions, self.frame, count, xi);
            let (here, start, end) = (at(xi), at(S::zero()), at(S::one()));
            for ((f, start), end) in here.iter().zip(&start).zip(&end) {
                let lift = c * start[2];
                let tilt = match self.frame {
                    BeamFrame::Chord => c * (end[2] - start[2]),
                    BeamFrame::Clamped => S::zero(),
                };
                let w = f[0] - c * f[2] + lift + tilt * xi;
                let rotation = (f[1] + tilt) / length;
                let slope = (f[1] - c * f[3] + tilt) / length;
                let curvature = f[2] / (length * length);
                let moment_slope = -f[3] / (length * length * length);
                let mut mode = SectionMode::nothing();
                mode.displacement[1 + plane] = w;
                mode.slopes[plane] = slope;
                mode.moment_slopes[plane] = moment_slope;
                let (axis, sign) = if plane == 0 { (2, 1.0) } else { (1, -1.0) };
                mode.rotation[axis] = rotation * sign;
                mode.curvature[axis] = curvature * sign;
                all.push(mode);
            }
        }
        for [angle, slope] in stretch(self.modes.torsion, xi) {
            let mut mode = SectionMode::nothing();
            mode.rotation[0] = angle;
            mode.curvature[0] = slope / length;
            all.push(mode);
        }
        for [u, slope] in stretch(self.modes.stretch, xi) {
            let mut mode = SectionMode::nothing();
            mode.displacement[0] = u;
            mode.stretch = slope / length;
            all.push(mode);
        }
        all
    }

    /// Shears γ2, γ3 of a section by one coordinate.
    fn shears(&self, mode: &SectionMode<S>, stiffness: &[S; 6]) -> [S; 2] {
        let [_, ga2, ga3, _, ei2, ei3] = *stiffness;
        match self.shear {
            true => [
                mode.moment_slopes[0] * ei3 / ga2,
                mode.moment_slopes[1] * ei2 / ga3,
            ],
            false => [S::zero(); 2],
        }
    }

    /// The strain of the line of centres.
    pub(super) fn line_strain(&self, modes: &[SectionMode<S>]) -> Quadratic<S> {
        let slopes = |plane: usize| modes.iter().map(|mode| mode.slopes[plane]).collect();
        let mut squares = Vec::new();
        if self.strain == StrainMeasure::VonKarman {
            let planes = (0..2).filter(|&plane| self.modes.bending[plane] > 0);
            squares.extend(planes.map(|plane| (S::one(), slopes(plane))));
            if self.modes.torsion > 0 {
                let [ea, _, _, _, ei2, ei3] = self.values().stiffness;
                let twist = modes.iter().map(|mode| mode.curvature[0]).collect();
                squares.push(((ei2 + ei3) / ea, twist));
            }
        }
        Quadratic {
            linear: modes.iter().map(|mode| mode.stretch).collect(),
            squares,
        }
    }

    /// Points of the quadrature: exact for polynomials, round-off for sines.
    fn rule(&self) -> Vec<(f64, f64)> {
        let BeamModes {
            bending,
            torsion,
            stretch,
        } = self.modes;
        let most = bending[0].max(bending[1]);
        let polynomials = (2 * most + 1)
            .max(most + 2)
            .max(torsion + 1)
            .max(stretch + 1);
        gauss(match self.functions {
            BendingFunctions::Polynomial => polynomials,
            BendingFunctions::Sine => polynomials + 4 * most + 10,
        })
    }

    /// The numbers of the body.
    pub fn numbers(&self) -> ModalNumbers<S> {
        let SectionValues { stiffness, inertia } = self.values();
        let m = self.modes.count();
        let mut sums = Sums::zeros(m);
        let mut strains = self.twist_strains();
        // What has strains of its own is no part of K.
        let [gj, ei2, ei3] = match strains.is_empty() {
            true => [stiffness[3], stiffness[4], stiffness[5]],
            false => [S::zero(); 3],
        };
        for (xi, weight) in self.rule() {
            let xi = S::from(xi);
            let modes = self.section_modes(xi);
            let ds = self.length * weight;
            sums.add_mass(self.length * xi, &modes, &inertia.map(|x| x * ds));
            for (i, a) in modes.iter().enumerate() {
                let shears = self.shears(a, &stiffness);
                for (j, b) in modes.iter().enumerate() {
                    let [s2, s3] = self.shears(b, &stiffness);
                    sums.stiffness[i * m + j] += ds
                        * (stiffness[1] * shears[0] * s2
                            + stiffness[2] * shears[1] * s3
                            + gj * a.curvature[0] * b.curvature[0]
                            + ei2 * a.curvature[1] * b.curvature[1]
                            + ei3 * a.curvature[2] * b.curvature[2]);
                }
            }
            strains.push(Strain {
                weight: stiffness[0] * ds,
                axial: true,
                strain: self.line_strain(&modes),
            });
        }
        let mut numbers = sums.numbers(strains);
        numbers.damping = self.damping_matrix(&numbers);
        numbers.viscosity = self.damping.viscosity;
        numbers
    }

    fn damping_matrix(&self, numbers: &ModalNumbers<S>) -> Vec<S> {
        let (mass, stiffness) = (numbers.elastic_mass(), numbers.linear_stiffness());
        let heavy = self.damping.mass;
        let mut damping: Vec<S> = mass.iter().map(|&m| m * heavy).collect();
        let m = self.modes.count();
        let [bending, torsion, stretch] = self.damping.ratios;
        let ratios = [bending, bending, torsion, stretch];
        // The kinds do not couple while the motion is small.
        for (range, ratio) in self.modes.ranges().into_iter().zip(ratios) {
            if ratio == S::zero() {
                continue;
            }
            let entries: Vec<usize> = (range.clone())
                .flat_map(|i| range.clone().map(move |j| i * m + j))
                .collect();
            let block = |matrix: &[S]| entries.iter().map(|&at| matrix[at]).collect::<Vec<S>>();
            let part = ratio_damping(&block(&mass), &block(&stiffness), ratio);
            for (&at, x) in entries.iter().zip(part) {
                damping[at] += x;
            }
        }
        damping
    }

    /// Motion of the point of the section at ξ with the distance `offset` (y, z) from its centre.
    pub fn point(&self, xi: S, offset: [S; 2]) -> PointModes<S> {
        let arm = Vec3::new(S::zero(), offset[0], offset[1]);
        let modes = self.section_modes(xi);
        PointModes {
            position: Vec3::new(self.length * xi, offset[0], offset[1]),
            displacement: (modes.iter())
                .map(|mode| mode.displacement + mode.rotation.cross(&arm))
                .collect(),
            rotation: modes.iter().map(|mode| mode.rotation).collect(),
        }
    }
}

/// Sums over the quadrature.
struct Sums<S> {
    mass: S,
    centre: Vec3<S>,
    /// S_00.
    second: Mat3<S>,
    static_moments: Vec<Vec3<S>>,
    with_position: Vec<Mat3<S>>,
    products: Vec<Mat3<S>>,
    stiffness: Vec<S>,
}

impl<S: Scalar> Sums<S> {
    fn zeros(m: usize) -> Self {
        Self {
            mass: S::zero(),
            centre: Vec3::zeros(),
            second: Mat3::zeros(),
            static_moments: vec![Vec3::zeros(); m],
            with_position: vec![Mat3::zeros(); m],
            products: vec![Mat3::zeros(); m * (m + 1) / 2],
            stiffness: vec![S::zero(); m * m],
        }
    }

    /// A slice of the beam at x. A point of its section is at X + y e2 + z e3; a mode moves it by
    /// U + y θ×e2 + z θ×e3, so S_IJ = ∫ρA U_I U_Jᵀ + ρI3 A_I A_Jᵀ + ρI2 B_I B_Jᵀ with A = θ×e2 and
    /// B = θ×e3.
    fn add_mass(&mut self, x: S, modes: &[SectionMode<S>], [m, m2, m3]: &[S; 3]) {
        let (e2, e3) = (Vec3::y(), Vec3::z());
        let place = Vec3::new(x, S::zero(), S::zero());
        let parts: Vec<[Vec3<S>; 3]> = (modes.iter())
            .map(|mode| {
                let turn = &mode.rotation;
                [mode.displacement, turn.cross(&e2), turn.cross(&e3)]
            })
            .collect();
        let outer = |a: &[Vec3<S>; 3], b: &[Vec3<S>; 3]| {
            (a[0] * b[0].transpose()) * *m
                + (a[1] * b[1].transpose()) * *m3
                + (a[2] * b[2].transpose()) * *m2
        };
        let undeformed = [place, e2, e3];
        self.mass += *m;
        self.centre += place * *m;
        self.second += outer(&undeformed, &undeformed);
        let mut next = self.products.iter_mut();
        for (i, part) in parts.iter().enumerate() {
            self.static_moments[i] += part[0] * *m;
            self.with_position[i] += outer(&undeformed, part);
            for (other, product) in parts[i..].iter().zip(&mut next) {
                *product += outer(part, other);
            }
        }
    }

    fn numbers(self, strains: Vec<Strain<S>>) -> ModalNumbers<S> {
        let m = self.static_moments.len();
        ModalNumbers {
            mass: self.mass,
            inertia: Mat3::from_diagonal_element(self.second.trace()) - self.second,
            shapes: ModalInertia {
                centre: self.centre,
                static_moments: self.static_moments,
                with_position: self.with_position,
                products: self.products,
            },
            stiffness: ModalStiffness {
                linear: self.stiffness,
                strains,
            },
            damping: vec![S::zero(); m * m],
            viscosity: None,
        }
    }
}
