//! What a quasi-static start leaves out: the rates of deformations that change with the motion.
//!
//! A start has no elastic rates. They are zero where the bodies turn and move steadily, as seen from them, with their
//! loads: in relative equilibrium. Else the deformations that satisfy the equations of the start change. Their rates at
//! t = 0 follow from the implicit function theorem, with the placement, its velocities and time in place of parameters:
//!
//! ```text
//! q_g = q + ε v,     v_g = v + ε a,     t = ε
//! ```

use super::equations::State;
use super::matrix::Factors;
use super::{FINE, Given, KnownStarts, Solver, Sought, at_solution};
use crate::math::slices::dot;
use crate::math::{Dual, Parameters};
use crate::model::{FlexibleBody, Model};
use crate::system::bodies;
use crate::system::failure::AssemblyFailure;
use crate::system::flexible::strain_energy;

/// By flexible body: √(T / U), with T the kinetic energy of the rates that the start of `model` leaves out and U its strain
/// energy. This is the amplitude of the vibration that follows, as a part of the deformation. The bodies of `model` are
/// placed and undeformed.
///
/// # Errors
/// If there is no such start.
pub fn left_out(model: &Model<f64>, known: &KnownStarts) -> Result<Vec<f64>, AssemblyFailure> {
    at_solution(model, known, Sought::Start, |solver, factors, found| {
        Ok(solver.left_out(factors, found))
    })
}

impl Solver<'_> {
    fn left_out(&self, factors: &mut Factors, found: &State<f64>) -> Vec<f64> {
        let layout = self.layout;
        let (numbering, still) = (layout.numbering, |x: f64| Dual::new(x, 0.0));
        let (v, a) = (layout.of_rigid(&found.v), layout.of_rigid(&found.a));
        // The state is its own placement.
        let mut at = found.clone();
        at.sigma.fill(0.0);
        at.tau.fill(0.0);
        let placed = Given {
            q: found.q.clone(),
            v: v.clone(),
            time: 0.0,
            turning: None,
        };
        let mut later = Given {
            q: found.q.iter().map(|&x| still(x)).collect::<Vec<Dual>>(),
            v: v.iter().zip(&a).map(|(&v, &a)| Dual::new(v, a)).collect(),
            time: Dual::new(0.0, 1.0),
            turning: None,
        };
        let moved: Vec<Dual> = v.iter().map(|&v| Dual::new(0.0, v)).collect();
        let mut increment = vec![still(0.0); later.q.len()];
        bodies::advance(numbering, &mut later.q, &mut increment, &moved);
        let model = self.model.map(&mut |x| still(x));
        let residual = layout.residual(&model, &later, &at.map(still));
        let right: Vec<f64> = residual.iter().map(|x| -x.du).collect();
        let at_placement = Solver {
            given: &placed,
            numbers: self.numbers.clone(),
            ..*self
        };
        let rates = at_placement.change(factors, &at, &right, FINE);

        let motions = layout.at_rest(&found.q);
        let part = |body: &FlexibleBody<f64>| {
            let mut own = vec![0.0; numbering.unknowns()];
            for (carrier, k) in body.places() {
                let i = numbering.unknown(carrier) + k;
                own[i] = rates[i];
            }
            let kinetic = 0.5 * dot(&own, &layout.mass_product(self.model, &motions, &own));
            let strain = strain_energy(body, &motions);
            match strain > 0.0 {
                true => (kinetic / strain).max(0.0).sqrt(),
                false => 0.0,
            }
        };
        self.model.flexible.iter().map(part).collect()
    }
}
