//! Numbers that several rules share. In any one place of the interior point, a thousand times more or
//! less of the first two loses no problem of the bed.

/// What is smaller than this part of a number is lost in half of its digits: about √ε. A step below the root of
/// this part of its box is lost in the tolerances of Clarabel: without a second solution the truss of 200 bars ends
/// at a violation of 1e-13 of the limits.
pub(crate) const HALF_OF_DIGITS: f64 = 1e-8;

/// A part that does not matter.
pub(crate) const SMALL_PART: f64 = 1e-6;

/// What rounding leaves of a sum of products, relative to its terms: some hundred ε.
pub(crate) const ROUND_OFF: f64 = 1e-13;

/// Least share of the predicted decrease for which a step is accepted (Armijo).
pub(crate) const SUFFICIENT: f64 = 1e-4;

/// Successive points that show more than chance: a dominant row, after which the program is degenerate, or
/// steps that are lost in rounding. A run towards multipliers that exist leaves a dominant row sooner.
/// Without the end at a dominant row the bed takes 16 % more evaluations.
pub(crate) const SUCCESSIVE: usize = 5;

/// Steps of a simple iteration that converges in about ten: of Newton's method to curved rows from a point
/// ten times as far, or to the length of a step; halvings of a step where the functions are undefined.
pub(crate) const MOST_STEPS: usize = 20;

/// Distance from the first point, relative to its size, that is far: the way there is followed.
/// Without that, three claims of the bed are false. Steps of so many sizes lead nowhere: a row so flat
/// is scaled by its violation.
pub(crate) const FAR: f64 = 1e4;

/// Unit of forces where the gradient vanishes, as a part of the typical gradient, and of the variables where the
/// objective vanishes. Ten times more or less of the first changes the count of solved problems by at most one.
pub(crate) const UNIT: f64 = 0.1;

/// Two numbers agree that differ by less than this part of their size: differences by two steps, or a step by
/// two solvers. Nothing in the bed decides between a thousandth of this and 0.9.
pub(crate) const AGREE: f64 = 0.1;

/// Rows, variables or pairs up to which a matrix is dense. A dense matrix of 30 pairs loses the trust region five
/// problems of the bed, multipliers by sparse matrices alone the interior point two.
pub(crate) const DENSE: usize = 200;

/// Steps of the differences that test derivatives, relative to max(1, |x|).
pub(crate) const STEPS: [f64; 3] = [1e-4, 1e-5, 1e-6];
