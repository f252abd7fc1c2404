//! Carrying out the runs of a campaign on worker threads.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::time::{Duration, Instant};

use drum_rig::Flow;

use super::campaign::Campaign;
use super::file;
use super::lock::Share;
use super::manifest::Row;
use super::result::{Effort, FORMAT, Failure, FailureClass, RowOutcome, RowResult};
use super::row::{Left, RowRun};
use crate::CampaignError;

/// Least time between two reports of one run.
const REPORT_EVERY: Duration = Duration::from_millis(200);
/// Wait before the second attempt; each next one waits twice as long.
const FIRST_WAIT: Duration = Duration::from_millis(200);

/// How a campaign is run; nothing here changes a result.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunOptions {
    /// Worker threads, each with one simulation at a time.
    pub jobs: usize,
    /// Time between two checkpoints of a run.
    pub checkpoint_every: Duration,
    /// Attempts at a run whose reading or writing fails.
    pub attempts: u32,
    /// Also try runs again that failed for good.
    pub retry_failed: bool,
}

impl Default for RunOptions {
    /// One worker, a checkpoint every ten seconds, three attempts.
    fn default() -> Self {
        Self {
            jobs: 1,
            checkpoint_every: Duration::from_secs(10),
            attempts: 3,
            retry_failed: false,
        }
    }
}

/// What a caller hears while a campaign is run.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A run begins, or goes on from a checkpoint.
    Started {
        /// Number of the run.
        index: u64,
        /// Whether it goes on.
        resumed: bool,
    },
    /// A run goes on.
    Progress {
        /// Number of the run.
        index: u64,
        /// Steps done.
        steps: u64,
        /// Fewest steps that are still to come.
        least_steps_left: u64,
    },
    /// A run ended.
    Ended {
        /// Number of the run.
        index: u64,
        /// Why it failed, if it did.
        failure: Option<Failure>,
        /// What it cost.
        effort: Effort,
    },
    /// A run was stopped and keeps its checkpoint.
    Stopped {
        /// Number of the run.
        index: u64,
    },
}

/// How a call of [`Campaign::run`] ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Summary {
    /// Runs with responses, those of earlier calls included.
    pub done: Vec<u64>,
    /// Runs that failed.
    pub failed: Vec<(u64, Failure)>,
    /// Runs without a result.
    pub open: Vec<u64>,
    /// Runs that were carried out by this call.
    pub carried_out: usize,
}

/// Runs of one motion.
struct Group<'r> {
    /// Those to be carried out.
    due: Vec<&'r Row>,
    /// All that the plan has.
    all: Vec<&'r Row>,
}

impl Campaign {
    /// Carry out every run that has no result yet.
    ///
    /// A run that fails does not stop the others. When `stop` becomes true, every worker writes its
    /// checkpoint and ends; the same call later goes on. The results do not depend on the number of
    /// workers, nor on how often a campaign was stopped or killed.
    ///
    /// # Errors
    /// [`CampaignError::Locked`] while another process is at this campaign; errors of the folder itself.
    /// What is wrong with single runs is in the summary.
    pub fn run(
        &self,
        how: &RunOptions,
        stop: &AtomicBool,
        heard: impl FnMut(&Event),
    ) -> Result<Summary, CampaignError> {
        check(how)?;
        let _alone = self.lock(Share::Alone)?;
        file::sweep(&self.rows_folder())?;
        let mut due = Vec::new();
        for row in self.manifest().rows() {
            if self.is_due(row, how.retry_failed)? {
                due.push(row);
            }
        }
        self.carry_out(&due, how, stop, heard)?;
        self.summary(due.len())
    }

    /// Carry out one run, beside other processes that carry out others.
    ///
    /// # Errors
    /// As [`Campaign::run`]; [`CampaignError::Locked`] also while another process is at this run,
    /// [`CampaignError::NoSuchRun`].
    pub fn run_one(
        &self,
        index: u64,
        how: &RunOptions,
        stop: &AtomicBool,
        heard: impl FnMut(&Event),
    ) -> Result<Summary, CampaignError> {
        check(how)?;
        let row = self.manifest().row(index)?;
        let _shared = self.lock(Share::Shared)?;
        let due: Vec<&Row> =
            if self.is_due(row, how.retry_failed)? { vec![row] } else { Vec::new() };
        self.carry_out(&due, how, stop, heard)?;
        self.summary(due.len())
    }

