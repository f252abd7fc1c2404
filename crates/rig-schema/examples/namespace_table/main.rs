//! Prints the namespace of parameters as the book's page (`docs/src/namespace.md`).
//!
//! ```sh
//! cargo run --release -p rig-schema --example namespace_table > docs/src/namespace.md
//! ```
#![expect(clippy::print_stdout, reason = "an example shows its results")]

mod page;

fn main() {
    print!("{}", page::markdown());
}
