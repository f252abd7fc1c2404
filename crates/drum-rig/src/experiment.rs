//! The experiment: settle, turn, wait for the steady state, sample, at one speed after another.

use std::sync::Arc;

use dem_core::error::Partner;
use dem_core::glam::DVec3;
use dem_core::particles::ParticleId;
use dem_core::prelude::Drag;
use rig_schema::Rig;

use crate::assemble::{Assembly, assemble};
use crate::error::Error;
use crate::frame::{Exposure, Frame, Sampled, angle_deg};
use crate::grains::Grains;
use crate::options::Options;
use crate::regime::{Regime, froude};
use crate::schedule::{BETWEEN_TESTS, Stage, WINDOW};
use crate::script::{Phase, Record, Script};
use crate::stationary::{Comparison, Signal, mean_of};
use crate::{GRAVITY, codec};

/// Time between two looks at a settling bed, s.
const SETTLING_LOOK_S: f64 = 0.02;
/// Time after which a bed that does not settle is given up, s.
const LONGEST_SETTLING_S: f64 = 10.0;
/// Rest: mean kinetic energy of a particle below this share of its weight times its diameter.
const REST: f64 = 1e-3;
/// Drag at the start of the first speed over the angular frequency of a swinging bed.
const STARTING_DRAG: f64 = 1.0;

/// Where a run stands, told after every few steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What is being done.
    pub phase: Phase,
    /// Speed of the schedule, rpm.
    pub speed_rpm: f64,
    /// Its number in ascending order, from zero.
    pub speed_index: usize,
    /// Number of speeds.
    pub speeds: usize,
    /// Time, s.
    pub time_s: f64,
    /// Turns at this speed so far.
    pub turns: f64,
    /// Direction of the centre of mass from the vertical now, degrees.
    pub angle_deg: f64,
    /// Frames at hand at this speed.
    pub frames_done: usize,
    /// Frames wanted at each speed.
    pub frames: usize,
    /// Whether a frame has just become complete; those of an approach that turns out not to have
    /// been steady yet are left out of [`Sampled::frames`].
    pub new_frame: bool,
    /// Steps done.
    pub steps: u64,
    /// Fewest steps that are still to come: a lower bound, since the steady state may take longer.
    pub least_steps_left: u64,
}

/// Whether to go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flow {
    /// Go on.
    Go,
    /// Stop here; [`Experiment::checkpoint`] keeps what was done.
    Stop,
}

/// How [`Experiment::run`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// All speeds are done.
    Finished,
    /// The caller asked to stop.
    Stopped,
}

/// A particle as it moves now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParticleState {
    /// Centre of mass, m.
    pub position: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
    /// Angular velocity, rad/s.
    pub spin: DVec3,
    /// Force of contacts, gaps and drag together (mass times acceleration less weight), N.
    pub force: DVec3,
    /// Mass, kg.
    pub mass: f64,
    /// Contacts with other particles.
    pub contacts: u32,
    /// Contacts with walls.
    pub wall_contacts: u32,
}

/// A contact as it is now.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactState {
    /// Centre of the first particle's sphere, m.
    pub from: DVec3,
    /// Centre of the other's sphere, or the point of the wall, m.
    pub to: DVec3,
    /// Force on the first particle, N.
    pub force: DVec3,
    /// Number of the first particle.
    pub particle: u32,
    /// Number of the other particle; `None` for a wall.
    pub other: Option<u32>,
}

/// A virtual rotating-drum experiment under way.
pub struct Experiment {
    assembly: Assembly,
    grains: Arc<Grains>,
    stages: Vec<Stage>,
    script: Script,
    fingerprint: blake3::Hash,
}

impl std::fmt::Debug for Experiment {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Experiment")
            .field("particles", &self.grains.len())
            .field("time_s", &self.time())
            .field("phase", &self.script.phase)
            .finish_non_exhaustive()
    }
}

