//! `tumble roi`: the page on which a person marks the bed.

use drum_vision::config::DecodeConfig;
use drum_vision::{decode, roi_page};

use crate::cli::RoiArgs;
use crate::output;

pub(crate) fn run(args: &RoiArgs) -> anyhow::Result<()> {
    let frame = decode::decode_file(&args.image, &DecodeConfig::default())?;
    let name = args.image.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let page = roi_page(&frame, &name)?;
    let folder = output::folder(args.out.as_deref(), "roi")?;
    let path = output::write(&folder, &format!("{name}.html"), &page)?;
    println!("{}", path.display());
    println!(
        "Open it, click the corners of the bed, save, then: tumble measure FRAMES --roi SAVED.json"
    );
    Ok(())
}
