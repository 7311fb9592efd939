//! The text of `optimize explain`: the scene, what lowering removes from it, and the work of its
//! integration.

use super::table::render;
use serde::Serialize;
use std::fmt::Write;

/// What stands above the changes by richer bases.
const RICHER: &str =
    "with richer reduced bases, an order of magnitude (--error compares with all nodes)";

/// The explanation of `optimize explain`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Explanation {
    /// Name of the problem.
    pub name: String,
    /// Numbers of bodies, joints and loads.
    pub bodies: usize,
    /// See above.
    pub joints: usize,
    /// See above.
    pub loads: usize,
    /// The couplings: how the last motion of each follows the others.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub couplings: Vec<String>,
    /// The controllers: what their states cost.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub controllers: Vec<String>,
    /// The flexible bodies: their coordinates and natural frequencies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub flexible: Vec<String>,
    /// Changes by richer reduced bases, by function.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub bases: Vec<String>,
    /// The reductions made, and why they are allowed.
    pub left_out: Vec<String>,
    /// The reductions that failed, and the violated conditions.
    pub kept: Vec<String>,
    /// Changes of the given start, if the joints require any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub start: Vec<String>,
    /// The system as it is written.
    pub written: SystemSize,
    /// The system that is integrated.
    pub lowered: SystemSize,
    /// How the start is integrated, unless that failed.
    #[serde(flatten)]
    pub integration: Option<IntegrationUse>,
    /// Why the start could not be simulated, or its functions not be differentiated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// The functions.
    pub functions: Vec<FunctionUse>,
    /// Variables that neither the objective nor a constraint depends on.
    pub idle_variables: Vec<String>,
}

/// How a scene is integrated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IntegrationUse {
    /// The method, why it was chosen, and how many steps it takes at the start.
    pub method: String,
    /// See above.
    pub reason: String,
    /// See above.
    pub steps: usize,
    /// Where lowering changes the discretisation error of the method, and not only round-off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub merged: Option<String>,
    /// Memory of the samples and of what is kept for gradients \[bytes\].
    pub samples_bytes: usize,
    /// See above.
    pub tape_bytes: usize,
    /// How linear systems of finite elements are solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linear: Option<LinearUse>,
    /// Matrices that were factorised, and Newton iterations of an implicit method, in the simulated part.
    pub factorisations: usize,
    /// See above.
    pub newton_iterations: usize,
    /// Steps that a gradient repeats because memory is limited.
    pub recomputed: usize,
    /// The simulated part of the motion, if the whole takes long. The number of steps, the memory
    /// and the dependences of functions are estimated from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<f64>,
}

/// How the linear systems of steps of finite elements are solved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinearUse {
    /// The solver, and why it was chosen.
    pub solver: String,
    /// See above.
    pub reason: String,
    /// Unknowns and entries of the matrix of a step, or of a stage.
    pub unknowns: usize,
    /// See above.
    pub entries: usize,
    /// Entries of its factors, and floating-point operations of a factorisation.
    pub factors: usize,
    /// See above.
    pub operations: usize,
    /// Products with a matrix and kept factors in the simulated part.
    pub krylov_products: usize,
}

impl LinearUse {
    fn text(&self) -> String {
        format!(
            "  linear systems: {}: {}\n  a matrix: {} unknowns, {:.1e} entries, {:.1e} with fill, {:.1e} operations \
             to factorise\n",
            self.solver,
            self.reason,
            self.unknowns,
            self.entries as f64,
            self.factors as f64,
            self.operations as f64
        )
    }
}

/// Size of the equations of a scene, and how they are eliminated.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystemSize {
    /// Velocities.
    pub velocities: usize,
    /// Constraint rows.
    pub rows: usize,
    /// Unknowns of an implicit step, with the rows that stabilise it.
    pub stabilised: usize,
    /// Bodies in the order of elimination; empty with sparse LU.
    pub order: Vec<String>,
    /// The reason for sparse LU, if it is used.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sparse: Option<String>,
    /// Joints that close loops, eliminated after the bodies.
    pub closing: Vec<String>,
    /// Entries of the sparse matrix and of its factors, if it is used.
    pub fill: Option<(usize, usize)>,
    /// Floating-point operations of a factorisation.
    pub operations: usize,
}

/// Use and dependences of a function.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FunctionUse {
    /// Its name.
    pub name: String,
    /// "objective", "constraint", or empty if an optimisation never evaluates it.
    pub used: String,
    /// Whether it depends on the whole motion, or on its end alone.
    pub whole_motion: bool,
    /// Variables that it depends on at the start, if that could be simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub variables: Option<Vec<String>>,
}

