//! Functions that expressions of other functions give: f = e(g_1, …, g_k, p), with the values g of other functions and
//! the parameters p of the file. Their derivatives are ∇f = Σ ∂e/∂g_i ∇g_i + ∂e/∂p ∇p.
//!
//! Functions of the scene come first, in the order of the file, then those of expressions, each after those that it names.

use super::Variable;
use super::derived::Derived;
use super::expression::{Expression, Operator};
use crate::math::{Dual, Scalar};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What a name of an expression stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// The function of this index.
    Function(usize),
    /// A number of the file.
    Fixed(f64),
    /// A place in the design and the numbers that follow from it.
    Place(usize),
}

/// A function that an expression gives.
#[derive(Clone, Debug, PartialEq)]
pub struct Composed {
    /// The expression.
    pub expression: Expression<Term>,
    /// SI unit; empty if it is not known.
    pub unit: String,
}

/// The functions of a problem that expressions give.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Composition {
    /// Number of functions of the scene.
    pub first: usize,
    /// The others. Each names only functions before it.
    pub list: Vec<Composed>,
    /// Numbers that follow from a design.
    pub derived: Derived,
}

/// Σ ((x − x0)/s)² from the start x0, each variable in its scale s.
pub(super) fn distance_from_start(variables: &[Variable]) -> Composed {
    let both = |operator, a, b| Expression::Binary(operator, Box::new([a, b]));
    let square = |(place, own): (usize, &Variable)| {
        let start = Expression::Number(own.start);
        let change = both(Operator::Minus, Expression::Name(Term::Place(place)), start);
        let scaled = both(Operator::Over, change, Expression::Number(own.scale));
        both(Operator::Power, scaled, Expression::Number(2.0))
    };
    let squares = variables.iter().enumerate().map(square);
    let sum = squares.reduce(|sum, own| both(Operator::Plus, sum, own));
    Composed {
        expression: sum.unwrap_or(Expression::Number(0.0)),
        unit: "1".to_owned(),
    }
}

/// The value of an expression that neither functions nor variables change.
fn fixed(of: &Expression<Term>) -> Option<f64> {
    let fixed = |term: &&Term| matches!(term, Term::Fixed(_));
    of.names().iter().all(fixed).then(|| {
        of.value(&|term: &Term| match term {
            Term::Fixed(number) => *number,
            Term::Function(_) | Term::Place(_) => f64::NAN,
        })
    })
}

/// Derivatives of an expression.
#[derive(Clone, Debug, PartialEq)]
pub struct Partials {
    /// By the functions of the scene on which it depends.
    pub by_function: Vec<(usize, f64)>,
    /// By each design variable, with these functions fixed.
    pub by_variable: Vec<f64>,
}

impl Composition {
    /// Whether an expression gives function f.
    pub fn gives(&self, f: usize) -> bool {
        !self.list.is_empty() && f >= self.first
    }

    /// Whether an expression names function f.
    pub fn names(&self, f: usize) -> bool {
        let mut all = self.list.iter().flat_map(|own| own.expression.names());
        all.any(|term| *term == Term::Function(f))
    }

    /// For each expression: whether a function of `which` needs it.
    fn needed(&self, which: &[usize]) -> Vec<bool> {
        let mut needed = vec![false; self.list.len()];
        for &f in which.iter().filter(|&&f| self.gives(f)) {
            needed[f - self.first] = true;
        }
        for k in (0..self.list.len()).rev() {
            if !needed[k] {
                continue;
            }
            for term in self.list[k].expression.names() {
                if let Term::Function(g) = *term
                    && self.gives(g)
                {
                    needed[g - self.first] = true;
                }
            }
        }
        needed
    }

    /// Functions `which` and the expressions that they need.
    pub fn with_expressions(&self, which: &[usize]) -> Vec<usize> {
        let needed = self.needed(which).into_iter().enumerate();
        let composed = needed.filter(|(_, needed)| *needed);
        let own = which.iter().copied().filter(|&f| !self.gives(f));
        own.chain(composed.map(|(k, _)| self.first + k)).collect()
    }

