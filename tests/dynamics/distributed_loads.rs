//! Pressures and dead loads on bodies of elements: resultants in closed form, and every derivative by the complex step.

use crate::reference;

use flexbody_mathematics::math::{Complex64, Parameters, Scalar, Vec3};
use flexbody_mechanics::integrate::{Method, Settings, simulate};
use flexbody_mechanics::model::{
    Air, Axes, DistributedLoad, Form, Load, LoadKind, Model, Spread, TimeFunction,
};
use flexbody_mechanics::structures::loads::edge_shares;
use flexbody_mechanics::structures::shell::ShellKind;
use flexbody_mechanics::system::loads::{self, LoadCotangent};
use flexbody_mechanics::system::{InMotion, Numbering, bodies, placement};
use reference::cases::{Case, TIME, dot, lift, parameters, slopes, unit};
use reference::models::{Numbers, alone};
use reference::shells::{
    Shells, aluminium_plate, four_node_swing, press, reduced_swing, shell_swing, shells_of,
    stiffened_swing,
};

fn case(name: &str, mut model: Model<f64>) -> Case {
    press(&mut model);
    let (q, v) = placement::guess(&model);
    Case {
        name: name.into(),
        numbering: Numbering::new(&model),
        model,
        q,
        v,
        numbers: Numbers(5),
    }
}

fn forces<S: Scalar>(case: &Case, model: &Model<S>, q: &[S], time: S) -> Vec<S> {
    let v: Vec<S> = case.v.iter().map(|&v| S::from(v)).collect();
    moving_forces(case, model, [q, &v], time)
}

fn moving_forces<S: Scalar>(case: &Case, model: &Model<S>, [q, v]: [&[S]; 2], time: S) -> Vec<S> {
    let motions = case.motions(q, v);
    let mut out = vec![S::zero(); case.v.len()];
    let here = InMotion::new(model, &case.numbering, &motions, time);
    loads::add_forces(&here, &mut out);
    out
}

/// ψᵀf by positions, time and every parameter, of shells by all nodes, in a basis, with beams, and rigid.
#[test]
fn pull_backs() {
    for mut case in [
        case("full", shell_swing(3, [2, 1])),
        case("reduced", reduced_swing(4, [2, 1], 3)),
        case("stiffened", stiffened_swing(5, [1, 1], None)),
        case("four nodes", four_node_swing(7, [2, 1], None)),
        case("rigid", reduced_swing(6, [1, 1], 0)),
    ] {
        let nv = case.v.len();
        let psi = case.numbers.list(nv);
        let (mut y, mut v, mut by_time) = (vec![0.0; nv], vec![0.0; nv], 0.0);
        let mut cot = case.model.map(&mut |_| 0.0);
        let mut out = LoadCotangent {
            y: Some(&mut y),
            v: Some(&mut v),
            time: &mut by_time,
            model: &mut cot,
        };
        let motions = case.motions(&case.q, &case.v);
        let here = InMotion::new(&case.model, &case.numbering, &motions, TIME);
        loads::pull_back(&here, &psi, &mut out);
        let (model, q, time) = (case.lifted(), lift(&case.q), Complex64::from(TIME));
        let power = |model: &Model<Complex64>, q: &[Complex64], time| {
            dot(&slopes(&forces(&case, model, q, time)), &psi)
        };
        let numbering = &case.numbering;
        let places = (0..numbering.bodies()).flat_map(|body| {
            let mobility = numbering.mobility(body);
            let turns = if mobility.has_rotation() { 3 } else { 0 };
            let own = (0..mobility.translation.free()).chain(3..3 + turns);
            own.map(move |k| numbering.velocity(body) + k)
        });
        let places: Vec<usize> = places.collect();
        let given: Vec<f64> = places.iter().map(|&i| y[i]).collect();
        let exact = places.iter();
        let exact: Vec<f64> = exact
            .map(|&j| power(&model, &case.moved(&unit(nv, j)), time))
            .collect();
        case.assert("by positions", &given, &exact);
        let exact = places.iter().map(|&j| {
            let mut v = lift(&case.v);
            v[j] += Complex64::new(0.0, flexbody_mathematics::math::scalar::COMPLEX_STEP);
            dot(&slopes(&moving_forces(&case, &model, [&q, &v], time)), &psi)
        });
        let given: Vec<f64> = places.iter().map(|&i| v[i]).collect();
        assert!(given.iter().any(|x| x.abs() > 1e-3), "the air slows it");
        case.assert("by velocities", &given, &exact.collect::<Vec<f64>>());
        let later = Complex64::new(TIME, flexbody_mathematics::math::scalar::COMPLEX_STEP);
        case.assert("by time", &[by_time], &[power(&model, &q, later)]);
        let exact = case.by_parameters(|model| power(model, &q, time));
        case.assert("by parameters", &parameters(&cot), &exact);
    }
}

