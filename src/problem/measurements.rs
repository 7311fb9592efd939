//! Measured values: tables in the problem file, and files of values separated by commas.

use super::data_file::{DataFault, DataFiles};
use super::data_text::{TextFault, Word, bytes, lines, number, quoted};
use super::fault::Faults;
use super::finding::Finding;
use super::pointer::join;
use super::source::Source;
use super::{Problem, Sense};
use crate::functions::series::Measured;
use crate::optimiser::Method;
use crate::schema::Document;
use crate::schema::functions::Function;
use crate::schema::misfit::{DataFile, Series, Variance};
use std::sync::Arc;

/// Data beyond the end by less than this part of the duration are at the end.
const SAME: f64 = 1e-12;

/// Reads the measured values of all misfits of a document in this file. Returns the content of other files as a
/// text for the hash of the problem.
///
/// # Errors
/// The first fault of a table or file.
pub(super) fn load(
    document: &mut Document,
    (file, source): (&str, &Source),
) -> Result<String, Faults> {
    let mut files = DataFiles::beside(file);
    let span = span(document);
    for (name, function) in &mut document.functions {
        let Function::Misfit(misfit) = function else {
            continue;
        };
        let pointer = join(&join(&join("/functions", name), "misfit"), "series");
        for (name, series) in &mut misfit.series {
            let read = measured(&join(&pointer, name), name, series, (&mut files, span));
            let read = read.map_err(|fault| fault.located((file, source)))?;
            series.loaded = Some(Arc::new(read));
        }
        // What all its data say together.
        let given = misfit.variance() == Variance::Given;
        for series in misfit.series.values_mut() {
            if let Some(loaded) = series.loaded.as_mut().and_then(Arc::get_mut) {
                loaded.has_deviations = given;
            }
        }
    }
    Ok(files.content)
}

/// Copies the data of all misfits to the same functions of `to`.
pub(super) fn share(from: &Document, to: &mut Document) {
    for (name, to) in &mut to.functions {
        if let (Function::Misfit(to), Some(Function::Misfit(from))) = (to, from.functions.get(name))
        {
            for (from, to) in from.series.values().zip(to.series.values_mut()) {
                to.loaded.clone_from(&from.loaded);
            }
        }
    }
}

/// Whether functions of a document have their data in other files.
pub(super) fn names_files(document: &Document) -> bool {
    document.functions.values().any(|function| match function {
        Function::Misfit(misfit) => misfit.series.values().any(|own| own.file.is_some()),
        _ => false,
    })
}

/// Least squares need the residuals of misfits.
pub(super) fn without_residuals(problem: &Problem) -> Option<Finding> {
    if problem.optimiser.method != Some(Method::LeastSquares) {
        return None;
    }
    let objective = problem.objective.filter(|own| own.sense == Sense::Minimise);
    if objective.is_some_and(|own| problem.misfits(own.function).is_some()) {
        return None;
    }
    let expected = "the objective to minimise a \"misfit\" or a sum of them with fixed factors above zero, or another method";
    Some(Finding::new(
        "/optimiser/method",
        "least squares without one",
        expected,
    ))
}

/// The duration of the motion, unless an event ends it.
fn span(document: &Document) -> Option<f64> {
    let simulation = document.simulation.as_ref()?;
    simulation
        .until
        .is_none()
        .then_some(simulation.duration.value)
}

/// A datum and where it is: time, value and √w.
struct Datum<P> {
    at: P,
    row: [f64; 3],
}