impl Experiment {
    /// Build the drum of a rig and fill it.
    ///
    /// # Errors
    /// See [`Error`]: parameters that are missing or cannot act, particles that do not fit, a time
    /// step above its limit.
    pub fn new(rig: &Rig, options: &Options) -> Result<Self, Error> {
        options.check()?;
        let assembly = assemble(rig, options)?;
        let mut speeds = rig.run.speeds_rpm.clone();
        speeds.sort_by(f64::total_cmp);
        let stages = speeds
            .iter()
            .map(|&speed| {
                let scales = (assembly.dt, assembly.radius);
                Stage::new(speed, assembly.speed_scale, scales, rig.run.frames, options)
            })
            .collect();
        // Another camera at the same motion is the same experiment.
        let identity = format!("{:?} {}", rig.motion(), options.identity());
        Ok(Self {
            grains: Arc::new(assembly.grains.clone()),
            assembly,
            stages,
            script: Script::new(),
            fingerprint: blake3::hash(identity.as_bytes()),
        })
    }

    /// Take up an experiment from the bytes of [`Experiment::checkpoint`]; it goes on bit by bit as
    /// if it had not been stopped, with any number of threads. Names, camera and reader of the rig may be others.
    ///
    /// # Errors
    /// Those of [`Experiment::new`]; [`Error::Checkpoint`] for bytes that are cut short, altered or
    /// of another version; [`Error::OtherRig`] for another rig or other options.
    pub fn resume(rig: &Rig, options: &Options, checkpoint: &[u8]) -> Result<Self, Error> {
        let mut experiment = Self::new(rig, options)?;
        let (script, world) = codec::unpack(experiment.fingerprint, checkpoint)?;
        experiment.assembly.engine.restore(world)?;
        experiment.script = script;
        Ok(experiment)
    }

    /// Everything needed to go on later, as bytes with a version and a checksum.
    pub fn checkpoint(&self) -> Vec<u8> {
        codec::pack(self.fingerprint, &self.script, &self.assembly.engine.snapshot())
    }

    /// Run until all speeds are done or `progress` asks to stop.
    ///
    /// `progress` may look at the particles, for instance to write them where
    /// [`Progress::new_frame`] is set. What it does changes nothing.
    ///
    /// # Errors
    /// [`Error::Unsettled`], [`Error::NotSteady`], and faults of the mechanics. What was sampled
    /// before stays available.
    pub fn run(
        &mut self,
        mut progress: impl FnMut(&Self, &Progress) -> Flow,
    ) -> Result<Outcome, Error> {
        while self.script.phase != Phase::Done {
            let frames = self.frames_taken();
            match self.script.phase {
                Phase::Settling => self.settle()?,
                Phase::Approaching => self.approach()?,
                Phase::Sampling => self.sample()?,
                Phase::Done => {}
            }
            let mut report = self.progress();
            report.new_frame = self.frames_taken() > frames;
            if progress(self, &report) == Flow::Stop && self.script.phase != Phase::Done {
                return Ok(Outcome::Stopped);
            }
        }
        Ok(Outcome::Finished)
    }

    fn settle(&mut self) -> Result<(), Error> {
        let steps = ((SETTLING_LOOK_S / self.assembly.dt).round() as u64).max(1);
        self.assembly.engine.run(steps)?;
        let count = self.grains.len() as f64;
        let energy = self.assembly.engine.kinetic_energy() / count;
        let weight = self.grains.total_mass() / count * GRAVITY;
        let limit = REST * weight * 2.0 * self.grains.equivalent_radius();
        if energy <= limit && self.time() >= self.fall_time() {
            self.assembly.engine.set_gravity(self.assembly.gravity)?;
            self.script.started = self.step();
            return self.take_up_speed();
        }
        if self.time() > LONGEST_SETTLING_S + self.fall_time() {
            return Err(Error::Unsettled { time_s: self.time(), energy, limit });
        }
        Ok(())
    }

    /// Time to fall half a drum radius: a bed may be slow at first without being at rest.
    fn fall_time(&self) -> f64 {
        (self.assembly.radius / GRAVITY).sqrt()
    }

    fn take_up_speed(&mut self) -> Result<(), Error> {
        let Some(stage) = self.stages.get(self.script.records.len()).copied() else {
            self.script.phase = Phase::Done;
            return Ok(());
        };
        let since = (self.step() - self.script.started) as f64 * self.assembly.dt;
        for (wall, &turns) in self.assembly.turns.iter().enumerate() {
            let rate = if turns { stage.omega } else { 0.0 };
            let motion = self.assembly.drive.motion(rate, since);
            self.assembly.engine.set_motion(wall, motion)?;
        }
        self.script.records.push(Record { begun: self.step(), ..Record::default() });
        self.script.phase = Phase::Approaching;
        Ok(())
    }