/// A free panel with a deformation of any form and this size, and these loads.
fn loaded(
    size: f64,
    loads: &dyn Fn(&Shells) -> Vec<DistributedLoad<f64>>,
) -> (Case, Shells, Vec<f64>) {
    loaded_of(ShellKind::Mitc9, size, loads)
}

/// The same of shells of this kind.
fn loaded_of(
    kind: ShellKind,
    size: f64,
    loads: &dyn Fn(&Shells) -> Vec<DistributedLoad<f64>>,
) -> (Case, Shells, Vec<f64>) {
    let mut numbers = Numbers(8);
    let own = shells_of(kind, &mut numbers, [3, 2], false);
    let mut frame = numbers.body("panel");
    (frame.mass, frame.inertia) = own.elements.rigid();
    let mut model = alone(frame);
    let deformed: Vec<f64> = numbers.list(own.elements.mesh.coordinates);
    let deformed: Vec<f64> = deformed.iter().map(|x| size * x).collect();
    let still = vec![0.0; deformed.len()];
    model.add_flexible(0, (&deformed, &still), Form::Finite(own.elements.clone()));
    for load in loads(&own) {
        model.loads.push(Load {
            name: "load".into(),
            kind: LoadKind::Distributed(load),
        });
    }
    let (q, v) = placement::guess(&model);
    let case = Case {
        name: "panel".into(),
        numbering: Numbering::new(&model),
        model,
        q,
        v,
        numbers,
    };
    (case, own, deformed)
}

/// Where the nodes of the deformed panel are, in the axes of its frame.
fn places(own: &Shells, q: &[f64]) -> Vec<Vec3<f64>> {
    let mesh = &own.elements.mesh;
    let all = mesh.nodes.iter().zip(&mesh.displacements);
    all.map(|(x, at)| x + Vec3::from_fn(|k, _| at[k].map_or(0.0, |i| q[i])))
        .collect()
}

fn pressure(shells: usize, magnitude: f64) -> DistributedLoad<f64> {
    DistributedLoad {
        body: 0,
        spread: Spread::Pressure {
            shells: (0..shells).collect(),
        },
        magnitude: TimeFunction::constant(magnitude),
    }
}

/// The force of a pressure p on a surface is p/2 ∮ x × dx along its border (Stokes), however its inside is deformed. So
/// on a closed surface, which has no border, it vanishes.
#[test]
fn a_pressure_has_the_resultant_of_its_border() {
    border(ShellKind::Mitc9);
    border(ShellKind::Mitc4);
}

fn border(kind: ShellKind) {
    let p = 3.0;
    let all = |own: &Shells| vec![pressure(own.elements.thickness.len(), p)];
    let (case, own, q) = loaded_of(kind, 0.1, &all);
    let x = places(&own, &q);
    let mut exact = Vec3::zeros();
    for (name, sign) in [("y0", 1.0), ("x1", 1.0), ("y1", -1.0), ("x0", -1.0)] {
        for edge in &own.mesh.edge_sets[name] {
            if let [a, b] = edge[..] {
                exact += x[a].cross(&x[b]) * (0.5 * p * sign);
                continue;
            }
            let [a, b, c] = [edge[0], edge[1], edge[2]];
            // ∫ x × x,r dr of a parabola through three points, exact by three points of Gauss.
            let root = 0.6_f64.sqrt();
            for (r, weight) in [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)] {
                let at = x[a] * (0.5 * r * (r - 1.0))
                    + x[b] * (1.0 - r * r)
                    + x[c] * (0.5 * r * (r + 1.0));
                let along = x[a] * (r - 0.5) - x[b] * (2.0 * r) + x[c] * (r + 0.5);
                exact += at.cross(&along) * (0.5 * p * sign * weight);
            }
        }
    }
    let found = forces(&case, &case.model, &case.q, TIME);
    let frame = case.numbering.velocity(0);
    let (force, _) = bodies::velocities_of(&found[frame..]);
    let motions = case.motions(&case.q, &case.v);
    let local = motions[0].rotation.tr_mul(&force);
    assert!(
        exact.norm() > 0.5 && (local - exact).norm() < 1e-13 * exact.norm(),
        "{local} {exact}"
    );
}

