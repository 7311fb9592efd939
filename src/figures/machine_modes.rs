//! Pictures of the modes of machines: shapes about rest, and Campbell diagrams.

use super::detail::Detail;
use super::elastic_figures::elastic;
use super::error::FigureError;
use super::outlines::{outline, scenery};
use super::shells;
use crate::driver::Simulation;
use crate::driver::modes::{ToldModes, told};
use crate::functions::snapshot::Snapshot;
use crate::math::Complex64;
use crate::plots::{BodyMotion, CampbellPoint, Lapse, Motion, Sense, campbell, motion};
use crate::problem::{Drawing, Problem};
use crate::report::number::significant;
use crate::system::bodies::advance;
use crate::system::equilibrium::{MachineMode, MachineModes, Whirl};

/// Modes that are drawn.
const MOST_MODES: usize = 3;
/// Numbers of all bodies in a picture, about 1 MB.
const MOST_NUMBERS: usize = 10_000;
/// The largest displacement in a picture, as a part of the size of the machine; and the largest rotation \[rad\].
const DISPLACED: f64 = 0.12;
const TURNED: f64 = 0.4;
/// A mode that moves by less than this part of the size of the machine in a picture is across it.
const SEEN: f64 = 1e-3;
/// A part of a mode that is small enough for its direction.
const SMALL: f64 = 1e-6;

