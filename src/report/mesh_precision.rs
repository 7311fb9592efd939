//! Error against run time of structures, from mesh to mesh: `work_precision.csv` and a table.

use super::csv::csv_table;
use super::number::significant;
use super::table::render;

/// Results on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshRow {
    /// Number of cuts of each element of the file along each direction.
    pub cuts: usize,
    /// Number of elements.
    pub elements: usize,
    /// Number of unknowns.
    pub unknowns: usize,
    /// CPU time of the solution, and of one gradient on top \[s\].
    pub seconds: f64,
    /// See above.
    pub gradient_seconds: f64,
    /// Values of all functions.
    pub values: Vec<f64>,
    /// The gradient of one.
    pub gradient: Vec<f64>,
}

/// All meshes of a problem; the last is the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct PrecisionOfMesh {
    /// Name of the problem.
    pub name: String,
    /// Names of the functions.
    pub functions: Vec<String>,
    /// The function whose gradient is judged.
    pub chosen: usize,
    /// From coarse to fine.
    pub rows: Vec<MeshRow>,
}

impl PrecisionOfMesh {
    /// Relative differences from the finest mesh: of each function, and of the gradient.
    pub fn errors(&self, row: &MeshRow) -> Option<Vec<f64>> {
        let last = self.rows.last().filter(|last| last.cuts != row.cuts)?;
        let relative = |a: f64, b: f64| if a == b { 0.0 } else { (a - b).abs() / b.abs() };
        let pairs = row.values.iter().zip(&last.values);
        let mut all: Vec<f64> = pairs.map(|(&a, &b)| relative(a, b)).collect();
        let pairs = || row.gradient.iter().zip(&last.gradient);
        let difference = pairs().map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let size = last.gradient.iter().map(|b| b * b).sum::<f64>().sqrt();
        all.push(if difference == 0.0 {
            0.0
        } else {
            difference / size
        });
        Some(all)
    }

    fn headings(&self) -> Vec<String> {
        let fixed = ["elements", "unknowns", "time [s]", "gradient [s]"];
        let errors = self.functions.iter().map(|name| format!("error of {name}"));
        let gradient = match self.functions.get(self.chosen) {
            Some(name) => format!("error of the gradient of {name}"),
            None => "error of the gradient".to_owned(),
        };
        let fixed = fixed.iter().map(ToString::to_string);
        fixed.chain(errors).chain([gradient]).collect()
    }

    fn cells(&self) -> Vec<Vec<String>> {
        let row = |row: &MeshRow| {
            let number = |x: f64| significant(x, 3);
            let mut cells = vec![row.elements.to_string(), row.unknowns.to_string()];
            cells.extend([number(row.seconds), number(row.gradient_seconds)]);
            match self.errors(row) {
                Some(errors) => cells.extend(errors.into_iter().map(number)),
                None => cells.extend(vec![String::new(); self.functions.len() + 1]),
            }
            cells
        };
        self.rows.iter().map(row).collect()
    }

    /// A table for people.
    pub fn text(&self) -> String {
        let headings: Vec<String> = self.headings().iter().map(|h| format!(">{h}")).collect();
        let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
        format!(
            "{}: relative differences from the finest mesh, which is the last line\n{}",
            self.name,
            render(&headings, &self.cells())
        )
    }

    /// A table for programs.
    pub fn to_csv(&self) -> String {
        let row = |row: &MeshRow| {
            let counts = [row.elements as f64, row.unknowns as f64];
            let times = [row.seconds, row.gradient_seconds];
            let unknown = vec![f64::NAN; self.functions.len() + 1];
            let errors = self.errors(row).unwrap_or(unknown);
            counts.into_iter().chain(times).chain(errors).collect()
        };
        csv_table(&self.headings(), self.rows.iter().map(row))
    }
}
