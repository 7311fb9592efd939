//! Random numbers, the same in every run (SplitMix64, Steele, Lea & Flood 2014), and rotations.

/// A vector in space.
pub type Vector = [f64; 3];

/// A sequence of random numbers.
pub struct Numbers(pub u64);

impl Numbers {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number in [lower, upper).
    pub fn between(&mut self, lower: f64, upper: f64) -> f64 {
        lower + (upper - lower) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// A unit vector.
    pub fn direction(&mut self) -> Vector {
        loop {
            let v: Vector = std::array::from_fn(|_| self.between(-1.0, 1.0));
            let length = dot(v, v).sqrt();
            if length > 0.1 && length < 1.0 {
                return v.map(|x| x / length);
            }
        }
    }

    /// The numbers below `count` in any order.
    pub fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            order.swap(i, self.below(i + 1));
        }
        order
    }
}

/// The scalar product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// The vector product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// A rotation by an angle about a unit axis.
#[derive(Clone, Copy)]
pub struct Turn {
    /// Its axis, a unit vector.
    pub axis: Vector,
    /// Its angle [rad].
    pub angle: f64,
}

impl Turn {
    /// No rotation.
    pub const NONE: Self = Self {
        axis: [0.0, 0.0, 1.0],
        angle: 0.0,
    };

    /// The turned vector, by Rodrigues' formula.
    pub fn of(&self, v: Vector) -> Vector {
        let (sine, cosine) = self.angle.sin_cos();
        let (along, across) = (dot(self.axis, v), cross(self.axis, v));
        std::array::from_fn(|k| {
            cosine * v[k] + sine * across[k] + (1.0 - cosine) * along * self.axis[k]
        })
    }
}
