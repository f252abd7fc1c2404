//! Fractions of the two-level factorial, of highest resolution and least aberration.
//!
//! A fraction 2^(k-p) runs a full factorial in k - p factors; each of the other p factors is set
//! to the product of some of them (its generator). Products of generators give 2^p - 1 words,
//! products of factors that are constant over the plan; the shortest word is the resolution:
//! III aliases main effects with pairs, IV pairs with pairs, V neither. Among the choices of
//! generators, the one with the fewest shortest words, then the fewest next ones, has the least
//! aberration (A. Fries, W. G. Hunter, Technometrics 22, 1980). All choices are tried.

use super::Design;
use crate::error::DoeError;
use crate::factor::{Factor, check_factors};

/// Most factors: the search takes under a second up to here.
const MOST_FACTORS: usize = 11;

/// A fraction with what it aliases.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fraction {
    /// The runs.
    pub design: Design,
    /// Each generated factor with the factors it is the product of, by name.
    pub generators: Vec<(String, Vec<String>)>,
    /// Length of the shortest word.
    pub resolution: usize,
    /// Number of words of each length, from length 0 to the number of factors.
    pub word_lengths: Vec<usize>,
}

/// The 2^(k-p) fraction of highest resolution and least aberration; `generated` is p.
///
/// ```
/// use doe::{Factor, design::fractional_factorial};
/// let names = ["a", "b", "c", "d", "e"];
/// let factors = names.map(|n| Factor::new(n, 0.0, 1.0)).into_iter().collect::<Result<Vec<_>, _>>()?;
/// let half = fractional_factorial(&factors, 1)?;
/// assert_eq!((half.design.runs(), half.resolution), (16, 5));
/// # Ok::<(), doe::DoeError>(())
/// ```
///
/// # Errors
/// Invalid factors, fewer than 3 or more than 11 of them, or more generated factors than a plan
/// of resolution III has room for.
pub fn fractional_factorial(factors: &[Factor], generated: usize) -> Result<Fraction, DoeError> {
    check_factors(factors)?;
    let k = factors.len();
    let refuse = |what, got, expected| DoeError::Design {
        design: "fractional factorial",
        what,
        got,
        expected,
    };
    if !(3..=MOST_FACTORS).contains(&k) {
        return Err(refuse("number of factors", k, "from 3 to 11"));
    }
    let room = "at least 1, and few enough for the products of the other factors";
    if generated == 0 || generated >= k {
        return Err(refuse("number of generated factors", generated, room));
    }
    let base = k - generated;
    let words = (3..=k)
        .rev()
        .find_map(|resolution| Search::new(base, generated, resolution).run())
        .ok_or_else(|| refuse("number of generated factors", generated, room))?;

    let sign = |run: usize, word: u32| {
        // Product of -1 for each factor of the word that is low.
        let low = (word & !(run as u32)).count_ones();
        if low.is_multiple_of(2) { 1.0 } else { -1.0 }
    };
    let base_bits = (1_u32 << base) - 1;
    let coded: Vec<Vec<f64>> = (0..1_usize << base)
        .map(|run| {
            let own = (0..base).map(|j| sign(run, 1 << j));
            own.chain(words.generators.iter().map(|w| sign(run, w & base_bits))).collect()
        })
        .collect();
    let named = |word: u32| -> Vec<String> {
        (0..base).filter(|j| word >> j & 1 == 1).map(|j| factors[j].name.clone()).collect()
    };
    let generators = words
        .generators
        .iter()
        .zip(&factors[base..])
        .map(|(word, f)| (f.name.clone(), named(*word)))
        .collect();
    let resolution = words.lengths.iter().position(|n| *n > 0).unwrap_or(k);
    Ok(Fraction {
        design: Design::from_coded(factors, &coded),
        generators,
        resolution,
        word_lengths: words.lengths,
    })
}

/// Generators as words (bit j for factor j), with the number of words of each length.
#[derive(Clone)]
struct Words {
    generators: Vec<u32>,
    lengths: Vec<usize>,
}

/// Tries every set of generators whose words all have at least the wanted length.
struct Search {
    candidates: Vec<u32>,
    base: usize,
    generated: usize,
    resolution: usize,
    best: Option<Words>,
}

