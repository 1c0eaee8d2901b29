//! A tree of JSON or YAML as one flat list: sixteen bytes a value, whatever it is.

use serde_json::Value;

use super::error::{MovesError, shown};

/// Deepest nesting that is read.
pub(super) const DEPTH: usize = 64;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    List,
    Map,
    /// Quoted.
    Text,
    /// A number, `true`, `null`; in YAML also a word without quotes.
    Plain,
}

#[derive(Clone, Copy)]
struct Token {
    kind: Kind,
    /// A scalar's first byte.
    start: u32,
    /// A scalar's end; of a list or a map, the token behind it.
    end: u32,
    line: u32,
}

/// Values in the order of the text; keys of maps are values too.
pub(super) struct Tape<'a> {
    source: &'a str,
    /// Scalars that do not stand in the source as they are. Their places count on from its end.
    pool: String,
    tokens: Vec<Token>,
    open: Vec<usize>,
}

impl<'a> Tape<'a> {
    pub(super) fn new(source: &'a str, values: usize) -> Self {
        Self { source, pool: String::new(), tokens: Vec::with_capacity(values), open: Vec::new() }
    }

    /// Begins a list or a map. False when it is too deep.
    pub(super) fn open(&mut self, kind: Kind, line: usize) -> bool {
        self.open.push(self.tokens.len());
        self.tokens.push(Token { kind, start: 0, end: 0, line: line as u32 });
        self.open.len() <= DEPTH
    }

    pub(super) fn close(&mut self) {
        let end = self.tokens.len() as u32;
        if let Some(token) = self.open.pop().and_then(|at| self.tokens.get_mut(at)) {
            token.end = end;
        }
    }

    /// A scalar that stands in the source.
    pub(super) fn scalar(&mut self, kind: Kind, start: usize, end: usize, line: usize) {
        self.tokens.push(Token { kind, start: start as u32, end: end as u32, line: line as u32 });
    }

    /// A scalar that does not.
    pub(super) fn pooled(&mut self, kind: Kind, text: &str, line: usize) {
        let start = self.source.len() + self.pool.len();
        self.pool.push_str(text);
        self.scalar(kind, start, start + text.len(), line);
    }

    /// The first value.
    pub(super) fn root(&self) -> Node<'_> {
        Node { tape: self, at: 0 }
    }

    fn slice(&self, token: &Token) -> &str {
        let (start, end, known) = (token.start as usize, token.end as usize, self.source.len());
        match start.checked_sub(known) {
            Some(from) => self.pool.get(from..end - known).unwrap_or(""),
            None => self.source.get(start..end).unwrap_or(""),
        }
    }
}

/// A value of a tape.
#[derive(Clone, Copy)]
pub(super) struct Node<'a> {
    tape: &'a Tape<'a>,
    at: usize,
}

impl<'a> Node<'a> {
    fn token(self) -> Token {
        let none = Token { kind: Kind::Plain, start: 0, end: 0, line: 1 };
        self.tape.tokens.get(self.at).copied().unwrap_or(none)
    }

    pub(super) fn kind(self) -> Kind {
        self.token().kind
    }

    pub(super) fn is_map(self) -> bool {
        self.kind() == Kind::Map
    }

    pub(super) fn is_list(self) -> bool {
        self.kind() == Kind::List
    }

    pub(super) fn line(self) -> u32 {
        self.token().line
    }

    /// `line 3, pan`; nothing is added for an empty text.
    pub(super) fn place(self, what: &str) -> String {
        let comma = if what.is_empty() { "" } else { ", " };
        format!("line {}{comma}{what}", self.line())
    }

