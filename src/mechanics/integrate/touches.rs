//! Contacts that come and go within a step, and the points of the profiles of cams, at which steps end.
//!
//! The error of a step knows nothing of a force that no stage has met. So the bodies are followed over the step by the quintic
//! through positions q, velocities and accelerations at both ends, Euler parameters likewise:
//!
//! ```text
//! q(s) = Σ_e [ H_e0(s) q_e + h H_e1(s) q̇_e + h² H_e2(s) q̈_e ],   e the start and the end, 0 ≤ s ≤ 1
//! ```
//!
//! It errs by h⁶/46080 times the sixth derivative: by 2e-5 of the length of what turns by 2 rad in the step. A step that begins
//! apart, ends so or grazes, and touches more between is repeated, and then ends where it is deepest. Of equal steps, which cannot be
//! repeated, one fails that begins apart and is past the deepest place at its end, as it went through the contact or back out of it, and
//! one that touches and at whose end the normal points back, as it went past the middle.
//!
//! The third derivative of a profile jumps at its points, and each of its values acts near one of them alone. So derivatives in
//! the values need steps that are no longer than from one point to the next.

use super::settings::Spacing;
use crate::math::Scalar;
use crate::math::rotation;
use crate::model::{Joint, Model, TimeFunction};
use crate::system::Numbering;
use crate::system::bodies::{BodyMotion, positions_of, velocities_of};
use crate::system::loads::gaps::{Gap, gaps, may_touch};

/// A contact that a step passes over, or a point of a profile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// Which.
    pub over: Over,
    /// The part of the step after which it is deepest, or at the point.
    pub part: f64,
}

/// What a step passes over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// The contact that is this load.
    Contact(usize),
    /// The profile of the cam that is this joint.
    Profile(usize),
}

impl Over {
    /// Its name.
    pub fn name<S>(self, model: &Model<S>) -> String {
        match self {
            Self::Contact(load) => model.loads[load].name.clone(),
            Self::Profile(joint) => model.joints[joint].name.clone(),
        }
    }
}

/// A state as the quintic needs it: q, q̇ and q̈ by body, its time and its gaps.
#[derive(Clone, Debug, Default)]
struct End {
    bodies: Vec<[[f64; 7]; 3]>,
    time: f64,
    /// Of all loads; none if the scene has many contacts.
    gaps: Vec<Gap>,
}

/// The start of a step and its end.
pub struct Touches {
    before: End,
    after: End,
    cams: Vec<Cam>,
    /// Whether steps are equal, so that what one passes over is a failure.
    equal: bool,
}

/// A cam: its joint, the body whose coordinate it follows, and the points of its profile.
struct Cam {
    joint: usize,
    body: usize,
    points: Vec<f64>,
}

impl Cam {
    fn all<S: Scalar>(model: &Model<S>) -> Vec<Self> {
        let one = |(joint, own): (usize, &Joint<S>)| {
            let modes = own.modes.as_ref()?;
            let &(body, _) = modes.places.first()?;
            match modes.profile.as_ref()? {
                TimeFunction::Table { times, .. } => Some(Self {
                    joint,
                    body,
                    points: times.iter().map(|t| t.re()).collect(),
                }),
                _ => None,
            }
        };
        model.joints.iter().enumerate().filter_map(one).collect()
    }
}

impl Touches {
    /// Watches the stops and contacts of a model, and its cams if steps follow a tolerance, from its start (q, v, v̇); `None` if it
    /// has none.
    pub fn open<S: Scalar>(
        model: &Model<S>,
        numbering: &Numbering,
        (start, spacing): ([&[S]; 3], &Spacing),
    ) -> Option<Self> {
        let chosen = matches!(spacing, Spacing::Tolerance(_));
        let cams = if chosen { Cam::all(model) } else { Vec::new() };
        if cams.is_empty() && !model.loads.iter().any(|load| may_touch(&load.kind)) {
            return None;
        }
        let mut before = End::default();
        before.set(model, numbering, start, 0.0);
        Some(Self {
            before,
            after: End::default(),
            cams,
            equal: spacing.is_equal(),
        })
    }

