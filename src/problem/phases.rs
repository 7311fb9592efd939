//! A phase of a motion that events divide: the machine between two events, with what is on then.
//!
//! A phase begins with the state in which the one before it ends. This state follows the design variables in the arguments of
//! its scene:
//!
//! ```text
//! for each body          position, orientation, velocity, angular velocity                 13 numbers
//! for each joint that    the point and the turn R of its frame on body B, and the length   13 numbers
//!   closed before        of a rod
//! for each angle         the angle at which counting goes on                                1 number
//! time                   of the begin of the phase                                          1 number
//! ```
//!
//! The axes b_k of a frame on body B are R a_k, of the a_k on body A: R = Σ b_k a_kᵀ is the same if a reduction to a plane has
//! turned both frames. Phases have no other one that changes frames.
//!
//! The consistent start of the scene then gives the jump of the velocities by the joints that close:
//! M (v⁺ − v⁻) + Gᵀ σ = 0, G v⁺ + Φ_t = 0 (`system/initial.rs`). Without joints that close v⁺ = v⁻.

use super::Problem;
use crate::adjoint::WeightedEnd;
use crate::functions::turning::{Rotation, turns};
use crate::functions::{Function, Scene};
use crate::integrate::Trajectory;
use crate::math::{Mat3, Parameters, Scalar, Vec3};
use crate::model::{JointFrame, JointKind, Model};
use crate::schema::Document;
use crate::system::redundancy;

/// Numbers of a body and of a joint in a state.
const OF_BODY: usize = 13;
const OF_FRAME: usize = 13;

/// Cotangents of the end of a phase, from those of the state with which the next one begins.
pub struct EndCotangent {
    /// Of the last state of the motion.
    pub end: WeightedEnd,
    /// Of the frames of joints on their bodies A and B, by the number of the joint.
    pub frames: Vec<(usize, [JointFrame<f64>; 2])>,
    /// Of the duration, and of the time of the begin.
    pub duration: f64,
}

/// Opens the joints that are open at the start, before bodies are placed by their joints. Loads go off where the start depends
/// on them: in the first phase.
pub(super) fn open_at_start<S: Scalar>(document: &Document, model: &mut Model<S>) {
    for (j, name) in document.joints.keys().enumerate() {
        if !document.is_on(name, 0) {
            match document.phase {
                Some(0) => model.open(j),
                _ => model.joints[j].kind = JointKind::Free,
            }
        }
    }
    if document.phase == Some(0) {
        switch_off_loads(document, 0, model);
    }
}

fn switch_off_loads<S: Scalar>(document: &Document, phase: usize, model: &mut Model<S>) {
    for (load, name) in model.loads.iter_mut().zip(document.loads.keys()) {
        if !document.is_on(name, phase) {
            load.kind.switch_off();
        }
    }
}

/// Makes a scene that of its phase, which begins with `state`; without a state with the bodies as they are placed.
pub(super) fn begin<S: Scalar>(document: &Document, scene: &mut Scene<S>, state: &[S]) {
    let Some(phase) = document.phase.filter(|_| !document.events.is_empty()) else {
        return;
    };
    let model = &mut scene.model;
    let mut numbers = state.iter().copied();
    let mut next = || numbers.next().unwrap_or_else(S::zero);
    if !state.is_empty() {
        for body in &mut model.bodies {
            body.position = Vec3::from_fn(|_, _| next());
            body.orientation = std::array::from_fn(|_| next());
            body.velocity = Vec3::from_fn(|_, _| next());
            body.angular_velocity = Vec3::from_fn(|_, _| next());
        }
    }
    for (j, (name, written)) in document.joints.iter().enumerate() {
        match (document.is_on(name, phase), document.on_since(name, phase)) {
            (false, _) => model.open(j),
            (true, None) => {}
            (true, Some(since)) => {
                let own = &mut model.joints[j];
                own.kind = written.kind();
                if since == phase || state.is_empty() {
                    model.close(j);
                } else {
                    own.frame_b.point = Vec3::from_fn(|_, _| next());
                    let turn = Mat3::from_columns(&[(); 3].map(|()| Vec3::from_fn(|_, _| next())));
                    own.frame_b.axes = own.frame_a.axes.map(|axis| turn * axis);
                    own.frame_a.length = next();
                }
            }
        }
    }
    switch_off_loads(document, phase, model);
    if state.is_empty() {
        resume_drives(document, phase, model);
        return;
    }
    let of_functions = scene.functions.iter_mut();
    for own in of_functions.flat_map(Function::rotations_mut) {
        own.first = Some(next().re());
    }
    // The quantity of an event is that of a function of all phases.
    if let Some(place) = event_quantity(document)
        && let Some(until) = &mut scene.until
    {
        let known: Vec<Option<f64>> = scene.functions[place]
            .rotations_mut()
            .map(|own| own.first)
            .collect();
        for (own, known) in until.measure.rotations_mut().zip(known) {
            own.first = known;
        }
    }
    let measured = scene.until.iter_mut().map(|own| &mut own.measure);
    for own in measured
        .chain(&mut scene.functions)
        .flat_map(Function::rotations_mut)
    {
        count_from_closing(document, &scene.model, own);
    }
    let time = next();
    scene.model.begin_at(time);
    resume_drives(document, phase, &mut scene.model);
    scene.duration -= time;
}

