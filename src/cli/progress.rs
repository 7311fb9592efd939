//! What is seen of an optimisation while it runs.

use super::tell;
use crate::report::History;

/// One line an iteration, with the column heads every twenty lines.
pub fn show(history: &History) {
    let Some(row) = history.rows.last() else {
        return;
    };
    if history.rows.len() % 20 == 1 {
        tell(
            "iter      objective    inf_pr    inf_du  lg(mu)     ||d||  lg(rg)  alpha_du  alpha_pr \
             ls  evals\n",
        );
    }
    let logarithm = |x: f64| {
        if x > 0.0 {
            format!("{:.1}", x.log10())
        } else {
            "-".to_string()
        }
    };
    let mark = match row.phase.as_str() {
        "restoration" => "r",
        "sqp" => "s",
        _ => " ",
    };
    tell(&format!(
        "{:>4}{mark} {:>13.6e}  {:>8.2e}  {:>8.2e}  {:>6}  {:>8.2e}  {:>6}  {:>8.2e}  {:>8.2e} \
         {:>2}  {:>5}\n",
        row.iteration,
        row.objective,
        row.infeasibility,
        row.optimality,
        logarithm(row.barrier),
        row.step_norm,
        logarithm(row.regularisation),
        row.dual_step,
        row.primal_step,
        row.line_search_trials,
        row.evaluations
    ));
}
