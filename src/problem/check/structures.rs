//! Structures: their meshes, properties and supports.

use super::Checker;
use super::sets::{Kind, Sets};
use crate::finding::Finding;
use crate::math::Mat3;
use crate::pointer::{advice, join};
use crate::quantity::Quantity;
use crate::schema::structures::{Mesh, Per, Structure, Thickness, VariedSection, VariedThickness};
use crate::statics::expand::{section_count, thickness_count};
use crate::statics::mesh::{element_count, part};

/// Largest number of elements of a structure.
const MOST_ELEMENTS: usize = 200_000;

impl Checker<'_> {
    /// Whether the document has structures and no motion.
    pub(super) fn is_static(&self) -> bool {
        self.document.simulation.is_none()
    }

    pub(super) fn structures(&mut self) {
        let document = self.document;
        self.names("structures", document.structures.keys());
        if document.structures.len() > 1 {
            for name in document.structures.keys().filter(|name| name.contains('.')) {
                let found = format!("the name \"{name}\"");
                let expected = "a name without a dot, which separates a structure from its sets";
                self.fault(Finding::new(join("/structures", name), found, expected).of_key());
            }
        }
        self.names("materials", document.materials.keys());
        self.names("load_cases", document.load_cases.keys());
        if !self.is_static() {
            let used = [
                ("structures", !document.structures.is_empty()),
                ("load_cases", !document.load_cases.is_empty()),
                ("statics", document.statics.is_some()),
            ];
            for (key, _) in used.iter().filter(|(_, used)| *used) {
                let found = format!("\"{key}\" beside a motion");
                let expected = "structures without \"simulation\", as they do not move";
                self.fault(Finding::new(join("", key), found, expected).of_key());
            }
            return;
        }
        let moving = [
            ("bodies", !document.bodies.is_empty()),
            ("joints", !document.joints.is_empty()),
            ("loads", !document.loads.is_empty()),
            ("drives", !document.drives.is_empty()),
            ("couplings", !document.couplings.is_empty()),
        ];
        for (key, _) in moving.iter().filter(|(_, used)| *used) {
            let found = format!("\"{key}\" beside structures without a motion");
            let hint =
                (*key == "loads").then(|| "loads of structures are in \"load_cases\"".into());
            let finding = Finding::new(join("", key), found, "structures alone").hint(hint);
            self.fault(finding.of_key());
        }
        if document.structures.is_empty() && !self.damage.touches("structures") {
            let finding = Finding::new("/structures", "no structure", "one at least");
            self.fault(finding.of_key());
        }
        self.sets.unknown = self.damage.touches("structures");
        for (name, structure) in &document.structures {
            self.structure(name, structure);
        }
        for (case, loads) in &document.load_cases {
            let pointer = join("/load_cases", case);
            if loads.is_empty() {
                let finding = Finding::new(&pointer, "no load", "one load at least");
                self.fault(finding.of_key());
            }
            for (name, load) in loads {
                self.case_load(&join(&pointer, name), load);
            }
        }
    }

    fn structure(&mut self, name: &str, structure: &Structure) {
        let pointer = join("/structures", name);
        if structure.damping.is_some() {
            let found = "\"damping\" of a structure that does not move";
            let expected =
                "no damping: load cases are static, and frequencies those without damping";
            self.fault(Finding::new(join(&pointer, "damping"), found, expected).of_key());
        }
        self.structure_at(pointer, name, structure);
    }

    /// Checks the name of a material that is written at `place`.
    pub(super) fn material(&mut self, place: &str, name: &str) {
        let materials = &self.document.materials;
        if materials.contains_key(name) || self.damage.holds("materials", name) {
            return;
        }
        let hint = advice(name, "materials", materials.keys().map(String::as_str));
        let found = format!("\"{name}\"");
        self.fault(Finding::new(place, found, "the name of a material").hint(hint));
    }

    /// Checks a structure that is written at `pointer`.
    pub(super) fn structure_at(&mut self, pointer: String, name: &str, structure: &Structure) {
        let before = self.findings.len();
        self.material(&join(&pointer, "material"), &structure.material);
        if structure.mesh.is_unread() {
            self.sets.unknown = true;
            return;
        }
        self.mesh(&join(&pointer, "mesh"), &structure.mesh);
        self.properties(&pointer, structure);
        for (set, written) in &structure.sets {
            let place = join(&join(&pointer, "sets"), set);
            if matches!(structure.mesh, Mesh::Gmsh(_)) {
                let found = "a set by its place in a mesh without directions x and y";
                let hint = Some("a physical group of the file of the mesh is a set".to_owned());
                let finding = Finding::new(place, found, "no such set").hint(hint);
                self.fault(finding.of_key());
                continue;
            }
            self.written_set(&place, written);
        }
        if self.findings.len() > before {
            self.sets.unknown = true;
            return;
        }
        self.names_of_sets(&pointer, structure);
        let part = part::<f64>(structure, &[], 1);
        self.empty_sets(&pointer, structure, &part.mesh);
        let several = self.document.structures.len() > 1;
        let named = |set: &String| match several {
            true => format!("{name}.{set}"),
            false => set.clone(),
        };
        let own = Sets {
            nodes: part.mesh.node_sets.keys().cloned().collect(),
            edges: part.mesh.edge_sets.keys().cloned().collect(),
            faces: part.mesh.face_sets.keys().cloned().collect(),
            beams: part.mesh.beam_sets.keys().cloned().collect(),
            unknown: false,
        };
        self.sets.nodes.extend(own.nodes.iter().map(named));
        self.sets.edges.extend(own.edges.iter().map(named));
        self.sets.faces.extend(own.faces.iter().map(named));
        self.sets.beams.extend(own.beams.iter().map(named));
        if let (true, false) = (several, structure.mesh.is_of_beams()) {
            self.sets.faces.insert("all".into());
        } else if several {
            self.sets.beams.insert("all".into());
        }
        self.groups(
            &pointer,
            structure,
            &part.mesh.face_sets,
            &part.mesh.beam_sets,
        );
        for (support, written) in &structure.supports {
            let list = join(&join(&join(&pointer, "supports"), support), "nodes");
            if written.nodes.all.is_empty() {
                self.fault(Finding::new(
                    &list,
                    "an empty list",
                    "one set of nodes at least",
                ));
            }
            for (k, set) in written.nodes.all.iter().enumerate() {
                let place = match written.nodes.is_list {
                    true => join(&list, k),
                    false => list.clone(),
                };
                self.set_among(&place, set, Kind::Nodes, &own);
            }
            if written.held.as_ref().is_some_and(Vec::is_empty) {
                let place = join(&join(&join(&pointer, "supports"), support), "held");
                let expected = "x, y, z, rx, ry, rz, or no \"held\" for all of them";
                self.fault(Finding::new(place, "an empty list", expected));
            }
        }
        for (mass, written) in &structure.masses {
            let place = join(&join(&pointer, "masses"), mass);
            self.set_among(&join(&place, "nodes"), &written.nodes, Kind::Nodes, &own);
            if let Some(inertia) = &written.inertia {
                let [xx, yy, zz, xy, yz, zx] = inertia.map(|q| q.value);
                let inertia = Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
                self.inertia(&join(&place, "inertia"), &inertia, 0.0);
            }
        }
    }

    fn mesh(&mut self, pointer: &str, mesh: &Mesh) {
        if element_count(mesh) > MOST_ELEMENTS {
            let found = format!("{} elements", element_count(mesh));
            let expected = format!("at most {MOST_ELEMENTS}");
            self.fault(Finding::new(pointer, found, expected));
        }
        match mesh {
            Mesh::Panel { points, .. } if points.len() != 4 && points.len() != 9 => {
                let found = format!("{} points", points.len());
                let expected = "4 corners, or 9 points, row by row along x";
                self.fault(Finding::new(
                    format!("{pointer}/panel/points"),
                    found,
                    expected,
                ));
            }
            Mesh::Cylinder { elements, .. } if elements[0] < 3 => {
                let found = format!("{} elements around", elements[0]);
                let place = format!("{pointer}/cylinder/elements/0");
                self.fault(Finding::new(place, found, "at least 3"));
            }
            Mesh::CurvedPanel { angles, .. } => {
                self.arc(&format!("{pointer}/curved_panel/angles"), angles);
            }
            Mesh::CurvedBeam { angles, .. } => {
                self.arc(&format!("{pointer}/curved_beam/angles"), angles);
            }
            Mesh::Frame { points, members } => {
                if members.is_empty() {
                    let place = format!("{pointer}/frame/members");
                    self.fault(Finding::new(place, "no member", "one at least"));
                }
                for (name, member) in members {
                    let place = join(&join(&format!("{pointer}/frame/members"), name), "between");
                    for (k, point) in member.between.iter().enumerate() {
                        if !points.contains_key(point) {
                            let hint = advice(point, "points", points.keys().map(String::as_str));
                            let found = format!("\"{point}\"");
                            let expected = "the name of a point of the frame";
                            self.fault(Finding::new(join(&place, k), found, expected).hint(hint));
                        }
                    }
                    if member.between[0] == member.between[1] {
                        let found = format!("\"{}\" twice", member.between[0]);
                        self.fault(Finding::new(&place, found, "two different points"));
                    }
                }
            }
            Mesh::Gmsh(gmsh) => {
                let beams = mesh.is_of_beams();
                let found = match gmsh.orientation {
                    None if beams => "no \"orientation\" of beams",
                    Some(_) if !beams => "\"orientation\" of a mesh of shells",
                    _ => return,
                };
                let expected = match beams {
                    true => "a vector in the plane of each beam and axis 2 of its section",
                    false => "no such key, as only beams have one",
                };
                self.fault(Finding::new(format!("{pointer}/gmsh"), found, expected).of_key());
            }
            Mesh::Plate { .. }
            | Mesh::Panel { .. }
            | Mesh::Cylinder { .. }
            | Mesh::StraightBeam { .. } => {}
        }
    }

    /// An arc does not lie on itself.
    fn arc(&mut self, pointer: &str, angles: &[Quantity; 2]) {
        let turn = (angles[1].value - angles[0].value).abs();
        if turn > 2.0 * std::f64::consts::PI * (1.0 + 1e-12) {
            let found = format!("an arc of {turn} rad");
            self.fault(Finding::new(pointer, found, "at most a whole turn, 2π rad"));
        }
    }

    fn properties(&mut self, pointer: &str, structure: &Structure) {
        let beams = structure.mesh.is_of_beams();
        let there = [
            ("thickness", structure.thickness.is_some(), false),
            ("surface_mass", structure.surface_mass.is_some(), false),
            ("section", structure.section.is_some(), true),
            ("sections", structure.sections.is_some(), true),
            ("line_mass", structure.line_mass.is_some(), true),
            ("offset", structure.offset.is_some(), true),
        ];
        if let (true, Some(_)) = (beams, structure.element) {
            let found = "\"element\" of a mesh of beams";
            let expected = "no such key, as only shells have one";
            self.fault(Finding::new(join(pointer, "element"), found, expected).of_key());
        }
        for (key, _, _) in there.iter().filter(|(_, there, of)| *there && *of != beams) {
            let (found, expected) = match beams {
                true => (format!("\"{key}\" of a mesh of beams"), "a \"section\""),
                false => (format!("\"{key}\" of a mesh of shells"), "a \"thickness\""),
            };
            self.fault(Finding::new(join(pointer, key), found, expected).of_key());
        }
        if !beams && structure.thickness.is_none() {
            let expected = "a thickness of the shells";
            self.fault(Finding::new(pointer, "no \"thickness\"", expected).of_key());
        }
        match (&structure.section, &structure.sections) {
            (None, None) if beams => {
                let expected = "a cross section of the beams";
                self.fault(Finding::new(pointer, "no \"section\"", expected).of_key());
            }
            (Some(_), Some(_)) => {
                let place = join(pointer, "sections");
                let found = "\"sections\" beside \"section\"";
                self.fault(Finding::new(place, found, "one of them").of_key());
            }
            _ => {}
        }
        if let Some(Thickness::Varied(varied)) = &structure.thickness {
            self.varied_thickness(&join(pointer, "thickness"), structure, varied);
        }
        if let Some(section) = &structure.section {
            self.sizes(&join(pointer, "section"), section);
        }
        if let Some(varied) = &structure.sections {
            let pointer = join(pointer, "sections");
            self.varied_section(&pointer, structure, varied);
            if let Some(section) = &varied.value {
                self.sizes(&join(&pointer, "value"), section);
            }
            for (k, section) in varied.values.iter().flatten().enumerate() {
                self.sizes(&join(&join(&pointer, "values"), k), section);
            }
        }
    }

    fn varied_thickness(&mut self, pointer: &str, structure: &Structure, of: &VariedThickness) {
        let keys = [
            ("along", of.along.is_some(), Per::Band),
            ("bands", of.bands.is_some(), Per::Band),
            ("patches", of.patches.is_some(), Per::Patch),
            ("groups", of.groups.is_some(), Per::Group),
        ];
        for (key, there, per) in keys {
            if there && per != of.per {
                let found = format!("\"{key}\" with another \"per\"");
                let finding = Finding::new(join(pointer, key), found, "no such key here");
                self.fault(finding.of_key());
            }
            if !there && per == of.per && ["patches", "groups"].contains(&key) {
                let found = format!("no \"{key}\"");
                let expected = format!("\"{key}\", as \"per\" asks for them");
                self.fault(Finding::new(pointer, found, expected).of_key());
            }
        }
        if let (Mesh::Gmsh(_), Per::Band | Per::Patch) = (&structure.mesh, of.per) {
            let found = "bands or patches of a mesh without directions x and y";
            let place = join(pointer, "per");
            self.fault(Finding::new(place, found, "\"element\" or \"group\""));
            return;
        }
        if let Some([nx, ny]) = structure.mesh.panel_elements() {
            let [px, py] = of.patches.unwrap_or([1, 1]);
            if !nx.is_multiple_of(px) || !ny.is_multiple_of(py) {
                let found = format!("{px} × {py} patches of {nx} × {ny} elements");
                let expected = "numbers that divide those of the elements";
                self.fault(Finding::new(join(pointer, "patches"), found, expected));
            }
            if let Some(bands) = of.bands {
                let count = match of.along {
                    Some(crate::schema::structures::Direction::X) => nx,
                    _ => ny,
                };
                if !count.is_multiple_of(bands) {
                    let found = format!("{bands} bands of {count} elements");
                    let expected = "a number that divides that of the elements";
                    self.fault(Finding::new(join(pointer, "bands"), found, expected));
                }
            }
        }
        let count = thickness_count(structure, of);
        self.values(
            pointer,
            of.value.is_some(),
            of.values.as_ref().map(Vec::len),
            count,
        );
    }

    fn varied_section(&mut self, pointer: &str, structure: &Structure, of: &VariedSection) {
        match (of.per, &of.groups) {
            (Per::Group, None) => {
                let expected = "\"groups\", as \"per\" asks for them";
                self.fault(Finding::new(pointer, "no \"groups\"", expected).of_key());
            }
            (Per::Element, Some(_)) => {
                let place = join(pointer, "groups");
                let found = "\"groups\" with another \"per\"";
                self.fault(Finding::new(place, found, "no such key here").of_key());
            }
            (Per::Band | Per::Patch, _) => {
                let place = join(pointer, "per");
                let found = "a band or patch of beams";
                self.fault(Finding::new(place, found, "\"element\" or \"group\""));
            }
            (Per::Group, Some(_)) | (Per::Element, None) => {}
        }
        let count = section_count(structure);
        self.values(
            pointer,
            of.value.is_some(),
            of.values.as_ref().map(Vec::len),
            count,
        );
    }

    /// One value, or as many as are needed.
    fn values(&mut self, pointer: &str, value: bool, values: Option<usize>, count: usize) {
        match (value, values) {
            (true, None) => {}
            (false, Some(found)) if found == count => {}
            (false, Some(found)) => {
                let (found, expected) = (format!("{found} values"), format!("{count} values"));
                self.fault(Finding::new(join(pointer, "values"), found, expected));
            }
            (true, Some(_)) => {
                let expected = "\"value\" or \"values\"";
                self.fault(
                    Finding::new(pointer, "both \"value\" and \"values\"", expected).of_key(),
                );
            }
            (false, None) => {
                let found = "neither \"value\" nor \"values\"";
                self.fault(Finding::new(pointer, found, "one of them").of_key());
            }
        }
    }
}
