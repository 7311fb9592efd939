//! Why a figure cannot be drawn.

use plotters::drawing::DrawingAreaErrorKind;

/// Why a figure cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum FigureError {
    /// Data that the figure shows are missing.
    #[error("figure {figure}: {missing}")]
    NothingToDraw {
        /// Name of the figure.
        figure: &'static str,
        /// What is missing.
        missing: &'static str,
    },
    /// The drawing library failed.
    #[error("figure: {0}")]
    Drawing(#[from] DrawingAreaErrorKind<std::io::Error>),
}
