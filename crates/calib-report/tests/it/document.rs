//! Reading a picture back as XML.

use roxmltree::{Document, Node};

/// Parses a picture and checks what every picture promises.
pub(crate) fn checked(svg: &str) -> Document<'_> {
    let document = Document::parse(svg).unwrap_or_else(|e| panic!("{e}\n{svg}"));
    let root = document.root_element();
    assert_eq!(root.tag_name().name(), "svg");
    assert_eq!(root.attribute("role"), Some("img"));
    assert!(root.attribute("viewBox").is_some());
    let child =
        |name| root.children().find(|n| n.has_tag_name(("http://www.w3.org/2000/svg", name)));
    assert!(child("title").is_some() && child("desc").is_some());
    for word in ["NaN", "inf", "href", "script", "url("] {
        assert!(!svg.contains(word), "{word} in {svg}");
    }
    document
}

/// The elements of a name.
pub(crate) fn all<'a, 'input>(
    document: &'a Document<'input>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    document.descendants().filter(move |n| n.tag_name().name() == name)
}

/// A numeric attribute.
pub(crate) fn number(node: &Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).and_then(|v| v.parse().ok()).unwrap_or(f64::NAN)
}

/// All text of a node, its spans included.
pub(crate) fn text(node: &Node<'_, '_>) -> String {
    node.descendants().filter(|n| n.is_text()).filter_map(|n| n.text()).collect()
}
