//! A biconvex tablet as a clump of ten spheres, and how far the clump is from the tablet.
#![expect(clippy::print_stdout, reason = "an example shows its results")]

use dem_shapes::{
    BiconvexTablet, ClumpMass, Fidelity, FidelityOptions, RingTabletSpec, ShapeError,
    solids::SolidOfRevolution,
};

fn main() -> Result<(), ShapeError> {
    // ANCHOR: solid
    // Radius, height of the band, radius of the crowns; m.
    let tablet = BiconvexTablet::new(4.00e-3, 2.25e-3, 9.64e-3)?;
    println!("tablet {:.2} mm3", tablet.volume() * 1e9);
    // ANCHOR_END: solid

    // ANCHOR: clump
    let spec = RingTabletSpec {
        ring_spheres: 9,
        ring_radius: 2.5e-3,
        sphere_radius: 1.87e-3,
        middle_radius: Some(2.3e-3),
    };
    // The ring on which the union of the spheres has the tablet's volume.
    let spec = spec.with_union_volume(tablet.volume())?;
    let glued = spec.build()?;
    let clump = glued.clump(ClumpMass::Total(0.225e-3))?; // kg, as weighed
    println!("ring {:.3} mm, density {:.0} kg/m3", spec.ring_radius * 1e3, clump.density());
    let moments = clump.principal_moments * 1e9; // kg m2 to g mm2
    println!("principal moments {moments:.3} g mm2");
    // ANCHOR_END: clump

    // ANCHOR: fidelity
    let off = Fidelity::measure(&glued.spheres(), &tablet, &FidelityOptions::default())?;
    println!("volume off by {:+.2} %", 100.0 * off.volume_error_rel());
    println!("volume on one side only {:.1} %", 100.0 * off.symmetric_difference_rel());
    println!("reaches out by {:.3} mm", off.protrusion * 1e3);
    println!("leaves up to {:.3} mm uncovered", off.uncovered_depth * 1e3);
    // ANCHOR_END: fidelity
    Ok(())
}
