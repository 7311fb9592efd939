//! The texts of Gmsh's mesh files: MSH 2.2 and 4.1 in ASCII, as the reference manual of Gmsh describes them
//! (file formats, MSH file format).

use super::data_text::{TextFault, Word, bytes, lines, number, quoted, whole, words};
use crate::math::Vec3;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// How to write what is read here.
const SAVE: &str = "gmsh -2 -order 2 -format msh41 writes such a file";

/// Gmsh's numbers of the kinds of elements that are read, and how many nodes they have.
const READ: [(u64, usize); 6] = [(1, 2), (3, 4), (8, 3), (10, 9), (15, 1), (16, 8)];
/// Names of the commonest others.
const OTHERS: [(u64, &str); 4] = [
    (2, "three-node triangle"),
    (9, "six-node triangle"),
    (4, "tetrahedron"),
    (5, "hexahedron"),
];

/// A physical group: its dimension and its number.
pub(super) type Group = (usize, u64);

/// An element: a point, a line or a quadrangle.
#[derive(Clone, Debug)]
pub(super) struct Element {
    /// Its number in the file.
    pub number: u64,
    /// The physical groups that it belongs to.
    pub groups: Vec<Group>,
    /// Indices of its nodes in the order of Gmsh.
    pub nodes: Vec<usize>,
    /// Its line in the file.
    pub at: Range<usize>,
}

impl Element {
    /// Its dimension, 0 to 2.
    pub(super) fn dimension(&self) -> usize {
        match self.nodes.len() {
            1 => 0,
            2 | 3 => 1,
            _ => 2,
        }
    }
}

/// A mesh as it is written.
#[derive(Clone, Debug, Default)]
pub(super) struct Msh {
    /// Places of the nodes, in the unit of the file.
    pub places: Vec<Vec3<f64>>,
    /// The elements.
    pub elements: Vec<Element>,
    /// Names of physical groups, and where they stand.
    pub names: BTreeMap<Group, (String, Range<usize>)>,
}

/// Whether the header of a file announces numbers that are not text.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(100)]).into_owned();
    let line = head.lines().nth(1).unwrap_or("");
    head.starts_with("$MeshFormat") && line.split_whitespace().nth(1) == Some("1")
}

/// Reads a file.
pub(super) fn read(text: &str) -> Result<Msh, TextFault> {
    let mut reader = Reader {
        lines: Box::new(lines(text)),
        last: 0..text.len().min(1),
        index: HashMap::new(),
        entities: HashMap::new(),
        msh: Msh::default(),
    };
    reader.file()?;
    Ok(reader.msh)
}

struct Reader<'a> {
    lines: Box<dyn Iterator<Item = (usize, &'a str)> + 'a>,
    /// The last line that was read.
    last: Range<usize>,
    /// Index of each node by its number.
    index: HashMap<u64, usize>,
    /// Physical groups of the entities, by dimension and number; whether they turn its elements over.
    entities: HashMap<(usize, u64), (Vec<Group>, bool)>,
    msh: Msh,
}

impl<'a> Reader<'a> {
    /// The next line that is not empty.
    fn line(&mut self) -> Option<(usize, &'a str)> {
        let (start, line) = self.lines.find(|(_, line)| !line.trim().is_empty())?;
        self.last = start..start + line.len();
        Some((start, line))
    }

    fn fault(&self, found: impl Into<String>, expected: impl Into<String>) -> TextFault {
        TextFault::new(self.last.clone(), found, expected)
    }

