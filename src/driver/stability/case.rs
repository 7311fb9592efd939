//! A case of the stability suite: a scene, its changes, its integration, and its judge.

use super::exact::Exact;
use crate::integrate::Method;
use crate::report::stability::case_name;

/// Default tolerance of the steps.
pub(super) const TOLERANCE: f64 = 1e-9;

/// Formats a number for the table.
pub(super) fn decade(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        x if (0.1..1000.0).contains(&x) => format!("{x}"),
        x => format!("{x:e}"),
    }
}

/// A problem file.
#[derive(Clone, Copy, Debug)]
pub(super) struct SceneFile {
    /// Its folder under `problems`.
    pub folder: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

/// The steps of a run.
#[derive(Clone, Copy, Debug)]
pub(super) enum Steps {
    /// Adaptive, with this tolerance.
    Tolerance(f64),
    /// This many equal steps.
    Equal(usize),
}

/// Method (`None` if it is chosen for the scene) and steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub method: Option<Method>,
    pub steps: Steps,
}

/// The source of the correct numbers.
#[derive(Clone, Copy, Debug)]
pub(super) enum Judge {
    /// A motion that is known independently of the program.
    Exact(Exact),
    /// A run by a method of the other family with a much smaller tolerance and only the first
    /// `kept` changes. Its error is relative to `size` \[m\].
    OtherMethod { kept: usize, size: f64 },
    /// A run of the same scene by the other family of implicit methods with many more steps. Its error is relative
    /// to `size` \[m\].
    SmallSteps { size: f64 },
    /// The least or largest value of the objective of an optimisation (NaN if there is none); its
    /// error is relative to `size`.
    Optimum { value: f64, size: f64 },
}

impl From<Exact> for Judge {
    fn from(exact: Exact) -> Self {
        Judge::Exact(exact)
    }
}

/// A case.
#[derive(Clone, Debug)]
pub(super) struct Case {
    /// The extreme property, in one word.
    pub family: &'static str,
    /// Its value.
    pub extreme: String,
    /// The scene.
    pub scene: SceneFile,
    /// Method and steps; `None` for those of the file.
    pub way: Option<Way>,
    /// Duration \[s\].
    pub duration: f64,
    /// Changes of the file as PATH=VALUE, in addition to method, steps and duration.
    pub changes: Vec<String>,
    /// Source of the correct numbers.
    pub judge: Judge,
    /// Factor of lengths.
    pub length: f64,
    /// Largest error of an accurate motion, relative to its size.
    pub bound: f64,
    /// Whether energy is conserved.
    pub conservative: bool,
    /// Whether the case is too slow for the tests.
    pub slow: bool,
}

/// Largest errors of an accurate motion: with a tolerance of 1e-9, and with equal steps of a method
/// of order 2.
const FINE: f64 = 1e-6;
const COARSE: f64 = 1e-3;

/// The bound for a method. Methods of order 2 are not accurate at ordinary steps.
fn bound(way: Way) -> f64 {
    match way.method {
        Some(Method::Bdf { .. } | Method::GeneralisedAlpha { .. }) => COARSE,
        _ => FINE,
    }
}

/// BDF of order 2, and generalised-α.
pub(super) fn order_two() -> [Method; 2] {
    let bdf = Method::Bdf {
        order: 2,
        start: crate::integrate::Start::Radau,
    };
    [bdf, Method::GeneralisedAlpha { radius: 0.8 }]
}

/// The adaptive methods.
pub(super) const ADAPTIVE: [Method; 3] = [
    Method::Dop853,
    Method::Radau { stages: 2 },
    Method::Radau { stages: 3 },
];

/// The method chosen for the scene (explicit unless it is stiff), and the implicit methods: with a
/// `tolerance`, or otherwise with equal steps.
pub(super) fn usual(tolerance: f64, steps: usize) -> Vec<Way> {
    let tolerance = Steps::Tolerance(tolerance);
    let mut all = vec![Way {
        method: None,
        steps: tolerance,
    }];
    let way = |(method, steps)| Way {
        method: Some(method),
        steps,
    };
    let [_, implicit @ ..] = ADAPTIVE;
    all.extend(implicit.map(|method| way((method, tolerance))));
    all.extend(order_two().map(|method| way((method, Steps::Equal(steps)))));
    all
}

