//! What the readers of descriptions share: a checked document, lines, and attributes as numbers.

use roxmltree::{Document, Node};

use super::RobotError;

/// Attributes of an element at most. The XML reader compares each with all others of its element.
const ATTRIBUTES: usize = 1000;

/// A document with the lines of its elements.
pub(super) struct Xml<'t> {
    pub document: Document<'t>,
    ends: Vec<usize>,
}

impl<'t> Xml<'t> {
    /// Reads XML; refuses what would take the reader long.
    pub fn parse(text: &'t str) -> Result<Self, RobotError> {
        crowded(text)?;
        let document = Document::parse(text).map_err(|error| {
            RobotError::new(
                format!("line {}", error.pos().row),
                format!("not XML: {error}"),
                "expected a URDF or an MJCF; `check_urdf FILE` of liburdfdom-tools finds the same error",
            )
        })?;
        Ok(Self { document, ends: text.match_indices('\n').map(|(at, _)| at).collect() })
    }

    /// Line of an element, from 1.
    pub fn line(&self, node: Node) -> u32 {
        1 + self.ends.partition_point(|end| *end < node.range().start) as u32
    }
}

/// Refuses an element with more attributes than any robot's.
fn crowded(text: &str) -> Result<(), RobotError> {
    let skipped = [("!--", "-->"), ("![CDATA[", "]]>"), ("?", "?>")];
    let mut at = 0;
    while let Some(open) = text[at..].find('<') {
        at += open + 1;
        let rest = &text[at..];
        if let Some((_, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            at += rest.find(end).unwrap_or(rest.len());
            continue;
        }
        let start = at;
        let (mut quote, mut values) = (None, 0);
        for byte in rest.bytes() {
            at += 1;
            match (quote, byte) {
                (None, b'>') => break,
                (None, b'"' | b'\'') => quote = Some(byte),
                (Some(open), byte) if open == byte => (quote, values) = (None, values + 1),
                _ => {}
            }
            if values > ATTRIBUTES {
                let line = 1 + text[..start].matches('\n').count();
                return Err(RobotError::new(
                    format!("line {line}"),
                    format!("found an element with more than {ATTRIBUTES} attributes, expected a URDF"),
                    "its elements have ten attributes at most: is this the right file?",
                ));
            }
        }
    }
    Ok(())
}

/// The first child of this name.
pub(super) fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|node| node.has_tag_name(name))
}

/// Plausible numbers, metres or radians or degrees; nothing where one of them is none.
pub(super) fn numbers(text: &str) -> Option<Vec<f64>> {
    let number = |x: &str| x.parse::<f64>().ok().filter(|x| x.abs() < 1e6);
    text.split_whitespace().map(number).collect()
}
