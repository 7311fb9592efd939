//! How much of bodies that deform is shown: all, or fewer sections and faces of large machines.

use crate::model::finite::ElementMesh;
use crate::problem::Outline;
use crate::structures::shell::{ShellKind, ShellNodes};

/// The nodes, or Gauss points, at the corners of the parts of an element: four quarters of nine nodes, or one.
pub(super) fn quarters(kind: ShellKind) -> &'static [[usize; 4]] {
    match kind {
        ShellKind::Mitc9 => &[[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]],
        ShellKind::Mitc4 => &[[0, 1, 3, 2]],
    }
}

/// The nodes at its corners.
pub(super) fn whole(kind: ShellKind) -> &'static [usize; 4] {
    match kind {
        ShellKind::Mitc9 => &[0, 2, 8, 6],
        ShellKind::Mitc4 => &[0, 1, 3, 2],
    }
}

/// Numbers of a rigid body at an instant.
pub(super) const OF_BODY: usize = 9;
/// Numbers of the two sides of a section at an instant.
pub(super) const OF_POINTS: usize = 6;

/// How much of bodies that deform is shown.
pub(super) struct Detail {
    /// Part of the sections of beams; of shells all nodes if it is one, else their corners.
    share: f64,
}

impl Detail {
    /// All, or what keeps the numbers of an instant near `most`.
    pub(super) fn of<'a>(outlines: impl Iterator<Item = &'a Outline>, most: usize) -> Self {
        let all = Self { share: 1.0 };
        let of = |outline: &Outline| match outline {
            Outline::Deformed(line) => OF_POINTS * (line.points.len() / 2),
            other => all.number(other),
        };
        let numbers: usize = outlines.map(of).sum();
        Self {
            share: (most as f64 / numbers.max(1) as f64).min(1.0),
        }
    }

    /// Whether something is left out.
    pub(super) fn is_thinned(&self) -> bool {
        self.share < 1.0
    }

    /// Numbers of all bodies at an instant.
    pub(super) fn numbers<'a>(&self, outlines: impl Iterator<Item = &'a Outline>) -> usize {
        outlines.map(|outline| self.number(outline)).sum()
    }

    /// Numbers of a body at an instant.
    fn number(&self, outline: &Outline) -> usize {
        match outline {
            Outline::Deformed(line) => {
                let sections = self.sections(line.points.len() / 2).len();
                (OF_POINTS * sections).min(OF_BODY + line.coordinates())
            }
            Outline::Shells(line) => 3 * self.nodes(&line.mesh).len(),
            Outline::Hull(_) | Outline::Sphere(_) | Outline::Spokes(_) => OF_BODY,
        }
    }

    /// The sections of `count` that are shown, both ends among them.
    pub(super) fn sections(&self, count: usize) -> Vec<usize> {
        let some = ((count as f64 * self.share).round() as usize).clamp(2.min(count), count);
        let last = count.saturating_sub(1);
        let gaps = some.saturating_sub(1).max(1);
        (0..some).map(|i| i * last / gaps).collect()
    }

    /// The points of both sides at the sections that are shown, of `points` in all: one side, then the other in
    /// opposite order.
    pub(super) fn sides(&self, points: usize) -> Vec<usize> {
        if !self.is_thinned() {
            return (0..points).collect();
        }
        let sections = self.sections(points / 2);
        let back = sections.iter().rev().map(|&k| points - 1 - k);
        sections.iter().copied().chain(back).collect()
    }

    /// The corners of the faces of a shell, four or one, among its nodes.
    pub(super) fn corners(&self, kind: ShellKind) -> &'static [[usize; 4]] {
        match self.is_thinned() {
            true => std::slice::from_ref(whole(kind)),
            false => quarters(kind),
        }
    }

    /// The faces of shells by their nodes.
    pub(super) fn faces(&self, mesh: &ElementMesh) -> Vec<Vec<usize>> {
        let of_element = |nodes: &ShellNodes| -> Vec<Vec<usize>> {
            let each = self.corners(ShellKind::of(nodes)).iter();
            each.map(|own| own.map(|local| nodes[local]).to_vec())
                .collect()
        };
        let mut all: Vec<Vec<usize>> = mesh
            .elements
            .iter()
            .flat_map(|element| of_element(&element.nodes))
            .collect();
        for ends in &mesh.beams {
            all.extend(ends.windows(2).map(|half| half.to_vec()));
        }
        all
    }

    /// The nodes that the faces have, in order.
    pub(super) fn nodes(&self, mesh: &ElementMesh) -> Vec<usize> {
        let mut all: Vec<usize> = self.faces(mesh).into_iter().flatten().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}
