//! The thesis's drums of beads by Tumble's own solver: campaigns in `target/reproduce`.
//!
//! A campaign that was killed goes on by the same call. What it shows is kept as a table of responses,
//! `fixtures/own/CONFIG.csv`, by the photographs' definition of the angles.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use close_loop::campaign::plan::{
    Campaign, Event, Freeze, Manifest, RowOutcome, RowState, RunOptions, Seen, SpeedResult,
};
use rig_schema::Response;

use super::fixture;

/// Lines of a plan by our laws, and those by the laws that EDEM documents.
pub(super) const EDEM_LAWS: [(&str, &str); 2] = [
    ("tangential = \"mindlin\"", "tangential = \"mindlin_total_spring\""),
    ("rolling = \"constant_torque\"", "rolling = \"absolute_spin\""),
];

/// Factor on the number of beads of the fuller drums.
pub(super) const MORE: f64 = 1.15;

/// The line of a plan that says so.
const FULLER: (&str, &str) = ("[fill]\n", "[fill]\nscale = 1.15\n");

/// Table 6 prints the radius of the beads as (3.0 +- 0.3) mm. Read as limits between which all radii are as likely, the standard
/// deviation is 0.3 / 3 / sqrt(3).
const LIMITS: (&str, &str) = ("[fill]\n", "[size]\nspread = 0.058\n\n[fill]\n");

/// Read as a standard deviation; the smallest of them need a shorter step.
const DEVIATION: [(&str, &str); 2] = [
    ("[fill]\n", "[size]\nspread = 0.1\n\n[fill]\nscale = 1.0\n"),
    ("time_step_s = 7e-5", "time_step_s = 6e-5"),
];

/// The printed diameter, 250 mm, as that of the tube's outside, its wall 5 mm.
pub(super) const TUBE: (&str, &str) = ("radius_m = 0.125\n", "radius_m = 0.120\n");

/// Which settings of a configuration are simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Design {
    /// Those of Table 8: friction 0.1, 0.5, 0.9 between beads, 0.4, 0.6, 0.8 at walls.
    Table8,
    /// Levels that the thesis lacks: between those, and walls down to 0.1.
    Between,
    /// Those of Table 8 by the laws that EDEM documents: the tangential spring as a whole with new
    /// stiffness, rolling torque against each bead's own spin.
    EdemLaws,
    /// The same with [`MORE`] times as many beads.
    Fuller,
    /// Those of Table 8 by our laws with [`MORE`] times as many beads.
    OursFuller,
    /// By EDEM's laws with radii between the limits that Table 6 prints.
    Limits,
    /// By EDEM's laws with radii that scatter by as much.
    Deviation,
    /// By EDEM's laws in a drum of 240 mm inside.
    Tube,
    /// Those of Table 8 by our laws in a drum of 240 mm inside.
    OursTube,
}

impl Design {
    /// Lines of the plan of Table 8 and what stands in their place.
    const fn changes(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Self::Table8 => &[],
            Self::Between => &[
                ("factors.friction.pp = [0.1, 0.5, 0.9]", "factors.friction.pp = [0.25, 0.7]"),
                (
                    "factors.friction.mantle = [0.4, 0.6, 0.8]",
                    "factors.friction.mantle = [0.1, 0.5]",
                ),
            ],
            Self::EdemLaws => &EDEM_LAWS,
            Self::Fuller => &[EDEM_LAWS[0], EDEM_LAWS[1], FULLER],
            Self::OursFuller => &[FULLER],
            Self::Limits => &[EDEM_LAWS[0], EDEM_LAWS[1], LIMITS],
            Self::Deviation => &[EDEM_LAWS[0], EDEM_LAWS[1], DEVIATION[0], DEVIATION[1]],
            Self::Tube => &[EDEM_LAWS[0], EDEM_LAWS[1], TUBE],
            Self::OursTube => &[TUBE],
        }
    }

    fn folder(self, config: &str) -> PathBuf {
        let suffix = match self {
            Self::Table8 => "",
            Self::Between => "-between",
            Self::EdemLaws => "-edem-laws",
            Self::Fuller => "-edem-laws-fuller",
            Self::OursFuller => "-fuller",
            Self::Limits => "-edem-laws-limits",
            Self::Deviation => "-edem-laws-spread",
            Self::Tube => "-edem-laws-tube",
            Self::OursTube => "-tube",
        };
        crate::root().join(format!("target/reproduce/{}{suffix}", config.to_lowercase()))
    }

    /// The campaign, begun or gone on with.
    fn campaign(self, config: &str) -> anyhow::Result<Campaign> {
        let file = format!("thesis/plans/{}.toml", config.to_lowercase());
        let mut text = fixture(&file)?.to_owned();
        for (old, new) in self.changes() {
            anyhow::ensure!(text.contains(old), "{file} has no line `{old}`");
            text = text.replace(old, new);
        }
        let manifest = Manifest::freeze(&file, &text, &Freeze::default())?;
        Ok(Campaign::begin(&self.folder(config), manifest)?)
    }
}

/// Four responses, deg, deg, % R, % R.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reading {
    pub(crate) mean: [f64; 4],
    /// Standard deviation of frames.
    pub(crate) sd: [f64; 4],
    /// Standard error of the mean.
    pub(crate) error: [f64; 4],
}

/// One setting at one speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OwnRow {
    pub(crate) omega_rpm: f64,
    pub(crate) mu_wall: f64,
    pub(crate) mu_pp: f64,
    /// Angles as photographs are read.
    pub(crate) photograph: Reading,
    /// Angles as EDEM's pictures were read.
    pub(crate) edem: Reading,
}

