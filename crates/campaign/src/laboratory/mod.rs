//! Simulated experiments on demand, several at a time, each kept by the hash of its content.
//!
//! Two levels are kept: the motion (physics, seed, sampling) and the measured row (motion, camera,
//! reader). A rig that differs from an earlier one in camera or reader alone is filmed again, not
//! simulated again. Rows do not depend on the number of workers, on their order, nor on whether they
//! were just made or read back.

mod footage;
pub(crate) mod key;
mod run;
mod store;

use std::collections::HashMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Instant;

use drum_rig::{Experiment, Flow, Options, Outcome};
use rig_schema::Rig;

pub use footage::Footage;
pub use run::{Run, SpeedRow};
use store::Store;

use crate::{CampaignError, Observatory, Resolution};

/// Motions above this size are not kept, bytes.
const LARGEST_KEPT: usize = 64 << 20;

/// How experiments are sampled, the same for all of a laboratory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampling {
    /// Size of frames and fineness of exposures.
    pub resolution: Resolution,
    /// Time from frame to frame, s; [`Options::frame_interval_s`].
    pub frame_interval_s: Option<f64>,
    /// [`Options::window_turns`].
    pub window_turns: f64,
    /// [`Options::least_window_s`].
    pub least_window_s: Option<f64>,
}

impl Default for Sampling {
    fn default() -> Self {
        let o = Options::default();
        Self {
            resolution: Resolution::default(),
            frame_interval_s: o.frame_interval_s,
            window_turns: o.window_turns,
            least_window_s: o.least_window_s,
        }
    }
}

/// Told after every experiment, in the order in which they end.
#[derive(Debug, Clone, Copy)]
pub struct Done<'a> {
    /// Place in the list that was asked for.
    pub index: usize,
    /// Its row, or why there is none.
    pub run: Result<&'a Run, &'a CampaignError>,
    /// Whether it was there already.
    pub kept: bool,
}

/// Where simulated experiments are made and kept.
#[derive(Debug)]
pub struct Laboratory {
    store: Store,
    jobs: usize,
    sampling: Sampling,
    stop: AtomicBool,
}

impl Laboratory {
    /// Open a laboratory whose results are kept in `folder`, with `jobs` workers.
    ///
    /// # Errors
    /// [`CampaignError::Unwritable`].
    pub fn open(folder: &Path, jobs: usize, sampling: Sampling) -> Result<Self, CampaignError> {
        let store = Store::open(folder)?;
        Ok(Self { store, jobs: jobs.max(1), sampling, stop: AtomicBool::new(false) })
    }

    /// How experiments are sampled here.
    pub fn sampling(&self) -> Sampling {
        self.sampling
    }

    /// Number of workers.
    pub fn jobs(&self) -> usize {
        self.jobs
    }

    /// Ask the workers to stop as soon as they can; what is under way is given up.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether a stop was asked for.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The row of a rig if it is kept already.
    ///
    /// # Errors
    /// A camera or reader that cannot be set up, a kept file that cannot be read.
    pub fn kept(&self, rig: &Rig) -> Result<Option<Run>, CampaignError> {
        let observatory = Observatory::new(rig, self.sampling.resolution)?;
        let motion = key::motion(rig, &self.options(&observatory));
        self.kept_row(&self.row_key(&motion, rig))
    }

