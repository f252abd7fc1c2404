//! House tasks: `ci`, `tidy`, `reproduce`.

fn main() -> anyhow::Result<()> {
    anyhow::bail!("usage: cargo xtask <ci|tidy|reproduce>")
}
