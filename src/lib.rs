//! Design of flexible multibody systems by gradient.
