//! Motions in time of a file, of drives and of references.

use super::placement::Assembly;
use crate::math::Scalar;
use crate::model::{SCurve, Smoothness, TimeFunction};
use crate::quantity::Quantity;
use crate::schema::drives::TimeFunction as Written;
use crate::schema::loads::Interpolation;

/// A motion in time.
pub(super) fn course<S: Scalar>(assembly: &Assembly<S>, written: Written) -> TimeFunction<S> {
    let get = |quantity: &Quantity| assembly.quantity(quantity);
    match written {
        Written::Rate(rate) => TimeFunction::Polynomial(vec![S::zero(), get(rate)]),
        Written::Polynomial(coefficients) => {
            TimeFunction::Polynomial(coefficients.iter().map(get).collect())
        }
        Written::Harmonic([mean, amplitude, frequency, phase]) => TimeFunction::Harmonic {
            mean: get(mean),
            amplitude: get(amplitude),
            frequency: get(frequency),
            phase: get(phase),
        },
        Written::SCurve([from, to, start, speed, acceleration]) => TimeFunction::SCurve(SCurve {
            from: get(from),
            to: get(to),
            start: get(start),
            speed: get(speed),
            acceleration: get(acceleration),
        }),
        Written::Table(times, values, interpolation) => TimeFunction::Table {
            interpolation: Interpolation::of(interpolation),
            smoothness: Smoothness::Motion,
            times: times.iter().map(|&t| t.into()).collect(),
            values: values.iter().map(get).collect(),
        },
    }
}