    /// A scalar as it is written, without quotes; of a list or a map nothing.
    pub(super) fn text(self) -> &'a str {
        match self.kind() {
            Kind::List | Kind::Map => "",
            _ => self.tape.slice(&self.token()),
        }
    }

    /// A scalar that is no number, told as one word: `null`, `''`, a list.
    pub(super) fn shown(self) -> String {
        match self.kind() {
            Kind::List => "a list".into(),
            Kind::Map => "an object".into(),
            _ => shown(self.text()),
        }
    }

    /// A number, also one that is not finite; quoted ones are none.
    pub(super) fn number(self) -> Option<f64> {
        if self.kind() != Kind::Plain {
            return None;
        }
        let text = self.text();
        // YAML's spelling.
        let text = text.strip_prefix(['.']).filter(|rest| rest.starts_with(['i', 'n', 'I', 'N'])).unwrap_or(text);
        let text = if text.starts_with("-.i") { "-inf" } else { text };
        text.parse().ok()
    }

    fn after(self) -> usize {
        match self.kind() {
            Kind::List | Kind::Map => (self.token().end as usize).max(self.at + 1),
            _ => self.at + 1,
        }
    }

    /// Values of a list; of a map, keys and values in turn.
    pub(super) fn items(self) -> impl Iterator<Item = Node<'a>> {
        let inside = matches!(self.kind(), Kind::List | Kind::Map);
        let end = if inside { self.after().min(self.tape.tokens.len()) } else { 0 };
        let mut at = self.at + 1;
        std::iter::from_fn(move || {
            let node = Node { tape: self.tape, at };
            (at < end).then(|| {
                at = node.after();
                node
            })
        })
    }

    /// Keys and values of a map.
    pub(super) fn members(self) -> impl Iterator<Item = (&'a str, Node<'a>)> {
        let mut items = self.items();
        let map = self.is_map();
        std::iter::from_fn(move || if map { Some((items.next()?.text(), items.next()?)) } else { None })
    }

    /// The value of the first key of this name.
    pub(super) fn get(self, key: &str) -> Option<Node<'a>> {
        self.members().find(|(name, _)| *name == key).map(|(_, value)| value)
    }

    /// The value as serde_json has it. Words that JSON does not know are texts.
    pub(super) fn value(self) -> Value {
        match self.kind() {
            Kind::List => self.items().map(Node::value).collect(),
            Kind::Map => self.members().map(|(key, value)| (key.to_owned(), value.value())).collect(),
            Kind::Text => Value::String(self.text().to_owned()),
            Kind::Plain => match self.text() {
                "" | "~" => Value::Null,
                text => serde_json::from_str(text).unwrap_or_else(|_| Value::String(text.to_owned())),
            },
        }
    }

    /// Number of maps in it, itself included.
    pub(super) fn maps(self) -> usize {
        let tokens = self.tape.tokens.get(self.at..self.after()).unwrap_or(&[]);
        tokens.iter().filter(|token| token.kind == Kind::Map).count()
    }

    /// Values of a list, or what is there instead; `place` says whose.
    pub(super) fn list(self, place: impl Fn() -> String) -> Result<impl Iterator<Item = Node<'a>>, MovesError> {
        match self.is_list() {
            true => Ok(self.items()),
            false => {
                let what = format!("found {}, expected a list", self.shown());
                Err(MovesError::new(self.place(&place()), what, "one entry a frame or joint, in brackets"))
            }
        }
    }

    /// A finite number, refused with its line; `place` says whose.
    pub(super) fn finite(self, place: impl Fn() -> String) -> Result<f64, MovesError> {
        match self.number() {
            Some(value) if value.is_finite() => Ok(value),
            _ => {
                let help = match self.text() {
                    "..." => "`ros2 topic echo` cut the list: record it again with --full-length",
                    _ => "correct the value, or cut the frame out",
                };
                let what = format!("found {}, expected a finite number", self.shown());
                Err(MovesError::new(self.place(&place()), what, help))
            }
        }
    }
}

/// Adds a text in quotes, as JSON and YAML want it.
pub(super) fn quote(text: &str, out: &mut String) {
    out.push_str(&Value::from(text).to_string());
}
