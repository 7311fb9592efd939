//! Parts of a scene on which no requested function depends.
//!
//! Bodies form parts through joints and springs; ground does not connect them. A part does not
//! affect the motion of the others. Without the parts that neither a requested function nor the
//! event observes, the functions are the same. Adaptive steps follow the error of the remaining
//! parts, so there the functions change by their discretisation error.

use super::welded::Groups;
use crate::functions::function::Part;
use crate::functions::{Function, Instant, Scene};
use crate::integrate::Trajectory;
use crate::math::Scalar;
use crate::model::{Joint, LoadKind, Model};
use crate::system::{Numbering, placement};

/// The parts of a scene that are kept: ascending indices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Bodies.
    pub bodies: Vec<usize>,
    /// Requested functions.
    pub functions: Vec<usize>,
}

impl Seen {
    /// The parts on which the functions `asked` and the event of `scene` depend.
    pub fn find<S: Scalar>(scene: &Scene<S>, asked: &[usize]) -> Self {
        let model = &scene.model;
        let mut parts = Groups::new(model.bodies.len());
        let loads = model
            .loads
            .iter()
            .map(|load| load.kind.bodies(&model.joints));
        let joints = model.joints.iter().map(|own| of_joint(own));
        for all in joints.chain(loads) {
            for pair in all.windows(2) {
                parts.join(pair[0], pair[1]);
            }
        }
        for load in &model.loads {
            if let (Some(joint), Some(counter)) = (load.kind.joint(), load.kind.counter()) {
                parts.join(model.joints[joint].body_a, counter);
            }
        }
        let mut functions = asked.to_vec();
        functions.sort_unstable();
        functions.dedup();
        let mut seen = vec![false; model.bodies.len()];
        let event = scene.until.iter().map(|until| &until.measure);
        for function in functions.iter().map(|&f| &scene.functions[f]).chain(event) {
            let of_all = |instant: &&Instant<S>| {
                matches!(
                    instant,
                    Instant::Energy(_)
                        | Instant::Momentum { .. }
                        | Instant::AngularMomentum(_)
                        | Instant::Vibration(_)
                )
            };
            if function.instants().iter().any(of_all) {
                seen.fill(true);
            }
            let mut function = function.clone();
            function.for_each_place(&mut |body, _| seen[*body] = true);
            let observed = function.parts().into_iter().flat_map(|part| match part {
                Part::Joint(&mut joint) => of_joint(&model.joints[joint]),
                Part::Load(&mut load) => model.loads[load].kind.bodies(&model.joints),
            });
            for body in observed {
                seen[body] = true;
            }
        }
        // The duration depends on no body, but a scene needs one. No joint joins carriers; couplings, controllers and cables
        // join several.
        if !seen.contains(&true) || model.is_entangled() {
            seen.fill(true);
        }
        let all = 0..model.bodies.len();
        let looked_at: Vec<usize> = (all.clone().filter(|&body| seen[body]))
            .map(|body| parts.of(body))
            .collect();
        Self {
            bodies: all
                .filter(|&body| looked_at.contains(&parts.of(body)))
                .collect(),
            functions,
        }
    }

    /// All of `bodies` bodies, with the requested functions.
    pub fn all_bodies(&self, bodies: usize) -> Self {
        Self {
            bodies: (0..bodies).collect(),
            functions: self.functions.clone(),
        }
    }

    /// Whether all bodies of a model are kept.
    pub fn keeps_all<S>(&self, model: &Model<S>) -> bool {
        self.bodies.len() == model.bodies.len()
    }

    /// Whether a body is kept.
    pub fn keeps(&self, body: usize) -> bool {
        self.bodies.binary_search(&body).is_ok()
    }

    /// Removes the other parts from `scene` and renumbers the bodies.
    pub fn apply<S: Scalar>(&self, scene: &mut Scene<S>) {
        let mut functions = std::mem::take(&mut scene.functions).into_iter().map(Some);
        let mut functions: Vec<Option<Function<S>>> = functions.by_ref().collect();
        let kept = self.functions.iter().map(|&f| functions[f].take());
        scene.functions = kept.flatten().collect();
        if self.keeps_all(&scene.model) {
            return;
        }
        let mut number = vec![None; scene.model.bodies.len()];
        for (new, &old) in self.bodies.iter().enumerate() {
            number[old] = Some(new);
        }
        let event = scene.until.as_mut().map(|until| &mut until.measure);
        for function in scene.functions.iter_mut().chain(event) {
            function.for_each_place(&mut |body, _| {
                *body = number[*body].expect("a body that a function observes is kept");
            });
        }
        let [joints, loads] = leave_out(&mut scene.model, &number);
        let event = scene.until.as_mut().map(|until| &mut until.measure);
        for function in scene.functions.iter_mut().chain(event) {
            for part in function.parts() {
                let (own, new) = match part {
                    Part::Joint(joint) => (joint, &joints),
                    Part::Load(load) => (load, &loads),
                };
                *own = new[*own].expect("a part that a function observes is kept");
            }
        }
    }

