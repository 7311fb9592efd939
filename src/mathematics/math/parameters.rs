//! One list of parameters per type: what a design can change, in a fixed order.
//!
//! The same types carry values, complex steps and dual numbers, and cotangents have the shape of
//! their objects. So every type with parameters maps from scalar to scalar.

use super::Scalar;
use nalgebra::SMatrix;

/// A value with parameters of the scalar `S`.
pub trait Parameters<S: Scalar> {
    /// The same type with another scalar.
    type Of<T: Scalar>;

    /// The value with `f` applied to every parameter, in a fixed order.
    fn map<T: Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> Self::Of<T>;
}

impl<S: Scalar> Parameters<S> for S {
    type Of<T: Scalar> = T;

    fn map<T: Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> T {
        f(*self)
    }
}

impl<S: Scalar, const R: usize, const C: usize> Parameters<S> for SMatrix<S, R, C> {
    type Of<T: Scalar> = SMatrix<T, R, C>;

    fn map<T: Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> SMatrix<T, R, C> {
        SMatrix::map(self, f)
    }
}

impl<S: Scalar, P: Parameters<S>, const N: usize> Parameters<S> for [P; N] {
    type Of<T: Scalar> = [P::Of<T>; N];

    fn map<T: Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> [P::Of<T>; N] {
        self.each_ref().map(|own| own.map(f))
    }
}

impl<S: Scalar, P: Parameters<S>> Parameters<S> for Vec<P> {
    type Of<T: Scalar> = Vec<P::Of<T>>;

    fn map<T: Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> Vec<P::Of<T>> {
        self.iter().map(|own| own.map(f)).collect()
    }
}

impl<S: Scalar, A: Parameters<S>, B: Parameters<S>> Parameters<S> for (A, B) {
    type Of<T: Scalar> = (A::Of<T>, B::Of<T>);

    fn map<T: Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> Self::Of<T> {
        (self.0.map(f), self.1.map(f))
    }
}

impl<S: Scalar, P: Parameters<S>> Parameters<S> for Option<P> {
    type Of<T: Scalar> = Option<P::Of<T>>;

    fn map<T: Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> Option<P::Of<T>> {
        self.as_ref().map(|own| own.map(f))
    }
}

/// Implements [`Parameters`] for a struct or enum from one list of its fields: `constants;
/// parameters`. A forgotten field does not compile.
#[macro_export]
macro_rules! parameters {
    (struct $name:ident { $($constant:ident),*; $($own:ident),* }) => {
        impl<S: $crate::math::Scalar> $crate::math::Parameters<S> for $name<S> {
            type Of<T: $crate::math::Scalar> = $name<T>;

            fn map<T: $crate::math::Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> $name<T> {
                $name {
                    $($own: $crate::math::Parameters::map(&self.$own, f),)*
                    $($constant: self.$constant.clone(),)*
                }
            }
        }
    };
    (enum $name:ident { $(
        $variant:ident
        $({ $($constant:ident),*; $($own:ident),* })?
        $(( $($fixed:ident),*; $($part:ident),* ))?
    ),* $(,)? }) => {
        impl<S: $crate::math::Scalar> $crate::math::Parameters<S> for $name<S> {
            type Of<T: $crate::math::Scalar> = $name<T>;

            fn map<T: $crate::math::Scalar>(&self, f: &mut dyn FnMut(S) -> T) -> $name<T> {
                match self { $(
                    $name::$variant $({ $($constant,)* $($own,)* })? $(( $($fixed,)* $($part,)* ))? => {
                        $name::$variant $({
                            $($own: $crate::math::Parameters::map($own, f),)*
                            $($constant: $constant.clone(),)*
                        })? $((
                            $($fixed.clone(),)*
                            $($crate::math::Parameters::map($part, f),)*
                        ))?
                    }
                )* }
            }
        }
    };
}
#[doc(inline)]
pub use crate::parameters;
