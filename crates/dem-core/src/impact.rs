//! Two bodies and one contact: what a contact law does to a collision, without a world around it.
//!
//! A sphere meets another sphere or a rigid plane under any [`ContactLaw`]; [`collide`] returns
//! what is measured in an impact test. [`TwoBody`] is the same motion step by step, with gravity,
//! for rolling and sliding on a plane.
//!
//! Body i starts to the left, its partner to the right: `normal_i_to_j` is `+X` at first. The
//! scheme is velocity Verlet. Slip and spins enter the laws at the middle of the step, where the
//! scheme has them; the overlap rate at the place that [`RateAt`] says. What that does to the
//! restitution of a contact of few steps is tabulated in the validation report.

use glam::DVec3;

use crate::contact::kinematics::{Kinematics, PairGeometry};
use crate::contact::law::Memory;
use crate::contact::model::{ContactLaw, ContactResponse};

/// Why an impact has no result.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ImpactError {
    /// A size, mass or time that must be positive is not.
    #[error("impact: `{quantity}` is {value}, expected a finite number greater than 0")]
    NotPositive {
        /// Its name.
        quantity: &'static str,
        /// What was given.
        value: f64,
    },
    /// The bodies do not approach each other.
    #[error("impact: the speed of approach is {speed} m/s, expected more than 0")]
    NotApproaching {
        /// Speed of approach, m/s.
        speed: f64,
    },
    /// The bodies still touch after the allowed number of steps (they stick, or the step is short).
    #[error("impact: still in contact after {steps} steps ({time} s)")]
    NoSeparation {
        /// Steps done.
        steps: usize,
        /// Time simulated, s.
        time: f64,
    },
    /// A velocity is no longer finite.
    #[error("impact: the motion is not finite at step {step}; the time step is likely too long")]
    NotFinite {
        /// Step at which it was seen.
        step: usize,
    },
}

/// A sphere in motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Radius, m.
    pub radius: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Moment of inertia about any axis through the centre, kg m^2.
    pub inertia: f64,
    /// Velocity of the centre, m/s.
    pub velocity: DVec3,
    /// Angular velocity, rad/s.
    pub spin: DVec3,
}

impl Body {
    /// Solid sphere at rest; `radius` in m, `density` in kg/m^3.
    pub fn solid_sphere(radius: f64, density: f64) -> Self {
        let mass = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * density;
        let inertia = 0.4 * mass * radius * radius;
        Self { radius, mass, inertia, velocity: DVec3::ZERO, spin: DVec3::ZERO }
    }

    /// The same body at another velocity (m/s).
    pub fn with_velocity(self, velocity: DVec3) -> Self {
        Self { velocity, ..self }
    }

    /// The same body at another angular velocity (rad/s).
    pub fn with_spin(self, spin: DVec3) -> Self {
        Self { spin, ..self }
    }

    /// Kinetic energy, J.
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.mass * self.velocity.length_squared()
            + 0.5 * self.inertia * self.spin.length_squared()
    }
}

/// What body i meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Partner {
    /// A rigid plane at rest, perpendicular to X.
    Plane,
    /// Another sphere.
    Sphere(Body),
}

/// Where the laws see the rate of the overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum RateAt {
    /// Extrapolated to the end of the step with the acceleration known: second order.
    #[default]
    End,
    /// At the middle of the step, half a step late: first order, yet closer than [`RateAt::End`] in
    /// contacts of fewer than some 20 steps.
    Middle,
    /// At the start of the step, one step late: damps too little.
    Start,
}

/// Where tangential forces attack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LeverOf {
    /// The middle of the overlap of two spheres, the surface of a plane: conserves angular
    /// momentum.
    #[default]
    Overlap,
    /// The radius of the undeformed sphere: what rigid-body formulas assume.
    Radius,
}

/// How to compute an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Time step, s.
    pub dt: f64,
    /// Gap at the start, as a share of the distance covered in one step (0 to 1): where in a step
    /// the bodies touch.
    pub phase: f64,
    /// Where the laws see the rate of the overlap.
    pub rate: RateAt,
    /// Where tangential forces attack.
    pub lever: LeverOf,
    /// Steps after which the impact is given up.
    pub max_steps: usize,
}

