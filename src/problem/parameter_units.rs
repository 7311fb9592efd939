//! Units of parameters, by the numbers that follow from them.

use super::expression::Expression;
use super::pointer::of_parameter;
use super::variables::Variable;
use crate::schema::OF_PARAMETERS;
use indexmap::{IndexMap, IndexSet};

/// The expression of a parameter, if one gives it.
type Given<'a> = dyn Fn(&String) -> Option<&'a Expression<String>> + 'a;

/// What the number of an expression says about the unit of a parameter.
pub(super) struct Claim {
    /// Path of the parameter.
    path: String,
    unit: String,
    /// Whether the factor of the parameter is one, which has no unit of its own.
    certain: bool,
}

/// The value of an expression if the parameters that no expression gives have the values `of`.
fn value_at(expression: &Expression<String>, given: &Given, of: &dyn Fn(&String) -> f64) -> f64 {
    expression.value(&|name: &String| match given(name) {
        Some(own) => value_at(own, given, of),
        None => of(name),
    })
}

/// The parameters that no expression gives and that an expression follows from.
fn bases<'a>(expression: &'a Expression<String>, given: &Given<'a>) -> IndexSet<&'a String> {
    let names = expression.names().into_iter();
    let all = names.flat_map(|name| match given(name) {
        Some(own) => bases(own, given),
        None => IndexSet::from([name]),
    });
    all.collect()
}

/// The unit of a number for the parameters that its expression follows from, if it is a sum of multiples of them.
pub(super) fn claims<'a>(
    expression: &'a Expression<String>,
    unit: &str,
    values: &IndexMap<String, f64>,
    given: &Given<'a>,
) -> Vec<Claim> {
    let names = bases(expression, given);
    // At values of their size, also if they are zero in the file.
    let sizes: Vec<f64> = (names.iter())
        .map(|name| values[*name].abs().max(1.0))
        .collect();
    let at = |factor: &dyn Fn(usize) -> f64| {
        let place = |name: &String| {
            names
                .get_index_of(name)
                .expect("a parameter of the expression")
        };
        value_at(expression, given, &|name| {
            factor(place(name)) * sizes[place(name)]
        })
    };
    let parts: Vec<f64> = (0..names.len())
        .map(|i| at(&|k| if k == i { 1.0 } else { 0.0 }))
        .collect();
    let is_sum = |factor: &dyn Fn(usize) -> f64| {
        let terms = parts.iter().enumerate().map(|(k, part)| factor(k) * part);
        let size: f64 = terms.clone().map(f64::abs).sum();
        (at(factor) - terms.sum::<f64>()).abs() <= 1e-12 * size
    };
    let alternating: [[f64; 2]; 3] = [[1.0, 1.0], [0.6, 1.7], [1.7, 0.6]];
    let linear = (alternating.iter()).all(|own| is_sum(&|k| own[k % 2]));
    if !linear || !parts.iter().all(|part| part.is_normal()) {
        return Vec::new();
    }
    let claim = |(name, factor): (&&String, f64)| Claim {
        path: of_parameter(name),
        unit: unit.to_owned(),
        certain: (factor.abs() - 1.0).abs() < 1e-12,
    };
    let factors = parts.iter().zip(&sizes).map(|(part, size)| part / size);
    names.iter().zip(factors).map(claim).collect()
}

/// Gives variables of parameters their units. Factors may have units of their own, so those of claims without a factor
/// come first, and claims that differ are none.
pub(super) fn give(claims: &[Claim], variables: &mut [Variable]) {
    for variable in variables.iter_mut().filter(|own| own.unit == OF_PARAMETERS) {
        let of_this = claims
            .iter()
            .filter(|claim| variable.paths.contains(&claim.path));
        let (certain, others): (Vec<&Claim>, Vec<&Claim>) =
            of_this.partition(|claim| claim.certain);
        let counting = if certain.is_empty() { others } else { certain };
        let mut units = counting.into_iter().map(|claim| &claim.unit);
        if let Some(first) = units
            .next()
            .filter(|first| units.all(|unit| unit == *first))
        {
            first.clone_into(&mut variable.unit);
        }
    }
}
