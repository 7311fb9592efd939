//! Pseudo-random numbers that are the same in every run, and comparisons of derivatives.

use flexbody_mathematics::math::{Complex64, Scalar, Vec3};
use flexbody_mechanics::structures::material::Material;
use flexbody_mechanics::structures::shell::{Field, Motion, NODES, Shell, ShellKind};
use flexbody_mechanics::structures::structure::Structure;

/// A sequence of numbers in (−1, 1), by a congruential generator (Knuth's MMIX constants).
pub struct Numbers(u64);

impl Numbers {
    pub fn new(seed: u64) -> Self {
        Self(
            seed.wrapping_mul(2862933555777941757)
                .wrapping_add(3037000493),
        )
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self, size: f64) -> Vec3<f64> {
        Vec3::new(self.next(), self.next(), self.next()) * size
    }
}

/// Elements of nine and of four nodes.
pub const KINDS: [ShellKind; 2] = [ShellKind::Mitc9, ShellKind::Mitc4];

pub const ALUMINIUM: Material<f64> = Material {
    young: 70e9,
    poisson: 0.3,
    density: 2700.0,
    yield_stress: 270e6,
};

/// A curved and distorted element whose directors are near its normals.
pub fn distorted_element(kind: ShellKind, numbers: &mut Numbers, drilling: bool) -> Shell<f64> {
    let mut geometry = Field::zeros();
    let wide = kind.order() + 1;
    for k in 0..wide * wide {
        let place = |i: usize| 2.0 * i as f64 / kind.order() as f64 - 1.0;
        let (r, s) = (place(k % wide), place(k / wide));
        geometry.points[k] = Vec3::new(0.5 * r + 0.1 * s, 0.35 * s, 0.2 * r * r - 0.1 * r * s)
            + numbers.vector(0.05);
        geometry.directors[k] =
            (Vec3::new(-0.8 * r, 0.2 * r, 1.0) + numbers.vector(0.05)).normalize();
    }
    Shell {
        kind,
        geometry,
        thickness: 0.03,
        material: ALUMINIUM,
        surface_mass: 12.0,
        drilling,
    }
}

pub fn random_motion(kind: ShellKind, numbers: &mut Numbers) -> Motion<f64> {
    let mut motion = Motion::zeros();
    for a in 0..(kind.order() + 1).pow(2) {
        motion.displacement[a] = numbers.vector(0.01);
        motion.rotation[a] = numbers.vector(0.03);
    }
    motion
}

/// All numbers of an element, in a fixed order.
pub fn shell_numbers<S: Scalar>(shell: &Shell<S>) -> Vec<S> {
    let mut all: Vec<S> = Vec::new();
    for a in 0..NODES {
        all.extend(shell.geometry.points[a].iter());
        all.extend(shell.geometry.directors[a].iter());
    }
    let m = &shell.material;
    all.extend([shell.thickness, shell.surface_mass]);
    all.extend([m.young, m.poisson, m.density, m.yield_stress]);
    all
}

/// The element with these numbers.
pub fn shell_of<S: Scalar>(kind: ShellKind, numbers: &[S], drilling: bool) -> Shell<S> {
    let mut geometry = Field::zeros();
    for a in 0..NODES {
        geometry.points[a] = Vec3::from_column_slice(&numbers[6 * a..6 * a + 3]);
        geometry.directors[a] = Vec3::from_column_slice(&numbers[6 * a + 3..6 * a + 6]);
    }
    let rest = &numbers[6 * NODES..];
    Shell {
        kind,
        geometry,
        thickness: rest[0],
        surface_mass: rest[1],
        material: Material {
            young: rest[2],
            poisson: rest[3],
            density: rest[4],
            yield_stress: rest[5],
        },
        drilling,
    }
}

pub fn motion_numbers<S: Scalar>(motion: &Motion<S>) -> Vec<S> {
    let mut all: Vec<S> = Vec::new();
    for a in 0..NODES {
        all.extend(motion.displacement[a].iter());
        all.extend(motion.rotation[a].iter());
    }
    all
}

pub fn motion_of<S: Scalar>(numbers: &[S]) -> Motion<S> {
    let mut motion = Motion::zeros();
    for a in 0..NODES {
        motion.displacement[a] = Vec3::from_column_slice(&numbers[6 * a..6 * a + 3]);
        motion.rotation[a] = Vec3::from_column_slice(&numbers[6 * a + 3..6 * a + 6]);
    }
    motion
}

/// All numbers of a structure, and the lengths of the ranges of equal units.
pub fn structure_numbers<S: Scalar>(structure: &Structure<S>) -> (Vec<S>, Vec<usize>) {
    let shells = structure.thickness.len();
    let mut kinds = vec![3 * structure.nodes.len(), shells, shells];
    for section in &structure.sections {
        let _ = section.map(&mut |_| kinds.push(1));
    }
    let beams = structure.sections.len();
    if beams > 0 {
        kinds.extend([3 * beams, 2 * beams, beams]);
    }
    kinds.extend(structure.masses.iter().flat_map(|_| [1, 6]));
    kinds.extend(structure.materials.iter().flat_map(|_| [1; 4]));
    (structure.values(), kinds)
}

/// The structure with these numbers.
pub fn with_numbers(structure: &Structure<f64>, values: &[Complex64]) -> Structure<Complex64> {
    let mut next = values.iter().copied();
    structure.map(|_| next.next().expect("as many numbers"))
}

/// Derivatives of a function by the complex step.
pub fn complex_step(at: &[f64], f: impl Fn(&[Complex64]) -> Complex64) -> Vec<f64> {
    let h = 1e-30;
    let mut x: Vec<Complex64> = at.iter().map(|&x| Complex64::from(x)).collect();
    (0..at.len())
        .map(|i| {
            x[i].im = h;
            let derivative = f(&x).im / h;
            x[i].im = 0.0;
            derivative
        })
        .collect()
}

/// Derivatives to check, those by the complex step, and their function.
pub struct Compared<'a> {
    pub name: &'a str,
    /// Value of the function.
    pub value: f64,
    /// Numbers in which it is differentiated.
    pub at: &'a [f64],
    pub exact: &'a [f64],
    pub found: &'a [f64],
    /// Lengths of the ranges of numbers with equal units.
    pub kinds: &'a [usize],
}

impl Compared<'_> {
    /// Asserts agreement relative to the largest derivative of the same unit or, if these are only
    /// round-off, relative to the value divided by the number.
    pub fn assert(&self, tolerance: f64) {
        assert_eq!(self.exact.len(), self.found.len());
        let largest = |list: &[f64]| list.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let mut start = 0;
        for &kind in self.kinds {
            let range = start..start + kind;
            let unit = self.value.abs() / largest(&self.at[range.clone()]).max(1e-300);
            let size = largest(&self.exact[range.clone()]).max(unit);
            for i in range {
                let (exact, found) = (self.exact[i], self.found[i]);
                assert!(
                    (exact - found).abs() <= tolerance * size,
                    "{}: derivative {i}: {exact:e} by the complex step, {found:e} found, beside {size:e}",
                    self.name
                );
            }
            start += kind;
        }
        assert_eq!(start, self.exact.len());
    }
}
