//! An error in a text file, shown with the line it is in.

use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// What is wrong where in a text file, and what was expected.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic {
    /// Name of the file as the user gave it.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column, from 1.
    pub column: usize,
    /// What is wrong.
    pub message: String,
    /// What was expected there.
    pub expected: String,
    /// The same with the source line drawn.
    rendered: String,
}

impl Diagnostic {
    /// Describe an error at the byte range `span` of `text`.
    pub fn new(
        file: &str,
        text: &str,
        span: Range<usize>,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        let (message, expected) = (message.into(), expected.into());
        let start = floor_boundary(text, span.start);
        let end = floor_boundary(text, span.end).max(start);
        let line = text[..start].matches('\n').count() + 1;
        let column =
            text[..start].rsplit('\n').next().map_or(0, |before| before.chars().count()) + 1;
        // Show the lines of the range alone, so that a long file costs nothing.
        let first = text[..start].rfind('\n').map_or(0, |i| i + 1);
        let last = text[end..].find('\n').map_or(text.len(), |i| end + i);
        let report = [Level::ERROR.primary_title(message.as_str()).element(
            Snippet::source(&text[first..last]).line_start(line).path(file).annotation(
                AnnotationKind::Primary.span(start - first..end - first).label(expected.as_str()),
            ),
        )];
        let rendered = Renderer::plain().render(&report);
        Self { file: file.to_owned(), line, column, message, expected, rendered }
    }

    /// Describe an error in a whole line (from 1) of `text`.
    pub fn at_line(
        file: &str,
        text: &str,
        line: usize,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        let start: usize =
            text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
        let start = start.min(text.len());
        let length = text[start..].lines().next().map_or(0, str::len);
        Self::new(file, text, start..start + length, message, expected)
    }
}

/// The largest character boundary not above `at`.
fn floor_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.rendered.trim_start_matches("error: "))
    }
}

#[cfg(test)]
mod tests {
    use super::Diagnostic;

    #[test]
    fn line_and_column_count_from_one_and_in_characters() {
        let d = Diagnostic::new("a.toml", "é = 1\nb = x\n", 11..12, "bad", "a number");
        assert_eq!((d.line, d.column), (2, 5));
        assert!(d.to_string().contains("b = x"), "{d}");
    }

    #[test]
    fn a_span_beyond_the_text_is_clamped() {
        let d = Diagnostic::new("a.toml", "", 5..9, "empty", "a table");
        assert_eq!(d.line, 1);
        assert_eq!(Diagnostic::at_line("a", "x\ny", 9, "m", "e").line, 2);
    }
}
