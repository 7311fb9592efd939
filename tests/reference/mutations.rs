//! Random changes of problem files with structures and flexible bodies: each is read, and analysed if it is sound.
//! Nothing that a file says may make the program panic. The tests try some hundred changes, `cargo bench --bench
//! mutations` tries as many as asked.

use flexbody::{Analysis, Problem};
use serde_json::Value;
use std::path::Path;

/// Structures at rest: shells and beams with every kind of set, support, load and function.
const AT_REST: [&str; 3] = [
    r#"{"version": 1, "name": "plates", "materials": {
        "steel": {"young": 2.1e11, "poisson": 0.3, "density": 7850, "yield_stress": 2.35e8}, "al": {"young": 7e10, "poisson": 0.33, "density": 2700, "yield_stress": 2e8}},
      "structures": {
        "plate": {"mesh": {"plate": {"length": 1, "width": 0.5, "elements": [2, 2]}}, "material": "steel",
          "thickness": {"per": "group", "groups": ["left", "all"], "values": [0.01, 0.012]}, "surface_mass": 1,
          "sets": {"mid": {"node": {"at": [0.5, 0.5]}}, "left": {"elements": {"from": [0, 0], "to": [0.5, 1]}}},
          "supports": {"clamp": {"nodes": ["x0"]}, "slide": {"nodes": ["x1y0"], "held": ["x", "rz"]}},
          "masses": {"box": {"nodes": "mid", "mass": 2, "inertia": [0.1, 0.1, 0.1, 0, 0, 0]}}},
        "roof": {"mesh": {"curved_panel": {"radius": 2, "length": 1, "angles": [0.2, 0.6], "elements": [1, 2]}}, "material": "al", "at": [0, 3, 0],
          "thickness": {"per": "band", "along": "y", "bands": 2, "values": [0.01, 0.02]}, "supports": {"clamp": {"nodes": ["x0", "x1"]}}},
        "tube": {"mesh": {"cylinder": {"radius": 0.3, "length": 1, "elements": [3, 1]}}, "material": "al", "at": [5, 0, 0], "thickness": 0.01,
          "supports": {"clamp": {"nodes": ["y0"]}}},
        "flap": {"mesh": {"panel": {"points": [[0, 0, 0], [1, 0, 0], [0, 1, 0.1], [1, 1, 0]], "elements": [2, 2]}}, "material": "al", "at": [0, 0, 5],
          "thickness": {"per": "patch", "patches": [2, 1], "value": 0.01}, "supports": {"clamp": {"nodes": ["x0"]}}}},
      "load_cases": {
        "tip": {"edge": {"edge": {"edges": "plate.x1", "force": [0, 0, -400]}}, "corner": {"point": {"nodes": "plate.x1y1", "force": [0, 0, -50], "moment": [1, 2, 0]}}},
        "wind": {"all": {"pressure": {"faces": "all", "pressure": 100}}, "left": {"area": {"faces": "plate.left", "force": [1, 0, 2]}}, "own": {"gravity": {"acceleration": [0, 0, -9.81]}}}},
      "functions": {"mass": "mass", "stress": {"von_mises": {"rho": 50, "cases": ["tip", "wind"]}}, "one": {"von_mises": {"rho": 50, "aggregate": "induced_exponential", "elements": "plate.left"}},
        "w": {"displacement": {"case": "tip", "nodes": "plate.x1", "direction": [0, 0, 1]}}, "u": {"strain_energy": {"case": "tip"}}, "c": {"compliance": {"case": "wind"}},
        "r": {"reaction": {"case": "tip", "nodes": "plate.x0", "direction": [0, 0, 1]}}, "m": {"reaction_moment": {"case": "tip", "nodes": "plate.x0", "axis": [0, 1, 0], "about": [0, 0, 0]}},
        "f": {"frequency": {"mode": 1}}, "l": {"lowest_frequency": {"rho": 0.5}}, "cx": {"centre_of_mass": {"direction": [1, 0, 0]}}, "j": {"moment_of_inertia": {"axis": [0, 0, 1], "other": [1, 0, 0]}}},
      "variables": {"t": {"path": "/structures/tube/thickness", "lower": 0.005, "upper": 0.03}, "patches": {"path": "/structures/flap/thickness/value", "lower": 0.005, "upper": 0.03}},
      "objective": {"minimise": "mass"}, "constraints": {"stress": {"function": "stress", "upper": 1}}}"#,
    r#"{"version": 1, "name": "frame", "materials": {"steel": {"young": 2.1e11, "poisson": 0.3, "density": 7850}},
      "statics": {"strains": "von_karman", "node_unknowns": "six"},
      "structures": {"portal": {"mesh": {"frame": {
          "points": {"a": [0, 0, 0], "b": [0, 0, 1], "c": [1, 0, 1], "d": [1, 0, 0]},
          "members": {"left": {"between": ["a", "b"], "orientation": [0, 1, 0], "elements": 2}, "top": {"between": ["b", "c"], "orientation": [0, 1, 0], "elements": 2}, "right": {"between": ["c", "d"], "orientation": [0, 1, 0], "elements": 1}}}},
        "material": "steel", "line_mass": 0.1, "offset": [0.01, 0],
        "sections": {"per": "group", "groups": ["left", "top", "right"], "values": [{"tube": {"radius": 0.02, "wall": 0.002}}, {"i": {"width": 0.05, "height": 0.06, "flange": 0.004, "web": 0.003}}, {"rectangle": {"width": 0.03, "height": 0.04}}]},
        "supports": {"feet": {"nodes": ["a"]}, "foot": {"nodes": ["d"], "held": ["x", "y", "z"]}}, "masses": {"load": {"nodes": "c", "mass": 10}}}},
      "load_cases": {"push": {"point": {"point": {"nodes": "b", "force": [100, 0, 0]}}, "snow": {"line": {"beams": "top", "force": [0, 0, -50]}}}},
      "functions": {"mass": "mass", "u": {"displacement": {"case": "push", "nodes": "b", "direction": [1, 0, 0]}}, "f": {"frequency": {"mode": 2}}, "r": {"reaction": {"case": "push", "nodes": "a", "direction": [0, 0, 1]}}},
      "variables": {"radius": {"path": "/structures/portal/sections/values/0/tube/radius", "lower": 0.01, "upper": 0.04}, "height": {"paths": ["/structures/portal/mesh/frame/points/b/2", "/structures/portal/mesh/frame/points/c/2"], "lower": 0.5, "upper": 2}},
      "objective": {"minimise": "mass"}, "constraints": {"stiff": {"function": "u", "lower": -0.01, "upper": 0.01}}}"#,
    r#"{"version": 1, "name": "beams", "materials": {"al": {"young": 7e10, "poisson": 0.3, "density": 2700}},
      "structures": {
        "boom": {"mesh": {"straight_beam": {"from": [0, 0, 0], "to": [1, 0, 0], "orientation": [0, 0, 1], "elements": 2}}, "material": "al",
          "sections": {"per": "element", "value": {"tube": {"radius": 0.02, "wall": 0.002}}}, "supports": {"root": {"nodes": ["start"]}}},
        "hook": {"mesh": {"curved_beam": {"radius": 0.5, "angles": [0, 1.5], "elements": 2}}, "material": "al", "at": [0, 2, 0],
          "section": {"given": {"axial_and_shear": [1e6, 1e5, 1e5], "torsion_and_bending": [10, 20, 30], "mass": 1, "inertia": [1e-4, 1e-4]}}, "supports": {"root": {"nodes": ["start"]}}}},
      "load_cases": {"tip": {"force": {"point": {"nodes": "boom.end", "force": [0, 0, -10]}}, "line": {"line": {"beams": "all", "force": [0, 1, 0]}}}},
      "functions": {"w": {"displacement": {"case": "tip", "nodes": "boom.end", "direction": [0, 0, 1]}}, "c": {"compliance": {"case": "tip"}}},
      "variables": {"wall": {"path": "/structures/boom/sections/value/tube/wall", "lower": 0.001, "upper": 0.01}},
      "objective": {"minimise": "c"}}"#,
];

