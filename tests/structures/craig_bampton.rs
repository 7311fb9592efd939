//! Reductions of free bodies against the frequencies of their full matrices, closed forms and exact integrals.

use super::sample::{ALUMINIUM, Numbers};
use flexbody_mathematics::math::{Mat3, Vec3};
use flexbody_mechanics::structures::assembly::Assembly;
use flexbody_mechanics::structures::beam::Section;
use flexbody_mechanics::structures::damping::RayleighDamping;
use flexbody_mechanics::structures::generate::{Generated, plate, straight_beam};
use flexbody_mechanics::structures::modal::ModalNumbers;
use flexbody_mechanics::structures::modal::craig_bampton::{Reduction, reduce};
use flexbody_mechanics::structures::modal::free_body::{FreeBody, NoFreeBody};
use flexbody_mechanics::structures::modal::frequencies::{Held, frequencies};
use flexbody_mechanics::structures::modal::imported::{Factors, ImportedDamping};
use flexbody_mechanics::structures::modal::interfaces::{Holding, Interface, NoReduction};
use flexbody_mechanics::structures::modal::written::Entry;
use flexbody_mechanics::structures::modes::ModalProblem;
use flexbody_mechanics::structures::shell::Terms;
use flexbody_mechanics::structures::state::NodalMotion;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::NodeUnknowns;

/// Stiffness and mass of a structure without supports, as a file would have them.
fn exported(structure: &Structure<f64>) -> FreeBody {
    let assembly = Assembly::new(structure, &[], NodeUnknowns::Six).expect("known sets");
    let configuration = assembly.configuration(structure);
    let rest = NodalMotion::zeros(structure.nodes.len());
    let mut values = [0, 1].map(|_| vec![0.0; assembly.pattern.entries()]);
    assembly.tangent(&configuration, &rest, Terms::LINEAR, &mut values[0]);
    assembly.mass(&configuration, &mut values[1]);
    let mut keys = vec![0; assembly.unknowns.count];
    for (node, at) in assembly.unknowns.nodes.iter().enumerate() {
        for k in 0..3 {
            keys[at.displacements[k].expect("free")] = 6 * node + k;
        }
        let rotations = assembly.unknowns.rotations_of(node);
        assert_eq!(rotations.len(), 3);
        for (k, unknown) in rotations.enumerate() {
            keys[unknown] = 6 * node + 3 + k;
        }
    }
    let entries = |values: &[f64]| -> Vec<Entry> {
        let columns = 0..assembly.unknowns.count;
        columns
            .flat_map(|j| {
                let keys = &keys;
                let column = assembly.pattern.column(j);
                column.map(move |(at, i)| (keys[i], keys[j], values[at]))
            })
            .collect()
    };
    let body = FreeBody::new(
        structure.nodes.clone(),
        &entries(&values[0]),
        &entries(&values[1]),
    );
    body.check(|node| node.to_string()).expect("a free body");
    body
}

fn sheet(cells: [usize; 2]) -> Structure<f64> {
    let Generated { mesh, nodes } = plate([1.0, 0.6], cells);
    Structure::uniform(mesh, nodes, 0.01, ALUMINIUM).expect("sound")
}

fn node_at(body: &FreeBody, place: [f64; 3]) -> usize {
    let place = Vec3::from(place);
    let found = body.nodes.iter().position(|x| (x - place).norm() < 1e-9);
    found.expect("a node there")
}

/// All nodes at x.
fn edge(body: &FreeBody, x: f64) -> Interface {
    Interface {
        name: format!("x = {x}"),
        nodes: (0..body.nodes.len())
            .filter(|&k| (body.nodes[k].x - x).abs() < 1e-9)
            .collect(),
    }
}

fn interfaces(body: &FreeBody, places: &[[f64; 3]]) -> Vec<Interface> {
    (places.iter().enumerate())
        .map(|(k, place)| Interface {
            name: format!("{k}"),
            nodes: vec![node_at(body, *place)],
        })
        .collect()
}

fn numbers(reduction: &Reduction) -> ModalNumbers<f64> {
    let one = Factors {
        young: 1.0,
        density: 1.0,
        length: 1.0,
    };
    let none = ImportedDamping {
        ratio: 0.0,
        rayleigh: RayleighDamping {
            mass: 0.0,
            stiffness: 0.0,
        },
    };
    reduction.body.numbers(&one, &none)
}

