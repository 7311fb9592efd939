//! Whether quantities that have to vanish do, and those that do not.

use crate::functions::Scene;
use crate::math::{Dual, Scalar};

/// Size, relative to its scale, up to which a quantity is round-off.
pub(super) const ROUND_OFF: f64 = 1e-13;

/// What stands against a reduction.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ViolatedCondition {
    /// What it is, with the name of the part of the scene.
    pub what: String,
    /// By how much (or, if a variable is at fault, by how much for a typical change of it); zero if
    /// it has no size.
    pub size: f64,
    /// Unit of the size.
    pub unit: &'static str,
    /// The design variable that makes it so, if only some designs do.
    pub variable: Option<String>,
    /// Whether it is so at a design between the bounds, and not at the start.
    pub elsewhere: bool,
}

impl ViolatedCondition {
    /// One that has no size.
    pub(super) fn plain(what: impl Into<String>) -> Self {
        Self {
            what: what.into(),
            size: 0.0,
            unit: "",
            variable: None,
            elsewhere: false,
        }
    }
}

impl std::fmt::Display for ViolatedCondition {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}", self.what)?;
        if self.size > 0.0 {
            write!(f, " by {:.1e}", self.size)?;
            if !self.unit.is_empty() {
                write!(f, " {}", self.unit)?;
            }
        }
        match &self.variable {
            Some(name) => write!(f, ", moved by the variable \"{name}\""),
            None if self.elsewhere => write!(f, ", at another design"),
            None => Ok(()),
        }
    }
}

/// Whether something may be left out, or all that stands against it.
pub(crate) type Verdict = Result<(), Vec<ViolatedCondition>>;

/// Collects the quantities that do not vanish.
pub(super) struct ConditionChecker {
    /// The typical change that an infinitesimal part is multiplied by.
    change: f64,
    found: Vec<ViolatedCondition>,
}

impl ConditionChecker {
    pub(crate) fn new(change: f64) -> Self {
        Self {
            change,
            found: Vec::new(),
        }
    }

    /// What was found.
    pub(crate) fn verdict(self) -> Verdict {
        match self.found.is_empty() {
            true => Ok(()),
            false => Err(self.found),
        }
    }

    /// Tells an obstacle that has no size.
    pub(crate) fn tell(&mut self, what: String) {
        self.add(ViolatedCondition::plain(what));
    }