    /// The point of a profile that comes first of those which the step passes over.
    fn passed(&self, h: f64) -> Option<Missed> {
        let one = |cam: &Cam| {
            let place = |s: f64| self.inside::<f64>(cam.body, h, s).position.x;
            let ends = [&self.before, &self.after].map(|end| end.bodies[cam.body][0][0]);
            let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            let between = cam.points.iter().filter(|x| low < **x && **x < high);
            let part = |&x: &f64| {
                let (mut low, mut high) = (0.0, 1.0);
                let sign = (ends[1] - ends[0]).signum();
                for _ in 0..HALVES {
                    let middle = 0.5 * (low + high);
                    match sign * (place(middle) - x) < 0.0 {
                        true => low = middle,
                        false => high = middle,
                    }
                }
                low
            };
            let parts = between.map(part).filter(|s| (NEAR..1.0 - NEAR).contains(s));
            let over = Over::Profile(cam.joint);
            (parts.min_by(f64::total_cmp)).map(|part| Missed { over, part })
        };
        let all = self.cams.iter().filter_map(one);
        all.min_by(|a, b| a.part.total_cmp(&b.part))
    }

    /// Whether the force of a contact begins, sets in or lets go between the start of a step and the positions `motions` at
    /// `time`. Not known of scenes with many contacts, where none decides alone.
    pub fn change<S: Scalar>(
        &self,
        model: &Model<S>,
        (motions, time): (&[BodyMotion<S>], f64),
    ) -> bool {
        if self.before.gaps.is_empty() {
            return false;
        }
        let mut now = Vec::new();
        gaps(model, (motions, time), 0..model.loads.len(), &mut now);
        let mut pairs = self.before.gaps.iter().zip(&now);
        pairs.any(|(before, now)| before.phase() != now.phase())
    }

    /// The contact that comes first of those which a step of size h to the state (q, v, v̇) passes over.
    pub fn missed<S: Scalar>(
        &mut self,
        model: &Model<S>,
        numbering: &Numbering,
        end: [&[S]; 3],
        h: f64,
    ) -> Option<Missed> {
        self.after.set(model, numbering, end, self.before.time + h);
        let passed = self.passed(h);
        let near = numbering.near();
        if passed.is_some() || (self.before.gaps.is_empty() && near.is_none()) {
            return passed;
        }
        let mut motions: Vec<BodyMotion<S>> = Vec::new();
        let mut at = |part: f64, of: &[usize]| {
            let bodies = 0..numbering.bodies();
            motions.clear();
            motions.extend(bodies.map(|body| self.inside(body, h, part)));
            let (mut found, time) = (Vec::new(), self.before.time + part * h);
            gaps(model, (&motions, time), of.iter().copied(), &mut found);
            found
        };
        let (before, middle, after) = match near {
            None => {
                let all: Vec<usize> = (0..model.loads.len()).collect();
                (
                    self.before.gaps.clone(),
                    at(0.5, &all),
                    self.after.gaps.clone(),
                )
            }
            Some(near) => {
                let place = |body: usize| self.inside::<f64>(body, h, 0.5).position;
                let reach = |body: usize| self.way(body, h);
                let all = near.loads(place, reach);
                (at(0.0, &all), at(0.5, &all), at(1.0, &all))
            }
        };
        let all = before.iter().zip(&middle).zip(&after).enumerate();
        let all = all.filter_map(|(k, ((now, middle), after))| {
            let ends_apart = after.penetration < -GRAZES * after.onset;
            let least = if self.equal && now.normal.dot(&after.normal) < 0.0 {
                now.onset
            } else if (ends_apart || self.equal) && may_meet([now, middle, after], h) {
                now.onset.max(after.penetration)
            } else {
                return None;
            };
            let first = before.iter().position(|own| own.load == now.load)?;
            let wanted = (now.load, k - first, least);
            self.deepest(model, &mut motions, wanted, h)
        });
        all.min_by(|a, b| a.part.total_cmp(&b.part))
    }

