//! The elements of an MJCF, those of included files in their places.

use std::collections::HashSet;
use std::path::{Component, Path};

use nalgebra::Vector3;
use roxmltree::{Document, Node};

use super::super::RobotError;
use super::super::urdf::crowded;
use crate::files;

/// Files that one description may include.
const FILES: usize = 32;
/// Bytes of all included files together at most.
const BYTES: usize = 64 << 20;
/// Numbers beyond these are no robot's.
const LARGEST: f64 = 1e6;

/// One element.
pub(super) struct Element {
    /// Its name.
    pub tag: String,
    /// In the file's order.
    pub children: Vec<usize>,
    attributes: Vec<(String, String)>,
    /// Line of its file.
    pub line: u32,
    /// Index of the included file's name; 0 is the description itself.
    file: usize,
}

/// All elements; index 0 is the root.
pub(super) struct Source {
    elements: Vec<Element>,
    files: Vec<String>,
}

impl Source {
    /// Reads the text; included files are those of `folder`, none without one.
    pub fn read(text: &str, folder: Option<&Path>) -> Result<Self, RobotError> {
        let mut source = Self { elements: Vec::new(), files: vec![String::new()] };
        let (mut seen, mut bytes) = (HashSet::new(), 0);
        // Included texts are read before the elements behind them, so that all stand in their places.
        source.add(text, None, folder, &mut seen, &mut bytes)?;
        Ok(source)
    }

    fn add(
        &mut self,
        text: &str,
        into: Option<usize>,
        folder: Option<&Path>,
        seen: &mut HashSet<String>,
        bytes: &mut usize,
    ) -> Result<(), RobotError> {
        let file = self.files.len() - 1;
        crowded(text).map_err(|error| self.within(file, error))?;
        let document = Document::parse(text).map_err(|error| {
            let place = self.line(file, error.pos().row);
            RobotError::new(place, format!("not XML: {error}"), "expected an MJCF; MuJoCo's `simulate` finds the same")
        })?;
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
        let line = |node: Node| 1 + ends.partition_point(|end| *end < node.range().start) as u32;
        let root = document.root_element();
        // The root of an included file only holds what is included.
        let mut open: Vec<(Node, Option<usize>)> = match into {
            None => vec![(root, None)],
            Some(_) => root.children().filter(Node::is_element).map(|node| (node, into)).collect(),
        };
        open.reverse();
        while let Some((node, parent)) = open.pop() {
            let tag = node.tag_name().name();
            if tag == "include" {
                let place = self.line(file, line(node));
                let text = include(node.attribute("file"), folder, &place, seen, bytes)?;
                self.files.push(node.attribute("file").unwrap_or_default().to_owned());
                self.add(&text, parent, folder, seen, bytes)?;
                continue;
            }
            let at = self.elements.len();
            if let Some(parent) = parent {
                self.elements[parent].children.push(at);
            }
            let attributes = node.attributes().map(|one| (one.name().to_owned(), one.value().to_owned())).collect();
            let line = line(node);
            self.elements.push(Element { tag: tag.to_owned(), children: Vec::new(), attributes, line, file });
            let inner: Vec<Node> = node.children().filter(Node::is_element).collect();
            open.extend(inner.into_iter().rev().map(|node| (node, Some(at))));
        }
        Ok(())
    }

    /// An element.
    pub fn at(&self, element: usize) -> &Element {
        &self.elements[element]
    }