impl Settings {
    /// The defaults at the time step `dt` (s): touch at once, second order, up to ten million steps.
    pub fn new(dt: f64) -> Self {
        Self { dt, phase: 0.0, rate: RateAt::End, lever: LeverOf::Overlap, max_steps: 10_000_000 }
    }
}

/// Where the energy of an impact went, J.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ledger {
    /// Kinetic energy at the start.
    pub kinetic_before: f64,
    /// Kinetic energy at the end.
    pub kinetic_after: f64,
    /// Elastic energy at the end.
    pub elastic_after: f64,
    /// Work of gravity.
    pub gravity_work: f64,
    /// Lost by the normal law.
    pub normal: f64,
    /// Lost by the tangential law.
    pub tangential: f64,
    /// Lost by the rolling law.
    pub rolling: f64,
    /// Lost by the cohesion law.
    pub cohesion: f64,
}

impl Ledger {
    /// What the laws do not account for: the error of the integration, J.
    pub fn remainder(&self) -> f64 {
        self.kinetic_before + self.gravity_work
            - self.kinetic_after
            - self.elastic_after
            - self.dissipated()
    }

    /// Lost by all laws together, J.
    pub fn dissipated(&self) -> f64 {
        self.normal + self.tangential + self.rolling + self.cohesion
    }
}

/// Result of an impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Body i after the impact.
    pub i: Body,
    /// Its partner after the impact.
    pub partner: Partner,
    /// Speed of separation over speed of approach, along the line of centres of each moment.
    pub restitution: f64,
    /// Time over which the law pushed or pulled, s.
    pub duration: f64,
    /// Largest normal force, N.
    pub peak_force: f64,
    /// Largest overlap, m.
    pub peak_overlap: f64,
    /// Steps in contact.
    pub steps: usize,
    /// Where the energy went.
    pub energy: Ledger,
}

/// A body and its partner under one contact law, step by step.
#[derive(Debug, Clone, Copy)]
pub struct TwoBody<L: ContactLaw> {
    /// The law.
    pub law: L,
    /// Body i.
    pub i: Body,
    /// Its partner.
    pub partner: Partner,
    /// Centre of i, m; a plane lies at `x = 0`.
    pub position_i: DVec3,
    /// Centre of j, m.
    pub position_j: DVec3,
    /// Acceleration of gravity, m/s^2.
    pub gravity: DVec3,
    /// What the contact remembers.
    pub memory: L::Memory,
    /// Result of the law in the last step.
    pub response: ContactResponse,
    /// Overlap in the last step, m.
    pub overlap: f64,
    /// Slip velocity of i against its partner in the last step, m/s.
    pub slip_velocity: DVec3,
    /// Energy so far; its end values are those of the last step.
    pub energy: Ledger,
    /// Time, s.
    pub time: f64,
    settings: Settings,
    acceleration: [DVec3; 4],
}

impl<L: ContactLaw> TwoBody<L> {
    /// Bodies apart by `gap` (m, negative when they overlap) along X.
    pub fn new(law: L, i: Body, partner: Partner, gap: f64, settings: Settings) -> Self {
        let radius_j = match partner {
            Partner::Plane => 0.0,
            Partner::Sphere(j) => j.radius,
        };
        let kinetic = i.kinetic_energy() + kinetic_of(&partner);
        Self {
            law,
            i,
            partner,
            position_i: DVec3::X * -(i.radius + radius_j + gap),
            position_j: DVec3::ZERO,
            gravity: DVec3::ZERO,
            memory: L::Memory::default(),
            response: ContactResponse::default(),
            overlap: -gap,
            slip_velocity: DVec3::ZERO,
            energy: Ledger {
                kinetic_before: kinetic,
                kinetic_after: kinetic,
                ..Default::default()
            },
            time: 0.0,
            settings,
            acceleration: [DVec3::ZERO; 4],
        }
    }

    /// The same bodies in gravity (m/s^2).
    pub fn in_gravity(mut self, gravity: DVec3) -> Self {
        self.gravity = gravity;
        self.acceleration[0] = gravity;
        if let Partner::Sphere(_) = self.partner {
            self.acceleration[2] = gravity;
        }
        self
    }

