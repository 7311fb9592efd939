//! Boxes that fall on a floor in any pose, and what the smoothing of contacts and friction changes as it goes to zero.

use crate::reference::documents::{problem as parsed, run, values};
use crate::reference::models::Numbers;
use flexbody_driver::smoothing::changes;
use serde_json::{Map, Value};

/// A box of random size, pose and motion above the floor y = 0, with a contact at each corner.
fn drop(seed: u64) -> Value {
    let mut numbers = Numbers(seed);
    let half = numbers.vector().map(|x| 0.2 + 0.1 * x);
    let (v, w) = (numbers.vector() * 2.0, numbers.vector() * 6.0);
    let (axis, height) = (numbers.vector(), 0.8 + 0.3 * numbers.next());
    let corner = |k: usize| {
        let side = |i: usize| if k >> i & 1 == 1 { half[i] } else { -half[i] };
        [side(0), side(1), side(2)]
    };
    let contact = |k: usize| {
        json!({"contact": {"between": ["box", "ground"], "at": {"a": corner(k), "b": [0, 0, 0]},
                           "surface": {"plane": {"normal": [0, 1, 0]}}, "stiffness": 2e4, "dissipation": 0.3, "width": 0.004,
                           "friction": {"coefficient": 0.5, "width": 0.02}}})
    };
    let loads: Map<String, Value> = (0..8)
        .map(|k| (format!("corner {k}"), contact(k)))
        .collect();
    json!({
        "version": 1, "name": "drop",
        "bodies": {"box": {"shape": {"box": {"size": half.map(|x| 2.0 * x).as_slice()}}, "mass": 3,
                           "place": {"at": [0, height, 0], "turn": {"axis": axis.as_slice(), "angle": 3.0 * numbers.next()}},
                           "velocity": {"linear": v.as_slice(), "angular": w.as_slice()}}},
        "loads": loads,
        "simulation": {"duration": 2, "tolerance": 1e-6},
        "functions": {"energy": {"final": {"energy": "total"}}}
    })
}

/// After two seconds a box lies or rolls on the floor: its centre is never lower than its least half size but for the
/// penetration, it has lost energy, and nothing failed.
fn falls(seeds: std::ops::Range<u64>) {
    for seed in seeds {
        let file = drop(seed);
        let motion = run(&file);
        let size = &file["bodies"]["box"]["shape"]["box"]["size"];
        let half = (0..3).map(|i| 0.5 * size[i].as_f64().expect("a size"));
        let least = half.fold(f64::INFINITY, f64::min);
        let of = &motion.at.run;
        let heights = (0..=of.last()).map(|k| of.q(k)[1]);
        let lowest = heights.fold(f64::INFINITY, f64::min);
        assert!(lowest > least - 0.06, "{seed}: {lowest} {least}");
        let energies = motion
            .observations
            .iter()
            .map(|own| own.kinetic + own.potential);
        let energies: Vec<f64> = energies.collect();
        let [first, last] = [energies[0], energies[energies.len() - 1]];
        assert!(last < first && last > 0.0, "{seed}: {first} {last}");
    }
}

#[test]
fn boxes_stay_above_the_floor() {
    falls(0..200);
}

#[test]
#[ignore = "half a minute of one core"]
fn a_thousand_boxes_stay_above_the_floor() {
    falls(200..1000);
}