/// Bodies that deform: shells with a stiffener, beams of elements, a beam of functions, a body of files.
const IN_MOTION: [&str; 3] = [
    r#"{"version": 1, "name": "wing", "gravity": [0, 0, -9.81],
      "materials": {"al": {"young": 7e10, "poisson": 0.3, "density": 2700, "yield_stress": 2e8}},
      "bodies": {
        "wing": {"elements": {"structure": {"mesh": {"plate": {"length": 0.6, "width": 0.2, "elements": [2, 1]}}, "material": "al", "thickness": 0.004,
            "damping": {"stiffness": 1e-4, "mass": 0.1}, "sets": {"tip": {"node": {"at": [1, 0.5]}}, "half": {"elements": {"from": [0, 0], "to": [0.5, 1]}}}, "masses": {"pod": {"nodes": "x1y0", "mass": 0.2}}},
          "stiffeners": {"spar": {"along": "x", "at": 1, "section": {"rectangle": {"width": 0.01, "height": 0.02}}, "offset": [0, 0.012]}},
          "frame": {"clamped": "x0"}, "basis": {"reduced": {"interfaces": ["root", "tip"], "modes": 2}}, "points": {"root": {"edge": "x0"}, "tip": {"node": "tip"}}},
          "place": {"put": "root", "at": [0, 0, 1]}},
        "ball": {"shape": {"sphere": {"radius": 0.05}}, "density": 500, "place": {"at": "wing.tip"}}},
      "joints": {"hinge": {"revolute": {"between": ["wing", "ground"], "at": "wing.root", "axis": [0, 1, 0]}}, "hang": {"spherical": {"between": ["ball", "wing"], "at": "wing.tip"}}},
      "loads": {"p": {"pressure": {"body": "wing", "faces": "half", "pressure": 20}}, "a": {"area": {"body": "wing", "faces": "all", "direction": [0, 0, 1], "magnitude": 3}},
        "e": {"edge": {"body": "wing", "edges": "x1", "direction": [0, 0, 1], "magnitude": {"harmonic": {"amplitude": 1, "frequency": 2}}}}, "f": {"force": {"body": "wing", "point": "tip", "direction": [1, 0, 0], "axes": "body", "magnitude": 1}}},
      "simulation": {"duration": 0.01, "steps": 3, "seconds": 2, "method": {"bdf": {"order": 2}}},
      "functions": {"stress": {"ks": {"rho": 20, "of": {"von_mises": {"body": "wing", "rho": 30, "elements": "half"}}}}, "force": {"final": {"section_force": {"body": "wing", "beams": "spar", "station": 0.5, "component": "bending_y"}}},
        "fibre": {"ks": {"rho": 1e-6, "of": {"largest_fibre_stress": {"body": "wing", "beams": "spar", "stations": 3, "rho": 1e-6}}}}, "u": {"final": {"elastic_displacement": {"body": "wing", "point": "tip", "direction": [0, 0, 1]}}}, "mass": "mass"},
      "variables": {"t": {"path": "/bodies/wing/elements/structure/thickness", "lower": 0.002, "upper": 0.01}, "h": {"path": "/bodies/wing/elements/stiffeners/spar/section/rectangle/height", "lower": 0.01, "upper": 0.05}},
      "objective": {"minimise": "mass"}, "constraints": {"strong": {"function": "stress", "upper": 1}}, "plot": {"trace": ["wing.tip"]}}"#,
    r#"{"version": 1, "name": "arms", "gravity": [0, -9.81, 0],
      "materials": {"al": {"young": 7e10, "poisson": 0.3, "density": 2700}},
      "bodies": {
        "arm": {"elements": {"structure": {"mesh": {"straight_beam": {"from": [0, 0, 0], "to": [0.6, 0, 0], "orientation": [0, 0, 1], "elements": 2}}, "material": "al", "section": {"tube": {"radius": 0.01, "wall": 0.002}}},
          "frame": {"clamped": "start"}, "inertia": "full", "points": {"a": {"node": "start"}, "z": {"node": "end"}}}, "place": {"put": "a", "at": [0, 0, 0]}},
        "rod": {"beam": {"length": 0.5, "section": {"rectangle": {"width": 0.01, "height": 0.02}}, "material": {"young": 7e10, "poisson": 0.3, "density": 2700}, "modes": {"bending_y": 1, "bending_z": 2, "torsion": 1, "stretch": 1},
          "stations": {"middle": 0.5}, "damping": {"ratio": 0.01}, "start": {"coordinates": [0, 0, 0, 0, 0]}}, "place": {"put": "start", "at": "arm.z"}}},
      "joints": {"root": {"revolute": {"between": ["arm", "ground"], "at": "arm.a", "axis": [0, 0, 1]}}, "elbow": {"revolute": {"between": ["rod", "arm"], "at": "arm.z", "axis": [0, 0, 1]}}},
      "loads": {"t": {"torque": {"body": "rod", "point": "middle", "direction": [0, 0, 1], "magnitude": 0.1}}, "l": {"line": {"body": "arm", "beams": "all", "direction": [0, 1, 0], "magnitude": 2}}, "s": {"spring": {"between": ["rod", "ground"], "at": {"a": "end", "b": [1, 1, 0]}, "rest_length": 0.5, "stiffness": 10}}},
      "drives": {"turn": {"joint": "root", "turn": {"harmonic": {"amplitude": 0.1, "frequency": 1}}}},
      "simulation": {"duration": 0.01, "steps": 2, "seconds": 2, "method": {"radau": {"stages": 2}}},
      "functions": {"sf": {"final": {"section_force": {"body": "arm", "beams": "all", "station": 0.5, "component": "axial"}}}, "bend": {"ks": {"rho": 1, "of": {"largest_section_force": {"body": "rod", "stations": ["start", 0.3, "middle"], "component": "bending_z", "sign": "both", "rho": 1}}}},
        "fs": {"final": {"fibre_stress": {"body": "rod", "station": "middle", "fibre": [1, -1]}}}, "se": {"integral": {"strain_energy": {"body": "rod"}}}, "jf": {"ks": {"rho": 1, "of": {"joint_force": {"joint": "elbow", "direction": [1, 0, 0]}}}}, "y": {"final": {"position": {"body": "rod", "point": "end", "direction": [0, 1, 0]}}}},
      "variables": {"wall": {"path": "/bodies/arm/elements/structure/section/tube/wall", "lower": 0.001, "upper": 0.005}, "width": {"path": "/bodies/rod/beam/section/rectangle/width", "lower": 0.005, "upper": 0.02}},
      "objective": {"minimise": "se"}, "constraints": {"y": {"function": "y", "upper": 1}}}"#,
    r#"{"version": 1, "name": "files", "gravity": [0, -9.81, 0],
      "bodies": {"b": {"modal": {"source": {"matrix_market": {"nodes": "beam.nodes", "stiffness": "beam_k.mtx", "mass": "beam_m.mtx", "units": {"length": 1, "mass": 1, "time": 1}}},
          "interfaces": {"a": 1, "m": [10, 11], "z": 21}, "frame": {"chord": ["a", "z"]}, "modes": 3, "scale": 1, "young_factor": 1, "density_factor": 1, "damping": {"ratio": 0.02, "stiffness": 1e-5}}, "place": {"put": "a", "at": [0, 0, 0]}}},
      "joints": {"h": {"revolute": {"between": ["b", "ground"], "at": "b.a", "axis": [0, 0, 1]}}},
      "loads": {"f": {"force": {"body": "b", "point": "z", "direction": [0, 1, 0], "magnitude": {"table": {"times": [0, 1], "values": [0, 1]}}}}, "d": {"damping": {"joint": "h", "coefficient": 0.1}}},
      "simulation": {"duration": 0.01, "steps": 3, "seconds": 2, "method": {"generalised_alpha": {"radius": 0.8}}},
      "functions": {"u": {"ks": {"rho": 100, "of": {"elastic_displacement": {"body": "b", "point": "z", "direction": [0, 1, 0]}}}}, "e": {"final": {"strain_energy": {"body": "b"}}}, "x": {"final": {"position": {"body": "b", "point": "m", "direction": [1, 0, 0]}}}},
      "variables": {"size": {"path": "/bodies/b/modal/scale", "lower": 0.8, "upper": 1.2}},
      "objective": {"minimise": "e"}}"#,
];

