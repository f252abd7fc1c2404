//! Results for machines.

use calib::{JointMatch, Match, MeasuredOutlier, SimulatedOutlier, Study, WithheldPrediction};
use rig_schema::Response;
use serde::Serialize;

/// Friction at one speed, or over all (`omega_rpm` null).
#[derive(Serialize)]
pub(crate) struct Friction {
    omega_rpm: Option<f64>,
    mu_pp: f64,
    lo: Option<f64>,
    hi: Option<f64>,
    chi2: f64,
    dof: usize,
}

/// Friction of the mantle.
#[derive(Serialize)]
pub(crate) struct Wall {
    value: f64,
    lo: Option<f64>,
    hi: Option<f64>,
    identified: bool,
}

/// One residual.
#[derive(Serialize)]
pub(crate) struct Residual {
    omega_rpm: f64,
    response: &'static str,
    measured: f64,
    model: f64,
    sd: f64,
}

/// One doubtful cell.
#[derive(Serialize)]
pub(crate) struct Outlier {
    table: String,
    place: String,
    response: &'static str,
    value: f64,
    expected: f64,
    distance: f64,
    note: String,
}

/// What `tumble calibrate CASE --json` prints.
#[derive(Serialize)]
pub(crate) struct Calibration {
    case: String,
    friction: Vec<Friction>,
    mu_wall: Option<Wall>,
    chi2: f64,
    dof: usize,
    p: f64,
    p_bootstrap: Option<f64>,
    chi2_by_n_eff: Vec<(f64, f64)>,
    nuisance: Vec<Nuisance>,
    residuals: Vec<Residual>,
    held_out: Vec<Residual>,
    outliers: Vec<Outlier>,
    left_out_rpm: Vec<f64>,
    pub(crate) report: String,
}

#[derive(Serialize)]
struct Nuisance {
    name: String,
    value: f64,
    sd: f64,
    pull: f64,
}

/// A joint fit of several cases.
#[derive(Serialize)]
pub(crate) struct Joint {
    parameter: String,
    value: f64,
    lo: Option<f64>,
    hi: Option<f64>,
    chi2: f64,
    dof: usize,
    p: f64,
    tie_p: f64,
    members: Vec<Member>,
    withheld: Vec<Withheld>,
}

#[derive(Serialize)]
struct Member {
    case: String,
    alone: f64,
    strain: f64,
    chi2: f64,
    observations: usize,
}

#[derive(Serialize)]
struct Withheld {
    case: String,
    predicted_from: f64,
    own: f64,
    chi2: f64,
    own_chi2: f64,
    dof: usize,
    rmse: Vec<(&'static str, f64)>,
}

/// Several cases in one object.
#[derive(Serialize)]
pub(crate) struct Several {
    pub(crate) cases: Vec<Calibration>,
    pub(crate) joint: Option<Joint>,
    pub(crate) report: String,
}

fn residuals(all: &[calib::Residual]) -> Vec<Residual> {
    all.iter()
        .map(|r| Residual {
            omega_rpm: r.omega_rpm,
            response: r.response.column(),
            measured: r.measured,
            model: r.model,
            sd: r.sd,
        })
        .collect()
}

/// Root mean square of the residuals of each response.
pub(crate) fn rmse(all: &[calib::Residual]) -> Vec<(&'static str, f64)> {
    let of = |r: Response| Some((r.column(), calib::root_mean_square(all, r)?));
    Response::ALL.into_iter().filter_map(of).collect()
}

fn note(coincidences: &[calib::Coincidence]) -> String {
    let places: Vec<&str> = coincidences.iter().map(|c| c.place.as_str()).collect();
    if places.is_empty() { String::new() } else { format!("equals {}", places.join(" and ")) }
}

/// Outliers of both tables of a case.
pub(crate) fn outliers(
    study: &Study,
    measured: &[MeasuredOutlier],
    measured_file: &str,
    simulated: &[SimulatedOutlier],
) -> Vec<Outlier> {
    let m = measured.iter().map(|o| Outlier {
        table: measured_file.to_owned(),
        place: format!("{} rpm", o.omega_rpm),
        response: o.response.column(),
        value: o.value,
        expected: o.expected,
        distance: o.z,
        note: note(&o.coincidences),
    });
    let s = simulated.iter().map(|o| Outlier {
        table: study.table().file.clone(),
        place: format!("run {}", o.run),
        response: o.response.column(),
        value: o.value,
        expected: o.expected,
        distance: o.t.abs(),
        note: note(&o.coincidences),
    });
    m.chain(s).collect()
}

impl Outlier {
    pub(crate) fn row(&self) -> calib_report::calibration::OutlierRow {
        calib_report::calibration::OutlierRow {
            place: format!("{}, {}", self.table, self.place),
            response: self.response.to_owned(),
            value: Some(self.value),
            expected: Some(self.expected),
            distance_sd: Some(self.distance),
            note: self.note.clone(),
        }
    }

