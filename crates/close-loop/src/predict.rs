//! What confirmed models say of speeds of the rig's own load that nobody measured.

use calib::OperatingPoint;
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
        .map(|Made { rows, .. }| {
            let find = |omega: &f64| {
                let at = OperatingPoint::from(*omega);
                rows.iter().find(|(p, _)| *p == at).map(|(_, row)| row.clone())
            };
            let own = setup.predict.iter().filter_map(find).collect();
            rows.retain(|(p, _)| setup.knots.contains(p));
            own
        })
        .collect()
}

/// Means over fresh runs at the speeds to predict, with the standard deviation of a drum filled anew, whose responses shift by
/// `shift`. The runs' mean excess of
/// volume, with what twice the volume does at the knots, is taken out of them; `nuisance` is what nuisances add to a response.
pub(crate) fn predictions(
    runs: &[Vec<SpeedRow>],
    (excess, of_volume): (f64, &[[f64; 4]]),
    setup: &Setup,
    (base, shift): (&Emulator, [f64; 4]),
    nuisance: &dyn Fn(Response, f64) -> f64,
) -> Vec<SpeedResponse> {
    let n = runs.len() as f64;
    let volume_sd = setup.loads[0].volume_sd;
    let mut all = Vec::new();
    for (k, omega) in setup.predict.iter().enumerate() {
        let at = OperatingPoint::from(*omega);
        let rows: Vec<&SpeedRow> = runs.iter().filter_map(|r| r.get(k)).collect();
        for response in Response::ALL {
            let r = response.index();
            let mut mean = rows.iter().map(|s| s.mean[r]).sum::<f64>() / n;
            let frames =
                rows.iter().map(|s| s.covariance[r][r]).sum::<f64>() / (n * n) * base.swings(at);
            let more = base.of_volume_at(of_volume, at)[r];
            let filling = shift[r].powi(2) * (1.0 + 1.0 / n) + (volume_sd * more).powi(2);
            let variance = frames + filling;
            mean -= excess * more;
            mean += nuisance(response, mean);
            all.push(SpeedResponse {
                load: 0,
                omega_rpm: *omega,
                response: response.column(),
                mean,
                sd: variance.sqrt(),
            });
        }
    }
    all
}
