//! Dot-product tests: each linear map beside its transpose, ȳ·(A x) = x·(Aᵀ ȳ), by name.

use super::basis::{NODES, SHEAR_POINTS, TYING_POINTS, Tables};
use super::field::{
    AtPoint, Field, add_interpolate_transpose, add_sum_transpose, interpolate, sum,
};
use super::frame::Frame;
use super::tying::{add_carry_shear_transpose, add_carry_transpose, carry, carry_shear};
use super::{Motion, energy::Shell};
use crate::math::Vec3;
use crate::model::shell_kind::{PerNode, ShellKind};
use crate::structures::material::Material;

const KINDS: [ShellKind; 2] = [ShellKind::Mitc9, ShellKind::Mitc4];

fn tables() -> [&'static Tables; 2] {
    KINDS.map(ShellKind::tables)
}

/// Numbers in (−1, 1) that look random.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self) -> Vec3<f64> {
        Vec3::new(self.next(), self.next(), self.next())
    }

    fn list<const N: usize>(&mut self) -> [f64; N] {
        std::array::from_fn(|_| self.next())
    }

    fn field(&mut self) -> Field<f64> {
        Field {
            points: std::array::from_fn(|_| self.vector()),
            directors: std::array::from_fn(|_| self.vector()),
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn dot_vectors(a: &[Vec3<f64>], b: &[Vec3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn dot_fields(a: &Field<f64>, b: &Field<f64>) -> f64 {
    dot_vectors(&a.points, &b.points) + dot_vectors(&a.directors, &b.directors)
}

#[track_caller]
fn assert_same(forwards: f64, backwards: f64) {
    assert!(
        (forwards - backwards).abs() < 1e-13,
        "{forwards} {backwards}"
    );
    assert!(forwards.abs() > 1e-3, "a pair that says nothing");
}

#[test]
fn sum_and_its_transpose() {
    let mut numbers = Numbers(1);
    for count in [9, 4] {
        let x = numbers.field().points;
        let weights = PerNode::from_fn(count, |_| numbers.next());
        let bar = numbers.vector();
        let mut to = [Vec3::zeros(); NODES];
        add_sum_transpose(&weights, &bar, &mut to);
        assert_same(bar.dot(&sum(&weights, &x)), dot_vectors(&to, &x));
        assert!(to[count..].iter().all(|x| *x == Vec3::zeros()));
    }
}

#[test]
fn interpolate_and_its_transpose() {
    let mut numbers = Numbers(2);
    let bases = tables().into_iter().flat_map(|tables| {
        let tying = tables.tying.iter().map(|own| &own.basis);
        tying.chain(&tables.gauss).chain(&tables.nodes)
    });
    for basis in bases {
        let x = numbers.field();
        let bar = AtPoint {
            by: std::array::from_fn(|_| numbers.vector()),
            director: numbers.vector(),
            director_by: std::array::from_fn(|_| numbers.vector()),
        };
        let mut to = Field::zeros();
        add_interpolate_transpose(basis, &bar, &mut to);
        let y = interpolate(basis, &x);
        let forwards = dot_vectors(&bar.by, &y.by)
            + bar.director.dot(&y.director)
            + dot_vectors(&bar.director_by, &y.director_by);
        assert_same(forwards, dot_fields(&to, &x));
    }
}

#[test]
fn carry_and_its_transpose() {
    let mut numbers = Numbers(3);
    for g in tables().into_iter().flat_map(|tables| &tables.tied) {
        let (x, bar) = (numbers.list::<TYING_POINTS>(), numbers.list::<3>());
        let mut to = [0.0; TYING_POINTS];
        add_carry_transpose(g, &bar, &mut to);
        assert_same(dot(&bar, &carry(g, &x)), dot(&to, &x));
        let (x, bar) = (numbers.list::<SHEAR_POINTS>(), numbers.list::<2>());
        let mut to = [0.0; SHEAR_POINTS];
        add_carry_shear_transpose(g, &bar, &mut to);
        assert_same(dot(&bar, &carry_shear(g, &x)), dot(&to, &x));
    }
}

#[test]
fn strain_and_shear_of_a_frame_and_their_transposes() {
    let mut numbers = Numbers(4);
    for _ in 0..10 {
        let tangents = [numbers.vector(), numbers.vector()];
        let frame = Frame::of(&tangents, &numbers.vector());
        let (x, bar) = (numbers.list::<3>(), numbers.list::<3>());
        let size = 1.0 / (1.0 + frame.t.iter().flatten().map(|x| x * x).sum::<f64>());
        let forwards = dot(&bar, &frame.strain(&x)) * size;
        let backwards = dot(&frame.strain_transpose(&bar), &x) * size;
        assert_same(forwards, backwards);
        let (x, bar) = (numbers.list::<2>(), numbers.list::<2>());
        let forwards = dot(&bar, &frame.shear(&x)) * size;
        assert_same(forwards, dot(&frame.shear_transpose(&bar), &x) * size);
    }
}

#[test]
fn the_field_of_a_motion_and_its_transpose() {
    let mut numbers = Numbers(5);
    let (geometry, bar) = (numbers.field(), numbers.field());
    let motion = Motion {
        displacement: numbers.field().points,
        rotation: numbers.field().points,
    };
    let (mut to, mut geometry_to) = (Motion::zeros(), Field::zeros());
    motion.add_field_transpose(&geometry, &bar, &mut to, &mut geometry_to);
    let forwards = dot_fields(&bar, &motion.field(&geometry));
    let backwards = dot_vectors(&to.displacement, &motion.displacement)
        + dot_vectors(&to.rotation, &motion.rotation);
    assert_same(forwards, backwards);
    // In the directors the map is linear too, and the points take no part.
    let turned = dot_vectors(&bar.directors, &motion.field(&geometry).directors);
    assert_same(
        turned,
        dot_vectors(&geometry_to.directors, &geometry.directors),
    );
    assert_eq!(dot_vectors(&geometry_to.points, &geometry.points), 0.0);
}

/// The bilinear form of the energy is symmetric: ψ·F(v) = v·F(ψ) for linear strains.
#[test]
fn the_linear_force_is_its_own_transpose() {
    KINDS.into_iter().for_each(linear_force);
}

fn linear_force(kind: ShellKind) {
    let mut numbers = Numbers(6);
    let mut geometry = numbers.field();
    let wide = kind.order() + 1;
    for k in 0..wide * wide {
        let place = |i: usize| 2.0 * i as f64 / kind.order() as f64 - 1.0;
        let (r, s) = (place(k % wide), place(k / wide));
        geometry.points[k] = geometry.points[k] * 0.05 + Vec3::new(r, s, 0.1 * r * r);
        geometry.directors[k] = geometry.directors[k] * 0.05 + Vec3::new(-0.2 * r, 0.0, 1.0);
    }
    let shell = Shell {
        kind,
        geometry,
        thickness: 0.3,
        material: Material {
            young: 1.0,
            poisson: 0.3,
            density: 1.0,
            yield_stress: 1.0,
        },
        surface_mass: 0.2,
        drilling: true,
    };
    let mut motion = || Motion {
        displacement: numbers.field().points,
        rotation: numbers.field().points,
    };
    let pair = [motion(), motion()];
    let work = |a: &Motion<f64>, b: &Motion<f64>| {
        dot_vectors(&a.displacement, &b.displacement) + dot_vectors(&a.rotation, &b.rotation)
    };
    for kinetic in [false, true] {
        let products = [0, 1].map(|k: usize| {
            let mut force = Motion::zeros();
            let to = &mut super::ShellCotangent::zeros();
            if kinetic {
                shell.add_kinetic_energy_transpose(&pair[k], 1.0, &mut force, to);
            } else {
                let terms = super::Terms::LINEAR;
                shell.add_energy_transpose(&pair[k], terms, &mut force, to);
            }
            work(&force, &pair[1 - k])
        });
        assert_same(products[0], products[1]);
    }
}
