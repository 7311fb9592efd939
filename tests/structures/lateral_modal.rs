//! Lateral buckling and Wagner's term of beams by functions, and their section forces.

use super::sample::{ALUMINIUM, Numbers};
use flexbody_mechanics::model::flexible::{ModalStiffness, Quadratic};
use flexbody_mechanics::structures::beam::Section;
use flexbody_mechanics::structures::modal::sections::SectionForce;
use flexbody_mechanics::structures::modal::{
    BeamDamping, BeamFrame, BeamModes, BendingFunctions, FlexibleBeam, StrainMeasure,
};
use nalgebra::{DMatrix, DVector};

const LENGTH: f64 = 0.8;
const DEEP: Section<f64> = Section::Rectangle {
    width: 0.001,
    height: 0.03,
};

fn beam(section: Section<f64>, bending: [usize; 2], torsion: usize) -> FlexibleBeam<f64> {
    FlexibleBeam {
        length: LENGTH,
        section,
        material: ALUMINIUM,
        frame: BeamFrame::Clamped,
        functions: BendingFunctions::Polynomial,
        modes: BeamModes {
            bending,
            torsion,
            stretch: BeamModes::companions(bending, torsion),
        },
        strain: StrainMeasure::VonKarman,
        shear: true,
        damping: BeamDamping {
            ratios: [0.0; 3],
            mass: 0.0,
            viscosity: None,
        },
    }
}

/// ∇U and ∂²U/∂q².
fn derivatives(own: &ModalStiffness<f64>, q: &DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let m = q.len();
    let linear = DMatrix::from_row_slice(m, m, &own.linear);
    let (mut force, mut tangent) = (&linear * q, linear);
    for strain in &own.strains {
        let form = &strain.strain;
        let mut gradient = vec![0.0; m];
        form.add_gradient(q.as_slice(), 1.0, &mut gradient);
        let gradient = DVector::from_vec(gradient);
        let n = strain.weight * form.value(q.as_slice());
        force += &gradient * n;
        tangent += &gradient * gradient.transpose() * strain.weight;
        for (c, g) in &form.squares {
            let g = DVector::from_column_slice(g);
            tangent += &g * g.transpose() * (n * c);
        }
    }
    (force, tangent)
}

/// Equilibrium under a dead load, by Newton's method in load steps.
fn at_rest(own: &ModalStiffness<f64>, load: &DVector<f64>) -> DVector<f64> {
    let mut q = DVector::zeros(load.len());
    for step in 1..=4 {
        for _ in 0..30 {
            let (force, tangent) = derivatives(own, &q);
            let rest = load * (f64::from(step) / 4.0) - force;
            q += tangent.lu().solve(&rest).expect("regular");
        }
    }
    q
}

