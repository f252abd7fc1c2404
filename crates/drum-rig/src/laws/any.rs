//! Laws chosen by name: each enum holds one law of its role and passes every call on to it.

use dem_core::contact::cohesion::{Cohesionless, sjkr::Sjkr};
use dem_core::contact::kinematics::{Kinematics, PairGeometry};
use dem_core::contact::law::{
    CohesionLaw, CohesionResponse, Memory, NormalLaw, NormalResponse, RollingLaw, RollingResponse,
    TangentialLaw, TangentialResponse,
};
use dem_core::contact::normal::jkr::Bond;
use dem_core::contact::normal::walton_braun::PeakOverlap;
use dem_core::contact::normal::{
    Dmt, HertzTailCut, HertzTailKept, Jkr, LinearTailCut, LinearTailKept, WaltonBraun,
};
use dem_core::contact::rolling::{
    AbsoluteSpin, ConstantTorque, FreeRolling, RollingSpringDashpot, ViscousCapped, Zhu,
};
use dem_core::contact::spring::SpringMemory;
use dem_core::contact::tangential::partial_slip::PartialSlipMemory;
use dem_core::contact::tangential::{
    LinearSpring, Mindlin, MindlinDeresiewicz, MindlinTotalSpring, WaltonBraunShear,
};
use dem_core::glam::DVec3;

/// A normal law, adhesive ones included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum AnyNormal {
    HertzCut(HertzTailCut),
    HertzKept(HertzTailKept),
    LinearCut(LinearTailCut),
    LinearKept(LinearTailKept),
    WaltonBraun(WaltonBraun),
    Jkr(Jkr),
    Dmt(Dmt),
}

/// The one number that a normal law remembers: a bond (JKR) or the largest overlap
/// (Walton and Braun).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct NormalMemory {
    number: [f64; 1],
}

impl Memory for NormalMemory {
    const SLOTS: usize = 1;
    #[inline]
    fn store(&self, slots: &mut [f64]) {
        slots[0] = self.number[0];
    }
    #[inline]
    fn load(slots: &[f64]) -> Self {
        Self { number: [slots[0]] }
    }
    #[inline]
    fn transport(&mut self, _: DVec3, _: f64) {}
}

impl NormalMemory {
    #[inline]
    fn with<T: Memory>(
        &mut self,
        respond: impl FnOnce(&mut T) -> NormalResponse,
    ) -> NormalResponse {
        let mut own = T::load(&self.number);
        let response = respond(&mut own);
        own.store(&mut self.number);
        response
    }
}

impl NormalLaw for AnyNormal {
    type Memory = NormalMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        memory: &mut NormalMemory,
    ) -> NormalResponse {
        match self {
            Self::HertzCut(law) => law.respond(pair, motion, &mut ()),
            Self::HertzKept(law) => law.respond(pair, motion, &mut ()),
            Self::LinearCut(law) => law.respond(pair, motion, &mut ()),
            Self::LinearKept(law) => law.respond(pair, motion, &mut ()),
            Self::WaltonBraun(law) => {
                memory.with(|own: &mut PeakOverlap| law.respond(pair, motion, own))
            }
            Self::Jkr(law) => memory.with(|own: &mut Bond| law.respond(pair, motion, own)),
            Self::Dmt(law) => law.respond(pair, motion, &mut ()),
        }
    }

    fn reach(&self, pair: &PairGeometry) -> f64 {
        match self {
            Self::Jkr(law) => law.reach(pair),
            _ => 0.0,
        }
    }
}

/// A tangential law with a shear spring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum SpringShear {
    Mindlin(Mindlin),
    TotalSpring(MindlinTotalSpring),
    Linear(LinearSpring),
}

impl TangentialLaw for SpringShear {
    type Memory = SpringMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut SpringMemory,
    ) -> TangentialResponse {
        match self {
            Self::Mindlin(law) => law.respond(pair, motion, normal, memory),
            Self::TotalSpring(law) => law.respond(pair, motion, normal, memory),
            Self::Linear(law) => law.respond(pair, motion, normal, memory),
        }
    }
}

/// A tangential law with micro-slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum PartialSlipShear {
    MindlinDeresiewicz(MindlinDeresiewicz),
    WaltonBraun(WaltonBraunShear),
}

impl TangentialLaw for PartialSlipShear {
    type Memory = PartialSlipMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut PartialSlipMemory,
    ) -> TangentialResponse {
        match self {
            Self::MindlinDeresiewicz(law) => law.respond(pair, motion, normal, memory),
            Self::WaltonBraun(law) => law.respond(pair, motion, normal, memory),
        }
    }
}

/// A rolling law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum AnyRolling {
    Free(FreeRolling),
    ConstantTorque(ConstantTorque),
    ViscousCapped(ViscousCapped),
    SpringDashpot(RollingSpringDashpot),
    Zhu(Zhu),
    AbsoluteSpin(AbsoluteSpin),
}

impl RollingLaw for AnyRolling {
    type Memory = SpringMemory;

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        memory: &mut SpringMemory,
    ) -> RollingResponse {
        match self {
            Self::Free(law) => law.respond(pair, motion, normal, &mut ()),
            Self::ConstantTorque(law) => law.respond(pair, motion, normal, &mut ()),
            Self::ViscousCapped(law) => law.respond(pair, motion, normal, &mut ()),
            Self::SpringDashpot(law) => law.respond(pair, motion, normal, memory),
            Self::Zhu(law) => law.respond(pair, motion, normal, &mut ()),
            Self::AbsoluteSpin(law) => law.respond(pair, motion, normal, &mut ()),
        }
    }
}

/// A cohesion law that is added to a normal law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum AnyCohesion {
    None(Cohesionless),
    Sjkr(Sjkr),
}

impl CohesionLaw for AnyCohesion {
    type Memory = ();

    #[inline]
    fn respond(
        &self,
        pair: &PairGeometry,
        motion: &Kinematics,
        normal: &NormalResponse,
        (): &mut (),
    ) -> CohesionResponse {
        match self {
            Self::None(law) => law.respond(pair, motion, normal, &mut ()),
            Self::Sjkr(law) => law.respond(pair, motion, normal, &mut ()),
        }
    }
}
