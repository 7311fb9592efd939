//! Tables of reference positions.

use super::ReportError;
use super::csv;
use std::path::Path;

/// Positions of centres of mass \[m\] by index of the body.
pub type Positions = Vec<(usize, [f64; 3])>;

/// Reads a table of positions, `time,body,x,y,z` (s and m). Returns those of the instant `end` by
/// index of the body in `bodies`.
///
/// # Errors
/// [`ReportError::Positions`] with the line if the table has another form, names another body,
/// names one twice or has no row at the end.
pub fn positions_from_csv(
    path: &Path,
    text: &str,
    bodies: &[String],
    end: f64,
) -> Result<Positions, ReportError> {
    let fault = |line: usize, found: String, expected: String| ReportError::Positions {
        path: path.to_path_buf(),
        line,
        found,
        expected,
    };
    const HEADER: [&str; 5] = ["time", "body", "x", "y", "z"];
    let records = csv::parse(text).map_err(|bad| {
        fault(
            bad.line,
            "a quote out of place".into(),
            "quotes as in RFC 4180".into(),
        )
    })?;
    let (found, line) = match records.first() {
        Some(header) if header.fields == HEADER => (None, 1),
        Some(header) => (Some(header.fields.join(",")), header.line),
        None => (Some("an empty file".into()), 1),
    };
    if let Some(found) = found {
        return Err(fault(line, found, HEADER.join(",")));
    }
    let mut all: Positions = Vec::new();
    let mut latest = f64::NEG_INFINITY;
    for record in &records[1..] {
        let [time, name, place @ ..] = record.fields.as_slice() else {
            return Err(fault(
                record.line,
                "too few fields".into(),
                "five fields".into(),
            ));
        };
        if place.len() != 3 {
            let found = format!("{} fields", record.fields.len());
            return Err(fault(record.line, found, "five fields".into()));
        }
        let number = |text: &String| match text.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(fault(
                record.line,
                format!("{text:?}"),
                "a finite number".into(),
            )),
        };
        let time = number(time)?;
        let place = [number(&place[0])?, number(&place[1])?, number(&place[2])?];
        let Some(body) = bodies.iter().position(|body| body == name.trim()) else {
            let expected = format!("one of the bodies {}", bodies.join(", "));
            return Err(fault(record.line, format!("{name:?}"), expected));
        };
        latest = latest.max(time);
        if (time - end).abs() > 1e-9 * end {
            continue;
        }
        if all.iter().any(|(known, _)| *known == body) {
            let found = format!("{name:?} at {end} s once more");
            return Err(fault(
                record.line,
                found,
                "one row for each body and instant".into(),
            ));
        }
        all.push((body, place));
    }
    if all.is_empty() {
        let line = records[records.len() - 1].line;
        let found = match latest.is_finite() {
            true => format!("rows up to {latest} s"),
            false => "no rows".into(),
        };
        let expected = format!("rows at {end} s, where the motion ends");
        return Err(fault(line, found, expected));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_read_at_the_end_by_body() {
        let bodies = ["arm".to_owned(), "bob".to_owned()];
        let read = |text: &str| positions_from_csv(Path::new("p.csv"), text, &bodies, 2.0);
        let good = "time,body,x,y,z\n1,arm,0,0,0\n2,bob,1,2,3\n2,arm,4,5,6\n";
        let found = read(good).expect("is a table");
        assert_eq!(found, [(1, [1.0, 2.0, 3.0]), (0, [4.0, 5.0, 6.0])]);
        for (text, part) in [
            ("", "empty file"),
            ("t,x\n", "time,body,x,y,z"),
            ("time,body,x,y,z\n2,leg,0,0,0\n", "arm, bob"),
            ("time,body,x,y,z\n2,arm,0,0\n", "five fields"),
            ("time,body,x,y,z\n2,arm,0,0,far\n", "finite number"),
            ("time,body,x,y,z\n1,arm,0,0,0\n", "rows at 2 s"),
            ("time,body,x,y,z\n2,arm,0,0,0\n2,arm,0,0,0\n", "once more"),
        ] {
            let fault = read(text).expect_err("is no table").to_string();
            assert!(
                fault.contains(part) && fault.starts_with("p.csv:"),
                "{fault}"
            );
        }
    }
}