/// Lets drives that came on at an event, they or their joints, go on from where their joints are.
fn resume_drives<S: Scalar>(document: &Document, phase: usize, model: &mut Model<S>) {
    for (name, drive) in &document.drives {
        let came = |own: &str| document.on_since(own, phase).is_some();
        if (came(name) || came(&drive.joint))
            && let Some(joint) = document.joints.get_index_of(&drive.joint)
        {
            model.resume_drives(joint);
        }
    }
}

/// Lets the angle of a joint that an event has closed count from there, as those of its loads.
fn count_from_closing<S: Scalar>(document: &Document, model: &Model<S>, angle: &mut Rotation<S>) {
    let closed = angle.joint.and_then(|j| {
        let (name, _) = document.joints.get_index(j)?;
        Some((j, document.on_since(name, document.phase?)?))
    });
    if let Some((j, since)) = closed {
        let own = &model.joints[j];
        angle.count_from([&own.frame_a.axes, &own.frame_b.axes]);
        if document.phase == Some(since) {
            angle.first = Some(0.0);
        }
    }
}

/// Leaves out the rows that are redundant in the position with which a phase begins, if joints have closed: in another
/// position others are.
pub(super) fn leave_out<S: Scalar>(document: &Document, model: &mut Model<S>, state: &[S]) {
    let Some(phase) = document.phase.filter(|_| !state.is_empty()) else {
        return;
    };
    let mut names = document.joints.keys();
    if !names.any(|name| document.on_since(name, phase).is_some()) {
        return;
    }
    let mut real = model.map(&mut |x| x.re());
    redundancy::leave_out(&mut real);
    for (joint, real) in model.joints.iter_mut().zip(real.joints) {
        (joint.redundant, joint.fit) = (real.redundant, real.fit);
    }
}

/// The function that has the quantity of the event that ends a phase.
fn event_quantity(document: &Document) -> Option<usize> {
    let (name, _) = document.next_event()?;
    document.functions.get_index_of(&quantity_of(name))
}

/// Name of the function that has the quantity of an event in every phase.
pub(super) fn quantity_of(event: &str) -> String {
    format!("quantity of the event {event}")
}

