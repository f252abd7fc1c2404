//! `tumble export`: the same drum for other codes, and their positions back.

use campaign::export::{Code, Schedule, deck, dump_name, positions};

use crate::cli::{ExportArgs, OtherCode};
use crate::experiment::{self, Changes};
use crate::input::{self, InputError};
use crate::output;

pub(crate) fn run(args: &ExportArgs) -> anyhow::Result<()> {
    let code = match args.to {
        OtherCode::Liggghts => Code::Liggghts,
        OtherCode::Lammps => Code::Lammps,
        OtherCode::Yade => Code::Yade,
    };
    let changes = Changes {
        calibrated: args.calibrated.as_deref(),
        settings: &args.settings,
        speeds: &args.speeds,
        frames: args.frames,
        seed: args.seed,
        coarse: args.coarse,
    };
    let (rig, _) = experiment::rig(&args.rig, &changes)?;
    let name = format!("{}-{}", rig.name, code.name().to_lowercase());
    if args.collect {
        let folder = output::folder(args.out.as_deref(), &name)?;
        return collect(&rig.run.speeds_rpm, code, &folder);
    }
    let rises = args.times.windows(2).all(|w| w[0] < w[1]);
    if !rises {
        let what = format!("--times {:?}", args.times);
        let expected = "times of frames that rise".to_owned();
        return Err(InputError::Run { what, expected }.into());
    }
    let schedule = Schedule {
        approach_turns: args.approach_turns,
        interval_s: args.interval,
        times_s: args.times.clone(),
    };
    let files = deck(&rig, code, &schedule)?;
    let folder = output::folder(args.out.as_deref(), &name)?;
    for file in &files {
        output::write(&folder, &file.name, &file.text)?;
    }
    let program = match code {
        Code::Liggghts => "liggghts -in",
        Code::Lammps => "lmp -in",
        Code::Yade => "yade -n -j1 -x",
    };
    println!("cd {} && {program} {}", folder.display(), code.script());
    Ok(())
}

/// Dumps to tables of positions, one a speed.
fn collect(speeds_rpm: &[f64], code: Code, folder: &std::path::Path) -> anyhow::Result<()> {
    let mut found = 0;
    for &rpm in speeds_rpm {
        let path = folder.join(dump_name(rpm));
        if !path.exists() {
            eprintln!("{} is not there yet", path.display());
            continue;
        }
        let text = input::read(&path)?;
        let table = positions(&text.name, &text.text)?;
        let written = output::write(folder, &format!("positions_{rpm}rpm.csv"), &table)?;
        println!("{}", written.display());
        found += 1;
    }
    if found == 0 {
        let path = folder.display().to_string();
        return Err(InputError::NoDumps { path, code: code.name() }.into());
    }
    Ok(())
}
