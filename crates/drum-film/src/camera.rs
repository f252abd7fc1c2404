//! The camera: a pinhole (or parallel) projection that looks at the middle of the front plate.
//!
//! World frame: drum axis along z through the origin, x to the right as the camera sees it, y up, the
//! front plate's inner face at `z = +length/2`, the camera beyond it on the side of positive z.
//! A drum that turns counter-clockwise in the picture (positive about z) raises its bed on the right.
//!
//! Picture frame: column `u` to the right, row `v` downwards, **pixel centres at whole numbers**, so that
//! the picture reaches from -0.5 to width - 0.5 (the convention of scikit-image and of MATLAB less one).
//!
//! The pinhole stands `distance_m` in front of the front plate's inner face; the principal distance is the
//! focal length. (A thin lens focused at distance D has the principal distance f D / (D - f), 4.6 % more for 35 mm at 0.8 m: a
//! pure magnification, which a ring in the picture cancels; [`Camera::scale`] holds it where it matters.)

use glam::{DVec2, DVec3};

use crate::error::{Error, check};
use crate::scene::Drum;

/// How points in space become points in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Projection {
    /// Through a pinhole: far things look smaller.
    #[default]
    Perspective,
    /// Along parallel rays, with the magnification that the pinhole has in the plane of the front plate.
    Orthographic,
}

/// A camera on a stand in front of the drum.
///
/// The default is a Nikon D-60 with a 35 mm lens 0.8 m from the drum, 1936 x 1296 pixels.
///
/// ```
/// use drum_film::{Camera, Drum};
/// let view = Camera::default().view(&Drum::default())?;
/// // 35 mm / 800 mm on 23.6 mm / 1936 pixels: a drum of 125 mm radius is 449 pixels wide.
/// assert!((view.radius_px(0.125) - 448.6).abs() < 0.1);
/// # Ok::<(), drum_film::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Camera {
    /// Perspective or parallel rays.
    pub projection: Projection,
    /// Focal length, mm.
    pub focal_length_mm: f64,
    /// Width of the sensor, mm.
    pub sensor_width_mm: f64,
    /// Columns of the picture.
    pub width_px: u32,
    /// Rows of the picture; pixels are square.
    pub height_px: u32,
    /// Distance of the pinhole from the inner face of the front plate, m.
    pub distance_m: f64,
    /// Turn about the optical axis, degrees; positive turns the picture counter-clockwise, so that a bed
    /// raised on the right reads steeper by the roll.
    pub roll_deg: f64,
    /// Turn of the line of sight about the horizontal, degrees; positive: the camera stands higher and looks down.
    pub pitch_deg: f64,
    /// Turn of the line of sight about the vertical, degrees; positive: the camera stands further right.
    pub yaw_deg: f64,
    /// Shift of the picture to the right, percent of the drum's radius.
    pub offset_x_pct: f64,
    /// Shift of the picture upwards, percent of the drum's radius.
    pub offset_y_pct: f64,
    /// Factor on the magnification.
    pub scale: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            projection: Projection::Perspective,
            focal_length_mm: 35.0,
            sensor_width_mm: 23.6,
            width_px: 1936,
            height_px: 1296,
            distance_m: 0.8,
            roll_deg: 0.0,
            pitch_deg: 0.0,
            yaw_deg: 0.0,
            offset_x_pct: 0.0,
            offset_y_pct: 0.0,
            scale: 1.0,
        }
    }
}

/// Radius of the drum that the usual lens suits, m.
const USUAL_RADIUS_M: f64 = 0.125;

impl Camera {
    /// The same camera with another number of pixels on the same sensor width.
    #[must_use]
    pub fn with_size(mut self, width_px: u32, height_px: u32) -> Self {
        self.width_px = width_px;
        self.height_px = height_px;
        self
    }