    /// The motion of all bodies of `written`; those that were removed are at rest.
    pub fn at_rest(&self, written: &Model<f64>, run: &Trajectory<f64>) -> Trajectory<f64> {
        let numbering = Numbering::new(written);
        let (placed, _) = placement::guess(written);
        let (mut q, mut v, mut a) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..=run.last() {
            let (at_q, at_v) = (q.len(), v.len());
            q.extend_from_slice(&placed);
            v.resize(at_v + numbering.velocities(), 0.0);
            a.resize(at_v + numbering.velocities(), 0.0);
            for (new, &old) in self.bodies.iter().enumerate() {
                let from = run.numbering.position(new);
                let to = at_q + numbering.position(old);
                q[to..to + 7].copy_from_slice(&run.q(k)[from..from + 7]);
                let from = run.numbering.velocity(new);
                let to = at_v + numbering.velocity(old);
                v[to..to + 6].copy_from_slice(&run.v(k)[from..from + 6]);
                a[to..to + 6].copy_from_slice(&run.a(k)[from..from + 6]);
            }
        }
        run.with_states(numbering, [q, v, a])
    }
}

/// The bodies of a joint.
fn of_joint<S>(joint: &Joint<S>) -> Vec<usize> {
    std::iter::once(joint.body_a).chain(joint.body_b).collect()
}

/// Removes the bodies without a new number, and their joints and loads. Returns the new numbers of joints
/// and of loads.
fn leave_out<S: Scalar>(model: &mut Model<S>, number: &[Option<usize>]) -> [Vec<Option<usize>>; 2] {
    let kept = |ends: Vec<usize>| ends.into_iter().all(|b| number[b].is_some());
    let loads: Vec<bool> = (model.loads.iter())
        .map(|load| kept(load.kind.bodies(&model.joints)))
        .collect();
    let joints = model.joints.iter();
    let joints: Vec<bool> = joints.map(|joint| kept(of_joint(joint))).collect();
    let joint_number = renumbered(&joints);
    let new = |body: &mut usize| {
        *body = number[*body].expect("what is on a body that is left out is left out");
    };
    let new_joint = |joint: &mut usize| {
        *joint = joint_number[*joint].expect("a load on a joint that is left out is left out");
    };
    let mut stays = loads.iter();
    model.loads.retain(|_| stays.next() == Some(&true));
    for load in &mut model.loads {
        match &mut load.kind {
            LoadKind::Force { body, .. }
            | LoadKind::Torque { body, .. }
            | LoadKind::Drag { body, .. } => new(body),
            LoadKind::Distributed(load) => new(&mut load.body),
            LoadKind::Controller(_) | LoadKind::Cable(_) => {
                unreachable!("a scene with controllers or cables is kept whole")
            }
            LoadKind::Spring { body_a, body_b, .. }
            | LoadKind::DistanceStop { body_a, body_b, .. } => {
                new(body_a);
                body_b.iter_mut().for_each(new);
            }
            LoadKind::Contact(own) => {
                new(&mut own.body_a);
                own.body_b.iter_mut().for_each(new);
            }
            LoadKind::TorsionSpring { joint, counter, .. }
            | LoadKind::JointStop { joint, counter, .. } => {
                new_joint(joint);
                counter.iter_mut().for_each(new);
            }
            LoadKind::Damping { joint, .. }
            | LoadKind::BallDamping { joint, .. }
            | LoadKind::Bushing { joint, .. }
            | LoadKind::Friction { joint, .. } => new_joint(joint),
        }
    }
    let mut stays = joint_number.iter();
    model
        .joints
        .retain(|_| stays.next().is_some_and(Option::is_some));
    for joint in &mut model.joints {
        new(&mut joint.body_a);
        joint.body_b.iter_mut().for_each(new);
    }
    let mut stays = number.iter();
    model
        .bodies
        .retain(|_| stays.next().is_some_and(Option::is_some));
    [joint_number, renumbered(&loads)]
}

/// The new numbers of those that stay.
fn renumbered(stays: &[bool]) -> Vec<Option<usize>> {
    let mut next = 0;
    let number = |&stays: &bool| {
        let own = stays.then_some(next);
        next += usize::from(stays);
        own
    };
    stays.iter().map(number).collect()
}
