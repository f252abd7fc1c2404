//! Draws what stands still, and the analytic bed, pixel by pixel: each pixel asks what its ray meets first.

use glam::DVec2;

use crate::bed::BedShape;
use crate::camera::View;
use crate::canvas::{Canvas, Color, mixed, scaled};
use crate::effects::Exposure;
use crate::light::Lamp;
use crate::scene::{HubPart, Scene};
use crate::texture::{Texture, hash, unit};
use crate::truth::rear_shrink;

/// Steps from the front plate to the rear wall when looking for the free surface of an extruded bed.
const DEPTH_STEPS: u32 = 24;

/// What a ray meets first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Background,
    Plate,
    Ring,
    Hub(HubPart),
    BedFront,
    BedTop,
    Tube,
    RearWall,
}

/// An analytic bed with its looks.
pub(crate) struct DressedBed<'a> {
    pub(crate) shape: &'a BedShape,
    pub(crate) texture: &'a Texture,
    pub(crate) exposure: &'a Exposure,
}

/// The scene as one view sees it.
pub(crate) struct Stage<'a> {
    scene: &'a Scene,
    view: &'a View,
    bed: Option<DressedBed<'a>>,
    lamp: Lamp,
    /// Foot of the pinhole on the front plane (radii, x towards the raised side) and shrink of the rear wall.
    foot: DVec2,
    s_rear: f64,
    /// The same foot in world axes.
    foot_world: DVec2,
}

impl<'a> Stage<'a> {
    pub(crate) fn new(
        scene: &'a Scene,
        view: &'a View,
        lamp: Lamp,
        bed: Option<DressedBed<'a>>,
    ) -> Self {
        let raised = bed.as_ref().map(|b| b.shape.raised()).unwrap_or_default();
        let (foot, s_rear) = rear_shrink(raised, scene, view);
        let foot_world = DVec2::new(foot.x * raised.sign(), foot.y);
        Self { scene, view, bed, lamp, foot, s_rear, foot_world }
    }