/// Largest relative difference of the first frequencies.
fn difference(found: &[f64], expected: &[f64]) -> f64 {
    let pairs = found.iter().zip(expected);
    pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

/// A free plate of shells: six frequencies against those of its own finite elements, with clamped and chord
/// frames, whose free frequencies are the same as they span the same motions.
#[test]
fn a_reduced_plate_has_the_frequencies_of_the_full_one() {
    let structure = sheet([8, 6]);
    let mut full = ModalProblem::new(&structure, &[], NodeUnknowns::Six).expect("known sets");
    let full = full.solve(&structure, 6).expect("modes");
    assert_eq!(full.rigid, 6);
    let full = &full.frequencies()[..6];
    let body = exported(&structure);
    let ports = interfaces(&body, &[[0.0, 0.0, 0.0], [1.0, 0.6, 0.0], [1.0, 0.0, 0.0]]);
    let mut last = f64::INFINITY;
    for (modes, most) in [(6, 0.3), (20, 0.02), (60, 2e-3)] {
        let mut both = Vec::new();
        for holding in [
            Holding::Clamped(1),
            Holding::Chord(0, 1, None),
            Holding::Chord(2, 0, Some(1)),
        ] {
            let reduction = reduce(&body, &ports, &holding, modes).expect("reduced");
            assert_eq!(reduction.boundary_before, 18);
            assert_eq!(reduction.boundary.len(), 12, "{holding:?}");
            let found = frequencies(&numbers(&reduction), Held::Nothing).expect("definite");
            let off = difference(&found[..6], full);
            println!("{modes} fixed-interface modes, {holding:?}: {off:.1e}");
            assert!(off < most, "{off:e}");
            // Ritz: no reduced frequency is below the true one.
            assert!(found.iter().zip(full).all(|(a, b)| a / b > 1.0 - 1e-6));
            both.push((found, off));
        }
        assert!(difference(&both[0].0[..6], &both[1].0[..6]) < 1e-7);
        assert!(difference(&both[0].0[..6], &both[2].0[..6]) < 1e-7);
        assert!(both[0].1 < last);
        last = both[0].1;
    }
}

/// The rigid inertia and the integrals of the shapes of a thin plate, whose elements interpolate all
/// displacements alike: exact where rotary inertia h²/12 does not count.
#[test]
fn integrals_are_those_of_the_mass() {
    let structure = sheet([6, 4]);
    let body = exported(&structure);
    let ports = [edge(&body, 0.0), edge(&body, 1.0)];
    let reduction = reduce(&body, &ports, &Holding::Clamped(0), 8).expect("reduced");
    let found = &reduction.body;
    let (a, b, h) = (1.0, 0.6, 0.01);
    let mass = ALUMINIUM.density * a * b * h;
    assert!((found.mass / mass - 1.0).abs() < 1e-12);
    let centre = Vec3::new(a / 2.0, b / 2.0, 0.0);
    assert!((found.centre / mass - centre).norm() < 1e-12);
    let rotary = h * h / 12.0;
    let (xx, yy) = (b * b / 3.0 + rotary, a * a / 3.0 + rotary);
    let xy = -a * b / 4.0;
    let inertia = Mat3::new(xx, xy, 0.0, xy, yy, 0.0, 0.0, 0.0, (a * a + b * b) / 3.0) * mass;
    assert!(
        (found.inertia - inertia).amax() < 1e-10 * mass,
        "{}",
        found.inertia
    );
    let m = found.modes();
    let own = numbers(&reduction);
    let elastic = own.elastic_mass();
    for i in 0..m {
        for j in 0..m {
            let (mass_ij, k) = (elastic[i * m + j] / mass, own.stiffness.linear[i * m + j]);
            let scale = (own.stiffness.linear[i * m + i] * own.stiffness.linear[j * m + j]).sqrt();
            let expected = f64::from(u8::from(i == j));
            assert!((mass_ij - expected).abs() < 1e-9, "{i} {j}: {mass_ij}");
            assert!(i == j || k.abs() < 1e-7 * scale, "{i} {j}: {k}");
            // S must be that of displacements: |S_IJ|² ≤ tr S_II tr S_JJ.
            let s = found.products[own.shapes.place(i.min(j), i.max(j)).0];
            assert!(s.norm() <= mass * (1.0 + 1e-9));
        }
    }
    // The lowest modes are bending along z.
    let first = found.products[0];
    assert!(
        (first[(2, 2)] / mass - 1.0).abs() < 1e-3,
        "{}",
        first / mass
    );
}

/// Frequencies of a slender beam against Euler and Bernoulli: free, and clamped at its start.
#[test]
fn a_reduced_beam_has_the_frequencies_of_closed_forms() {
    let (length, side) = (1.0, 0.004);
    let ends = [Vec3::zeros(), Vec3::x() * length];
    let line = straight_beam(ends, Vec3::y(), 40);
    let section = Section::Rectangle {
        width: side,
        height: side,
    };
    let (nodes, orientations) = (line.nodes, line.orientations);
    let structure = Structure::with_beams(line.mesh, nodes, 0.0, section, orientations, ALUMINIUM)
        .expect("sound");
    let body = exported(&structure);
    let ports = interfaces(&body, &[[0.0; 3], [length, 0.0, 0.0]]);
    let reduction = reduce(&body, &ports, &Holding::Clamped(0), 12).expect("reduced");
    assert_eq!(
        (reduction.boundary_before, reduction.boundary.len()),
        (12, 6)
    );
    let own = numbers(&reduction);
    let unit = (ALUMINIUM.young * side * side / (12.0 * ALUMINIUM.density)).sqrt()
        / (2.0 * std::f64::consts::PI * length * length);
    for (held, roots) in [
        (Held::Axes, [1.8751041, 4.6940911]),
        (Held::Nothing, [4.7300407, 7.8532046]),
    ] {
        let found = frequencies(&own, held).expect("definite");
        for (k, root) in roots.iter().enumerate() {
            // Both planes.
            for found in &found[2 * k..2 * k + 2] {
                let expected = root * root * unit;
                assert!((found / expected - 1.0).abs() < 5e-4, "{found} {expected}");
            }
        }
    }
}

/// Several nodes of an edge as one rigid interface, among them such without rotations; and what bodies
/// cannot be.
#[test]
fn interfaces_and_matrices_that_do_not_suit_are_told() {
    let structure = sheet([4, 4]);
    let body = exported(&structure);
    let ports = [edge(&body, 0.0), edge(&body, 1.0)];
    let reduction = reduce(&body, &ports, &Holding::Clamped(0), 4).expect("reduced");
    assert_eq!(reduction.boundary.len(), 6);
    assert!((reduction.body.points[1].position - Vec3::new(1.0, 0.3, 0.0)).norm() < 1e-12);
    let still = &reduction.body.points[0];
    assert!(still.displacement.iter().all(|n| *n == Vec3::zeros()));
    assert!(still.rotation.iter().all(|n| *n == Vec3::zeros()));
    // Without rotations these nodes hold nothing about their line.
    let keep = |node: usize, component: usize| component < 3 || body.nodes[node].x > 0.9;
    let entries = |values: &[f64]| -> Vec<Entry> {
        let key = |i: usize| 6 * body.unknowns[i].node + body.unknowns[i].component;
        let there = |i: usize| keep(body.unknowns[i].node, body.unknowns[i].component);
        let columns = (0..body.unknowns.len()).filter(|&j| there(j));
        columns
            .flat_map(|j| {
                let column = body.pattern.column(j).filter(|(_, i)| there(*i));
                column
                    .map(|(at, i)| (key(i), key(j), values[at]))
                    .collect::<Vec<_>>()
            })
            .collect()
    };
    let solid = FreeBody::new(
        body.nodes.clone(),
        &entries(&body.stiffness),
        &entries(&body.mass),
    );
    let failure = reduce(&solid, &ports, &Holding::Clamped(0), 4).expect_err("one line");
    assert!(matches!(failure, NoReduction::OnALine { .. }), "{failure}");
    let same = [ports[0].clone()];
    let failure = reduce(&body, &same, &Holding::Chord(0, 0, None), 4).expect_err("no line");
    assert_eq!(failure, NoReduction::Collinear);
    // Supports: the rows of a node are taken away, or springs to the ground.
    let held = |values: &[f64], more: f64| -> Vec<Entry> {
        let key = |i: usize| 6 * body.unknowns[i].node + body.unknowns[i].component;
        let columns = 0..body.unknowns.len();
        let mut all: Vec<Entry> = columns
            .flat_map(|j| {
                let column = body.pattern.column(j);
                column
                    .map(|(at, i)| (key(i), key(j), values[at]))
                    .collect::<Vec<_>>()
            })
            .collect();
        let largest = values.iter().fold(0.0_f64, |m, x| m.max(*x));
        all.push((2, 2, more * largest));
        all
    };
    let sprung = FreeBody::new(
        body.nodes.clone(),
        &held(&body.stiffness, 1e-3),
        &held(&body.mass, 0.0),
    );
    let fault = sprung.check(|node| node.to_string()).expect_err("held");
    assert!(matches!(fault, NoFreeBody::Held { .. }), "{fault}");
    let heavy = FreeBody::new(
        body.nodes.clone(),
        &held(&body.stiffness, 0.0),
        &held(&body.mass, 1.0),
    );
    let fault = heavy.check(|node| node.to_string()).expect_err("uneven");
    assert!(matches!(fault, NoFreeBody::Masses { .. }), "{fault}");
}

/// Random bars in space with lumped masses: a reduction with all modes is the body itself, and its integrals are
/// sums over the nodes.
#[test]
fn lumped_masses_give_exact_integrals() {
    for seed in 0..4 {
        let mut random = Numbers::new(seed);
        let count = 7;
        let nodes: Vec<Vec3<f64>> = (0..count).map(|_| random.vector(1.0)).collect();
        let masses: Vec<f64> = (0..count).map(|_| 1.5 + random.next()).collect();
        let mut stiffness = Vec::new();
        for a in 0..count {
            for b in 0..a {
                let line = (nodes[a] - nodes[b]).normalize();
                let k = 100.0 * (1.5 + random.next());
                for i in 0..3 {
                    for j in 0..3 {
                        let value = k * line[i] * line[j];
                        stiffness.push((6 * a + i, 6 * b + j, -value));
                        if i >= j {
                            stiffness.push((6 * a + i, 6 * a + j, value));
                            stiffness.push((6 * b + i, 6 * b + j, value));
                        }
                    }
                }
            }
        }
        let diagonal = |a: usize| (0..3).map(move |i| (6 * a + i, 6 * a + i));
        let mass: Vec<Entry> = (0..count)
            .flat_map(|a| diagonal(a).map(move |(i, j)| (a, i, j)))
            .map(|(a, i, j)| (i, j, masses[a]))
            .collect();
        let body = FreeBody::new(nodes.clone(), &stiffness, &mass);
        body.check(|node| node.to_string()).expect("a free body");
        let port = |k: usize| Interface {
            name: format!("{k}"),
            nodes: vec![k],
        };
        let ports = [port(0), port(1), port(2)];
        let reduction =
            reduce(&body, &ports, &Holding::Chord(0, 1, Some(2)), 100).expect("reduced");
        // 21 displacements less six rigid motions.
        assert_eq!(reduction.body.modes(), 15, "{reduction:?}");
        let found = &reduction.body;
        let total: f64 = masses.iter().sum();
        let centre: Vec3<f64> = nodes.iter().zip(&masses).map(|(x, m)| x * *m).sum();
        assert!((found.mass - total).abs() < 1e-12 * total);
        assert!((found.centre - centre).norm() < 1e-12 * total);
        let mut inertia = Mat3::zeros();
        for (x, m) in nodes.iter().zip(&masses) {
            inertia -= x.cross_matrix() * x.cross_matrix() * *m;
        }
        assert!((found.inertia - inertia).amax() < 1e-12 * total);
        assert!(!found.points[0].turns);
        // The frame: the first point rests, the second stays on the chord, the third in the plane.
        let chord = (nodes[1] - nodes[0]).normalize();
        let normal = chord.cross(&(nodes[2] - nodes[0])).normalize();
        for k in 0..15 {
            assert!(found.points[0].displacement[k].norm() < 1e-14);
            assert!(found.points[1].displacement[k].cross(&chord).norm() < 1e-12);
            assert!(found.points[2].displacement[k].dot(&normal).abs() < 1e-12);
        }
        // Motions are as many as displacements, so rigid inertia of a moved body follows from S: moving it by q
        // in mode k changes ∫ X Xᵀ dm by q (S_0k + S_k0) + q² S_kk.
        let points = reduction_shapes(&body, &ports, &reduction);
        for (k, shape) in points.iter().enumerate() {
            let mut with_position = Mat3::zeros();
            let mut square = Mat3::zeros();
            for ((x, u), m) in nodes.iter().zip(shape).zip(&masses) {
                with_position += x * u.transpose() * *m;
                square += u * u.transpose() * *m;
            }
            assert!((found.with_position[k] - with_position).amax() < 1e-9 * total);
            let own = numbers(&reduction);
            let s = found.products[own.shapes.place(k, k).0];
            assert!((s - square).amax() < 1e-9 * total);
        }
    }
}

/// Shapes at all nodes, from a reduction in which every node is an interface.
fn reduction_shapes(
    body: &FreeBody,
    ports: &[Interface],
    reduction: &Reduction,
) -> Vec<Vec<Vec3<f64>>> {
    let mut all = ports.to_vec();
    for k in all.len()..body.nodes.len() {
        all.push(Interface {
            name: format!("{k}"),
            nodes: vec![k],
        });
    }
    let whole = reduce(body, &all, &Holding::Chord(0, 1, Some(2)), 0).expect("reduced");
    let m = reduction.body.modes();
    assert_eq!(whole.body.modes(), m);
    (0..m)
        .map(|k| {
            let shape: Vec<Vec3<f64>> = whole
                .body
                .points
                .iter()
                .map(|point| point.displacement[k])
                .collect();
            // Modes have a sign of their own.
            let along: f64 = (0..3)
                .map(|p| shape[p].dot(&reduction.body.points[p].displacement[k]))
                .sum();
            shape.iter().map(|u| u * along.signum()).collect()
        })
        .collect()
}
