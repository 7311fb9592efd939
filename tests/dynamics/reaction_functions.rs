//! Reactions of joints, slides, springs and angular momentum as functions: values that balance the
//! bodies, and exact gradients by every method.

use super::gradients_match_complex_step::{compare, explicit, implicit};
use crate::reference;

use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::functions::instant::DeformationKind;
use flexbody_mechanics::functions::samples::sample;
use flexbody_mechanics::functions::stations::Largest;
use flexbody_mechanics::functions::{Bound, Function, Instant, Reduction, Scene};
use flexbody_mechanics::integrate::{Method, Multipliers, Settings, Trajectory, simulate};
use flexbody_mechanics::model::{
    Axes, DegreeOfFreedom, Drive, JointKind, Load, LoadKind, Model, TimeFunction,
};
use flexbody_mechanics::system::Numbering;
use flexbody_mechanics::system::angular_momentum::AngularMomentum;
use flexbody_mechanics::system::loads::measured::{LoadMeasure, LoadPart};
use flexbody_mechanics::system::measures::{End, Wrench, WrenchPart};
use flexbody_mechanics::system::observe::{observe, reactions};
use reference::flexible::{quadratic, swing, swing_of};
use reference::models::{KINDS, Numbers, free_pair};

const WRENCHES: [(End, WrenchPart, Axes); 8] = [
    (End::A, WrenchPart::Force, Axes::Ground),
    (End::A, WrenchPart::Force, Axes::Body),
    (End::A, WrenchPart::Moment, Axes::Ground),
    (End::A, WrenchPart::Moment, Axes::Body),
    (End::B, WrenchPart::Force, Axes::Ground),
    (End::B, WrenchPart::Force, Axes::Body),
    (End::B, WrenchPart::Moment, Axes::Ground),
    (End::B, WrenchPart::Moment, Axes::Body),
];

/// Every reaction of every joint of the file, slide, measure of a spring and the angular momentum, each in
/// one reduction; the reductions take turns, from number `first`.
fn functions(model: &Model<f64>, first: usize, numbers: &mut Numbers) -> Vec<Function<f64>> {
    let mut all = Vec::new();
    for (joint, own) in model.joints.iter().enumerate() {
        if own.modes.is_some() {
            continue;
        }
        // A moment that is always zero has derivatives of round-off.
        let free = matches!(own.kind, JointKind::Spherical | JointKind::Rod);
        let carried = |part: WrenchPart| part == WrenchPart::Force || !free;
        for (on, part, axes) in WRENCHES.into_iter().filter(|own| carried(own.1)) {
            all.push(Instant::Reaction(Wrench {
                joint,
                on,
                part,
                axes,
                direction: numbers.vector(),
            }));
        }
        all.push(Instant::Slide(joint));
    }
    for (load, own) in model.loads.iter().enumerate() {
        let parts: &[LoadPart] = match own.kind {
            LoadKind::Spring { .. } => &[LoadPart::Length, LoadPart::Tension],
            LoadKind::TorsionSpring { .. } => &[LoadPart::Torque],
            _ => &[],
        };
        let spring = |&part| Instant::Load(LoadMeasure { load, part });
        all.extend(parts.iter().map(spring));
    }
    all.push(Instant::AngularMomentum(AngularMomentum {
        direction: numbers.vector(),
        about: numbers.vector(),
    }));
    let rho = 0.03;
    let reductions = [
        Reduction::Final,
        Reduction::Integral,
        Reduction::Ks {
            rho,
            bound: Bound::Below,
        },
        Reduction::Ks {
            rho,
            bound: Bound::Above,
        },
        Reduction::InducedExponential { rho },
    ];
    let reduced =
        |(i, instant)| Function::reduced(instant, reductions[(i + first) % reductions.len()]);
    all.into_iter().enumerate().map(reduced).collect()
}

fn scene(model: &Model<f64>, duration: f64, functions: Vec<Function<f64>>) -> Scene<f64> {
    Scene {
        model: model.clone(),
        duration,
        until: None,
        functions,
        unstarted: None,
    }
}

