//! Coefficients of the pair DOP853 of Dormand & Prince, with its dense output of order 7 (Hairer,
//! Nørsett & Wanner 1993, *Solving Ordinary Differential Equations I*, section II.5 and II.6).

/// Number of stages of a step; stage 0 is the derivative at its start.
pub const STAGES: usize = 12;
/// Index of the derivative at the step's end: stage 0 of the next step.
pub const END: usize = 12;
/// Number of stages with those of the dense output.
pub const ALL: usize = 16;
/// Order of the method.
pub const ORDER: usize = 8;

/// Nodes c.
pub const C: [f64; ALL] = [
    0.0,
    0.05260015195876773,
    0.0789002279381516,
    0.1183503419072274,
    0.2816496580927726,
    0.3333333333333333,
    0.25,
    0.3076923076923077,
    0.6512820512820513,
    0.6,
    0.8571428571428571,
    1.0,
    1.0,
    0.1,
    0.2,
    0.7777777777777778,
];

/// Runge–Kutta matrix a: the non-zeros of each row (row END has the weights b of the step).
pub const A: [&[(usize, f64)]; ALL] = [
    &[],
    &[(0, 0.05260015195876773)],
    &[(0, 0.0197250569845379), (1, 0.0591751709536137)],
    &[(0, 0.02958758547680685), (2, 0.08876275643042054)],
    &[
        (0, 0.2413651341592667),
        (2, -0.8845494793282861),
        (3, 0.924834003261792),
    ],
    &[
        (0, 0.037037037037037035),
        (3, 0.17082860872947386),
        (4, 0.12546768756682242),
    ],
    &[
        (0, 0.037109375),
        (3, 0.17025221101954405),
        (4, 0.06021653898045596),
        (5, -0.017578125),
    ],
    &[
        (0, 0.03709200011850479),
        (3, 0.17038392571223998),
        (4, 0.10726203044637328),
        (5, -0.015319437748624402),
        (6, 0.008273789163814023),
    ],
    &[
        (0, 0.6241109587160757),
        (3, -3.3608926294469414),
        (4, -0.868219346841726),
        (5, 27.59209969944671),
        (6, 20.154067550477894),
        (7, -43.48988418106996),
    ],
    &[
        (0, 0.47766253643826434),
        (3, -2.4881146199716677),
        (4, -0.590290826836843),
        (5, 21.230051448181193),
        (6, 15.279233632882423),
        (7, -33.28821096898486),
        (8, -0.020331201708508627),
    ],
    &[
        (0, -0.9371424300859873),
        (3, 5.186372428844064),
        (4, 1.0914373489967295),
        (5, -8.149787010746927),
        (6, -18.52006565999696),
        (7, 22.739487099350505),
        (8, 2.4936055526796523),
        (9, -3.0467644718982196),
    ],
    &[
        (0, 2.273310147516538),
        (3, -10.53449546673725),
        (4, -2.0008720582248625),
        (5, -17.9589318631188),
        (6, 27.94888452941996),
        (7, -2.8589982771350235),
        (8, -8.87285693353063),
        (9, 12.360567175794303),
        (10, 0.6433927460157636),
    ],
    &[
        (0, 0.054293734116568765),
        (5, 4.450312892752409),
        (6, 1.8915178993145003),
        (7, -5.801203960010585),
        (8, 0.3111643669578199),
        (9, -0.1521609496625161),
        (10, 0.20136540080403034),
        (11, 0.04471061572777259),
    ],
    &[
        (0, 0.056167502283047954),
        (6, 0.25350021021662483),
        (7, -0.2462390374708025),
        (8, -0.12419142326381637),
        (9, 0.15329179827876568),
        (10, 0.00820105229563469),
        (11, 0.007567897660545699),
        (12, -0.008298),
    ],
    &[
        (0, 0.03183464816350214),
        (5, 0.028300909672366776),
        (6, 0.053541988307438566),
        (7, -0.05492374857139099),
        (10, -0.00010834732869724932),
        (11, 0.0003825710908356584),
        (12, -0.00034046500868740456),
        (13, 0.1413124436746325),
    ],
    &[
        (0, -0.42889630158379194),
        (5, -4.697621415361164),
        (6, 7.683421196062599),
        (7, 4.06898981839711),
        (8, 0.3567271874552811),
        (12, -0.0013990241651590145),
        (13, 2.9475147891527724),
        (14, -9.15095847217987),
    ],
];