    /// Size and inertia of the pair.
    pub fn geometry(&self) -> PairGeometry {
        match &self.partner {
            Partner::Plane => PairGeometry {
                r_star: self.i.radius,
                m_star: self.i.mass,
                radius_i: self.i.radius,
                radius_j: f64::INFINITY,
            },
            Partner::Sphere(j) => PairGeometry {
                r_star: self.i.radius * j.radius / (self.i.radius + j.radius),
                m_star: self.i.mass * j.mass / (self.i.mass + j.mass),
                radius_i: self.i.radius,
                radius_j: j.radius,
            },
        }
    }

    /// One step of velocity Verlet.
    pub fn step(&mut self) {
        let dt = self.settings.dt;
        let [a_i, alpha_i, a_j, alpha_j] = self.acceleration;
        let mut j = match self.partner {
            Partner::Plane => Body {
                radius: 0.0,
                mass: f64::INFINITY,
                inertia: f64::INFINITY,
                velocity: DVec3::ZERO,
                spin: DVec3::ZERO,
            },
            Partner::Sphere(j) => j,
        };
        self.i.velocity += a_i * (0.5 * dt);
        self.i.spin += alpha_i * (0.5 * dt);
        j.velocity += a_j * (0.5 * dt);
        j.spin += alpha_j * (0.5 * dt);
        self.position_i += self.i.velocity * dt;
        self.position_j += j.velocity * dt;
        self.time += dt;

        let motion = self.kinematics(&j, a_i - a_j);
        self.overlap = motion.overlap;
        self.slip_velocity = motion.slip_velocity;
        let pair = self.geometry();
        if motion.overlap >= -self.law.reach(&pair) {
            let twist = 0.5 * (self.i.spin + j.spin).dot(motion.normal_i_to_j) * dt;
            self.memory.transport(motion.normal_i_to_j, twist);
            self.response = self.law.respond(&pair, &motion, &mut self.memory);
        } else {
            self.response = ContactResponse::default();
            self.memory = L::Memory::default();
        }
        let r = &self.response;
        let gravity_j =
            if matches!(self.partner, Partner::Plane) { DVec3::ZERO } else { self.gravity };
        self.acceleration = [
            r.force_on_i / self.i.mass + self.gravity,
            r.torque_on_i / self.i.inertia,
            -r.force_on_i / j.mass + gravity_j,
            r.torque_on_j / j.inertia,
        ];
        // The mid-step velocity is the one that moved the bodies.
        self.energy.gravity_work += self.i.mass * self.gravity.dot(self.i.velocity) * dt;
        if let Partner::Sphere(_) = self.partner {
            self.energy.gravity_work += j.mass * self.gravity.dot(j.velocity) * dt;
        }
        self.energy.normal += r.normal.dissipated_power * dt;
        self.energy.tangential += r.tangential.dissipated_power * dt;
        self.energy.rolling += r.rolling.dissipated_power * dt;
        self.energy.cohesion += r.cohesion.dissipated_power * dt;
        self.energy.elastic_after = r.elastic_energy();
        self.i.velocity += self.acceleration[0] * (0.5 * dt);
        self.i.spin += self.acceleration[1] * (0.5 * dt);
        if let Partner::Sphere(_) = self.partner {
            j.velocity += self.acceleration[2] * (0.5 * dt);
            j.spin += self.acceleration[3] * (0.5 * dt);
            self.partner = Partner::Sphere(j);
        }
        self.energy.kinetic_after = self.i.kinetic_energy() + kinetic_of(&self.partner);
    }

    fn kinematics(&self, j: &Body, acceleration: DVec3) -> Kinematics {
        let plane = matches!(self.partner, Partner::Plane);
        let (normal, overlap) = if plane {
            (DVec3::X, self.i.radius + self.position_i.x)
        } else {
            let d = self.position_j - self.position_i;
            let distance = d.length();
            (d / distance, self.i.radius + j.radius - distance)
        };
        let relative = self.i.velocity - j.velocity;
        let lever = |overlap: f64| {
            let depth = overlap.max(0.0);
            match (self.settings.lever, plane) {
                (LeverOf::Radius, true) => (self.i.radius, 0.0),
                (LeverOf::Radius, false) => (self.i.radius, j.radius),
                (LeverOf::Overlap, true) => (self.i.radius - depth, 0.0),
                (LeverOf::Overlap, false) => (self.i.radius - 0.5 * depth, j.radius - 0.5 * depth),
            }
        };
        let (lever_i, lever_j) = lever(overlap);
        // Slip belongs to the middle of the step, and so do its levers.
        let (arm_i, arm_j) = lever(overlap - 0.5 * self.settings.dt * relative.dot(normal));
        let surface = relative + self.i.spin.cross(normal * arm_i) + j.spin.cross(normal * arm_j);
        let end = match self.settings.rate {
            RateAt::End => relative + acceleration * (0.5 * self.settings.dt),
            RateAt::Middle => relative,
            RateAt::Start => relative - acceleration * (0.5 * self.settings.dt),
        };
        Kinematics {
            normal_i_to_j: normal,
            overlap,
            overlap_rate: end.dot(normal),
            slip_velocity: surface - normal * surface.dot(normal),
            spin_i: self.i.spin,
            spin_j: j.spin,
            lever_i,
            lever_j,
            dt: self.settings.dt,
        }
    }

