//! What another camera shows of the same motions.
//!
//! A camera is turned to either side and the same motions are filmed again, at one friction. Of a camera that is turned about its
//! axis geometry says most: lines are steeper by the angle, the centre of area is carried about the axis, wherever the bed lies. So
//! only what films show beside that is learnt from them. It is about linear: `first v + second v^2` with `v` in units of the
//! strength that was filmed, and how well films tell it is what they differ by from one motion to the next.
//! (Before, `second` was taken as it was read, and carried the errors of three films fourfold to twice the strength without
//! being counted: a camera at -4 deg was read 0.25 deg wrong where 0.02 were thought.)

/// What a camera effect does to the responses at each knot.
#[derive(Debug, Clone, PartialEq)]
pub struct Filmed {
    /// Whether strengths are degrees by which the picture is turned.
    turns: bool,
    /// Strength over this is the unit.
    unit: f64,
    /// Change for one unit, beside the turn.
    first: Vec<[f64; 4]>,
    /// Change for its square.
    second: Vec<[f64; 4]>,
    /// Variance of `first`, by knot.
    of_first: Vec<[f64; 4]>,
    /// Variance of `second`, by knot.
    of_second: Vec<[f64; 4]>,
}

/// How curved a change may be, degrees or per cent of the radius for one unit: by a few degrees, of which the cosine is 0.999, a
/// picture is narrowed by less than this. A standard deviation.
const CURVED: f64 = 0.05;

/// Standard deviation of half the difference of two films of one motion where no second motion tells it: how well lines and
/// centre of some frames are read.
const READ: f64 = 0.1;

/// Variance below which no change is known.
const LEAST: f64 = 1e-4;

/// The responses that one motion has at each knot, filmed as it is and by a camera that is turned by one unit down and up.
pub(crate) struct Films {
    pub(crate) zero: Vec<[f64; 4]>,
    pub(crate) down: Vec<[f64; 4]>,
    pub(crate) up: Vec<[f64; 4]>,
}

impl Filmed {
    /// From films of some motions; the loads tell which knots are read alike. `None` without a motion.
    pub(crate) fn of(films: &[Films], loads: &[usize], (unit, turns): (f64, bool)) -> Option<Self> {
        if films.is_empty() {
            return None;
        }
        let motions = films.len() as f64;
        let turned = |four: &[f64; 4], by: f64| if turns { turned(*four, by) } else { *four };
        // Of each motion: first, second.
        let each: Vec<[Vec<[f64; 4]>; 2]> = films
            .iter()
            .map(|f| {
                let beside = |seen: &Vec<[f64; 4]>, by: f64| -> Vec<[f64; 4]> {
                    let one = |(s, z): (&[f64; 4], &[f64; 4])| less(*s, turned(z, by));
                    seen.iter().zip(&f.zero).map(one).collect()
                };
                let (down, up) = (beside(&f.down, -unit), beside(&f.up, unit));
                [-1.0, 1.0].map(|sign| {
                    let both = down.iter().zip(&up);
                    both.map(|(d, u)| std::array::from_fn(|r| 0.5 * (u[r] + sign * d[r]))).collect()
                })
            })
            .collect();
        let mean = |which: usize| -> Vec<[f64; 4]> {
            let knot = |k: usize| -> [f64; 4] {
                std::array::from_fn(|r| each.iter().map(|e| e[which][k][r]).sum::<f64>() / motions)
            };
            (0..loads.len()).map(knot).collect()
        };
        let variance = |which: usize, mean: &[[f64; 4]], alone: f64| -> Vec<[f64; 4]> {
            let of_load = |load: usize, r: usize| {
                let own: Vec<usize> = (0..loads.len()).filter(|k| loads[*k] == load).collect();
                let miss = |k: &usize| -> f64 {
                    each.iter().map(|e| (e[which][*k][r] - mean[*k][r]).powi(2)).sum()
                };
                let sum: f64 = own.iter().map(miss).sum();
                let witnesses = (motions - 1.0) * own.len() as f64;
                if witnesses > 0.0 { sum / witnesses / motions } else { alone }
            };
            loads.iter().map(|l| std::array::from_fn(|r| of_load(*l, r))).collect()
        };
        let (first, mut second) = (mean(0), mean(1));
        let mut of_first = variance(0, &first, READ * READ);
        // Half the sum of two films less a third one scatters by three times the variance of half a difference.
        let mut of_second = variance(1, &second, 3.0 * READ * READ);
        of_first.iter_mut().flatten().for_each(|v| *v += LEAST);
        for (s, v) in second.iter_mut().flatten().zip(of_second.iter_mut().flatten()) {
            let believed = CURVED * CURVED / (CURVED * CURVED + *v);
            *s *= believed;
            *v *= believed;
        }
        Some(Self { turns, unit, first, second, of_first, of_second })
    }

