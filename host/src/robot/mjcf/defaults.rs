//! Classes: what `<default>` says where an element says nothing.

use std::collections::HashMap;

use super::super::RobotError;
use super::source::Source;

/// Name of the class of everything without one.
const MAIN: &str = "main";

/// By class: which element of a `<default>` says each attribute.
pub(super) struct Defaults {
    attributes: &'static [&'static str],
    classes: HashMap<String, Vec<Option<usize>>>,
}

impl Defaults {
    /// Reads what all `<default>` elements say of the elements `tag`, the outer ones first: inner ones inherit.
    pub fn read(source: &Source, tag: &str, attributes: &'static [&'static str]) -> Result<Self, RobotError> {
        let nothing = vec![None; attributes.len()];
        let mut classes = HashMap::from([(MAIN.to_owned(), nothing.clone())]);
        let mut open: Vec<(usize, Option<String>)> = Vec::new();
        open.extend(source.sections("default").into_iter().rev().map(|at| (at, None)));
        while let Some((at, outer)) = open.pop() {
            let name = match (source.get(at, "class"), &outer) {
                (Some(name), _) => name.to_owned(),
                (None, None) => MAIN.to_owned(),
                (None, Some(_)) => {
                    let what = "found a <default> without a class inside another one, expected class=\"...\"";
                    return Err(RobotError::new(source.place(at), what, "name it"));
                }
            };
            let mut known = match &outer {
                None => classes.get(&name).cloned().unwrap_or_else(|| nothing.clone()),
                Some(outer) => classes.get(outer).cloned().unwrap_or_else(|| nothing.clone()),
            };
            for element in source.children(at, tag) {
                for (value, attribute) in known.iter_mut().zip(attributes) {
                    if source.get(element, attribute).is_some() {
                        *value = Some(element);
                    }
                }
            }
            // A class without a name of its own outside is the main one for every other.
            if outer.is_none() && name != MAIN && classes.len() == 1 {
                classes.insert(MAIN.to_owned(), known.clone());
            }
            classes.insert(name.clone(), known);
            let inner = source.children(at, "default").into_iter().rev();
            open.extend(inner.map(|inner| (inner, Some(name.clone()))));
        }
        Ok(Self { attributes, classes })
    }

    /// The element that says an attribute of another: itself, its class, or the class of the bodies around it.
    pub fn says(
        &self,
        source: &Source,
        element: usize,
        around: Option<&str>,
        attribute: &str,
    ) -> Result<Option<usize>, RobotError> {
        if source.get(element, attribute).is_some() {
            return Ok(Some(element));
        }
        let class = source.get(element, "class").or(around).unwrap_or(MAIN);
        let known = self.classes.get(class).ok_or_else(|| {
            let what = format!("its class '{class}' is not in the file, which has {} classes", self.classes.len());
            RobotError::new(
                source.place(element),
                what,
                format!("add <default class=\"{class}\"/>, or correct the name"),
            )
        })?;
        let at = self.attributes.iter().position(|known| *known == attribute);
        Ok(at.and_then(|at| known[at]))
    }
}