    /// A bound of the way of a body from the middle of a step to either end. What turns about the body stays within its reach.
    fn way(&self, body: usize, h: f64) -> f64 {
        let speed = |s: f64| self.inside::<f64>(body, h, s).velocity.norm();
        0.5 * h * SPEEDS_UP * [0.0, 0.5, 1.0].map(speed).into_iter().fold(0.0, f64::max)
    }

    /// Goes on from the end of the step that was looked at last.
    pub fn go_on(&mut self) {
        std::mem::swap(&mut self.before, &mut self.after);
    }

    /// The motion of a body at a part s of a step of size h.
    fn inside<S: Scalar>(&self, body: usize, h: f64, s: f64) -> BodyMotion<S> {
        let (at, rates) = weights(h, s);
        let ends = [&self.before.bodies[body], &self.after.bodies[body]];
        let sum = |weights: &[[f64; 3]; 2]| {
            let term = |e: usize, d: usize, i: usize| weights[e][d] * ends[e][d][i];
            let one = |i: usize| -> f64 {
                (0..2)
                    .map(|e| (0..3).map(|d| term(e, d, i)).sum::<f64>())
                    .sum()
            };
            std::array::from_fn::<f64, 7, _>(one)
        };
        let (position, p) = positions_of(&sum(&at));
        let (velocity, pdot) = positions_of(&sum(&rates));
        let p = rotation::unit(&p);
        let omega = rotation::angular_velocity(&p, &pdot);
        let orientation = p.map(S::from);
        BodyMotion {
            position: position.map(S::from),
            orientation,
            rotation: rotation::matrix(&orientation),
            velocity: velocity.map(S::from),
            omega: omega.map(S::from),
            ..BodyMotion::ground()
        }
    }

    /// Where gap k of a load is deepest, if it is deeper there than `least`.
    fn deepest<S: Scalar>(
        &self,
        model: &Model<S>,
        motions: &mut [BodyMotion<S>],
        (load, k, least): (usize, usize, f64),
        h: f64,
    ) -> Option<Missed> {
        let bodies = model.loads[load].kind.bodies(&model.joints);
        let mut found = Vec::new();
        let mut depth = |part: f64| {
            for &body in &bodies {
                motions[body] = self.inside(body, h, part);
            }
            let time = self.before.time + part * h;
            gaps(model, (motions, time), load..load + 1, &mut found);
            found[k].penetration
        };
        let at = |k: usize| k as f64 / INTERVALS as f64;
        let depths: Vec<f64> = (1..INTERVALS).map(|k| depth(at(k))).collect();
        let order = |&a: &usize, &b: &usize| depths[a - 1].total_cmp(&depths[b - 1]);
        let best = (1..INTERVALS).max_by(order)?;
        let (mut low, mut high) = (at(best - 1), at(best + 1));
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            if depth(low + third) < depth(high - third) {
                low += third;
            } else {
                high -= third;
            }
        }
        let part = 0.5 * (low + high);
        let over = Over::Contact(load);
        (depth(part) > least).then_some(Missed { over, part })
    }
}

impl End {
    fn set<S: Scalar>(
        &mut self,
        model: &Model<S>,
        numbering: &Numbering,
        [q, v, a]: [&[S]; 3],
        time: f64,
    ) {
        self.time = time;
        self.bodies.clear();
        self.bodies.extend((0..numbering.bodies()).map(|body| {
            let (o, u) = (numbering.position(body), numbering.velocity(body));
            let real = |of: &[S]| -> Vec<f64> { of.iter().map(|x| x.re()).collect() };
            let (r, p) = positions_of(&real(&q[o..o + 7]));
            let (velocity, omega) = velocities_of(&real(&v[u..u + 6]));
            let (acceleration, alpha) = velocities_of(&real(&a[u..u + 6]));
            let pdot = rotation::rates(&p, &omega);
            let [by_alpha, by_omega] =
                [rotation::rates(&p, &alpha), rotation::rates(&pdot, &omega)];
            let pddot = std::array::from_fn(|i| by_alpha[i] + by_omega[i]);
            [(r, p), (velocity, pdot), (acceleration, pddot)].map(|(x, p)| joined(&x, &p))
        }));
        if numbering.near().is_some() {
            return;
        }
        let mut motions = Vec::new();
        BodyMotion::all(numbering, q, v, &mut motions);
        gaps(
            model,
            (&motions, time),
            0..model.loads.len(),
            &mut self.gaps,
        );
    }
}

