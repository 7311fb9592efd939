//! The scalar of all formulas: real, complex (complex step) or dual (forward mode).

use super::packed::Packed;
use nalgebra::{Matrix3, Vector3};
use num_traits::{One, Zero};
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// Column vector of three scalars.
pub type Vec3<S> = Vector3<S>;
/// Square matrix of three rows.
pub type Mat3<S> = Matrix3<S>;
/// The scalar of the complex-step derivative.
pub type Complex64 = num_complex::Complex<f64>;

/// Step of the complex-step derivative. It may be tiny because nothing is subtracted (Martins,
/// Sturdza & Alonso 2003, eq. 6).
pub const COMPLEX_STEP: f64 = 1e-30;

/// A number in which analytic formulas are evaluated.
///
/// It has only analytic functions: no absolute value, no conjugate, no ordering. A branch may
/// depend only on [`Scalar::re`]. So a formula in `S: Scalar` gives its value in `f64`, and its
/// exact derivative in [`Complex64`] (complex step) and in [`Dual`].
pub trait Scalar:
    Copy
    + Debug
    + Packed
    + PartialEq
    + Send
    + Sync
    + 'static
    + Zero
    + One
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// Whether the number has an infinitesimal part (a derivative).
    const INFINITESIMAL: bool;
    /// Real part. A branch may depend only on it.
    fn re(self) -> f64;
    /// Infinitesimal part; zero for a real number. No branch may depend on it.
    fn infinitesimal(self) -> f64;
    /// The number with this infinitesimal part and real part zero; zero for real numbers.
    fn of_infinitesimal(x: f64) -> Self;
    /// Square root (principal branch).
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm (principal branch).
    fn ln(self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// Angle of the point (x, y) = (`other`, `self`), in (−π, π], exact to first order in the
    /// infinitesimal part.
    fn atan2(self, other: Self) -> Self;
    /// True if every component is finite.
    fn is_finite(self) -> bool;
}

impl Scalar for f64 {
    const INFINITESIMAL: bool = false;
    fn re(self) -> f64 {
        self
    }
    fn infinitesimal(self) -> f64 {
        0.0
    }
    fn of_infinitesimal(_: f64) -> Self {
        0.0
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn exp(self) -> Self {
        f64::exp(self)
    }
    fn ln(self) -> Self {
        f64::ln(self)
    }
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
    fn atan2(self, other: Self) -> Self {
        f64::atan2(self, other)
    }
    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }
}

impl Scalar for Complex64 {
    const INFINITESIMAL: bool = true;
    fn re(self) -> f64 {
        self.re
    }
    fn infinitesimal(self) -> f64 {
        self.im
    }
    fn of_infinitesimal(x: f64) -> Self {
        Complex64::new(0.0, x)
    }
    fn sqrt(self) -> Self {
        // Cartesian form to first order in the imaginary part. The polar form loses digits of a
        // tiny imaginary part.
        let root = self.re.sqrt();
        Complex64::new(root, self.im / (2.0 * root))
    }
    fn exp(self) -> Self {
        let e = self.re.exp();
        Complex64::new(e, e * self.im)
    }
    fn ln(self) -> Self {
        Complex64::new(self.re.ln(), self.im / self.re)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.re.sin_cos();
        (
            Complex64::new(s, c * self.im),
            Complex64::new(c, -s * self.im),
        )
    }
    fn atan2(self, other: Self) -> Self {
        let r2 = self.re * self.re + other.re * other.re;
        Complex64::new(
            self.re.atan2(other.re),
            (other.re * self.im - self.re * other.im) / r2,
        )
    }
    fn is_finite(self) -> bool {
        self.re.is_finite() && self.im.is_finite()
    }
}

/// Dual number a + ε b with ε² = 0: value and derivative in one direction.
///
/// It carries the derivative of model parameters in design variables. The check of the total
/// gradient uses [`Complex64`], so neither verifies itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual {
    /// Value.
    pub re: f64,
    /// Derivative.
    pub du: f64,
}

impl Dual {
    /// The dual number `re` + ε `du`.
    pub fn new(re: f64, du: f64) -> Self {
        Self { re, du }
    }
}

impl From<f64> for Dual {
    fn from(re: f64) -> Self {
        Self::new(re, 0.0)
    }
}

impl Zero for Dual {
    fn zero() -> Self {
        Self::new(0.0, 0.0)
    }
    fn is_zero(&self) -> bool {
        self.re == 0.0 && self.du == 0.0
    }
}

impl One for Dual {
    fn one() -> Self {
        Self::new(1.0, 0.0)
    }
}