    /// Draws everything; pixels on an edge are the mean of `samples` x `samples` points.
    pub(crate) fn draw(&self, samples: u32) -> Canvas {
        let (width, height) = (self.view.width_px, self.view.height_px);
        let parts = self.parts();
        let part_at = |u: i64, v: i64| {
            let u = u.clamp(0, i64::from(width) - 1);
            let v = v.clamp(0, i64::from(height) - 1);
            parts[(v * i64::from(width) + u) as usize]
        };
        let mut canvas = Canvas::new(width, height, self.scene.background);
        canvas.for_rows(|row, pixels| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let (u, v) = (column as i64, i64::from(row));
                let part = part_at(u, v);
                let edge = samples > 1
                    && (-1..=1).any(|j| (-1..=1).any(|i| part_at(u + i, v + j) != part));
                *pixel = if edge {
                    self.mean(u as f64, v as f64, samples)
                } else {
                    self.color(u as f64, v as f64, part)
                };
            }
        });
        canvas
    }

    /// Ring and hub alone: colour times coverage, and coverage.
    pub(crate) fn front(&self, samples: u32) -> Vec<[f32; 4]> {
        use rayon::prelude::*;
        let width = self.view.width_px as usize;
        let mut layer = vec![[0.0_f32; 4]; width * self.view.height_px as usize];
        let step = 1.0 / f64::from(samples);
        let weight = 1.0 / (samples * samples) as f32;
        layer.par_chunks_mut(width).enumerate().for_each(|(v, row)| {
            for (u, pixel) in row.iter_mut().enumerate() {
                for k in 0..samples * samples {
                    let x = u as f64 + (f64::from(k % samples) + 0.5) * step - 0.5;
                    let y = v as f64 + (f64::from(k / samples) + 0.5) * step - 0.5;
                    let part = self.before_bed(x, y);
                    if let Some(part) = part {
                        let color = self.color(x, y, part);
                        for q in 0..3 {
                            pixel[q] += weight * color[q];
                        }
                        pixel[3] += weight;
                    }
                }
            }
        });
        layer
    }

    /// Share of each pixel that the bed covers, row by row.
    pub(crate) fn bed_coverage(&self, samples: u32) -> Canvas {
        let mut canvas = Canvas::new(self.view.width_px, self.view.height_px, [0.0; 3]);
        let step = 1.0 / f64::from(samples);
        canvas.for_rows(|row, pixels| {
            for (column, pixel) in pixels.iter_mut().enumerate() {
                let mut count = 0_u32;
                for k in 0..samples * samples {
                    let du = (f64::from(k % samples) + 0.5) * step - 0.5;
                    let dv = (f64::from(k / samples) + 0.5) * step - 0.5;
                    let part = self.inside(column as f64 + du, f64::from(row) + dv);
                    count += u32::from(matches!(part, Some(Part::BedFront | Part::BedTop)));
                }
                *pixel = [count as f32 / (samples * samples) as f32; 3];
            }
        });
        canvas
    }

    fn parts(&self) -> Vec<Part> {
        use rayon::prelude::*;
        let width = self.view.width_px as usize;
        let mut parts = vec![Part::Background; width * self.view.height_px as usize];
        parts.par_chunks_mut(width).enumerate().for_each(|(v, row)| {
            for (u, part) in row.iter_mut().enumerate() {
                *part = self.part(u as f64, v as f64);
            }
        });
        parts
    }

    fn mean(&self, u: f64, v: f64, samples: u32) -> Color {
        let step = 1.0 / f64::from(samples);
        let mut sum = [0.0_f32; 3];
        for j in 0..samples {
            for i in 0..samples {
                let x = u + (f64::from(i) + 0.5) * step - 0.5;
                let y = v + (f64::from(j) + 0.5) * step - 0.5;
                let color = self.color(x, y, self.part(x, y));
                for k in 0..3 {
                    sum[k] += color[k];
                }
            }
        }
        scaled(sum, 1.0 / (samples * samples) as f32)
    }

    /// What the ray through a pixel coordinate meets first.
    pub(crate) fn part(&self, u: f64, v: f64) -> Part {
        if let Some(part) = self.before_bed(u, v) {
            return part;
        }
        let drum = &self.scene.drum;
        let r2 = self.view.on_plane(u, v, drum.front_z()).length_squared();
        if r2 < drum.radius_m * drum.radius_m {
            self.inside(u, v).unwrap_or(Part::RearWall)
        } else if r2 < self.scene.plate_radius_m * self.scene.plate_radius_m {
            Part::Plate
        } else {
            Part::Background
        }
    }

    /// Ring or hub, which lie before everything else.
    fn before_bed(&self, u: f64, v: f64) -> Option<Part> {
        let drum = &self.scene.drum;
        let ring = &self.scene.ring;
        let front = self.view.on_plane(u, v, drum.front_z());
        let at_ring = if ring.standoff_m == 0.0 {
            front
        } else {
            self.view.on_plane(u, v, drum.front_z() + ring.standoff_m)
        };
        if ring.covers(drum, at_ring.x, at_ring.y) {
            return Some(Part::Ring);
        }
        self.scene.hub.part(front.x, front.y).map(Part::Hub)
    }

    /// What lies behind the front plate at a pixel coordinate; `None` outside the drum.
    fn inside(&self, u: f64, v: f64) -> Option<Part> {
        let drum = &self.scene.drum;
        let front = self.view.on_plane(u, v, drum.front_z());
        if front.length_squared() >= drum.radius_m * drum.radius_m {
            return None;
        }
        if let Some(bed) = &self.bed {
            let p = DVec2::new(front.x * bed.shape.raised().sign(), front.y) / drum.radius_m;
            if bed.shape.contains(p) {
                return Some(Part::BedFront);
            }
            if bed.shape.extruded() && self.top_depth(bed.shape, p).is_some() {
                return Some(Part::BedTop);
            }
        }
        let rear = self.view.on_plane(u, v, -drum.front_z());
        Some(if rear.length_squared() < drum.radius_m * drum.radius_m {
            Part::RearWall
        } else {
            Part::Tube
        })
    }

    /// Where the ray through a front-plane point enters an extruded bed: depth of the place below the pinhole over that
    /// of the front plate, from 1 to `1 / s_rear`.
    fn top_depth(&self, shape: &BedShape, p: DVec2) -> Option<f64> {
        let across = p - self.foot;
        let at = |k: f64| self.foot + across * k;
        // The ray runs outwards from the foot and ends at the rear wall or at the tube.
        let (a, b, c) =
            (across.length_squared(), self.foot.dot(across), self.foot.length_squared() - 1.0);
        let at_wall = ((b * b - a * c).max(0.0).sqrt() - b) / a.max(f64::MIN_POSITIVE);
        let last = (1.0 / self.s_rear).min(at_wall * (1.0 - 1e-12));
        let step = (last - 1.0) / f64::from(DEPTH_STEPS);
        let mut outside = 1.0;
        for i in 1..=DEPTH_STEPS {
            let mut k = 1.0 + step * f64::from(i);
            if shape.contains(at(k)) {
                for _ in 0..20 {
                    let mid = 0.5 * (k + outside);
                    if shape.contains(at(mid)) { k = mid } else { outside = mid }
                }
                return Some(k);
            }
            outside = k;
        }
        None
    }

    fn color(&self, u: f64, v: f64, part: Part) -> Color {
        let scene = self.scene;
        let drum = &scene.drum;
        match part {
            Part::Background => scene.background,
            Part::Plate => scene.plate,
            Part::Ring => scene.ring.color,
            Part::RearWall => scene.rear_wall,
            Part::Hub(part) => {
                let p = self.view.on_plane(u, v, drum.front_z());
                // A washer turned on a lathe shows light and shade in opposite sectors.
                let turned = 1.0 + 0.12 * (2.0 * p.y.atan2(p.x) + 0.7).cos();
                match part {
                    HubPart::Washer => scaled(scene.hub.color, turned as f32),
                    HubPart::Nut => scene.hub.nut_color,
                    HubPart::Bolt => scaled(scene.hub.nut_color, 0.7),
                }
            }
            Part::Tube => {
                // Darker towards the rear wall, as light comes through the front plate.
                let p = self.view.on_plane(u, v, drum.front_z()) / drum.radius_m;
                let from_foot = (p - self.foot_world).length();
                let share = (1.0 - from_foot) / (1.0 - self.s_rear).max(1e-9);
                mixed(scene.tube, scene.rear_wall, share.clamp(0.0, 1.0) as f32)
            }
            Part::BedFront | Part::BedTop => self.bed_color(u, v, part),
        }
    }

    fn bed_color(&self, u: f64, v: f64, part: Part) -> Color {
        let Some(bed) = &self.bed else { return self.scene.rear_wall };
        let drum = &self.scene.drum;
        let front = self.view.on_plane(u, v, drum.front_z());
        let p = DVec2::new(front.x * bed.shape.raised().sign(), front.y) / drum.radius_m;
        if part == Part::BedTop
            && let Some(k) = self.top_depth(bed.shape, p)
        {
            let q = self.foot + (p - self.foot) * k;
            // Beads of the free surface, along the slope and into the depth.
            let height = self.view.position.z - drum.front_z();
            let depth = height * (k - 1.0);
            let along = q.x * drum.radius_m * bed.shape.slope(0.0).hypot(1.0);
            return bed.texture.color(&self.lamp, DVec2::new(along, depth));
        }
        // Points of edge pixels lie on a lattice of 1/64 px and finer: each its own phase.
        let phase = unit(hash(bed.texture.seed, (64.0 * u) as i64, (64.0 * v) as i64));
        bed.exposure.mean(phase, |seconds| {
            let moved = bed.exposure.texture_origin(bed.shape, p, seconds);
            let world = DVec2::new(moved.x * bed.shape.raised().sign(), moved.y);
            bed.texture.color(&self.lamp, world * drum.radius_m)
        })
    }
}