/// Weights b of order 8.
pub const B: &[(usize, f64)] = &[
    (0, 0.054293734116568765),
    (5, 4.450312892752409),
    (6, 1.8915178993145003),
    (7, -5.801203960010585),
    (8, 0.3111643669578199),
    (9, -0.1521609496625161),
    (10, 0.20136540080403034),
    (11, 0.04471061572777259),
];

/// Difference to the embedded weights of order 3.
pub const E3: &[(usize, f64)] = &[
    (0, -0.18980075407240762),
    (5, 4.450312892752409),
    (6, 1.8915178993145003),
    (7, -5.801203960010585),
    (8, -0.4226823213237919),
    (9, -0.1521609496625161),
    (10, 0.20136540080403034),
    (11, 0.02265179219836082),
];

/// Difference to the embedded weights of order 5.
pub const E5: &[(usize, f64)] = &[
    (0, 0.01312004499419488),
    (5, -1.2251564463762044),
    (6, -0.4957589496572502),
    (7, 1.6643771824549864),
    (8, -0.35032884874997366),
    (9, 0.3341791187130175),
    (10, 0.08192320648511571),
    (11, -0.022355307863886294),
];

/// Rows of the dense output beyond the cubic Hermite part.
pub const D: [&[(usize, f64)]; 4] = [
    &[
        (0, -8.428938276109013),
        (5, 0.5667149535193777),
        (6, -3.0689499459498917),
        (7, 2.38466765651207),
        (8, 2.117034582445028),
        (9, -0.871391583777973),
        (10, 2.2404374302607883),
        (11, 0.6315787787694688),
        (12, -0.08899033645133331),
        (13, 18.148505520854727),
        (14, -9.194632392478356),
        (15, -4.436036387594894),
    ],
    &[
        (0, 10.427508642579134),
        (5, 242.28349177525817),
        (6, 165.20045171727028),
        (7, -374.5467547226902),
        (8, -22.113666853125306),
        (9, 7.733432668472264),
        (10, -30.674084731089398),
        (11, -9.332130526430229),
        (12, 15.697238121770845),
        (13, -31.139403219565178),
        (14, -9.35292435884448),
        (15, 35.81684148639408),
    ],
    &[
        (0, 19.985053242002433),
        (5, -387.0373087493518),
        (6, -189.17813819516758),
        (7, 527.8081592054236),
        (8, -11.57390253995963),
        (9, 6.8812326946963),
        (10, -1.0006050966910838),
        (11, 0.7777137798053443),
        (12, -2.778205752353508),
        (13, -60.19669523126412),
        (14, 84.32040550667716),
        (15, 11.99229113618279),
    ],
    &[
        (0, -25.69393346270375),
        (5, -154.18974869023643),
        (6, -231.5293791760455),
        (7, 357.6391179106141),
        (8, 93.40532418362432),
        (9, -37.45832313645163),
        (10, 104.0996495089623),
        (11, 29.8402934266605),
        (12, -43.53345659001114),
        (13, 96.32455395918828),
        (14, -39.17726167561544),
        (15, -149.72683625798564),
    ],
];

/// Weights of the stages of the dense output: 0 and 5 … 15.
pub type DenseWeights = [(usize, f64); 12];