impl Neg for Dual {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.re, -self.du)
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.re + o.re, self.du + o.du)
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.re - o.re, self.du - o.du)
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self::new(self.re * o.re, self.du * o.re + self.re * o.du)
    }
}

impl Div for Dual {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let re = self.re / o.re;
        Self::new(re, (self.du - re * o.du) / o.re)
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    fn add(self, o: f64) -> Self {
        Self::new(self.re + o, self.du)
    }
}

impl Sub<f64> for Dual {
    type Output = Self;
    fn sub(self, o: f64) -> Self {
        Self::new(self.re - o, self.du)
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        Self::new(self.re * o, self.du * o)
    }
}

impl Div<f64> for Dual {
    type Output = Self;
    fn div(self, o: f64) -> Self {
        Self::new(self.re / o, self.du / o)
    }
}

impl AddAssign for Dual {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Dual {
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

impl MulAssign for Dual {
    fn mul_assign(&mut self, o: Self) {
        *self = *self * o;
    }
}

impl DivAssign for Dual {
    fn div_assign(&mut self, o: Self) {
        *self = *self / o;
    }
}

impl Scalar for Dual {
    const INFINITESIMAL: bool = true;
    fn re(self) -> f64 {
        self.re
    }
    fn infinitesimal(self) -> f64 {
        self.du
    }
    fn of_infinitesimal(x: f64) -> Self {
        Dual::new(0.0, x)
    }
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        Self::new(root, self.du / (2.0 * root))
    }
    fn exp(self) -> Self {
        let e = self.re.exp();
        Self::new(e, e * self.du)
    }
    fn ln(self) -> Self {
        Self::new(self.re.ln(), self.du / self.re)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = self.re.sin_cos();
        (Self::new(s, c * self.du), Self::new(c, -s * self.du))
    }
    fn atan2(self, other: Self) -> Self {
        let r2 = self.re * self.re + other.re * other.re;
        Self::new(
            self.re.atan2(other.re),
            (other.re * self.du - self.re * other.du) / r2,
        )
    }
    fn is_finite(self) -> bool {
        self.re.is_finite() && self.du.is_finite()
    }
}

/// Length √(aᵀa). It is analytic: no number is conjugated.
pub fn length<S: Scalar>(a: &Vec3<S>) -> S {
    a.dot(a).sqrt()
}

/// The unit vector along `a`.
pub fn unit<S: Scalar>(a: Vec3<S>) -> Vec3<S> {
    a * (S::one() / length(&a))
}

/// A constant vector in the scalar `S`.
pub fn lift3<S: Scalar>(a: &Vec3<f64>) -> Vec3<S> {
    a.map(S::from)
}

/// aᵀ b of a constant vector b.
#[inline]
pub fn along<S: Scalar>(a: &Vec3<S>, b: &Vec3<f64>) -> S {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// The matrix ã of the cross product, ã b = a × b.
pub fn skew<S: Scalar>(a: &Vec3<S>) -> Mat3<S> {
    let z = S::zero();
    Mat3::new(z, -a.z, a.y, a.z, z, -a.x, -a.y, a.x, z)
}

impl Packed for Complex64 {
    fn pack(&self, out: &mut Vec<f64>) {
        [self.re, self.im].pack(out);
    }

    fn unpack(from: &mut &[f64]) -> Self {
        let [re, im] = Packed::unpack(from);
        Self::new(re, im)
    }
}

impl Packed for Dual {
    fn pack(&self, out: &mut Vec<f64>) {
        [self.re, self.du].pack(out);
    }

    fn unpack(from: &mut &[f64]) -> Self {
        let [re, du] = Packed::unpack(from);
        Self { re, du }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f(x) = atan2(sin x, 2 + cos x) · √(1 + eˣ) / ln(3 + x) in any scalar.
    fn formula<S: Scalar>(x: S) -> S {
        let (s, c) = x.sin_cos();
        s.atan2(c + 2.0) * (x.exp() + 1.0).sqrt() / (x + 3.0).ln()
    }

    #[test]
    fn dual_and_complex_derivatives_agree_with_each_other_and_with_differences() {
        for x in [-1.3, 0.2, 2.5] {
            let dual = formula(Dual::new(x, 1.0)).du;
            let complex = formula(Complex64::new(x, COMPLEX_STEP)).im / COMPLEX_STEP;
            let h = 1e-6;
            let difference = (formula(x + h) - formula(x - h)) / (2.0 * h);
            assert!((dual - complex).abs() <= 1e-14 * dual.abs().max(1.0));
            assert!((dual - difference).abs() <= 1e-8 * dual.abs().max(1.0));
            assert_eq!(formula(Dual::new(x, 1.0)).re, formula(x));
        }
    }
}