/// Two bodies with a joint of this kind; the first may be held to ground by another. Springs, and drives
/// where the kind has them.
fn pair(kind: JointKind, seed: u64, driven: bool) -> Model<f64> {
    let mut model = free_pair(kind, seed);
    let mut numbers = Numbers(seed + 100);
    model.gravity = Vec3::new(0.5, -9.0, 1.0);
    let joint = &mut model.joints[0];
    for &dof in kind.degrees_of_freedom().iter().filter(|_| driven) {
        joint.drives.push(Drive {
            dof,
            course: match dof {
                DegreeOfFreedom::Rotation => TimeFunction::Polynomial(vec![0.0, 0.7, -1.3, 0.4]),
                DegreeOfFreedom::Translation => TimeFunction::Polynomial(vec![0.0, -0.4, 0.9]),
            },
        });
    }
    if kind
        .degrees_of_freedom()
        .contains(&DegreeOfFreedom::Rotation)
        && !driven
    {
        model.loads.push(Load {
            name: "coil".into(),
            kind: LoadKind::TorsionSpring {
                joint: 0,
                counter: None,
                rest_angle: 0.4,
                stiffness: 3.0,
                cubic: 0.8,
                damping: 0.2,
                tables: [None, None],
            },
        });
    }
    model.loads.push(Load {
        name: "spring".into(),
        kind: LoadKind::Spring {
            body_a: 0,
            body_b: Some(1),
            point_a: numbers.vector() * 0.4,
            point_b: numbers.vector() * 0.4 + Vec3::new(1.5, 0.0, 0.0),
            rest_length: 0.8,
            stiffness: 20.0,
            cubic: 3.0,
            damping: 0.4,
            tables: [None, None],
        },
    });
    model
}

fn directions(scene: &Scene<f64>, settings: &Settings, numbers: &mut Numbers) {
    let parameters = scene.parameters();
    let mut direction = || -> Vec<f64> {
        let all = parameters.iter();
        all.map(|p| numbers.next() * p.abs().max(0.1)).collect()
    };
    compare(scene, settings, &[direction(), direction()]);
}

/// Every kind of joint, driven or not, by the explicit and an implicit method.
#[test]
fn gradients_of_every_kind_of_joint() {
    for (i, kind) in KINDS.into_iter().enumerate() {
        for driven in [false, true] {
            if driven && kind.degrees_of_freedom().is_empty() {
                continue;
            }
            let model = pair(kind, 40 + i as u64, driven);
            let mut numbers = Numbers(i as u64);
            let all = functions(&model, i + usize::from(driven), &mut numbers);
            let scene = scene(&model, 0.3, all);
            let settings = explicit(&model, 0.3, 6);
            directions(&scene, &settings[i % 4], &mut numbers);
            let settings = implicit(&model, 0.3, 12);
            directions(
                &scene,
                &settings[(2 * i + 1) % settings.len()],
                &mut numbers,
            );
        }
    }
}

/// All methods and grids, in a model with a tree of joints.
#[test]
fn gradients_by_every_method() {
    let (model, _) = reference::load("triple_pendulum");
    let mut numbers = Numbers(3);
    let all = functions(&model, 0, &mut numbers);
    let scene = scene(&model, 0.3, all);
    let settings = [explicit(&model, 0.3, 8), implicit(&model, 0.3, 20)].concat();
    for settings in settings {
        directions(&scene, &settings, &mut numbers);
    }
}

/// Functions of a flexible scene, with the largest of several forms in the coordinates.
fn flexible(model: &Model<f64>, first: usize) -> Vec<Function<f64>> {
    let mut numbers = Numbers(9 + first as u64);
    let mut all = functions(model, first, &mut numbers);
    for (kind, bound, reduction) in [
        (DeformationKind::Stress, Bound::Below, Reduction::Final),
        (
            DeformationKind::Moment,
            Bound::Above,
            Reduction::Ks {
                rho: 2.0,
                bound: Bound::Above,
            },
        ),
    ] {
        let modes = model.flexible[0].modes();
        let largest = Largest {
            forms: (0..3).map(|_| quadratic(&mut numbers, modes)).collect(),
            signs: vec![1.0, -1.0, 1.0],
            rho: 2.0,
            bound,
        };
        let instant = Instant::LargestDeformation {
            flexible: 0,
            unknowns: None,
            kind,
            largest,
        };
        all.push(Function::reduced(instant, reduction));
    }
    all
}