fn joined(x: &crate::math::Vec3<f64>, p: &[f64; 4]) -> [f64; 7] {
    [x.x, x.y, x.z, p[0], p[1], p[2], p[3]]
}

/// Intervals of a step in which the deepest place is looked for, and steps to the best in them: to 1e-9 of the step.
const INTERVALS: usize = 16;
const THIRDS: usize = 45;
/// Halvings to a point of a profile; those nearer to an end of the step than this part of it are left alone.
const HALVES: usize = 40;
const NEAR: f64 = 1e-3;

/// A penetration below this times the size of that at which a force is felt has a force that steps need not notice.
const GRAZES: f64 = 2.0;

/// The speed between two looks is at most this times the largest of the three.
const SPEEDS_UP: f64 = 1.5;

/// Whether a step that begins apart may touch before its end: the gap is known at three places, and no place is
/// further than a quarter of the step from one.
fn may_meet(gaps: [&Gap; 3], h: f64) -> bool {
    let largest = |of: &dyn Fn(&Gap) -> f64| gaps.iter().map(|gap| of(gap)).fold(0.0, f64::max);
    let apart = gaps[0].penetration < gaps[0].onset;
    let reach = 0.25 * h * SPEEDS_UP * largest(&|gap| gap.speed);
    let near = |gap: &&Gap| gap.penetration + reach >= gap.onset;
    apart && gaps.iter().any(near)
}

/// Factors of q, q̇ and q̈ at the start and at the end, in the quintic and in its rate.
fn weights(h: f64, s: f64) -> ([[f64; 3]; 2], [[f64; 3]; 2]) {
    let (s2, s3, s4) = (s * s, s * s * s, s * s * s * s);
    let s5 = s4 * s;
    let half = 0.5 * h * h;
    let value = [
        [
            1.0 - 10.0 * s3 + 15.0 * s4 - 6.0 * s5,
            h * (s - 6.0 * s3 + 8.0 * s4 - 3.0 * s5),
            half * (s2 - 3.0 * s3 + 3.0 * s4 - s5),
        ],
        [
            10.0 * s3 - 15.0 * s4 + 6.0 * s5,
            h * (-4.0 * s3 + 7.0 * s4 - 3.0 * s5),
            half * (s3 - 2.0 * s4 + s5),
        ],
    ];
    let turn = 30.0 * (s2 - 2.0 * s3 + s4) / h;
    let rate = [
        [
            -turn,
            1.0 - 18.0 * s2 + 32.0 * s3 - 15.0 * s4,
            0.5 * h * (2.0 * s - 9.0 * s2 + 12.0 * s3 - 5.0 * s4),
        ],
        [
            turn,
            -12.0 * s2 + 28.0 * s3 - 15.0 * s4,
            0.5 * h * (3.0 * s2 - 8.0 * s3 + 5.0 * s4),
        ],
    ];
    (value, rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The quintic has the values, rates and second derivatives of s⁵ − 2 s² + 1 at both ends, and so all of it.
    #[test]
    fn follows_a_quintic() {
        let h = 0.7;
        let of = |t: f64| t.powi(5) - 2.0 * t * t + 1.0;
        let rate = |t: f64| 5.0 * t.powi(4) - 4.0 * t;
        let second = |t: f64| 20.0 * t.powi(3) - 4.0;
        let ends = [0.0, h].map(|t| [of(t), rate(t), second(t)]);
        for s in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let (value, by) = weights(h, s);
            let sum = |w: [[f64; 3]; 2]| -> f64 {
                let all = w.iter().flatten().zip(ends.iter().flatten());
                all.map(|(w, x)| w * x).sum()
            };
            assert!((sum(value) - of(s * h)).abs() < 1e-14);
            assert!((sum(by) - rate(s * h)).abs() < 1e-13);
        }
    }
}
