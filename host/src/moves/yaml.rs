//! YAML into the same tape as JSON: one list of documents.

use saphyr_parser::{Event, Parser, ScalarStyle};

use super::error::MovesError;
use super::tape::{DEPTH, Kind, Tape};

/// All documents of the text. References (`*name`) are refused: a few lines of them can stand for more than fits into memory.
pub(super) fn parse(text: &str) -> Result<Tape<'_>, MovesError> {
    let mut tape = Tape::new("", text.len() / 8);
    tape.open(Kind::List, 1);
    // Whether a key is expected, for every open map.
    let mut keys: Vec<Option<bool>> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            MovesError::new(
                format!("line {}", error.marker().line()),
                format!("not YAML: {}", super::error::shown(error.info())),
                "is the file whole, and indented by spaces? `yamllint FILE` finds the same error",
            )
        })?;
        let line = span.start.line();
        let place = || format!("line {line}");
        match event {
            Event::MappingStart(..) | Event::SequenceStart(..) => {
                if let Some(Some(true)) = keys.last() {
                    let what = "found a list or a map as a key, expected a word";
                    return Err(MovesError::new(place(), what, "remove the '?' or the brackets before the ':'"));
                }
                turn(&mut keys);
                let map = matches!(event, Event::MappingStart(..));
                keys.push(map.then_some(true));
                if !tape.open(if map { Kind::Map } else { Kind::List }, line) {
                    let what = format!("found more than {DEPTH} levels, expected a trajectory");
                    return Err(MovesError::new(
                        place(),
                        what,
                        "name the part of it that holds joint_names and points",
                    ));
                }
            }
            Event::MappingEnd | Event::SequenceEnd => {
                keys.pop();
                tape.close();
            }
            Event::Scalar(text, style, ..) => {
                turn(&mut keys);
                let kind = if style == ScalarStyle::Plain { Kind::Plain } else { Kind::Text };
                tape.pooled(kind, &text, line);
            }
            Event::Alias(_) => {
                let what = "found a reference ('*name'), expected the values themselves";
                return Err(MovesError::new(place(), what, "write the values out where the reference stands"));
            }
            _ => {}
        }
    }
    tape.close();
    Ok(tape)
}

/// Keys and values of a map come in turn.
fn turn(keys: &mut [Option<bool>]) {
    if let Some(Some(key)) = keys.last_mut() {
        *key = !*key;
    }
}
