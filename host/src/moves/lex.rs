//! JSON with the line of every value. One text may hold several values one after the other (JSON lines).

use super::error::MovesError;
use super::tape::{DEPTH, Kind, Tape};

/// A list of all values of the text. `NaN` and `Infinity`, which Python writes, are taken as numbers that are not finite.
pub(super) fn parse(text: &str) -> Result<Tape<'_>, MovesError> {
    // No more values than there are commas, colons and brackets, and one a line.
    let marks = text.bytes().filter(|b| matches!(b, b',' | b':' | b'[' | b'{' | b'\n')).count();
    let mut parser = Parser { text, at: 0, line: 1, tape: Tape::new(text, marks + 4) };
    parser.tape.open(Kind::List, 1);
    while parser.peek().is_some() {
        parser.value(1)?;
    }
    parser.tape.close();
    Ok(parser.tape)
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    line: usize,
    tape: Tape<'a>,
}

impl Parser<'_> {
    fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// The next byte that is no space.
    fn peek(&mut self) -> Option<u8> {
        while let Some(byte) = self.byte().filter(u8::is_ascii_whitespace) {
            self.line += usize::from(byte == b'\n');
            self.at += 1;
        }
        self.byte()
    }

    fn refuse(&self, expected: &str) -> MovesError {
        let found = match self.text.get(self.at..).and_then(|rest| rest.chars().next()) {
            Some(c) => format!("'{}'", c.escape_default()),
            None => "the end of the file".into(),
        };
        MovesError::new(
            format!("line {}", self.line),
            format!("not JSON: found {found}, expected {expected}"),
            "`python -m json.tool FILE` finds the same error; is the file whole?",
        )
    }

    fn value(&mut self, depth: usize) -> Result<(), MovesError> {
        match self.peek() {
            Some(b'{') => self.inside(Kind::Map, b'}', depth),
            Some(b'[') => self.inside(Kind::List, b']', depth),
            Some(b'"') => self.string(),
            Some(byte) if byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'+' | b'.') => self.plain(),
            _ => Err(self.refuse("a value")),
        }
    }

    fn inside(&mut self, kind: Kind, close: u8, depth: usize) -> Result<(), MovesError> {
        if depth >= DEPTH || !self.tape.open(kind, self.line) {
            return Err(self.refuse(&format!("at most {DEPTH} brackets in each other")));
        }
        self.at += 1;
        if self.peek() != Some(close) {
            loop {
                if kind == Kind::Map {
                    if self.peek() != Some(b'"') {
                        return Err(self.refuse("a key in double quotes"));
                    }
                    self.string()?;
                    if self.peek() != Some(b':') {
                        return Err(self.refuse("':' behind the key"));
                    }
                    self.at += 1;
                }
                self.value(depth + 1)?;
                match self.peek() {
                    Some(b',') => self.at += 1,
                    Some(byte) if byte == close => break,
                    _ => return Err(self.refuse(&format!("',' or '{}'", char::from(close)))),
                }
            }
        }
        self.at += 1;
        self.tape.close();
        Ok(())
    }

    fn plain(&mut self) -> Result<(), MovesError> {
        let start = self.at;
        while self.byte().is_some_and(|b| b.is_ascii_alphanumeric() || matches!(b, b'-' | b'+' | b'.')) {
            self.at += 1;
        }
        let text = self.text.get(start..self.at).unwrap_or("");
        if !matches!(text, "true" | "false" | "null") && text.parse::<f64>().is_err() {
            self.at = start;
            return Err(self.refuse("a number, a text in double quotes, true, false or null"));
        }
        self.tape.scalar(Kind::Plain, start, self.at, self.line);
        Ok(())
    }

    fn string(&mut self) -> Result<(), MovesError> {
        let (start, line) = (self.at + 1, self.line);
        self.at = start;
        let mut decoded: Option<String> = None;
        let mut run = start;
        loop {
            match self.byte() {
                None => return Err(self.refuse("the end of a text, '\"'")),
                Some(b'"') => break,
                Some(b'\\') => {
                    let mut text = decoded.take().unwrap_or_default();
                    text.push_str(self.text.get(run..self.at).unwrap_or(""));
                    text.push(self.escape()?);
                    run = self.at;
                    decoded = Some(text);
                }
                Some(byte) => {
                    self.line += usize::from(byte == b'\n');
                    self.at += 1;
                }
            }
        }
        match decoded {
            None => self.tape.scalar(Kind::Text, start, self.at, line),
            Some(mut text) => {
                text.push_str(self.text.get(run..self.at).unwrap_or(""));
                self.tape.pooled(Kind::Text, &text, line);
            }
        }
        self.at += 1;
        Ok(())
    }

    fn escape(&mut self) -> Result<char, MovesError> {
        self.at += 1;
        let simple = match self.byte() {
            Some(b'n') => '\n',
            Some(b't') => '\t',
            Some(b'r') => '\r',
            Some(b'b') => '\u{8}',
            Some(b'f') => '\u{c}',
            Some(byte @ (b'"' | b'\\' | b'/')) => char::from(byte),
            Some(b'u') => {
                let high = self.hex()?;
                let follows = self.text.get(self.at..).is_some_and(|rest| rest.starts_with("\\u"));
                if !(0xd800..0xdc00).contains(&high) || !follows {
                    return char::from_u32(high).ok_or_else(|| self.refuse("the other half of a '\\u' pair"));
                }
                self.at += 1;
                let low = self.hex()?;
                let pair = 0x10000 + ((high - 0xd800) << 10) + (low.wrapping_sub(0xdc00) & 0x3ff);
                let fits = (0xdc00..0xe000).contains(&low);
                return char::from_u32(pair)
                    .filter(|_| fits)
                    .ok_or_else(|| self.refuse("the other half of a '\\u' pair"));
            }
            _ => return Err(self.refuse("one of \\\" \\\\ \\/ \\b \\f \\n \\r \\t \\u")),
        };
        self.at += 1;
        Ok(simple)
    }

    /// Four digits behind a `u`.
    fn hex(&mut self) -> Result<u32, MovesError> {
        let digits = self.text.get(self.at + 1..self.at + 5).filter(|d| d.bytes().all(|b| b.is_ascii_hexdigit()));
        let code = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let code = code.ok_or_else(|| self.refuse("four hexadecimal digits behind '\\u'"))?;
        self.at += 5;
        Ok(code)
    }
}