    /// Go on by one instant, and see at each monitoring whether the motion has become steady.
    ///
    /// Frames are taken meanwhile: those of the windows that turn out to be steady count.
    fn approach(&mut self) -> Result<(), Error> {
        let stage = self.stages[self.script.speed()];
        self.damp_the_start(&stage)?;
        let monitored = self.advance(&stage)?;
        let radius = self.assembly.radius;
        let Some(record) = self.script.records.last_mut() else { return Ok(()) };
        let n = record.series.torque.len();
        let tested = n >= stage.lead + 2 * WINDOW && (n - stage.lead).is_multiple_of(BETWEEN_TESTS);
        if !monitored || !tested {
            return Ok(());
        }
        // A tenth of a percent of the radius, half a percent of the torque: below what frames show.
        let floor = 1e-3 * radius;
        let torque = mean_of(&record.series.torque[n - WINDOW..]).mean.abs();
        let signals = [
            (&record.series.torque, "torque", "N m", 5e-3 * torque),
            (&record.series.x, "centre of mass (x)", "m", floor),
            (&record.series.y, "centre of mass (y)", "m", floor),
        ];
        let compared = signals.map(|(series, name, unit, floor)| {
            Comparison::of(Signal { name, unit, floor }, series, WINDOW)
        });
        if compared.iter().all(Comparison::is_stationary) {
            record.steady = (n - 2 * WINDOW) as u64;
            let transient = stage.frames_begun_before(record.steady * stage.monitor);
            record.leave_out(transient.saturating_sub(record.left_out) as usize);
            self.script.phase = Phase::Sampling;
            return self.end_speed(&stage);
        }
        if n >= stage.patience {
            let worst = compared.iter().max_by(|a, b| a.sigmas.total_cmp(&b.sigmas));
            if let Some(c) = worst {
                return Err(Error::NotSteady {
                    speed_rpm: stage.speed_rpm,
                    turns: self.turns(),
                    signal: c.signal.name,
                    unit: c.signal.unit,
                    before: c.before,
                    after: c.after,
                    sigmas: c.sigmas,
                });
            }
        }
        Ok(())
    }

    /// A drag that fades before the first window keeps the first avalanche from swinging on.
    fn damp_the_start(&mut self, stage: &Stage) -> Result<(), Error> {
        let done = self.script.records.last().map_or(0, |r| r.series.torque.len());
        if self.script.records.len() != 1 || done > stage.lead {
            return Ok(());
        }
        let left = 1.0 - done as f64 / stage.lead as f64;
        let swing = (GRAVITY / self.assembly.radius).sqrt();
        let rate = self.assembly.drag + STARTING_DRAG * left * swing;
        let drag = (rate > 0.0).then_some(Drag::Uniform { rate });
        Ok(self.assembly.engine.set_drag(drag)?)
    }

    /// Go on to the next instant, and see whether all frames are there.
    fn sample(&mut self) -> Result<(), Error> {
        let stage = self.stages[self.script.speed()];
        self.advance(&stage)?;
        self.end_speed(&stage)
    }

    /// Take up the next speed if this one has all its frames.
    fn end_speed(&mut self, stage: &Stage) -> Result<(), Error> {
        let step = self.step();
        let Some(record) = self.script.records.last_mut() else { return Ok(()) };
        if record.complete(stage.sub_frames) < stage.frames {
            return Ok(());
        }
        record.close_with(stage.frames);
        record.ended = step;
        self.take_up_speed()
    }

    /// Go on to the next monitoring or instant of a frame, whichever comes first; whether it was a
    /// monitoring.
    fn advance(&mut self, stage: &Stage) -> Result<bool, Error> {
        let now = self.step();
        let Some(record) = self.script.records.last() else { return Ok(false) };
        let next_monitor =
            ((now - record.begun) / stage.monitor + 1) * stage.monitor + record.begun;
        let next = stage.due(record).min(next_monitor);
        self.assembly.engine.run(next.saturating_sub(now))?;
        let monitored = self.step() == next_monitor;
        if monitored {
            self.monitor()?;
        }
        while self.script.records.last().is_some_and(|r| stage.due(r) <= self.step()) {
            self.expose(stage);
        }
        Ok(monitored)
    }

