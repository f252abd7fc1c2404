//! A case made ready: its observations, surrogate, free parameters and nuisances.

use rig_schema::{Case, MeasuredTable, Response, SimulatedTable, Simulator as Source, TableBasis};

use crate::{
    Basis, CalibError, FrameCorrelation, FreeParameter, JointMember, Match, Nuisance, Observations,
    Problem, Simulator, Surrogate,
};

/// Independent frames in a mean where neither the case nor the table says.
const DEFAULT_N_EFF: f64 = 15.0;

/// Which responses are matched.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum ResponseSet {
    /// All four.
    #[default]
    All,
    /// Both angles.
    Angles,
    /// One alone.
    One(Response),
}

impl ResponseSet {
    /// All, both angles, then each alone.
    pub const ALL: [Self; 6] = [
        Self::All,
        Self::Angles,
        Self::One(Response::AorLin),
        Self::One(Response::AorMid),
        Self::One(Response::CenX),
        Self::One(Response::CenY),
    ];

    /// Whether a response belongs to the set.
    pub fn contains(self, response: Response) -> bool {
        match self {
            Self::All => true,
            Self::Angles => matches!(response, Response::AorLin | Response::AorMid),
            Self::One(r) => r == response,
        }
    }

    /// Key for tables: `all`, `angles`, `aor_lin`, `aor_mid`, `cen_x`, `cen_y`.
    pub fn key(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Angles => "angles",
            Self::One(r) => ["aor_lin", "aor_mid", "cen_x", "cen_y"][r.index()],
        }
    }
}

/// A case made ready to be matched.
#[derive(Debug, Clone)]
pub struct Study {
    /// Name of the case.
    pub name: String,
    /// The response surfaces.
    pub surrogate: Surrogate,
    /// Observations that are fitted.
    pub observations: Observations,
    /// Observations kept aside.
    pub held_out: Observations,
    /// Measured speeds beyond the surrogate's range, rpm.
    pub left_out_rpm: Vec<f64>,
    /// What is fitted.
    pub free: Vec<FreeParameter>,
    /// Labels under which parameters are shared between cases: (path, label).
    pub shared: Vec<(String, String)>,
    /// What is marginalised.
    pub nuisances: Vec<Nuisance>,
    table: SimulatedTable,
    /// Column and path of each parameter of the table.
    columns: Vec<(String, String)>,
    /// Parameters that are not free, with their values.
    held: Vec<(String, f64)>,
}

impl Study {
    /// Columns of factors that the case's table has, free parameters first in their order.
    ///
    /// # Errors
    /// [`CalibError::NoTable`] if the case's simulator is not a table.
    pub fn columns(case: &Case) -> Result<Vec<(String, String)>, CalibError> {
        let Source::Table(table) = &case.simulator else {
            return Err(CalibError::NoTable { case: case.rig.name.clone() });
        };
        let mut columns: Vec<(String, String)> =
            table.columns.iter().map(|(c, p)| (c.clone(), p.clone())).collect();
        // The friction between particles first: it is what is asked for.
        let rank = |path: &str| {
            let free = case.free.iter().position(|f| f.path == path);
            (path != "friction.pp", free.unwrap_or(usize::MAX))
        };
        columns.sort_by_key(|(_, path)| rank(path));
        Ok(columns)
    }