/// A figure, or why there is none.
type Drawn = (&'static str, Result<String, FigureError>);

/// Shapes of the modes of the last design, and Campbell diagrams of all; none if the file asks for no modes.
pub(super) fn figures(
    problem: &Problem,
    designs: &[(&str, &Simulation)],
    drawings: &[Drawing],
) -> Vec<Drawn> {
    let found: Vec<(&str, ToldModes)> = (designs.iter())
        .filter_map(|(title, design)| Some((*title, told(problem, &design.at.x).ok()??)))
        .collect();
    let mut all = Vec::new();
    if let (Some((_, own)), Some((_, design)), Some(drawing)) =
        (found.last(), designs.last(), drawings.last())
    {
        let shapes: Vec<Motion> = (own.modes.modes.iter().take(MOST_MODES).enumerate())
            .filter_map(|(k, mode)| shape(design, drawing, (k, mode)))
            .collect();
        all.push(("modes.svg", motion(&shapes, &scenery(drawing))));
    }
    let diagrams: Vec<(String, Vec<CampbellPoint>)> = (found.iter())
        .map(|(title, own)| ((*title).to_owned(), points(own)))
        .filter(|(_, points)| !points.is_empty())
        .collect();
    if !diagrams.is_empty() {
        all.push(("campbell.svg", campbell(&diagrams)));
    }
    all
}

fn points(told: &ToldModes) -> Vec<CampbellPoint> {
    let of = |(speed, modes): &(f64, MachineModes)| {
        let speed = *speed;
        let one = move |mode: &MachineMode| {
            let (sense, frequency) = match mode.whirl {
                Some((Whirl::Forward, frequency)) => (Sense::Forward, frequency),
                Some((Whirl::Backward, frequency)) => (Sense::Backward, frequency),
                None => (Sense::None, mode.frequency),
            };
            CampbellPoint {
                speed,
                frequency,
                sense,
            }
        };
        modes.modes.iter().map(one).collect::<Vec<_>>()
    };
    told.diagram.iter().flat_map(of).collect()
}

/// The machine at rest, pale, and with a part of a mode at the instant of its largest displacement.
fn shape(
    design: &Simulation,
    drawing: &Drawing,
    (number, mode): (usize, &MachineMode),
) -> Option<Motion> {
    let (run, model) = (design.motion(), &design.written.model);
    let still = Snapshot::of(model, run, 0);
    let numbering = still.numbering;
    if mode.shape.len() != numbering.velocities() {
        return None;
    }
    let seen: Vec<usize> = (0..model.bodies.len())
        .filter(|&body| !model.is_internal(body))
        .collect();
    let detail = Detail::of(
        seen.iter().map(|&body| &drawing.outlines[body]),
        MOST_NUMBERS,
    );
    let moved = |along: &[f64], part: f64| {
        let mut q = still.q.to_vec();
        let step: Vec<f64> = along.iter().map(|y| part * y).collect();
        let mut increment = vec![0.0; q.len()];
        advance(numbering, &mut q, &mut increment, &step);
        q
    };
    let drawn = |q: &[f64]| -> Vec<Vec<[f64; 2]>> {
        let at = Snapshot { q, ..still };
        let one = |&body: &usize| {
            let motion = at.motion(body);
            let own = shells::unknowns(model, body, elastic(model, &at, body));
            outline(&drawing.outlines[body], &own, &detail, |s| {
                drawing.flat(&motion.point(s))
            })
        };
        seen.iter().map(one).collect()
    };
    let rest = drawn(still.q);
    let size = extent(&rest);
    // Outlines move by elastic coordinates, too; across the picture by nothing.
    let most = mode
        .shape
        .iter()
        .fold(f64::MIN_POSITIVE, |m, y| m.max(y.norm()));
    let slight = SMALL * size / most;
    let rates = |of: fn(&Complex64) -> f64| -> Vec<f64> {
        let along: Vec<f64> = mode.shape.iter().map(of).collect();
        let other = drawn(&moved(&along, slight));
        let pairs = other.iter().zip(&rest);
        let of_body = |(a, b): (&Vec<[f64; 2]>, &Vec<[f64; 2]>)| {
            let pairs = supports(a).into_iter().zip(supports(b));
            pairs.map(|(a, b)| (a - b) / slight).collect::<Vec<f64>>()
        };
        pairs.flat_map(of_body).collect()
    };
    let (real, imaginary) = (rates(|y| y.re), rates(|y| y.im));
    let pairs = real.iter().zip(&imaginary);
    let seen_rates: Vec<Complex64> = pairs.map(|(&re, &im)| Complex64::new(re, im)).collect();
    // The phase at which the picture moves most.
    let turn = seen_rates.iter().map(|y| y * y).sum::<Complex64>();
    let phase = turn.sqrt().conj();
    let phase = match phase.norm() > 0.0 {
        true => phase / phase.norm(),
        false => Complex64::new(1.0, 0.0),
    };
    let along: Vec<f64> = mode.shape.iter().map(|y| (y * phase).re).collect();
    let seen_rate = seen_rates
        .iter()
        .fold(0.0_f64, |most, y| most.max((y * phase).re.abs()));
    let largest = |of: std::ops::Range<usize>| {
        let bodies = (0..model.bodies.len()).filter(|&body| !model.is_carrier(body));
        let parts = bodies.flat_map(|body| {
            let o = numbering.velocity(body);
            of.clone().map(move |k| o + k)
        });
        parts.fold(0.0_f64, |most, k| most.max(along[k].abs()))
    };
    let limits = [
        DISPLACED * size / seen_rate,
        DISPLACED * size / largest(0..3),
        TURNED / largest(3..6),
    ];
    let part = limits.into_iter().fold(f64::INFINITY, f64::min);
    if !part.is_finite() {
        return None;
    }
    let deflected = drawn(&moved(&along, part));
    let outlines = rest.into_iter().zip(deflected);
    let bodies = (seen.iter().zip(outlines))
        .map(|(&body, (rest, deflected))| BodyMotion {
            name: model.bodies[body].name.clone(),
            outlines: vec![rest, deflected],
            patches: Vec::new(),
            depths: Vec::new(),
        })
        .collect();
    let whirl = match mode.whirl {
        Some((Whirl::Forward, _)) => ", forward",
        Some((Whirl::Backward, _)) => ", backward",
        None => "",
    };
    let across = match part * seen_rate < SEEN * size {
        true => ", across the picture",
        false => "",
    };
    let frequency = significant(mode.frequency, 4);
    Some(Motion {
        title: format!("mode {}: {frequency} Hz{whirl}{across}", number + 1),
        lapse: Lapse::Mode,
        bodies,
        connectors: Vec::new(),
        traces: Vec::new(),
        flight: None,
        coloured: None,
    })
}

/// How far an outline reaches in eight directions. Its corners may be others as soon as it moves, but not these.
fn supports(outline: &[[f64; 2]]) -> [f64; 8] {
    std::array::from_fn(|k| {
        let (sin, cos) = (std::f64::consts::FRAC_PI_4 * k as f64).sin_cos();
        let along = outline.iter().map(|[x, y]| x * cos + y * sin);
        along.fold(f64::NEG_INFINITY, f64::max)
    })
}

/// The larger side of what is drawn.
fn extent(outlines: &[Vec<[f64; 2]>]) -> f64 {
    let side = |k: usize| {
        let all = outlines.iter().flatten().map(|point| point[k]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        high - low
    };
    side(0).max(side(1))
}