impl Problem {
    /// The design variables of a point in the space of the variables and of the state with which a phase begins, and this
    /// state.
    pub(super) fn split<'x, S>(&self, x: &'x [S]) -> (&'x [S], &'x [S]) {
        x.split_at(self.variables.len().min(x.len()))
    }

    /// Joints that are closed in its phase since an event before the one with which it begins.
    fn kept_closed(&self) -> Vec<usize> {
        let Some(phase) = self.written.phase else {
            return Vec::new();
        };
        let names = self.written.joints.keys().enumerate();
        let since = |name: &str| self.written.on_since(name, phase);
        let kept = names.filter(|(_, name)| since(name).is_some_and(|since| since < phase));
        kept.map(|(j, _)| j).collect()
    }

    /// The state with which its phase begins, after the phase of `scene` with the motion `run` from the time `begin` on.
    pub fn state_after<S: Scalar>(
        &self,
        scene: &Scene<S>,
        run: &Trajectory<S>,
        begin: S,
    ) -> Vec<S> {
        let (q, v) = (run.q(run.last()), run.v(run.last()));
        let mut state = Vec::new();
        for body in 0..scene.model.bodies.len() {
            state.extend(&q[run.numbering.position(body)..][..7]);
            state.extend(&v[run.numbering.velocity(body)..][..6]);
        }
        for joint in self.kept_closed() {
            let own = &scene.model.joints[joint];
            state.extend(own.frame_b.point.iter());
            let axes = own.frame_a.axes.iter().zip(&own.frame_b.axes);
            let turn: Mat3<S> = axes.map(|(a, b)| b * a.transpose()).sum();
            state.extend(turn.iter());
            state.push(own.frame_a.length);
        }
        for instant in scene.functions.iter().flat_map(Function::instants) {
            if let Some(watched) = instant.watched_rotation() {
                let twist = watched.angle(&run.numbering, q).re();
                let turns = turns(Some(watched), run);
                let turns = turns.and_then(|all| all.last().copied());
                state.push(S::from(twist + turns.unwrap_or_default()));
            }
        }
        state.push(begin + run.duration);
        state
    }

    /// Cotangents of what [`Problem::state_after`] takes, from those of the state, `by`.
    pub fn pull_state(
        &self,
        scene: &Scene<f64>,
        run: &Trajectory<f64>,
        by: &[f64],
    ) -> EndCotangent {
        let numbering = &run.numbering;
        let mut end = WeightedEnd {
            q: vec![0.0; numbering.positions()],
            v: vec![0.0; numbering.velocities()],
        };
        let bodies = numbering.bodies();
        for (body, by) in by.chunks_exact(OF_BODY).take(bodies).enumerate() {
            end.q[numbering.position(body)..][..7].copy_from_slice(&by[..7]);
            end.v[numbering.velocity(body)..][..6].copy_from_slice(&by[7..]);
        }
        let of_frames = by[OF_BODY * bodies..].chunks_exact(OF_FRAME);
        let frames = self.kept_closed().into_iter().zip(of_frames);
        let frames = frames.map(|(joint, by)| {
            let own = &scene.model.joints[joint];
            let [mut a, mut b] = [JointFrame::zero(); 2];
            b.point = Vec3::from_column_slice(&by[..3]);
            let turn = Mat3::from_column_slice(&by[3..12]);
            b.axes = own.frame_a.axes.map(|axis| turn * axis);
            a.axes = own.frame_b.axes.map(|axis| turn.tr_mul(&axis));
            a.length = by[12];
            (joint, [a, b])
        });
        EndCotangent {
            end,
            frames: frames.collect(),
            duration: by.last().copied().unwrap_or_default(),
        }
    }

    /// Whether it is a phase of a motion that events divide.
    pub fn is_phase(&self) -> bool {
        self.written.phase.is_some()
    }

    /// Name of the event with which its phase begins, if one does.
    pub fn last_event(&self) -> Option<&str> {
        let event = self.written.phase?.checked_sub(1)?;
        let (name, _) = self.written.events.get_index(event)?;
        Some(name)
    }

    /// Whether its phase waits for the quantity that ended the one before it.
    pub fn waits_again(&self) -> bool {
        let of = |event: &str| &self.document["events"][event]["when"]["measure"];
        let both = self.last_event().zip(self.next_event());
        both.is_some_and(|(last, next)| !of(next).is_null() && of(last) == of(next))
    }

    /// When its phase begins at the design and the state `x` \[s\].
    pub fn begin(&self, x: &[f64]) -> f64 {
        self.split(x).1.last().copied().unwrap_or_default()
    }

    /// Name of the event that ends its phase, if one does.
    pub fn next_event(&self) -> Option<&str> {
        self.written.next_event().map(|(name, _)| name.as_str())
    }
}