/// Values that take the place of others.
const OTHERS: [&str; 16] = [
    "null",
    "true",
    "0",
    "-1",
    "1",
    "3",
    "0.5",
    "1e-12",
    "1e9",
    "1e300",
    "\"x\"",
    "\"all\"",
    "[]",
    "{}",
    "[0, 0, 0]",
    r#"{"x": 1}"#,
];

/// The sound files.
pub(crate) fn sound() -> Vec<Value> {
    let all = AT_REST.iter().chain(&IN_MOTION);
    all.map(|text| serde_json::from_str(text).expect("JSON"))
        .collect()
}

/// Random numbers (xorshift), the same in every run.
pub(crate) struct Random(pub u64);

impl Random {
    fn next(&mut self, below: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % below.max(1)
    }
}

/// Pointers to all values below a value.
fn pointers(value: &Value, at: &str, list: &mut Vec<String>) {
    let mut below = |key: &str, value: &Value| {
        let key = key.replace('~', "~0").replace('/', "~1");
        let pointer = format!("{at}/{key}");
        list.push(pointer.clone());
        pointers(value, &pointer, list);
    };
    match value {
        Value::Object(all) => all.iter().for_each(|(key, value)| below(key, value)),
        Value::Array(all) => {
            (all.iter().enumerate()).for_each(|(k, value)| below(&k.to_string(), value))
        }
        _ => {}
    }
}