#[test]
fn gradients_with_a_flexible_body_by_every_method() {
    let model = swing(23);
    let mut numbers = Numbers(5);
    let settings = [explicit(&model, 0.2, 12), implicit(&model, 0.2, 20)].concat();
    for (i, settings) in settings.iter().enumerate() {
        let scene = scene(&model, 0.2, flexible(&model, i));
        directions(&scene, settings, &mut numbers);
    }
}

/// Every single parameter: masses, shapes, stiffness, strains, attachments, springs, directions.
#[test]
fn gradients_in_every_parameter() {
    let model = swing_of(22, 2, 60.0);
    let scene = scene(&model, 0.1, flexible(&model, 2));
    let count = scene.parameters().len();
    let unit = |i: usize| (0..count).map(|j| f64::from(u8::from(i == j))).collect();
    let units: Vec<Vec<f64>> = (0..count).map(unit).collect();
    compare(&scene, &Settings::steps(Method::Dop853, 3), &units);
    compare(
        &scene,
        &Settings::steps(Method::Radau { stages: 2 }, 4),
        &units,
    );
}

fn wrench(joint: usize, (on, part, axes): (End, WrenchPart, Axes), k: usize) -> Instant<f64> {
    let mut direction = Vec3::zeros();
    direction[k] = 1.0;
    Instant::Reaction(Wrench {
        joint,
        on,
        part,
        axes,
        direction,
    })
}

/// A vector function at all instants of a run.
fn vectors(
    model: &Model<f64>,
    run: &Trajectory<f64>,
    component: impl Fn(usize) -> Instant<f64>,
) -> Vec<Vec3<f64>> {
    let all: Vec<Vec<f64>> = (0..3).map(|k| sample(&component(k), model, run)).collect();
    let at = |i: usize| Vec3::new(all[0][i], all[1][i], all[2][i]);
    (0..=run.last()).map(at).collect()
}

fn near(what: &str, found: &Vec3<f64>, expected: &Vec3<f64>) {
    let off = (found - expected).norm();
    let size = expected.norm().max(1.0);
    assert!(off <= 1e-9 * size, "{what}: {found:?} against {expected:?}");
}

/// The forces and moments on both bodies of a joint give them their momentum, for every kind of joint,
/// driven or not: F + m g = m a, M + (P − r) × F = R (J α + ω × J ω), where a drive moves no point on its body. They are those of
/// the tables.
#[test]
fn reactions_balance_both_bodies() {
    for (i, kind) in KINDS.into_iter().enumerate() {
        for driven in [false, true] {
            let mut model = pair(kind, 60 + i as u64, driven);
            model.loads.clear();
            let settings = Settings::steps(Method::Dop853, 12);
            let run = simulate(&model, 0.4, &settings).expect("runs");
            let numbering = Numbering::new(&model);
            let mut multipliers = Multipliers::new(&model, &numbering, &run);
            let [on_a, on_b] = [End::A, End::B].map(|on| {
                [WrenchPart::Force, WrenchPart::Moment]
                    .map(|part| vectors(&model, &run, |k| wrench(0, (on, part, Axes::Ground), k)))
            });
            let turned = vectors(&model, &run, |k| {
                wrench(0, (End::A, WrenchPart::Moment, Axes::Body), k)
            });
            for k in 0..=run.last() {
                let lambda = multipliers.at(k);
                let told = reactions(&model, &numbering, (run.q(k), &lambda), run.time(k));
                near("force", &on_a[0][k], &told[0].force_ground);
                near("moment", &on_a[1][k], &told[0].torque_ground);
                near("opposite force", &on_b[0][k], &-on_a[0][k]);
                let joint = &model.joints[0];
                let mut points = Vec::new();
                for (body, [force, moment], frame) in
                    [(0, &on_a, &joint.frame_a), (1, &on_b, &joint.frame_b)]
                {
                    let (q, v, a) = (&run.q(k)[7 * body..], &run.v(k)[6 * body..], {
                        &run.a(k)[6 * body..]
                    });
                    let three = |x: &[f64]| Vec3::new(x[0], x[1], x[2]);
                    let r = rotation::matrix(&[q[3], q[4], q[5], q[6]]);
                    let own = &model.bodies[body];
                    let (omega, alpha) = (three(&v[3..]), three(&a[3..]));
                    let spin = own.inertia * alpha + omega.cross(&(own.inertia * omega));
                    let arm = r * frame.point;
                    let weight = model.gravity * own.mass;
                    near("momentum", &(force[k] + weight), &(three(a) * own.mass));
                    let total = moment[k] + arm.cross(&force[k]);
                    near("spin", &total, &(r * spin));
                    if body == 0 {
                        near("body axes", &turned[k], &Mat3::tr_mul(&r, &moment[k]));
                    }
                    points.push(three(q) + arm);
                }
                // Both moments and forces about one point cancel.
                let moved = (points[0] - points[1]).cross(&on_a[0][k]);
                near("opposite moment", &on_b[1][k], &-(on_a[1][k] + moved));
            }
        }
    }
}

