//! The film: camera, scene, light and effects together, and the frames that they make.

use image::RgbImage;

use crate::bed::Bed;
use crate::camera::Camera;
use crate::effects::Exposure;
use crate::error::{Error, check};
use crate::light::Light;
use crate::scene::Scene;
use crate::stage::{DressedBed, Stage};
use crate::texture::Texture;
use crate::truth::Truth;

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
    /// Looks of an analytic bed.
    pub texture: Texture,
    /// Shutter time and motion.
    pub exposure: Exposure,
    /// Edge pixels are the mean of this many points along each side.
    pub edge_samples: u32,
}

impl Default for Film {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            scene: Scene::default(),
            light: Light::default(),
            texture: Texture::default(),
            exposure: Exposure::default(),
            edge_samples: 4,
        }
    }
}

/// A frame of an analytic bed with what a perfect reader would measure on it.
#[derive(Debug, Clone, PartialEq)]
pub struct BedFrame {
    /// The picture.
    pub image: RgbImage,
    /// The measures of the silhouette that was drawn.
    pub truth: Truth,
}

impl Film {
    fn check(&self) -> Result<(), Error> {
        self.scene.check()?;
        self.texture.check()?;
        self.exposure.check()?;
        check("edge_samples", self.edge_samples.into(), "", (1.0, 64.0), "1 to 64 points a side")
    }

    /// Films an analytic bed; frames of different `index` differ in texture and noise.
    ///
    /// # Errors
    /// What [`Camera::view`], [`Bed::shape`] and [`Truth::of_bed`] report.
    pub fn bed_frame(&self, bed: &Bed, index: u64) -> Result<BedFrame, Error> {
        self.check()?;
        let view = self.camera.view(&self.scene.drum)?;
        let shape = bed.shape()?;
        let truth = Truth::of_bed(&shape, &self.scene, &view)?;
        let texture = Texture {
            seed: crate::texture::hash(self.texture.seed, index as i64, 0),
            ..self.texture
        };
        let dressed = DressedBed { shape: &shape, texture: &texture, exposure: &self.exposure };
        let stage = Stage::new(&self.scene, &view, self.light.lamp(), Some(dressed));
        let mut canvas = stage.draw(self.edge_samples);
        self.light.apply_gradient(&mut canvas, &view, truth.radius_px);
        Ok(BedFrame { image: canvas.to_image(), truth })
    }

    /// Share of each pixel that an analytic bed covers (8 x 8 points a pixel, hub ignored), row by row, and its truth.
    ///
    /// # Errors
    /// As [`Film::bed_frame`].
    pub fn bed_coverage(&self, bed: &Bed) -> Result<(Vec<f32>, Truth), Error> {
        self.check()?;
        let view = self.camera.view(&self.scene.drum)?;
        let shape = bed.shape()?;
        let truth = Truth::of_bed(&shape, &self.scene, &view)?;
        let dressed =
            DressedBed { shape: &shape, texture: &self.texture, exposure: &self.exposure };
        let stage = Stage::new(&self.scene, &view, self.light.lamp(), Some(dressed));
        let coverage = stage.bed_coverage(8);
        Ok((coverage.pixels().iter().map(|c| c[0]).collect(), truth))
    }
}