    fn carry_out(
        &self,
        due: &[&Row],
        how: &RunOptions,
        stop: &AtomicBool,
        mut heard: impl FnMut(&Event),
    ) -> Result<(), CampaignError> {
        let next = AtomicUsize::new(0);
        let (tell, listen) = channel();
        let groups = self.by_motion(due)?;
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..how.jobs.min(groups.len()))
                .map(|_| {
                    let tell = tell.clone();
                    let (next, groups) = (&next, &groups);
                    scope.spawn(move || -> Result<(), CampaignError> {
                        while !stop.load(Ordering::Relaxed) {
                            let at = next.fetch_add(1, Ordering::Relaxed);
                            let Some(group) = groups.get(at) else { break };
                            for row in &group.due {
                                if stop.load(Ordering::Relaxed) {
                                    break;
                                }
                                self.one(row, &group.all, how, stop, &tell)?;
                            }
                        }
                        Ok(())
                    })
                })
                .collect();
            drop(tell);
            for event in listen {
                heard(&event);
            }
            for worker in workers {
                worker.join().map_err(|_| CampaignError::Fault {
                    detail: "a worker ended without a word".to_owned(),
                })??;
            }
            Ok(())
        })
    }

    /// The runs that are due, those of one motion together: the first simulates it for all.
    fn by_motion<'r>(&'r self, due: &[&'r Row]) -> Result<Vec<Group<'r>>, CampaignError> {
        let mut groups: Vec<Group<'r>> = Vec::new();
        for &row in due {
            let place = groups.iter().position(|g| g.all.iter().any(|r| r.index == row.index));
            match place {
                Some(k) => groups[k].due.push(row),
                None => {
                    let all = self.manifest().of_one_motion(row)?;
                    groups.push(Group { due: vec![row], all });
                }
            }
        }
        Ok(groups)
    }

    /// One run with its attempts, to a result or a checkpoint; `all` are those of its motion.
    fn one(
        &self,
        row: &Row,
        all: &[&Row],
        how: &RunOptions,
        stop: &AtomicBool,
        tell: &Sender<Event>,
    ) -> Result<(), CampaignError> {
        let _lock = self.lock_row(row)?;
        // Another process may have ended this run since it was looked at.
        if !self.is_due(row, how.retry_failed)? {
            return Ok(());
        }
        let index = row.index;
        let checkpoint = self.checkpoint_path(row);
        // The caller may have stopped listening: then nobody needs to hear.
        let say = |event| drop(tell.send(event));
        say(Event::Started { index, resumed: checkpoint.exists() });
        let motion = (all.len() > 1).then(|| self.motion_path(all[0]));
        let manifest = self.manifest();
        let run = RowRun { manifest, row, checkpoint, motion, every: how.checkpoint_every };
        let mut wait = FIRST_WAIT;
        let mut attempts = 0;
        let (outcome, effort) = loop {
            attempts += 1;
            let mut told = Instant::now();
            let left = guarded(|| {
                run.carry_out(|p| {
                    if told.elapsed() >= REPORT_EVERY {
                        told = Instant::now();
                        let (steps, least_steps_left) = (p.steps, p.least_steps_left);
                        say(Event::Progress { index, steps, least_steps_left });
                    }
                    if stop.load(Ordering::Relaxed) { Flow::Stop } else { Flow::Go }
                })
            });
            match left {
                Ok(Left::Done(simulated, effort)) => break (RowOutcome::Done(simulated), effort),
                Ok(Left::Stopped) => {
                    say(Event::Stopped { index });
                    return Ok(());
                }
                Err(error) => {
                    let class = FailureClass::of(&error);
                    if class == FailureClass::Io && attempts < how.attempts {
                        std::thread::sleep(wait);
                        wait *= 2;
                        continue;
                    }
                    let failure = Failure { class, reason: chain(&error), attempts };
                    break (RowOutcome::Failed(failure), Effort::default());
                }
            }
        };
        let failure = match &outcome {
            RowOutcome::Failed(failure) => Some(failure.clone()),
            RowOutcome::Done(_) => None,
        };
        let values = self.manifest().factors().iter().cloned().zip(row.values.iter().copied());
        let result = RowResult {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            index,
            hash: row.hash.clone(),
            values: values.collect(),
            seed: row.seed,
            outcome,
            effort,
        };
        self.write_result(row, &result)?;
        // What may pass keeps its checkpoint; what is altered is left for people to look at.
        if failure.as_ref().is_none_or(|f| !f.class.passes()) {
            self.remove_checkpoint(row)?;
        }
        self.forget_motion(all)?;
        say(Event::Ended { index, failure, effort });
        Ok(())
    }

    fn summary(&self, due: usize) -> Result<Summary, CampaignError> {
        let mut summary = Summary::default();
        for row in self.manifest().rows() {
            match self.state(row)? {
                super::RowState::Ended(result) => match result.outcome {
                    RowOutcome::Done(_) => summary.done.push(row.index),
                    RowOutcome::Failed(failure) => summary.failed.push((row.index, failure)),
                },
                super::RowState::Open | super::RowState::Begun => summary.open.push(row.index),
            }
        }
        summary.carried_out = due;
        Ok(summary)
    }
}

fn check(how: &RunOptions) -> Result<(), CampaignError> {
    let refuse = |name, expected| Err(CampaignError::Option { name, value: 0.0, expected });
    if how.jobs == 0 {
        return refuse("jobs", "at least 1");
    }
    if how.attempts == 0 {
        return refuse("attempts", "at least 1");
    }
    Ok(())
}

/// A panic in one run is that run's failure.
fn guarded<T>(run: impl FnOnce() -> Result<T, CampaignError>) -> Result<T, CampaignError> {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|cause| {
        let words = cause.downcast_ref::<String>().map(String::as_str);
        let words = words.or_else(|| cause.downcast_ref::<&str>().copied());
        Err(CampaignError::Fault { detail: words.unwrap_or("no message").to_owned() })
    })
}

/// An error with its causes, without saying anything twice.
fn chain(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(e) = cause {
        let words = e.to_string();
        if !text.contains(&words) {
            text = format!("{text}: {words}");
        }
        cause = e.source();
    }
    text
}
