//! Contacts that come and go within a step.
//!
//! The error of a step knows nothing of a force that no stage has met. So each stop or contact is followed over the step by
//! the cubic through values and rates at both ends: of the penetration of joints and planes, and of the vector between the points of
//! distances and spheres, whose length has a sharp bend where they fly past each other. The cubic errs by h⁴/384 times its fourth
//! derivative. A step that begins and ends apart and touches between is repeated, and then ends where the cubic is deepest.

use crate::math::Scalar;
use crate::model::Model;
use crate::system::loads::course::Course;
use crate::system::loads::gaps::{Gap, gaps, may_touch};
use crate::system::{BodyMotion, Numbering};

/// A contact that a step passes over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// The load.
    pub load: usize,
    /// The part of the step after which it is deepest.
    pub part: f64,
}

/// The gaps at the start of a step and at its end.
pub struct Touches {
    before: Vec<Gap>,
    after: Vec<Gap>,
}

impl Touches {
    /// Watches the stops and contacts of a model from its start (q, v); `None` if it has none.
    pub fn open<S: Scalar>(
        model: &Model<S>,
        numbering: &Numbering,
        (q, v): (&[S], &[S]),
    ) -> Option<Self> {
        if !model.loads.iter().any(|load| may_touch(&load.kind)) {
            return None;
        }
        let (mut before, mut motions) = (Vec::new(), Vec::new());
        BodyMotion::all(numbering, q, v, &mut motions);
        gaps(model, &motions, &mut before);
        Some(Self {
            before,
            after: Vec::new(),
        })
    }

    /// The contact that comes first of those which a step of size h passes over; `motions` are those of its end.
    pub fn missed<S: Scalar>(
        &mut self,
        model: &Model<S>,
        motions: &[BodyMotion<S>],
        h: f64,
    ) -> Option<Missed> {
        gaps(model, motions, &mut self.after);
        let pairs = self.before.iter().zip(&self.after);
        let all = pairs.filter_map(|(before, after)| {
            let part = deepest([before, after], h)?;
            Some(Missed {
                load: before.load,
                part,
            })
        });
        all.min_by(|a, b| a.part.total_cmp(&b.part))
    }

    /// Goes on from the end of the step that was looked at last.
    pub fn go_on(&mut self) {
        std::mem::swap(&mut self.before, &mut self.after);
    }
}

/// Intervals of a step in which the deepest place is looked for, and halvings of the best.
const INTERVALS: usize = 16;
const HALVINGS: usize = 50;

/// The part of a step of size h at which the penetration is largest, if it begins and ends apart and touches between.
fn deepest([before, after]: [&Gap; 2], h: f64) -> Option<f64> {
    let onset = before.onset.max(after.onset);
    let apart = |gap: &Gap| gap.course.penetration() < gap.onset;
    if !(apart(before) && apart(after)) || stays_apart([before, after], h) {
        return None;
    }
    let depth = |part: f64| between([&before.course, &after.course], h, part).penetration();
    let at = |k: usize| k as f64 / INTERVALS as f64;
    let best = (1..INTERVALS).max_by(|&a, &b| depth(at(a)).total_cmp(&depth(at(b))))?;
    let (mut low, mut high) = (at(best - 1), at(best + 1));
    for _ in 0..HALVINGS {
        let third = (high - low) / 3.0;
        if depth(low + third) < depth(high - third) {
            low += third;
        } else {
            high -= third;
        }
    }
    let part = 0.5 * (low + high);
    (depth(part) > onset).then_some(part)
}