    /// An attribute.
    pub fn get(&self, element: usize, name: &str) -> Option<&str> {
        self.elements[element].attributes.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Children of the root with this name, in order: sections may be split.
    pub fn sections(&self, tag: &str) -> Vec<usize> {
        self.children(0, tag)
    }

    /// Children with this name.
    pub fn children(&self, element: usize, tag: &str) -> Vec<usize> {
        self.elements[element].children.iter().copied().filter(|child| self.elements[*child].tag == tag).collect()
    }

    /// Where an element is, for messages.
    pub fn place(&self, element: usize) -> String {
        let Element { tag, line, file, .. } = &self.elements[element];
        let place = self.line(*file, *line);
        match self.get(element, "name") {
            Some(name) if ["joint", "body"].contains(&tag.as_str()) => format!("{place}, {tag} '{name}'"),
            _ => format!("{place}, <{tag}>"),
        }
    }

    /// Numbers of an attribute.
    pub fn numbers(&self, element: usize, name: &str) -> Result<Option<Vec<f64>>, RobotError> {
        let Some(text) = self.get(element, name) else { return Ok(None) };
        let all: Option<Vec<f64>> = text.split_whitespace().map(|x| x.parse().ok()).collect();
        match all.filter(|all| all.iter().all(|x| x.abs() < LARGEST)) {
            Some(all) => Ok(Some(all)),
            None => Err(RobotError::new(
                self.place(element),
                format!("{name}=\"{text}\": expected numbers below a million"),
                "as in \"0 0 1\": metres, and degrees unless <compiler angle=\"radian\"/>",
            )),
        }
    }

    /// So many numbers of an attribute.
    pub fn exactly<const N: usize>(&self, element: usize, name: &str) -> Result<Option<[f64; N]>, RobotError> {
        let Some(all) = self.numbers(element, name)? else { return Ok(None) };
        let found = all.len();
        match <[f64; N]>::try_from(all) {
            Ok(all) => Ok(Some(all)),
            Err(_) => Err(RobotError::new(
                self.place(element),
                format!("{name}=\"{}\": found {found} numbers, expected {N}", self.get(element, name).unwrap_or("")),
                "add or remove numbers",
            )),
        }
    }

    /// A vector; zero where there is none.
    pub fn vector(&self, element: usize, name: &str) -> Result<Vector3<f64>, RobotError> {
        Ok(self.exactly::<3>(element, name)?.map(Vector3::from).unwrap_or_default())
    }

    fn line(&self, file: usize, line: u32) -> String {
        match self.files[file].as_str() {
            "" => format!("line {line}"),
            name => format!("{name}, line {line}"),
        }
    }

    fn within(&self, file: usize, mut error: RobotError) -> RobotError {
        if !self.files[file].is_empty() {
            error.place = format!("{}, {}", self.files[file], error.place);
        }
        error
    }
}

/// The text of an included file. It lies beside the description or below: a description names no file elsewhere.
fn include(
    name: Option<&str>,
    folder: Option<&Path>,
    place: &str,
    seen: &mut HashSet<String>,
    bytes: &mut usize,
) -> Result<String, RobotError> {
    let refuse = |what: String, help: &str| Err(RobotError::new(place, what, help));
    let Some(name) = name.filter(|name| !name.is_empty()) else {
        return refuse("found an <include> without a file, expected file=\"...\"".into(), "name it");
    };
    let whole = "write one file: python -c \"import mujoco; m = mujoco.MjModel.from_xml_path('robot.xml'); \
                 mujoco.mj_saveLastXML('whole.xml', m)\"";
    let Some(folder) = folder else {
        return refuse(format!("it includes '{name}', and this text has no folder"), whole);
    };
    if !Path::new(name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return refuse(format!("it includes '{name}', expected a file beside this one or in a folder below"), whole);
    }
    if !seen.insert(name.to_owned()) {
        return refuse(format!("it includes '{name}' twice, expected once"), "leave one of the two out");
    }
    if seen.len() > FILES {
        return refuse(format!("it includes more than {FILES} files"), whole);
    }
    match files::read_text(&folder.join(name)) {
        Ok(text) if *bytes + text.len() <= BYTES => {
            *bytes += text.len();
            Ok(text)
        }
        Ok(_) => refuse(format!("the included files have more than {} MiB", BYTES >> 20), whole),
        Err(error) => {
            let path = folder.join(name);
            let what = format!("it includes '{name}', which cannot be read: {error}");
            refuse(what, &format!("expected it at {}: copy it there, or remove the <include>", path.display()))
        }
    }
}
