//! What files of Gmsh may have wrong.

use super::plate::{Format, PLAIN, plate};
use super::{SIZE, at_rest, parsed};

/// What a file may have wrong, by line.
#[test]
fn faults_are_told_by_line() {
    let good = plate(
        SIZE,
        [2, 1],
        Format {
            version: "2.2",
            ..PLAIN
        },
    );
    let file = at_rest(json!({"gmsh": {"file": "a.msh"}}));
    assert!(parsed(&file, &[("a.msh", &good)]).is_ok());
    let quad = good
        .lines()
        .find(|line| line.contains(" 10 2 "))
        .expect("a quadrangle");
    let words: Vec<&str> = quad.split(' ').collect();
    let of = |kind: &str, nodes: &[usize]| {
        let nodes: Vec<&str> = nodes.iter().map(|&k| words[5 + k]).collect();
        format!("{} {kind} 2 1 1 {}", words[0], nodes.join(" "))
    };
    let swapped = of("10", &[0, 2, 1, 3, 4, 5, 6, 7, 8]);
    // The middle of the first edge, from 0 to 0.3.
    let middle = format!(
        "
{} 0.15 0 0
",
        words[5 + 4]
    );
    assert!(good.contains(&middle));
    let shifted = good.replace(&middle, &middle.replace("0.15", "0.084"));
    let cases: [(String, &[&str]); 16] = [
        (String::new(), &["an empty file", "$MeshFormat"]),
        (
            good.replace(&middle, &middle.replace(" 0\n", " 0 0.5\n")),
            &["\"0.5\"", "the end of the line after 4 numbers"],
        ),
        (
            good.replace("2.2 0 8", "4.0 0 8"),
            &["MSH version \"4.0\"", "a.msh:2:1", "-format msh41"],
        ),
        (
            good.replace("2.2 0 8", "2.2 1 8"),
            &["binary", "Mesh.Binary = 0"],
        ),
        (
            good.replace(quad, &of("9", &[0, 1, 2, 4, 5, 6])),
            &["six-node triangle", "Mesh.RecombineAll"],
        ),
        (
            good.replace(quad, &of("4", &[0, 1, 2, 3])),
            &["tetrahedron", "gmsh -2"],
        ),
        (good.replace(quad, &of("36", &[0, 1, 2, 3])), &["kind 36"]),
        (
            good.replace(quad, &of("10", &[0, 1, 2, 3])),
            &["4 nodes", "9 nodes"],
        ),
        (
            good.replace(quad, &of("3", &[0, 1, 2, 3])),
            &["of 4 nodes", "elements of one order"],
        ),
        (good.replace(quad, &swapped), &["is inverted or folded"]),
        (shifted, &["is the order of the nodes right?"]),
        (
            good.replace(quad, &format!("{quad}x")),
            &["the number of a node"],
        ),
        (
            good.replace("\"x1\"", "\"x0\""),
            &["the name \"x0\" of group 2"],
        ),
        (
            good.replace("\"x1\"", "\"all\""),
            &["the name \"all\" of group 2"],
        ),
        (
            good.replace("$EndElements\n", ""),
            &["the end of the file", "$EndElements"],
        ),
        (
            good.split("$Elements").next().unwrap_or("").to_owned(),
            &["a section $Elements"],
        ),
    ];
    for (text, expected) in &cases {
        let faults = parsed(&file, &[("a.msh", text)]).err().unwrap_or_default();
        for part in *expected {
            assert!(faults.contains(part), "{part:?} is not in:\n{faults}");
        }
    }
    let missing = parsed(&file, &[]).expect_err("no file");
    assert!(
        missing.contains("no file") && missing.contains("/mesh/gmsh/file"),
        "{missing}"
    );
    let mut sets = file.clone();
    sets["structures"]["plate"]["sets"] = json!({"middle": {"node": {"at": [0.5, 0.5]}}});
    let faults = parsed(&sets, &[("a.msh", &good)]).expect_err("a set by its place");
    assert!(faults.contains("a physical group of the file"), "{faults}");
    let mut bands = file.clone();
    bands["structures"]["plate"]["thickness"] = json!({"per": "band", "value": 0.01});
    let faults = parsed(&bands, &[("a.msh", &good)]).expect_err("bands");
    assert!(faults.contains("\"element\" or \"group\""), "{faults}");
    // Faults of the document come before its files.
    let mut misspelt = file.clone();
    misspelt["structures"]["plate"]["thicknes"] = json!(0.01);
    let faults = parsed(&misspelt, &[]).expect_err("a misspelt key");
    assert!(
        faults.contains("thicknes") && !faults.contains("no file"),
        "{faults}"
    );
}