    /// Run all rigs; the results are in the order of `rigs`. Rigs that are equal are run once.
    pub fn run(
        &self,
        rigs: &[Rig],
        mut done: impl FnMut(Done<'_>),
    ) -> Vec<Result<Run, CampaignError>> {
        let next = AtomicUsize::new(0);
        let (sender, receiver) = mpsc::channel();
        let mut results: Vec<Option<Result<Run, CampaignError>>> = Vec::new();
        results.resize_with(rigs.len(), || None);
        let mut first: HashMap<String, usize> = HashMap::new();
        let same: Vec<Option<usize>> = rigs
            .iter()
            .enumerate()
            .map(|(k, rig)| {
                let place = *first.entry(format!("{rig:?}")).or_insert(k);
                (place != k).then_some(place)
            })
            .collect();
        // Workers that would have nothing to do help with what there is: threads do not change a bit.
        let distinct = same.iter().filter(|s| s.is_none()).count();
        let threads = (self.jobs / distinct.max(1)).max(1);
        std::thread::scope(|scope| {
            for _ in 0..self.jobs.min(rigs.len()) {
                let sender = sender.clone();
                let (next, same) = (&next, &same);
                scope.spawn(move || {
                    loop {
                        let k = next.fetch_add(1, Ordering::Relaxed);
                        let Some(rig) = rigs.get(k) else { break };
                        if same[k].is_some() {
                            continue;
                        }
                        if sender.send((k, self.one(rig, threads))).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            for (k, outcome) in receiver {
                let (run, kept) = match outcome {
                    Ok((run, kept)) => (Ok(run), kept),
                    Err(e) => (Err(e), false),
                };
                done(Done { index: k, run: run.as_ref(), kept });
                results[k] = Some(run);
            }
        });
        for k in 0..rigs.len() {
            if let Some(place) = same[k] {
                let twin = match &results[place] {
                    Some(Ok(run)) => Ok(run.clone()),
                    _ => Err(CampaignError::Twin { index: place }),
                };
                done(Done { index: k, run: twin.as_ref(), kept: true });
                results[k] = Some(twin);
            }
        }
        results.into_iter().map(|r| r.unwrap_or(Err(CampaignError::Stopped))).collect()
    }

    fn options(&self, observatory: &Observatory) -> Options {
        Options {
            frame_interval_s: self.sampling.frame_interval_s,
            window_turns: self.sampling.window_turns,
            least_window_s: self.sampling.least_window_s,
            ..observatory.options(1)
        }
    }

    fn row_key(&self, motion: &blake3::Hash, rig: &Rig) -> blake3::Hash {
        key::responses(motion, rig, self.sampling.resolution, rig.run.frames as usize)
    }

    fn kept_row(&self, key: &blake3::Hash) -> Result<Option<Run>, CampaignError> {
        let path = self.store.row(key);
        let Some(bytes) = self.store.read(&path)? else { return Ok(None) };
        // A row that cannot be read is made anew: it is only a copy of what can be computed.
        Ok(serde_json::from_slice(&bytes).ok())
    }

    fn one(&self, rig: &Rig, threads: usize) -> Result<(Run, bool), CampaignError> {
        if self.is_stopped() {
            return Err(CampaignError::Stopped);
        }
        let begun = Instant::now();
        let observatory = Observatory::new(rig, self.sampling.resolution)?;
        let options = Options { threads, ..self.options(&observatory) };
        let motion = key::motion(rig, &options);
        let key = self.row_key(&motion, rig);
        if let Some(run) = self.kept_row(&key)? {
            return Ok((run, true));
        }
        let (speeds, steps, particles) = self.footage(rig, &options, &motion)?;
        let mut rows = Vec::new();
        for footage in &speeds {
            if self.is_stopped() {
                return Err(CampaignError::Stopped);
            }
            rows.push(SpeedRow::seen(&observatory, footage)?);
        }
        let run = Run {
            key: key.to_hex().to_string(),
            speeds: rows,
            steps,
            particles,
            cost_s: begun.elapsed().as_secs_f64(),
        };
        let text = serde_json::to_vec_pretty(&run)
            .map_err(|source| CampaignError::Json { what: "a row", source })?;
        self.store.write(&self.store.row(&key), &text)?;
        Ok((run, false))
    }

    /// The motion of a rig, kept or simulated: footage, steps, particles.
    fn footage(
        &self,
        rig: &Rig,
        options: &Options,
        key: &blake3::Hash,
    ) -> Result<(Vec<Footage>, u64, usize), CampaignError> {
        let path = self.store.motion(key);
        if let Some(bytes) = self.store.read(&path)?
            && let Ok(speeds) = footage::unpack(&bytes, &path.display().to_string())
        {
            let particles = speeds.first().map_or(0, |f| f.radii.len() / f.per_body as usize);
            return Ok((speeds, 0, particles));
        }
        let mut drum = Experiment::new(rig, options)?;
        let particles = drum.grains().len();
        let outcome = drum.run(|_, _| if self.is_stopped() { Flow::Stop } else { Flow::Go })?;
        if outcome == Outcome::Stopped {
            return Err(CampaignError::Stopped);
        }
        let steps = drum.progress().steps;
        let speeds: Vec<Footage> = drum.into_sampled().iter().map(Footage::of).collect();
        let bytes = footage::pack(&speeds);
        if bytes.len() <= LARGEST_KEPT {
            self.store.write(&path, &bytes)?;
        }
        Ok((speeds, steps, particles))
    }
}
