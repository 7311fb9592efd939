//! Values of a parameter, as `--sweep` takes them.

/// Values of a parameter: `PATH=a..b,n`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Range {
    /// JSON Pointer to the parameter.
    pub path: String,
    first: f64,
    last: f64,
    count: usize,
}

/// Largest number of values of a sweep.
const MOST: usize = 1000;

/// Reads `PATH=a..b,n`.
pub(crate) fn range(text: &str) -> Result<Range, String> {
    let expected = || "expected PATH=a..b,n such as /bodies/arm/mass=30..60,7".to_owned();
    let (path, rest) = text.split_once('=').ok_or_else(expected)?;
    let (first, rest) = rest.split_once("..").ok_or_else(expected)?;
    let (last, count) = rest.split_once(',').ok_or_else(expected)?;
    let value = |text: &str| text.trim().parse::<f64>().map_err(|_| expected());
    let (first, last) = (value(first)?, value(last)?);
    let count: usize = count.trim().parse().map_err(|_| expected())?;
    if !path.starts_with('/') {
        return Err(
            "expected a JSON Pointer such as /bodies/arm/mass before the equals sign".into(),
        );
    }
    if !first.is_finite() || !last.is_finite() || first == last {
        return Err("expected two different finite ends".into());
    }
    if !(2..=MOST).contains(&count) {
        return Err(format!("expected 2 to {MOST} values"));
    }
    Ok(Range {
        path: path.to_owned(),
        first,
        last,
        count,
    })
}

impl Range {
    /// The values, with both ends.
    pub(crate) fn values(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.count).map(|k| match k {
            k if k + 1 == self.count => self.last,
            k => self.first + (self.last - self.first) * k as f64 / (self.count - 1) as f64,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read() {
        let read = range("/a/b=-1..2.5,8").expect("a range");
        let values: Vec<f64> = read.values().collect();
        assert_eq!((values.len(), values[0], values[7]), (8, -1.0, 2.5));
        assert_eq!(values[1], -0.5);
        for text in [
            "/a",
            "/a=1",
            "/a=1..2",
            "/a=1..1,3",
            "/a=1..2,1",
            "/a=1..2,x",
            "a=1..2,3",
            "/a=1..nan,3",
            "/a=1..2,1001",
        ] {
            assert!(range(text).is_err(), "{text}");
        }
    }
}
