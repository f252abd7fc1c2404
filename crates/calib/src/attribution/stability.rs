//! How the verdict changes when the data or their errors do.

use rig_schema::Response;

use super::data::Variation;
use super::gate::{Case, Null, Screen};
use super::ranking::decide;
use super::{Attribution, Overturn, StabilityRow, Verdict};
use crate::{CalibError, Observation, Observations};

/// Largest scatter of the set-up that is tried, deg and percent of R.
const MOST: f64 = 30.0;

/// The verdict alone, by a bootstrap that stops where nothing is missing.
pub(super) fn verdict(case: &Case<'_, '_>, draws: usize) -> Result<Verdict, CalibError> {
    let screen = Screen::new(case, draws, true)?;
    if screen.gate.passes {
        return Ok(Verdict::None);
    }
    Ok(decide(case, &screen, false)?.verdict)
}

/// The verdict without each speed, without each response, and with other errors.
pub(super) fn rows(attribution: &Attribution<'_>) -> Vec<StabilityRow> {
    let all = &attribution.base.observations;
    let draws = attribution.settings.stability_bootstrap;
    let mut rows = Vec::new();
    if draws == 0 {
        return rows;
    }
    let mut add = |change: String, observations: &Observations, variation: Variation| {
        let verdict = if observations.items.is_empty() {
            Err("no observation is left".to_owned())
        } else {
            Case::new(attribution, observations, variation, true)
                .and_then(|case| verdict(&case, draws))
                .map_err(|e| e.to_string())
        };
        rows.push(StabilityRow { change, verdict });
    };
    for speed in all.speeds_rpm() {
        let rest = all.filter(|o| o.omega_rpm != speed);
        add(format!("without {speed} rpm"), &rest, Variation::default());
    }
    for r in Response::ALL {
        let of = |o: &Observation| o.response == r;
        if all.items.iter().any(of) {
            let rest = all.filter(|o| !of(o));
            add(format!("without {}", r.column()), &rest, Variation::default());
        }
    }
    for frames in [0.75, 1.25] {
        add(format!("sd x {frames}"), all, Variation { frames, ..Variation::default() });
    }
    rows
}

/// Extra scatter at which both parts of the gate would pass, at the critical values of the
/// bootstrap.
pub(super) fn overturn(case: &Case<'_, '_>, screen: &Screen) -> Result<Overturn, CalibError> {
    let passes = |variation: Variation| -> Result<bool, CalibError> {
        let varied = case.vary(variation)?;
        let base = varied.fit_base()?;
        if base.chi2 > screen.critical_chi2 {
            return Ok(false);
        }
        for model in &varied.singles {
            let null = Null::new(model, &varied.data, &base)?;
            let gained = null.improvement(model, &varied.data, &varied.data.y, base.chi2)?;
            if screen.errors.counted(gained, base.chi2) > screen.critical_improvement {
                return Ok(false);
            }
        }
        Ok(true)
    };
    let search = |of: &dyn Fn(f64) -> Variation| -> Result<Option<f64>, CalibError> {
        if !passes(of(MOST))? {
            return Ok(None);
        }
        let (mut low, mut high) = (1e-3_f64, MOST);
        for _ in 0..14 {
            let middle = (low * high).sqrt();
            if passes(of(middle))? {
                high = middle;
            } else {
                low = middle;
            }
        }
        Ok(Some(high))
    };
    Ok(Overturn {
        independent: search(&|sd| Variation { independent: sd, ..Variation::default() })?,
        shared: search(&|sd| Variation { shared: sd, ..Variation::default() })?,
    })
}
