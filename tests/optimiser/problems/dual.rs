//! Forward-mode dual numbers, which give the test problems exact gradients.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Value and derivative in one direction.
#[derive(Clone, Copy, Debug)]
pub struct Dual {
    pub value: f64,
    pub slope: f64,
}

impl Dual {
    fn chain(self, value: f64, derivative: f64) -> Dual {
        Dual {
            value,
            slope: derivative * self.slope,
        }
    }

    pub fn exp(self) -> Dual {
        self.chain(self.value.exp(), self.value.exp())
    }

    pub fn ln(self) -> Dual {
        self.chain(self.value.ln(), 1.0 / self.value)
    }

    pub fn sin(self) -> Dual {
        self.chain(self.value.sin(), self.value.cos())
    }

    pub fn cos(self) -> Dual {
        self.chain(self.value.cos(), -self.value.sin())
    }

    pub fn sqrt(self) -> Dual {
        self.chain(self.value.sqrt(), 0.5 / self.value.sqrt())
    }

    pub fn powi(self, n: i32) -> Dual {
        self.chain(self.value.powi(n), f64::from(n) * self.value.powi(n - 1))
    }

    pub fn powf(self, p: f64) -> Dual {
        self.chain(self.value.powf(p), p * self.value.powf(p - 1.0))
    }

    /// Positive base to a variable power.
    pub fn pow(self, p: Dual) -> Dual {
        (p * self.ln()).exp()
    }
}

impl From<f64> for Dual {
    fn from(value: f64) -> Dual {
        Dual { value, slope: 0.0 }
    }
}

impl Neg for Dual {
    type Output = Dual;
    fn neg(self) -> Dual {
        Dual {
            value: -self.value,
            slope: -self.slope,
        }
    }
}

impl Add for Dual {
    type Output = Dual;
    fn add(self, o: Dual) -> Dual {
        Dual {
            value: self.value + o.value,
            slope: self.slope + o.slope,
        }
    }
}

impl Sub for Dual {
    type Output = Dual;
    fn sub(self, o: Dual) -> Dual {
        Dual {
            value: self.value - o.value,
            slope: self.slope - o.slope,
        }
    }
}

impl Mul for Dual {
    type Output = Dual;
    fn mul(self, o: Dual) -> Dual {
        Dual {
            value: self.value * o.value,
            slope: self.slope * o.value + self.value * o.slope,
        }
    }
}

impl Div for Dual {
    type Output = Dual;
    fn div(self, o: Dual) -> Dual {
        let value = self.value / o.value;
        Dual {
            value,
            slope: (self.slope - value * o.slope) / o.value,
        }
    }
}

macro_rules! with_numbers {
    ($($operation:ident $method:ident),*) => {$(
        impl $operation<f64> for Dual {
            type Output = Dual;
            fn $method(self, o: f64) -> Dual {
                self.$method(Dual::from(o))
            }
        }
        impl $operation<Dual> for f64 {
            type Output = Dual;
            fn $method(self, o: Dual) -> Dual {
                Dual::from(self).$method(o)
            }
        }
    )*};
}
with_numbers!(Add add, Sub sub, Mul mul, Div div);

impl std::iter::Sum for Dual {
    fn sum<I: Iterator<Item = Dual>>(values: I) -> Dual {
        values.fold(Dual::from(0.0), Add::add)
    }
}

impl std::iter::Product for Dual {
    fn product<I: Iterator<Item = Dual>>(values: I) -> Dual {
        values.fold(Dual::from(1.0), Mul::mul)
    }
}
