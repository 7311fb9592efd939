//! Vibrations of a machine with damping, about rest or about steady rotation, also under loads without potential: motions
//! y e^{st} of [`super::pencil`], s = −ζ |s| ± i 2π f. With right and left vectors r and l, lᵀ (D + 2 s M) y = 1,
//!
//! ```text
//! ds = −lᵀ (dK + s dD + s² dM) r
//! ```
//!
//! with the rows of constraints in K, and with the change of rest. Eigenvalues that meet have the mean of their derivatives,
//! so that sums over them have the derivative of the sum.

use super::contracted::contracted;
use super::eigenpairs::{Cluster, clusters};
use super::equations::State;
use super::krylov::{GROWS, growing, lowest};
use super::modes::{Vibration, WantedModes, without_modes};
use super::pencil::{At, Matrices};
use super::released::Released;
use super::rest::FREE;
use super::{KnownStarts, Solver};
use crate::math::{Complex64, Scalar};
use crate::structures::modes::MOST_MODES;
use crate::system::failure::AssemblyFailure;
use std::f64::consts::PI;
use std::ops::Range;

/// Relative distance of a growth from the eigenvalue that it is found to be, and how many are looked at.
const NEAR: f64 = 1e-4;
const MOST_GROWING: usize = 16;
/// Rates that count, relative to that of the lowest mode without damping.
const SLOWER: f64 = 1e-2;
/// Dimension up to which all motions in steady rotation are looked at.
const WHOLE: usize = 200;
/// Number of spectra that are known.
const KEPT: usize = 4;

/// A vibration y e^{st} with its rate s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedVibration<S> {
    /// Re s \[1/s\]: negative if it decays.
    pub growth: S,
    /// Im s \[rad/s\], positive.
    pub speed: S,
    /// Whether another one has the same rate, so that it has no derivative of its own; sums over both have one.
    pub repeated: bool,
}

impl<S: Scalar> DampedVibration<S> {
    /// Frequency Im s / 2π \[Hz\].
    pub fn frequency(&self) -> S {
        self.speed / (2.0 * PI)
    }

    /// Damping ratio ζ = −Re s / |s|: 0 without damping, 1 where no oscillation is left, negative if it grows.
    pub fn damping_ratio(&self) -> S {
        -self.growth / (self.growth * self.growth + self.speed * self.speed).sqrt()
    }

    pub(super) fn undamped(&self) -> Vibration<S> {
        Vibration {
            frequency: self.frequency(),
            repeated: self.repeated,
        }
    }
}

/// σ of a search, and sizes |s| that count.
type Scales = (f64, Range<f64>);

/// The rates of a machine, its lowest |s| first, by clusters.
#[derive(Clone, Debug)]
pub(super) struct Spectrum {
    pub clusters: Vec<Cluster>,
    /// Whether D is part of it.
    pub damped: bool,
    /// The fastest growth of a motion that does not oscillate \[1/s\].
    pub diverging: Option<f64>,
    wanted: WantedModes,
}

impl Spectrum {
    /// That of a machine at an instant.
    pub(super) fn of_instant(clusters: Vec<Cluster>) -> Self {
        Self {
            clusters,
            damped: true,
            diverging: None,
            wanted: WantedModes::default(),
        }
    }

    /// Cluster and place in it of each rate, by size |s|.
    pub(super) fn order(&self) -> Vec<(usize, usize)> {
        let all = self.clusters.iter().enumerate();
        let mut all: Vec<(usize, usize)> = all
            .flat_map(|(c, own)| (0..own.values.len()).map(move |k| (c, k)))
            .collect();
        let size = |&(c, k): &(usize, usize)| self.clusters[c].values[k].norm();
        all.sort_by(|a, b| size(a).total_cmp(&size(b)));
        all
    }
}

/// The fastest growth of these rates that are eigenvalues, and no round-off: neither of motions without inertia nor of undamped ones.
fn confirmed(matrices: &Matrices, rates: impl Iterator<Item = Complex64>) -> Option<f64> {
    let growth = |rate: Complex64| {
        let found = clusters(matrices, &[rate]).ok()?;
        let mut exact = found.iter().flat_map(|own| &own.values);
        let grows = |s: &Complex64| s.re > GROWS * s.norm() && (s - rate).norm() <= NEAR * s.norm();
        exact.all(grows).then_some(rate.re)
    };
    rates.take(MOST_GROWING).filter_map(growth).reduce(f64::max)
}

/// Frequencies of rates \[Hz\], the size of the last one in its place: beyond it there are others of any.
fn frequencies(rates: &[Complex64]) -> Vec<f64> {
    let mut all: Vec<f64> = rates.iter().map(|s| s.im / (2.0 * PI)).collect();
    all.sort_by(f64::total_cmp);
    if let (Some(own), Some(last)) = (all.last_mut(), rates.last()) {
        *own = last.norm() / (2.0 * PI);
    }
    all
}