    /// The same camera with a lens that shows a drum of radius `radius_m` no smaller than the usual one shows a drum of 250 mm from
    /// 0.8 m: 0.23 of the picture's width to the radius. Perspective goes with the distance, not with the lens.
    ///
    /// ```
    /// use drum_film::Camera;
    /// let near = Camera { distance_m: 0.5, ..Camera::default() };
    /// // 35 mm x (0.125 / 0.05) x (0.5 / 0.8).
    /// assert!((near.clone().close_up(0.05).focal_length_mm - 54.69).abs() < 0.01);
    /// assert_eq!(near.close_up(0.125).focal_length_mm, 35.0);
    /// ```
    #[must_use]
    pub fn close_up(mut self, radius_m: f64) -> Self {
        let usual = Self::default();
        let share = usual.focal_length_mm / usual.distance_m * USUAL_RADIUS_M;
        self.focal_length_mm = self.focal_length_mm.max(share * self.distance_m / radius_m);
        self
    }

    /// The camera as a reference picture knows it: no shift and no error of scale.
    ///
    /// A circle taken from such a picture and applied to frames of the real camera brings shift and scale into the
    /// centre of area, as one reference picture for a whole table of EDEM runs does.
    #[must_use]
    pub fn reference(&self) -> Self {
        Self { offset_x_pct: 0.0, offset_y_pct: 0.0, scale: 1.0, ..self.clone() }
    }

    /// Resolves the camera for a drum.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a number outside its range, with its path.
    pub fn view(&self, drum: &Drum) -> Result<View, Error> {
        drum.check()?;
        check(
            "camera.focal_length_mm",
            self.focal_length_mm,
            "mm",
            (1e-3, 1e4),
            "a focal length above 0",
        )?;
        check(
            "camera.sensor_width_mm",
            self.sensor_width_mm,
            "mm",
            (1e-3, 1e4),
            "a width above 0",
        )?;
        check(
            "camera.width_px",
            self.width_px.into(),
            "px",
            (16.0, 20_000.0),
            "16 to 20000 pixels",
        )?;
        check(
            "camera.height_px",
            self.height_px.into(),
            "px",
            (16.0, 20_000.0),
            "16 to 20000 pixels",
        )?;
        check("camera.distance_m", self.distance_m, "m", (1e-3, 1e4), "a distance above 0")?;
        check("camera.roll_deg", self.roll_deg, "deg", (-180.0, 180.0), "-180 to 180")?;
        check("camera.pitch_deg", self.pitch_deg, "deg", (-45.0, 45.0), "-45 to 45")?;
        check("camera.yaw_deg", self.yaw_deg, "deg", (-45.0, 45.0), "-45 to 45")?;
        check("camera.offset_x_pct", self.offset_x_pct, "% of R", (-500.0, 500.0), "-500 to 500")?;
        check("camera.offset_y_pct", self.offset_y_pct, "% of R", (-500.0, 500.0), "-500 to 500")?;
        check("camera.scale", self.scale, "", (1e-3, 1e3), "a factor above 0, near 1")?;

        let (sin_p, cos_p) = self.pitch_deg.to_radians().sin_cos();
        let (sin_y, cos_y) = self.yaw_deg.to_radians().sin_cos();
        let target = DVec3::new(0.0, 0.0, drum.front_z());
        let towards_camera = DVec3::new(sin_y * cos_p, sin_p, cos_y * cos_p);
        let right0 = DVec3::new(cos_y, 0.0, -sin_y);
        let up0 = towards_camera.cross(right0);
        // The picture turns counter-clockwise when the camera's own axes turn clockwise.
        let (sin_r, cos_r) = self.roll_deg.to_radians().sin_cos();
        let right = right0 * cos_r - up0 * sin_r;
        let up = right0 * sin_r + up0 * cos_r;

        let principal_px =
            self.scale * self.focal_length_mm * f64::from(self.width_px) / self.sensor_width_mm;
        let nominal_radius_px = principal_px / self.scale / self.distance_m * drum.radius_m;
        Ok(View {
            position: target + towards_camera * self.distance_m,
            right,
            up,
            backward: towards_camera,
            projection: self.projection,
            principal_px,
            distance_m: self.distance_m,
            center_px: DVec2::new(
                (f64::from(self.width_px) - 1.0) / 2.0
                    + self.offset_x_pct / 100.0 * nominal_radius_px,
                (f64::from(self.height_px) - 1.0) / 2.0
                    - self.offset_y_pct / 100.0 * nominal_radius_px,
            ),
            width_px: self.width_px,
            height_px: self.height_px,
        })
    }
}