/// A flat plate of 1 × 0.25 m with a load.
fn flat(elements: [usize; 2], load: impl FnOnce(usize) -> DistributedLoad<f64>) -> Case {
    let own = aluminium_plate(elements, 0.01);
    let load = load(own.mesh.elements.len());
    let mut frame = Numbers(3).body("plate");
    (frame.mass, frame.inertia) = own.rigid();
    let mut model = alone(frame);
    let still = vec![0.0; own.mesh.coordinates];
    model.add_flexible(0, (&still, &still), Form::Finite(own));
    model.loads.push(Load {
        name: "load".into(),
        kind: LoadKind::Distributed(load),
    });
    let (q, v) = placement::guess(&model);
    Case {
        name: "plate".into(),
        numbering: Numbering::new(&model),
        model,
        q,
        v,
        numbers: Numbers(1),
    }
}

/// On a flat plate of area A a pressure p has the force p A n and the moment of that at its middle, turned as the plate.
#[test]
fn a_pressure_on_a_flat_plate_is_its_area() {
    let case = flat([3, 2], |shells| pressure(shells, 40.0));
    let found = forces(&case, &case.model, &case.q, TIME);
    let (force, torque) = bodies::velocities_of(&found[case.numbering.velocity(0)..]);
    let local = case.motions(&case.q, &case.v)[0].rotation.tr_mul(&force);
    let exact = Vec3::new(0.0, 0.0, 40.0 * 0.25);
    assert!((local - exact).norm() < 1e-13 * exact.norm(), "{local}");
    let exact = Vec3::new(0.5, 0.125, 0.0).cross(&exact);
    assert!((torque - exact).norm() < 1e-13 * exact.norm(), "{torque}");
}

/// A flat plate of area A that moves at the angle α to its plane has the force −u² A (c u/|u| + c_n sin α n): at the middle, and a
/// plate that turns about its middle line is slowed by ∫ (c + c_n) |ω x|³ over it.
#[test]
fn the_air_on_a_flat_plate() {
    let (c, c_n, area) = (0.3, 1.7, 0.25);
    let case = flat([6, 4], |shells| DistributedLoad {
        body: 0,
        spread: Spread::Air {
            shells: (0..shells).collect(),
            air: Air {
                coefficient: c,
                normal_coefficient: c_n,
                width: 1e-6,
            },
        },
        magnitude: TimeFunction::constant(1.0),
    });
    let start = case.numbering.velocity(0);
    let turn = case.motions(&case.q, &case.v)[0].rotation;
    let found = |case: &Case, linear: Vec3<f64>, omega: Vec3<f64>| {
        let mut v = vec![0.0; case.v.len()];
        for k in 0..3 {
            (v[start + k], v[start + 3 + k]) = (linear[k], omega[k]);
        }
        let found = moving_forces(case, &case.model, [&case.q, &v], TIME);
        bodies::velocities_of(&found[start..])
    };
    for angle in [0.0_f64, 0.3, 1.2, std::f64::consts::FRAC_PI_2] {
        let along = Vec3::new(angle.cos(), 0.0, angle.sin());
        let (force, torque) = found(&case, turn * along * 3.0, Vec3::zeros());
        let exact = -(along * c + Vec3::z() * (c_n * angle.sin())) * (9.0 * area);
        let local = turn.tr_mul(&force);
        assert!(
            (local - exact).norm() < 1e-11 * exact.norm(),
            "{angle} {local} {exact}"
        );
        let moment = Vec3::new(0.5, 0.125, 0.0).cross(&exact);
        assert!(
            (torque - moment).norm() < 1e-11 * moment.norm(),
            "{angle} {torque}"
        );
    }
    // About the line x = 0 through the edge: u = ω x, over 1 × 0.25 m: the torque ∫ (c + c_n) ω² x³ dA.
    let (_, torque) = found(&case, Vec3::zeros(), Vec3::new(0.0, 2.0, 0.0));
    let exact = (c + c_n) * 4.0 * area / 4.0;
    assert!((torque.y + exact).abs() < 1e-4 * exact, "{torque} {exact}");
}