impl Solver<'_> {
    /// The vibrations of least |s| at a solution, so many as are wanted, or all if there are fewer and not all of them are
    /// needed. Free motions and motions that do not oscillate do not count. The spectrum becomes known.
    ///
    /// # Errors
    /// Rest is not stable, or there are fewer vibrations. Steady rotation may be unstable if not all are needed.
    pub(super) fn spectrum(
        &self,
        found: &State<f64>,
        wanted: &WantedModes,
        (damped, all_needed): (bool, bool),
    ) -> Result<Spectrum, AssemblyFailure> {
        let own = match self.known.spectrum(&self.numbers, (wanted, damped)) {
            Some(known) => known,
            None => self.sought(found, wanted, (damped, all_needed))?,
        };
        match own.diverging {
            Some(rate) if all_needed => {
                let time = 1.0 / rate;
                let what = match self.given.turning {
                    Some(_) => "the rotation",
                    None => "it",
                };
                let why = format!(
                    "{what} is not stable: a motion grows by a factor of e in {time:.1e} s without an oscillation"
                );
                Err(AssemblyFailure::NoModes { why })
            }
            _ => Ok(own),
        }
    }

    /// The fastest growth of a motion in steady rotation or of a closed loop: of all motions if they are few, else of those in
    /// a spectrum.
    ///
    /// # Errors
    /// Singular equations.
    pub(super) fn fastest_growth(
        &self,
        found: &State<f64>,
        spectrum: &Spectrum,
    ) -> Result<Option<f64>, AssemblyFailure> {
        let all = match self.given.turning.is_some() || self.model.is_controlled() {
            true => self.growth_of_all(found, false)?,
            false => None,
        };
        if let Some(growth) = all {
            return Ok(growth);
        }
        let rates = spectrum.clusters.iter().flat_map(|own| &own.values);
        let growing = rates.filter(|s| s.re > GROWS * s.norm()).map(|s| s.re);
        Ok(growing.chain(spectrum.diverging).reduce(f64::max))
    }

    /// What small motions are about: the solution, with controllers that run if they have states.
    fn about<'a>(
        &'a self,
        released: &'a Option<Released<f64>>,
        found: &'a State<f64>,
    ) -> At<'a, f64> {
        match released {
            Some(own) => own.at(),
            None => At::rest(self.layout, self.model, found, self.given.turning.as_ref()),
        }
    }

    /// The fastest growth of all motions, with their damping and running controllers; none if they are many, unless `however_many`.
    ///
    /// # Errors
    /// Singular equations.
    pub(super) fn growth_of_all(
        &self,
        found: &State<f64>,
        however_many: bool,
    ) -> Result<Option<Option<f64>>, AssemblyFailure> {
        let released = Released::of((self.model, self.layout.numbering), found)?;
        let at = self.about(&released, found);
        let allowed = at.freedom();
        if allowed == 0 || !however_many && 2 * allowed > WHOLE {
            return Ok(None);
        }
        let matrices = Matrices::new(at, true);
        let rates = (found.rate.sqrt(), (FREE * found.rate).sqrt());
        let all = growing(&matrices, rates, allowed)?;
        Ok(Some(confirmed(&matrices, all.into_iter())))
    }

    /// σ of a search, and sizes |s| that count, from modes without damping: the rate of a machine of finite elements is that of
    /// the stretch of thin plates. `None` where they do not tell it.
    ///
    /// # Errors
    /// Round-off hides the modes.
    fn nearer(
        &self,
        found: &State<f64>,
        wanted: &WantedModes,
        (rate, least): (f64, f64),
    ) -> Result<Option<Scales>, AssemblyFailure> {
        if self.given.turning.is_some() || self.model.is_controlled() {
            return Ok(None);
        }
        let near = self.reach_of_modes(found, wanted)?;
        let scales = |[lowest, highest]: [f64; 2]| {
            let near = (highest, least.min(SLOWER * lowest)..f64::INFINITY);
            (highest < rate).then_some(near)
        };
        Ok(near.and_then(scales))
    }

    fn sought(
        &self,
        found: &State<f64>,
        wanted: &WantedModes,
        (damped, all_needed): (bool, bool),
    ) -> Result<Spectrum, AssemblyFailure> {
        let none = |why: String| Err(AssemblyFailure::NoModes { why });
        let turning = self.given.turning.as_ref();
        let released = Released::of((self.model, self.layout.numbering), found)?;
        // Damping ratios tell whether a closed loop is stable.
        if turning.is_none() && !(damped && self.model.is_controlled()) {
            let stability = self.with_factors(found, |own| self.stability(own, found))??;
            if let Some(why) = without_modes(&stability) {
                return none(why.into());
            }
        }
        let at = self.about(&released, found);
        let matrices = Matrices::new(at, damped).with_strains(at, damped);
        let allowed = at.freedom();
        let (rate, least) = (found.rate.sqrt(), (FREE * found.rate).sqrt());
        let near = match matrices.have_nodes() {
            true => self.nearer(found, wanted, (rate, least))?,
            false => None,
        };
        // An aggregate needs one.
        let asked = wanted.count.max(1);
        let mut count = wanted.least().max(1);
        let (values, diverging) = loop {
            let counts = (count, allowed);
            let by_rate = || lowest(&matrices, (rate, least..f64::INFINITY), counts);
            let own = match &near {
                Some(near) => lowest(&matrices, near.clone(), counts).or_else(|_| by_rate())?,
                None => by_rate()?,
            };
            let there = own.values.len();
            let grows = turning.is_some() || damped && self.model.is_controlled();
            let real = |&rate: &f64| Complex64::new(rate, 0.0);
            let diverging = match grows {
                true => confirmed(&matrices, own.diverging.iter().map(real)),
                false => None,
            };
            if own.all && there < asked && all_needed && diverging.is_none() {
                return none(format!("mode {asked} is asked for, and there are {there}"));
            }
            if own.all || wanted.reach(&frequencies(&own.values)) {
                break (own.values, diverging);
            }
            if count >= MOST_MODES {
                return none(format!(
                    "more than {MOST_MODES} modes are within reach of ρ; a larger one needs fewer"
                ));
            }
            count = (2 * count).min(MOST_MODES);
        };
        let values: Vec<Complex64> = values.into_iter().take(count).collect();
        let clusters = clusters(&matrices, &values)?;
        let mut rates = clusters.iter().flat_map(|own| &own.values);
        if !damped && rates.any(|s| s.re.abs() > GROWS * s.norm()) {
            return none("its oscillations grow without damping (flutter)".into());
        }
        let out = Spectrum {
            clusters,
            damped,
            diverging,
            wanted: *wanted,
        };
        self.known.keep_spectrum(&self.numbers, &out);
        Ok(out)
    }
}