/// Weights of the derivatives k_i in the dense output y(θ) = y_0 + h Σ w_i(θ) k_i, and their
/// derivatives w_i'(θ), for 0 ≤ θ ≤ 1.
///
/// y(θ) = y_0 + θ (F_0 + (1−θ) (F_1 + θ (F_2 + (1−θ) (F_3 + θ (F_4 + …))))), with F_0 the
/// increment of the step, F_1 and F_2 those of the cubic Hermite polynomial and F_3 … F_6 = h D k.
pub fn dense_weights(theta: f64) -> (DenseWeights, DenseWeights) {
    let (t, u) = (theta, 1.0 - theta);
    // Basis polynomials θ, θ(1−θ), θ²(1−θ), θ²(1−θ)², … and their derivatives.
    let tu = t * u;
    let (square, cube) = (tu * tu, tu * tu * tu);
    let basis = [t, tu, t * tu, square, t * square, cube, t * cube];
    let slopes = [
        1.0,
        u - t,
        t * (2.0 * u - t),
        2.0 * tu * (u - t),
        t * tu * (3.0 * u - 2.0 * t),
        3.0 * square * (u - t),
        t * square * (4.0 * u - 3.0 * t),
    ];
    (combined(&basis), combined(&slopes))
}

/// Stages of the dense output, and their weights in each of its basis polynomials.
const DENSE_STAGES: [usize; 12] = [0, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
const DENSE: [[f64; 12]; 7] = dense_rows();

const fn dense_rows() -> [[f64; 12]; 7] {
    let mut rows = [[0.0; 12]; 7];
    let mut k = 0;
    while k < B.len() {
        let (i, b) = B[k];
        let at = place(i);
        rows[0][at] += b;
        rows[1][at] -= b;
        rows[2][at] += 2.0 * b;
        k += 1;
    }
    rows[1][place(0)] += 1.0;
    rows[2][place(0)] -= 1.0;
    rows[2][place(END)] -= 1.0;
    let mut row = 0;
    while row < D.len() {
        let mut k = 0;
        while k < D[row].len() {
            let (i, d) = D[row][k];
            rows[3 + row][place(i)] += d;
            k += 1;
        }
        row += 1;
    }
    rows
}

/// Index of a stage among those of the dense output.
const fn place(stage: usize) -> usize {
    stage.saturating_sub(4)
}

/// The weights for given values of the basis polynomials.
fn combined(polynomials: &[f64; 7]) -> DenseWeights {
    let mut sum = [0.0; 12];
    for (row, p) in DENSE.iter().zip(polynomials) {
        for (sum, c) in sum.iter_mut().zip(row) {
            *sum += c * p;
        }
    }
    std::array::from_fn(|k| (DENSE_STAGES[k], sum[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_add_up_to_their_nodes() {
        for (row, c) in A.iter().zip(C) {
            let sum: f64 = row.iter().map(|(_, a)| a).sum();
            assert!((sum - c).abs() < 1e-13, "{sum} against {c}");
        }
        assert_eq!(A[END], B);
        for difference in [E3, E5] {
            assert!(difference.iter().map(|(_, e)| e).sum::<f64>().abs() < 1e-14);
        }
    }

    #[test]
    fn quadrature_and_dense_output_have_their_orders() {
        for theta in [0.0, 0.2, 0.55, 1.0] {
            let (w, rate) = dense_weights(theta);
            for power in 0..7 {
                let node = |i: usize| C[i].powi(power);
                let integral: f64 = w.iter().map(|&(i, w)| w * node(i)).sum();
                let value: f64 = rate.iter().map(|&(i, w)| w * node(i)).sum();
                let exact = theta.powi(power + 1) / f64::from(power + 1);
                assert!((integral - exact).abs() < 1e-13, "power {power} at {theta}");
                assert!(
                    (value - theta.powi(power)).abs() < 1e-12,
                    "power {power} at {theta}"
                );
            }
        }
        let eighth: f64 = B.iter().map(|&(i, b)| b * C[i].powi(7)).sum();
        assert!((eighth - 0.125).abs() < 1e-14);
    }
}
