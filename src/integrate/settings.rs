//! How a scene is integrated in time.

/// The integration method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Backward differentiation formula on the GGL-stabilised equations, of order 1 or 2; step k
    /// has order min(k, order) (Kennedy & Boopathy, section II.A).
    Bdf {
        /// Order, 1 or 2.
        order: usize,
    },
}

/// Method and number of steps of equal size h = T / N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Number of steps N ≥ 1.
    pub steps: usize,
    /// Method.
    pub method: Method,
}
