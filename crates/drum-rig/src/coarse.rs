//! A coarser stand-in of a rig, for quick work.
//!
//! The drum is cut to a short slice with periodic ends and filled with beads that are larger by a
//! factor `k`, at the same fill volume. A drum that is no longer than the slice keeps its length and its ends.
//! What is scaled along, so that the bed feels the same:
//!
//! | quantity | scaled by | what stays the same |
//! |---|---|---|
//! | lengths of a particle | `k` | |
//! | count | `(slice/length) / k^3` | fill volume over drum volume |
//! | mass of a particle | `k^3` | density |
//! | elastic moduli | 1 | overlap over diameter under the bed's pressure, which the drum sets |
//! | time step | `k` | share of the Rayleigh time |
//! | surface energy, surface tension | `k^2` | Bond number (pull over weight) |
//! | energy density | `k` | Bond number, overlap over diameter being kept |
//! | rolling coefficients (numbers) | 1 | lever over radius |
//!
//! What is lost: in a slice the friction of the end plates, which steepens the bed the more the shorter the
//! drum is, and always the ratio of layer depth to bead diameter. The bias has to be measured against the full rig.

use rig_schema::{Ends, Rig, Settings, Shape};

use crate::error::Error;
use crate::options::Options;
use crate::outline::outline;

/// How coarse a stand-in is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coarsening {
    /// Factor on the size of the particles, at least 1.
    pub size: f64,
    /// Length of the slice over the diameter of the (enlarged) particles, at least 6.
    pub diameters: f64,
}

impl Default for Coarsening {
    fn default() -> Self {
        Self { size: 1.5, diameters: 8.0 }
    }
}

/// Steps of size in [`Coarsening::until`], and where they end.
const STEP: f64 = 0.25;
const COARSEST: f64 = 3.0;
/// Radius of the drum over the diameter of the larger particles, at least.
const LEAST_RADIUS: f64 = 10.0;

impl Coarsening {
    /// This one or the first coarser one (up to three times the size) with at most `particles`, or the coarsest that leaves ten diameters
    /// to the drum's radius.
    ///
    /// # Errors
    /// Those of [`outline`], which counts the particles.
    pub fn until(self, rig: &Rig, particles: usize) -> Result<Self, Error> {
        let full = outline(rig, &Options::default())?.particles as f64;
        let mut by = self;
        loop {
            let share = (by.diameters * by.size * diameter(rig) / rig.drum.length_m).min(1.0);
            let next = Self { size: by.size + STEP, ..by };
            let fits = full * share / by.size.powi(3) <= particles as f64;
            let room = rig.drum.radius_m >= LEAST_RADIUS * next.size * diameter(rig);
            if fits || next.size > COARSEST || !room {
                return Ok(by);
            }
            by = next;
        }
    }

    /// Whether the drum is cut to a slice, and so loses its ends.
    pub fn cuts(self, rig: &Rig) -> bool {
        rig.drum.length_m > self.diameters * self.size * diameter(rig)
    }
}

/// Outer diameter of a particle as described, m: an error of size changes neither the slice nor its ends.
fn diameter(rig: &Rig) -> f64 {
    match &rig.particles.shape {
        Shape::Sphere(s) => s.diameter_m,
        Shape::RingTablet(r) => 2.0 * (r.sphere_radius_m + r.ring_radius_m),
    }
}

/// Parameters of end plates, which a periodic slice does not have.
const END_PLATES: [&str; 3] = ["friction.end_plate", "rolling.end_plate", "restitution.end_plate"];

/// The coarser stand-in of a rig.
///
/// # Errors
/// [`Error::Option`] for factors out of range, [`Error::NoParticles`] when a rig has no fill,
/// [`Error::Range`] when a scaled parameter leaves its range; an inclined rig has no stand-in
/// ([`Error::Contradiction`]), nor has one with a liner.
pub fn coarse(rig: &Rig, by: Coarsening) -> Result<Rig, Error> {
    let k = by.size;
    if !(k >= 1.0 && k.is_finite()) {
        return Err(Error::Option {
            name: "size",
            value: k,
            expected: "a finite factor of at least 1",
        });
    }
    if !(by.diameters >= 6.0 && by.diameters.is_finite()) {
        let value = by.diameters;
        return Err(Error::Option { name: "diameters", value, expected: "at least 6" });
    }
    let cuts = by.cuts(rig);
    let refuse = |first| {
        let because = "a periodic slice has neither ends nor a liner's own length";
        Err(Error::Contradiction { first, second: "a coarse stand-in", because })
    };
    if cuts && rig.settings.value("axis.inclination_deg").is_some_and(|a| a != 0.0) {
        return refuse("an inclined axis");
    }
    if rig.drum.liner.is_some() {
        return refuse("a liner");
    }
    let mut coarse = rig.clone();
    match &mut coarse.particles.shape {
        Shape::Sphere(s) => s.diameter_m *= k,
        Shape::RingTablet(r) => {
            r.sphere_radius_m *= k;
            r.ring_radius_m *= k;
            r.middle_radius_m = r.middle_radius_m.map(|m| m * k);
        }
    }
    coarse.particles.mass_kg = rig.particles.mass_kg.map(|m| m * k.powi(3));
    coarse.run.time_step_s = rig.run.time_step_s.map(|dt| dt * k);
    if cuts {
        coarse.drum.ends = Ends::Periodic;
        coarse.drum.length_m = by.diameters * diameter(&coarse);
    }
    let share = coarse.drum.length_m / rig.drum.length_m;
    let mut settings = Settings::default();
    let kept = |path: &str| !cuts || !END_PLATES.contains(&path);
    for (path, value) in rig.settings.iter().filter(|(path, _)| kept(path)) {
        let factor = match path {
            "fill.count" => share / k.powi(3),
            "fill.mass_kg" => share,
            "cohesion.surface_energy_j_m2" => k * k,
            "cohesion.energy_density_j_m3" => k,
            _ => 1.0,
        };
        set(&mut settings, path, value * factor)?;
    }
    if rig.contact.cohesion == rig_schema::Cohesion::Capillary {
        let tension = rig.settings.value("cohesion.surface_tension_n_m").unwrap_or(0.0);
        set(&mut settings, "cohesion.surface_tension_n_m", tension * k * k)?;
    }
    coarse.settings = settings;
    coarse.name = format!("{} (coarse)", rig.name);
    Ok(coarse)
}

pub(crate) fn set(settings: &mut Settings, path: &'static str, value: f64) -> Result<(), Error> {
    settings.set(path, value).map_err(|parameter| {
        let (low, high) = parameter.map_or((f64::NAN, f64::NAN), |p| p.range);
        Error::Range { path, value, low, high }
    })
}
