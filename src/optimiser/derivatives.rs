//! The derivatives of a program, compared with differences of its values.

use crate::constants::STEPS;
use crate::nlp::{Evaluation, EvaluationFailure, Nlp};

/// The worst derivative of one function.
#[derive(Clone, Debug, PartialEq)]
pub struct DerivativeError {
    /// Name of the function: `objective`, or that of the row.
    pub function: String,
    /// Name of the variable.
    pub variable: String,
    /// The derivative that the program returns.
    pub given: f64,
    /// The derivative by differences of values.
    pub difference: f64,
    /// Their distance, relative to the largest derivative of this function.
    pub relative: f64,
}

/// Compares the derivatives of `nlp` at `x` with central differences. Returns the worst one of the
/// objective and of each row, the objective first. Of three steps the one counts that agrees best.
///
/// ```
/// use flexbody_optimiser::{Functions, derivative_errors};
/// let mut wrong = Functions::new(&[1.0], |x| (x[0].powi(2), vec![3.0 * x[0]]));
/// let found = derivative_errors(&mut wrong, &[2.0])?;
/// assert_eq!((found[0].given, found[0].difference.round()), (6.0, 4.0));
/// # Ok::<(), flexbody_optimiser::EvaluationFailure>(())
/// ```
///
/// # Errors
/// [`EvaluationFailure`] if the functions or their derivatives are undefined at or near `x`.
pub fn derivative_errors(
    nlp: &mut dyn Nlp,
    x: &[f64],
) -> Result<Vec<DerivativeError>, EvaluationFailure> {
    let (n, m) = (nlp.variables(), nlp.constraints());
    let slopes = nlp.gradients(x)?;
    let given = |f: usize, i: usize| match f {
        0 => slopes.objective[i],
        _ => slopes.jacobian[(f - 1, i)],
    };
    let value = |e: &Evaluation, f: usize| match f {
        0 => e.objective,
        _ => e.constraints[f - 1],
    };
    let size = |f: usize| (0..n).fold(f64::MIN_POSITIVE, |a, i| a.max(given(f, i).abs()));
    let sizes: Vec<f64> = (0..=m).map(size).collect();
    let mut worst: Vec<Option<(usize, f64, f64)>> = vec![None; m + 1];
    for i in 0..n {
        let mut best = vec![(f64::INFINITY, f64::NAN); m + 1];
        for step in STEPS {
            let h = step * x[i].abs().max(1.0);
            let mut at = x.to_vec();
            at[i] = x[i] + h;
            let after = nlp.evaluate(&at)?;
            at[i] = x[i] - h;
            let before = nlp.evaluate(&at)?;
            for (f, best) in best.iter_mut().enumerate() {
                let difference = (value(&after, f) - value(&before, f)) / (2.0 * h);
                let error = (difference - given(f, i)).abs();
                // A difference that is not a number is never the best, and so is shown.
                if error < best.0 {
                    *best = (error, difference);
                }
            }
        }
        for f in 0..=m {
            let (error, difference) = best[f];
            let relative = error / sizes[f].max(difference.abs());
            if worst[f].is_none_or(|w| relative > w.2) {
                worst[f] = Some((i, difference, relative));
            }
        }
    }
    let named = worst.into_iter().enumerate().filter_map(|(f, found)| {
        let (i, difference, relative) = found?;
        Some(DerivativeError {
            function: match f {
                0 => "objective".into(),
                _ => nlp.constraint_name(f - 1),
            },
            variable: nlp.variable_name(i),
            given: given(f, i),
            difference,
            relative,
        })
    });
    Ok(named.collect())
}
