//! Moving bodies that are welded to each other: which of them are merged.
//!
//! A start is the state nearest to the placement that satisfies the constraints. The nearest state
//! of one merged body is not that of several bodies. So bodies are merged only if nothing has to be
//! corrected: at every design, the placement and its velocities satisfy all joints of the connected
//! bodies.

use super::examine::{ConditionChecker, Designs, Verdict, ViolatedCondition};
use super::merge::{self, Cluster};
use super::{Kept, fixed, reactions};
use crate::functions::Scene;
use crate::integrate::Trajectory;
use crate::math::{Scalar, Vec3};
use crate::model::{Joint, JointKind, LoadKind, Model, TimeFunction};
use crate::system::{BodyMotion, Numbering, constraint, placement, side};

/// Bodies that are merged.
#[derive(Clone, Debug, Default)]
pub struct Welded {
    /// The bodies that move as one.
    pub clusters: Vec<Cluster>,
    /// The welds that vanish.
    pub welds: Vec<usize>,
    /// Joints of all bodies that are connected with them; all must be closed.
    closed: Vec<usize>,
    /// Pairs of bodies of one cluster whose rotations functions observe.
    alike: Vec<[usize; 2]>,
}

/// A weld of two moving bodies, and the violated conditions of merging them.
struct Candidate {
    joint: usize,
    bodies: [usize; 2],
    obstacles: Vec<ViolatedCondition>,
}

impl Welded {
    /// Finds the bodies to merge, and the welds that stay with their violated conditions.
    pub(super) fn find(designs: &Designs) -> (Self, Vec<Kept>) {
        let model = &designs.start.model;
        let held = fixed::welded_to_ground(model);
        let between = |joint: &Joint<f64>| match joint.body_b {
            Some(b) if !held[joint.body_a] && !held[b] => Some([joint.body_a, b]),
            _ => None,
        };
        let welds = model.joints.iter().enumerate();
        let welds = welds.filter(|(_, joint)| joint.kind == JointKind::Weld);
        let mut candidates: Vec<Candidate> = welds
            .filter_map(|(joint, weld)| {
                Some(Candidate {
                    joint,
                    bodies: between(weld)?,
                    obstacles: loads_on(&designs.start, joint),
                })
            })
            .collect();
        if candidates.is_empty() {
            return Default::default();
        }
        // Connected bodies; ground does not connect.
        let mut together = Groups::new(model.bodies.len());
        for [a, b] in model.joints.iter().filter_map(between) {
            together.join(a, b);
        }
        let joints_of = |group: usize, together: &mut Groups| -> Vec<usize> {
            let joints = model.joints.iter().enumerate();
            let own = joints.filter(|(_, joint)| {
                let ends = [Some(joint.body_a), joint.body_b];
                let mut free = ends.into_iter().flatten().filter(|&body| !held[body]);
                free.any(|body| together.of(body) == group)
            });
            own.map(|(j, _)| j).collect()
        };
        let mut found = Self::default();
        let mut examined: Vec<(usize, Vec<ViolatedCondition>)> = Vec::new();
        for candidate in &mut candidates {
            let group = together.of(candidate.bodies[0]);
            let known = examined.iter().position(|(own, _)| *own == group);
            let known = known.unwrap_or_else(|| {
                let joints = joints_of(group, &mut together);
                let verdict = designs.ask(
                    |scene| closed(scene, &joints, 0.0),
                    |scene, change| closed(scene, &joints, change),
                );
                if verdict.is_ok() {
                    found.closed.extend(joints);
                }
                examined.push((group, verdict.err().unwrap_or_default()));
                examined.len() - 1
            });
            candidate.obstacles.extend_from_slice(&examined[known].1);
        }
        found.join(designs, &mut candidates);
        let kept = candidates.into_iter().filter_map(|candidate| {
            let name = &model.joints[candidate.joint].name;
            (!candidate.obstacles.is_empty()).then(|| Kept {
                reduction: format!("weld \"{name}\" between bodies that move"),
                obstacles: candidate.obstacles,
            })
        });
        (found, kept.collect())
    }

