//! Constants of the laws of one pair of materials.
//!
//! Some laws ask for more than a rig says. What is set here, once for all of them:
//!
//! | constant | value | source |
//! |---|---|---|
//! | linear stiffness `k_n` | that of Hertz at the impact speed `sqrt(g R)` of the drum, equal peak overlap | Navarro and de Souza Braun 2013 |
//! | linear shear stiffness | `k_n 4 G*/E*`, Mindlin's ratio of the slopes at one contact radius | Mindlin 1949 |
//! | Walton-Braun `K1`, `K0` | `k_n`; `4 G*/E*` times the normal slope; exponent 1/3 | Walton and Braun 1986 |
//! | rolling spring | stiffness factor 2.25, damping ratio 0.3 | Ai et al. 2011 |
//! | rolling viscosity | the cap is reached at `0.05 sqrt(g/r)` | ours: slow against the spins of a flowing layer |
//! | shear damping | the factor `alpha` of the normal law | Tsuji et al. 1992 |
//! | bridges | contact angle 0; the liquid of a particle in three bridges (coordination number 6) | ours |

use dem_core::contact::cohesion::Cohesionless;
use dem_core::contact::cohesion::sjkr::{Sjkr, SjkrSpec};
use dem_core::contact::elasticity::{ElasticPair, Elasticity};
use dem_core::contact::friction::{Friction, FrictionSpec};
use dem_core::contact::model::ContactModel;
use dem_core::contact::normal::hertz::damping_factor;
use dem_core::contact::normal::restitution::damping_ratio;
use dem_core::contact::normal::{
    AttractiveTail, DmtSpec, Hertz, HertzMatch, HertzSpec, JkrSpec, LinearSpringDashpotSpec,
    WaltonBraunSpec, YieldStiffness, linear_stiffness,
};
use dem_core::contact::rolling::{
    AbsoluteSpin, ConstantTorque, ConstantTorqueSpec, FreeRolling, RollingCoefficient,
    RollingSpringDashpotSpec, RollingStiffness, RollingViscosity, ViscousCappedSpec, ZhuSpec,
};
use dem_core::contact::tangential::{
    LinearSpringSpec, Mindlin, MindlinDeresiewiczSpec, MindlinSpec, MindlinTotalSpring,
    ShearStiffness, WaltonBraunShearSpec,
};
use dem_core::noncontact::{CapillaryBridge, CapillaryBridgeSpec};
use rig_schema::{Cohesion, Contact, NormalLaw, RollingLaw, TangentialLaw};

use super::{AnyCohesion, AnyNormal, AnyRolling, PartialSlipShear, SpringShear};
use crate::GRAVITY;
use crate::error::Error;

/// Which of the static products a rig runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Hertz, Mindlin, constant torque: the tail cut off or kept.
    HertzMindlin { cut_tail: bool },
    /// The same with the pull of simplified JKR.
    Cohesive { cut_tail: bool },
    /// EDEM's: the shear spring taken as a whole, the torque against each body's own spin.
    Edem { cut_tail: bool },
    /// Any laws with a shear spring.
    Spring,
    /// Any laws with micro-slip.
    PartialSlip,
}

impl Kind {
    pub(crate) fn of(contact: &Contact) -> Self {
        let hertz = contact.normal == NormalLaw::Hertz;
        let dry = matches!(contact.cohesion, Cohesion::None | Cohesion::Capillary);
        let constant = matches!(contact.rolling, RollingLaw::ConstantTorque | RollingLaw::None);
        let absolute = contact.rolling == RollingLaw::AbsoluteSpin;
        let cut_tail = !contact.attractive_tail;
        match contact.tangential {
            TangentialLaw::Mindlin if hertz && constant && dry => Self::HertzMindlin { cut_tail },
            TangentialLaw::Mindlin
                if hertz && constant && contact.cohesion == Cohesion::SimplifiedJkr =>
            {
                Self::Cohesive { cut_tail }
            }
            TangentialLaw::MindlinTotalSpring if hertz && absolute && dry => {
                Self::Edem { cut_tail }
            }
            TangentialLaw::Mindlin
            | TangentialLaw::MindlinTotalSpring
            | TangentialLaw::LinearSpring => Self::Spring,
            TangentialLaw::MindlinDeresiewicz | TangentialLaw::WaltonBraun => Self::PartialSlip,
        }
    }
}

/// The products that have a vector kernel.
pub(crate) type HertzMindlin<const CUT: bool, C = Cohesionless> =
    ContactModel<Hertz<CUT>, Mindlin, ConstantTorque, C>;
pub(crate) type Edem<const CUT: bool> =
    ContactModel<Hertz<CUT>, MindlinTotalSpring, AbsoluteSpin, Cohesionless>;