fn measured(
    pointer: &str,
    name: &str,
    series: &Series,
    (files, span): (&mut DataFiles<'_>, Option<f64>),
) -> Result<Measured, Box<DataFault>> {
    let document = |finding: Finding| Box::new(DataFault::Document(finding));
    let scale = series.scale.unwrap_or(1.0);
    if scale == 0.0 {
        let finding = Finding::new(join(pointer, "scale"), "0", "a factor that is not zero");
        return Err(document(finding));
    }
    let usual = series.standard_deviation.map_or(1.0, |sd| 1.0 / sd);
    let offset = series.offset.map_or(0.0, |offset| offset.value);
    let clock = (offset, span);
    let (rows, has_deviations): (Vec<[f64; 3]>, bool) = match (&series.table, &series.file) {
        (Some(table), None) => {
            let rows = of_table(&join(pointer, "table"), table, (scale, usual))
                .and_then(|rows| {
                    in_order(rows, clock)
                        .map_err(|(at, found, expected)| Finding::new(at, found, expected))
                })
                .map_err(document)?;
            let all = table.iter().all(|row| row.len() == 3);
            (rows, all || series.standard_deviation.is_some())
        }
        (None, Some(file)) => {
            let place = join(&join(pointer, "file"), "path");
            let (rows, own) = files.read(&place, &file.path, |text| {
                let (rows, own) = of_file(text, file, (scale, usual))?;
                let rows = in_order(rows, clock)
                    .map_err(|(at, found, expected)| TextFault::new(at, found, expected))?;
                Ok((rows, own))
            })?;
            (rows, own || series.standard_deviation.is_some())
        }
        (both, _) => {
            let found = match both {
                Some(_) => "both \"table\" and \"file\"",
                None => "neither \"table\" nor \"file\"",
            };
            return Err(document(
                Finding::new(pointer, found, "one of them").of_key(),
            ));
        }
    };
    Ok(Measured {
        name: name.to_owned(),
        times: rows.iter().map(|row| row[0]).collect(),
        values: rows.iter().map(|row| row[1]).collect(),
        weights: rows.iter().map(|row| row[2]).collect(),
        has_deviations,
    })
}

/// The data in the order of time, inside of the motion.
fn in_order<P>(
    data: Vec<Datum<P>>,
    (offset, span): (f64, Option<f64>),
) -> Result<Vec<[f64; 3]>, (P, String, String)> {
    let mut rows: Vec<[f64; 3]> = Vec::with_capacity(data.len());
    for Datum { at, row } in data {
        let time = row[0];
        if let Some(before) = rows.last().filter(|last| last[0] > time) {
            let expected = format!("times in their order, none before {}", before[0]);
            return Err((at, format!("the time {time}"), expected));
        }
        let own = time + offset;
        let late = span.filter(|span| own > span * (1.0 + SAME));
        if own < 0.0 || late.is_some() {
            let clock = match offset {
                0.0 => String::new(),
                _ => format!(", with the offset {own}"),
            };
            let expected = match span {
                Some(span) => format!("a time inside of the motion, from 0 to {span} s"),
                None => "a time inside of the motion, from 0 s on".to_owned(),
            };
            return Err((at, format!("the time {time}{clock}"), expected));
        }
        rows.push(row);
    }
    Ok(rows)
}

fn of_table(
    pointer: &str,
    table: &[Vec<f64>],
    (scale, usual): (f64, f64),
) -> Result<Vec<Datum<String>>, Finding> {
    if table.is_empty() {
        let expected = "at least one row [time, value]";
        return Err(Finding::new(pointer, "no rows", expected));
    }
    let datum = |(k, row): (usize, &Vec<f64>)| {
        let place = join(pointer, k);
        // A standard deviation of the series is in the unit of the quantity already.
        let weight = match row[..] {
            [_, _] => usual,
            [_, _, sd] if sd > 0.0 => 1.0 / (sd * scale.abs()),
            [_, _, sd] => {
                let expected = "a standard deviation above zero";
                return Err(Finding::new(join(&place, "2"), sd.to_string(), expected));
            }
            _ => {
                let found = format!("{} numbers", row.len());
                let expected = "[time, value] or [time, value, standard deviation]";
                return Err(Finding::new(place, found, expected));
            }
        };
        Ok(Datum {
            at: join(&place, "0"),
            row: [row[0], row[1] * scale, weight],
        })
    };
    table.iter().enumerate().map(datum).collect()
}

/// The fields of a line.
fn fields(start: usize, line: &str, separator: char) -> Vec<Word<'_>> {
    let mut at = start;
    let field = |text: &'_ str| {
        let begin = at;
        at += text.len() + separator.len_utf8();
        (begin, text.len())
    };
    let places: Vec<(usize, usize)> = line.split(separator).map(field).collect();
    let word = |(begin, length): (usize, usize)| {
        let text = &line[begin - start..begin - start + length];
        let trimmed = text.trim();
        let before = text.len() - text.trim_start().len();
        (begin + before, trimmed)
    };
    places.into_iter().map(word).collect()
}

