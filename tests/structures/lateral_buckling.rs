//! Twist and bending of beams, to second order: lateral buckling, Wagner's term, rigid rotations, and beams that bend in both
//! planes and twist.

use super::sample::{ALUMINIUM, Numbers};
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::beam::{BEAM_NODES, Beam, BeamMotion, Section, SectionValues};
use flexbody_mechanics::structures::generate::{GeneratedBeams, straight_beam};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::statics::{StaticFailure, StaticProblem};
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use flexbody_mechanics::structures::von_karman::LoadSteps;
use nalgebra::Rotation3;

const PI: f64 = std::f64::consts::PI;
const LENGTH: f64 = 0.6;
const DEEP: Section<f64> = Section::Rectangle {
    width: 0.03,
    height: 0.001,
};

/// A straight beam along x whose axis 2 is y, turned by a rotation.
fn beam(section: Section<f64>, elements: usize, turn: &Rotation3<f64>) -> Structure<f64> {
    let mut straight = straight_beam([Vec3::zeros(), Vec3::x() * LENGTH], Vec3::y(), elements);
    for x in straight.nodes.iter_mut().chain(&mut straight.orientations) {
        *x = turn * *x;
    }
    let GeneratedBeams {
        mesh,
        nodes,
        orientations,
    } = straight;
    Structure::with_beams(mesh, nodes, 0.0, section, orientations, ALUMINIUM).expect("sound")
}

/// EI about the weak axis, about the strong one, and GJ.
fn stiffness(section: &Section<f64>) -> [f64; 3] {
    let [_, _, _, torsion, weak, strong] = section.values(&ALUMINIUM).stiffness;
    [weak, strong, torsion]
}

/// The part of a load at which the structure buckles.
fn critical(structure: &Structure<f64>, supports: &[Support], case: &[Load<f64>]) -> f64 {
    let mut problem = StaticProblem::new(structure, supports, NodeUnknowns::Natural).expect("sets");
    match problem.solve_von_karman(structure, case, &LoadSteps::default()) {
        Err(StaticFailure::Critical { kind, factor, .. }) => {
            println!("{kind}");
            factor
        }
        other => panic!("{other:?}"),
    }
}

fn point(nodes: &str, force: Vec3<f64>, moment: Vec3<f64>) -> Load<f64> {
    Load::Point {
        nodes: nodes.into(),
        force,
        moment,
    }
}

/// Critical loads of narrow rectangles: c √(EI GJ) / L² of forces and of whole distributed loads at the centre of the
/// section, 4.013 and 12.85 of cantilevers, 16.94 and 28.3 between hinges that do not twist, with the force in the
/// middle (Timoshenko & Gere 1961, ch. 6). In axes turned anyhow.
#[test]
fn narrow_beams_buckle_sideways_at_the_loads_of_the_book() {
    let [weak, _, torsion] = stiffness(&DEEP);
    let unit = (weak * torsion).sqrt() / LENGTH.powi(2);
    let clamp = [Support::clamp("start")];
    // Between hinges in axes x, y, z.
    let hinges = [
        Support::of("start", [true; 3], [true, false, false]),
        Support::of("end", [false, true, true], [true, false, false]),
    ];
    let line = |total: f64, turn: &Rotation3<f64>| Load::Line {
        beams: "all".into(),
        force: turn * Vec3::y() * (-total / LENGTH),
    };
    let down = |nodes: &str, force: f64, turn: &Rotation3<f64>| {
        point(nodes, turn * Vec3::y() * -force, Vec3::zeros())
    };
    let still = Rotation3::identity();
    let turned = Rotation3::new(Vec3::new(0.3, -1.1, 0.7));
    for (c, turn, supports, of_force) in [
        (4.013, &still, &clamp[..], Some("end")),
        (4.013, &turned, &clamp[..], Some("end")),
        (12.85, &turned, &clamp[..], None),
        (16.94, &still, &hinges[..], Some("middle")),
        (28.3, &still, &hinges[..], None),
    ] {
        let mut structure = beam(DEEP, 16, turn);
        let topology = std::sync::Arc::make_mut(&mut structure.topology);
        let middle = topology.mesh.beams[8][0];
        topology
            .mesh
            .node_sets
            .insert("middle".into(), vec![middle]);
        topology
            .mesh
            .beam_sets
            .insert("all".into(), (0..16).collect());
        let size = 1.3 * c * unit;
        let load = match of_force {
            Some(nodes) => down(nodes, size, turn),
            None => line(size, turn),
        };
        let found = 1.3 * critical(&structure, supports, &[load]);
        println!("{c}: {found}");
        assert!((found - 1.0).abs() < 4e-3, "{c}: {found}");
    }
}

