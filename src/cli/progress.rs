//! Progress of an optimisation or a long simulation: a bar on a terminal, lines elsewhere.

use super::tell;
use crate::integrate::Progress;
use crate::integrate::limits::View;
use crate::report::History;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

/// Wall time before the first line on a simulation, and longest time between two lines [s].
const LONG: f64 = 2.0;
const MOST: f64 = 30.0;
/// Interval at which the simulations are checked.
const LOOK: Duration = Duration::from_millis(500);
/// Parts of the bar of one simulation.
const PARTS: f64 = 1000.0;

/// The progress of the simulations of this process.
pub(crate) fn progress() -> Arc<Progress> {
    static PROGRESS: OnceLock<Arc<Progress>> = OnceLock::new();
    Arc::clone(PROGRESS.get_or_init(Arc::default))
}

/// The bar below the lines of standard error. It is hidden until something takes long.
pub(super) fn bar() -> &'static ProgressBar {
    static BAR: OnceLock<ProgressBar> = OnceLock::new();
    BAR.get_or_init(|| ProgressBar::with_draw_target(None, indicatif::ProgressDrawTarget::hidden()))
}

/// Whether the bar counts the parts of a command.
static COUNTS: AtomicBool = AtomicBool::new(false);

fn show_bar(length: u64, template: &str) {
    let bar = bar();
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.reset();
    bar.set_length(length);
    bar.set_draw_target(indicatif::ProgressDrawTarget::stderr());
}

/// Clears the bar.
pub(super) fn hide_bar() {
    bar().finish_and_clear();
    bar().set_draw_target(indicatif::ProgressDrawTarget::hidden());
}

/// Remaining time from the time so far, if a part of the work is done.
fn left(seconds: f64, part: f64) -> String {
    match part > 0.0 {
        true => format!("{:.0} s left", seconds * (1.0 - part) / part),
        false => String::new(),
    }
}

/// Counts the `total` parts of a long command on the bar: done, rate, remaining time. Without a terminal it does
/// nothing.
pub(crate) struct Counter {
    what: &'static str,
    total: usize,
    done: AtomicUsize,
    since: Instant,
}

impl Counter {
    /// Begins to count.
    pub(crate) fn new(what: &'static str, total: usize) -> Self {
        let own = Self {
            what,
            total,
            done: AtomicUsize::new(0),
            since: Instant::now(),
        };
        if std::io::stderr().is_terminal() {
            COUNTS.store(true, Ordering::Relaxed);
            show_bar(total as u64, "[{bar:30}] {msg}");
            own.tell(0);
        }
        own
    }

    /// One part is done.
    pub(crate) fn one(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        self.tell(done);
    }

    fn tell(&self, done: usize) {
        let seconds = self.since.elapsed().as_secs_f64();
        let mut text = format!("{done} of {} {}", self.total, self.what);
        if done > 0 {
            let rate = 60.0 * done as f64 / seconds.max(1e-3);
            let left = left(seconds, done as f64 / self.total.max(1) as f64);
            text += &format!(", {rate:.0} a minute, {left}");
        }
        bar().set_message(text);
        bar().set_position(done as u64);
    }
}

impl Drop for Counter {
    fn drop(&mut self) {
        COUNTS.store(false, Ordering::Relaxed);
        hide_bar();
    }
}

/// Reports long simulations on standard error. On a terminal: a bar after 2 s. Elsewhere: a line after 2 s, then after
/// twice the time of the last line, at least every 30 s.
pub(crate) fn watch() {
    static WATCHED: OnceLock<()> = OnceLock::new();
    WATCHED.get_or_init(|| {
        let seen = progress();
        let on_terminal = std::io::stderr().is_terminal();
        // The thread ends with the process.
        std::thread::spawn(move || match on_terminal {
            true => draw_bars(&seen),
            false => tell_lines(&seen),
        });
    });
}

fn draw_bars(seen: &Progress) {
    let mut drawn = false;
    loop {
        std::thread::sleep(LOOK);
        let long = seen.longest().filter(|view| view.seconds >= LONG);
        let counts = COUNTS.load(Ordering::Relaxed);
        match long {
            // The bar counts parts of the command.
            _ if counts => {}
            Some(view) => {
                if !drawn {
                    show_bar(PARTS as u64, "[{bar:30}] {percent} % {msg}");
                }
                drawn = true;
                let part = view.time / view.duration;
                let left = left(view.seconds, part);
                bar().set_message(format!("{} steps, {left}", view.steps));
                bar().set_position((PARTS * part) as u64);
            }
            None if drawn => {
                drawn = false;
                hide_bar();
            }
            None => {}
        }
    }
}

fn tell_lines(seen: &Progress) {
    let mut due = LONG;
    loop {
        std::thread::sleep(LOOK);
        match seen.longest() {
            Some(view) if view.seconds >= due => {
                tell(&format!("simulating: {}\n", line(&view)));
                due = (2.0 * view.seconds).min(view.seconds + MOST);
            }
            // Another simulation is the longest now.
            Some(view) if view.seconds < LONG => due = LONG,
            Some(_) => {}
            None => due = LONG,
        }
    }
}

fn line(view: &View) -> String {
    format!(
        "t = {:.6e} s of {} s after {:.0} s, {} steps, {} rejected",
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