    /// Speed of approach along the line of centres, m/s.
    pub fn approach_speed(&self) -> f64 {
        match &self.partner {
            Partner::Plane => self.i.velocity.x,
            Partner::Sphere(j) => (self.i.velocity - j.velocity)
                .dot((self.position_j - self.position_i).normalize_or(DVec3::X)),
        }
    }
}

fn kinetic_of(partner: &Partner) -> f64 {
    match partner {
        Partner::Plane => 0.0,
        Partner::Sphere(j) => j.kinetic_energy(),
    }
}

/// Let two bodies collide and part under `law`.
///
/// # Errors
/// A quantity that is not positive, bodies that do not approach, bodies that do not part within
/// `settings.max_steps`, a motion that is no longer finite.
///
/// ```
/// use dem_core::contact::{cohesion::Cohesionless, model::ContactModel, rolling::FreeRolling};
/// use dem_core::contact::normal::{HertzSpec, HertzTailCut};
/// use dem_core::contact::tangential::Frictionless;
/// use dem_core::glam::DVec3;
/// use dem_core::impact::{Body, Partner, Settings, collide};
/// let law = ContactModel {
///     normal: HertzTailCut::try_from(HertzSpec { e_star: 25e9, restitution: 0.9 })?,
///     tangential: Frictionless,
///     rolling: FreeRolling,
///     cohesion: Cohesionless,
/// };
/// let bead = Body::solid_sphere(3e-3, 2500.0).with_velocity(DVec3::X);
/// let hit = collide(law, bead, Partner::Plane, Settings::new(2e-8))?;
/// assert!((hit.restitution - 0.9).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn collide<L: ContactLaw>(
    law: L,
    i: Body,
    partner: Partner,
    settings: Settings,
) -> Result<Outcome, ImpactError> {
    for (quantity, value) in
        [("dt", settings.dt), ("radius", i.radius), ("mass", i.mass), ("inertia", i.inertia)]
    {
        if !(value.is_finite() && value > 0.0) {
            return Err(ImpactError::NotPositive { quantity, value });
        }
    }
    let mut pair = TwoBody::new(law, i, partner, 0.0, settings);
    let speed = pair.approach_speed();
    if speed <= 0.0 || speed.is_nan() {
        return Err(ImpactError::NotApproaching { speed });
    }
    pair.position_i.x -= settings.phase * speed * settings.dt;
    let reach = law.reach(&pair.geometry());
    let (mut peak_force, mut peak_overlap) = (0f64, 0f64);
    let (mut steps, mut touched) = (0, false);
    for step in 1..=settings.max_steps {
        pair.step();
        if !pair.i.velocity.is_finite() {
            return Err(ImpactError::NotFinite { step });
        }
        let force = pair.response.normal.force - pair.response.cohesion.pull;
        if force != 0.0 {
            steps += 1;
        }
        touched |= pair.overlap > 0.0;
        peak_force = peak_force.max(force);
        peak_overlap = peak_overlap.max(pair.overlap);
        if touched && pair.overlap <= -reach && pair.approach_speed() < 0.0 {
            return Ok(Outcome {
                i: pair.i,
                partner: pair.partner,
                restitution: -pair.approach_speed() / speed,
                duration: steps as f64 * settings.dt,
                peak_force,
                peak_overlap,
                steps,
                energy: pair.energy,
            });
        }
    }
    Err(ImpactError::NoSeparation { steps: settings.max_steps, time: pair.time })
}

#[cfg(test)]
#[path = "impact_tests.rs"]
mod tests;
