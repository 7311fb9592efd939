//! Messages of one kind on the members of one family, as functions `stress[0]`, `stress[1]`, …, told once.

/// A message on the function or constraint `name`; of a family the one of the largest `size` is told.
pub(super) struct Message {
    pub name: String,
    pub size: f64,
    pub text: String,
}

/// The messages in their order, with those of a family in one.
pub(super) fn grouped(all: impl IntoIterator<Item = Message>) -> Vec<String> {
    let mut kept: Vec<(Message, usize)> = Vec::new();
    for message in all {
        let same = |(own, _): &&mut (Message, usize)| {
            family(&own.name).is_some_and(|family_of| family(&message.name) == Some(family_of))
        };
        match kept.iter_mut().find(same) {
            Some((own, count)) => {
                *count += 1;
                if message.size > own.size {
                    *own = message;
                }
            }
            None => kept.push((message, 0)),
        }
    }
    let told = kept
        .into_iter()
        .map(|(own, others)| match (family(&own.name), others) {
            (Some(name), 1..) => {
                format!("{}; so of {others} more of \"{name}\", by less", own.text)
            }
            _ => own.text,
        });
    told.collect()
}

/// `stress` of `stress[3]`.
fn family(name: &str) -> Option<&str> {
    let (family, number) = name.strip_suffix(']')?.rsplit_once('[')?;
    number.parse::<usize>().is_ok().then_some(family)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn members_of_a_family_are_told_once_by_the_largest() {
        let message = |name: &str, size: f64| Message {
            name: name.into(),
            size,
            text: format!("{name} is far"),
        };
        let all = [
            ("stress[0]", 1.0),
            ("mass", 5.0),
            ("stress[12]", 3.0),
            ("load[x]", 1.0),
            ("stress[2]", 2.0),
            ("load[y]", 1.0),
            ("t[1]", 1.0),
        ];
        let told = grouped(all.map(|(name, size)| message(name, size)));
        let expected = [
            "stress[12] is far; so of 2 more of \"stress\", by less",
            "mass is far",
            "load[x] is far",
            "load[y] is far",
            "t[1] is far",
        ];
        assert_eq!(told, expected);
    }
}