fn reading(seen: [Seen; 4]) -> Reading {
    Reading {
        mean: seen.map(|s| s.mean),
        sd: seen.map(|s| s.sd.unwrap_or(f64::NAN)),
        error: seen.map(|s| s.sd.unwrap_or(f64::NAN) / s.n_eff.unwrap_or(1.0).sqrt()),
    }
}

/// What a design has shown when all that is not there yet is simulated, `jobs` at a time; with none at a
/// time what is there.
pub(crate) fn simulate(config: &str, design: Design, jobs: usize) -> anyhow::Result<Vec<OwnRow>> {
    let campaign = design.campaign(config)?;
    if jobs > 0 {
        carry_out(&campaign, config, jobs)?;
    }
    rows(&campaign)
}

fn carry_out(campaign: &Campaign, config: &str, jobs: usize) -> anyhow::Result<()> {
    let how = RunOptions { jobs, ..RunOptions::default() };
    campaign.run(&how, &AtomicBool::new(false), |event| match event {
        Event::Started { index, resumed } => {
            eprintln!("{config}: run {index} {}", if *resumed { "goes on" } else { "begins" });
        }
        Event::Ended { index, failure, effort } => match failure {
            Some(f) => eprintln!("{config}: run {index} failed: {}", f.reason),
            None => eprintln!("{config}: run {index} took {:.0} s", effort.wall_s),
        },
        Event::Progress { .. } | Event::Stopped { .. } => {}
    })?;
    campaign.collect()?;
    Ok(())
}

/// The settings that are done.
fn rows(campaign: &Campaign) -> anyhow::Result<Vec<OwnRow>> {
    let manifest = campaign.manifest();
    let place = |path: &str| {
        let at = manifest.factors().iter().position(|f| f == path);
        at.with_context(|| format!("the plan does not vary {path}"))
    };
    let (wall, pp) = (place("friction.mantle")?, place("friction.pp")?);
    let mut out = Vec::new();
    for row in manifest.rows() {
        let RowState::Ended(result) = campaign.state(row)? else { continue };
        let RowOutcome::Done(done) = result.outcome else { continue };
        let seen = |s: &SpeedResult| Some((s.responses?.all(), s.responses_edem?.all()));
        out.extend(done.speeds.iter().filter_map(|s| {
            let (photograph, edem) = seen(s)?;
            Some(OwnRow {
                omega_rpm: s.omega_rpm,
                mu_wall: row.values[wall],
                mu_pp: row.values[pp],
                photograph: reading(photograph),
                edem: reading(edem),
            })
        }));
    }
    Ok(out)
}

/// Runs by our laws that are kept as tables of responses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// As the thesis prints the drum.
    Printed,
    /// With [`MORE`] times as many beads.
    Fuller,
    /// In a drum of 240 mm inside.
    Tube,
}

impl Kept {
    /// Path of a configuration's table below `fixtures/`.
    pub(super) fn table(self, config: &str) -> String {
        let suffix = match self {
            Self::Printed => "",
            Self::Fuller => "_fuller",
            Self::Tube => "_tube",
        };
        format!("own/{config}{suffix}.csv")
    }

    /// Option of `reproduce --dem` that simulates them.
    const fn option(self) -> &'static str {
        match self {
            Self::Printed => "--between",
            Self::Fuller => "--beads",
            Self::Tube => "--tube",
        }
    }

    const fn designs(self) -> &'static [Design] {
        match self {
            Self::Printed => &[Design::Table8, Design::Between],
            Self::Fuller => &[Design::OursFuller],
            Self::Tube => &[Design::OursTube],
        }
    }
}

/// Write what was simulated so far as a table of responses.
pub(super) fn keep(config: &str, which: Kept) -> anyhow::Result<()> {
    let how = format!("cargo xtask reproduce --dem {config} {}", which.option());
    write(&which.table(config), config, &how, which.designs())
}

fn write(path: &str, config: &str, how: &str, designs: &[Design]) -> anyhow::Result<()> {
    let mut text = format!(
        "# source: Tumble's own simulation of configuration {config}: `{how}`;\n\
         # angles as photographs are read, mean and standard deviation over the frames of one run\n\
         run,omega_rpm,mu_wall,mu_pp"
    );
    for r in Response::ALL {
        let _ = write!(text, ",{},{}", r.column(), r.sd_column());
    }
    text.push('\n');
    let mut all = Vec::new();
    for design in designs {
        if design.folder(config).join("manifest.json").exists() {
            all.extend(rows(&design.campaign(config)?)?);
        }
    }
    if all.is_empty() {
        return Ok(());
    }
    for (k, row) in all.iter().enumerate() {
        let run = k + 1;
        let _ = write!(text, "{run},{},{},{}", row.omega_rpm, row.mu_wall, row.mu_pp);
        for r in 0..4 {
            let _ = write!(text, ",{:.3},{:.3}", row.photograph.mean[r], row.photograph.sd[r]);
        }
        text.push('\n');
    }
    crate::write_whole(&crate::root().join("fixtures").join(path), &text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_change_by_what_is_said_of_them() {
        assert_eq!(FULLER.1, format!("{}scale = {MORE}\n", FULLER.0));
        let spread = format!("spread = {:.3}\n", 0.3 / 3.0 / 3f64.sqrt());
        assert!(LIMITS.1.contains(&spread), "{spread}");
        for plan in ["thesis/plans/az1.toml", "thesis/plans/az2.toml"] {
            let text = fixture(plan).unwrap();
            for design in
                [Design::Limits, Design::Deviation, Design::Fuller, Design::Between, Design::Tube]
            {
                assert!(design.changes().iter().all(|(old, _)| text.contains(old)), "{plan}");
            }
        }
    }
}
