//! What is said of redundant rows that are left out.

/// Largest number of joints of which alike messages are said one by one.
const ALONE: usize = 3;

/// A joint with redundant rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Redundancy {
    /// The joint.
    pub joint: String,
    /// Number of its rows that are left out.
    pub left_out: usize,
    /// Number of its rows.
    pub rows: usize,
    /// How far these rows miss, relative to the size of their loop or as an angle \[rad\], if they fit only
    /// within the tolerance of the input; with this tolerance.
    pub misfit: Option<[f64; 2]>,
}

impl Redundancy {
    /// The message for these joints.
    fn text(&self, joints: &str, several: bool) -> String {
        let (each, their) = match several {
            true => (" each", "their"),
            false => ("", "its"),
        };
        let fit = match self.misfit {
            None => "to 1e-11".to_owned(),
            Some([misfit, tolerance]) => {
                format!("but for {misfit:.1e} (\"input_tolerance\" {tolerance:e})")
            }
        };
        let (left_out, rows) = (self.left_out, self.rows);
        format!(
            "{joints}: {left_out} of {rows} rows{each} follow from the others {fit} and are left out; {their} \
             reactions are not unique"
        )
    }

    /// Whether the messages differ by the joint alone.
    fn is_like(&self, other: &Self) -> bool {
        (self.left_out, self.rows) == (other.left_out, other.rows)
            && self.misfit.is_some() == other.misfit.is_some()
    }
}

impl std::fmt::Display for Redundancy {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        let joint = format!("joint \"{}\"", self.joint);
        f.write_str(&self.text(&joint, false))
    }
}

/// The messages, with one for all joints that are alike if there are more than three. It names the first
/// three, and the largest misfit.
pub fn told(all: &[Redundancy]) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, first) in all.iter().enumerate() {
        if all[..i].iter().any(|before| before.is_like(first)) {
            continue;
        }
        let group: Vec<&Redundancy> = all.iter().filter(|own| own.is_like(first)).collect();
        if group.len() <= ALONE {
            lines.extend(group.iter().map(|own| own.to_string()));
            continue;
        }
        let misfits = group.iter().filter_map(|own| own.misfit);
        let largest = Redundancy {
            misfit: misfits.max_by(|a, b| a[0].total_cmp(&b[0])),
            ..first.clone()
        };
        let names: Vec<&str> = group.iter().map(|own| own.joint.as_str()).collect();
        lines.push(largest.text(&listed(&names), true));
    }
    lines
}

/// The names of several joints, of which the first three are written.
pub fn listed(names: &[&str]) -> String {
    let first: Vec<String> = (names.iter().take(ALONE))
        .map(|name| format!("\"{name}\""))
        .collect();
    let first = first.join(", ");
    match names.len() {
        1 => format!("joint {first}"),
        n if n <= ALONE => format!("joints {first}"),
        n => format!("joints {first} and {} more", n - ALONE),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(joint: &str, left_out: usize, misfit: Option<f64>) -> Redundancy {
        Redundancy {
            joint: joint.to_owned(),
            left_out,
            rows: 5,
            misfit: misfit.map(|x| [x, 1e-5]),
        }
    }

    #[test]
    fn alike_messages_are_grouped_and_name_the_largest_misfit() {
        let mut all: Vec<Redundancy> = (0..80).map(|i| of(&format!("j{i}"), 3, None)).collect();
        all.push(of("door", 5, None));
        all.extend((0..5).map(|i| of(&format!("r{i}"), 3, Some(1e-7 * f64::from(i)))));
        assert_eq!(
            told(&all),
            [
                "joints \"j0\", \"j1\", \"j2\" and 77 more: 3 of 5 rows each follow from the others to 1e-11 and \
                 are left out; their reactions are not unique",
                "joint \"door\": 5 of 5 rows follow from the others to 1e-11 and are left out; its reactions \
                 are not unique",
                "joints \"r0\", \"r1\", \"r2\" and 2 more: 3 of 5 rows each follow from the others but for \
                 4.0e-7 (\"input_tolerance\" 1e-5) and are left out; their reactions are not unique",
            ]
        );
        let few = [of("a", 1, None), of("b", 1, None), of("c", 1, None)];
        assert_eq!(told(&few), few.each_ref().map(Redundancy::to_string));
    }
}