/// The factor of a load in the plane at which equilibrium in it ceases to be stable.
fn critical(own: &ModalStiffness<f64>, load: &DVector<f64>) -> f64 {
    let (mut low, mut high) = (0.0, 2.0);
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        let (_, tangent) = derivatives(own, &at_rest(own, &(load * middle)));
        if tangent.cholesky().is_some() {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Work of a force along y at ξ, by the coordinates.
fn down(body: &FlexibleBeam<f64>, xi: f64, force: f64) -> DVector<f64> {
    let point = body.point(xi, [0.0; 2]);
    DVector::from_iterator(
        point.displacement.len(),
        point.displacement.iter().map(|x| force * x.y),
    )
}

/// √(EI GJ) / L² with the smaller EI.
fn unit(body: &FlexibleBeam<f64>) -> f64 {
    let [_, _, _, torsion, ei2, ei3] = body.values().stiffness;
    (ei2.min(ei3) * torsion).sqrt() / LENGTH.powi(2)
}

/// 4.013 √(EI GJ) / L² of a force at the end, 12.85 of a distributed one (Timoshenko & Gere 1961, ch. 6), from
/// above the nearer the more functions. Three in the stiff plane are the fewest that suffice: with two the load is 9 % low.
#[test]
fn cantilevers_buckle_sideways_at_the_loads_of_the_book() {
    let distributed = |body: &FlexibleBeam<f64>| {
        let rule = flexbody_mathematics::math::legendre::gauss(8);
        let zero = DVector::zeros(body.modes.count());
        rule.iter()
            .fold(zero, |sum, &(xi, w)| sum + down(body, xi, w))
    };
    for (bending, torsion, tolerance) in
        [([3, 3], 2, 0.035), ([4, 4], 4, 0.008), ([6, 5], 5, 0.004)]
    {
        let body = beam(DEEP, bending, torsion);
        let stiffness = body.numbers().stiffness;
        let end = down(&body, 1.0, 4.013 * unit(&body));
        let found = critical(&stiffness, &end);
        println!("{bending:?} {torsion}: {found}");
        let range = 1.0 - 0.004..1.0 + tolerance;
        assert!(range.contains(&found), "{bending:?} {torsion}: {found}");
        // Few functions of bending and twist have no parabolas.
        if bending[0] > 3 {
            let whole = distributed(&body) * (12.85 * unit(&body));
            let found = critical(&stiffness, &whole);
            println!("{bending:?} {torsion}, distributed: {found}");
            let range = 1.0 - 0.004..1.0 + 2.0 * tolerance;
            assert!(range.contains(&found), "{bending:?} {torsion}: {found}");
        }
    }
}

/// Section forces of a bent and twisted beam balance the load at its end to second order: moments about the turned axes of the
/// section; a shear force, the slope of a moment, is less exact. With linear curvatures that about the stiff axis would be wrong by more than its size.
#[test]
fn section_forces_balance_the_load() {
    let body = beam(DEEP, [5, 5], 4);
    let own = body.numbers().stiffness;
    let force = 0.2 * 4.013 * unit(&body);
    let point = body.point(1.0, [0.0; 2]);
    let [_, _, _, torsion, _, _] = body.values().stiffness;
    let load = down(&body, 1.0, force)
        + DVector::from_iterator(
            point.rotation.len(),
            (point.rotation.iter()).map(|turn| turn.x * 0.1 * torsion / LENGTH),
        );
    let q = at_rest(&own, &load);
    let at = |form: &Quadratic<f64>| form.value(q.as_slice());
    for xi in [0.1, 0.5, 0.8] {
        let here = body.point(xi, [0.0; 2]);
        let twist: f64 = (0..q.len()).map(|i| here.rotation[i].x * q[i]).sum();
        let arm = LENGTH * (1.0 - xi);
        let strong = at(&body.section_force(SectionForce::BendingZ, xi));
        let weak = at(&body.section_force(SectionForce::BendingY, xi));
        let shear = at(&body.section_force(SectionForce::ShearY, xi));
        println!(
            "{xi}: {} {} {}",
            strong / (force * arm),
            weak / (force * arm * twist),
            shear / force
        );
        // Relative to the moment at the root.
        assert!(
            (strong - force * arm).abs() < 0.02 * force * LENGTH,
            "{strong}"
        );
        assert!((weak / (force * arm * twist) - 1.0).abs() < 0.1, "{weak}");
        assert!((shear / force - 1.0).abs() < 0.1, "{shear}");
    }
}

/// N adds N I_p/A to GJ (Wagner 1929).
#[test]
fn an_axial_force_changes_the_stiffness_of_torsion() {
    let mut random = Numbers::new(5);
    for bending in [[0, 0], [2, 0], [2, 3]] {
        let body = beam(DEEP, bending, 3);
        let own = body.numbers().stiffness;
        let [ea, _, _, torsion, ei2, ei3] = body.values().stiffness;
        let gyration = (ei2 + ei3) / ea;
        let force = (2.0 + random.next()) * torsion / gyration;
        let point = body.point(1.0, [0.0; 2]);
        let load = DVector::from_iterator(
            point.rotation.len(),
            (point.displacement.iter().zip(&point.rotation))
                .map(|(x, turn)| x.x * force + turn.x * 1e-3 * torsion),
        );
        let q = at_rest(&own, &load);
        let twist: f64 = (0..q.len()).map(|i| point.rotation[i].x * q[i]).sum();
        let exact = 1e-3 * torsion * LENGTH / (torsion + force * gyration);
        assert!(
            (twist / exact - 1.0).abs() < 1e-6,
            "{bending:?}: {twist} {exact}"
        );
    }
}
