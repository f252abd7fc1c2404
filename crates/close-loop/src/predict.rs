//! What confirmed models say of speeds that nobody measured.

use campaign::SpeedRow;
use rig_schema::Response;

use crate::emulator::Emulator;
use crate::outcome::SpeedResponse;
use crate::plan::Setup;
use crate::runs::Made;

/// Rows of the speeds to predict, run by run, in the order in which they are asked for; speeds that nobody measured are taken
/// out of the runs.
pub(crate) fn predicted_rows(runs: &mut [Made], setup: &Setup) -> Vec<Vec<SpeedRow>> {
    runs.iter_mut()
        .map(|Made { run, .. }| {
            let find = |omega: &f64| run.speeds.iter().find(|s| s.omega_rpm == *omega).cloned();
            let own = setup.predict.iter().filter_map(find).collect();
            run.speeds.retain(|s| setup.knots.contains(&s.omega_rpm));
            own
        })
        .collect()
}

/// Means over fresh runs at the speeds to predict, with the standard deviation of a drum filled anew. The runs' mean excess of
/// volume, with what twice the volume does at the knots, is taken out of them; `nuisance` is what nuisances add to a response.
pub(crate) fn predictions(
    runs: &[Vec<SpeedRow>],
    (excess, of_volume): (f64, &[[f64; 4]]),
    setup: &Setup,
    base: &Emulator,
    nuisance: &dyn Fn(Response, f64) -> f64,
) -> Vec<SpeedResponse> {
    let n = runs.len() as f64;
    let shift = base.shift();
    let mut all = Vec::new();
    for (k, omega) in setup.predict.iter().enumerate() {
        let rows: Vec<&SpeedRow> = runs.iter().filter_map(|r| r.get(k)).collect();
        for response in Response::ALL {
            let r = response.index();
            let mut mean = rows.iter().map(|s| s.mean[r]).sum::<f64>() / n;
            let frames = rows.iter().map(|s| s.covariance[r][r]).sum::<f64>() / (n * n)
                * base.swings(*omega);
            let more = base.of_volume_at(of_volume, *omega)[r];
            let filling = shift[r].powi(2) * (1.0 + 1.0 / n) + (setup.volume_sd * more).powi(2);
            let variance = frames + filling;
            mean -= excess * more;
            mean += nuisance(response, mean);
            all.push(SpeedResponse {
                omega_rpm: *omega,
                response: response.column(),
                mean,
                sd: variance.sqrt(),
            });
        }
    }
    all
}