    fn expose(&mut self, stage: &Stage) {
        let exposure = self.exposure();
        let (pairs, walls) = self.coordination();
        let dt = self.assembly.dt;
        let Some(record) = self.script.records.last_mut() else { return };
        let (number, sub) = record.next_instant(stage.sub_frames);
        if sub == 0 {
            let ends = [0, stage.sub_frames - 1].map(|sub| stage.instant(number, sub));
            let time_s = 0.5 * (2 * record.begun + ends[0] + ends[1]) as f64 * dt;
            record.frames.push(Frame { time_s, exposures: Vec::new() });
            record.coordination.push(pairs);
            record.wall_contacts.push(walls);
        }
        if let Some(frame) = record.frames.last_mut() {
            frame.exposures.push(exposure);
        }
        // No more than are wanted are kept while the motion is not steady yet.
        let surplus = record.complete(stage.sub_frames).saturating_sub(stage.frames);
        record.leave_out(surplus);
    }

    fn monitor(&mut self) -> Result<(), Error> {
        let mut on_walls = 0.0;
        for (wall, _) in self.assembly.turns.iter().enumerate().filter(|(_, t)| **t) {
            on_walls += self.assembly.engine.torque(wall)?;
        }
        let centre = self.centre_of_mass();
        let Some(record) = self.script.records.last_mut() else { return Ok(()) };
        let s = &mut record.series;
        s.torque.push(-on_walls);
        s.x.push(centre.x);
        s.y.push(centre.y);
        s.z.push(centre.z);
        s.angle_deg.push(angle_deg(centre));
        Ok(())
    }

    fn particles_of(&self) -> impl Iterator<Item = ParticleId> + use<> {
        (0..self.grains.len() as u32).map(ParticleId)
    }

    /// Centre of mass of the bed now, m.
    pub fn centre_of_mass(&self) -> DVec3 {
        let view = self.assembly.engine.view();
        let mut sum = DVec3::ZERO;
        let mut mass = 0.0;
        for id in self.particles_of() {
            let m = view.mass(id);
            sum += view.position(id) * m;
            mass += m;
        }
        sum / mass
    }

    /// Places of all particles now.
    pub fn exposure(&self) -> Exposure {
        let engine = &self.assembly.engine;
        let view = engine.view();
        let orientations = if self.grains.are_clumps() {
            self.particles_of().map(|id| engine.orientation(id)).collect()
        } else {
            Vec::new()
        };
        Exposure {
            time_s: view.time(),
            positions: self.particles_of().map(|id| view.position(id)).collect(),
            orientations,
        }
    }

    /// Mean number of contacts of a particle now: with others, with walls.
    pub fn coordination(&self) -> (f64, f64) {
        let (mut pairs, mut walls) = (0u64, 0u64);
        self.assembly.engine.view().for_each_contact(&mut |c| match c.partner {
            Partner::Particle(_) => pairs += 1,
            Partner::Wall(_) => walls += 1,
        });
        let n = self.grains.len() as f64;
        (2.0 * pairs as f64 / n, walls as f64 / n)
    }

    /// All particles now, by number.
    pub fn particles(&self) -> Vec<ParticleState> {
        let engine = &self.assembly.engine;
        let view = engine.view();
        let mut list: Vec<ParticleState> = self
            .particles_of()
            .map(|id| ParticleState {
                position: view.position(id),
                velocity: view.velocity(id),
                spin: engine.spin(id),
                force: (engine.acceleration(id) - self.assembly.gravity) * view.mass(id),
                mass: view.mass(id),
                contacts: 0,
                wall_contacts: 0,
            })
            .collect();
        view.for_each_contact(&mut |c| match c.partner {
            Partner::Particle(other) => {
                list[c.particle.0 as usize].contacts += 1;
                list[other.0 as usize].contacts += 1;
            }
            Partner::Wall(_) => list[c.particle.0 as usize].wall_contacts += 1,
        });
        list
    }

    /// All contacts now.
    pub fn contacts(&self) -> Vec<ContactState> {
        let mut list = Vec::new();
        self.assembly.engine.view().for_each_contact(&mut |c| {
            list.push(ContactState {
                from: c.centre,
                to: c.centre + c.branch,
                force: c.force,
                particle: c.particle.0,
                other: match c.partner {
                    Partner::Particle(p) => Some(p.0),
                    Partner::Wall(_) => None,
                },
            });
        });
        list
    }