/// Whether the cubic surely stays apart: it lies in the convex hull of its control points.
fn stays_apart([before, after]: [&Gap; 2], h: f64) -> bool {
    match (&before.course, &after.course) {
        (Course::Depth { value: x, rate: v }, Course::Depth { value: y, rate: w }) => {
            (x + v * h / 3.0).max(y - w * h / 3.0) < before.onset
        }
        (
            Course::Distance {
                point: x, rate: v, ..
            },
            Course::Distance {
                point: y, rate: w, ..
            },
        ) => {
            let far = [v * (h / 3.0), y - w * (h / 3.0) - x, y - x];
            let far = far.iter().fold(0.0_f64, |far, own| far.max(own.norm()));
            // What turns may come nearer by its length.
            let half = |course: &Course| match course {
                Course::Distance { half, .. } => half.norm(),
                Course::Depth { .. } => 0.0,
            };
            let turned = half(&before.course) + half(&after.course);
            before.course.penetration() + far + turned < before.onset
        }
        (Course::Depth { .. }, Course::Distance { .. })
        | (Course::Distance { .. }, Course::Depth { .. }) => unreachable!("a gap keeps its kind"),
    }
}

/// The course at a part of a step: the cubic, and the segment between both.
fn between([before, after]: [&Course; 2], h: f64, s: f64) -> Course {
    let (rest, at_end) = ((1.0 - s) * (1.0 - s), s * s);
    let weights = [
        rest * (1.0 + 2.0 * s),
        rest * s * h,
        at_end * (3.0 - 2.0 * s),
        -(at_end * (1.0 - s) * h),
    ];
    match (*before, *after) {
        (Course::Depth { value: x, rate: v }, Course::Depth { value: y, rate: w }) => {
            let [a, b, c, d] = weights;
            Course::Depth {
                value: x * a + v * b + y * c + w * d,
                rate: v,
            }
        }
        (
            Course::Distance {
                point: x,
                rate: v,
                half,
                reach,
                side,
            },
            Course::Distance {
                point: y,
                rate: w,
                half: half_after,
                ..
            },
        ) => {
            let [a, b, c, d] = weights;
            Course::Distance {
                point: x * a + v * b + y * c + w * d,
                rate: v,
                half: half + (half_after - half) * s,
                reach,
                side,
            }
        }
        (Course::Depth { .. }, Course::Distance { .. })
        | (Course::Distance { .. }, Course::Depth { .. }) => unreachable!("a gap keeps its kind"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;

    fn gap(value: f64, rate: f64) -> Gap {
        Gap {
            load: 0,
            course: Course::Depth { value, rate },
            onset: 0.0,
        }
    }

    /// A cubic with the root of its rate inside, a parabola, and motions that come near only or move one way.
    #[test]
    fn finds_the_deepest_place() {
        let cubic = |s: f64| {
            let from = s - 0.4;
            let value = 0.1 - from * from * (1.0 + s);
            gap(value, (-2.0 * from * (1.0 + s) - from * from) / 0.5)
        };
        let part = deepest([&cubic(0.0), &cubic(1.0)], 0.5).expect("a contact");
        assert!((part - 0.4).abs() < 1e-6, "{part}");
        let part = deepest([&gap(-0.2, 1.0), &gap(-0.2, -1.0)], 1.0).expect("a contact");
        assert!((part - 0.5).abs() < 1e-6, "{part}");
        assert_eq!(deepest([&gap(-0.2, 0.6), &gap(-0.2, -0.6)], 1.0), None);
        assert_eq!(deepest([&gap(-0.5, 0.3), &gap(-0.2, 0.3)], 1.0), None);
    }

    /// A point that flies 40 m past a post of 0.1 m, off its middle.
    #[test]
    fn finds_a_thin_post() {
        let at = |x: f64, height: f64, half: f64| Gap {
            load: 0,
            course: Course::Distance {
                point: Vec3::new(x, height, 0.0),
                rate: Vec3::new(20.0, 0.0, 0.0),
                half: Vec3::new(0.0, half, 0.0),
                reach: 0.1,
                side: 1.0,
            },
            onset: -1e-3,
        };
        let part = deepest([&at(-13.0, 0.05, 0.0), &at(27.0, 0.05, 0.0)], 2.0).expect("a contact");
        assert!((part - 13.0 / 40.0).abs() < 1e-6, "{part}");
        assert_eq!(
            deepest([&at(-13.0, 0.2, 0.0), &at(27.0, 0.2, 0.0)], 2.0),
            None
        );
        let long = [&at(-13.0, 0.2, 0.15), &at(27.0, 0.2, 0.15)];
        assert!(deepest(long, 2.0).is_some());
    }
}
