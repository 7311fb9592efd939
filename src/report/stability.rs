//! The stability table: results of extreme scenes, as Markdown and as CSV.

use super::csv;

/// Result of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum StabilityOutcome {
    /// The numbers agree with their judge.
    Accurate,
    /// The numbers are wrong, and the program says so.
    Degraded {
        /// The warning or number that says so.
        told: String,
    },
    /// No numbers, but a reason.
    Refused {
        /// The reason in the program's words.
        message: String,
    },
    /// The case exceeded its time limit.
    TimeLimit {
        /// The limit \[s\].
        seconds: f64,
    },
    /// The program panicked.
    Panicked {
        /// Message of the panic.
        message: String,
    },
    /// The numbers are wrong without a warning.
    WrongAndSilent,
}

impl StabilityOutcome {
    /// The class in a few words.
    pub fn class(&self) -> &'static str {
        match self {
            StabilityOutcome::Accurate => "accurate",
            StabilityOutcome::Degraded { .. } => "degraded",
            StabilityOutcome::Refused { .. } => "refused",
            StabilityOutcome::TimeLimit { .. } => "time limit",
            StabilityOutcome::Panicked { .. } => "panicked",
            StabilityOutcome::WrongAndSilent => "wrong and silent",
        }
    }

    /// Whether the result is a failure of the program.
    pub fn is_failure(&self) -> bool {
        match self {
            StabilityOutcome::Accurate
            | StabilityOutcome::Degraded { .. }
            | StabilityOutcome::Refused { .. } => false,
            StabilityOutcome::TimeLimit { .. }
            | StabilityOutcome::Panicked { .. }
            | StabilityOutcome::WrongAndSilent => true,
        }
    }

    /// The program's message, if any.
    pub fn words(&self) -> &str {
        match self {
            StabilityOutcome::Degraded { told } => told,
            StabilityOutcome::Refused { message } | StabilityOutcome::Panicked { message } => {
                message
            }
            StabilityOutcome::Accurate
            | StabilityOutcome::TimeLimit { .. }
            | StabilityOutcome::WrongAndSilent => "",
        }
    }
}

/// One case.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityRow {
    /// The extreme property, in one word.
    pub family: String,
    /// Its value.
    pub extreme: String,
    /// Problem file without its folder.
    pub scene: String,
    /// Requested method, with its tolerance or number of steps.
    pub method: String,
    /// Name of the method in use.
    pub by: Option<String>,
    /// Number of steps.
    pub steps: Option<usize>,
    /// The result.
    pub outcome: StabilityOutcome,
    /// Largest error of a function relative to the size of the motion.
    pub error: Option<f64>,
    /// Largest error of accurate numbers.
    pub bound: f64,
    /// Source of the correct numbers.
    pub judge: String,
    /// Largest change of energy relative to the largest kinetic energy, if energy is conserved.
    pub energy_drift: Option<f64>,
    /// Largest |Φ| \[m or 1\].
    pub position_drift: Option<f64>,
    /// Largest |G v| \[m/s or 1/s\].
    pub velocity_drift: Option<f64>,
    /// Largest difference of a derivative by the adjoint from the complex step, relative to the
    /// largest derivative of the scene (in relative changes of variables and functions).
    pub gradient_error: Option<f64>,
    /// Why a motion has no derivatives.
    pub no_gradient: Option<String>,
    /// Command that runs the case.
    pub command: String,
}

impl StabilityRow {
    /// Name of the case, by which it can be run alone.
    pub fn name(&self) -> String {
        case_name(&self.family, &self.extreme, &self.method)
    }
}

/// Name of a case: property, value and method.
pub fn case_name(family: &str, extreme: &str, method: &str) -> String {
    format!("{family}/{extreme}/{method}")
}

/// A family of cases.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityFamily {
    /// Its word.
    pub name: String,
    /// Its description.
    pub about: String,
}

/// All cases, family by family.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityTable {
    /// Families in the order of the table.
    pub families: Vec<StabilityFamily>,
    /// Cases in the order of the table.
    pub rows: Vec<StabilityRow>,
}

/// Classes in the order of the summary.
const CLASSES: [&str; 6] = [
    "accurate",
    "degraded",
    "refused",
    "time limit",
    "panicked",
    "wrong and silent",
];

const COLUMNS: [&str; 18] = [
    "case",
    "scene",
    "extreme",
    "method",
    "by",
    "steps",
    "outcome",
    "error",
    "bound",
    "judged_by",
    "energy_drift",
    "position_drift",
    "velocity_drift",
    "gradient_error",
    "no_gradient",
    "words",
    "family",
    "command",
];