    /// Forms and sizes of the particles.
    pub fn grains(&self) -> &Grains {
        &self.grains
    }

    /// Time step, s.
    pub fn time_step(&self) -> f64 {
        self.assembly.dt
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.assembly.engine.view().time()
    }

    /// A number that depends on every bit of the state of the particles.
    pub fn state_hash(&self) -> u64 {
        self.assembly.engine.state_hash()
    }

    fn step(&self) -> u64 {
        self.assembly.engine.view().step_number()
    }

    fn turns(&self) -> f64 {
        let (Some(record), stage) = (self.script.records.last(), self.stages[self.script.speed()])
        else {
            return 0.0;
        };
        let end = if record.ended > 0 { record.ended } else { self.step() };
        let time = (end - record.begun) as f64 * self.assembly.dt;
        time * stage.omega / std::f64::consts::TAU
    }

    /// Where the run stands.
    pub fn progress(&self) -> Progress {
        let index = self.script.speed();
        let stage = &self.stages[index];
        let record = self.script.records.last();
        let done = match record {
            Some(_) if self.script.phase == Phase::Done => stage.least_steps(),
            Some(r) if self.script.phase == Phase::Sampling => {
                let missing = stage.frames.saturating_sub(r.complete(stage.sub_frames)) as u64;
                stage.least_steps().saturating_sub(missing * stage.frame)
            }
            Some(r) => (self.step() - r.begun).min(stage.least_steps()),
            None => 0,
        };
        let all: u64 = self.stages[index..].iter().map(Stage::least_steps).sum();
        Progress {
            phase: self.script.phase,
            speed_rpm: stage.speed_rpm,
            speed_index: index,
            speeds: self.stages.len(),
            time_s: self.time(),
            turns: self.turns(),
            angle_deg: angle_deg(self.centre_of_mass()),
            frames_done: record.map_or(0, |r| r.complete(stage.sub_frames)),
            frames: stage.frames,
            new_frame: false,
            steps: self.step(),
            least_steps_left: all.saturating_sub(done),
        }
    }

    /// Frames that have been complete so far, at all speeds together.
    fn frames_taken(&self) -> u64 {
        let speeds = self.script.records.iter().zip(&self.stages);
        speeds.map(|(r, s)| r.left_out + r.complete(s.sub_frames) as u64).sum()
    }

    /// The speeds that are done, in ascending order.
    pub fn sampled(&self) -> Vec<Sampled> {
        let ended = self.script.records.iter().zip(&self.stages).filter(|(r, _)| r.ended > 0);
        ended.map(|(r, s)| self.summary(r, s, r.frames.clone())).collect()
    }

    /// The speeds that are done, without a copy of their frames.
    pub fn into_sampled(mut self) -> Vec<Sampled> {
        let mut records = std::mem::take(&mut self.script.records);
        let ended = records.iter_mut().zip(&self.stages).filter(|(r, _)| r.ended > 0);
        ended
            .map(|(r, s)| {
                let frames = std::mem::take(&mut r.frames);
                self.summary(r, s, frames)
            })
            .collect()
    }

    fn summary(&self, record: &Record, stage: &Stage, frames: Vec<Frame>) -> Sampled {
        let dt = self.assembly.dt;
        let steady = record.steady as usize;
        let mean = |series: &[f64]| mean_of(&series[steady..]);
        let s = &record.series;
        let froude = froude(stage.omega, self.assembly.radius);
        Sampled {
            speed_rpm: stage.speed_rpm,
            omega: stage.omega,
            froude,
            regime: Regime::at(froude),
            steady_from_s: (record.begun + record.steady * stage.monitor) as f64 * dt,
            turned_from_s: record.begun as f64 * dt,
            revolutions: (record.ended - record.begun) as f64 * dt * stage.omega
                / std::f64::consts::TAU,
            frames,
            torque: mean(&s.torque),
            centre_of_mass: [mean(&s.x), mean(&s.y), mean(&s.z)],
            angle_deg: mean(&s.angle_deg),
            coordination: mean_of(&record.coordination),
            wall_contacts: mean_of(&record.wall_contacts),
            grains: Arc::clone(&self.grains),
        }
    }
}
