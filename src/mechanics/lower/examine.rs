//! Conditions of reductions: quantities that must vanish at every design.

use crate::functions::Scene;
use crate::math::{Dual, Scalar};
use std::collections::HashMap;

/// A quantity is round-off up to this fraction of its scale.
pub(super) const ROUND_OFF: f64 = 1e-13;

/// A condition that the model violates.
#[derive(Clone, Debug, PartialEq)]
pub struct ViolatedCondition {
    /// Description, with the name of the part of the scene.
    pub what: String,
    /// Amount of the violation; zero if it has none. If a variable causes it: the amount for a
    /// typical change of this variable.
    pub size: f64,
    /// Unit of the size.
    pub unit: &'static str,
    /// The design variable that causes the violation, if only some designs violate the condition.
    pub variable: Option<String>,
    /// Whether the condition is violated at another design, and not at the start.
    pub elsewhere: bool,
}

impl ViolatedCondition {
    /// A violation without an amount.
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

/// `Ok` if a reduction may be made, or all violated conditions.
pub type Verdict = Result<(), Vec<ViolatedCondition>>;

/// Collects the violated conditions.
pub(super) struct ConditionChecker {
    /// Typical change of the variable. It multiplies infinitesimal parts.
    change: f64,
    found: Vec<ViolatedCondition>,
    /// The places in `found` by description: a large scene violates thousands.
    places: HashMap<String, usize>,
}

impl ConditionChecker {
    pub fn new(change: f64) -> Self {
        Self {
            change,
            found: Vec::new(),
            places: HashMap::new(),
        }
    }

    /// `Ok` if no condition is violated.
    pub fn verdict(self) -> Verdict {
        match self.found.is_empty() {
            true => Ok(()),
            false => Err(self.found),
        }
    }

    /// Adds a violation without an amount.
    pub fn tell(&mut self, what: String) {
        self.add(ViolatedCondition::plain(what));
    }

    /// Requires that `value` vanishes relative to `scale`; `what` gives the description and the
    /// unit.
    pub fn zero<S: Scalar>(
        &mut self,
        value: S,
        scale: f64,
        what: impl FnOnce() -> (String, &'static str),
    ) {
        self.vanishes(&[value], scale, what);
    }

    /// The same for the norm of a vector.
    pub fn vanishes<S: Scalar>(
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
        // NaN does not vanish.
        if size.is_nan() || size > ROUND_OFF * scale {
            let (what, unit) = what();
            // Angles are given by their sine.
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

    /// Adds a violation. Of several with one description only the largest is kept.
    fn add(&mut self, obstacle: ViolatedCondition) {
        match self.places.get(&obstacle.what) {
            Some(&place) => {
                let own = &mut self.found[place];
                own.size = own.size.max(obstacle.size);
            }
            None => {
                self.places.insert(obstacle.what.clone(), self.found.len());
                self.found.push(obstacle);
            }
        }
    }
}

/// A design variable: its range.
#[derive(Clone, Debug)]
pub struct Range {
    /// Name.
    pub name: String,
    /// Value at the start.
    pub start: f64,
    /// Bounds; infinite where there are none.
    pub bounds: [f64; 2],
    /// A typical change.
    pub scale: f64,
}

/// Number of designs between the bounds at which a reduction is examined.
const BETWEEN: usize = 4;

/// What makes scenes at other designs, and with derivatives.
pub type Makers<'a> = (
    &'a dyn Fn(&[f64]) -> Scene<f64>,
    &'a dyn Fn(&[Dual]) -> Scene<Dual>,
);

/// The scenes in which a reduction is examined.
#[derive(Clone)]
pub(super) struct Designs {
    /// The scene at the start.
    pub start: Scene<f64>,
    /// The scenes at other designs.
    others: Vec<Scene<f64>>,
    /// By variable: its name, its typical change, and the scene with its derivatives.
    derived: Vec<(String, f64, Scene<Dual>)>,
}

impl Designs {
    /// Whether the scenes of all designs have these numbers of parts.
    pub fn all_have(&self, parts: [usize; 3]) -> bool {
        self.others
            .iter()
            .all(|scene| super::parts(&scene.model) == parts)
    }

    /// The scene at the start, and those that `real` and `dual` make.
    pub fn new(start: Scene<f64>, (real, dual): Makers, variables: &[Range]) -> Self {
        let seed = |i: usize| -> Vec<Dual> {
            let part = |j: usize| if i == j { 1.0 } else { 0.0 };
            let all = variables.iter().enumerate();
            all.map(|(j, own)| Dual::new(own.start, part(j))).collect()
        };
        let derived = variables.iter().enumerate().map(|(i, variable)| {
            // The scale of the optimiser may be small; it does not bound the effect of the
            // variable.
            let change = variable.scale.max(variable.start.abs()).max(1.0);
            (variable.name.clone(), change, dual(&seed(i)))
        });
        Self {
            derived: derived.collect(),
            others: designs(variables).iter().map(|x| real(x)).collect(),
            start,
        }
    }

    /// A single scene, without design variables.
    pub fn single(start: Scene<f64>) -> Self {
        Self {
            start,
            others: Vec::new(),
            derived: Vec::new(),
        }
    }

    /// Changes all scenes.
    pub fn change(&mut self, real: impl Fn(&mut Scene<f64>), dual: impl Fn(&mut Scene<Dual>)) {
        real(&mut self.start);
        self.others.iter_mut().for_each(real);
        self.derived.iter_mut().for_each(|(.., scene)| dual(scene));
    }

    /// Examines conditions at the start and in the derivatives by the variables. If these are
    /// satisfied, examines them at the other designs too.
    pub fn ask(
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

/// Both corners of the bounds, and a fixed set of designs spread between them.
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
        // Fractional parts of multiples of the golden ratio.
        all.push(at(&|i| {
            (0.618_033_988_749_895 * (k + 7 * i + 1) as f64).fract()
        }));
    }
    all
}