/// A dead load along an edge has the force m L n, in ground axes or those of the body, whatever the deformation.
#[test]
fn a_dead_load_has_the_resultant_of_its_length() {
    for axes in [Axes::Ground, Axes::Body] {
        let n = Vec3::new(0.3, -0.5, 0.8);
        let (case, own, _) = loaded(0.1, &|own| {
            let shares = edge_shares(&own.elements.mesh.nodes, &own.mesh.edge_sets["x1"]);
            vec![DistributedLoad {
                body: 0,
                spread: Spread::Dead {
                    shares: shares.into_iter().collect(),
                    direction: n,
                    axes,
                },
                magnitude: TimeFunction::constant(2.0),
            }]
        });
        let x = &own.elements.mesh.nodes;
        let length: f64 = (own.mesh.edge_sets["x1"].iter())
            .map(|edge| {
                let [a, b, c] = [edge[0], edge[1], edge[2]];
                // Simpson's rule for the length of arcs, of many pieces.
                let speed =
                    |r: f64| (x[a] * (r - 0.5) - x[b] * (2.0 * r) + x[c] * (r + 0.5)).norm();
                let step = 2.0 / 200.0;
                let at = |k: usize| -1.0 + step * k as f64;
                let inner = (1..200).map(|k| speed(at(k)) * if k % 2 == 1 { 4.0 } else { 2.0 });
                step / 3.0 * (speed(-1.0) + speed(1.0) + inner.sum::<f64>())
            })
            .sum();
        let found = forces(&case, &case.model, &case.q, TIME);
        let (force, _) = bodies::velocities_of(&found[case.numbering.velocity(0)..]);
        let turn = case.motions(&case.q, &case.v)[0].rotation;
        let exact = match axes {
            Axes::Ground => n,
            Axes::Body => turn * n,
        } * (2.0 * length);
        // Three points of Gauss for an arc that is nearly straight.
        assert!(
            (force - exact).norm() < 1e-6 * exact.norm(),
            "{force} {exact}"
        );
    }
}

/// A free panel under a pressure gains the momentum of the force that acts on it: ∫ F dt, by the motion of its frame and
/// its nodes.
#[test]
fn a_pressure_gives_its_momentum() {
    let (mut case, _, _) = loaded(0.01, &|own| {
        vec![pressure(own.elements.thickness.len(), 0.5)]
    });
    case.model.gravity = Vec3::zeros();
    let gain = |steps: usize| {
        let method = Method::Radau { stages: 3 };
        let run = simulate(&case.model, 0.2, &Settings::steps(method, steps)).expect("runs");
        let motions = |k: usize| {
            let mut all = Vec::new();
            bodies::BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut all);
            all
        };
        let momentum = |k: usize| reference::flexible::totals(&case.model, &motions(k)).2;
        let force = |k: usize| {
            let all = motions(k);
            let mut out = vec![0.0; case.v.len()];
            let here = InMotion::new(&case.model, &run.numbering, &all, run.time(k));
            loads::add_forces(&here, &mut out);
            bodies::velocities_of(&out[run.numbering.velocity(0)..]).0
        };
        // Simpson's rule over the steps.
        let h = 0.2 / steps as f64;
        let inner = (1..steps).map(|k| force(k) * if k % 2 == 1 { 4.0 } else { 2.0 });
        let impulse = inner.fold(force(0) + force(steps), |sum, f| sum + f) * (h / 3.0);
        (momentum(steps) - momentum(0), impulse)
    };
    let off = |steps: usize| {
        let (gained, given) = gain(steps);
        (gained - given).norm() / given.norm()
    };
    let (coarse, fine) = (off(40), off(80));
    assert!(fine < 1e-4 && coarse / fine > 8.0, "{coarse:e} {fine:e}");
}