impl StabilityTable {
    /// The rows as CSV.
    pub fn to_csv(&self) -> String {
        let mut text = String::new();
        csv::write_record(&mut text, COLUMNS.into_iter());
        let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.3e}"));
        for row in &self.rows {
            let fields = [
                row.name(),
                row.scene.clone(),
                row.extreme.clone(),
                row.method.clone(),
                row.by.clone().unwrap_or_default(),
                row.steps.map_or_else(String::new, |n| n.to_string()),
                row.outcome.class().to_owned(),
                number(row.error),
                format!("{:.0e}", row.bound),
                row.judge.clone(),
                number(row.energy_drift),
                number(row.position_drift),
                number(row.velocity_drift),
                number(row.gradient_error),
                row.no_gradient.clone().unwrap_or_default(),
                row.outcome.words().to_owned(),
                row.family.clone(),
                row.command.clone(),
            ];
            csv::write_record(&mut text, fields.iter().map(String::as_str));
        }
        text
    }

    /// The rows as Markdown, one table per family.
    pub fn to_markdown(&self) -> String {
        let mut text = String::from(
            "# Stability\n\nResults of `optimize stability` on extreme scenes. \
             [docs/stability.md](../../docs/stability.md) says how they are judged.\nThe command of \
             every row is in [stability.csv](stability.csv).\n\n",
        );
        text += "| what is extreme | cases |";
        CLASSES
            .iter()
            .for_each(|class| text += &format!(" {class} |"));
        text += "\n|---|---|";
        CLASSES.iter().for_each(|_| text += "---|");
        text.push('\n');
        let mut line = |name: &str, rows: &[&StabilityRow]| {
            text += &format!("| {name} | {} |", rows.len());
            for class in CLASSES {
                let own = rows.iter().filter(|row| row.outcome.class() == class);
                text += &format!(" {} |", own.count());
            }
            text.push('\n');
        };
        for family in &self.families {
            line(&family.name, &self.of(family));
        }
        line("all", &self.rows.iter().collect::<Vec<_>>());
        for family in &self.families {
            let rows = self.of(family);
            if rows.is_empty() {
                continue;
            }
            text += &format!("\n## {}\n\n{}\n\n", family.name, family.about);
            text += "| extreme | scene | method | by | steps | outcome | error | accurate within | \
                     judged by | energy drift | position drift | velocity drift | gradient error |\n";
            text += "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
            rows.iter().for_each(|row| text += &markdown_row(row));
            let notes = notes(&rows);
            if !notes.is_empty() {
                text += &format!("\n{notes}");
            }
        }
        text
    }

    fn of(&self, family: &StabilityFamily) -> Vec<&StabilityRow> {
        let own = self.rows.iter().filter(|row| row.family == family.name);
        own.collect()
    }

    /// Number of rows of every class that occurs, as text.
    pub fn summary(&self) -> String {
        let mut parts = Vec::new();
        for class in CLASSES {
            let count = self.rows.iter().filter(|row| row.outcome.class() == class);
            let count = count.count();
            if count > 0 {
                parts.push(format!("{count} {class}"));
            }
        }
        format!("{} cases: {}", self.rows.len(), parts.join(", "))
    }

    /// Whether a row is wrong and silent, panicked or exceeded its time limit.
    pub fn has_failures(&self) -> bool {
        self.rows.iter().any(|row| row.outcome.is_failure())
    }
}

fn markdown_row(row: &StabilityRow) -> String {
    let number = |x: Option<f64>| x.map_or_else(|| "–".into(), |x| format!("{x:.1e}"));
    let gradient = match (&row.gradient_error, &row.no_gradient) {
        (None, Some(_)) => "none".into(),
        (error, _) => number(*error),
    };
    let steps = row.steps.map_or_else(|| "–".into(), |n| n.to_string());
    format!(
        "| {} | {} | {} | {} | {steps} | {} | {} | {:.0e} | {} | {} | {} | {} | {gradient} |\n",
        row.extreme,
        row.scene,
        row.method,
        row.by.as_deref().unwrap_or("–"),
        row.outcome.class(),
        number(row.error),
        row.bound,
        row.judge,
        number(row.energy_drift),
        number(row.position_drift),
        number(row.velocity_drift),
    )
}

/// Messages of the program on the rows; equal ones once.
fn notes(rows: &[&StabilityRow]) -> String {
    let mut said: Vec<(String, Vec<String>)> = Vec::new();
    let mut add = |row: &StabilityRow, what: String| {
        let which = format!("{} by {}", row.extreme, row.method);
        match said.iter_mut().find(|(words, _)| *words == what) {
            Some((_, all)) => all.push(which),
            None => said.push((what, vec![which])),
        }
    };
    for row in rows {
        let words = row.outcome.words().replace('\n', " ");
        if !words.is_empty() {
            add(row, format!("{}: {words}", row.outcome.class()));
        }
        if let Some(reason) = &row.no_gradient {
            add(row, format!("no gradient: {}", reason.replace('\n', " ")));
        }
    }
    let line = |(words, which): (String, Vec<String>)| format!("- {}: {words}\n", which.join("; "));
    said.into_iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(outcome: StabilityOutcome) -> StabilityRow {
        StabilityRow {
            family: "speeds".into(),
            extreme: "1e6".into(),
            scene: "fast.json".into(),
            method: "dop853".into(),
            by: None,
            steps: Some(3),
            outcome,
            error: None,
            bound: 1e-6,
            judge: "closed form".into(),
            energy_drift: None,
            position_drift: Some(1e-9),
            velocity_drift: None,
            gradient_error: None,
            no_gradient: None,
            command: "optimize simulate fast.json".into(),
        }
    }

    #[test]
    fn words_of_the_program_stand_below_the_table_once() {
        let refused = StabilityOutcome::Refused {
            message: "too fast".into(),
        };
        let table = StabilityTable {
            families: vec![StabilityFamily {
                name: "speeds".into(),
                about: "Fast.".into(),
            }],
            rows: vec![
                row(refused.clone()),
                row(refused),
                row(StabilityOutcome::Accurate),
            ],
        };
        let text = table.to_markdown();
        assert_eq!(text.matches("too fast").count(), 1, "{text}");
        assert!(
            text.contains("| speeds | 3 | 1 | 0 | 2 | 0 | 0 | 0 |"),
            "{text}"
        );
        assert_eq!(table.summary(), "3 cases: 1 accurate, 2 refused");
        assert!(!table.has_failures());
        assert_eq!(table.to_csv().lines().count(), 4);
    }
}
