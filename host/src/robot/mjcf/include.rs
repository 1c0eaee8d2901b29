//! Files that an MJCF includes: put in their places before it is read.

use std::collections::HashSet;
use std::path::{Component, Path};

use super::super::RobotError;
use super::super::xml::Xml;

/// Files in one model at most.
const FILES: usize = 64;
/// Bytes of a model with its files at most.
const BYTES: usize = 64 << 20;

/// The text with every `<include file="..."/>` replaced by what is in that file, beside the model or in a folder below. Line ends of
/// included text become spaces, so that lines are those of the model's own file.
pub(crate) fn included(mut text: String, folder: &Path) -> Result<String, RobotError> {
    let mut read: HashSet<String> = HashSet::new();
    // Every file once: the loop ends with the files.
    while text.contains("<include") {
        let xml = Xml::parse(&text)?;
        let root = xml.document.root_element();
        let nodes: Vec<_> = root.descendants().filter(|node| node.has_tag_name("include")).collect();
        if nodes.is_empty() || !root.has_tag_name("mujoco") {
            break;
        }
        let (mut out, mut at) = (String::new(), 0);
        for node in nodes {
            let place = format!("line {}", xml.line(node));
            let refuse = |what: String, help: &str| RobotError::new(&place, what, help);
            let name = node.attribute("file").unwrap_or_default().to_owned();
            let inside =
                Path::new(&name).components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
            if name.is_empty() || !inside {
                let what = format!("<include file=\"{name}\">: expected a file beside the model or in a folder below");
                return Err(refuse(
                    what,
                    "copy it beside the model, or write the model flat: mj_saveLastXML of MuJoCo",
                ));
            }
            if !read.insert(name.clone()) || read.len() > FILES {
                let what = format!("<include file=\"{name}\">: expected every file once, and {FILES} at most");
                return Err(refuse(what, "write the model flat: mj_saveLastXML of MuJoCo"));
            }
            let part = crate::files::read_text(&folder.join(&name)).map_err(|error| {
                refuse(format!("<include file=\"{name}\">: cannot be read: {error}"), "put the file beside the model")
            })?;
            let part = body(&part).map_err(|error| error.in_file(Path::new(&name)))?;
            out.push_str(text.get(at..node.range().start).unwrap_or_default());
            out.push_str(&part);
            at = node.range().end;
            if out.len() > BYTES {
                return Err(refuse(format!("the model grows beyond {BYTES} bytes"), "is this the right file?"));
            }
        }
        out.push_str(text.get(at..).unwrap_or_default());
        text = out;
    }
    Ok(text)
}

/// What is inside the root element, on one line.
fn body(text: &str) -> Result<String, RobotError> {
    let xml = Xml::parse(text)?;
    let root = xml.document.root_element();
    let ends = root.first_child().zip(root.last_child()).map(|(first, last)| first.range().start..last.range().end);
    Ok(ends.and_then(|range| text.get(range)).unwrap_or_default().replace(['\n', '\r'], " "))
}
