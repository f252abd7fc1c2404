//! A self-contained HTML page: verdict, sections of figures and tables, provenance.
//!
//! One file without scripts or external resources. It follows the reader's light or dark scheme,
//! prints on white with figures kept whole, and on a phone falls into one column in which tables
//! scroll sideways.

mod table;

use maud::{DOCTYPE, Markup, PreEscaped, html};

pub use table::{Align, Column, Row, Table};

use crate::Picture;
use crate::svg::text::{Level, plain, runs};

/// How a statement is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Plain information.
    #[default]
    Neutral,
    /// Agreement.
    Good,
    /// To be taken with care.
    Caution,
    /// Disagreement or failure.
    Bad,
}

impl Tone {
    fn class(self) -> &'static str {
        match self {
            Tone::Neutral => "neutral",
            Tone::Good => "good",
            Tone::Caution => "caution",
            Tone::Bad => "bad",
        }
    }

    /// A sign that says the same without colour.
    fn sign(self) -> &'static str {
        match self {
            Tone::Neutral => "•",
            Tone::Good => "✓",
            Tone::Caution => "!",
            Tone::Bad => "✗",
        }
    }
}

/// The result in one sentence.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// The sentence.
    pub sentence: String,
    /// How it is meant.
    pub tone: Tone,
}

/// A picture with its caption.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// SVG document.
    pub svg: String,
    /// Caption: what the picture shows and how to read it.
    pub caption: String,
}

impl Figure {
    /// Draws a picture and gives it a caption.
    pub fn new(picture: &impl Picture, caption: impl Into<String>) -> Self {
        Self { svg: picture.svg(), caption: caption.into() }
    }
}

/// A part of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// Running text.
    Paragraph(String),
    /// A statement set apart.
    Note(Tone, String),
    /// A bulleted list.
    List(Vec<String>),
    /// A table.
    Table(Table),
    /// Figures side by side where there is room.
    Figures(Vec<Figure>),
    /// A subheading.
    Heading(String),
    /// Parts folded away behind a line of text; open in print.
    Folded(String, Vec<Block>),
}

/// A section: a heading and its parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// Heading.
    pub heading: String,
    /// Parts in order.
    pub blocks: Vec<Block>,
}

impl Section {
    /// An empty section.
    pub fn new(heading: impl Into<String>) -> Self {
        Self { heading: heading.into(), blocks: Vec::new() }
    }

    /// Adds a part.
    #[must_use]
    pub fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }
}

/// An input file and its hash.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InputFile {
    /// Name of the file.
    pub name: String,
    /// Hash of its content, with the name of the hash: "blake3 ab12...".
    pub hash: String,
}

/// Where the numbers of a page come from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Input files with hashes.
    pub inputs: Vec<InputFile>,
    /// Seed of random numbers, where any were drawn.
    pub seed: Option<u64>,
    /// Program and version.
    pub version: String,
    /// The command that makes the page again.
    pub command: String,
    /// Further facts: (name, value).
    pub settings: Vec<(String, String)>,
}

/// An HTML page.
///
/// ```
/// use calib_report::page::{Block, Page, Section};
/// let page = Page::new("Friction of glass beads")
///     .with(Section::new("Result").with(Block::Paragraph("μ_{pp} is 0.31.".into())));
/// let html = page.html();
/// assert!(html.contains("μ<sub>pp</sub> is 0.31."));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    /// Title.
    pub title: String,
    /// A line under the title.
    pub subtitle: String,
    /// The result in one sentence.
    pub verdict: Option<Verdict>,
    /// Sections in order.
    pub sections: Vec<Section>,
    /// Where the numbers come from.
    pub provenance: Option<Provenance>,
}

impl Page {
    /// A page with a title.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Adds a section.
    #[must_use]
    pub fn with(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// The HTML document.
    pub fn html(&self) -> String {
        let shown: Vec<&Section> = self.sections.iter().filter(|s| !s.blocks.is_empty()).collect();
        html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    title { (plain(&self.title)) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    header {
                        h1 { (rich(&self.title)) }
                        @if !self.subtitle.is_empty() { p.subtitle { (rich(&self.subtitle)) } }
                        @if let Some(verdict) = &self.verdict {
                            (note(verdict.tone, &verdict.sentence, "verdict"))
                        }
                        @if shown.len() > 3 {
                            nav aria-label="Contents" {
                                ol {
                                    @for (i, section) in shown.iter().enumerate() {
                                        li { a href={ "#section-" (i + 1) } { (rich(&section.heading)) } }
                                    }
                                }
                            }
                        }
                    }
                    main {
                        @for (i, section) in shown.iter().enumerate() {
                            section id={ "section-" (i + 1) } {
                                h2 { (rich(&section.heading)) }
                                (blocks(&section.blocks))
                            }
                        }
                    }
                    @if let Some(provenance) = &self.provenance { (provenance.markup()) }
                }
            }
        }
        .into_string()
    }
}

impl Provenance {
    fn markup(&self) -> Markup {
        let seed = self.seed.map(|s| ("Seed", s.to_string()));
        let version = (!self.version.is_empty()).then(|| ("Version", self.version.clone()));
        html! {
            footer {
                h2 { "Where the numbers come from" }
                @if !self.command.is_empty() { p { "Made by " code { (self.command) } } }
                div.scroll tabindex="0" {
                    table {
                        tbody {
                            @for (name, value) in version.iter().chain(&seed) {
                                tr { th scope="row" { (name) } td { (value) } }
                            }
                            @for (name, value) in &self.settings {
                                tr { th scope="row" { (rich(name)) } td { (rich(value)) } }
                            }
                            @for input in &self.inputs {
                                tr { th scope="row" { (input.name) } td { code { (input.hash) } } }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Text with `_{}` and `^{}` as sub- and superscripts.
fn rich(text: &str) -> Markup {
    html! {
        @for (level, run) in runs(text) {
            @match level {
                Level::Line => (run),
                Level::Sub => sub { (run) },
                Level::Super => sup { (run) },
            }
        }
    }
}

fn note(tone: Tone, text: &str, class: &str) -> Markup {
    html! {
        p class={ (class) " " (tone.class()) } {
            span.sign aria-hidden="true" { (tone.sign()) }
            span { (rich(text)) }
        }
    }
}

fn blocks(parts: &[Block]) -> Markup {
    html! {
        @for part in parts {
            @match part {
                Block::Paragraph(text) => p { (rich(text)) },
                Block::Note(tone, text) => (note(*tone, text, "note")),
                Block::List(items) => ul { @for item in items { li { (rich(item)) } } },
                Block::Table(table) => (table.markup()),
                Block::Heading(text) => h3 { (rich(text)) },
                Block::Figures(figures) => div.figures {
                    @for figure in figures {
                        figure {
                            (PreEscaped(&figure.svg))
                            @if !figure.caption.is_empty() {
                                figcaption { (rich(&figure.caption)) }
                            }
                        }
                    }
                },
                Block::Folded(summary, inner) => details {
                    summary { (rich(summary)) }
                    (blocks(inner))
                },
            }
        }
    }
}

const STYLE: &str = include_str!("style.css");
