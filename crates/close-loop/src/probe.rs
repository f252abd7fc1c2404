//! Every effect near the calibrated point.

use calib::attribution::Layer;

use crate::catalogue::Effect;
use crate::curve::Change;
use crate::driver::{Stage, State, Told, is_simulated};
use crate::error::CloseLoopError;
use crate::filmed::{Filmed, Films};
use crate::runs::{Made, rig_with, sample};

impl State<'_> {
    /// Simulate every effect at the calibrated point, and film it by every other camera.
    pub(crate) fn probe(&mut self, watch: &mut dyn FnMut(&Told)) -> Result<(), CloseLoopError> {
        let known: Vec<Effect> =
            self.setup.simulated.iter().filter_map(|n| self.known(n)).collect();
        let effects: Vec<Effect> = self.setup.catalogue.effects.clone();
        let each = self.effort.probes;
        let tried = effects.iter().filter(|e| is_simulated(e)).map(|e| (e, each));
        // An uncertain known is simulated to both sides.
        let of_known = known.iter().map(|e| (e, each.max(2)));
        let turns = |(e, each)| (0..each).map(move |k| (e, 1 - k % 2, k / 2));
        let wanted: Vec<(&Effect, usize, usize)> = tried.chain(of_known).flat_map(turns).collect();
        self.probes(&wanted, watch)?;
        // Where the stronger one of few could not be simulated, the weaker one says something too.
        let none = |e: &&Effect| !self.effects.contains_key(&e.path);
        let failed = effects.iter().filter(|e| is_simulated(e)).filter(none);
        let weaker: Vec<(&Effect, usize, usize)> = failed.map(|e| (e, 0, 0)).collect();
        if self.effort.probes == 1 && !weaker.is_empty() {
            self.probes(&weaker, watch)?;
        }
        for e in &effects {
            if is_simulated(e) && !self.effects.contains_key(&e.path) {
                let why = "none of its runs came out".to_owned();
                self.setup.catalogue.left_out.push((e.path.clone(), why));
            }
        }
        for e in effects.iter().filter(|e| e.layer == Layer::Camera) {
            if let Some(change) = self.film(e, watch)? {
                self.curves.insert(e.path.clone(), change);
            }
        }
        for e in effects.iter().filter(|e| e.layer == Layer::Measurement) {
            let change = match e.path.as_str() {
                "measure.bias_lin_deg" => Change::Shift(0),
                "measure.bias_mid_deg" => Change::Shift(1),
                "measure.offset_x_pct" => Change::Shift(2),
                "measure.offset_y_pct" => Change::Shift(3),
                "measure.scale" => Change::Divide,
                _ => match self.film(e, watch)? {
                    Some(change) => change,
                    None => continue,
                },
            };
            self.curves.insert(e.path.clone(), change);
        }
        let simulated = self.setup.simulated.clone();
        for (known, (path, mean, sd)) in known.iter().zip(&simulated) {
            self.modes.extend(self.mode(known, path, *mean, *sd)?);
        }
        Ok(())
    }

    /// Simulate effects at the calibrated point: which of their two strengths, and in which filling. The
    /// fillings are the same for every effect: nothing is gained by others.
    fn probes(
        &mut self,
        wanted: &[(&Effect, usize, usize)],
        watch: &mut dyn FnMut(&Told),
    ) -> Result<(), CloseLoopError> {
        let theta = self.snap(&self.theta);
        let mut rigs = Vec::new();
        for (e, which, k) in wanted {
            let filling = self.runs.filling(Stage::Probes, 2 * k + which);
            let (rig, axes) = (&self.setup.rig, &self.setup.axes);
            let strength = e.probes[*which];
            let with = rig_with(rig, axes, &theta, (e, strength), filling)?;
            rigs.push((format!("{} = {strength:.4}", e.path), with));
        }
        let runs = self.runs.all(Stage::Probes, &rigs, watch)?;
        for ((e, which, _), run) in wanted.iter().zip(&runs) {
            let mut at = theta.clone();
            at.push(e.probes[*which]);
            match run {
                Some(run) => {
                    self.effects.entry(e.path.clone()).or_default().push(sample(at, run));
                }
                None => self.lose(std::slice::from_ref(*e), at),
            }
        }
        Ok(())
    }

    /// An uncertain known as an effect that is simulated two standard deviations to either side.
    fn known(&self, (path, mean, sd): &(String, f64, f64)) -> Option<Effect> {
        let p = rig_schema::namespace::find(path)?;
        let inside = |x: f64| x.clamp(p.range.0, p.range.1);
        Some(Effect {
            null: *mean,
            probes: [inside(mean - 2.0 * sd), inside(mean + 2.0 * sd)],
            range: p.range,
            meaning: p.meaning.to_owned(),
            ..Effect::bare(path)
        })
    }

    /// Change of all responses for one standard deviation of an uncertain known.
    fn mode(
        &self,
        effect: &Effect,
        path: &str,
        mean: f64,
        sd: f64,
    ) -> Result<Option<Vec<[f64; 4]>>, CloseLoopError> {
        let Some(samples) = self.effects.get(path) else { return Ok(None) };
        let at = |s: f64| {
            let mut at = self.theta.clone();
            at.push(s);
            at
        };
        let model = self.effect_model(&self.base_model()?, effect, samples)?;
        let (up, down) = (model.at_knots(&at(mean + sd)), model.at_knots(&at(mean - sd)));
        let half = |(u, d): (&[f64; 4], &[f64; 4])| std::array::from_fn(|r| 0.5 * (u[r] - d[r]));
        Ok(Some(up.iter().zip(&down).map(half).collect()))
    }

    /// Film the motions of the calibrated point again, with a camera effect.
    fn film(
        &mut self,
        effect: &Effect,
        watch: &mut dyn FnMut(&Told),
    ) -> Result<Option<Change>, CloseLoopError> {
        let count = self.effort.replicates.min(3);
        let unit = effect.probes[1] - effect.null;
        let strengths = [effect.null, effect.null - unit, effect.null + unit];
        let mut rigs = Vec::new();
        for strength in strengths {
            for k in 0..count {
                let filling = self.runs.filling(Stage::Replicates, k);
                let (rig, axes) = (&self.setup.rig, &self.setup.axes);
                // Where the replicates were made; the best point has moved a little since.
                let at = &self.base[self.base.len() - 1].at.clone();
                rigs.push((
                    format!("{} = {strength:.4}", effect.path),
                    rig_with(rig, axes, at, (effect, strength), filling)?,
                ));
            }
        }
        let runs = self.runs.all(Stage::Filming, &rigs, watch)?;
        let means = |made: &Made| made.rows.iter().map(|(_, row)| row.mean).collect();
        let films: Vec<Films> = (0..count)
            .filter_map(|k| {
                let of = |which: usize| runs[which * count + k].as_ref().map(means);
                Some(Films { zero: of(0)?, down: of(1)?, up: of(2)? })
            })
            .collect();
        let loads: Vec<usize> = self.setup.knots.iter().map(|k| k.load).collect();
        let turns = effect.path == "camera.roll_deg";
        let filmed = Filmed::of(&films, &loads, (unit, turns));
        if filmed.is_none() {
            let why = "none of its films could be measured".to_owned();
            self.setup.catalogue.left_out.push((effect.path.clone(), why));
        }
        Ok(filmed.map(Change::Filmed))
    }
}