    /// Merges the bodies of welds without violated conditions.
    fn join(&mut self, designs: &Designs, candidates: &mut [Candidate]) {
        let model = &designs.start.model;
        let watched = merge::watched(&designs.start);
        let mut host: Vec<Option<usize>> = vec![None; model.bodies.len()];
        for &body in &watched {
            host[body] = Some(body);
        }
        let mut groups = Groups::new(model.bodies.len());
        let vanishing = |candidates: &[Candidate], j: usize| {
            let mut all = candidates.iter();
            all.any(|own| own.joint == j && own.obstacles.is_empty())
        };
        for c in 0..candidates.len() {
            if !candidates[c].obstacles.is_empty() {
                continue;
            }
            let [a, b] = candidates[c].bodies.map(|body| groups.of(body));
            if a == b {
                continue;
            }
            let mut links = |ends: [Option<usize>; 2]| {
                let ends = ends.map(|body| body.map(|body| groups.of(body)));
                ends == [Some(a), Some(b)] || ends == [Some(b), Some(a)]
            };
            let mut obstacles = Vec::new();
            for (j, joint) in model.joints.iter().enumerate() {
                if links([Some(joint.body_a), joint.body_b]) && !vanishing(candidates, j) {
                    let name = &joint.name;
                    obstacles.push(ViolatedCondition::plain(format!(
                        "joint \"{name}\" joins them too"
                    )));
                }
            }
            for load in &model.loads {
                let pair = match &load.kind {
                    LoadKind::Spring { body_a, body_b, .. }
                    | LoadKind::DistanceStop { body_a, body_b, .. } => [Some(*body_a), *body_b],
                    LoadKind::Contact(own) => [Some(own.body_a), own.body_b],
                    // A scene with cables is not welded.
                    LoadKind::Cable(_)
                    | LoadKind::Force { .. }
                    | LoadKind::Torque { .. }
                    | LoadKind::TorsionSpring { .. }
                    | LoadKind::Damping { .. }
                    | LoadKind::BallDamping { .. }
                    | LoadKind::Bushing { .. }
                    | LoadKind::Friction { .. }
                    | LoadKind::Drag { .. }
                    | LoadKind::JointStop { .. }
                    | LoadKind::Controller(_)
                    | LoadKind::Distributed(_) => continue,
                };
                if links(pair) {
                    let name = &load.name;
                    obstacles.push(ViolatedCondition::plain(format!(
                        "load \"{name}\" joins them too"
                    )));
                }
            }
            if let (Some(first), Some(second)) = (host[a], host[b]) {
                let pair = [first, second];
                let verdict = designs.ask(
                    |scene| alike(&scene.model, &[pair], 0.0),
                    |scene, change| alike(&scene.model, &[pair], change),
                );
                match verdict {
                    Ok(()) => self.alike.push(pair),
                    Err(found) => obstacles.extend(found),
                }
            }
            if obstacles.is_empty() {
                let watched = host[a].or(host[b]);
                groups.join(a, b);
                host[groups.of(a)] = watched;
            }
            candidates[c].obstacles = obstacles;
        }
        for first in 0..model.bodies.len() {
            let group = groups.of(first);
            let members: Vec<usize> = (first..model.bodies.len())
                .filter(|&body| groups.of(body) == group)
                .collect();
            let known = self.clusters.iter().any(|own| own.members.contains(&first));
            if members.len() > 1 && !known {
                self.clusters.push(Cluster {
                    host: host[group].unwrap_or(first),
                    members,
                });
            }
        }
        let vanish = candidates.iter().filter(|own| own.obstacles.is_empty());
        self.welds = vanish.map(|own| own.joint).collect();
        if self.welds.is_empty() {
            self.closed.clear();
        }
    }

    /// Whether no bodies are merged.
    pub fn is_empty(&self) -> bool {
        self.clusters.is_empty()
    }

    /// Examines the conditions of merging the bodies.
    pub(super) fn holds<S: Scalar>(&self, scene: &Scene<S>, change: f64) -> Verdict {
        closed(scene, &self.closed, change)?;
        alike(&scene.model, &self.alike, change)
    }

    /// Merges the bodies.
    pub(super) fn apply<S: Scalar>(&self, scene: &mut Scene<S>) {
        merge::merge(scene, &self.clusters, &self.welds);
    }

    /// The motion of all bodies of `written` from `run`, the motion of the merged bodies.
    pub(super) fn expand(&self, written: &Model<f64>, run: &Trajectory<f64>) -> Trajectory<f64> {
        merge::expand(written, &self.clusters, run)
    }
}

