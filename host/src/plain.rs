//! Text of others on a terminal: names, paths and notes out of files, with their control characters shown instead of sent.
//!
//! A terminal takes ESC, BEL, CR and others as commands: a joint's name could set the window's title, clear the screen or write to
//! the clipboard. Marks of writing direction are shown too: they can make a line read as another one.

use std::borrow::Cow;

/// Characters of a line of a message at most.
const LONGEST: usize = 2000;

/// True for characters that a terminal does not draw but obeys.
fn obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

fn shown<'t>(text: &'t str, kept: &[char], escape: impl Fn(char) -> String) -> Cow<'t, str> {
    let hidden = |c: char| obeyed(c) && !kept.contains(&c);
    if !text.contains(hidden) {
        return Cow::Borrowed(text);
    }
    let each = |c: char| if hidden(c) { escape(c) } else { c.to_string() };
    Cow::Owned(text.chars().map(each).collect())
}

/// A name or a path for a line: control characters, line ends too, as `\u{1b}`.
pub fn line(text: &str) -> Cow<'_, str> {
    shown(text, &[], |c| c.escape_unicode().to_string())
}

/// Text of several lines: as [`line()`], with line ends and tabs as they are.
pub fn text(text: &str) -> Cow<'_, str> {
    shown(text, &['\n', '\t'], |c| c.escape_unicode().to_string())
}

/// JSON: as [`text`], in JSON's own escapes, so that it stays the same document.
pub fn json(text: &str) -> Cow<'_, str> {
    shown(text, &['\n', '\t'], |c| format!("\\u{:04x}", u32::from(c)))
}

/// A message: as [`text`], with lines cut that nobody reads. They come from broken files, whose lines may be the whole file.
pub fn message(message: &str) -> String {
    let cut = |line: &str| match line.char_indices().nth(LONGEST) {
        None => text(line).into_owned(),
        Some((at, _)) => {
            format!("{} ... and {} characters more", text(&line[..at]), line[at..].chars().count())
        }
    };
    message.split('\n').map(cut).collect::<Vec<_>>().join("\n")
}

/// A name as a cell of CSV (RFC 4180). What other tables part cells by is quoted too: readers guess it from the header.
pub fn quoted(name: &str) -> String {
    if name.contains([',', ';', '\t', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Title, clear screen, clipboard, link, one-character forms of C1, direction.
    const HOSTILE: &str = "a\x1b]0;title\x07\x1b[2J\r\n\tb\u{9b}2J\u{202e}c\x7fé";

    #[test]
    fn a_terminal_is_sent_no_command() {
        assert_eq!(line("Röhre 2"), "Röhre 2");
        let shown = line(HOSTILE);
        assert_eq!(shown, r"a\u{1b}]0;title\u{7}\u{1b}[2J\u{d}\u{a}\u{9}b\u{9b}2J\u{202e}c\u{7f}é");
        assert!(!shown.contains(obeyed));
        assert_eq!(text("a\n\tb\x1b"), "a\n\tb\\u{1b}");
    }

    #[test]
    fn json_stays_the_same_document() {
        let document = serde_json::to_string_pretty(&[HOSTILE]).unwrap();
        let plain = json(&document);
        assert!(!plain.contains(|c| obeyed(c) && c != '\n'));
        assert_eq!(serde_json::from_str::<[String; 1]>(&plain).unwrap(), [HOSTILE]);
    }

    #[test]
    fn the_line_of_a_broken_file_is_cut() {
        let cut = message(&format!("{}\nnext \x1b", "é".repeat(1_000_000)));
        assert_eq!(cut, format!("{} ... and 998000 characters more\nnext \\u{{1b}}", "é".repeat(2000)));
    }
}
