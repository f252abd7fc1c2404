//! One particle friction a material: fitted on three of its four configurations, the fourth
//! predicted.

use calib::{JointMatch, Study, WithheldPrediction, root_mean_square};
use rig_schema::{ErrataLevel, Response};
use serde::Serialize;

use super::study;

/// A material in its four configurations.
#[derive(Serialize)]
pub(crate) struct Material {
    pub(crate) name: &'static str,
    pub(crate) value: f64,
    pub(crate) lo: Option<f64>,
    pub(crate) hi: Option<f64>,
    pub(crate) chi2: f64,
    pub(crate) dof: usize,
    /// Probability that one friction for all costs as much by chance.
    pub(crate) tie_p: f64,
    pub(crate) members: Vec<(String, f64, f64)>,
    pub(crate) withheld: Vec<Withheld>,
}

/// One configuration predicted.
#[derive(Serialize)]
pub(crate) struct Withheld {
    pub(crate) config: String,
    pub(crate) from_others: f64,
    pub(crate) own: f64,
    pub(crate) chi2: f64,
    pub(crate) own_chi2: f64,
    pub(crate) dof: usize,
    pub(crate) rmse: Vec<(&'static str, f64)>,
}

const MATERIALS: [(&str, [&str; 4]); 3] = [
    ("glass bead", ["AZ1_Plexi", "AZ2_Plexi", "AZ1_Steel", "AZ2_Steel"]),
    ("coated tablet", ["AZ4_Plexi", "AZ5_Plexi", "AZ4_Steel", "AZ5_Steel"]),
    ("pressed tablet", ["AZ6_Plexi", "AZ7_Plexi", "AZ6_Steel", "AZ7_Steel"]),
];

pub(crate) fn all() -> anyhow::Result<Vec<Material>> {
    let of = |(name, configs): &(&'static str, [&str; 4])| {
        let studies = configs.iter().map(|c| study(c, ErrataLevel::Certain));
        Material::of(name, &studies.collect::<anyhow::Result<Vec<_>>>()?)
    };
    MATERIALS.iter().map(of).collect()
}

impl Material {
    /// One friction for all of some studies, and for all but each in turn.
    pub(crate) fn of(name: &'static str, studies: &[Study]) -> anyhow::Result<Self> {
        let members: Vec<_> = studies.iter().map(Study::member).collect();
        let joint = JointMatch::solve("friction.pp", &members)?;
        let withheld = JointMatch::withhold_each("friction.pp", &members)?;
        Ok(Self {
            name,
            value: joint.value,
            lo: joint.lo,
            hi: joint.hi,
            chi2: joint.goodness.chi2,
            dof: joint.goodness.dof,
            tie_p: joint.tie.p,
            members: joint.members.iter().map(|m| (m.name.clone(), m.alone, m.strain)).collect(),
            withheld: withheld.iter().map(Withheld::of).collect(),
        })
    }
}

impl Withheld {
    fn of(w: &WithheldPrediction) -> Self {
        let rmse = |r: Response| Some((r.column(), root_mean_square(&w.residuals, r)?));
        Self {
            config: w.name.clone(),
            from_others: w.value,
            own: w.own_value,
            chi2: w.goodness.chi2,
            own_chi2: w.own.chi2,
            dof: w.goodness.dof,
            rmse: Response::ALL.into_iter().filter_map(rmse).collect(),
        }
    }
}
