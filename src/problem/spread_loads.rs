//! Loads that are spread over the elements of a body: shares of its nodes, and the forces on its unknowns.

use crate::math::Vec3;
use crate::model::finite::ElementMesh;
use crate::prepared::Prepared;
use crate::schema::Document;
use crate::schema::elements::Elements;
use crate::schema::loads::Load;
use crate::structures::loads::edge_shares;
use crate::structures::mesh::Edge;
use crate::system::loads::normal_shares;
use std::collections::BTreeMap;

/// s_a of the nodes of a load in a fixed direction \[m or m²\]; `None` of another load, or if it names no set.
pub(super) fn dead_shares(own: &Prepared, load: &Load) -> Option<BTreeMap<usize, f64>> {
    let (nodes, sets) = (&own.mesh.nodes, &own.sets);
    match load {
        Load::Area(load) => Some(area_shares(&own.mesh, sets.face_sets.get(&load.faces)?)),
        Load::Edge(load) => Some(edge_shares(nodes, sets.edge_sets.get(&load.edges)?)),
        Load::Line(load) => {
            let beams = sets.beam_sets.get(&load.beams)?.iter();
            let beams: Vec<Edge> = beams.map(|&beam| sets.beams[beam].into()).collect();
            Some(edge_shares(nodes, &beams))
        }
        _ => None,
    }
}

/// ∫ N_a dA of the nodes of some shells \[m²\].
fn area_shares(mesh: &ElementMesh, shells: &[usize]) -> BTreeMap<usize, f64> {
    let mut shares = BTreeMap::new();
    for &shell in shells {
        let element = &mesh.elements[shell];
        for (node, row) in element.nodes.iter().zip(&element.shares) {
            *shares.entry(*node).or_default() += row.iter().sum::<f64>();
        }
    }
    shares
}

/// Forces of unit magnitude on the unknowns of a body, of each load that is spread over it: in all directions of a load whose
/// direction is fixed, as the body may turn, and of a pressure or drag along the normals of the undeformed shells. Loads with faults
/// have none.
pub(super) fn unit_forces(
    document: &Document,
    elements: &Elements,
    own: &Prepared,
) -> Vec<Vec<f64>> {
    let force = |forces: &mut dyn Iterator<Item = (usize, Vec3<f64>)>| {
        let mut out = vec![0.0; own.mesh.coordinates];
        for (node, force) in forces {
            for (k, unknown) in own.mesh.displacements[node].iter().enumerate() {
                if let Some(unknown) = *unknown {
                    out[unknown] += force[k];
                }
            }
        }
        out
    };
    let mut all = Vec::new();
    for load in document.loads.values() {
        let body = match load {
            Load::Pressure(own) => &own.body,
            Load::Area(own) => &own.body,
            Load::Edge(own) => &own.body,
            Load::Line(own) => &own.body,
            Load::Drag(own) if own.faces.is_some() => &own.body,
            _ => continue,
        };
        let of_body = document.bodies.get(body);
        let of_body = of_body.and_then(|body| body.elements.as_ref());
        if !of_body.is_some_and(|of_body| std::ptr::eq(&**of_body, elements)) {
            continue;
        }
        let normal = match load {
            Load::Pressure(load) => Some(&load.faces),
            Load::Drag(load) => load.faces.as_ref(),
            _ => None,
        };
        if let Some(faces) = normal {
            if let Some(shells) = own.sets.face_sets.get(faces) {
                all.push(force(&mut normal_shares(&own.mesh, shells).into_iter()));
            }
            continue;
        }
        let shares = dead_shares(own, load).unwrap_or_default();
        for k in 0..3 {
            let along = |(&node, &share): (&usize, &f64)| {
                let unit = Vec3::from_fn(|i, _| if i == k { share } else { 0.0 });
                (node, unit)
            };
            all.push(force(&mut shares.iter().map(along)));
        }
    }
    all
}
