//! The adjoint of motions with flexible bodies gives the derivative of every function in every parameter:
//! start, mass, shapes, stiffness, strains, damping, attachments.

use super::gradients_match_complex_step::{compare, explicit, functions, implicit};
use crate::reference;

use flexbody_mechanics::functions::instant::DeformationKind;
use flexbody_mechanics::functions::{Bound, Function, Instant, Reduction, Scene};
use flexbody_mechanics::integrate::{Method, Settings, Start};
use flexbody_mechanics::model::{Model, Role};
use reference::flexible::{quadratic, swing, swing_of};
use reference::models::Numbers;

/// Functions of a point of the deformed body, of the rigid body, and of the deformation.
fn scene(model: &Model<f64>, duration: f64) -> Scene<f64> {
    let tip = (0..model.bodies.len()).find(|&body| model.bodies[body].role == Role::Interface);
    let mut numbers = Numbers(5);
    let form = quadratic(&mut numbers, model.flexible[0].modes());
    let deformation = Instant::Deformation {
        flexible: 0,
        unknowns: None,
        kind: DeformationKind::Moment,
        form,
    };
    let reduced = Function::reduced;
    let mut functions = functions(tip.expect("has an interface"), 1);
    functions.push(reduced(Instant::StrainEnergy(0), Reduction::Integral));
    functions.push(reduced(deformation.clone(), Reduction::Final));
    functions.push(reduced(
        deformation,
        Reduction::Ks {
            rho: 2.0,
            bound: Bound::Above,
        },
    ));
    Scene {
        model: model.clone(),
        duration,
        until: None,
        functions,
        unstarted: None,
    }
}

fn every_parameter(scene: &Scene<f64>, settings: &Settings) {
    let count = scene.parameters().len();
    let units: Vec<Vec<f64>> = (0..count)
        .map(|i| (0..count).map(|j| f64::from(u8::from(i == j))).collect())
        .collect();
    compare(scene, settings, &units);
}

fn directions(scene: &Scene<f64>, settings: &Settings) {
    let parameters = scene.parameters();
    let mut numbers = Numbers(77);
    let mut direction = || -> Vec<f64> {
        parameters
            .iter()
            .map(|p| numbers.next() * p.abs().max(0.1))
            .collect()
    };
    compare(scene, settings, &[direction(), direction()]);
}

#[test]
fn every_parameter_by_the_explicit_method() {
    let model = swing_of(21, 4, 60.0);
    let settings = explicit(&model, 0.1, 6);
    every_parameter(&scene(&model, 0.1), &settings[0]);
}

#[test]
fn every_parameter_by_implicit_methods() {
    let model = swing_of(22, 2, 60.0);
    let scene = scene(&model, 0.1);
    every_parameter(&scene, &Settings::steps(Method::Radau { stages: 2 }, 4));
    let bdf = Method::Bdf {
        order: 2,
        start: Start::Radau,
    };
    every_parameter(&scene, &Settings::steps(bdf, 5));
}

/// All methods, all kinds of grids and samples.
#[test]
fn every_method() {
    let model = swing(23);
    let scene = scene(&model, 0.2);
    for settings in explicit(&model, 0.2, 12)
        .iter()
        .chain(&implicit(&model, 0.2, 30))
    {
        directions(&scene, settings);
    }
}
