//! What runs have taken, and what others will.
//!
//! It goes by what is kept with every run, so that a loop that was stopped and goes on stands where it stood.

/// Time of runs that are made so many at a time.
#[derive(Debug, Clone)]
pub(crate) struct Clock {
    jobs: usize,
    /// Time since the first run, s, without what lies between runs.
    pub(crate) spent_s: f64,
    /// Sum of costs, s, and number: of everyday runs, of whole rigs in place of their stand-in.
    costs: [(f64, usize); 2],
}

impl Clock {
    pub(crate) fn new(jobs: usize) -> Self {
        Self { jobs: jobs.max(1), spent_s: 0.0, costs: [(0.0, 0); 2] }
    }

    /// Runs that were asked for together, each with its cost, s.
    pub(crate) fn tell(&mut self, whole: bool, costs: &[f64]) {
        let (sum, longest) = costs.iter().fold((0.0, 0.0f64), |(s, l), c| (s + c, l.max(*c)));
        self.spent_s += longest.max(sum / self.jobs as f64);
        let own = &mut self.costs[usize::from(whole)];
        *own = (own.0 + sum, own.1 + costs.len());
    }

    /// What one run costs, s: 0 if none was made.
    fn each(&self, whole: bool) -> f64 {
        let (sum, count) = self.costs[usize::from(whole)];
        sum / count.max(1) as f64
    }

    /// Time of so many runs, s.
    pub(crate) fn time_of(&self, whole: bool, runs: usize) -> f64 {
        let all = runs as f64 * self.each(whole) / self.jobs as f64;
        if runs == 0 { 0.0 } else { all.max(self.each(whole)) }
    }

    /// Everyday runs that a time pays for.
    pub(crate) fn runs_in(&self, time_s: f64) -> usize {
        let each = self.each(false) / self.jobs as f64;
        if each > 0.0 { (time_s.max(0.0) / each) as usize } else { usize::MAX }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_side_by_side_take_the_time_of_the_longest_or_of_their_share() {
        let mut clock = Clock::new(2);
        clock.tell(false, &[4.0, 4.0, 4.0]);
        assert_eq!(clock.spent_s, 6.0);
        clock.tell(true, &[30.0]);
        assert_eq!(clock.spent_s, 36.0);
        assert_eq!((clock.time_of(false, 10), clock.time_of(false, 1)), (20.0, 4.0));
        assert_eq!((clock.time_of(true, 0), clock.time_of(true, 3)), (0.0, 45.0));
        assert_eq!((clock.runs_in(7.0), clock.runs_in(-7.0)), (3, 0));
        assert_eq!(Clock::new(0).runs_in(1.0), usize::MAX);
    }
}