/// What the laws of one pair are made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Constants {
    pub(crate) contact: Contact,
    pub(crate) i: Elasticity,
    pub(crate) j: Elasticity,
    pub(crate) friction: FrictionSpec,
    pub(crate) rolling: f64,
    pub(crate) restitution: f64,
    /// Work of adhesion, J/m2.
    pub(crate) work_of_adhesion: f64,
    /// Cohesion energy density, J/m3.
    pub(crate) energy_density: f64,
    /// Effective radius and mass of a mean pair, m and kg.
    pub(crate) r_star: f64,
    pub(crate) m_star: f64,
    /// Radius of the drum, m.
    pub(crate) drum_radius: f64,
}

impl Constants {
    fn elastic(&self) -> ElasticPair {
        ElasticPair::new(&self.i, &self.j)
    }

    fn tail(&self) -> AttractiveTail {
        let kept = self.contact.attractive_tail
            || matches!(self.contact.cohesion, Cohesion::Jkr | Cohesion::Dmt);
        if kept { AttractiveTail::Kept } else { AttractiveTail::Cut }
    }

    /// The default laws.
    pub(crate) fn hertz_mindlin<const CUT: bool>(&self) -> Result<HertzMindlin<CUT>, Error> {
        let spec = HertzSpec { e_star: self.elastic().e_star, restitution: self.restitution };
        let normal = Hertz::<CUT>::try_from(spec)?;
        Ok(ContactModel {
            normal,
            tangential: self.mindlin()?.try_into()?,
            rolling: self.torque().try_into()?,
            cohesion: Cohesionless,
        })
    }

    /// The default laws with the pull of simplified JKR.
    pub(crate) fn cohesive<const CUT: bool>(&self) -> Result<HertzMindlin<CUT, Sjkr>, Error> {
        let HertzMindlin { normal, tangential, rolling, .. } = self.hertz_mindlin::<CUT>()?;
        let cohesion = SjkrSpec { energy_density: self.energy_density }.try_into()?;
        Ok(ContactModel { normal, tangential, rolling, cohesion })
    }

    /// EDEM's laws.
    pub(crate) fn edem<const CUT: bool>(&self) -> Result<Edem<CUT>, Error> {
        let HertzMindlin { normal, tangential, cohesion, .. } = self.hertz_mindlin::<CUT>()?;
        let rolling = AbsoluteSpin::try_from(self.torque())?;
        Ok(ContactModel { normal, tangential: MindlinTotalSpring(tangential), rolling, cohesion })
    }

    /// Any laws with a shear spring.
    pub(crate) fn spring(
        &self,
    ) -> Result<ContactModel<AnyNormal, SpringShear, AnyRolling, AnyCohesion>, Error> {
        let tangential = match self.contact.tangential {
            TangentialLaw::MindlinTotalSpring => {
                SpringShear::TotalSpring(MindlinTotalSpring::try_from(self.mindlin()?)?)
            }
            TangentialLaw::LinearSpring => SpringShear::Linear(
                LinearSpringSpec {
                    stiffness: self.linear_stiffness()? * self.shear_ratio(),
                    friction: self.friction,
                    damping_ratio: damping_ratio(self.restitution, self.tail())?,
                }
                .try_into()?,
            ),
            _ => SpringShear::Mindlin(self.mindlin()?.try_into()?),
        };
        let (normal, rolling, cohesion) = (self.normal()?, self.rolling()?, self.cohesion()?);
        Ok(ContactModel { normal, tangential, rolling, cohesion })
    }

    /// Any laws with micro-slip.
    pub(crate) fn partial_slip(
        &self,
    ) -> Result<ContactModel<AnyNormal, PartialSlipShear, AnyRolling, AnyCohesion>, Error> {
        let tangential = match self.contact.tangential {
            TangentialLaw::WaltonBraun => PartialSlipShear::WaltonBraun(
                WaltonBraunShearSpec {
                    stiffness: ShearStiffness::OfNormal(self.shear_ratio()),
                    gamma: 1.0 / 3.0,
                    friction: self.friction,
                }
                .try_into()?,
            ),
            _ => PartialSlipShear::MindlinDeresiewicz(
                MindlinDeresiewiczSpec { g_star: self.elastic().g_star, friction: self.friction }
                    .try_into()?,
            ),
        };
        let (normal, rolling, cohesion) = (self.normal()?, self.rolling()?, self.cohesion()?);
        Ok(ContactModel { normal, tangential, rolling, cohesion })
    }

    /// Bridge of one pair, if there is liquid: `volume` of one bridge, m3, `tension` N/m.
    pub(crate) fn bridge(volume: f64, tension: f64) -> Result<Option<CapillaryBridge>, Error> {
        if !(volume > 0.0 && tension > 0.0) {
            return Ok(None);
        }
        let spec = CapillaryBridgeSpec { surface_tension: tension, contact_angle_deg: 0.0, volume };
        Ok(Some(spec.try_into()?))
    }

