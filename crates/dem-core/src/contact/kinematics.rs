//! What two touching bodies know of their relative motion.

use glam::DVec3;

/// Size and inertia of a pair, independent of its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairGeometry {
    /// Effective radius `R_i R_j / (R_i + R_j)`, m (a flat wall has an infinite radius).
    pub r_star: f64,
    /// Effective mass `m_i m_j / (m_i + m_j)`, kg (a wall has an infinite mass).
    pub m_star: f64,
    /// Radius of sphere i, m.
    pub radius_i: f64,
    /// Radius of sphere j, m (infinite for a flat wall, negative for a hollow cylinder).
    pub radius_j: f64,
}

/// Relative position and motion of one contact.
///
/// All vectors are in the laboratory frame. Body j may be a wall: its own motion at the contact
/// point is already inside `slip_velocity` and `overlap_rate`, its spin inside `spin_j`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kinematics {
    /// Unit vector from the centre of i towards j.
    pub normal_i_to_j: DVec3,
    /// Overlap, m; positive when touching, negative across a gap.
    pub overlap: f64,
    /// Rate of the overlap, m/s; positive on approach.
    pub overlap_rate: f64,
    /// Tangential velocity of i's contact point relative to j's, m/s.
    pub slip_velocity: DVec3,
    /// Angular velocity of i, rad/s.
    pub spin_i: DVec3,
    /// Angular velocity of j, rad/s.
    pub spin_j: DVec3,
    /// Distance from i's centre to the contact point, m.
    pub lever_i: f64,
    /// Distance from j's centre to the contact point, m (0 for a wall: its motion is prescribed).
    pub lever_j: f64,
    /// Time step, s.
    pub dt: f64,
}

impl Kinematics {
    /// Relative angular velocity `omega_i - omega_j`, rad/s.
    #[inline]
    pub fn relative_spin(&self) -> DVec3 {
        self.spin_i - self.spin_j
    }

    /// Part of the relative spin that rolls, rad/s: perpendicular to the normal.
    #[inline]
    pub fn rolling_spin(&self) -> DVec3 {
        let w = self.relative_spin();
        w - self.normal_i_to_j * w.dot(self.normal_i_to_j)
    }

    /// Part of the relative spin that twists about the normal, rad/s.
    #[inline]
    pub fn torsion_spin(&self) -> f64 {
        self.relative_spin().dot(self.normal_i_to_j)
    }
}
