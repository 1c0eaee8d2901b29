//! From bytes to text in the one form that the parser knows: UTF-8, line feeds, decimal points.

use std::borrow::Cow;

use super::fault::BvhFault;

/// The text, without byte-order mark, and what was changed.
pub(super) fn decode<'a>(bytes: &'a [u8], notes: &mut Vec<String>) -> Result<Cow<'a, str>, BvhFault> {
    let mut text = characters(bytes, notes)?;
    if let Some(rest) = text.strip_prefix('\u{feff}') {
        text = Cow::Owned(rest.to_owned());
    }
    if has_lone_return(&text) {
        notes.push("Lines end in CR alone.".into());
        text = Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n"));
    }
    if text.contains(',') {
        text = commas(&text, notes).map_or(text, Cow::Owned);
    }
    Ok(text)
}

/// Whether a CR is a line end of its own: also in files whose other part, or last line, was written elsewhere.
fn has_lone_return(text: &str) -> bool {
    let bytes = text.as_bytes();
    text.match_indices('\r').any(|(at, _)| bytes.get(at + 1).is_some_and(|next| *next != b'\n'))
}

fn characters<'a>(bytes: &'a [u8], notes: &mut Vec<String>) -> Result<Cow<'a, str>, BvhFault> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let Some(text) = utf16(bytes) {
        notes.push("The text is UTF-16.".into());
        return Ok(Cow::Owned(text));
    }
    let fault = |at: usize| BvhFault::NotText {
        line: 1 + bytes.iter().take(at).filter(|&&b| b == b'\n').count(),
        byte: bytes.get(at).copied().unwrap_or(0),
    };
    // A zero byte is valid UTF-8, but in practice means a binary file.
    if let Some(at) = bytes.iter().position(|&b| b == 0) {
        return Err(fault(at));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(Cow::Borrowed(text)),
        Err(error) => {
            let head = bytes.trim_ascii_start().get(..9).unwrap_or(&[]);
            // Other encodings are met in names, never in numbers.
            let motion = bytes.windows(6).position(|w| w.eq_ignore_ascii_case(b"MOTION")).unwrap_or(0);
            let names = bytes.iter().rposition(|&b| b >= 0x80).is_some_and(|last| last < motion);
            if !head.eq_ignore_ascii_case(b"HIERARCHY") || !names {
                return Err(fault(error.valid_up_to()));
            }
            notes.push(
                "The joint names are not UTF-8 (Shift-JIS or another encoding): each such byte is kept as one character."
                    .into(),
            );
            Ok(Cow::Owned(byte_by_byte(bytes)))
        }
    }
}

/// Each byte as one character. In names of two bytes a character the second may be that of a brace (in Shift-JIS "bo" ends so): it
/// becomes a wide brace. Of the encodings, the first in which braces balance then.
fn byte_by_byte(bytes: &[u8]) -> String {
    let leads: [fn(u8) -> bool; 3] =
        [|b| matches!(b, 0x81..=0x9f | 0xe0..=0xfc), |b| matches!(b, 0x81..=0xfe), |_| false];
    let read = |lead: fn(u8) -> bool| {
        let mut second = false;
        let character = |&b: &u8| {
            let inside = second;
            second = !inside && lead(b);
            match (inside, b) {
                (true, b'{') => '\u{ff5b}',
                (true, b'}') => '\u{ff5d}',
                _ => char::from(b),
            }
        };
        bytes.iter().map(character).collect::<String>()
    };
    let balanced = |text: &String| text.matches('{').count() == text.matches('}').count();
    leads.into_iter().map(read).find(balanced).unwrap_or_else(|| read(|_| false))
}

/// Text of two bytes a character: with a byte-order mark, or every second byte zero at the start.
pub(in crate::clip) fn utf16(bytes: &[u8]) -> Option<String> {
    let (little, bytes) = match bytes {
        [0xff, 0xfe, rest @ ..] => (true, rest),
        [0xfe, 0xff, rest @ ..] => (false, rest),
        [a, 0, b, 0, ..] if *a != 0 && *b != 0 => (true, bytes),
        [0, a, 0, b, ..] if *a != 0 && *b != 0 => (false, bytes),
        _ => return None,
    };
    let pairs = bytes.as_chunks::<2>().0.iter();
    let units: Vec<u16> =
        pairs.map(|pair| if little { u16::from_le_bytes(*pair) } else { u16::from_be_bytes(*pair) }).collect();
    String::from_utf16(&units).ok().filter(|text| !text.contains('\0'))
}

/// Text whose numbers have decimal commas, or commas between them, with points and blanks instead; none where there are no such.
fn commas(text: &str, notes: &mut Vec<String>) -> Option<String> {
    let is_number = |line: &str| line.bytes().all(|b| b.is_ascii_digit() || b" \t\r+-.,eE".contains(&b));
    let named = |line: &str| {
        let upper = line.trim_start().to_ascii_uppercase();
        ["ROOT", "JOINT", "END"].iter().any(|key| upper.starts_with(key))
    };
    // What follows a keyword is numbers.
    let numbers = |line: &str| {
        let tail = line.rsplit([':', 'T', 't']).next().unwrap_or(line);
        !named(line) && line.contains(',') && is_number(tail)
    };
    let mut lines = text.lines().filter(|line| numbers(line)).peekable();
    lines.peek()?;
    let listed = |line: &str| line.split_ascii_whitespace().any(|word| word.matches(',').count() > 1);
    let decimal =
        !lines.any(|line| line.contains('.') || line.contains(", ") || line.trim_end().ends_with(',') || listed(line));
    let (to, note) = match decimal {
        true => (".", "Numbers have decimal commas."),
        false => (" ", "Commas stand between the numbers."),
    };
    notes.push(note.into());
    let mut out = String::with_capacity(text.len());
    for line in text.lines() {
        if numbers(line) {
            out.push_str(&line.replace(',', to))
        } else {
            out.push_str(line)
        }
        out.push('\n');
    }
    Some(out)
}
