//! Cross sections: from their sizes to stiffnesses and masses, and back.

use super::torsion;
use crate::math::Scalar;
use crate::structures::material::Material;

/// A cross section. Axis 2 and axis 3 are the principal axes of bending.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Section<S> {
    /// A rectangle \[m\]. Shear factor 5/6, torsion by Saint-Venant's series.
    Rectangle {
        /// Size along axis 2.
        width: S,
        /// Size along axis 3.
        height: S,
    },
    /// A round tube \[m\]; a solid bar if the wall is the radius. Shear factor of Cowper (1966) for ν = 0.
    Tube {
        /// Outer radius.
        radius: S,
        /// Thickness of the wall.
        wall: S,
    },
    /// An I of thin walls \[m\], the web along axis 3. The web carries shear along axis 3, the flanges
    /// along axis 2 (5/6 of their area). J = Σ b t³/3. Warping is free.
    I {
        /// Width of the flanges.
        width: S,
        /// Whole height.
        height: S,
        /// Thickness of a flange.
        flange: S,
        /// Thickness of the web.
        web: S,
    },
    /// Given values.
    Given(SectionValues<S>),
}

/// Stiffnesses and masses per length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionValues<S> {
    /// EA \[N\], GA2 \[N\], GA3 \[N\] (with shear factors), GJ, EI2 and EI3 [N m²].
    pub stiffness: [S; 6],
    /// ρA [kg/m], ρI2 and ρI3 [kg m].
    pub inertia: [S; 3],
}

impl<S: Scalar> SectionValues<S> {
    /// Zeros.
    pub fn zeros() -> Self {
        Self {
            stiffness: [S::zero(); 6],
            inertia: [S::zero(); 3],
        }
    }
}

/// A size of a section that its other sizes do not admit.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a {size} of {found} m, above {limit}, {most} m")]
pub struct SectionFault {
    /// What is too large.
    pub size: &'static str,
    /// Its value \[m\].
    pub found: f64,
    /// What limits it.
    pub limit: &'static str,
    /// The largest value \[m\].
    pub most: f64,
}

/// Part by which a size may exceed its limit through rounding.
const ROUNDING: f64 = 1e-12;

impl Section<f64> {
    /// Why no beam can have this section. Formulas of areas and moments do not show it.
    pub fn fault(&self) -> Option<SectionFault> {
        let limits = match *self {
            Self::Rectangle { .. } | Self::Given(_) => return None,
            Self::Tube { radius, wall } => vec![("wall", wall, "the radius", radius)],
            Self::I {
                width,
                height,
                flange,
                web,
            } => vec![
                ("flange", flange, "half the height", 0.5 * height),
                ("web", web, "the width", width),
            ],
        };
        let wrong = limits
            .into_iter()
            .find(|&(_, found, _, most)| found > most * (1.0 + ROUNDING));
        wrong.map(|(size, found, limit, most)| SectionFault {
            size,
            found,
            limit,
            most,
        })
    }
}

/// A, A2, A3, J, I2, I3 of a section.
type Geometry<S> = [S; 6];

impl<S: Scalar> Section<S> {
    /// The section in another scalar.
    pub fn map<T>(&self, f: &mut dyn FnMut(S) -> T) -> Section<T> {
        match *self {
            Self::Rectangle { width, height } => Section::Rectangle {
                width: f(width),
                height: f(height),
            },
            Self::Tube { radius, wall } => Section::Tube {
                radius: f(radius),
                wall: f(wall),
            },
            Self::I {
                width,
                height,
                flange,
                web,
            } => Section::I {
                width: f(width),
                height: f(height),
                flange: f(flange),
                web: f(web),
            },
            Self::Given(values) => Section::Given(SectionValues {
                stiffness: values.stiffness.map(&mut *f),
                inertia: values.inertia.map(&mut *f),
            }),
        }
    }

    /// Adds the numbers of a section of the same kind.
    pub fn add(&mut self, other: &Self) {
        let mut numbers = Vec::with_capacity(9);
        other.map(&mut |x| numbers.push(x));
        let mut next = numbers.into_iter();
        *self = self.map(&mut |x| x + next.next().unwrap_or_else(S::zero));
    }

    /// Stiffnesses and masses of the section in a material.
    pub fn values(&self, material: &Material<S>) -> SectionValues<S> {
        let Some([a, a2, a3, j, i2, i3]) = self.geometry() else {
            let Self::Given(values) = self else {
                unreachable!("every other section has a geometry")
            };
            return *values;
        };
        let (e, g, rho) = (material.young, material.shear_modulus(), material.density);
        SectionValues {
            stiffness: [e * a, g * a2, g * a3, g * j, e * i2, e * i3],
            inertia: [rho * a, rho * i2, rho * i3],
        }
    }

    /// Transpose of the derivative of [`Section::values`].
    pub(super) fn add_values_transpose(
        &self,
        material: &Material<S>,
        bar: &SectionValues<S>,
        to: &mut Self,
        material_to: &mut Material<S>,
    ) {
        let Some([a, a2, a3, j, i2, i3]) = self.geometry() else {
            to.add(&Self::Given(*bar));
            return;
        };
        let [ea, ga2, ga3, gj, ei2, ei3] = bar.stiffness;
        let [m, m2, m3] = bar.inertia;
        let (e, g, rho) = (material.young, material.shear_modulus(), material.density);
        material_to.young += ea * a + ei2 * i2 + ei3 * i3;
        material.add_shear_modulus_transpose(ga2 * a2 + ga3 * a3 + gj * j, material_to);
        material_to.density += m * a + m2 * i2 + m3 * i3;
        self.add_geometry_transpose(
            [
                ea * e + m * rho,
                ga2 * g,
                ga3 * g,
                gj * g,
                ei2 * e + m2 * rho,
                ei3 * e + m3 * rho,
            ],
            to,
        );
    }

