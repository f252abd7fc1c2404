//! Text: escaping, sub- and superscripts (`_{pp}`, `^{2}`), width and wrapping.

/// A run of text at one level: on the line, below it or above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Level {
    Line,
    Sub,
    Super,
}

/// Splits `mu_{pp}^{2}` into runs; a brace without its partner is plain text.
pub(crate) fn runs(text: &str) -> Vec<(Level, &str)> {
    let mut out = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let next = ["_{", "^{"].iter().filter_map(|mark| rest.find(mark)).min();
        let Some((start, length)) =
            next.and_then(|start| rest[start..].find('}').map(|length| (start, length)))
        else {
            out.push((Level::Line, rest));
            break;
        };
        if start > 0 {
            out.push((Level::Line, &rest[..start]));
        }
        let level = if rest[start..].starts_with('_') { Level::Sub } else { Level::Super };
        if length > 2 {
            out.push((level, &rest[start + 2..start + length]));
        }
        rest = &rest[start + length + 1..];
    }
    out
}

/// The text without the marks of sub- and superscripts, for titles and screen readers.
pub(crate) fn plain(text: &str) -> String {
    runs(text).into_iter().map(|(_, run)| run).collect()
}

/// Escapes what XML reserves and drops the control characters that it forbids.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\u{fffe}' | '\u{ffff}' => {}
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

/// The text as SVG `tspan`s, sub- and superscripts shifted.
pub(crate) fn spans(text: &str) -> String {
    let parts = runs(text);
    if parts.iter().all(|(level, _)| *level == Level::Line) {
        return parts.iter().map(|(_, run)| escape(run)).collect();
    }
    // dy shifts everything that follows, so each run undoes the shift before it.
    let mut out = String::new();
    let mut shift = 0.0;
    for (level, run) in parts {
        let (target, size) = match level {
            Level::Line => (0.0, ""),
            Level::Sub => (3.0, " font-size=\"78%\""),
            Level::Super => (-5.0, " font-size=\"78%\""),
        };
        out.push_str(&format!("<tspan dy=\"{}\"{size}>{}</tspan>", target - shift, escape(run)));
        shift = target;
    }
    out
}

/// Estimated width, px, of a text set in a common sans-serif face; errs on the wide side.
pub(crate) fn width(text: &str, size_px: f64) -> f64 {
    let em: f64 = runs(text)
        .into_iter()
        .map(|(level, run)| {
            let scale = if level == Level::Line { 1.0 } else { 0.78 };
            scale * run.chars().map(advance).sum::<f64>()
        })
        .sum();
    WIDEST_FACE * em * size_px
}

/// Ratio of the widest common face (DejaVu Sans, measured) to the advances below.
const WIDEST_FACE: f64 = 1.12;

/// Advance of a character in a face like Arial, em.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | 'I' | ' ' | '·' => 0.29,
        'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' | '°' => 0.37,
        'm' | 'w' | 'M' | 'W' | '%' | '@' | '…' | '—' => 0.88,
        'A'..='Z' | '±' | '−' | '+' | '=' | '<' | '>' | '≤' | '≥' | '×' => 0.68,
        _ => 0.56,
    }
}

/// Breaks a text into lines no wider than `limit_px`; a single long word stays whole.
pub(crate) fn wrap(text: &str, size_px: f64, limit_px: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size_px) <= limit_px => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

/// Cuts a text with an ellipsis so that it fits `limit_px`.
pub(crate) fn shorten(text: &str, size_px: f64, limit_px: f64) -> String {
    if width(text, size_px) <= limit_px {
        return text.to_string();
    }
    let mut kept: Vec<char> = plain(text).chars().collect();
    while kept.len() > 1 {
        kept.pop();
        let short: String = kept.iter().collect::<String>() + "…";
        if width(&short, size_px) <= limit_px {
            return short;
        }
    }
    "…".into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_are_split_and_lone_braces_kept() {
        assert_eq!(
            runs("μ_{pp}, R^{2}"),
            [(Level::Line, "μ"), (Level::Sub, "pp"), (Level::Line, ", R"), (Level::Super, "2")]
        );
        assert_eq!(runs("a_{b"), [(Level::Line, "a_{b")]);
        assert_eq!(runs("AZ4_Steel"), [(Level::Line, "AZ4_Steel")]);
        assert_eq!(plain("μ_{pp}"), "μpp");
    }

    #[test]
    fn shifts_of_spans_add_to_zero() {
        assert!(spans("μ_{pp} x").contains("dy=\"-3\""));
    }

    #[test]
    fn wrapped_lines_fit_and_lose_no_word() {
        let text = "Contours of the four responses with measured bands at 17 rpm";
        let lines = wrap(text, 13.0, 200.0);
        assert!(lines.len() > 1 && lines.iter().all(|l| width(l, 13.0) <= 200.0));
        assert_eq!(lines.join(" "), text);
    }

    #[test]
    fn control_characters_are_dropped() {
        assert_eq!(escape("a\u{0}<b>\u{7}"), "a&lt;b&gt;");
    }
}
