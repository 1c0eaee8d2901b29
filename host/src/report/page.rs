//! A page: blocks one below the other, styled for light and dark, without anything from outside.

use std::fmt::Write as _;

use super::chart::Chart;
use crate::pack::Provenance;

/// Colours and spacing; charts and figures are drawn for a light ground and keep it.
const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1c1e21; --soft: #5d636b; --line: #d9dce0; --ground: #fff }
@media (prefers-color-scheme: dark) { :root { --ink: #e8eaed; --soft: #a5abb3; --line: #3a3f45; --ground: #16181b } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--ground); max-width: 60rem; margin: 2rem auto;
  padding: 0 1rem }
h1 { font-size: 1.7rem; margin-bottom: 0 } h2 { font-size: 1.2rem; margin-top: 2.2rem }
p, figcaption { max-width: 46rem } .lead, figcaption { color: var(--soft) }
.scroll { overflow-x: auto } table { border-collapse: collapse; font-variant-numeric: tabular-nums }
th, td { padding: .2rem .9rem .2rem 0; border-bottom: 1px solid var(--line); text-align: right; font-weight: normal }
thead th { color: var(--soft) } th:first-child, td:first-child { text-align: left }
figure { margin: 1rem 0 } figure svg { background: #fff; border-radius: 6px; max-width: 100%; height: auto }
code { overflow-wrap: anywhere }";

/// A page in the making.
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    body: String,
}

/// A table; the first column is text, the others are figures.
#[derive(Clone, Debug)]
pub struct Table {
    /// What the figures are, with their unit.
    pub caption: String,
    /// Column heads.
    pub head: Vec<String>,
    /// Rows, as long as the head.
    pub rows: Vec<Vec<String>>,
}

impl Report {
    /// A page with a title and a sentence below it.
    pub fn new(title: &str, lead: &str) -> Self {
        let body = format!("<h1>{}</h1>\n<p class=\"lead\">{}</p>\n", escape(title), escape(lead));
        Self { title: title.to_owned(), body }
    }

    /// A section begins.
    pub fn heading(&mut self, text: &str) -> &mut Self {
        self.push(format_args!("<h2>{}</h2>", escape(text)))
    }

    /// A paragraph.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.push(format_args!("<p>{}</p>", escape(text)))
    }

    /// A table.
    pub fn table(&mut self, table: &Table) -> &mut Self {
        let cells = |row: &[String], tag: &str| -> String {
            row.iter().map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect()
        };
        let rows: String = table.rows.iter().map(|row| format!("<tr>{}</tr>\n", cells(row, "td"))).collect();
        let (caption, head) = (escape(&table.caption), cells(&table.head, "th"));
        self.push(format_args!(
            "<figure><figcaption>{caption}</figcaption>\n<div class=\"scroll\"><table><thead><tr>{head}</tr></thead>\n<tbody>{rows}</tbody></table></div></figure>"
        ))
    }

    /// Curves.
    pub fn chart(&mut self, chart: &Chart) -> &mut Self {
        self.figure(&chart.svg(), &chart.caption)
    }

    /// An SVG drawing of our own, with a caption.
    pub fn figure(&mut self, svg: &str, caption: &str) -> &mut Self {
        self.push(format_args!("<figure>{svg}<figcaption>{}</figcaption></figure>", escape(caption)))
    }

    /// Where the pack comes from: command, seed, training files, notes.
    pub fn provenance(&mut self, provenance: &Provenance) -> &mut Self {
        self.heading("Where it comes from");
        let (tool, command) = (escape(&provenance.tool), escape(&provenance.command));
        self.push(format_args!("<p>{tool}, seed {}: <code>{command}</code></p>", provenance.seed));
        if !provenance.notes.is_empty() {
            let notes: String = provenance.notes.iter().map(|note| format!("<li>{}</li>", escape(note))).collect();
            self.push(format_args!("<ul>{notes}</ul>"));
        }
        let row = |file: &crate::pack::InputFile| vec![file.path.clone(), file.sha256.chars().take(16).collect()];
        self.table(&Table {
            caption: format!("The {} training files, with the beginning of their SHA-256", provenance.inputs.len()),
            head: vec!["file".into(), "hash".into()],
            rows: provenance.inputs.iter().map(row).collect(),
        })
    }

    /// The whole page.
    pub fn html(&self) -> String {
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>\n{STYLE}\n</style>\n</head>\n<body>\n{}</body>\n</html>\n",
            escape(&self.title),
            self.body
        )
    }

    fn push(&mut self, block: std::fmt::Arguments) -> &mut Self {
        // Writing to a string has no way to fail.
        let _ = writeln!(self.body, "{block}");
        self
    }
}

/// Text as HTML: file names may hold anything.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_the_page() {
        let mut report = Report::new("a <b> & \"c\"", "lead");
        report.table(&Table {
            caption: "x < y".into(),
            head: vec!["file".into()],
            rows: vec![vec!["<script>".into()]],
        });
        let html = report.html();
        assert!(html.contains("<title>a &lt;b&gt; &amp; &quot;c&quot;</title>"));
        assert!(html.contains("<td>&lt;script&gt;</td>") && !html.contains("<script>"));
        assert!(!html.contains("http"), "nothing from outside");
    }
}
