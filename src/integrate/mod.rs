//! Time integration.

pub mod settings;

pub use settings::{Method, Settings};
