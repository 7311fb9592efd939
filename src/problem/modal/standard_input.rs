//! Standard input data of a body: modes, integrals of inertia, stiffness, damping and points in a JSON file.

use super::text::TextFault;
use crate::math::{Mat3, Vec3};
use crate::schema::standard_input::{Square, StandardInput, Triple};
use crate::source::Source;
use crate::structure::walk;
use crate::structures::modal::imported::{ImportedBody, ImportedPoint};
use nalgebra::DMatrix;
use serde_json::Value;

/// Difference of entries of a symmetric matrix, relative to its largest entry.
const SYMMETRIC: f64 = 1e-9;

/// Reads a file.
pub(super) fn read(text: &str) -> Result<ImportedBody, TextFault> {
    let value: Value = serde_json::from_str(text).map_err(|error| {
        let lines: Vec<usize> = text.split_inclusive('\n').map(str::len).collect();
        let before: usize = lines.iter().take(error.line().saturating_sub(1)).sum();
        let mut at = (before + error.column().saturating_sub(1)).min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        TextFault::new(
            at..(at + 1).min(text.len()),
            error.to_string(),
            "a JSON text",
        )
    })?;
    let source = Source::index(text);
    let schema = StandardInput::schema();
    let found = walk(&value, &schema).findings.into_iter().next();
    if let Some(found) = found {
        let at = source.value(&found.pointer).unwrap_or(0..1);
        let named = format!("{} ({})", found.found, place(&found.pointer));
        return Err(TextFault {
            at,
            found: named,
            expected: found.expected,
            hint: found.hint,
        });
    }
    let input = StandardInput::read(value)
        .map_err(|error| TextFault::new(0..1, error, "standard input data"))?;
    let fault = |pointer: &str, found: String, expected: &str| {
        let at = source.value(pointer).unwrap_or(0..1);
        TextFault::new(at, found, expected)
    };
    let m = input.static_moments.len();
    if m == 0 {
        return Err(fault(
            "/static_moments",
            "no mode".into(),
            "at least one mode",
        ));
    }
    let count = |pointer: &str, found: usize, wanted: usize| match found == wanted {
        true => Ok(()),
        false => {
            let expected = format!("a list of {wanted}, as there are {m} static moments");
            Err(fault(pointer, format!("a list of {found}"), &expected))
        }
    };
    count("/with_position", input.with_position.len(), m)?;
    count("/products", input.products.len(), m)?;
    for (i, row) in input.products.iter().enumerate() {
        count(&format!("/products/{i}"), row.len(), m - i)?;
    }
    for (name, point) in &input.points {
        let pointer = crate::pointer::join("/points", name);
        count(
            &format!("{pointer}/displacement"),
            point.displacement.len(),
            m,
        )?;
        if let Some(rotation) = &point.rotation {
            count(&format!("{pointer}/rotation"), rotation.len(), m)?;
        }
    }
    let square = |pointer: &str, rows: &[Vec<f64>]| {
        count(pointer, rows.len(), m)?;
        for (i, row) in rows.iter().enumerate() {
            count(&format!("{pointer}/{i}"), row.len(), m)?;
        }
        let all = DMatrix::from_fn(m, m, |i, j| rows[i][j]);
        match symmetric(&all) {
            true => Ok(all),
            false => Err(fault(
                pointer,
                "a matrix that is not symmetric".into(),
                "a symmetric one",
            )),
        }
    };
    let stiffness = square("/stiffness", &input.stiffness)?;
    if stiffness.clone().cholesky().is_none() {
        let found = "a stiffness that is not positive definite".into();
        let expected = "modes of the held body, none of which is a rigid motion";
        return Err(fault("/stiffness", found, expected));
    }
    let damping = match &input.damping {
        Some(damping) => square("/damping", damping)?,
        None => DMatrix::zeros(m, m),
    };
    let inertia = DMatrix::from_fn(3, 3, |i, j| input.inertia[i][j]);
    if !symmetric(&inertia) || inertia.symmetric_eigenvalues().min() < 0.0 {
        let found = "a matrix that is no inertia".into();
        return Err(fault(
            "/inertia",
            found,
            "a symmetric matrix without negative moments",
        ));
    }
    let matrix = |rows: &Square| Mat3::from_fn(|i, j| rows[i][j]);
    let vectors = |all: &[Triple]| all.iter().map(|v| Vec3::from(*v)).collect::<Vec<_>>();
    let body = ImportedBody {
        mass: input.mass,
        centre: Vec3::from(input.centre_of_mass) * input.mass,
        inertia: matrix(&input.inertia),
        static_moments: vectors(&input.static_moments),
        with_position: input.with_position.iter().map(matrix).collect(),
        products: input.products.iter().flatten().map(matrix).collect(),
        stiffness: stiffness.transpose().iter().copied().collect(),
        damping: damping.transpose().iter().copied().collect(),
        points: (input.points.iter())
            .map(|(name, point)| ImportedPoint {
                name: name.clone(),
                position: Vec3::from(point.position),
                displacement: vectors(&point.displacement),
                rotation: match &point.rotation {
                    Some(rotation) => vectors(rotation),
                    None => vec![Vec3::zeros(); m],
                },
                turns: point.rotation.is_some(),
            })
            .collect(),
    };
    let mass = DMatrix::from_row_slice(m, m, &body.elastic_mass());
    if mass.cholesky().is_none() {
        let found = "products whose traces are not a positive definite mass matrix".into();
        return Err(fault("/products", found, "integrals of independent shapes"));
    }
    Ok(body)
}

/// Where an entry is, in words.
fn place(pointer: &str) -> String {
    match pointer {
        "" => "the whole file".into(),
        pointer => format!("at {pointer}"),
    }
}

fn symmetric(a: &DMatrix<f64>) -> bool {
    (a - a.transpose()).amax() <= SYMMETRIC * a.amax()
}
