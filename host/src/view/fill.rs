//! The page from its template: every mark is replaced in one pass, so that no part is read as a template again.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use sha2::{Digest, Sha256};

/// `template` with each `{{mark}}` replaced by the part of that name.
///
/// # Panics
/// If the template has a mark without a part: the template is a file of this program.
pub(super) fn fill(template: &str, parts: &[(&str, &str)]) -> String {
    let mut pieces = template.split("{{");
    let mut page = pieces.next().unwrap_or_default().to_owned();
    for piece in pieces {
        let (mark, rest) = piece.split_once("}}").unwrap_or_else(|| unreachable!("a mark without its end"));
        let part = parts.iter().find(|(name, _)| *name == mark);
        let (_, part) = part.unwrap_or_else(|| unreachable!("no part is called {mark}"));
        page.push_str(part);
        page.push_str(rest);
    }
    page
}

/// Text between tags or in an attribute.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON in a script element: the element ends, or changes its mode, at a `<` alone. In JSON it only occurs in strings.
pub(super) fn inert(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// A Content-Security-Policy with which the page runs this script and this style, WebAssembly, and nothing else: it loads nothing,
/// sends nothing, and runs no script that a name could bring in.
pub(super) fn policy(script: &str, style: &str) -> String {
    let [script, style] = [script, style].map(|text| BASE64_STANDARD.encode(Sha256::digest(text)));
    format!(
        "default-src 'none'; script-src 'sha256-{script}' 'wasm-unsafe-eval'; style-src 'sha256-{style}'; base-uri 'none'; \
         form-action 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_never_read_as_a_template() {
        let parts = [("a", "{{b}}"), ("b", "{{a}}<")];
        assert_eq!(fill("1 {{a}} 2 {{b}} 3 {{a}}", &parts), "1 {{b}} 2 {{a}}< 3 {{b}}");
    }
}