    /// The words of the next line, at least `least` of them.
    fn words(&mut self, least: usize, expected: &str) -> Result<Vec<Word<'a>>, TextFault> {
        let Some((start, line)) = self.line() else {
            return Err(self.fault("the end of the file", expected));
        };
        let all: Vec<Word> = words(start, line, ' ').collect();
        match all.len() < least {
            true => Err(self.fault(quoted(line.trim()), expected)),
            false => Ok(all),
        }
    }

    /// Refuses the words of a line from number `most` on.
    fn at_most(&self, all: &[Word], most: usize) -> Result<(), TextFault> {
        all.get(most).map_or(Ok(()), |more| {
            let expected = format!("the end of the line after {most} numbers");
            Err(TextFault::new(bytes(more), quoted(more.1), expected))
        })
    }

    fn file(&mut self) -> Result<(), TextFault> {
        let first = self.line().map(|(_, line)| line.trim());
        if first != Some("$MeshFormat") {
            let found = first.map_or("an empty file".to_owned(), quoted);
            return Err(self
                .fault(found, "$MeshFormat, with which a mesh of Gmsh begins")
                .hint(SAVE));
        }
        let expected = "the version, 0 for ASCII, and the size of numbers: 4.1 0 8";
        let format = self.words(3, expected)?;
        let is_4 = match format[0].1 {
            "2" | "2.1" | "2.2" => false,
            "4.1" => true,
            other => {
                let found = format!("MSH version {}", quoted(other));
                let fault = TextFault::new(bytes(&format[0]), found, "version 2.2 or 4.1");
                return Err(fault.hint(SAVE));
            }
        };
        if format[1].1 != "0" {
            let fault = TextFault::new(bytes(&format[1]), quoted(format[1].1), "0, for ASCII");
            return Err(fault.hint("save with Mesh.Binary = 0"));
        }
        self.end("$EndMeshFormat")?;
        let mut seen = [false; 2];
        while let Some((_, line)) = self.line() {
            let section = line.trim();
            match (section, is_4) {
                ("$PhysicalNames", _) => self.names()?,
                ("$Entities", true) => self.entities()?,
                ("$Nodes", true) => self.nodes_4()?,
                ("$Nodes", false) => self.nodes_2()?,
                ("$Elements", true) => self.elements_4()?,
                ("$Elements", false) => self.elements_2()?,
                ("$PartitionedEntities", _) => {
                    let fault = self.fault("a partitioned mesh", "a mesh of one partition");
                    return Err(fault.hint("save without partitions"));
                }
                (other, _) if other.starts_with('$') => {
                    let end = format!("$End{}", &other[1..]);
                    let found = format!("no {end}");
                    let begin = self.last.clone();
                    if !self.lines.any(|(_, line)| line.trim() == end) {
                        return Err(TextFault::new(begin, found, "an end of every section"));
                    }
                    continue;
                }
                (other, _) => return Err(self.fault(quoted(other), "a section such as $Nodes")),
            }
            seen[0] |= section == "$Nodes";
            seen[1] |= section == "$Elements";
            self.end(&format!("$End{}", &section[1..]))?;
        }
        match seen {
            [true, true] => Ok(()),
            [false, _] => Err(self.fault("the end of the file", "a section $Nodes")),
            [_, false] => Err(self.fault("the end of the file", "a section $Elements")),
        }
    }

    fn end(&mut self, end: &str) -> Result<(), TextFault> {
        match self.line() {
            Some((_, line)) if line.trim() == end => Ok(()),
            Some((_, line)) => Err(self.fault(quoted(line.trim()), end)),
            None => Err(self.fault("the end of the file", end)),
        }
    }

    fn names(&mut self) -> Result<(), TextFault> {
        for _ in 0..self.count("the number of names")? {
            let expected = "dimension, number and name in quotes: 1 2 \"edge\"";
            let all = self.words(3, expected)?;
            let number = whole(&all[1], 1, "the number of a group")?;
            let group = (dimension(&all[0])?, number);
            // A name may have spaces.
            let words: Vec<&str> = all[2..].iter().map(|word| word.1).collect();
            let word = words.join(" ");
            let at = all[2].0..self.last.end;
            let name = word.strip_prefix('"').and_then(|own| own.strip_suffix('"'));
            let Some(name) = name.filter(|name| !name.is_empty()) else {
                return Err(TextFault::new(at, quoted(&word), expected));
            };
            let named = (name.to_owned(), at.clone());
            if self.msh.names.insert(group, named).is_some() {
                let found = format!("a second name of group {} {number}", group.0);
                return Err(TextFault::new(at, found, "one name of a group"));
            }
        }
        Ok(())
    }

    fn count(&mut self, what: &str) -> Result<u64, TextFault> {
        let all = self.words(1, what)?;
        whole(&all[0], 0, what)
    }

    /// The physical groups of the entities, MSH 4.1. A negative number turns its elements over.
    fn entities(&mut self) -> Result<(), TextFault> {
        let counts = self.words(4, "the numbers of points, curves, surfaces and volumes")?;
        for (dimension, count) in counts[..4].iter().enumerate() {
            for _ in 0..whole(count, 0, "a number of entities")? {
                // A point has its place, others have a box.
                let before = if dimension == 0 { 4 } else { 7 };
                let expected = "number, place or box, and physical groups of an entity";
                let all = self.words(before + 1, expected)?;
                let number = whole(&all[0], 0, "the number of an entity")?;
                let groups = whole(&all[before], 0, "the number of physical groups")? as usize;
                let Some(groups) = all.get(before + 1..before + 1 + groups) else {
                    return Err(self.fault("fewer physical groups than announced", expected));
                };
                let mut turned = false;
                let mut own = Vec::new();
                for word in groups {
                    let (at, text) = *word;
                    let plain = text.strip_prefix('-').unwrap_or(text);
                    turned |= plain.len() < text.len();
                    let number = whole(&(at, plain), 1, "the number of a physical group")?;
                    own.push((dimension, number));
                }
                self.entities.insert((dimension, number), (own, turned));
            }
        }
        Ok(())
    }

    fn node(&mut self, number: &Word, place: &[Word]) -> Result<(), TextFault> {
        let id = whole(number, 1, "the number of a node, 1 or more")?;
        let place = Vec3::new(
            self::number(&place[0])?,
            self::number(&place[1])?,
            self::number(&place[2])?,
        );
        if self.index.insert(id, self.msh.places.len()).is_some() {
            let found = format!("node {id} a second time");
            return Err(TextFault::new(bytes(number), found, "each node once"));
        }
        self.msh.places.push(place);
        Ok(())
    }

    fn nodes_2(&mut self) -> Result<(), TextFault> {
        for _ in 0..self.count("the number of nodes")? {
            let all = self.words(4, "a node: its number, x, y, z")?;
            self.at_most(&all, 4)?;
            self.node(&all[0], &all[1..])?;
        }
        Ok(())
    }

    fn nodes_4(&mut self) -> Result<(), TextFault> {
        let head = self.words(
            4,
            "the numbers of blocks and nodes, the least and largest number",
        )?;
        for _ in 0..whole(&head[0], 0, "the number of blocks")? {
            let expected = "dimension, entity, parametric or not, and number of nodes of a block";
            let block = self.words(4, expected)?;
            // Parameters on its curve or surface follow the place of a node.
            let most = match block[2].1 {
                "0" => 3,
                _ => 6,
            };
            let mut numbers = Vec::new();
            for _ in 0..whole(&block[3], 0, "the number of nodes of a block")? {
                numbers.push(self.words(1, "the number of a node")?[0]);
            }
            for number in &numbers {
                let place = self.words(3, "x, y, z of a node")?;
                self.at_most(&place, most)?;
                self.node(number, &place)?;
            }
        }
        Ok(())
    }

    fn elements_2(&mut self) -> Result<(), TextFault> {
        for _ in 0..self.count("the number of elements")? {
            let expected = "number, kind, number of tags, tags and nodes of an element";
            let all = self.words(4, expected)?;
            let tags = whole(&all[2], 0, "the number of tags")? as usize;
            let Some((tags, nodes)) = all
                .get(3..)
                .filter(|rest| rest.len() > tags)
                .map(|rest| rest.split_at(tags))
            else {
                return Err(self.fault("fewer words than announced", expected));
            };
            let group = match tags.first() {
                Some(tag) => whole(tag, 0, "the number of a physical group")?,
                None => 0,
            };
            let groups = |dimension| match group {
                0 => Vec::new(),
                group => vec![(dimension, group)],
            };
            self.element(&all[0], &all[1], nodes, groups, false)?;
        }
        Ok(())
    }

    fn elements_4(&mut self) -> Result<(), TextFault> {
        let expected = "the numbers of blocks and elements, the least and largest number";
        let head = self.words(4, expected)?;
        for _ in 0..whole(&head[0], 0, "the number of blocks")? {
            let expected = "dimension, entity, kind and number of elements of a block";
            let block = self.words(4, expected)?;
            let entity = whole(&block[1], 0, "the number of an entity")?;
            let entity = (dimension(&block[0])?, entity);
            let (groups, turned) = self.entities.get(&entity).cloned().unwrap_or_default();
            for _ in 0..whole(&block[3], 0, "the number of elements of a block")? {
                let all = self.words(2, "number and nodes of an element")?;
                let groups = |_| groups.clone();
                self.element(&all[0], &block[2], &all[1..], groups, turned)?;
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        number: &Word,
        kind: &Word,
        nodes: &[Word],
        groups: impl Fn(usize) -> Vec<Group>,
        turned: bool,
    ) -> Result<(), TextFault> {
        let number = whole(number, 1, "the number of an element, 1 or more")?;
        let id = whole(kind, 1, "the kind of an element")?;
        let Some(&(_, count)) = READ.iter().find(|(known, _)| *known == id) else {
            let name = OTHERS.iter().find(|(known, _)| *known == id);
            let name = name.map_or(format!("kind {id}"), |(_, name)| (*name).to_owned());
            let expected =
                "points, lines of two or three nodes, quadrangles of four, eight or nine";
            let hint = match id {
                2 | 9 => {
                    "Mesh.RecombineAll = 1 and Mesh.SubdivisionAlgorithm = 1 give quadrangles alone"
                }
                _ => "save the surfaces alone: gmsh -2",
            };
            let fault = self.fault(format!("a {name}, element {number}"), expected);
            return Err(fault.hint(hint));
        };
        if nodes.len() != count {
            let found = format!("{} nodes of element {number}", nodes.len());
            let expected = format!("{count} nodes, as its kind is {id}");
            return Err(self.fault(found, expected));
        }
        let mut own = Vec::with_capacity(count);
        for word in nodes {
            let id = whole(word, 1, "the number of a node")?;
            let Some(&index) = self.index.get(&id) else {
                let found = format!("node {id}");
                return Err(TextFault::new(
                    bytes(word),
                    found,
                    "a node of the section $Nodes",
                ));
            };
            if own.contains(&index) {
                let found = format!("node {id} twice in element {number}");
                return Err(TextFault::new(bytes(word), found, "different nodes"));
            }
            own.push(index);
        }
        if turned {
            turn_over(&mut own);
        }
        let mut element = Element {
            number,
            groups: Vec::new(),
            nodes: own,
            at: self.last.clone(),
        };
        element.groups = groups(element.dimension());
        self.msh.elements.push(element);
        Ok(())
    }
}

/// Lists the nodes of a quadrangle the other way round, so that its normal points to its other side; of a line, from
/// its other end.
pub(super) fn turn_over(nodes: &mut [usize]) {
    match nodes.len() {
        2 | 3 => nodes.swap(0, 1),
        4 => nodes.swap(1, 3),
        8 | 9 => {
            nodes.swap(1, 3);
            // The middle nodes of the edges 0-1, 1-2, 2-3, 3-0.
            nodes[4..8].reverse();
        }
        _ => {}
    }
}

fn dimension(word: &Word) -> Result<usize, TextFault> {
    let expected = "a dimension from 0 to 3";
    match whole(word, 0, expected)? {
        k @ 0..=3 => Ok(k as usize),
        _ => Err(TextFault::new(bytes(word), quoted(word.1), expected)),
    }
}
