//! The comparison: skins tuned, then all codes in turn, round by round.

use std::collections::BTreeMap;

use super::code::{Code, Installed, Run, Task};
use super::physics::Bed;
use super::report::{Absent, Entry, Report, Tried, Workload};
use super::scene::{DT_S, Scene};
use super::spread::Spread;
use super::tuning::fastest;
use super::{Peers, folder, load, machine, report, settled, worker};

/// Largest difference of contacts a particle between a code and Tumble.
const SAME_WORK: f64 = 0.02;

/// One line of the comparison: a code and the threads it gets.
type Lane = (Code, usize);

/// Ratios of one code to Tumble, round by round: by processor time and by wall time.
type Ratios = (Vec<f64>, Vec<f64>);

/// Run everything and print it.
pub(crate) fn run(options: &Peers) -> anyhow::Result<()> {
    let load_before = load();
    let scene = Scene::similar(options.particles);
    let (data, beads) = settled(&scene, options.settle)?;
    let folder = folder()?;
    let task = Task {
        scene: &scene,
        data: &data,
        folder: &folder,
        warm: options.warm,
        steps: options.steps,
        mode: options.kernels,
    };
    let (mut installed, mut absent) = (Vec::new(), Vec::new());
    for code in Code::ALL {
        match code.find() {
            Ok(found) => installed.push(found),
            Err(why) => absent.push(Absent { code: code.name(), why }),
        }
    }
    let mut skins = BTreeMap::new();
    let mut tried = Vec::new();
    let short = Task { steps: options.tune_steps, warm: options.warm.min(500), ..task.clone() };
    installed.retain(|code| match tune(code, &short, &mut tried) {
        Ok(skin) => {
            skins.insert(code.code, skin);
            true
        }
        Err(error) => {
            absent.push(Absent { code: code.code.name(), why: format!("{error:#}") });
            false
        }
    });
    anyhow::ensure!(
        skins.contains_key(&Code::Tumble) && skins.contains_key(&Code::TumbleNoRolling),
        "Tumble itself failed: {}",
        absent.first().map_or("", |a| a.why.as_str())
    );
    let rounds = Rounds::take(&installed, &skins, &task, options.repeats)?;
    let mut report = rounds.report(&task, &skins);
    report.absent = absent;
    report.skins_tried = tried;
    report.start = Bed::of(&beads);
    report.machine = machine();
    report.load = [load_before, load()];
    let [dissipated, remainder] = worker::ledger(&task, skins[&Code::Tumble])?;
    report.ledger_mj = [1e3 * dissipated, 1e3 * remainder];
    report::print(&report, options.json, &folder.join("side_by_side.json"))
}

/// The fastest of five skins.
fn tune(code: &Installed, task: &Task<'_>, tried: &mut Vec<Tried>) -> anyhow::Result<f64> {
    let skins = code.code.skins();
    let (best, least) = fastest(skins, |skin| {
        let ns = processor_ns(&code.run(task, 1, skin)?, task);
        eprintln!("{}: skin {:.2} mm, {ns:.1} ns a particle-step", code.code.name(), 1e3 * skin);
        Ok(ns)
    })?;
    tried.extend(skins.into_iter().zip(least).map(|(skin, ns)| Tried {
        code: code.code.name(),
        skin_mm: 1e3 * skin,
        ns_per_particle_step: ns,
    }));
    Ok(best)
}

fn particle_steps(task: &Task<'_>) -> f64 {
    task.steps as f64 * task.scene.beads as f64
}

fn wall_ns(run: &Run, task: &Task<'_>) -> f64 {
    run.told.loop_s * 1e9 / particle_steps(task)
}

fn processor_ns(run: &Run, task: &Task<'_>) -> f64 {
    run.busy * wall_ns(run, task)
}

/// All runs of all rounds.
struct Rounds {
    lanes: BTreeMap<Lane, Vec<Run>>,
    /// Two independent Tumble processes at once, one thread each: both loop times, s.
    pairs: Vec<[f64; 2]>,
}