/// The angular momentum is that of the tables, and about another point it differs by the momentum's moment.
#[test]
fn angular_momentum_is_that_of_the_tables() {
    for model in [swing(31), pair(JointKind::Universal, 7, false)] {
        let run = simulate(&model, 0.2, &Settings::steps(Method::Dop853, 20)).expect("runs");
        let numbering = Numbering::new(&model);
        let about = Vec3::new(0.3, -2.0, 1.1);
        let of = |about: Vec3<f64>| {
            vectors(&model, &run, |k| {
                let mut direction = Vec3::zeros();
                direction[k] = 1.0;
                Instant::AngularMomentum(AngularMomentum { direction, about })
            })
        };
        let (origin, other) = (of(Vec3::zeros()), of(about));
        for k in 0..=run.last() {
            let seen = observe(&model, &numbering, (run.q(k), run.v(k)), run.time(k));
            near("origin", &origin[k], &seen.angular_momentum);
            let moved = seen.angular_momentum - about.cross(&seen.momentum);
            near("about a point", &other[k], &moved);
        }
    }
}

/// With one ρ over sections and time a soft maximum is that of all values together.
#[test]
fn sections_and_time_are_one_maximum() {
    let model = swing(31);
    let run = simulate(&model, 0.2, &Settings::steps(Method::Dop853, 20)).expect("runs");
    let mut numbers = Numbers(4);
    let modes = model.flexible[0].modes();
    let forms: Vec<_> = (0..4).map(|_| quadratic(&mut numbers, modes)).collect();
    let rho = 6.0;
    let one = |forms: &[_]| Instant::LargestDeformation {
        flexible: 0,
        unknowns: None,
        kind: DeformationKind::Stress,
        largest: Largest {
            signs: vec![1.0; forms.len()],
            forms: forms.to_vec(),
            rho,
            bound: Bound::Below,
        },
    };
    let reduction = Reduction::Ks {
        rho,
        bound: Bound::Below,
    };
    let instant = one(&forms);
    let found = Function::reduced(instant, reduction).evaluate(&model, &run);
    let mut sum = 0.0;
    let mut most = f64::NEG_INFINITY;
    for form in &forms {
        let values = sample(&one(std::slice::from_ref(form)), &model, &run);
        for (k, value) in values.into_iter().enumerate() {
            sum += run.quadrature_weight(k) * (rho * value).exp() / forms.len() as f64;
            most = most.max(value);
        }
    }
    let expected = sum.ln() / rho;
    assert!((found.value - expected).abs() < 1e-12, "{}", found.value);
    assert!(found.value <= most && found.value > most - 2.0);
}
