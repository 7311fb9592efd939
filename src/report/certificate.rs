//! The certificate of an optimisation's gradients.

use super::number::significant;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

/// One directional derivative of every function at the start and at the optimum, computed twice: by
/// the adjoint, Σᵢ dᵢ ∂f/∂xᵢ, and by the complex step, Im f(x + i h d)/h, on the same steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GradientCertificate {
    /// Seed of the direction.
    pub seed: u64,
    /// The direction d: the change of each variable, in its unit.
    pub direction: IndexMap<String, f64>,
    /// Largest accepted difference, relative to Σᵢ |dᵢ ∂f/∂xᵢ|: the larger of those at this design and at the start,
    /// and of a sum over the motion that of its terms.
    pub tolerance: f64,
    /// Whether every derivative passed at both designs.
    pub passed: bool,
    /// The derivatives at the start.
    pub start: CertifiedDesign,
    /// The derivatives at the optimum.
    pub optimum: CertifiedDesign,
    /// Its work.
    pub cost: CertificateCost,
}

/// Work of a certificate, in whole runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertificateCost {
    /// Backward marches of all functions.
    pub gradients: u64,
    /// Runs in complex numbers.
    pub complex_runs: u64,
}

/// The derivatives at one design.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedDesign {
    /// The derivatives, by function.
    #[serde(default, skip_serializing_if = "IndexMap::is_empty")]
    pub functions: IndexMap<String, CertifiedDerivative>,
    /// The fault: the function, and the variable, body, joint and step if known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
    /// A note on derivatives that pass.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// A directional derivative, computed twice; a number that is not finite is left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedDerivative {
    /// By the adjoint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjoint: Option<f64>,
    /// By the complex step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub complex_step: Option<f64>,
    /// Their difference, relative to that of `tolerance`. A difference above the tolerance passes if it
    /// is round-off of the terms of the derivatives.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<f64>,
}

impl GradientCertificate {
    /// The faults, with the design, one sentence each.
    pub fn faults(&self) -> Vec<String> {
        self.told(|design| &design.faults)
    }

    fn told(&self, of: fn(&CertifiedDesign) -> &Vec<String>) -> Vec<String> {
        let designs = [
            ("at the start", &self.start),
            ("at the optimum", &self.optimum),
        ];
        let all = designs.into_iter().flat_map(|(place, design)| {
            let sentences = of(design).iter();
            sentences.map(move |sentence| format!("{place}, {sentence}"))
        });
        all.collect()
    }
}

/// The lines of a summary.
pub(super) fn lines(certificate: &GradientCertificate) -> String {
    let CertificateCost {
        gradients,
        complex_runs,
    } = certificate.cost;
    let cost = format!("cost: {gradients} gradients and {complex_runs} complex runs");
    // For derivatives that vanish, the difference is round-off.
    let largest = |design: &CertifiedDesign| {
        let differences = design.functions.values().filter_map(|d| d.difference);
        let judged = differences.filter(|d| *d <= certificate.tolerance);
        significant(judged.fold(0.0, f64::max), 2)
    };
    let mut text = match certificate.passed {
        true => format!(
            "Gradients: adjoint and complex step agree to {} at the start and {} at the optimum, of the \
             gradient of each of {} functions ({cost})\n",
            largest(&certificate.start),
            largest(&certificate.optimum),
            certificate.optimum.functions.len(),
        ),
        false => format!("Gradients: NOT CONFIRMED by the complex step ({cost})\n"),
    };
    let notes = certificate.told(|design| &design.notes);
    for sentence in certificate.faults().into_iter().chain(notes) {
        text.push_str(&format!("  {sentence}\n"));
    }
    text
}
