//! Walks over BVH text word by word and knows the line.

/// A place in the text. Words end at white space; a brace is a word of its own.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    rest: &'a str,
    line: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Cursor { rest: text, line: 1 }
    }

    /// Line of the next word (call after [`Cursor::peek`]) or of the end.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    fn skip_space(&mut self) {
        let trimmed = self.rest.trim_start();
        let skipped = &self.rest[..self.rest.len() - trimmed.len()];
        self.line += skipped.bytes().filter(|&b| b == b'\n').count();
        self.rest = trimmed;
    }

    /// The next word, without taking it; `None` at the end.
    pub(super) fn peek(&mut self) -> Option<&'a str> {
        self.skip_space();
        let first = self.rest.chars().next()?;
        if first == '{' || first == '}' {
            return self.rest.get(..1);
        }
        let end = self.rest.find(|c: char| c.is_whitespace() || c == '{' || c == '}').unwrap_or(self.rest.len());
        self.rest.get(..end)
    }

    /// Takes the next word.
    pub(super) fn word(&mut self) -> Option<&'a str> {
        let word = self.peek()?;
        self.rest = &self.rest[word.len()..];
        Some(word)
    }

    /// Takes the rest of the line up to a brace: a name may hold blanks.
    pub(super) fn name(&mut self) -> &'a str {
        let end = self.rest.find(['\n', '{', '}']).unwrap_or(self.rest.len());
        let (name, rest) = self.rest.split_at(end);
        self.rest = rest;
        name.trim()
    }

    /// Takes the next line that is not blank, trimmed, with its number.
    pub(super) fn full_line(&mut self) -> Option<(usize, &'a str)> {
        loop {
            if self.rest.is_empty() {
                return None;
            }
            let number = self.line;
            let (line, rest) = match self.rest.split_once('\n') {
                Some(parts) => {
                    self.line += 1;
                    parts
                }
                None => (self.rest, ""),
            };
            self.rest = rest;
            let line = line.trim();
            if !line.is_empty() {
                return Some((number, line));
            }
        }
    }

    /// The text that is left.
    pub(super) fn rest(&self) -> &'a str {
        self.rest
    }

    /// How many bytes are left.
    pub(super) fn left(&self) -> usize {
        self.rest.len()
    }

    /// Whether only white space is left.
    pub(super) fn at_end(&self) -> bool {
        self.rest.trim_start().is_empty()
    }
}