/// All methods with equal steps.
pub(super) fn equal(steps: usize) -> Vec<Way> {
    let methods = ADAPTIVE.into_iter().chain(order_two());
    let way = |method| Way {
        method: Some(method),
        steps: Steps::Equal(steps),
    };
    methods.map(way).collect()
}

/// A case for each value of what is extreme, by each way.
pub(super) fn each<T: Copy>(values: &[T], ways: &[Way], of: impl Fn(T, Way) -> Case) -> Vec<Case> {
    let by_ways = |&value: &T| ways.iter().map(move |&way| (value, way));
    let all = values.iter().flat_map(by_ways);
    all.map(|(value, way)| of(value, way)).collect()
}

impl Way {
    /// Name for the table.
    pub fn name(self) -> String {
        let method = self.method.map_or_else(|| "chosen".into(), Method::name);
        match self.steps {
            Steps::Tolerance(tolerance) => format!("{method} to {tolerance:.0e}"),
            Steps::Equal(steps) => format!("{method} in {steps}"),
        }
    }

    /// The section "simulation" of a problem file.
    fn json(self, duration: f64) -> String {
        let steps = match self.steps {
            Steps::Tolerance(tolerance) => format!("\"tolerance\":{tolerance:e}"),
            Steps::Equal(steps) => format!("\"steps\":{steps}"),
        };
        let method = match self.method {
            None => String::new(),
            Some(Method::Dop853) => ",\"method\":\"dop853\"".into(),
            Some(Method::Radau { stages }) => {
                format!(",\"method\":{{\"radau\":{{\"stages\":{stages}}}}}")
            }
            Some(Method::Bdf { order, .. }) => {
                format!(",\"method\":{{\"bdf\":{{\"order\":{order}}}}}")
            }
            Some(Method::GeneralisedAlpha { radius }) => {
                format!(",\"method\":{{\"generalised_alpha\":{{\"radius\":{radius}}}}}")
            }
        };
        format!("{{\"duration\":{duration:e},{steps}{method}}}")
    }
}

impl Case {
    /// A case with the usual bounds. It conserves energy if its motion is known.
    pub fn known(
        (family, extreme): (&'static str, String),
        scene: SceneFile,
        (way, duration): (Way, f64),
        judge: impl Into<Judge>,
    ) -> Self {
        let judge = judge.into();
        Self {
            family,
            extreme,
            scene,
            way: Some(way),
            duration,
            changes: Vec::new(),
            judge,
            length: 1.0,
            bound: bound(way),
            conservative: matches!(judge, Judge::Exact(_)),
            slow: false,
        }
    }

    /// Adds a change of the file.
    pub fn set(mut self, path: &str, value: impl std::fmt::Display) -> Self {
        self.changes.push(format!("{path}={value}"));
        self
    }

    /// The case with another largest error.
    pub(super) fn within(self, bound: f64) -> Self {
        Self { bound, ..self }
    }

    /// The case without a look at its energy: nothing moves, or a drive does work.
    pub(super) fn without_energy(self) -> Self {
        let conservative = false;
        Self {
            conservative,
            ..self
        }
    }

    /// Method and steps for the table.
    pub fn method(&self) -> String {
        self.way
            .map_or_else(|| "as the file says".into(), Way::name)
    }

    /// Name by which it can be run alone.
    pub fn name(&self) -> String {
        case_name(self.family, &self.extreme, &self.method())
    }

    /// The first `kept` changes of the file, and method, steps and duration.
    pub fn overrides(&self, kept: usize) -> Vec<String> {
        let mut all: Vec<String> = self.changes.iter().take(kept).cloned().collect();
        if let Some(way) = self.way {
            all.push(format!("/simulation={}", way.json(self.duration)));
        }
        all
    }

    /// The command that runs the case.
    pub fn command(&self) -> String {
        let verb = match self.judge {
            Judge::Exact(_) | Judge::OtherMethod { .. } | Judge::SmallSteps { .. } => "simulate ",
            Judge::Optimum { .. } => "",
        };
        let SceneFile { folder, name, .. } = self.scene;
        let mut text = format!("optimize {verb}problems/{folder}/{name}");
        for change in self.overrides(usize::MAX) {
            text += &format!(" --set '{change}'");
        }
        text
    }
}
