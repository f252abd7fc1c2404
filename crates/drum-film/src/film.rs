//! The film: camera, scene, light and effects together.

use crate::bed::Bed;
use crate::camera::Camera;
use crate::canvas::Color;
use crate::effects::{Defocus, Exposure, Glare, Noise, Powder, Vignetting};
use crate::error::{Error, check};
use crate::light::Light;
use crate::scene::{Drum, Scene};
use crate::spheres::Sphere;
use crate::studio::{BedFrame, SphereFrame, Studio};
use crate::texture::Texture;

/// All that decides how a frame looks.
///
/// ```
/// use drum_film::{Bed, Camera, Film};
/// let film = Film { camera: Camera::default().with_size(242, 162), ..Film::default() };
/// let frame = film.bed_frame(&Bed { aor_lin_deg: 31.0, s_shape_deg: 3.0, ..Bed::default() }, 0)?;
/// assert_eq!(frame.image.dimensions(), (242, 162));
/// assert!((frame.truth.aor_mid_deg - 34.0).abs() < 1e-5);
/// # Ok::<(), drum_film::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Film {
    /// The camera.
    pub camera: Camera,
    /// What stands still.
    pub scene: Scene,
    /// The light.
    pub light: Light,
    /// Looks of the beads.
    pub texture: Texture,
    /// Powder on the front plate.
    pub powder: Powder,
    /// Lamps mirrored in the front plate.
    pub glare: Glare,
    /// Blur of the lens.
    pub defocus: Defocus,
    /// Loss of light towards the corners.
    pub vignetting: Vignetting,
    /// Shutter time and motion.
    pub exposure: Exposure,
    /// Noise of the sensor.
    pub noise: Noise,
    /// A pixel on an edge is the mean of this many points along each side.
    pub edge_samples: u32,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            scene: Scene::default(),
            light: Light::default(),
            texture: Texture::default(),
            powder: Powder::default(),
            glare: Glare::default(),
            defocus: Defocus::default(),
            vignetting: Vignetting::default(),
            exposure: Exposure::default(),
            noise: Noise::default(),
            edge_samples: 4,
        }
    }
}

impl Film {
    /// Pictures in the manner of EDEM's: particles in one flat colour on a light background, nothing else.
    ///
    /// Without a ring such a picture does not show where the drum is: see [`Studio::reference_circle`].
    #[must_use]
    pub fn silhouette(drum: Drum, particles: Color, background: Color) -> Self {
        Self {
            scene: Scene::bare(drum, background),
            light: Light::flat(),
            texture: Texture {
                color: particles,
                contrast: 0.0,
                variation: 0.0,
                ..Texture::default()
            },
            ..Self::default()
        }
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// The first one out of its range, with its path.
    pub fn check(&self) -> Result<(), Error> {
        self.scene.check()?;
        self.light.check()?;
        self.texture.check()?;
        self.powder.check()?;
        self.glare.check()?;
        self.defocus.check()?;
        self.vignetting.check()?;
        self.exposure.check()?;
        self.noise.check()?;
        check("edge_samples", self.edge_samples.into(), "", (1.0, 64.0), "1 to 64 points a side")
    }

    /// Sets everything up for a series of frames.
    ///
    /// # Errors
    /// Those of [`Film::check`] and [`Camera::view`].
    pub fn studio(&self) -> Result<Studio, Error> {
        Studio::new(self)
    }

    /// Films one analytic bed; frames of different `index` differ in texture and noise.
    ///
    /// # Errors
    /// Those of [`Film::studio`] and [`Studio::bed_frame`].
    pub fn bed_frame(&self, bed: &Bed, index: u64) -> Result<BedFrame, Error> {
        self.studio()?.bed_frame(bed, index)
    }

    /// Films one snapshot of spheres; for a series, set up a [`Studio`] once.
    ///
    /// # Errors
    /// Those of [`Film::studio`] and [`Studio::sphere_frame`].
    pub fn sphere_frame(&self, spheres: &[Sphere], index: u64) -> Result<SphereFrame, Error> {
        self.studio()?.sphere_frame(spheres, index)
    }
}