    /// Make a case ready with its tables.
    ///
    /// # Errors
    /// [`CalibError`] if a free parameter is not in the table, a table's parameter is neither free
    /// nor set, a nuisance's effect is unknown, or the surfaces cannot be fitted.
    pub fn new(
        case: &Case,
        measured: &MeasuredTable,
        simulated: SimulatedTable,
    ) -> Result<Self, CalibError> {
        let columns = Self::columns(case)?;
        let known = || columns.iter().map(|c| c.1.clone()).collect::<Vec<_>>().join(", ");
        for f in &case.free {
            if !columns.iter().any(|(_, path)| *path == f.path) {
                return Err(CalibError::Unknown { name: f.path.clone(), known: known() });
            }
        }
        let mut held = Vec::new();
        let mut free = Vec::new();
        for (_, path) in &columns {
            if let Some(f) = case.free.iter().find(|f| f.path == *path) {
                free.push(FreeParameter { name: path.clone(), range: f.range });
                continue;
            }
            let value = case.rig.settings.value(path);
            let unset = || CalibError::Unset { name: path.clone(), case: case.rig.name.clone() };
            held.push((path.clone(), value.ok_or_else(unset)?));
        }
        let mut nuisances = Vec::new();
        for n in &case.nuisance {
            let unknown =
                || CalibError::Nuisance { name: n.path.clone(), known: Nuisance::PATHS.join(", ") };
            nuisances.push(Nuisance::from_path(&n.path, n.mean, n.sd).ok_or_else(unknown)?);
        }
        let Source::Table(source) = &case.simulator else {
            return Err(CalibError::NoTable { case: case.rig.name.clone() });
        };
        let basis = match source.basis {
            TableBasis::Quadratic => Basis::Quadratic,
            TableBasis::Saturating { m0 } => {
                Basis::Saturating { parameter: columns[0].1.clone(), m0 }
            }
        };
        let surrogate = surfaces(&simulated, &columns, &held, &basis)?;
        let (all, left_out_rpm) = Observations::from_table(
            measured,
            surrogate.speed_range_rpm(),
            case.data.n_eff.unwrap_or(DEFAULT_N_EFF),
            FrameCorrelation::default(),
        )?;
        let speeds = all.speeds_rpm();
        let aside = |omega: f64| {
            let index = speeds.partition_point(|s| *s < omega);
            case.holds_out(index, speeds.len(), omega)
        };
        let observations = all.filter(|o| !aside(o.omega_rpm));
        if observations.items.is_empty() {
            let (low, high) = surrogate.speed_range_rpm();
            return Err(CalibError::NoObservations { low, high });
        }
        Ok(Self {
            name: case.rig.name.clone(),
            observations,
            held_out: all.filter(|o| aside(o.omega_rpm)),
            left_out_rpm,
            free,
            shared: case
                .free
                .iter()
                .filter_map(|f| Some((f.path.clone(), f.shared.clone()?)))
                .collect(),
            nuisances,
            surrogate,
            table: simulated,
            columns,
            held,
        })
    }

    /// The same with surfaces of other terms.
    ///
    /// # Errors
    /// [`CalibError`] if they cannot be fitted.
    pub fn with_basis(&self, basis: &Basis) -> Result<Self, CalibError> {
        let surrogate = surfaces(&self.table, &self.columns, &self.held, basis)?;
        Ok(Self { surrogate, ..self.clone() })
    }

    /// The table behind the surfaces.
    pub fn table(&self) -> &SimulatedTable {
        &self.table
    }

    /// The matching problem for other observations than the study's own.
    pub fn problem_for(&self, observations: Observations) -> Problem<'_> {
        Problem {
            observations,
            simulator: &self.surrogate,
            free: self.free.clone(),
            nuisances: self.nuisances.clone(),
        }
    }

    /// The matching problem over all fitted speeds.
    pub fn problem(&self) -> Problem<'_> {
        self.problem_for(self.observations.clone())
    }

    /// Match at one speed, by a set of responses; `None` outside the measured speeds.
    ///
    /// # Errors
    /// As [`Problem::solve`].
    pub fn at_speed(&self, omega_rpm: f64, set: ResponseSet) -> Result<Option<Match>, CalibError> {
        let Some(here) = self.observations.at_speed(omega_rpm) else { return Ok(None) };
        let here = here.filter(|o| set.contains(o.response));
        if here.items.is_empty() {
            return Ok(None);
        }
        self.problem_for(here).solve(0, 0).map(Some)
    }

    /// This study as one configuration of a joint match.
    pub fn member(&self) -> JointMember<'_> {
        JointMember { name: self.name.clone(), problem: self.problem() }
    }
}

fn surfaces(
    table: &SimulatedTable,
    columns: &[(String, String)],
    held: &[(String, f64)],
    basis: &Basis,
) -> Result<Surrogate, CalibError> {
    let pairs: Vec<(&str, &str)> = columns.iter().map(|(c, p)| (c.as_str(), p.as_str())).collect();
    let mut surrogate = Surrogate::from_table(table, &pairs, basis)?;
    for (path, value) in held {
        surrogate = surrogate.hold(path, *value)?;
    }
    Ok(surrogate)
}