impl Search {
    fn new(base: usize, generated: usize, resolution: usize) -> Self {
        // The generated factor itself is one letter of its word.
        let candidates =
            (1_u32..1 << base).filter(|s| s.count_ones() as usize + 1 >= resolution).collect();
        Self { candidates, base, generated, resolution, best: None }
    }

    fn run(mut self) -> Option<Words> {
        self.extend(0, &mut Vec::new(), &mut vec![0]);
        self.best
    }

    /// `group` holds every product of the generators chosen so far, the empty one first.
    fn extend(&mut self, from: usize, chosen: &mut Vec<u32>, group: &mut Vec<u32>) {
        if chosen.len() == self.generated {
            let mut lengths = vec![0; self.base + self.generated + 1];
            group[1..].iter().for_each(|w| lengths[w.count_ones() as usize] += 1);
            if self.best.as_ref().is_none_or(|b| lengths < b.lengths) {
                self.best = Some(Words { generators: chosen.clone(), lengths });
            }
            return;
        }
        for i in from..self.candidates.len() {
            let word = self.candidates[i] | 1 << (self.base + chosen.len());
            let size = group.len();
            if group.iter().any(|w| ((w ^ word).count_ones() as usize) < self.resolution) {
                continue;
            }
            group.extend_from_within(..);
            group[size..].iter_mut().for_each(|w| *w ^= word);
            chosen.push(word);
            self.extend(i + 1, chosen, group);
            chosen.pop();
            group.truncate(size);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fraction(k: usize, p: usize) -> Fraction {
        let f: Vec<Factor> = (0..k).map(|i| Factor::uncoded(format!("x{i}")).unwrap()).collect();
        fractional_factorial(&f, p).unwrap()
    }

    #[test]
    fn resolutions_are_the_published_ones() {
        // D. C. Montgomery, Design and Analysis of Experiments, table of 2^(k-p) designs.
        for (k, p, resolution) in [
            (3, 1, 3),
            (4, 1, 4),
            (5, 1, 5),
            (5, 2, 3),
            (6, 2, 4),
            (6, 3, 3),
            (7, 1, 7),
            (7, 2, 4),
            (7, 3, 4),
            (7, 4, 3),
            (8, 2, 5),
            (8, 3, 4),
            (8, 4, 4),
            (9, 2, 6),
            (9, 5, 3),
            (10, 3, 5),
            (10, 5, 4),
            (11, 4, 5),
            (11, 6, 4),
            (11, 7, 3),
        ] {
            let plan = fraction(k, p);
            assert_eq!(plan.resolution, resolution, "2^({k}-{p})");
            assert_eq!(plan.design.runs(), 1 << (k - p));
        }
        assert_eq!(fraction(7, 4).design.runs(), 8);
        assert_eq!(fraction(11, 4).design.runs(), 128);
    }

    #[test]
    fn seven_factors_in_eight_runs_have_the_words_of_the_fano_plane() {
        assert_eq!(fraction(7, 4).word_lengths, [0, 0, 0, 7, 7, 0, 0, 1]);
    }

    #[test]
    fn words_are_constant_over_the_plan_and_shorter_products_are_balanced() {
        let plan = fraction(6, 2);
        let mut constant = vec![0; 7];
        for subset in 1_u32..1 << 6 {
            let product = |row: &Vec<f64>| -> f64 {
                (0..6).filter(|j| subset >> j & 1 == 1).map(|j| row[j]).product()
            };
            let sum: f64 = plan.design.points.iter().map(product).sum();
            assert!(sum.abs() == 0.0 || sum.abs() == 16.0);
            if sum != 0.0 {
                constant[subset.count_ones() as usize] += 1;
            }
        }
        assert_eq!(constant, plan.word_lengths);
    }

    #[test]
    fn more_factors_than_runs_have_room_for_are_refused() {
        let f: Vec<Factor> = (0..8).map(|i| Factor::uncoded(format!("x{i}")).unwrap()).collect();
        assert!(matches!(fractional_factorial(&f, 5), Err(DoeError::Design { got: 5, .. })));
        assert!(matches!(fractional_factorial(&f, 0), Err(DoeError::Design { got: 0, .. })));
        assert!(matches!(fractional_factorial(&f[..2], 1), Err(DoeError::Design { .. })));
    }
}
