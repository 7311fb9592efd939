//! Test problems with known optima.

pub mod allowed;
pub mod collected;
pub mod dual;
pub mod faulty;
pub mod hard;
mod hs_001_030;
mod hs_031_060;
mod hs_061_086;
mod hs_093_110;
mod hs_111_119;
pub mod least_squares;
pub mod problem;
pub mod recorded;
pub mod residuals;
pub mod scaled;
pub mod separable;
pub mod truss;

use problem::Problem;

/// All problems of Hock & Schittkowski (1981) that are coded here.
pub fn hock_schittkowski() -> Vec<Problem> {
    let mut all = hs_001_030::problems();
    all.extend(hs_031_060::problems());
    all.extend(hs_061_086::problems());
    all.extend(hs_093_110::problems());
    all.extend(hs_111_119::problems());
    all
}
