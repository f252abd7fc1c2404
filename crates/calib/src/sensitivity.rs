//! How a result moves with what was assumed.

use crate::{Basis, CalibError, FrameCorrelation, Match, ResponseSet, Study};

/// Independent frames in a mean under which a match is repeated: 1 is the frame-to-frame sd.
pub const N_EFF: [f64; 4] = [1.0, 5.0, 15.0, 30.0];

/// Frictions over which a saturating response may saturate.
pub const M0: [f64; 6] = [0.07, 0.1, 0.14, 0.2, 0.28, 0.4];

/// A match repeated under other assumptions, one changed at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivity {
    /// By the number of independent frames.
    pub by_n_eff: Vec<(f64, Match)>,
    /// By the correlation of the responses within a frame.
    pub by_correlation: Vec<(FrameCorrelation, Match)>,
    /// By the scale of a saturating basis in the first parameter; three levels of a factor do not
    /// determine it, so that every scale that can be fitted is as good as another.
    pub by_m0: Vec<(f64, Match)>,
    /// By the responses that are matched.
    pub by_responses: Vec<(ResponseSet, Match)>,
}

impl Sensitivity {
    /// Repeat the study's match; `draws` bootstrap draws with `seed` for each number of frames.
    ///
    /// # Errors
    /// As `Problem::solve`.
    pub fn of(study: &Study, draws: usize, seed: u64) -> Result<Self, CalibError> {
        let mut by_n_eff = Vec::new();
        for n in N_EFF {
            let problem = study.problem_for(study.observations.with_n_eff(n));
            by_n_eff.push((n, problem.solve(draws, seed)?));
        }
        let mut by_correlation = Vec::new();
        for c in FrameCorrelation::ALL {
            let problem = study.problem_for(study.observations.with_correlation(c));
            by_correlation.push((c, problem.solve(0, 0)?));
        }
        let mut by_m0 = Vec::new();
        if let Some(first) = study.free.first() {
            for m0 in M0 {
                let basis = Basis::Saturating { parameter: first.name.clone(), m0 };
                by_m0.push((m0, study.with_basis(&basis)?.problem().solve(0, 0)?));
            }
        }
        let mut by_responses = Vec::new();
        for set in ResponseSet::ALL {
            let observations = study.observations.filter(|o| set.contains(o.response));
            if !observations.items.is_empty() {
                by_responses.push((set, study.problem_for(observations).solve(0, 0)?));
            }
        }
        Ok(Self { by_n_eff, by_correlation, by_m0, by_responses })
    }
}
