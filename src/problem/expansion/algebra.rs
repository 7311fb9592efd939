//! Sums and products of expressions. Those of numbers are numbers.

use crate::expression::{Call, Expression, Operator};

/// An expression of parameters.
pub type Formula = Expression<String>;

fn number(formula: &Formula) -> Option<f64> {
    match formula {
        Formula::Number(number) => Some(*number),
        _ => None,
    }
}

fn joined(a: Formula, operator: Operator, b: Formula) -> Formula {
    let value = match (number(&a), number(&b)) {
        (Some(a), Some(b)) => match operator {
            Operator::Plus => Some(a + b),
            Operator::Minus => Some(a - b),
            Operator::Times => Some(a * b),
            Operator::Over => Some(a / b),
            Operator::Power => None,
        },
        _ => None,
    };
    match value {
        Some(value) => Formula::Number(value),
        None => Formula::Binary(operator, Box::new([a, b])),
    }
}

/// a + b; a zero is left out.
pub fn sum(a: Formula, b: Formula) -> Formula {
    match (number(&a), number(&b)) {
        (Some(0.0), _) => b,
        (_, Some(0.0)) => a,
        _ => joined(a, Operator::Plus, b),
    }
}

/// a − b.
pub fn difference(a: Formula, b: Formula) -> Formula {
    match number(&b) {
        Some(0.0) => a,
        _ => joined(a, Operator::Minus, b),
    }
}

/// a b; a product with zero is zero.
pub fn product(a: Formula, b: Formula) -> Formula {
    match (number(&a), number(&b)) {
        (Some(0.0), _) | (_, Some(0.0)) => Formula::Number(0.0),
        (Some(1.0), _) => b,
        (_, Some(1.0)) => a,
        _ => joined(a, Operator::Times, b),
    }
}

/// a / b.
pub fn quotient(a: Formula, b: Formula) -> Formula {
    match number(&b) {
        Some(1.0) => a,
        _ => joined(a, Operator::Over, b),
    }
}

/// A function of an expression.
pub fn call(call: Call, a: Formula) -> Formula {
    let formula = Formula::Call(call, Box::new(a));
    match formula.names().is_empty() {
        true => Formula::Number(formula.value(&|_: &String| 0.0)),
        false => formula,
    }
}

/// Σ a_k b_k.
pub fn dot<const N: usize>(a: [Formula; N], b: [Formula; N]) -> Formula {
    let terms = a.into_iter().zip(b);
    terms.fold(Formula::Number(0.0), |total, (a, b)| {
        sum(total, product(a, b))
    })
}
