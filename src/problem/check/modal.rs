//! Bodies from files of other codes: conditions before and after the files are read.

use super::Checker;
use crate::finding::Finding;
use crate::pointer::{advice, join};
use crate::schema::mechanics::Body;
use crate::schema::modal::{Modal, ModalFrame, Source};

impl Checker<'_> {
    pub(super) fn modal(&mut self, pointer: &str, body: &Body, modal: &Modal) {
        let expected = "one of them, as the files of the body give it";
        self.without_rigid_keys(pointer, body, ("modal", expected));
        let points = join(pointer, "points");
        let pointer = &join(pointer, "modal");
        match &modal.source {
            Source::StandardInput(_) => self.without_matrices(pointer, modal),
            Source::MatrixMarket { .. } | Source::Dmig { .. } => self.interfaces(pointer, modal),
        }
        for name in modal
            .point_names()
            .filter(|name| body.points.contains_key(*name))
        {
            let found = format!("\"{name}\", which an interface is called too");
            let finding = Finding::new(join(&points, name), found, "a name once");
            self.fault(finding.of_key());
        }
        let count = modal.loaded.as_ref().map(|loaded| loaded.body.modes());
        if let (Some(start), Some(count)) = (&modal.start, count) {
            for (key, row) in [("coordinates", &start.coordinates), ("rates", &start.rates)] {
                let Some(row) = row.as_ref().filter(|row| row.len() != count) else {
                    continue;
                };
                let found = format!("a list of {}", row.len());
                let expected = format!("a list of {count} numbers, by ascending frequency");
                let place = join(&join(pointer, "start"), key);
                self.fault(Finding::new(place, found, expected));
            }
        }
    }

    /// Standard input data have their own points and axes.
    fn without_matrices(&mut self, pointer: &str, modal: &Modal) {
        let extra = [
            ("interfaces", !modal.interfaces.is_empty()),
            ("frame", modal.frame.is_some()),
            ("modes", modal.modes.is_some()),
        ];
        for (key, _) in extra.into_iter().filter(|(_, given)| *given) {
            let found = format!("\"{key}\" beside \"standard_input\"");
            let expected = "none, as the file of the body has points and modes";
            self.fault(Finding::new(join(pointer, key), found, expected).of_key());
        }
    }

    fn interfaces(&mut self, pointer: &str, modal: &Modal) {
        if modal.interfaces.is_empty() {
            let finding = Finding::new(
                pointer,
                "a body of matrices without interfaces",
                "\"interfaces\": names of points and the numbers of their nodes",
            );
            self.fault(finding.of_key());
            return;
        }
        for (name, nodes) in &modal.interfaces {
            if nodes.list().is_empty() {
                let place = join(&join(pointer, "interfaces"), name);
                self.fault(Finding::new(place, "no node", "at least one node"));
            }
        }
        let frame = join(pointer, "frame");
        let mut known = |place: &str, name: &str| {
            if !modal.interfaces.contains_key(name) {
                let names = modal.interfaces.keys().map(String::as_str);
                let hint = advice(name, "interfaces", names);
                let expected = "the name of an interface";
                let finding = Finding::new(place, format!("\"{name}\""), expected);
                self.findings.push(finding.hint(hint));
            }
        };
        match &modal.frame {
            None => {}
            Some(ModalFrame::Clamped(name)) => known(&join(&frame, "clamped"), name),
            Some(ModalFrame::Chord(names)) => {
                let place = join(&frame, "chord");
                for (k, name) in names.iter().enumerate() {
                    known(&join(&place, k), name);
                }
                let mut sorted = names.clone();
                sorted.sort();
                sorted.dedup();
                if !(2..=3).contains(&names.len()) || sorted.len() != names.len() {
                    let found = names.join(", ");
                    let expected = "two or three different interfaces";
                    self.fault(Finding::new(place, found, expected));
                }
            }
        }
    }
}
