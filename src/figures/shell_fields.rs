//! Shells and beams of elements in motion as files for ParaView: one for each of some instants, and their list.

use super::shells;
use crate::driver::Simulation;
use crate::functions::snapshot::Snapshot;
use crate::math::Vec3;
use crate::model::flexible::FlexibleBody;
use crate::problem::{BeamFibres, Problem, larger};
use crate::system::flexible::{coordinates, rates};
use crate::vtu::{Fields, pvd, vtu};
use std::path::{Path, PathBuf};

/// Largest number of instants.
const INSTANTS: usize = 101;

/// `fields_0000.vtu` … and `fields.pvd`; nothing if no body has finite elements. The instants have equal
/// numbers of samples between them. All shells and beams are one mesh in ground axes.
pub fn series(
    directory: &Path,
    problem: &Problem,
    simulation: &Simulation,
) -> Vec<(PathBuf, Vec<u8>)> {
    let (model, run) = (&simulation.written.model, simulation.motion());
    if model
        .bodies
        .iter()
        .enumerate()
        .all(|(body, _)| shells::of(model, body).is_none())
    {
        return Vec::new();
    }
    let fibres = problem.fibres(&simulation.at.x);
    let shown = run.shown();
    let last = shown.len() - 1;
    let count = INSTANTS.min(shown.len());
    let mut instants: Vec<usize> = (0..count)
        .map(|i| shown[i * last / (count - 1).max(1)])
        .collect();
    instants.dedup();
    let (mut files, mut list) = (Vec::new(), Vec::new());
    for (i, &k) in instants.iter().enumerate() {
        let name = format!("fields_{i:04}.vtu");
        files.push((
            directory.join(&name),
            vtu(&fields(&Snapshot::of(model, run, k), &fibres)).into_bytes(),
        ));
        list.push((run.time(k), name));
    }
    files.push((directory.join("fields.pvd"), pvd(&list).into_bytes()));
    files
}

/// The value of a stress that is not known: a section without size has none.
pub(super) const UNKNOWN: f64 = -1.0;

/// The fields of all shells and beams at an instant; `fibres` are those of the beams of each body.
fn fields(at: &Snapshot<f64>, fibres: &[Vec<BeamFibres>]) -> Fields {
    let mut fields = Fields::default();
    let (mut displacements, mut velocities) = (Vec::new(), Vec::new());
    let (mut thickness, mut stress, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let (mut along, mut of_beams) = (Vec::new(), Vec::new());
    let motions = at.motions();
    let bodies = at.model.flexible.iter().enumerate();
    let finite = bodies
        .filter_map(|(i, body): (usize, &FlexibleBody<f64>)| Some((i, body, body.form.shells()?)));
    for (i, body, finite) in finite {
        let (mesh, motion) = (&finite.mesh, &motions[body.frame]);
        let unknowns = |of: Vec<f64>| body.form.unknowns(of);
        let q = unknowns(coordinates(body, &motions));
        let rate = unknowns(rates(body, &motions));
        let first = fields.nodes.len();
        for (node, place) in shells::places(mesh, &q).iter().enumerate() {
            let rate = |k: usize| mesh.displacements[node][k].map_or(0.0, |i| rate[i]);
            let own = Vec3::from_fn(|k, _| rate(k));
            let velocity = motion.point_velocity(place) + motion.rotation * own;
            fields.nodes.push(motion.point(place).into());
            displacements.push((motion.rotation * (place - mesh.nodes[node])).into());
            velocities.push(velocity.into());
        }
        let elements = mesh.elements.iter();
        fields
            .shells
            .extend(elements.map(|element| element.nodes.map(|node| first + node)));
        let beams = mesh.beams.iter();
        fields
            .beams
            .extend(beams.map(|beam| beam.map(|node| first + node)));
        along.extend(fibres[body.frame].iter().map(|beam| {
            let largest = beam.largest(&q).into_iter();
            largest.reduce(larger).unwrap_or(UNKNOWN)
        }));
        of_beams.extend(mesh.beams.iter().map(|_| (i + 1) as f64));
        thickness.extend(&finite.thickness);
        let largest = shells::stresses(finite, &q);
        stress.extend(largest.map(|all| all.into_iter().fold(0.0, f64::max)));
        numbers.extend(mesh.elements.iter().map(|_| (i + 1) as f64));
    }
    // Shells come first.
    let name = name_of_stress(fields.shells.is_empty(), &along, "");
    stress.extend(along);
    numbers.extend(of_beams);
    fields.of_elements = vec![
        (name, stress),
        ("number of the flexible body".to_owned(), numbers),
    ];
    if !fields.shells.is_empty() {
        let name = name_of_thickness(fields.beams.is_empty());
        thickness.resize(fields.shells.len() + fields.beams.len(), 0.0);
        fields.of_elements.insert(1, (name.to_owned(), thickness));
    }
    fields.vectors = vec![
        (
            "displacement against the body's axes [m]".to_owned(),
            displacements,
        ),
        ("velocity [m/s]".to_owned(), velocities),
    ];
    fields
}

/// The name of the field of stress: what it is on the shells and on the beams of the mesh. `of` says where it is.
pub(super) fn name_of_stress(no_shells: bool, along: &[f64], of: &str) -> String {
    let kinds = match (no_shells, along.is_empty()) {
        (_, true) => format!("largest von Mises stress{of} [Pa]"),
        (true, false) => format!("largest stress along fibres{of} [Pa]"),
        (false, false) => {
            format!("largest stress{of} [Pa], von Mises of shells and along fibres of beams")
        }
    };
    match along.contains(&UNKNOWN) {
        true => format!("{kinds}, -1 where unknown"),
        false => kinds,
    }
}

/// The name of the field of thickness.
pub(super) fn name_of_thickness(no_beams: bool) -> &'static str {
    match no_beams {
        true => "thickness [m]",
        false => "thickness of shells [m], 0 of beams",
    }
}
