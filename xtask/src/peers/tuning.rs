//! Which setting is the fastest on a machine that others use.

/// Rounds in which settings are tried in turn.
const ROUNDS: usize = 5;

/// The fastest of some settings, and the least time of each over some rounds in which all are tried in turn: others on the
/// machine only ever take time.
pub(crate) fn fastest<const N: usize>(
    settings: [f64; N],
    mut time: impl FnMut(f64) -> anyhow::Result<f64>,
) -> anyhow::Result<(f64, [f64; N])> {
    let mut least = [f64::INFINITY; N];
    for _ in 0..ROUNDS {
        for (least, setting) in least.iter_mut().zip(settings) {
            *least = least.min(time(setting)?);
        }
    }
    let best = settings.into_iter().zip(least).min_by(|a, b| a.1.total_cmp(&b.1));
    Ok((best.map_or(f64::NAN, |best| best.0), least))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_setting_is_judged_by_its_fastest_run() {
        // The second is the fastest but for what disturbs all of its runs but one.
        let mut times =
            [5.0, 9.0, 4.0, 4.5, 3.0, 4.2, 4.4, 8.0, 4.1, 6.0, 7.0, 5.0, 4.6, 9.0, 4.3].into_iter();
        let settings = [0.1, 0.2, 0.3];
        let (best, least) = fastest(settings, |_| Ok(times.next().unwrap())).unwrap();
        assert_eq!(least, [4.4, 3.0, 4.0]);
        assert_eq!(best, 0.2);
        assert!(fastest(settings, |_| anyhow::bail!("failed")).is_err());
    }
}
