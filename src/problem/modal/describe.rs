//! Text about bodies from files: their coordinates and natural frequencies.

use super::numbers::numbers;
use crate::schema::modal::Modal;
use crate::structures::modal::frequencies::{Held, frequencies};
use crate::structures::modal::interfaces::Holding;
use crate::structures::modal::loaded::{Loaded, Reduced};
use crate::structures::modes::Pencil;

/// Largest number of natural frequencies of a body in the text.
const TOLD: usize = 6;

/// Relative uncertainty of a stiffness by the digits of its file above which the text has it.
const TOLD_UNCERTAIN: f64 = 1e-4;

/// A body in words. Its sentence on the free body needs the modes of the full matrices.
pub fn described(name: &str, modal: &Modal, x: &[f64]) -> String {
    let Some(loaded) = &modal.loaded else {
        return format!("body \"{name}\": its files are not read");
    };
    let own = numbers(modal, x);
    let list = |all: Option<Vec<f64>>| match all {
        Some(all) => {
            let told: Vec<String> = all.iter().take(TOLD).map(|f| format!("{f:.4e}")).collect();
            told.join(", ")
        }
        None => "none".to_owned(),
    };
    let held = list(frequencies(&own, Held::Axes));
    let free = frequencies(&own, Held::Nothing);
    let Loaded { body, reduced } = &**loaded;
    let count = body.modes();
    let Some(reduced) = reduced else {
        return format!(
            "body \"{name}\": {count} coordinates of its file; frequencies with its axes held {held} Hz, \
             free {} Hz",
            list(free)
        );
    };
    let full = full_frequencies(reduced, factor(modal, x));
    format!(
        "body \"{name}\": {}; frequencies with its axes held {held} Hz, free {} Hz; of the full \
         matrices, free {} Hz{}",
        coordinates(reduced, count),
        list(free.clone()),
        list(full.clone()),
        difference(free, full)
    )
}

/// The vectors of the coordinates.
fn coordinates(reduced: &Reduced, count: usize) -> String {
    let Reduced {
        free,
        reduction,
        interfaces,
        holding,
    } = reduced;
    let of = |k: usize| {
        let own = reduction
            .boundary
            .iter()
            .filter(|(interface, _)| *interface == k);
        let names: Vec<&str> = own.map(|(_, name)| name.as_str()).collect();
        match names.len() {
            0 => format!("\"{}\" none", interfaces[k].name),
            // Vectors of one kind are counted.
            n if n > 3 => format!("\"{}\" {n}", interfaces[k].name),
            _ => format!("\"{}\" {}", interfaces[k].name, names.join(" and ")),
        }
    };
    let each: Vec<String> = (0..interfaces.len()).map(of).collect();
    let frame = match holding {
        Holding::Clamped(k) => format!("clamped at \"{}\"", interfaces[*k].name),
        Holding::Chord(a, b, c) => {
            let third = c.map_or(String::new(), |c| {
                format!(" and \"{}\"", interfaces[c].name)
            });
            let [a, b] = [a, b].map(|k| &interfaces[*k].name);
            format!("a chord from \"{a}\" to \"{b}\"{third}")
        }
    };
    let mut words = format!(
        "{} unknowns of {} nodes reduced to {count} coordinates: {} boundary modes ({}), which are the {} of \
         the interfaces less the six rigid motions of the frame, {frame}; and {} fixed-interface modes",
        free.unknowns.len(),
        free.nodes.len(),
        reduction.boundary.len(),
        each.join(", "),
        reduction.boundary_before,
        reduction.fixed.len(),
    );
    if let Some(last) = reduction.fixed.last() {
        words += &format!(" up to {last:.4e} Hz");
    }
    if reduction.massless > 0 {
        words += &format!("; {} modes without mass are left out", reduction.massless);
    }
    if reduction.uncertain > TOLD_UNCERTAIN {
        words += &format!(
            "; the digits of its files leave a stiffness uncertain by {:.0e} of itself",
            reduction.uncertain
        );
    }
    if free.empty > 0 {
        words += &format!(
            "; {} components of nodes have neither stiffness nor mass",
            free.empty
        );
    }
    words
}

/// Factor of the frequencies by the factors of the design: √(E/ρ)/s.
fn factor(modal: &Modal, x: &[f64]) -> f64 {
    let or = |q: Option<crate::quantity::Quantity>| q.map_or(1.0, |q| q.get(x));
    (or(modal.young_factor) / or(modal.density_factor)).sqrt() / or(modal.scale)
}

/// Frequencies of the full matrices without supports \[Hz\].
fn full_frequencies(reduced: &Reduced, factor: f64) -> Option<Vec<f64>> {
    let free = &reduced.free;
    let mut pencil = Pencil::new(free.pattern.clone());
    pencil.stiffness.clone_from(&free.stiffness);
    pencil.mass.clone_from(&free.mass);
    let motions = free.rigid_motions(&free.middle()).to_vec();
    let modes = pencil.lowest(motions, TOLD).ok()?;
    Some(modes.frequencies().iter().map(|f| f * factor).collect())
}

/// The largest error of the first frequencies.
fn difference(reduced: Option<Vec<f64>>, full: Option<Vec<f64>>) -> String {
    let (Some(reduced), Some(full)) = (reduced, full) else {
        return String::new();
    };
    let pairs = reduced.iter().zip(&full).take(TOLD);
    let count = pairs.clone().count();
    let largest = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
    format!(
        "; the first {count} differ by up to {:.2} %",
        100.0 * largest
    )
}
