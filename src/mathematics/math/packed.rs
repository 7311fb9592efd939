//! Data as lists of numbers, in which processes send them.

use nalgebra::{ArrayStorage, Const, Matrix};

/// What can be sent as numbers. Every bit of a number is kept.
pub trait Packed: Sized {
    /// Appends the numbers.
    fn pack(&self, out: &mut Vec<f64>);

    /// Reads them back, from the front.
    ///
    /// # Panics
    /// There are too few.
    fn unpack(from: &mut &[f64]) -> Self;
}

/// The first of some numbers, which is then gone.
fn next(from: &mut &[f64]) -> f64 {
    let (&first, rest) = from.split_first().expect("as many numbers as were packed");
    *from = rest;
    first
}

impl Packed for f64 {
    fn pack(&self, out: &mut Vec<f64>) {
        out.push(*self);
    }

    fn unpack(from: &mut &[f64]) -> Self {
        next(from)
    }
}

impl Packed for usize {
    fn pack(&self, out: &mut Vec<f64>) {
        out.push(*self as f64);
    }

    fn unpack(from: &mut &[f64]) -> Self {
        next(from) as Self
    }
}

impl<T: Packed, const N: usize> Packed for [T; N] {
    fn pack(&self, out: &mut Vec<f64>) {
        self.iter().for_each(|own| own.pack(out));
    }

    fn unpack(from: &mut &[f64]) -> Self {
        std::array::from_fn(|_| T::unpack(from))
    }
}

impl<S: Packed + nalgebra::Scalar, const R: usize, const C: usize> Packed
    for Matrix<S, Const<R>, Const<C>, ArrayStorage<S, R, C>>
{
    fn pack(&self, out: &mut Vec<f64>) {
        self.iter().for_each(|own| own.pack(out));
    }

    fn unpack(from: &mut &[f64]) -> Self {
        // By columns, as it is stored.
        Self::from_array_storage(ArrayStorage(Packed::unpack(from)))
    }
}

impl<T: Packed> Packed for Vec<T> {
    fn pack(&self, out: &mut Vec<f64>) {
        self.len().pack(out);
        self.iter().for_each(|own| own.pack(out));
    }

    fn unpack(from: &mut &[f64]) -> Self {
        let count = usize::unpack(from);
        (0..count).map(|_| T::unpack(from)).collect()
    }
}

impl<T: Packed> Packed for Option<T> {
    fn pack(&self, out: &mut Vec<f64>) {
        usize::from(self.is_some()).pack(out);
        self.iter().for_each(|own| own.pack(out));
    }

    fn unpack(from: &mut &[f64]) -> Self {
        (usize::unpack(from) > 0).then(|| T::unpack(from))
    }
}

impl<A: Packed, B: Packed> Packed for (A, B) {
    fn pack(&self, out: &mut Vec<f64>) {
        self.0.pack(out);
        self.1.pack(out);
    }

    fn unpack(from: &mut &[f64]) -> Self {
        (A::unpack(from), B::unpack(from))
    }
}

impl<A: Packed, B: Packed, C: Packed> Packed for (A, B, C) {
    fn pack(&self, out: &mut Vec<f64>) {
        self.0.pack(out);
        self.1.pack(out);
        self.2.pack(out);
    }

    fn unpack(from: &mut &[f64]) -> Self {
        (A::unpack(from), B::unpack(from), C::unpack(from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    #[test]
    fn what_is_packed_comes_back_to_the_bit() {
        let given = (
            vec![0.1, -0.0, f64::NAN, 1e-300],
            [Some(1.0 / 3.0), None],
            (
                Matrix3::new(1., 2., 3., 4., 5., 6., 7., 8., 9.),
                Vector3::<f64>::x(),
                7_usize,
            ),
        );
        let mut numbers = Vec::new();
        given.pack(&mut numbers);
        let mut rest = &numbers[..];
        type Given = (
            Vec<f64>,
            [Option<f64>; 2],
            (Matrix3<f64>, Vector3<f64>, usize),
        );
        let back = Given::unpack(&mut rest);
        assert!(rest.is_empty());
        assert_eq!((&back.1, &back.2), (&given.1, &given.2));
        let bits = |own: &[f64]| own.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
        assert_eq!(bits(&back.0), bits(&given.0));
    }
}