/// Makes one to three random changes of a file.
pub(crate) fn mutated(sound: &Value, random: &mut Random) -> Value {
    let mut out = sound.clone();
    for _ in 0..=random.next(3) {
        change(&mut out, random);
    }
    out
}

/// One random change: another value, a value of elsewhere, a number times a factor, an entry left out, doubled or
/// renamed.
fn change(document: &mut Value, random: &mut Random) {
    let mut list = Vec::new();
    pointers(document, "", &mut list);
    let pointer = list[random.next(list.len())].clone();
    let elsewhere = document.pointer(&list[random.next(list.len())]).cloned();
    let other = serde_json::from_str(OTHERS[random.next(OTHERS.len())]).expect("JSON");
    let factor = [-1.0, 2.0, 0.5, 1e-6, 1e6][random.next(5)];
    let what = random.next(8);
    let (above, key) = pointer.rsplit_once('/').expect("a pointer has a slash");
    let Some(place) = document.pointer_mut(&pointer) else {
        return;
    };
    let number = place.as_f64();
    match (what, number) {
        (0, Some(x)) => *place = Value::from(x * factor),
        (0 | 1, _) => *place = other,
        (2 | 3, _) => *place = elsewhere.unwrap_or(other),
        (_, Some(x)) if what == 4 => *place = Value::from(x * factor),
        _ => match document.pointer_mut(above) {
            Some(Value::Object(all)) if what == 5 => {
                let kept = all.shift_remove(key);
                all.insert("x".into(), kept.unwrap_or(Value::Null));
            }
            Some(Value::Object(all)) => {
                all.shift_remove(key);
            }
            Some(Value::Array(all)) if what == 5 => {
                let k: usize = key.parse().unwrap_or(0);
                let copy = all[k].clone();
                all.push(copy);
            }
            Some(Value::Array(all)) => {
                all.remove(key.parse().unwrap_or(0));
            }
            _ => {}
        },
    }
}

/// What became of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Faults, each with a text.
    Refused,
    /// Sound, but its analysis failed with a reason.
    Failed,
    /// Sound and analysed.
    Analysed,
}

/// Reads a file; if it is sound, analyses its start with gradients.
pub(crate) fn tried(document: &Value) -> Outcome {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/modal/mutated.json");
    let problem = match Problem::parse(&document.to_string(), &place.display().to_string(), &[]) {
        Ok(problem) => problem,
        Err(faults) => {
            assert!(!faults.list.is_empty() && !faults.to_string().is_empty());
            return Outcome::Refused;
        }
    };
    let all: Vec<usize> = (0..problem.functions().len()).collect();
    let start = problem.start();
    let found = Analysis::new(&problem).at(&start).and_then(|at| {
        let values = at.values();
        at.gradients(&all).map(|gradients| (values, gradients))
    });
    match found {
        Ok(_) => Outcome::Analysed,
        Err(failure) => {
            assert!(!failure.to_string().is_empty());
            Outcome::Failed
        }
    }
}