impl Explanation {
    /// The explanation as text.
    pub fn text(&self) -> String {
        let mut text = format!(
            "{}: {} bodies, {} joints, {} loads\n",
            self.name, self.bodies, self.joints, self.loads
        );
        for (title, lines) in [
            ("couplings", &self.couplings),
            ("controllers", &self.controllers),
            ("flexible bodies", &self.flexible),
            (RICHER, &self.bases),
            ("left out", &self.left_out),
            ("not left out", &self.kept),
            ("start", &self.start),
        ] {
            if !lines.is_empty() {
                let _ = writeln!(text, "\n{title}");
            }
            for line in lines {
                let _ = writeln!(text, "  {line}");
            }
        }
        let sizes = [&self.written, &self.lowered];
        let row = |name: &str, value: &dyn Fn(&SystemSize) -> String| {
            let [written, lowered] = sizes.map(value);
            vec![name.to_owned(), written, lowered]
        };
        let rows = [
            row("velocities", &|s| s.velocities.to_string()),
            row("constraint rows", &|s| s.rows.to_string()),
            row("unknowns of the accelerations", &|s| {
                (s.velocities + s.rows).to_string()
            }),
            row("unknowns of an implicit step", &|s| {
                s.stabilised.to_string()
            }),
            row("entries, with fill", &|s| match s.fill {
                Some((entries, fill)) => format!("{entries}, {fill}"),
                None => String::new(),
            }),
            row("operations to factorise", &|s| s.operations.to_string()),
        ];
        let told = |row: &Vec<String>| row[1..].iter().any(|cell| !cell.is_empty());
        let rows: Vec<Vec<String>> = rows.into_iter().filter(told).collect();
        text.push_str("\nequations\n");
        text.push_str(&render(&["", ">as written", ">lowered"], &rows));
        let order = match &self.lowered.sparse {
            Some(reason) => format!("by sparse LU: {reason}"),
            None => self.lowered.order.join(", "),
        };
        let _ = writeln!(text, "  elimination: {order}");
        if !self.lowered.closing.is_empty() {
            let closing = self.lowered.closing.join(", ");
            let _ = writeln!(text, "  last, as they close loops: {closing}");
        }
        text.push_str("\nintegration\n");
        if let Some(found) = &self.integration
            && found.steps == 0
        {
            text.push_str("  none: the machine is at rest\n");
        } else if let Some(found) = &self.integration {
            let _ = writeln!(
                text,
                "  {} in {} steps: {}\n  memory: {} for the samples, {} for gradients",
                found.method,
                match found.stretch {
                    None => found.steps.to_string(),
                    Some(_) => format!("about {}", found.steps),
                },
                found.reason,
                size(found.samples_bytes),
                size(found.tape_bytes)
            );
            let title = match &found.linear {
                Some(linear) => {
                    text += &linear.text();
                    ""
                }
                None => "linear systems: direct, ",
            };
            if found.newton_iterations > 0 && found.stretch.is_none() {
                let products = match &found.linear {
                    Some(LinearUse {
                        krylov_products: products,
                        ..
                    }) if *products > 0 => format!(" and {products} products"),
                    _ => String::new(),
                };
                let _ = writeln!(
                    text,
                    "  {title}{} factorisations{products} for {} Newton iterations",
                    found.factorisations, found.newton_iterations
                );
            }
            if found.recomputed > 0 {
                let part = found.recomputed as f64 / found.steps as f64;
                let _ = writeln!(
                    text,
                    "  a gradient makes {} steps again ({part:.2} of a run); more --memory keeps more",
                    found.recomputed
                );
            }
            if let Some(stretch) = found.stretch {
                let _ = writeln!(
                    text,
                    "  estimated from the first {:.2e} of the motion, as is what functions depend on",
                    stretch
                );
            }
            if let Some(merged) = &found.merged {
                let _ = writeln!(text, "  {merged}");
            }
        }
        if let Some(failure) = &self.failure {
            let _ = writeln!(text, "  fails at the start: {failure}");
        }
        if !self.functions.is_empty() {
            let row = |function: &FunctionUse| {
                let looks = match function.whole_motion {
                    true => "the whole motion",
                    false => "the end",
                };
                vec![
                    function.name.clone(),
                    match function.used.is_empty() {
                        true => "not evaluated by an optimisation".into(),
                        false => function.used.clone(),
                    },
                    looks.into(),
                    (function.variables.as_ref())
                        .map_or("unknown".into(), |names| names.join(", ")),
                ]
            };
            let rows: Vec<Vec<String>> = self.functions.iter().map(row).collect();
            text.push('\n');
            let headings = ["function", "use", "observes", "depends at the start on"];
            text.push_str(&render(&headings, &rows));
        }
        if !self.idle_variables.is_empty() {
            let names = self.idle_variables.join(", ");
            let _ = writeln!(
                text,
                "\nat the start no objective and no constraint changes with: {names}"
            );
        }
        text
    }

    /// The explanation as JSON.
    pub fn json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

/// A number of bytes as text.
pub fn size(bytes: usize) -> String {
    match bytes as f64 {
        bytes if bytes < 1e3 => format!("{bytes} B"),
        bytes if bytes < 1e6 => format!("{:.1} kB", bytes / 1e3),
        bytes if bytes < 1e9 => format!("{:.1} MB", bytes / 1e6),
        bytes if bytes < 1e12 => format!("{:.1} GB", bytes / 1e9),
        bytes => format!("{:.1} TB", bytes / 1e12),
    }
}
