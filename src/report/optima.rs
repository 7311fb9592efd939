//! The distinct optima of several starts as a table, `optima.csv`.

use super::ReportError;
use super::csv;
use super::history::{Column, OBJECTIVE, VARIABLE, exact};

/// An optimum that at least one start reached.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundOptimum {
    /// The number of the start with the best value there, from 1.
    pub start: usize,
    /// Number of starts that reached it.
    pub starts: usize,
    /// Objective in the user's sense.
    pub objective: f64,
    /// Values of the variables.
    pub design: Vec<f64>,
}

/// Optima, best first, as comma separated values (RFC 4180), with the columns of `history.csv` for
/// objective and variables.
///
/// # Errors
/// [`ReportError::History`] if a unit contains a square bracket.
pub fn optima_csv(
    objective: &Column,
    variables: &[Column],
    optima: &[FoundOptimum],
) -> Result<String, ReportError> {
    let mut header = vec!["optimum".to_owned(), "best start".into(), "starts".into()];
    header.push(objective.heading(OBJECTIVE)?);
    for variable in variables {
        header.push(variable.heading(VARIABLE)?);
    }
    let mut text = String::new();
    csv::write_record(&mut text, header.iter().map(String::as_str));
    for (k, found) in optima.iter().enumerate() {
        let mut fields: Vec<String> = [k + 1, found.start, found.starts]
            .map(|count| count.to_string())
            .to_vec();
        fields.push(exact(found.objective));
        fields.extend(found.design.iter().map(|&x| exact(x)));
        csv::write_record(&mut text, fields.iter().map(String::as_str));
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_that_of_the_optima() {
        let found = FoundOptimum {
            start: 3,
            starts: 2,
            objective: -0.1,
            design: vec![2.5, 1e-20],
        };
        let columns = [
            Column::new("mass, left", Some("kg")),
            Column::new("x", None),
        ];
        let text = optima_csv(&Column::new("range", Some("m")), &columns, &[found]);
        assert_eq!(
            text.expect("is written"),
            "optimum,best start,starts,objective: range [m],\"variable: mass, left [kg]\",variable: x\n\
             1,3,2,-0.1,2.5,1e-20\n"
        );
    }
}