    /// Change the means at knot `k` by a strength that departs so far from "absent".
    pub(crate) fn shift(&self, k: usize, departure: f64, four: &mut [f64; 4]) {
        if self.turns {
            *four = turned(*four, departure);
        }
        let v = departure / self.unit;
        for (r, value) in four.iter_mut().enumerate() {
            *value += v * self.first[k][r] + v * v * self.second[k][r];
        }
    }

    /// Variances of that change.
    pub(crate) fn variance(&self, k: usize, departure: f64) -> [f64; 4] {
        let v2 = (departure / self.unit).powi(2);
        std::array::from_fn(|r| v2 * self.of_first[k][r] + v2 * v2 * self.of_second[k][r])
    }
}

fn less(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    std::array::from_fn(|r| a[r] - b[r])
}

/// Responses (whole and middle line, deg; centre, to the raised side and below the axis) in a picture that is turned so that lines
/// are steeper by so many degrees.
fn turned([lin, mid, x, y]: [f64; 4], degrees: f64) -> [f64; 4] {
    let (sin, cos) = degrees.to_radians().sin_cos();
    [lin + degrees, mid + degrees, x * cos + y * sin, y * cos - x * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    const BED: [f64; 4] = [30.0, 31.0, 23.5, 39.2];

    /// Films of motions that are read wrong by `misses` times 0.1, by motion and then as it is, down, up.
    fn films(misses: &[[f64; 3]], show: impl Fn(f64) -> [f64; 4]) -> Vec<Films> {
        let knots = |by: f64, miss: f64| vec![show(by).map(|v| v + 0.1 * miss); 2];
        let one = |[z, d, u]: &[f64; 3]| Films {
            zero: knots(0.0, *z),
            down: knots(-2.0, *d),
            up: knots(2.0, *u),
        };
        misses.iter().map(one).collect()
    }

    #[test]
    fn a_turned_picture_carries_the_centre_about_the_axis() {
        let [lin, mid, x, y] = turned(BED, -4.0);
        assert_eq!([lin, mid], [26.0, 27.0]);
        assert!((x.hypot(y) - 23.5f64.hypot(39.2)).abs() < 1e-12);
        // A bed at 30.94 deg from the plumb line lies at 26.94.
        assert!((x.atan2(y).to_degrees() - (23.5f64.atan2(39.2).to_degrees() - 4.0)).abs() < 1e-12);
    }

    #[test]
    fn a_turn_holds_for_beds_that_nobody_filmed() {
        let shown = films(&[[0.0; 3]; 2], |by| turned(BED, by));
        let change = Filmed::of(&shown, &[0, 0], (2.0, true)).unwrap();
        let steep = [40.0, 43.0, 33.0, 30.0];
        let mut four = steep;
        change.shift(1, -4.0, &mut four);
        let off = less(four, turned(steep, -4.0));
        assert!(off.iter().all(|d| d.abs() < 1e-12), "{off:?}");
        assert!(change.variance(1, -4.0).iter().all(|v| *v < 4.01 * LEAST));
    }

    #[test]
    fn what_films_are_read_wrong_by_is_counted_and_not_carried_far() {
        // Three motions, read by 0.1 deg wrong: half a difference of two films by 0.07, their mean less a third one by 0.12.
        let misses = [[1.0, -0.5, 0.8], [-1.2, 0.6, -0.4], [0.3, -1.1, 0.2]];
        let shown = films(&misses, |by| [30.0 + 0.5 * by, 31.0, 23.5, 39.2]);
        let change = Filmed::of(&shown, &[0, 0], (2.0, false)).unwrap();
        let mut four = BED;
        change.shift(0, -4.0, &mut four);
        let off = less(four, [28.0, 31.0, 23.5, 39.2]);
        let sd = change.variance(0, -4.0).map(f64::sqrt);
        for r in 0..4 {
            assert!(off[r].abs() < 2.5 * sd[r] && (0.05..0.3).contains(&sd[r]), "{off:?} {sd:?}");
        }
        // One motion tells nothing of how well it is read.
        let one = Filmed::of(&shown[..1], &[0, 0], (2.0, false)).unwrap();
        assert!(one.variance(0, 2.0)[0] >= READ * READ);
        assert!(Filmed::of(&[], &[0, 0], (2.0, false)).is_none());
    }

    #[test]
    fn a_curved_change_is_believed_as_far_as_films_tell_it() {
        let curved = |by: f64| [30.0 - 0.05 * by * by, 31.0, 23.5, 39.2];
        let sure = Filmed::of(&films(&[[0.0; 3]; 3], curved), &[0, 1], (2.0, false)).unwrap();
        let mut four = BED;
        sure.shift(0, 4.0, &mut four);
        assert!((four[0] - 29.2).abs() < 1e-9, "{four:?}");
    }
}