/// A ray of sight in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, m.
    pub origin: DVec3,
    /// Its direction; one unit of it is 1 m of depth along the optical axis.
    pub direction: DVec3,
}

/// A camera resolved for a drum: maps points to pixels and pixels to rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// The pinhole (for parallel rays: the point that looks along the optical axis), m.
    pub position: DVec3,
    /// Unit vector to the right in the picture.
    pub right: DVec3,
    /// Unit vector upwards in the picture.
    pub up: DVec3,
    /// Unit vector from the drum to the camera.
    pub backward: DVec3,
    /// Perspective or parallel rays.
    pub projection: Projection,
    /// Principal distance, pixels.
    pub principal_px: f64,
    /// Distance of the pinhole from the middle of the front plate, m.
    pub distance_m: f64,
    /// Pixel at which the optical axis meets the picture.
    pub center_px: DVec2,
    /// Columns.
    pub width_px: u32,
    /// Rows.
    pub height_px: u32,
}

impl View {
    /// Pixels of a length that lies across the line of sight in the plane of the front plate.
    #[must_use]
    pub fn radius_px(&self, length_m: f64) -> f64 {
        self.principal_px / self.distance_m * length_m
    }

    /// A point in the camera's axes: right, up, depth along the line of sight, m.
    #[must_use]
    pub fn to_camera(&self, point: DVec3) -> DVec3 {
        let d = point - self.position;
        DVec3::new(d.dot(self.right), d.dot(self.up), -d.dot(self.backward))
    }

    /// The pixel of a point in space; `None` behind the pinhole.
    #[must_use]
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let c = self.to_camera(point);
        let depth = match self.projection {
            Projection::Perspective if c.z > 0.0 => c.z,
            Projection::Perspective => return None,
            Projection::Orthographic => self.distance_m,
        };
        let k = self.principal_px / depth;
        Some(DVec2::new(self.center_px.x + k * c.x, self.center_px.y - k * c.y))
    }

    /// The ray of sight through a pixel coordinate.
    #[must_use]
    pub fn ray(&self, u: f64, v: f64) -> Ray {
        let x = (u - self.center_px.x) / self.principal_px;
        let y = -(v - self.center_px.y) / self.principal_px;
        let across = self.right * x + self.up * y;
        match self.projection {
            Projection::Perspective => {
                Ray { origin: self.position, direction: across - self.backward }
            }
            Projection::Orthographic => {
                Ray { origin: self.position + across * self.distance_m, direction: -self.backward }
            }
        }
    }

    /// Where the ray of a pixel coordinate meets the plane `z = const`, m.
    #[must_use]
    pub fn on_plane(&self, u: f64, v: f64, z: f64) -> DVec2 {
        let ray = self.ray(u, v);
        let t = (z - ray.origin.z) / ray.direction.z;
        (ray.origin + ray.direction * t).truncate()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ray_through_the_pixel_of_a_point_meets_the_point() {
        for projection in [Projection::Perspective, Projection::Orthographic] {
            let camera = Camera {
                projection,
                roll_deg: 7.0,
                pitch_deg: -4.0,
                yaw_deg: 3.0,
                offset_x_pct: 5.0,
                scale: 1.1,
                ..Camera::default()
            };
            let view = camera.view(&Drum::default()).unwrap();
            let p = DVec3::new(0.03, -0.07, -0.02);
            let px = view.project(p).unwrap();
            // Rounding of a few ulp of 1 m.
            assert!((view.on_plane(px.x, px.y, p.z) - p.truncate()).length() < 1e-13);
        }
    }

    #[test]
    fn axes_of_the_camera_are_orthonormal_and_right_handed() {
        let camera =
            Camera { roll_deg: 31.0, pitch_deg: 20.0, yaw_deg: -15.0, ..Camera::default() };
        let v = camera.view(&Drum::default()).unwrap();
        assert!((v.right.cross(v.up) - v.backward).length() < 1e-15);
    }

    #[test]
    fn a_camera_inside_the_drum_is_refused_with_its_path() {
        let camera = Camera { distance_m: -0.1, ..Camera::default() };
        let error = camera.view(&Drum::default()).unwrap_err();
        assert!(error.to_string().starts_with("camera.distance_m = -0.1 m"), "{error}");
    }
}
