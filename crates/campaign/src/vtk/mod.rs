//! Particles and contacts as VTK XML, for ParaView and everything else that reads it.
//!
//! Unstructured grids (`.vtu`): particles are vertices, one a sphere, with radius, velocity, spin, force,
//! coordination and the number of their particle (the spheres of a clump share it); contacts are
//! lines from the first sphere's centre to the other's, or to the point on the wall, with the
//! force on the first. A `.pvd` file joins the instants to a series in time.
//!
//! ```
//! use campaign::vtk::{Encoding, particles};
//! use drum_rig::{Experiment, Options, rig_schema::Rig};
//! let rig = Rig::parse("drum.toml", r#"
//! name = "a handful of beads"
//! drum = { radius_m = 0.02, length_m = 0.02, mantle = "glass", end_plates = "glass" }
//! particles = { material = "glass", shape = { sphere = { diameter_m = 0.004 } } }
//! fill.count = 90
//! friction = { pp = 0.5, mantle = 0.6 }
//! restitution = { pp = 0.7, mantle = 0.7 }
//! rolling = { pp = 0.01, mantle = 0.01 }
//! run = { speeds_rpm = [60.0] }
//! [materials]
//! glass = { density_kg_m3 = 2500.0, poisson_ratio = 0.29, shear_modulus_pa = 2.52e6 }
//! "#)?;
//! let drum = Experiment::new(&rig, &Options::default())?;
//! let text = particles(&drum, Encoding::Ascii);
//! assert!(text.contains(r#"NumberOfPoints="90""#));
//! # Ok::<(), drum_rig::Error>(())
//! ```

mod grid;
mod series;

pub use grid::Encoding;
pub use series::Series;

use drum_rig::Experiment;
use grid::{Array, Cell, Grid};

/// All spheres of an experiment as it stands, as the text of a `.vtu` file.
///
/// Of a clump every sphere is a point: position and velocity are its own, spin, force and
/// coordination those of its particle. Lengths in m, velocities in m/s, spins in rad/s, forces in N.
pub fn particles(drum: &Experiment, encoding: Encoding) -> String {
    let states = drum.particles();
    let exposure = drum.exposure();
    let balls: Vec<_> = exposure.balls(drum.grains()).collect();
    let own: Vec<_> = balls.iter().map(|b| (b, &states[b.particle as usize])).collect();
    let velocity = own.iter().map(|(b, s)| s.velocity + s.spin.cross(b.centre - s.position));
    Grid {
        points: balls.iter().map(|b| b.centre).collect(),
        cell: Cell::Vertex,
        point_data: vec![
            Array::scalars("radius", balls.iter().map(|b| b.radius)),
            Array::vectors("velocity", velocity),
            Array::vectors("spin", own.iter().map(|(_, s)| s.spin)),
            Array::vectors("force", own.iter().map(|(_, s)| s.force)),
            Array::scalars("mass", own.iter().map(|(_, s)| s.mass)),
            Array::integers("coordination", own.iter().map(|(_, s)| i64::from(s.contacts))),
            Array::integers("wall_contacts", own.iter().map(|(_, s)| i64::from(s.wall_contacts))),
            Array::integers("particle", balls.iter().map(|b| i64::from(b.particle))),
        ],
        cell_data: Vec::new(),
        time_s: drum.time(),
    }
    .text(encoding)
}

/// All contacts of an experiment as it stands, as the text of a `.vtu` file.
///
/// A line a contact; `force` is that on the first particle, N. The other particle of a contact with a
/// wall is -1.
pub fn contacts(drum: &Experiment, encoding: Encoding) -> String {
    let states = drum.contacts();
    let other = |c: &drum_rig::ContactState| c.other.map_or(-1, i64::from);
    Grid {
        points: states.iter().flat_map(|c| [c.from, c.to]).collect(),
        cell: Cell::Line,
        point_data: Vec::new(),
        cell_data: vec![
            Array::vectors("force", states.iter().map(|c| c.force)),
            Array::scalars("force_magnitude", states.iter().map(|c| c.force.length())),
            Array::integers("particle", states.iter().map(|c| i64::from(c.particle))),
            Array::integers("other", states.iter().map(other)),
        ],
        time_s: drum.time(),
    }
    .text(encoding)
}