/// The vibrations of a spectrum in any scalar, at a solution in it, exact to first order.
pub(super) fn damped_vibrations<S: Scalar>(
    at: At<S>,
    spectrum: &Spectrum,
) -> Vec<DampedVibration<S>> {
    let mut changes = vec![Complex64::new(0.0, 0.0); spectrum.clusters.len()];
    if S::INFINITESIMAL {
        let mut pairs = Vec::new();
        let mut of = Vec::new();
        for (c, own) in spectrum.clusters.iter().enumerate() {
            let damping = if spectrum.damped { 1.0 } else { 0.0 };
            let change = own.change(Complex64::new(1.0, 0.0), damping);
            of.extend(change.iter().map(|_| c));
            pairs.extend(change);
        }
        let sums = contracted(at, &pairs);
        for (c, [re, im]) in of.into_iter().zip(sums) {
            // The real parts are zero but for what is not converged.
            changes[c] += Complex64::new(re.infinitesimal(), im.infinitesimal());
        }
    }
    let one = |(c, k): (usize, usize)| {
        let own = &spectrum.clusters[c];
        let with = |x: f64, dx: f64| S::from(x) + S::of_infinitesimal(dx);
        DampedVibration {
            growth: with(own.values[k].re, changes[c].re),
            speed: with(own.values[k].im, changes[c].im),
            repeated: own.values.len() > 1,
        }
    };
    spectrum.order().into_iter().map(one).collect()
}

/// The same without damping, the lowest frequency first.
pub(super) fn undamped_vibrations<S: Scalar>(at: At<S>, spectrum: &Spectrum) -> Vec<Vibration<S>> {
    let all = damped_vibrations(at, spectrum);
    all.iter().map(DampedVibration::undamped).collect()
}

impl KnownStarts {
    fn spectrum(
        &self,
        numbers: &[f64],
        (wanted, damped): (&WantedModes, bool),
    ) -> Option<Spectrum> {
        let known = self.0.lock().ok()?;
        let mut all = known.spectra.iter();
        let own = all.find(|(own, spectrum)| {
            own == numbers && spectrum.damped == damped && spectrum.wanted == *wanted
        });
        own.map(|(_, spectrum)| spectrum.clone())
    }

    fn keep_spectrum(&self, numbers: &[f64], spectrum: &Spectrum) {
        if let Ok(mut known) = self.0.lock() {
            if known.spectra.len() == KEPT {
                known.spectra.remove(0);
            }
            known.spectra.push((numbers.to_vec(), spectrum.clone()));
        }
    }
}
