//! Load cases of structures, and functions of them.

use super::Checker;
use super::sets::Kind;
use crate::finding::Finding;
use crate::pointer::{advice, join};
use crate::schema::functions::Function;
use crate::schema::misfit::Misfit;
use crate::schema::statics::{CaseLoad, Stress};
use crate::schema::structures::{Material, Structure, Thickness};
use std::collections::BTreeSet;

impl Checker<'_> {
    pub(super) fn case_load(&mut self, pointer: &str, load: &CaseLoad) {
        match load {
            CaseLoad::Point {
                nodes,
                force,
                moment,
            } => {
                let pointer = join(pointer, "point");
                self.set(&join(&pointer, "nodes"), nodes, Kind::Nodes);
                if force.is_none() && moment.is_none() {
                    let expected = "\"force\", \"moment\" or both";
                    self.fault(Finding::new(&pointer, "no force", expected).of_key());
                }
            }
            CaseLoad::Edge { edges, .. } => {
                self.set(&format!("{pointer}/edge/edges"), edges, Kind::Edges);
            }
            CaseLoad::Line { beams, .. } => {
                self.set(&format!("{pointer}/line/beams"), beams, Kind::Beams);
            }
            CaseLoad::Pressure { faces, .. } => {
                self.set(&format!("{pointer}/pressure/faces"), faces, Kind::Faces);
            }
            CaseLoad::Area { faces, .. } => {
                self.set(&format!("{pointer}/area/faces"), faces, Kind::Faces);
            }
            CaseLoad::Gravity { .. } => self.densities("weight"),
        }
    }

    /// Every material that is used has a density, if a load or function needs it.
    fn densities(&mut self, what: &str) {
        self.property(what, "density", |m| m.density.is_none());
    }

    fn property(&mut self, what: &str, key: &str, lacks: fn(&Material) -> bool) {
        let used: BTreeSet<&String> = self
            .document
            .structures
            .values()
            .map(|s| &s.material)
            .collect();
        for name in used {
            let pointer = join("/materials", name);
            let told =
                |finding: &Finding| finding.pointer == pointer && finding.found.contains(key);
            let lacking = self.document.materials.get(name).is_some_and(lacks);
            if lacking && !self.findings.iter().any(told) {
                let found = format!("no \"{key}\"");
                let expected = format!("\"{key}\", as {what} needs it");
                self.fault(Finding::new(&pointer, found, expected).of_key());
            }
        }
    }

    fn case(&mut self, pointer: &str, name: &str) {
        let cases = &self.document.load_cases;
        if !cases.contains_key(name) && !self.damage.holds("load_cases", name) {
            let hint = advice(name, "load cases", cases.keys().map(String::as_str));
            let found = format!("\"{name}\"");
            self.fault(Finding::new(pointer, found, "the name of a load case").hint(hint));
        }
    }

    fn of_nodes(
        &mut self,
        pointer: &str,
        case: &str,
        nodes: &str,
        (key, along): (&str, &[f64; 3]),
    ) {
        self.case(&join(pointer, "case"), case);
        self.set(&join(pointer, "nodes"), nodes, Kind::Nodes);
        self.nonzero(&join(pointer, key), *along);
    }

    /// A function of structures.
    pub(super) fn static_function(&mut self, pointer: &str, function: &Function) {
        let at = |key: &str| join(pointer, key);
        match function {
            Function::Mass => self.densities("the mass"),
            Function::CentreOfMass(centre) => {
                self.densities("the centre of mass");
                self.nonzero(
                    &format!("{pointer}/centre_of_mass/direction"),
                    centre.direction,
                );
            }
            Function::MomentOfInertia(inertia) => {
                self.densities("the moment of inertia");
                self.nonzero(&format!("{pointer}/moment_of_inertia/axis"), inertia.axis);
            }
            Function::StrainEnergy(of) => {
                self.case(&format!("{pointer}/strain_energy/case"), &of.case);
            }
            Function::Compliance(of) => self.case(&format!("{pointer}/compliance/case"), &of.case),
            Function::Displacement(of) => {
                let along = ("direction", &of.direction);
                self.of_nodes(&at("displacement"), &of.case, &of.nodes, along);
            }
            Function::Reaction(of) => {
                let along = ("direction", &of.direction);
                self.of_nodes(&at("reaction"), &of.case, &of.nodes, along);
            }
            Function::ReactionMoment(of) => {
                let along = ("axis", &of.axis);
                self.of_nodes(&at("reaction_moment"), &of.case, &of.nodes, along);
            }
            Function::Misfit(misfit) => self.numbers(&at("misfit"), misfit),
            Function::VonMises(stress) => self.stress(&at("von_mises"), stress),
            Function::Frequency(own) => {
                if own.damped {
                    let found = "a damped frequency of structures";
                    let expected = "none: structures have no damping";
                    self.fault(Finding::new(at("frequency/damped"), found, expected).of_key());
                }
                self.densities("a frequency");
            }
            Function::LowestFrequency(_) => self.densities("a frequency"),
            // Their names are checked where they are read.
            Function::Expression(_) | Function::OverCases(_) => {}
            Function::Ks(_)
            | Function::InducedExponential(_)
            | Function::Integral(_)
            | Function::Final(_)
            | Function::Mean(_)
            | Function::MeanSquare(_)
            | Function::MeanAbsolute(_)
            | Function::FatigueDamage(_)
            | Function::Value(_)
            | Function::Clearance(_)
            | Function::DampingRatio(_)
            | Function::CriticalSpeed(_)
            | Function::Duration
            | Function::EventTime(_) => {
                let expected = "a function of structures, such as \"mass\", or a \"simulation\"";
                self.fault(Finding::new(pointer, "a function of a motion", expected));
            }
        }
    }

    /// Checks the measured values of functions of structures.
    fn numbers(&mut self, pointer: &str, misfit: &Misfit) {
        let place = join(pointer, "numbers");
        if !misfit.series.is_empty() {
            let expected = "\"numbers\", as structures do not move";
            let finding = Finding::new(join(pointer, "series"), "series over time", expected);
            self.fault(finding.of_key());
        } else if misfit.numbers.is_empty() {
            let expected = "at least one measured value of a function, under \"numbers\"";
            self.fault(Finding::new(pointer, "none", expected));
        }
        for (k, own) in misfit.numbers.iter().enumerate() {
            let place = join(&join(&place, k), "function");
            self.function_name(&place, &own.function);
            if let Some(Function::Misfit(_)) = self.document.functions.get(&own.function) {
                let found = format!("the misfit \"{}\"", own.function);
                self.fault(Finding::new(place, found, "a function that is no misfit"));
            }
        }
    }

    fn stress(&mut self, pointer: &str, stress: &Stress) {
        self.property("a stress", "yield_stress", |m| m.yield_stress.is_none());
        for (k, case) in stress.cases.iter().flatten().enumerate() {
            let place = join(&join(pointer, "cases"), k);
            self.case(&place, case);
            if stress
                .cases
                .iter()
                .flatten()
                .take(k)
                .any(|other| other == case)
            {
                let found = format!("\"{case}\" a second time");
                self.fault(Finding::new(place, found, "a load case once"));
            }
        }
        let none = match &stress.cases {
            Some(cases) => cases.is_empty(),
            None => self.document.load_cases.is_empty() && !self.damage.touches("load_cases"),
        };
        if none {
            let finding = Finding::new(pointer, "a stress of no load case", "one case at least");
            self.fault(finding.of_key());
        }
        let shells = self.document.structures.values();
        let shells = shells
            .filter(|structure| !structure.mesh.is_of_beams())
            .count();
        if stress.per.is_some() {
            let varied =
                |structure: &Structure| matches!(structure.thickness, Some(Thickness::Varied(_)));
            let several = self.document.structures.values().any(varied);
            let place = join(pointer, "per");
            if stress.elements.is_some() {
                let found = "a set of elements beside it";
                self.fault(Finding::new(place, found, "\"per\" or \"elements\"").of_key());
            } else if !several && !self.damage.touches("structures") {
                let found = "structures of one thickness each";
                let expected = "a thickness \"per\" element, band, patch or group";
                self.fault(Finding::new(place, found, expected).of_key());
            }
        }
        match &stress.elements {
            Some(set) => self.set(&join(pointer, "elements"), set, Kind::Faces),
            None if shells == 0 && !self.sets.unknown => {
                let expected = "shells, whose stresses these are";
                self.fault(Finding::new(pointer, "structures of beams alone", expected).of_key());
            }
            None => {}
        }
    }
}