impl Rounds {
    fn take(
        installed: &[Installed],
        skins: &BTreeMap<Code, f64>,
        task: &Task<'_>,
        repeats: usize,
    ) -> anyhow::Result<Self> {
        let mut all = Self { lanes: BTreeMap::new(), pairs: Vec::new() };
        for round in 0..repeats {
            let mut order: Vec<(&Installed, usize)> = installed.iter().map(|c| (c, 1)).collect();
            order.extend(installed.iter().filter(|c| c.code == Code::Tumble).map(|c| (c, 2)));
            for (code, threads) in order {
                let run = code.run(task, threads, skins[&code.code])?;
                eprintln!(
                    "round {}: {} on {threads}: wall {:.1}, processor {:.1} ns a particle-step",
                    round + 1,
                    code.code.name(),
                    wall_ns(&run, task),
                    processor_ns(&run, task)
                );
                all.lanes.entry((code.code, threads)).or_default().push(run);
            }
            if let Some(tumble) = installed.iter().find(|c| c.code == Code::Tumble) {
                let skin = skins[&Code::Tumble];
                let first = tumble.start(task, 1, skin, "_a")?;
                let second = tumble.start(task, 1, skin, "_b")?;
                let times = [first.finish()?.told.loop_s, second.finish()?.told.loop_s];
                eprintln!("round {}: two processes at once: {times:.3?} s", round + 1);
                all.pairs.push(times);
            }
        }
        Ok(all)
    }

    fn ratios_to_tumble(&self, code: Code, task: &Task<'_>) -> Ratios {
        let ours = &self.lanes[&(Code::Tumble, 1)];
        let theirs = &self.lanes[&(code, 1)];
        let by = |of: fn(&Run, &Task<'_>) -> f64| {
            theirs.iter().zip(ours).map(|(t, o)| of(t, task) / of(o, task)).collect()
        };
        (by(processor_ns), by(wall_ns))
    }

    fn report(&self, task: &Task<'_>, skins: &BTreeMap<Code, f64>) -> Report {
        let beads = task.scene.beads as f64;
        let contacts =
            |runs: &[Run]| Spread::of(runs.iter().map(|r| r.told.contacts)).median / beads;
        let of = |code: Code| contacts(&self.lanes[&(code, 1)]);
        let mut entries = Vec::new();
        for ((code, threads), runs) in &self.lanes {
            let wall = Spread::of(runs.iter().map(|r| wall_ns(r, task)));
            let processor = Spread::of(runs.iter().map(|r| processor_ns(r, task)));
            let told = &runs[0].told;
            let own = contacts(runs);
            let reference = of(code.reference());
            entries.push(Entry {
                code: code.name(),
                version: told.version.clone(),
                threads: *threads,
                // Several threads work in less wall time than processor time.
                ns_per_particle_step: if *threads == 1 { processor.median } else { wall.median },
                spread: if *threads == 1 { processor.half_range() } else { wall.half_range() },
                wall_ns: wall,
                processor_ns: processor,
                particle_steps_per_s: 1e9 / wall.median,
                ns_per_contact: wall.median.min(processor.median) / own,
                contacts_per_particle: own,
                list_pairs_per_particle: told.list_pairs / beads,
                steps_per_list: task.steps as f64 / told.builds.max(1.0),
                skin_mm: 1e3 * skins[code],
                same_contacts: (own / reference - 1.0).abs() <= SAME_WORK,
                contacts_off_percent: 100.0 * (own / reference - 1.0),
                end: Bed::of(&runs[0].beads),
            });
        }
        let ratio = |code: Code| {
            self.lanes.contains_key(&(code, 1)).then(|| {
                let (processor, wall) = self.ratios_to_tumble(code, task);
                [Spread::of(processor), Spread::of(wall)]
            })
        };
        let one = &self.lanes[&(Code::Tumble, 1)];
        let two = &self.lanes[&(Code::Tumble, 2)];
        let raw = Spread::of(one.iter().zip(two).map(|(a, b)| a.told.loop_s / b.told.loop_s));
        // Rate of one run on two threads over half the rate of two runs side by side.
        let normalised = Spread::of(
            two.iter()
                .zip(&self.pairs)
                .map(|(b, p)| (2.0 / b.told.loop_s) / (1.0 / p[0] + 1.0 / p[1])),
        );
        let same_bits = one.iter().chain(two).all(|r| r.beads == one[0].beads);
        Report {
            scene: Workload {
                particles: task.scene.beads,
                contacts_per_particle: of(Code::Tumble),
                dt: DT_S,
                steps: task.steps,
                warm: task.warm,
                repeats: one.len(),
                kernels: task.mode.name(),
            },
            runs: entries,
            ratios: [
                Code::TumbleExact,
                Code::LammpsHertzHistory,
                Code::LammpsGranular,
                Code::LammpsGranularNoRolling,
                Code::Liggghts,
            ]
            .map(|code| (code.name(), ratio(code))),
            two_threads: [raw, normalised],
            same_bits_on_1_and_2_threads: same_bits,
            ..Report::default()
        }
    }
}
