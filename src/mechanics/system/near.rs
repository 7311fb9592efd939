//! Which contacts between bodies may touch: those whose spheres around both bodies meet.
//!
//! The spheres are sorted by their reach along the axis in which the bodies are spread most, and only pairs that overlap there are
//! looked at (sweep and prune: Cohen, Lin, Manocha & Ponamgi 1995). A contact that is left out has no force and no derivative.

use crate::math::{Scalar, Vec3, scalar::length};
use crate::model::{Contact, LoadKind, Model, Shape, Surface};

/// Fewer contacts between bodies than this are all looked at.
const FEW: usize = 50;

/// The contacts between bodies of a model, by pairs.
#[derive(Clone, Debug, PartialEq)]
pub struct Near {
    /// All other loads.
    always: Vec<usize>,
    /// Of each body: a radius about its origin that holds its contacts and half of the widths of their onsets; `None` without
    /// contacts.
    reach: Vec<Option<f64>>,
    /// Of each body: the bodies of a higher number that it may touch, each with its load, in order.
    partners: Vec<Vec<(usize, usize)>>,
}

/// The bodies of a contact between two, each with its reach; `None` if a surface is unbounded or ground's.
fn pair<S: Scalar>(own: &Contact<S>) -> Option<[(usize, f64); 2]> {
    let size = |x: &Vec3<S>| length(x).re();
    let (radius, more) = match &own.surface {
        Surface::Plane { .. } | Surface::Field { .. } => return None,
        Surface::Sphere { radius } => (radius, 0.0),
        Surface::Capsule { half, radius } => (radius, size(half)),
        Surface::Box { halves, radius } => (radius, halves.iter().map(size).sum()),
    };
    let around = match &own.shape {
        Shape::Sphere => 0.0,
        Shape::Wheel { radius, .. } => radius.re(),
        Shape::Capsule { half, .. } => size(half),
    };
    let of_a = size(&own.point_a) + own.radius.re() + around + 0.5 * own.law.width.re();
    let of_b = size(&own.point_b) + radius.re() + more;
    Some([(own.body_a, of_a), (own.body_b?, of_b)])
}

impl Near {
    /// The pairs of a model; `None` if it has few.
    pub fn new<S: Scalar>(model: &Model<S>) -> Option<Self> {
        let of = |load: &crate::model::Load<S>| match &load.kind {
            LoadKind::Contact(own) => pair(own),
            _ => None,
        };
        if model.loads.iter().filter_map(of).count() <= FEW {
            return None;
        }
        let mut own = Self {
            always: Vec::new(),
            reach: vec![None; model.bodies.len()],
            partners: vec![Vec::new(); model.bodies.len()],
        };
        for (i, load) in model.loads.iter().enumerate() {
            let Some(pair) = of(load) else {
                own.always.push(i);
                continue;
            };
            for (body, reach) in pair {
                let known = own.reach[body].get_or_insert(0.0);
                *known = known.max(reach);
            }
            let [a, b] = pair.map(|(body, _)| body);
            own.partners[a.min(b)].push((a.max(b), i));
        }
        own.partners.iter_mut().for_each(|all| all.sort_unstable());
        Some(own)
    }

    /// The loads that may act where the bodies have these places, in order; every body's reach grows by what it may `move` besides.
    pub fn loads(
        &self,
        place: impl Fn(usize) -> Vec3<f64>,
        moves: impl Fn(usize) -> f64,
    ) -> Vec<usize> {
        let mut balls: Vec<(usize, Vec3<f64>, f64)> = Vec::new();
        for (body, reach) in self.reach.iter().enumerate() {
            if let Some(reach) = reach {
                balls.push((body, place(body), reach + moves(body)));
            }
        }
        let spread = |i: usize| {
            let all = balls.iter().map(|own| own.1[i]);
            let ends = all.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
            ends.1 - ends.0
        };
        let widest = (0..3).max_by(|&i, &k| spread(i).total_cmp(&spread(k)));
        let axis = widest.unwrap_or(0);
        let start = |own: &(usize, Vec3<f64>, f64)| own.1[axis] - own.2;
        balls.sort_unstable_by(|a, b| start(a).total_cmp(&start(b)));
        let mut found = self.always.clone();
        for (k, (a, at, reach)) in balls.iter().enumerate() {
            let end = at[axis] + reach;
            // A place that is not a number is near to all.
            let apart = |own: &(usize, Vec3<f64>, f64)| start(own) > end;
            let rest = balls[k + 1..].iter();
            for (b, other, more) in rest.take_while(|own| !apart(own)) {
                if (at - other).norm_squared() > (reach + more) * (reach + more) {
                    continue;
                }
                let all = &self.partners[*a.min(b)];
                let first = all.partition_point(|own| own.0 < *a.max(b));
                let same = all[first..].iter().take_while(|own| own.0 == *a.max(b));
                found.extend(same.map(|own| own.1));
            }
        }
        found.sort_unstable();
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exactly the pairs whose spheres meet, of 60 bodies at random places.
    #[test]
    fn finds_all_pairs_that_meet() {
        let count = 60;
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / f64::from(1_u32 << 31)
        };
        let places: Vec<Vec3<f64>> = (0..count)
            .map(|_| Vec3::new(next(), 2.0 * next(), next()))
            .collect();
        let reach: Vec<f64> = (0..count).map(|_| 0.2 * next()).collect();
        let mut partners = vec![Vec::new(); count];
        let mut exact = vec![0, 1];
        let mut load = 2;
        for a in 0..count {
            for b in a + 1..count {
                partners[a].push((b, load));
                if (places[a] - places[b]).norm() <= reach[a] + reach[b] {
                    exact.push(load);
                }
                load += 1;
            }
        }
        assert!(exact.len() > 30, "{}", exact.len());
        let near = Near {
            always: vec![0, 1],
            reach: reach.iter().map(|own| Some(*own)).collect(),
            partners,
        };
        assert_eq!(near.loads(|body| places[body], |_| 0.0), exact);
        assert!(near.loads(|body| places[body], |_| 0.1).len() > exact.len());
    }
}
