//! The parts of one implicit step (residual, iteration matrix, factorisation, solves) and of one stage
//! of the explicit method.
//!
//! `cargo bench --bench step`; read the column "fastest" on a shared machine.

mod scenes;

use divan::{Bencher, black_box};
use flexbody::integrate::implicit::Stage;
use flexbody::integrate::implicit::ggl::{Equations, Instant};
use flexbody::integrate::{Tape, Trajectory};
use flexbody::linalg::{SparseLu, SparseMatrix};
use flexbody::model::Model;
use flexbody::system::accelerations::Accelerations;
use scenes::{Case, NAMES};

fn main() {
    divan::main();
}

/// Step of the motion that is stopped [s].
const H: f64 = 1e-3;

/// A motion stopped half way through.
struct Halted {
    model: Model<f64>,
    run: Trajectory<f64>,
    stage: Stage<f64>,
}

impl Halted {
    fn new(name: &'static str) -> Self {
        let case = Case::new(name, H);
        let run = case.simulate();
        let Tape::Implicit(tape) = &run.tape else {
            unreachable!("BDF is an implicit method");
        };
        let mut stage = Stage::zero(&run.numbering);
        tape.block.read_end(run.grid.steps() / 2, &mut stage);
        Self {
            model: case.scene.model,
            run,
            stage,
        }
    }

    fn instant(&self) -> Instant<'_, f64> {
        self.stage.instant()
    }

    fn equations(&self) -> Equations<'_, f64> {
        Equations::new(&self.model, &self.run.numbering)
    }

    /// The assembled iteration matrix of BDF2.
    fn matrix(&self) -> SparseMatrix<f64> {
        let mut equations = self.equations();
        let mut matrix = SparseMatrix::new(equations.pattern(&self.instant()));
        matrix.assemble(|emit| equations.jacobian(&self.instant(), H, 1.5 / H, emit));
        matrix
    }

    fn factors(&self) -> (SparseLu<f64>, Vec<f64>) {
        let matrix = self.matrix();
        let mut factors = SparseLu::new(&matrix.pattern);
        factors.factorise(&matrix).expect("regular");
        (factors, vec![1.0; matrix.pattern.order()])
    }
}

#[divan::bench(args = NAMES)]
fn residual(bencher: Bencher, name: &'static str) {
    let halted = Halted::new(name);
    let mut equations = halted.equations();
    let mut out = vec![0.0; equations.order()];
    bencher.bench_local(|| equations.residual(black_box(&halted.instant()), H, &mut out));
}

#[divan::bench(args = NAMES)]
fn jacobian(bencher: Bencher, name: &'static str) {
    let halted = Halted::new(name);
    let mut equations = halted.equations();
    let mut matrix = halted.matrix();
    bencher.bench_local(|| {
        let at = black_box(halted.instant());
        matrix.assemble(|emit| equations.jacobian(&at, H, 1.5 / H, emit));
    });
}

#[divan::bench(args = NAMES)]
fn factorisation(bencher: Bencher, name: &'static str) {
    let halted = Halted::new(name);
    let matrix = halted.matrix();
    let mut factors = SparseLu::new(&matrix.pattern);
    bencher.bench_local(|| factors.factorise(black_box(&matrix)));
}

/// Positions, constraint gradients, elimination and accelerations of one stage.
#[divan::bench(args = NAMES)]
fn explicit_stage(bencher: Bencher, name: &'static str) {
    let Halted { model, run, stage } = Halted::new(name);
    let mut field = Accelerations::new(&model, &run.numbering);
    let (mut a, mut lambda) = (stage.vdot.clone(), stage.lambda.clone());
    bencher.bench_local(|| {
        field.stand(black_box(&stage.q), &stage.v, stage.time);
        field.factorise().expect("regular");
        field.accelerations(&mut a, &mut lambda);
    });
}

#[divan::bench(args = NAMES)]
fn solve(bencher: Bencher, name: &'static str) {
    let (mut factors, ones) = Halted::new(name).factors();
    let mut b = ones.clone();
    bencher.bench_local(|| {
        b.copy_from_slice(&ones);
        factors.solve(black_box(&mut b));
    });
}

#[divan::bench(args = NAMES)]
fn solve_transposed(bencher: Bencher, name: &'static str) {
    let (mut factors, ones) = Halted::new(name).factors();
    let mut b = ones.clone();
    bencher.bench_local(|| {
        b.copy_from_slice(&ones);
        factors.solve_transposed(black_box(&mut b));
    });
}
