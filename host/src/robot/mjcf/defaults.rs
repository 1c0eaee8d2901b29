//! Classes of joints: what `<default>` says where a joint says nothing.

use std::collections::HashMap;

use super::super::RobotError;
use super::source::Source;

/// Attributes of a joint that are read.
const ATTRIBUTES: [&str; 6] = ["type", "axis", "range", "limited", "pos", "ref"];

/// Name of the class of everything without one.
const MAIN: &str = "main";

/// By class: which `<joint>` of a `<default>` says each of [`ATTRIBUTES`].
#[derive(Default)]
pub(super) struct Defaults {
    classes: HashMap<String, [Option<usize>; ATTRIBUTES.len()]>,
}

impl Defaults {
    /// Reads all `<default>` elements, the outer ones first: inner ones inherit.
    pub fn read(source: &Source) -> Result<Self, RobotError> {
        let mut classes = HashMap::from([(MAIN.to_owned(), [None; ATTRIBUTES.len()])]);
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
                None => classes.get(&name).copied().unwrap_or_default(),
                Some(outer) => classes.get(outer).copied().unwrap_or_default(),
            };
            for joint in source.children(at, "joint") {
                for (value, attribute) in known.iter_mut().zip(ATTRIBUTES) {
                    if source.get(joint, attribute).is_some() {
                        *value = Some(joint);
                    }
                }
            }
            // A class without a name of its own outside is the main one for every other.
            if outer.is_none() && name != MAIN && classes.len() == 1 {
                classes.insert(MAIN.to_owned(), known);
            }
            classes.insert(name.clone(), known);
            let inner = source.children(at, "default").into_iter().rev();
            open.extend(inner.map(|inner| (inner, Some(name.clone()))));
        }
        Ok(Self { classes })
    }

    /// The element that says an attribute of a joint: itself, its class, or the class of the bodies around it.
    pub fn says(
        &self,
        source: &Source,
        joint: usize,
        around: Option<&str>,
        attribute: &str,
    ) -> Result<Option<usize>, RobotError> {
        if source.get(joint, attribute).is_some() {
            return Ok(Some(joint));
        }
        let class = source.get(joint, "class").or(around).unwrap_or(MAIN);
        let known = self.classes.get(class).ok_or_else(|| {
            let what = format!("its class '{class}' is not in the file, which has {} classes", self.classes.len());
            RobotError::new(source.place(joint), what, format!("add <default class=\"{class}\"/>, or correct the name"))
        })?;
        let at = ATTRIBUTES.iter().position(|known| *known == attribute);
        Ok(at.and_then(|at| known[at]))
    }
}
