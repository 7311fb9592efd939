//! The matrices of loads that are spread over elements.

use super::patch::{Patch, Pulled, Virtual};
use super::{Acting, for_each};
use crate::linalg::Emit;
use crate::math::slices::add_scaled;
use crate::math::{Scalar, Vec3};
use crate::system::in_motion::InMotion;
use crate::system::loads::LoadEntries;

/// Derivatives of a row in what moves a body: (rotation, or velocity and angular velocity, of the frame; of each node).
type Derivatives<S> = (Vec<S>, Vec<Vec3<S>>);

/// Those in tangent positions, and in velocities if the load depends on them.
fn derivatives<S: Scalar>(acting: &Acting<S>, by: Pulled<S>) -> [Option<Derivatives<S>>; 2] {
    let in_velocities = (!by.rates.is_empty()).then(|| {
        let linear = acting.rotation * by.linear;
        let frame = linear.iter().chain(by.angular.iter()).copied().collect();
        (frame, by.rates)
    });
    let frame = by.theta.iter().copied().collect();
    [Some((frame, by.nodes)), in_velocities]
}

/// A virtual velocity of one: of a component of the frame, or of a node of the patch.
fn unit<S: Scalar>(row: usize, nodes: usize) -> ([Vec3<S>; 2], Vec<Vec3<S>>) {
    let (mut parts, mut all) = ([Vec3::zeros(); 2], vec![Vec3::zeros(); nodes]);
    match row.checked_sub(6) {
        None => parts[row / 3][row % 3] = S::one(),
        Some(own) => all[own / 3][own % 3] = S::one(),
    }
    (parts, all)
}

/// The derivatives of all forces of a load on a body in a reduced basis: rows and columns are the frame's and those of the coordinates.
struct Sums<S> {
    /// In tangent positions, whose columns of the frame are those of its rotation, and in velocities.
    all: [Vec<S>; 2],
}

/// Columns of the frame in tangent positions and in velocities.
const OF_FRAME: [usize; 2] = [3, 6];

impl<S: Scalar> Sums<S> {
    fn new(m: usize) -> Self {
        Self {
            all: OF_FRAME.map(|frame| vec![S::zero(); (6 + m) * (frame + m)]),
        }
    }

    fn add(
        &mut self,
        acting: &Acting<S>,
        patch: &Patch<S>,
        row: usize,
        by: [Option<Derivatives<S>>; 2],
    ) {
        let m = acting.q.len();
        for (sum, by) in self.all.iter_mut().zip(by) {
            let Some((mut of_row, nodes)) = by else {
                continue;
            };
            let frame = of_row.len();
            of_row.resize(frame + m, S::zero());
            for (&node, x) in patch.nodes.iter().zip(&nodes) {
                acting.add_force(node, x, &mut of_row[frame..]);
            }
            let width = frame + m;
            let mut add = |i: usize, factor: S| {
                add_scaled(&mut sum[i * width..(i + 1) * width], factor, &of_row);
            };
            let Some(own) = row.checked_sub(6) else {
                add(row, S::one());
                continue;
            };
            let vectors = acting.basis.into_iter();
            let vectors = vectors.flat_map(|basis| &basis.vectors);
            let unknown = acting.finite.mesh.displacements[patch.nodes[own / 3]][own % 3];
            if let Some(unknown) = unknown {
                for (i, vector) in vectors.enumerate() {
                    add(6 + i, vector[unknown].into());
                }
            }
        }
    }
}

/// Emits the derivatives of [`add_forces`](super::add_forces) in tangent positions, and of air in velocities.
pub(in crate::system::loads) fn emit_jacobian<S: Scalar>(
    here: &InMotion<S>,
    to: &LoadEntries<S>,
    emit: &mut dyn Emit<S>,
) {
    for_each(here, |_, acting| {
        let frame = here.numbering.velocity(acting.body.frame);
        let elastic = acting.body.places();
        let elastic = elastic.map(|(carrier, k)| here.numbering.velocity(carrier) + k);
        let slots: Vec<usize> = (frame..frame + 6).chain(elastic).collect();
        let columns = [
            slots[3..]
                .iter()
                .map(|slot| to.y + slot)
                .collect::<Vec<_>>(),
            slots.iter().map(|slot| to.v + slot).collect(),
        ];
        let factors = [to.by_y, to.by_v];
        let mut sums = acting.basis.map(|_| Sums::new(acting.q.len()));
        acting.for_each_patch(|patch| {
            for row in 0..6 + 3 * patch.nodes.len() {
                let (parts, nodes) = unit(row, patch.nodes.len());
                let psi = Virtual {
                    linear: acting.rotation.tr_mul(&parts[0]),
                    angular: parts[1],
                    nodes: &nodes,
                };
                let by = derivatives(acting, acting.pull(patch, &psi));
                if let Some(sums) = &mut sums {
                    sums.add(acting, patch, row, by);
                    continue;
                }
                let unknown =
                    |own: usize| acting.finite.mesh.displacements[patch.nodes[own / 3]][own % 3];
                let slot = match row.checked_sub(6) {
                    None => Some(slots[row]),
                    Some(own) => unknown(own).map(|i| slots[6 + i]),
                };
                let Some(slot) = slot else { continue };
                for ((by, columns), factor) in by.into_iter().zip(&columns).zip(factors) {
                    let Some((of_frame, nodes)) = by else {
                        continue;
                    };
                    for (x, column) in of_frame.iter().zip(columns) {
                        emit.add(to.row + slot, *column, *x * factor);
                    }
                    for (own, x) in nodes.iter().flat_map(|x| x.iter()).enumerate() {
                        if let Some(i) = unknown(own) {
                            emit.add(to.row + slot, columns[of_frame.len() + i], *x * factor);
                        }
                    }
                }
            }
        });
        if let Some(Sums { all }) = sums {
            let rows: Vec<usize> = slots.iter().map(|slot| to.row + slot).collect();
            let [y, v] = all;
            emit.add_dense(&rows, &columns[0], to.by_y, &y);
            if acting.moving.is_some() {
                emit.add_dense(&rows, &columns[1], to.by_v, &v);
            }
        }
    });
}