/// A beam under a uniform moment between hinges that do not twist has bent before it buckles: π √(EI GJ) / L by
/// √((1 − EI/EI_strong)(1 − GJ/EI_strong)) (Michell 1899; Trahair 1993, section 7.2).
/// Terms of third order in the strains would add (EI − GJ) / 4 EI_strong, which is small of deep beams.
#[test]
fn bending_before_buckling_raises_the_moment() {
    let supports = [
        Support::of("start", [true; 3], [true, false, false]),
        Support::of("end", [false, true, true], [true, false, false]),
    ];
    let sections = [
        DEEP,
        Section::Rectangle {
            width: 0.01,
            height: 0.0025,
        },
        Section::I {
            width: 0.012,
            height: 0.02,
            flange: 0.001,
            web: 0.001,
        },
        Section::Given(SectionValues {
            stiffness: [1e7, 4e6, 4e6, 5.0, 10.0, 100.0],
            inertia: [1.0, 1e-4, 1e-4],
        }),
        Section::Given(SectionValues {
            stiffness: [1e9, 4e8, 4e8, 10.0, 100.0, 5.0],
            inertia: [1.0, 1e-4, 1e-4],
        }),
    ];
    for section in sections {
        let structure = beam(section, 16, &Rotation3::identity());
        let [mut weak, mut strong, torsion] = stiffness(&section);
        let mut axis = Vec3::z();
        if weak > strong {
            (weak, strong, axis) = (strong, weak, Vec3::y());
        }
        let plain = PI * (weak * torsion).sqrt() / LENGTH;
        let exact = plain / ((1.0 - weak / strong) * (1.0 - torsion / strong)).sqrt();
        let size = 1.2 * exact;
        let case = [
            point("start", Vec3::zeros(), axis * -size),
            point("end", Vec3::zeros(), axis * size),
        ];
        let found = 1.2 * critical(&structure, &supports, &case);
        let slope = exact * LENGTH / (2.0 * strong);
        let third = (weak - torsion) / (4.0 * strong);
        println!("{section:?}: {found}, {third}, {slope}");
        assert!(
            (found - 1.0 - third).abs() < 1e-3 + 0.2 * third.abs() + 0.3 * slope * slope,
            "{found}"
        );
    }
}

/// An axial force N changes the torsional stiffness to GJ + N I_p/A (Wagner 1929); a thin cross buckles by twisting
/// at N = −GJ A / I_p. Neither without the force nor with linear strains.
#[test]
fn an_axial_force_changes_the_stiffness_of_torsion() {
    let values = SectionValues {
        stiffness: [2e7, 8e6, 8e6, 0.2, 900.0, 700.0],
        inertia: [1.0, 1e-3, 1e-3],
    };
    let structure = beam(Section::Given(values), 4, &Rotation3::identity());
    let [ea, _, _, torsion, bending2, bending3] = values.stiffness;
    let gyration = (bending2 + bending3) / ea;
    let mut problem = StaticProblem::new(
        &structure,
        &[Support::clamp("start")],
        NodeUnknowns::Natural,
    )
    .expect("sets");
    let end = structure.topology.mesh.node_sets["end"][0];
    for part in [-0.9, -0.4, 0.0, 1.0, 5.0] {
        let force = part * torsion / gyration;
        // Twists that are small: the stretch by the twist is of their square.
        let torque = 1e-3 * torsion;
        let case = [point("end", Vec3::x() * force, Vec3::x() * torque)];
        let found = problem
            .solve_von_karman(&structure, &case, &LoadSteps::default())
            .expect("an equilibrium");
        let twist = problem.motion(&structure, &found.x).rotation[end].x;
        let exact = torque * LENGTH / (torsion + force * gyration);
        assert!(
            (twist / exact - 1.0).abs() < 1e-4,
            "{part}: {twist} {exact}"
        );
    }
    let size = 1.4 * torsion / gyration;
    let case = [point("end", Vec3::x() * -size, Vec3::zeros())];
    let found = 1.4 * critical(&structure, &[Support::clamp("start")], &case);
    assert!((found - 1.0).abs() < 1e-3, "{found}");
}

/// A beam that is turned as a rigid body has no curvature, and the energy of what remains falls with the sixth power of the
/// angle: its strains are exact to second order. With von Karman's stretch alone it falls with the fourth.
#[test]
fn turned_beams_have_no_strain_to_second_order() {
    let mut numbers = Numbers::new(17);
    for _ in 0..6 {
        let beam = Beam {
            points: [0.0, 0.5, 1.0].map(|x| Vec3::new(x, 0.1 * x * x, -0.2 * x * x)),
            orientation: Vec3::new(0.1, 0.2, 1.0),
            section: Section::Rectangle {
                width: 0.05,
                height: 0.02,
            },
            offset: [0.0; 2],
            material: ALUMINIUM,
            line_mass: 0.0,
        };
        let axis = numbers.vector(1.0).normalize();
        let energy = |angle: f64| {
            let turn = axis * angle;
            let rotation = Rotation3::new(turn);
            let motion = BeamMotion {
                displacement: beam.points.map(|x| rotation * x - x),
                rotation: [turn; BEAM_NODES],
            };
            beam.energy(&motion, true)
        };
        let ratio = energy(0.2) / energy(0.1);
        println!("{ratio}");
        assert!(ratio > 50.0, "{ratio}");
    }
}