/// The columns of a file: their places in a line.
struct Columns {
    time: usize,
    value: usize,
    deviation: Option<usize>,
    weight: Option<usize>,
}

impl Columns {
    fn find(header: &[Word<'_>], file: &DataFile) -> Result<Self, TextFault> {
        let name = |word: &Word<'_>| word.1.trim_matches('"').trim().to_owned();
        let names: Vec<String> = header.iter().map(name).collect();
        let whole = || {
            let (first, last) = (header[0], header[header.len() - 1]);
            first.0..last.0 + last.1.len()
        };
        let required = |wanted: &str| {
            let found = names.iter().position(|own| own == wanted);
            found.ok_or_else(|| {
                let found = format!("the columns {}", names.join(", "));
                TextFault::new(whole(), found, format!("a column \"{wanted}\""))
                    .hint("the first line names the columns; \"time\", \"value\" and others of \"file\" choose them")
            })
        };
        let optional = |given: &Option<String>, usual: &str| match given {
            Some(wanted) => required(wanted).map(Some),
            None => Ok(names.iter().position(|own| own == usual)),
        };
        let deviation = optional(&file.standard_deviation, "standard_deviation")?;
        let weight = match deviation {
            Some(_) if file.weight.is_none() => None,
            _ => optional(&file.weight, "weight")?,
        };
        Ok(Self {
            time: required(file.time.as_deref().unwrap_or("time"))?,
            value: required(file.value.as_deref().unwrap_or("value"))?,
            deviation,
            weight,
        })
    }
}

/// A datum with the bytes of its time.
type DatumOfText = Datum<std::ops::Range<usize>>;

/// The data of a file, and whether it has standard deviations.
fn of_file(
    text: &str,
    file: &DataFile,
    (scale, usual): (f64, f64),
) -> Result<(Vec<DatumOfText>, bool), TextFault> {
    let mut content = lines(text).filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let none = |what: &str| {
        let expected = "a line with the names of the columns, and lines of numbers";
        TextFault::new(0..text.len().min(1), what, expected)
    };
    let (start, line) = content.next().ok_or_else(|| none("nothing"))?;
    let separator = [',', ';', '\t'].into_iter().find(|own| line.contains(*own));
    let separator = separator.unwrap_or(',');
    let header = fields(start, line, separator);
    let columns = Columns::find(&header, file)?;
    let mut data = Vec::new();
    for (start, line) in content {
        let words = fields(start, line, separator);
        if words.len() != header.len() {
            let found = format!("{} entries", words.len());
            let expected = format!("{}, as many as columns", header.len());
            return Err(TextFault::new(start..start + line.len(), found, expected));
        }
        let positive = |column: usize, what: &str| {
            let word = &words[column];
            match number(word)? {
                x if x > 0.0 => Ok(x),
                _ => Err(TextFault::new(bytes(word), quoted(word.1), what)),
            }
        };
        let mut weight = match columns.deviation {
            Some(column) => {
                1.0 / (positive(column, "a standard deviation above zero")? * scale.abs())
            }
            None => usual,
        };
        if let Some(column) = columns.weight {
            weight *= positive(column, "a weight above zero")?.sqrt();
        }
        let time = &words[columns.time];
        data.push(Datum {
            at: bytes(time),
            row: [
                number(time)?,
                number(&words[columns.value])? * scale,
                weight,
            ],
        });
    }
    match data.is_empty() {
        true => Err(none("no data")),
        false => Ok((data, columns.deviation.is_some())),
    }
}
