//! Lists of a few values without memory of their own on the heap.

use std::ops::{Deref, DerefMut};

/// At most N values in place, of which as many count as were given. What is left holds defaults, so that lists are
/// equal if their values are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ArrayVec<T, const N: usize> {
    count: usize,
    values: [T; N],
}

impl<T: Copy + Default, const N: usize> ArrayVec<T, N> {
    /// The list of the values of `f` at 0 .. `count`, N of them at most.
    pub fn from_fn(count: usize, mut f: impl FnMut(usize) -> T) -> Self {
        let count = count.min(N);
        let value = |k: usize| if k < count { f(k) } else { T::default() };
        Self {
            count,
            values: std::array::from_fn(value),
        }
    }

    /// The list of the values of `f` at each of these.
    pub fn map<U: Copy + Default>(&self, mut f: impl FnMut(T) -> U) -> ArrayVec<U, N> {
        ArrayVec::from_fn(self.count, |k| f(self.values[k]))
    }
}

impl<T: Copy, const N: usize> ArrayVec<T, N> {
    /// The values of `f` at each of these, and `rest` in the places that are left.
    pub fn gather<U: Copy>(&self, rest: U, mut f: impl FnMut(T) -> U) -> [U; N] {
        let mut all = [rest; N];
        for (to, &value) in all.iter_mut().zip(self.iter()) {
            *to = f(value);
        }
        all
    }

    /// All N places.
    #[inline(always)]
    pub fn places(&self) -> &[T; N] {
        &self.values
    }
}

impl<T, const N: usize> Deref for ArrayVec<T, N> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        &self.values[..self.count]
    }
}

impl<T, const N: usize> DerefMut for ArrayVec<T, N> {
    fn deref_mut(&mut self) -> &mut [T] {
        &mut self.values[..self.count]
    }
}

impl<'a, T, const N: usize> IntoIterator for &'a ArrayVec<T, N> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<T, const N: usize> IntoIterator for ArrayVec<T, N> {
    type Item = T;
    type IntoIter = std::iter::Take<std::array::IntoIter<T, N>>;

    fn into_iter(self) -> Self::IntoIter {
        self.values.into_iter().take(self.count)
    }
}

impl<T: Copy + Default, const M: usize, const N: usize> From<[T; M]> for ArrayVec<T, N> {
    /// A list that has room for all values, which is known when a program is compiled.
    fn from(values: [T; M]) -> Self {
        const { assert!(M <= N, "more values than a list has places") };
        Self::from_fn(M, |k| values[k])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_the_values_that_it_was_given_and_no_more() {
        let list: ArrayVec<usize, 9> = [3, 1, 4, 1].into();
        assert_eq!(&list[..], [3, 1, 4, 1]);
        assert_eq!(&list.map(|x| 2 * x)[..], [6, 2, 8, 2]);
        assert_eq!(list.gather(7, |x| x + 1), [4, 2, 5, 2, 7, 7, 7, 7, 7]);
        assert_eq!(list.into_iter().sum::<usize>(), 9);
        let mut reversed = list;
        reversed.reverse();
        assert_eq!(&reversed[..], [1, 4, 1, 3]);
        assert_ne!(reversed, list);
        assert_eq!(ArrayVec::from_fn(4, |k| reversed[3 - k]), list);
        // No more than there is room for.
        assert_eq!(ArrayVec::<usize, 3>::from_fn(5, |k| k).len(), 3);
    }
}
