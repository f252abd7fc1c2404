//! Central composite design: a two-level factorial, a star on the axes, and centre points.

use super::Design;
use crate::error::DoeError;
use crate::factor::{Factor, check_factors};

/// How far out the star points lie, in coded units.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AxialDistance {
    /// On the faces of the cube: no run leaves the factors' ranges.
    FaceCentred,
    /// 2^(k/4): the variance of prediction depends on the distance from the centre alone.
    Rotatable,
    /// Any other distance.
    Coded(f64),
}

/// A full two-level factorial with star points and centre points: 2^k + 2k + `centres` runs.
///
/// A rotatable star leaves the factors' ranges; the points are not cut back.
///
/// ```
/// use doe::{Factor, design::{AxialDistance, central_composite}};
/// let f = [Factor::uncoded("a")?, Factor::uncoded("b")?];
/// let plan = central_composite(&f, AxialDistance::Rotatable, 5)?;
/// assert_eq!(plan.runs(), 4 + 4 + 5);
/// assert!((plan.points[5][0] - 2.0_f64.sqrt()).abs() < 1e-14);
/// # Ok::<(), doe::DoeError>(())
/// ```
///
/// # Errors
/// Invalid factors, fewer than 2 or more than 10 of them, a distance that is not positive.
pub fn central_composite(
    factors: &[Factor],
    axial: AxialDistance,
    centres: usize,
) -> Result<Design, DoeError> {
    check_factors(factors)?;
    let k = factors.len();
    if !(2..=10).contains(&k) {
        return Err(DoeError::Design {
            design: "central composite",
            what: "number of factors",
            got: k,
            expected: "from 2 to 10",
        });
    }
    let alpha = match axial {
        AxialDistance::FaceCentred => 1.0,
        AxialDistance::Rotatable => 2.0_f64.powf(0.25 * k as f64),
        AxialDistance::Coded(alpha) if alpha.is_finite() && alpha > 0.0 => alpha,
        AxialDistance::Coded(value) => return Err(DoeError::AxialDistance { value }),
    };
    let sign = |run: usize, j: usize| if run >> j & 1 == 1 { 1.0 } else { -1.0 };
    let mut coded: Vec<Vec<f64>> =
        (0..1_usize << k).map(|run| (0..k).map(|j| sign(run, j)).collect()).collect();
    for j in 0..k {
        for end in [-alpha, alpha] {
            let mut point = vec![0.0; k];
            point[j] = end;
            coded.push(point);
        }
    }
    Ok(Design::from_coded(factors, &coded).with_centre_points(centres))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Model, ModelTerms, Weighting, fit};

    fn factors(k: usize) -> Vec<Factor> {
        (0..k).map(|i| Factor::uncoded(format!("x{i}")).unwrap()).collect()
    }

    #[test]
    fn a_rotatable_plan_predicts_equally_well_in_every_direction() {
        let f = factors(3);
        let plan = central_composite(&f, AxialDistance::Rotatable, 4).unwrap();
        let model = Model::new(&f, &ModelTerms::quadratic(&f)).unwrap();
        let y: Vec<f64> = (0..plan.runs()).map(|i| ((i * 37) % 11) as f64).collect();
        let fit = fit(&model, &plan.points, &y, Weighting::Ordinary).unwrap();
        let third = 1.0 / 3.0_f64.sqrt();
        let at = |x: [f64; 3]| fit.predict(&x).unwrap().var_mean;
        let (axis, diagonal) = (at([1.0, 0.0, 0.0]), at([third, third, -third]));
        // Exact but for the rounding of alpha to 15 digits.
        assert!((axis / diagonal - 1.0).abs() < 1.0e-12);
    }

    #[test]
    fn a_face_centred_plan_stays_in_the_cube() {
        let plan = central_composite(&factors(4), AxialDistance::FaceCentred, 1).unwrap();
        assert_eq!(plan.runs(), 16 + 8 + 1);
        assert!(plan.points.iter().flatten().all(|x| x.abs() <= 1.0));
        assert!(central_composite(&factors(1), AxialDistance::FaceCentred, 1).is_err());
        assert!(central_composite(&factors(2), AxialDistance::Coded(f64::NAN), 1).is_err());
    }
}