    fn normal(&self) -> Result<AnyNormal, Error> {
        let (e_star, restitution) = (self.elastic().e_star, self.restitution);
        let w = self.work_of_adhesion;
        let cut = self.tail() == AttractiveTail::Cut;
        Ok(match (self.contact.normal, self.contact.cohesion) {
            (_, Cohesion::Jkr) if w > 0.0 => {
                AnyNormal::Jkr(JkrSpec { e_star, work_of_adhesion: w, restitution }.try_into()?)
            }
            (_, Cohesion::Dmt) if w > 0.0 => {
                AnyNormal::Dmt(DmtSpec { e_star, work_of_adhesion: w, restitution }.try_into()?)
            }
            (NormalLaw::Hertz, _) => {
                let spec = HertzSpec { e_star, restitution };
                if cut {
                    AnyNormal::HertzCut(spec.try_into()?)
                } else {
                    AnyNormal::HertzKept(spec.try_into()?)
                }
            }
            (NormalLaw::LinearSpringDashpot, _) => {
                let stiffness = self.linear_stiffness()?;
                let spec = LinearSpringDashpotSpec { stiffness, restitution };
                if cut {
                    AnyNormal::LinearCut(spec.try_into()?)
                } else {
                    AnyNormal::LinearKept(spec.try_into()?)
                }
            }
            (NormalLaw::WaltonBraun, _) => {
                let loading = YieldStiffness::Fixed(self.linear_stiffness()?);
                AnyNormal::WaltonBraun(WaltonBraunSpec { loading, restitution }.try_into()?)
            }
        })
    }

    fn rolling(&self) -> Result<AnyRolling, Error> {
        let coefficient = RollingCoefficient::Ratio(self.rolling);
        if self.rolling == 0.0 {
            return Ok(AnyRolling::Free(FreeRolling));
        }
        // The cap `arm N` is reached at this spin: `c_1 N spin = arm N`.
        let spin = 0.05 * (GRAVITY / self.r_star).sqrt();
        let viscosity = RollingViscosity::PerLoad(self.rolling * self.r_star / spin);
        let viscous = ViscousCappedSpec { coefficient, viscosity };
        Ok(match self.contact.rolling {
            RollingLaw::None => AnyRolling::Free(FreeRolling),
            RollingLaw::ConstantTorque => AnyRolling::ConstantTorque(self.torque().try_into()?),
            RollingLaw::ViscousCapped => AnyRolling::ViscousCapped(viscous.try_into()?),
            RollingLaw::SpringDashpot => AnyRolling::SpringDashpot(
                RollingSpringDashpotSpec {
                    coefficient,
                    stiffness: RollingStiffness::OfNormal(2.25),
                    damping_ratio: 0.3,
                }
                .try_into()?,
            ),
            RollingLaw::Zhu => {
                AnyRolling::Zhu(ZhuSpec { torque: viscous, inertia_share: None }.try_into()?)
            }
            RollingLaw::AbsoluteSpin => {
                AnyRolling::AbsoluteSpin(AbsoluteSpin::try_from(self.torque())?)
            }
        })
    }

    fn cohesion(&self) -> Result<AnyCohesion, Error> {
        Ok(match self.contact.cohesion {
            Cohesion::SimplifiedJkr if self.energy_density > 0.0 => {
                AnyCohesion::Sjkr(SjkrSpec { energy_density: self.energy_density }.try_into()?)
            }
            _ => AnyCohesion::None(Cohesionless),
        })
    }

    fn torque(&self) -> ConstantTorqueSpec {
        let ratio = if self.contact.rolling == RollingLaw::None { 0.0 } else { self.rolling };
        ConstantTorqueSpec { coefficient: RollingCoefficient::Ratio(ratio) }
    }

    fn mindlin(&self) -> Result<MindlinSpec, Error> {
        Ok(MindlinSpec {
            g_star: self.elastic().g_star,
            friction: self.friction,
            damping: damping_factor(self.restitution, self.tail())?,
        })
    }

    /// `4 G*/E*`: shear over normal slope at equal contact radius.
    fn shear_ratio(&self) -> f64 {
        let e = self.elastic();
        4.0 * e.g_star / e.e_star
    }

    fn linear_stiffness(&self) -> Result<f64, Error> {
        let speed = (GRAVITY * self.drum_radius).sqrt();
        let e_star = self.elastic().e_star;
        Ok(linear_stiffness(e_star, self.r_star, self.m_star, speed, HertzMatch::PeakOverlap)?)
    }
}

/// Friction of a pair, checked.
pub(crate) fn friction(
    mu: f64,
    kinetic_ratio: f64,
    decay_speed: f64,
) -> Result<FrictionSpec, Error> {
    let spec = FrictionSpec {
        mu_static: mu,
        mu_kinetic: (kinetic_ratio < 1.0).then_some(mu * kinetic_ratio),
        decay_speed: (decay_speed > 0.0).then_some(decay_speed),
    };
    Friction::try_from(spec)?;
    Ok(spec)
}