/// Loads that act through a joint, and functions that observe its reaction. They prevent its removal.
fn loads_on(scene: &Scene<f64>, joint: usize) -> Vec<ViolatedCondition> {
    let model = &scene.model;
    let loads = model.loads.iter();
    let loads = loads.filter(|load| load.kind.joint() == Some(joint));
    let told =
        loads.map(|load| ViolatedCondition::plain(format!("load \"{}\" acts on it", load.name)));
    let mut all: Vec<ViolatedCondition> = told.collect();
    all.extend(reactions::kept(scene, |wrench| wrench.joint == joint));
    all
}

/// Examines whether the placement and its velocities satisfy `joints`.
///
/// A violation of a velocity is round-off relative to the placed velocities, to the largest rate of
/// drives, or to a characteristic length divided by the duration.
fn closed<S: Scalar>(scene: &Scene<S>, joints: &[usize], change: f64) -> Verdict {
    let model = &scene.model;
    let duration = scene.duration.re().abs();
    let mut examiner = ConditionChecker::new(change);
    let (q, v) = placement::guess(model);
    let mut motions = Vec::new();
    BodyMotion::all_normalised(&Numbering::new(model), &q, &v, &mut motions);
    let ground = BodyMotion::ground();
    let size = |x: &Vec3<S>| x.iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
    for &j in joints {
        let joint = &model.joints[j];
        let name = &joint.name;
        let (a, b) = side::sides(joint, &motions, &ground, S::zero());
        let characteristic_length =
            [&a, &b].map(|side| size(&side.motion.position) + size(&side.frame.point));
        let characteristic_length = characteristic_length[0]
            .max(characteristic_length[1])
            .max(joint.frame_a.length.re().abs());
        let speed = [&a, &b].map(|side| {
            size(&side.motion.velocity) + size(&side.motion.omega) * size(&side.frame.point)
        });
        let spin = [&a, &b].map(|side| size(&side.motion.omega));
        let (speed, spin) = (speed[0].max(speed[1]), spin[0].max(spin[1]));
        for row in joint.all_rows() {
            let what = || {
                let what = "is open where the bodies are placed";
                (format!("joint \"{name}\" {what}"), "")
            };
            let (length, rate) = match row.has_force() {
                true => (characteristic_length, speed + spin * characteristic_length),
                false => (1.0, spin),
            };
            let rate = rate.max(drives_reach(joint)).max(length / duration);
            examiner.zero(constraint::value(row, &a, &b), length, what);
            let what = || {
                let what = "opens by the velocities that the bodies are placed with";
                (format!("joint \"{name}\" {what}"), "")
            };
            examiner.zero(constraint::rate(row, &a, &b), rate, what);
        }
    }
    examiner.verdict()
}

/// Largest rate of the harmonic drives of a joint \[m/s or rad/s\]: the scale of the round-off of
/// their rate at the start. Other prescribed motions have no such round-off.
fn drives_reach<S: Scalar>(joint: &Joint<S>) -> f64 {
    let rates = joint.drives.iter().map(|drive| match &drive.course {
        TimeFunction::Harmonic {
            amplitude,
            frequency,
            ..
        } => std::f64::consts::TAU * (amplitude.re() * frequency.re()).abs(),
        TimeFunction::Polynomial(_) | TimeFunction::Table { .. } | TimeFunction::SCurve(_) => 0.0,
    });
    rates.fold(0.0, f64::max)
}

/// Examines whether the bodies of each pair have the same rotation.
fn alike<S: Scalar>(model: &Model<S>, pairs: &[[usize; 2]], change: f64) -> Verdict {
    let mut examiner = ConditionChecker::new(change);
    for pair in pairs {
        let [a, b] = pair.map(|body| &model.bodies[body]);
        let between: [S; 4] = std::array::from_fn(|k| a.orientation[k] - b.orientation[k]);
        examiner.vanishes(&between, 1.0, || {
            let (a, b) = (&a.name, &b.name);
            let what = "are watched, and turned against each other";
            (
                format!("the rotations of bodies \"{a}\" and \"{b}\" {what}"),
                "",
            )
        });
    }
    examiner.verdict()
}

/// Disjoint groups of numbers.
pub(super) struct Groups(Vec<usize>);

impl Groups {
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    /// Representative of the group of i.
    pub fn of(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.0[a] = b;
    }
}
