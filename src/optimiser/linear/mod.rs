//! Matrices: Jacobian, quasi-Newton matrix, systems of a primal–dual step.

pub(crate) mod compact;
pub(crate) mod curvature;
pub(crate) mod jacobian;
pub(crate) mod kkt_dense;
pub(crate) mod kkt_sparse;
pub(crate) mod kkt_system;
pub(crate) mod quasi_newton;
