//! The book's page of parameters is the one that the declarations print.

#[path = "../../examples/namespace_table/page.rs"]
mod page;

#[test]
fn the_books_page_of_parameters_is_up_to_date() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/namespace.md");
    let Ok(printed) = std::fs::read_to_string(path) else {
        println!("skipped: the crate stands outside its repository, docs/ is absent");
        return;
    };
    assert_eq!(
        printed,
        page::markdown(),
        "run: cargo run --release -p rig-schema --example namespace_table > docs/src/namespace.md"
    );
}