    pub(crate) fn is_at(&self, omega_rpm: f64, response: Response) -> bool {
        self.place == format!("{omega_rpm} rpm") && self.response == response.column()
    }

    pub(crate) fn line(&self) -> String {
        let note = if self.note.is_empty() { String::new() } else { format!(" ({})", self.note) };
        format!(
            "{}, {}: {} = {} where {:.2} is expected, {:.0} sd off{note}",
            self.table, self.place, self.response, self.value, self.expected, self.distance
        )
    }
}

/// Everything that was found for one case.
pub(crate) struct Found<'a> {
    pub(crate) study: &'a Study,
    pub(crate) joint: &'a Match,
    pub(crate) per_speed: &'a [(f64, Match)],
    pub(crate) by_n_eff: &'a [(f64, Match)],
    pub(crate) held_out: &'a [calib::Residual],
}

fn friction(omega_rpm: Option<f64>, m: &Match) -> Friction {
    let e = &m.estimates[0];
    Friction {
        omega_rpm,
        mu_pp: e.value,
        lo: e.lo,
        hi: e.hi,
        chi2: m.goodness.chi2,
        dof: m.goodness.dof,
    }
}

impl Calibration {
    pub(crate) fn new(found: &Found<'_>, outliers: Vec<Outlier>) -> Self {
        let m = found.joint;
        let mut all: Vec<Friction> =
            found.per_speed.iter().map(|(omega, m)| friction(Some(*omega), m)).collect();
        all.push(friction(None, m));
        let wall = m.estimates.iter().find(|e| e.name == "friction.mantle");
        Self {
            case: found.study.name.clone(),
            friction: all,
            mu_wall: wall.map(|e| Wall {
                value: e.value,
                lo: e.lo,
                hi: e.hi,
                identified: e.flatness.identified,
            }),
            chi2: m.goodness.chi2,
            dof: m.goodness.dof,
            p: m.goodness.p,
            p_bootstrap: m.bootstrap.as_ref().map(|b| b.p),
            chi2_by_n_eff: found.by_n_eff.iter().map(|(n, m)| (*n, m.goodness.chi2)).collect(),
            nuisance: m
                .nuisances
                .iter()
                .map(|n| Nuisance { name: n.name.clone(), value: n.value, sd: n.sd, pull: n.pull })
                .collect(),
            residuals: residuals(&m.residuals),
            held_out: residuals(found.held_out),
            outliers,
            left_out_rpm: found.study.left_out_rpm.clone(),
            report: String::new(),
        }
    }
}

impl Joint {
    pub(crate) fn new(joint: &JointMatch, withheld: &[WithheldPrediction]) -> Self {
        Self {
            parameter: joint.name.clone(),
            value: joint.value,
            lo: joint.lo,
            hi: joint.hi,
            chi2: joint.goodness.chi2,
            dof: joint.goodness.dof,
            p: joint.goodness.p,
            tie_p: joint.tie.p,
            members: joint
                .members
                .iter()
                .map(|m| Member {
                    case: m.name.clone(),
                    alone: m.alone,
                    strain: m.strain,
                    chi2: m.chi2,
                    observations: m.observations,
                })
                .collect(),
            withheld: withheld
                .iter()
                .map(|w| Withheld {
                    case: w.name.clone(),
                    predicted_from: w.value,
                    own: w.own_value,
                    chi2: w.goodness.chi2,
                    own_chi2: w.own.chi2,
                    dof: w.goodness.dof,
                    rmse: rmse(&w.residuals),
                })
                .collect(),
        }
    }
}
