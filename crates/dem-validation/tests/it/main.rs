//! Every case of the contact laws is within its tolerance.

mod outside_law;

#[expect(clippy::print_stdout, reason = "shown by --nocapture: how near the worst check is")]
fn assert_all(name: &str, checks: &[dem_validation::Check]) {
    let mut worst = 0.0f64;
    let mut failed = Vec::new();
    for c in checks {
        if c.tolerance > 0.0 {
            worst = worst.max(c.deviation / c.tolerance);
        }
        if !c.pass {
            failed.push(format!(
                "{}: {}: reference {:e}, ours {:e}, deviation {:.2e} > {:.1e} ({})",
                c.case,
                c.quantity,
                c.reference,
                c.ours,
                c.deviation,
                c.tolerance,
                c.tolerance_reason
            ));
        }
    }
    println!("{name}: {} checks, worst deviation {worst:.3} of its tolerance", checks.len());
    assert!(!checks.is_empty());
    assert!(
        failed.is_empty(),
        "{} of {} failed\n{}",
        failed.len(),
        checks.len(),
        failed.join("\n")
    );
}

macro_rules! group {
    ($($test:ident: $module:ident;)*) => {
        $(#[test]
        fn $test() {
            assert_all(stringify!($module), &dem_validation::$module::cases());
        })*
    };
}

group! {
    hertz_impacts_match_the_published_peaks: contact_hertz;
    every_dissipative_law_returns_the_restitution_asked: contact_restitution;
    oblique_and_spinning_impacts_match_chung_and_ooi: contact_oblique;
    linear_impacts_match_the_closed_solution_on_every_branch: contact_linear;
    jkr_and_dmt_match_their_closed_curves: contact_jkr;
    falling_spheres_match_the_piecewise_solution: contact_free_fall;
    rolling_and_sliding_on_a_plane_match_rigid_body_mechanics: contact_rolling;
    compatibility_laws_break_what_they_are_said_to_break: contact_compatibility;
    the_engine_drops_bounces_and_squeezes_like_the_equations: engine_drops;
    integrators_converge_with_their_order: engine_order;
    the_engine_slips_and_rolls_like_rigid_bodies: engine_rolling;
}