    /// The functions of the scene that the functions `which` need; `which` itself if it has no expressions.
    pub fn of_scene<'w>(&self, which: &'w [usize]) -> Cow<'w, [usize]> {
        if !which.iter().any(|&f| self.gives(f)) {
            return Cow::Borrowed(which);
        }
        let all = self.with_expressions(which);
        let mut own: Vec<usize> = Vec::new();
        for f in all {
            match self.gives(f) {
                false => own.push(f),
                true => {
                    let terms = self.list[f - self.first].expression.names();
                    own.extend(terms.into_iter().filter_map(|term| match *term {
                        Term::Function(g) if !self.gives(g) => Some(g),
                        _ => None,
                    }));
                }
            }
        }
        own.sort_unstable();
        own.dedup();
        Cow::Owned(own)
    }

    /// The functions f_g of the scene and their factors in f = Σ c_g f_g, if function f is such a sum with factors that no
    /// variable changes.
    pub fn sum(&self, f: usize) -> Option<Vec<(usize, f64)>> {
        let mut factors = BTreeMap::new();
        self.add(f, 1.0, &mut factors)?;
        Some(factors.into_iter().collect())
    }

    fn add(&self, f: usize, factor: f64, to: &mut BTreeMap<usize, f64>) -> Option<()> {
        match self.gives(f) {
            true => self.add_terms(&self.list[f - self.first].expression, factor, to),
            false => {
                *to.entry(f).or_default() += factor;
                Some(())
            }
        }
    }

    fn add_terms(
        &self,
        of: &Expression<Term>,
        factor: f64,
        to: &mut BTreeMap<usize, f64>,
    ) -> Option<()> {
        match of {
            Expression::Name(Term::Function(g)) => self.add(*g, factor, to),
            Expression::Minus(of) => self.add_terms(of, -factor, to),
            Expression::Binary(operator, of) => {
                let [a, b] = &**of;
                match operator {
                    Operator::Plus | Operator::Minus => {
                        let sign = if *operator == Operator::Plus {
                            1.0
                        } else {
                            -1.0
                        };
                        self.add_terms(a, factor, to)?;
                        self.add_terms(b, sign * factor, to)
                    }
                    Operator::Times => match (fixed(a), fixed(b)) {
                        (Some(c), _) => self.add_terms(b, c * factor, to),
                        (_, Some(c)) => self.add_terms(a, c * factor, to),
                        _ => None,
                    },
                    Operator::Over => self.add_terms(a, factor / fixed(b)?, to),
                    Operator::Power => None,
                }
            }
            Expression::Number(_)
            | Expression::Name(_)
            | Expression::Call(..)
            | Expression::Ks(..)
            | Expression::Angle(_) => None,
        }
    }

    /// Value of function f at the design `x`, with those of functions of the scene.
    pub fn value<S: Scalar>(&self, f: usize, x: &[S], of: &impl Fn(usize) -> S) -> S {
        if !self.gives(f) {
            return of(f);
        }
        let own = self.of_scene(&[f]).iter().map(|&g| (g, of(g))).collect();
        self.follow(f, &self.derived.extend(x), own)
    }

    /// What function f stands for, with the true values of functions of the scene; `None` if no expression smooths it.
    pub fn sharp(&self, f: usize, x: &[f64], of: &impl Fn(usize) -> f64) -> Option<f64> {
        let needed = self.needed(&[f]);
        let mut parts = needed.iter().zip(&self.list).filter(|(needed, _)| **needed);
        if !parts.any(|(_, own)| own.expression.is_smoothed()) {
            return None;
        }
        let mut sharp = self.clone();
        for own in &mut sharp.list {
            own.expression = own.expression.sharp();
        }
        Some(sharp.value(f, x, of))
    }

    /// ρ of function f, if it is a smooth bound over cases.
    pub fn rho(&self, f: usize) -> Option<f64> {
        let own = self.list.get(f.checked_sub(self.first)?)?;
        match &own.expression {
            Expression::Ks(rho, _) => Some(*rho),
            Expression::Minus(inner) => match &**inner {
                Expression::Ks(rho, _) => Some(*rho),
                _ => None,
            },
            _ => None,
        }
    }

    /// Value of function f, with those of functions of the scene and the numbers that terms may be.
    fn follow<S: Scalar>(&self, f: usize, numbers: &[S], mut known: BTreeMap<usize, S>) -> S {
        let needed = self.needed(&[f]);
        for (k, own) in self.list.iter().enumerate() {
            if needed[k] {
                let value = own.expression.value(&|term: &Term| match *term {
                    Term::Function(g) => known[&g],
                    Term::Fixed(number) => S::from(number),
                    Term::Place(place) => numbers[place],
                });
                known.insert(self.first + k, value);
            }
        }
        known[&f]
    }

    /// Derivatives of function f at the design `x`, with the values of functions of the scene.
    pub fn partials(&self, f: usize, x: &[f64], of: &impl Fn(usize) -> f64) -> Partials {
        let functions = self.of_scene(&[f]).into_owned();
        let values: Vec<f64> = functions.iter().map(|&g| of(g)).collect();
        let numbers = self.derived.extend(x);
        let seeded = |all: &[f64], which: Option<usize>| -> Vec<Dual> {
            let one = |(k, &value): (usize, &f64)| {
                Dual::new(value, f64::from(u8::from(which == Some(k))))
            };
            all.iter().enumerate().map(one).collect()
        };
        let along = |function: Option<usize>, place: Option<usize>| {
            let values = seeded(&values, function);
            let known = functions.iter().copied().zip(values).collect();
            self.follow(f, &seeded(&numbers, place), known).du
        };
        let by_function = functions.iter().enumerate();
        let by_function = by_function
            .map(|(k, &g)| (g, along(Some(k), None)))
            .collect();
        let mut by_variable = vec![0.0; x.len()];
        let needed = self.needed(&[f]).into_iter().zip(&self.list);
        let terms = needed.filter(|(needed, _)| *needed);
        let mut places: Vec<usize> = terms
            .flat_map(|(_, own)| own.expression.names())
            .filter_map(|term| match *term {
                Term::Place(place) => Some(place),
                Term::Function(_) | Term::Fixed(_) => None,
            })
            .collect();
        places.sort_unstable();
        places.dedup();
        let (own, follow): (Vec<usize>, Vec<usize>) =
            places.into_iter().partition(|&place| place < x.len());
        for place in own {
            by_variable[place] += along(None, Some(place));
        }
        if !follow.is_empty() {
            let slopes: Vec<f64> = (follow.iter())
                .map(|&place| along(None, Some(place)))
                .collect();
            for (i, by) in by_variable.iter_mut().enumerate() {
                let moved = self.derived.by_variable(x, i);
                let pairs = follow.iter().zip(&slopes);
                *by += pairs
                    .map(|(&place, slope)| slope * moved[place - x.len()])
                    .sum::<f64>();
            }
        }
        Partials {
            by_function,
            by_variable,
        }
    }

    /// The same of the functions `kept` of the scene and the expressions `asked`, which need no other, and the indices
    /// of these expressions before.
    pub fn focused(&self, kept: &[usize], asked: &[usize]) -> (Self, Vec<usize>) {
        let needed = self.needed(asked);
        let own: Vec<usize> = (0..self.list.len()).filter(|&k| needed[k]).collect();
        let renamed = |term: &Term| -> Result<Term, ()> {
            Ok(match *term {
                Term::Function(g) if self.gives(g) => {
                    let place = own.binary_search(&(g - self.first)).map_err(|_| ())?;
                    Term::Function(kept.len() + place)
                }
                Term::Function(g) => Term::Function(kept.binary_search(&g).map_err(|_| ())?),
                other => other,
            })
        };
        let list = own.iter().filter_map(|&k| {
            let Composed { expression, unit } = &self.list[k];
            Some(Composed {
                expression: expression.named(&mut |term| renamed(term)).ok()?,
                unit: unit.clone(),
            })
        });
        let focused = Self {
            first: kept.len(),
            list: list.collect(),
            derived: self.derived.clone(),
        };
        (focused, own.into_iter().map(|k| self.first + k).collect())
    }
}