    /// Asks that `value` vanishes beside `scale`; `what` tells it with its unit if it does not.
    pub(crate) fn zero<S: Scalar>(
        &mut self,
        value: S,
        scale: f64,
        what: impl FnOnce() -> (String, &'static str),
    ) {
        self.vanishes(&[value], scale, what);
    }

    /// As [`ConditionChecker::zero`], of a vector.
    pub(crate) fn vanishes<S: Scalar>(
        &mut self,
        vector: &[S],
        scale: f64,
        what: impl FnOnce() -> (String, &'static str),
    ) {
        let length = |part: &dyn Fn(S) -> f64| {
            let squares = vector.iter().map(|x| part(*x).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let derived = length(&|x| x.infinitesimal()) * self.change;
        let value = length(&|x| x.re());
        let size = if value.is_nan() {
            value
        } else {
            derived.max(value)
        };
        // A value that is not a number does not vanish.
        if size.is_nan() || size > ROUND_OFF * scale {
            let (what, unit) = what();
            // Angles are asked for by their sine.
            let size = match unit {
                "rad" => size.min(1.0).asin(),
                _ => size,
            };
            self.add(ViolatedCondition {
                size,
                unit,
                ..ViolatedCondition::plain(what)
            });
        }
    }

    /// Adds an obstacle, or makes one of several of one name as large as the largest.
    fn add(&mut self, obstacle: ViolatedCondition) {
        match self.found.iter_mut().find(|own| own.what == obstacle.what) {
            Some(own) => own.size = own.size.max(obstacle.size),
            None => self.found.push(obstacle),
        }
    }
}

/// A design variable, as far as it matters here.
#[derive(Clone, Debug)]
pub(crate) struct Range {
    /// Name.
    pub name: String,
    /// Where the design starts.
    pub start: f64,
    /// Bounds, infinite if there are none.
    pub bounds: [f64; 2],
    /// A typical change.
    pub scale: f64,
}

/// Designs between the bounds at which a reduction is examined.
const BETWEEN: usize = 4;

/// The scenes that a reduction is examined in.
#[derive(Clone)]
pub(super) struct Designs {
    /// That of the start.
    pub start: Scene<f64>,
    /// Those of other designs.
    others: Vec<Scene<f64>>,
    /// Those of the derivatives by the variables, with their names and typical changes.
    derived: Vec<(String, f64, Scene<Dual>)>,
}

impl Designs {
    /// The scenes that `real` and `dual` make.
    pub(crate) fn new(
        real: &dyn Fn(&[f64]) -> Scene<f64>,
        dual: &dyn Fn(&[Dual]) -> Scene<Dual>,
        variables: &[Range],
    ) -> Self {
        let start: Vec<f64> = variables.iter().map(|variable| variable.start).collect();
        let seed = |i: usize| -> Vec<Dual> {
            let part = |j: usize| if i == j { 1.0 } else { 0.0 };
            let start = start.iter().enumerate();
            start.map(|(j, &x)| Dual::new(x, part(j))).collect()
        };
        let derived = variables.iter().enumerate().map(|(i, variable)| {
            // How finely the optimiser scales it says nothing of what it can break.
            let change = variable.scale.max(variable.start.abs()).max(1.0);
            (variable.name.clone(), change, dual(&seed(i)))
        });
        Self {
            derived: derived.collect(),
            others: designs(variables).iter().map(|x| real(x)).collect(),
            start: real(&start),
        }
    }

    /// One scene, whatever the design.
    #[cfg(test)]
    pub fn single(start: Scene<f64>) -> Self {
        Self {
            start,
            others: Vec::new(),
            derived: Vec::new(),
        }
    }

    /// Changes all scenes.
    pub(crate) fn change(
        &mut self,
        real: impl Fn(&mut Scene<f64>),
        dual: impl Fn(&mut Scene<Dual>),
    ) {
        real(&mut self.start);
        self.others.iter_mut().for_each(real);
        self.derived.iter_mut().for_each(|(.., scene)| dual(scene));
    }

    /// Asks a question of the start, of the derivatives by the variables and of the other designs,
    /// the latter for what is not known by then.
    pub(crate) fn ask(
        &self,
        real: impl Fn(&Scene<f64>) -> Verdict,
        dual: impl Fn(&Scene<Dual>, f64) -> Verdict,
    ) -> Verdict {
        let mut all = real(&self.start).err().unwrap_or_default();
        let start: Vec<String> = all.iter().map(|own| own.what.clone()).collect();
        for (name, change, scene) in &self.derived {
            let found = dual(scene, *change).err().unwrap_or_default();
            let new = found.into_iter().filter(|own| !start.contains(&own.what));
            all.extend(new.map(|own| ViolatedCondition {
                variable: Some(name.clone()),
                ..own
            }));
        }
        for scene in &self.others {
            for own in real(scene).err().unwrap_or_default() {
                if all.iter().all(|known| known.what != own.what) {
                    all.push(ViolatedCondition {
                        elsewhere: true,
                        ..own
                    });
                }
            }
        }
        match all.is_empty() {
            true => Ok(()),
            false => Err(all),
        }
    }
}

/// Both corners of the bounds, and designs spread between them in a fixed way.
fn designs(variables: &[Range]) -> Vec<Vec<f64>> {
    if variables.is_empty() {
        return Vec::new();
    }
    let ends = |variable: &Range| {
        let [lower, upper] = variable.bounds;
        let finite = |bound: f64, otherwise: f64| match bound.is_finite() {
            true => bound,
            false => otherwise,
        };
        let (start, scale) = (variable.start, variable.scale);
        [finite(lower, start - scale), finite(upper, start + scale)]
    };
    let at = |part: &dyn Fn(usize) -> f64| {
        let value = |(i, variable): (usize, &Range)| {
            let [lower, upper] = ends(variable);
            lower + part(i) * (upper - lower)
        };
        variables.iter().enumerate().map(value).collect()
    };
    let mut all = vec![at(&|_| 0.0), at(&|_| 1.0)];
    for k in 1..=BETWEEN {
        // Fractional parts of multiples of an irrational number.
        all.push(at(&|i| {
            (0.618_033_988_749_895 * (k + 7 * i + 1) as f64).fract()
        }));
    }
    all
}
