//! Command line of Tumble.

fn main() -> anyhow::Result<()> {
    Ok(())
}