/// A ball without gravity that runs into a wall of 3000 N/m with 1.7 m/s: its place after the rebound by a sharp onset, and its
/// steps, and what half the width changes.
fn rebounded(width: f64) -> ((f64, usize), f64) {
    let time = 0.4;
    let file = json!({
        "version": 1, "name": "ball", "gravity": [0, 0, 0],
        "bodies": {"ball": {"shape": "point", "mass": 2, "place": {"at": [0, 0.2, 0]}, "velocity": {"linear": [0, -1.7, 0]}}},
        "loads": {"wall": {"contact": {"between": ["ball", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
                                       "surface": {"plane": {"normal": [0, 1, 0]}}, "stiffness": 3e3, "width": width}}},
        "simulation": {"duration": time, "tolerance": 1e-12},
        "functions": {"y": {"final": {"position": {"body": "ball", "direction": [0, 1, 0]}}}}
    });
    let free = time - 0.2 / 1.7 - std::f64::consts::PI * (2.0_f64 / 3e3).sqrt();
    let motion = run(&file);
    let sharper = changes(&parsed(&file), &motion.at, &[0]).expect("a motion");
    let value = motion.at.function(0).value - 1.7 * free;
    ((value, motion.at.run.grid.steps()), sharper[0].error())
}

/// A body of 2 kg that slides with 1 m/s and stops by friction: its way beyond v²/(2 μ g), and its steps.
fn stopped(width: f64) -> (f64, usize) {
    let (stiffness, mu) = (1e4, 0.5);
    let file = json!({
        "version": 1, "name": "block", "gravity": [0, -10, 0],
        "bodies": {"block": {"shape": "point", "mass": 2, "place": {"at": [0, -20.0 / stiffness, 0]}, "velocity": {"linear": [1, 0, 0]}}},
        "loads": {"floor": {"contact": {"between": ["block", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
                                        "surface": {"plane": {"normal": [0, 1, 0]}}, "stiffness": stiffness, "width": 1e-4,
                                        "friction": {"coefficient": mu, "width": width}}}},
        "simulation": {"duration": 1, "tolerance": 1e-11},
        "functions": {"x": {"final": {"position": {"body": "block", "direction": [1, 0, 0]}}}}
    });
    let motion = run(&file);
    (
        motion.at.function(0).value - 0.1,
        motion.at.run.grid.steps(),
    )
}

/// The onset of a contact changes a rebound by the third power of its width, friction a way by the square of its width and a
/// logarithm: ∫ √(v² + w²) dv / (μ g).
#[test]
fn the_smoothing_converges() {
    let both = [0.04, 0.02, 0.01].map(rebounded);
    for ((off, _), change) in both {
        // The third order: 7/8 of it goes with half the width.
        assert!((change / off.abs() - 0.875).abs() < 0.02, "{off} {change}");
    }
    let found = both.map(|own| own.0);
    println!("width of the onset 0.04, 0.02, 0.01: {found:?}");
    for pair in found.windows(2) {
        let order = (pair[0].0 / pair[1].0).log2();
        assert!((order - 3.0).abs() < 0.1, "{order} {found:?}");
    }
    let widths = [0.04_f64, 0.02, 0.01];
    let found = widths.map(stopped);
    println!("width of friction 0.04, 0.02, 0.01: {found:?}");
    for (w, (off, _)) in widths.iter().zip(found) {
        let way = 0.5 * (1.0 + w * w).sqrt() + 0.5 * w * w * (1.0 / w).asinh();
        assert!((off - (way / 5.0 - 0.1)).abs() < 1e-8, "{w} {off} {way}");
    }
    for pair in found.windows(2) {
        let order = (pair[0].0 / pair[1].0).log2();
        assert!(order > 1.7 && order < 2.0, "{order} {found:?}");
    }
}

/// Friction that holds a block on an incline lets it creep: v = w s / √(1 − s²), s = tan α / μ.
#[test]
fn what_sticks_creeps_by_the_width() {
    let (mu, slope) = (0.6_f64, 0.3_f64.atan());
    for width in [0.02, 0.002] {
        let normal = [-slope.sin(), slope.cos(), 0.0];
        let depth = 2.0 * 10.0 * slope.cos() / 1e4;
        let file = json!({
            "version": 1, "name": "incline", "gravity": [0, -10, 0],
            "bodies": {"block": {"shape": "point", "mass": 2, "place": {"at": normal.map(|x| -depth * x)}}},
            "loads": {"floor": {"contact": {"between": ["block", "ground"], "at": {"a": [0, 0, 0], "b": [0, 0, 0]},
                                            "surface": {"plane": {"normal": normal}}, "stiffness": 1e4, "width": 1e-4,
                                            "friction": {"coefficient": mu, "width": width}}}},
            "simulation": {"duration": 0.5, "tolerance": 1e-10},
            "functions": {"speed": {"final": {"speed": {"body": "block"}}}}
        });
        let share = 0.3 / mu;
        let creep = width * share / (1.0_f64 - share * share).sqrt();
        let found = values(&file)[0];
        assert!((found / creep - 1.0).abs() < 1e-6, "{found} {creep}");
    }
}