    /// Areas and moments, of sections that have sizes.
    fn geometry(&self) -> Option<Geometry<S>> {
        let pi = std::f64::consts::PI;
        Some(match *self {
            Self::Rectangle {
                width: b,
                height: h,
            } => {
                let area = b * h;
                let shear = area * (5.0 / 6.0);
                let (j, _) = torsion::rectangle([b, h]);
                [
                    area,
                    shear,
                    shear,
                    j,
                    area * h * h / 12.0,
                    area * b * b / 12.0,
                ]
            }
            Self::Tube { radius, wall } => {
                let inner = radius - wall;
                let (outer2, inner2) = (radius * radius, inner * inner);
                let area = (outer2 - inner2) * pi;
                let moment = area * (outer2 + inner2) * 0.25;
                let (k, _) = tube_shear(inner2 / outer2);
                [area, area * k, area * k, moment * 2.0, moment, moment]
            }
            Self::I {
                width: b,
                height: h,
                flange: f,
                web: w,
            } => {
                let clear = h - f * 2.0;
                let clear3 = clear * clear * clear;
                [
                    b * f * 2.0 + clear * w,
                    b * f * (5.0 / 3.0),
                    w * (h - f),
                    (b * f * f * f * 2.0 + clear * w * w * w) / 3.0,
                    (b * h * h * h - (b - w) * clear3) / 12.0,
                    (f * b * b * b * 2.0 + clear * w * w * w) / 12.0,
                ]
            }
            Self::Given(_) => return None,
        })
    }

    /// Transpose of the derivative of [`Section::geometry`].
    fn add_geometry_transpose(&self, [a, a2, a3, j, i2, i3]: Geometry<S>, to: &mut Self) {
        let pi = std::f64::consts::PI;
        let part = match *self {
            Self::Rectangle {
                width: b,
                height: h,
            } => {
                let area = a + (a2 + a3) * (5.0 / 6.0);
                let (_, by) = torsion::rectangle([b, h]);
                Self::Rectangle {
                    width: area * h + j * by[0] + i2 * h * h * h / 12.0 + i3 * h * b * b / 4.0,
                    height: area * b + j * by[1] + i2 * b * h * h / 4.0 + i3 * b * b * b / 12.0,
                }
            }
            Self::Tube { radius, wall } => {
                let inner = radius - wall;
                let (outer2, inner2) = (radius * radius, inner * inner);
                let area = (outer2 - inner2) * pi;
                let (k, slope) = tube_shear(inner2 / outer2);
                let moment = j * 2.0 + i2 + i3;
                let area_bar = a + (a2 + a3) * k;
                let ratio_bar = (a2 + a3) * area * slope;
                let outer2_bar = area_bar * pi + moment * outer2 * (0.5 * pi)
                    - ratio_bar * inner2 / (outer2 * outer2);
                let inner2_bar = ratio_bar / outer2 - area_bar * pi - moment * inner2 * (0.5 * pi);
                let inner_bar = inner2_bar * inner * 2.0;
                Self::Tube {
                    radius: outer2_bar * radius * 2.0 + inner_bar,
                    wall: -inner_bar,
                }
            }
            Self::I {
                width: b,
                height: h,
                flange: f,
                web: w,
            } => {
                let clear = h - f * 2.0;
                let (clear2, w2) = (clear * clear, w * w);
                let clear_bar =
                    a * w + j * w2 * w / 3.0 - i2 * (b - w) * clear2 / 4.0 + i3 * w2 * w / 12.0;
                Self::I {
                    width: a * f * 2.0
                        + a2 * f * (5.0 / 3.0)
                        + j * f * f * f * (2.0 / 3.0)
                        + i2 * (h * h * h - clear2 * clear) / 12.0
                        + i3 * f * b * b * 0.5,
                    height: clear_bar + a3 * w + i2 * b * h * h / 4.0,
                    flange: a * b * 2.0 + a2 * b * (5.0 / 3.0) - a3 * w
                        + j * b * f * f * 2.0
                        + i3 * b * b * b / 6.0
                        - clear_bar * 2.0,
                    web: a * clear
                        + a3 * (h - f)
                        + j * clear * w2
                        + i2 * clear2 * clear / 12.0
                        + i3 * clear * w2 / 4.0,
                }
            }
            Self::Given(_) => unreachable!("given values have no geometry"),
        };
        to.add(&part);
    }
}

/// Shear factor of a tube with μ = (inner / outer radius)², and its derivative by μ:
/// k = 6 (1 + μ)² / (7 (1 + μ)² + 20 μ).
fn tube_shear<S: Scalar>(mu: S) -> (S, S) {
    let one = mu + 1.0;
    let below = one * one * 7.0 + mu * 20.0;
    let k = one * one * 6.0 / below;
    let slope = (one * 12.0 - k * (one * 14.0 + 20.0)) / below;
    (k, slope)
}
