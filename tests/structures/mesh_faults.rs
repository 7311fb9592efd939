//! Faults of meshes are reported with the element or node. Valid meshes have none.

use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::generate::{curved_panel, cylinder, plate};
use flexbody_mechanics::structures::quality::{MeshFault, faults};

#[test]
fn generated_meshes_are_sound_at_any_aspect_ratio() {
    for [nx, ny] in [[1, 1], [3, 40], [17, 2]] {
        for generated in [
            plate([2.0, 0.01], [nx, ny]),
            curved_panel(0.3, 4.0, [0.2, 1.4], [nx, ny]),
            cylinder(0.5, 1.0, [nx + 3, ny]),
        ] {
            assert_eq!(faults(&generated.mesh, &generated.nodes), []);
        }
    }
}

#[test]
fn faults_name_the_element_and_the_node() {
    let sound = plate([1.0, 1.0], [3, 2]);
    let with = |change: &dyn Fn(&mut flexbody_mechanics::structures::generate::Generated<f64>)| {
        let mut generated = sound.clone();
        change(&mut generated);
        faults(&generated.mesh, &generated.nodes)
    };
    let loose = with(&|g| {
        g.mesh.nodes += 1;
        g.nodes.push(Vec3::zeros());
    });
    assert_eq!(loose, [MeshFault::LooseNode { node: 35 }]);
    let unknown = with(&|g| g.mesh.shells[5][8] = 99);
    assert!(unknown.contains(&MeshFault::UnknownNode {
        shell: 5,
        node: 99,
        nodes: 35
    }));
    let twice = with(&|g| g.mesh.shells[0][1] = g.mesh.shells[0][0]);
    assert!(twice.contains(&MeshFault::RepeatedNode { shell: 0, node: 0 }));
    let unreal = with(&|g| g.nodes[3].y = f64::NAN);
    assert_eq!(unreal, [MeshFault::NoPlace { node: 3 }]);
    // A corner that crosses the opposite one folds its element.
    let folded = with(&|g| g.nodes[0] = Vec3::new(0.5, 0.8, 0.0));
    assert!(
        matches!(folded[..], [MeshFault::Inverted { shell: 0, .. }]),
        "{folded:?}"
    );
    let middle = with(&|g| g.nodes[1].x = 0.09);
    assert!(
        matches!(
            middle[..],
            [MeshFault::MiddleNode {
                shell: 0,
                local: 1,
                ..
            }]
        ),
        "{middle:?}"
    );
    // The second element is wound in reverse: rows of nodes in reverse order.
    let wound = with(&|g| {
        let old = g.mesh.shells[1];
        g.mesh.shells[1] = [2, 1, 0, 5, 4, 3, 8, 7, 6].map(|k| old[k]).into();
    });
    assert!(
        wound.contains(&MeshFault::OppositeNormals {
            first: 0,
            second: 1
        }),
        "{wound:?}"
    );
}

/// Where a web stands on the edge of two elements, these are one sheet as well.
#[test]
fn opposite_elements_below_a_web_are_found() {
    let web = |reversed: bool| {
        let mut g = plate([1.0, 1.0], [2, 1]);
        let edge = [2, 5, 8].map(|k| g.mesh.shells[0][k]);
        let first = g.nodes.len();
        for row in [0.25, 0.5] {
            let above = edge.map(|k| g.nodes[k] + Vec3::new(0.0, 0.0, row));
            g.nodes.extend(above);
        }
        g.mesh.nodes = g.nodes.len();
        let row = |k: usize| [0, 1, 2].map(|i| first + 3 * k + i);
        let [[a, b, c], [d, e, f], [h, i, j]] = [edge, row(0), row(1)];
        g.mesh.shells.push([a, b, c, d, e, f, h, i, j].into());
        if reversed {
            let old = g.mesh.shells[1];
            g.mesh.shells[1] = [2, 1, 0, 5, 4, 3, 8, 7, 6].map(|k| old[k]).into();
        }
        faults(&g.mesh, &g.nodes)
    };
    assert_eq!(web(false), []);
    let (first, second) = (0, 1);
    assert_eq!(web(true), [MeshFault::OppositeNormals { first, second }]);
}
