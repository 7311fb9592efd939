//! Cases of closed loops: passages through singular positions, tolerances, and scenes whose motion
//! must not depend on order, units and axes.

use super::case::{Case, Judge, SceneFile, Steps, TOLERANCE, Way, decade, usual};
use super::exact::Exact;
use super::scenes::{
    BRICARD, FOUR_BARS_1, FOUR_BARS_2, FOUR_BARS_10, GOVERNOR, LOCKING, PARALLELOGRAM,
    SLIDER_CRANK, SQUEEZER,
};
use crate::integrate::Method;
use crate::math::{Mat3, Vec3, rotation};
use serde_json::{Map, Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

/// A scene with closed loops whose functions are lengths and speeds.
struct Looped {
    name: &'static str,
    scene: SceneFile,
    method: Option<Method>,
    /// Duration \[s\].
    duration: f64,
    /// Body whose mass is the variable.
    mass: &'static str,
    /// Functions that replace those of the file, if any.
    functions: &'static str,
    judge: Judge,
}

fn looped() -> [Looped; 6] {
    let own = |name, scene, duration, mass, judge| Looped {
        name,
        scene,
        method: None,
        duration,
        mass,
        functions: "",
        judge,
    };
    // Compared with the unchanged file. Errors are relative to this size [m].
    let as_it_is = |size| Judge::OtherMethod { kept: 2, size };
    let (bricard, cells) = (Judge::Exact(Exact::Bricard), 2);
    let four_bars = Judge::Exact(Exact::FourBars { cells, time: 2.0 });
    [
        own("bricard", BRICARD, 10.0, "rod 4", bricard),
        own("four bars", FOUR_BARS_2, 2.0, "bar 1", four_bars),
        own("locking linkage", LOCKING, 0.1, "coupler", as_it_is(0.3)),
        Looped {
            functions: r#"{"x":{"final":{"position":{"body":"K3","point":"E","direction":[1,0,0]}}},"y":{"final":{"position":{"body":"K3","point":"E","direction":[0,1,0]}}}}"#,
            ..own("squeezer", SQUEEZER, 0.03, "K5", as_it_is(0.03))
        },
        Looped {
            functions: r#"{"shaking":{"final":{"position":{"body":"frame","direction":[1,0,0]}}}}"#,
            ..own("slider-crank", SLIDER_CRANK, 0.5, "rod", as_it_is(0.1))
        },
        Looped {
            method: Some(Method::Radau { stages: 3 }),
            ..own("governor", GOVERNOR, 0.1, "right arm", as_it_is(1.0))
        },
    ]
}

impl Looped {
    /// The file with its variable, its functions, and explicit gravity.
    fn file(&self) -> Value {
        let mut file: Value = serde_json::from_str(self.scene.text).unwrap_or_default();
        if let Ok(functions) = serde_json::from_str(self.functions) {
            file["functions"] = functions;
        }
        let path = format!("/bodies/{}/mass", self.mass);
        file["variables"] = json!({"mass": {"path": path, "lower": 1e-12}});
        if file.get("gravity").is_none() {
            file["gravity"] = json!([0, -9.81, 0]);
        }
        file
    }

    /// The scene with changes that keep its motion, except for the unit of `length`.
    fn case(&self, family: &'static str, extreme: &str, changes: &[Change], length: f64) -> Case {
        let way = Way {
            method: self.method,
            steps: Steps::Tolerance(TOLERANCE),
        };
        let name = (family, format!("{} {extreme}", self.name));
        let mut case = Case::known(name, self.scene, (way, self.duration), self.judge);
        let file = self.file();
        for key in ["variables", "functions"] {
            case = case.set(&format!("/{key}"), &file[key]);
        }
        for (path, value) in changes {
            case = case.set(path, value);
        }
        Case { length, ..case }
    }
}

/// Path and new value.
type Change = (String, Value);

pub(super) fn passages() -> Vec<Case> {
    let mut all = Vec::new();
    // The other methods reject nearly all: they are tried only at the first position.
    let mut add = |name: String, ways: usize, speed: f64, angle: f64| {
        for way in usual(TOLERANCE, 4000).into_iter().take(ways) {
            let exact = Exact::Parallelogram { speed, angle };
            let name = ("passage", name.clone());
            let mut case = Case::known(name, PARALLELOGRAM, (way, angle / speed), exact);
            for (body, at) in [("left", 0.5), ("right", 0.5), ("coupler", 1.0)] {
                case = case.set(&format!("/bodies/{body}/velocity/linear/0"), -at * speed);
            }
            for body in ["left", "right"] {
                case = case.set(&format!("/bodies/{body}/velocity/angular/2"), speed);
            }
            all.push(case);
        }
    };
    add("at the first".into(), 5, 1.0, FRAC_PI_2);
    for (which, ways, angle) in [("first", 5, FRAC_PI_2), ("seventh", 1, 6.5 * PI)] {
        for decade_of in -8..=-2 {
            let apart = 10.0_f64.powi(decade_of);
            let name = |side| format!("{} {side} the {which}", decade(apart));
            add(name("before"), ways, 1.0, angle - apart);
            add(name("after"), ways, 1.0, angle + apart);
        }
    }
    for k in 0..30 {
        let speed = 10.0_f64.powf(f64::from(k) / 5.0 - 3.0);
        add(format!("at {speed:.2e} rad per s"), 1, speed, 11.0);
    }
    all
}

pub(super) fn tolerances() -> Vec<Case> {
    let mut all = Vec::new();
    for (cells, scene) in [(1, FOUR_BARS_1), (2, FOUR_BARS_2), (10, FOUR_BARS_10)] {
        for decade_of in 4..=13 {
            let tolerance = 10.0_f64.powi(-decade_of);
            let exact = Exact::FourBars { cells, time: 10.0 };
            let name = ("tolerance", format!("{cells} to {}", decade(tolerance)));
            let way = Way {
                method: None,
                steps: Steps::Tolerance(tolerance),
            };
            let case = Case::known(name, scene, (way, 10.0), exact);
            all.push(case.set(
                "/variables",
                r#"{"mass":{"path":"/bodies/bar 1/mass","lower":0.1}}"#,
            ));
        }
    }
    all
}

pub(super) fn orders() -> Vec<Case> {
    let mut all = Vec::new();
    for (own, count) in looped().iter().zip([40, 10, 10, 10, 10, 10]) {
        for seed in 1..=count {
            let mut random = Random(seed);
            let file = own.file();
            let mut joints: Vec<(&String, Value)> = Vec::new();
            for (name, joint) in file["joints"].as_object().into_iter().flatten() {
                let mut joint = joint.clone();
                for parts in joint.as_object_mut().into_iter().flat_map(Map::values_mut) {
                    if random.below(2) == 1 {
                        parts["between"]
                            .as_array_mut()
                            .into_iter()
                            .for_each(|x| x.reverse());
                        if let Some(at) = parts["at"].as_object_mut() {
                            let ends = at.clone();
                            at["a"] = ends["b"].clone();
                            at["b"] = ends["a"].clone();
                        }
                    }
                }
                joints.insert(random.below(joints.len() + 1), (name, joint));
            }
            let joints: Map<_, _> = joints.into_iter().map(|(k, v)| (k.clone(), v)).collect();
            let change = ("/joints".to_owned(), joints.into());
            all.push(own.case("order", &seed.to_string(), &[change], 1.0));
        }
    }
    all
}

pub(super) fn rotations() -> Vec<Case> {
    let mut all = Vec::new();
    for own in &looped() {
        for seed in 1..=10 {
            let mut random = Random(seed);
            let axis = Vec3::from_fn(|_, _| random.between(-1.0, 1.0));
            let angle = random.between(-PI, PI);
            let by = rotation::matrix(&rotation::from_axis_angle(&axis, angle));
            let (file, mut changes) = (own.file(), Vec::new());
            turn("", &file, &by, &mut changes);
            let turn = json!({"axis": axis.as_slice(), "angle": angle});
            for (name, body) in file["bodies"].as_object().into_iter().flatten() {
                let mut turns = match &body["place"]["turn"] {
                    Value::Null => Vec::new(),
                    one => vec![one.clone()],
                };
                turns.push(turn.clone());
                let mut place = body["place"].as_object().cloned().unwrap_or_default();
                place.insert("turn".into(), turns.into());
                if let Some(at) = place.get_mut("at") {
                    *at = turned(at, &by).unwrap_or_else(|| at.clone());
                }
                changes.push((format!("/bodies/{name}/place"), place.into()));
            }
            all.push(own.case("rotation", &seed.to_string(), &changes, 1.0));
        }
    }
    all
}

/// Rotated vectors and points in ground axes, without the placements of bodies.
fn turn(path: &str, value: &Value, by: &Mat3<f64>, changes: &mut Vec<Change>) {
    for (key, own) in value.as_object().into_iter().flatten() {
        let path = format!("{path}/{key}");
        let vector = match key.as_str() {
            "gravity" | "linear" | "angular" | "about" | "direction" | "at" | "axis" => {
                turned(own, by)
            }
            "b" if path.ends_with("/at/b") => turned(own, by),
            "place" => continue,
            _ => None,
        };
        match vector {
            Some(vector) => changes.push((path, vector)),
            None => turn(&path, own, by, changes),
        }
    }
}

/// A rotated list of three numbers.
fn turned(value: &Value, by: &Mat3<f64>) -> Option<Value> {
    let list: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
    let list = list.filter(|list| list.len() == 3)?;
    Some(json!((by * Vec3::from_column_slice(&list)).as_slice()))
}

pub(super) fn units() -> Vec<Case> {
    let mut all = Vec::new();
    for own in &looped() {
        for (length, mass) in [
            (1e3, 1.0),
            (1e-3, 1.0),
            (1.0, 1e6),
            (1.0, 1e-6),
            (1e3, 1e-6),
        ] {
            let changes = in_units(&own.file(), (length, mass));
            let name = format!("length {} mass {}", decade(length), decade(mass));
            all.push(own.case("units", &name, &changes, length));
        }
    }
    all
}

/// All numbers of a file with a unit and their pointers, with lengths in 1/`length` m and masses in
/// 1/`mass` kg.
pub fn in_units(file: &Value, (length, mass): (f64, f64)) -> Vec<Change> {
    let mut changes = Vec::new();
    scale("", file, 1.0, (length, mass), &mut changes);
    changes
}

/// Adds the numbers below a key. `unit` is their factor if the key has none itself.
fn scale(path: &str, value: &Value, unit: f64, by: (f64, f64), changes: &mut Vec<Change>) {
    let (length, mass) = by;
    for (key, own) in value.as_object().into_iter().flatten() {
        let unit = match key.as_str() {
            "gravity" | "centre_of_mass" | "points" | "at" | "put" | "size" | "radius"
            | "length" | "linear" | "about" | "rest_length" => length,
            "mass" | "stiffness" | "damping" => mass,
            "inertia" | "magnitude" => mass * length * length,
            "density" => mass / length.powi(3),
            "axis" | "angle" | "angular" | "direction" | "simulation" | "functions" | "version" => {
                1.0
            }
            _ => unit,
        };
        let path = format!("{path}/{key}");
        let list = own.as_array().cloned().unwrap_or_else(|| vec![own.clone()]);
        let numbers: Option<Vec<f64>> = list.iter().map(Value::as_f64).collect();
        match numbers {
            Some(_) if unit == 1.0 => {}
            Some(all) => {
                let all: Vec<f64> = all.iter().map(|x| x * unit).collect();
                let scaled = if own.is_array() {
                    json!(all)
                } else {
                    json!(all[0])
                };
                changes.push((path, scaled));
            }
            None => scale(&path, own, unit, by, changes),
        }
    }
}

/// Numbers without a pattern: SplitMix64 (Steele, Lea & Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, end: usize) -> usize {
        (self.next() % end as u64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
