//! Progress of an optimisation or a long simulation.

use super::tell;
use crate::integrate::Progress;
use crate::integrate::limits::View;
use crate::report::History;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

/// Wall time before the first line on a simulation, and longest time between two lines [s].
const LONG: f64 = 2.0;
const MOST: f64 = 30.0;
/// Interval at which the simulations are checked.
const LOOK: Duration = Duration::from_millis(500);

/// The progress of the simulations of this process.
pub(crate) fn progress() -> Arc<Progress> {
    static PROGRESS: OnceLock<Arc<Progress>> = OnceLock::new();
    Arc::clone(PROGRESS.get_or_init(Arc::default))
}

/// Reports long simulations on standard error: after 2 s, then after twice the time of the last line, at least
/// every 30 s.
pub(crate) fn watch() {
    static WATCHED: OnceLock<()> = OnceLock::new();
    WATCHED.get_or_init(|| {
        let seen = progress();
        // The thread ends with the process.
        std::thread::spawn(move || {
            let mut due = LONG;
            loop {
                std::thread::sleep(LOOK);
                match seen.longest() {
                    Some(view) if view.seconds >= due => {
                        tell(&line(&view));
                        due = (2.0 * view.seconds).min(view.seconds + MOST);
                    }
                    // Another simulation is the longest now.
                    Some(view) if view.seconds < LONG => due = LONG,
                    Some(_) => {}
                    None => due = LONG,
                }
            }
        });
    });
}

fn line(view: &View) -> String {
    format!(
        "simulating: t = {:.6e} s of {} s after {:.0} s, {} steps, {} rejected\n",
        view.time, view.duration, view.seconds, view.steps, view.rejected
    )
}

/// Prints one line per iteration, and the column heads every twenty lines.
pub(crate) fn show(history: &History) {
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
