//! A film set up for a series: the standing scene is drawn once, the frames one after another.

use std::sync::OnceLock;

use image::RgbImage;

use crate::bed::Bed;
use crate::camera::View;
use crate::canvas::{Canvas, Color, scaled};
use crate::coverage::Coverage;
use crate::error::Error;
use crate::film::Film;
use crate::scene::{Hub, Ring, Scene};
use crate::spheres::{self, Layer, Paint, Sphere};
use crate::stage::{DressedBed, Stage};
use crate::texture::{Texture, hash};
use crate::truth::{RingCircle, Truth};

/// A frame of an analytic bed with what a perfect reader would measure on it.
#[derive(Debug, Clone, PartialEq)]
pub struct BedFrame {
    /// The picture.
    pub image: RgbImage,
    /// The measures of the silhouette that was drawn.
    pub truth: Truth,
}

/// A frame of spheres.
#[derive(Debug, Clone, PartialEq)]
pub struct SphereFrame {
    /// The picture.
    pub image: RgbImage,
    /// The circle of the ring's inner edge.
    pub circle: RingCircle,
}

/// A camera in front of a scene.
#[derive(Debug)]
pub struct Studio {
    film: Film,
    view: View,
    circle: RingCircle,
    standing: OnceLock<Standing>,
}

/// What does not change from frame to frame.
#[derive(Debug)]
struct Standing {
    behind: Canvas,
    /// Ring and hub: colour times coverage, and coverage.
    front: Vec<[f32; 4]>,
}

impl Studio {
    pub(crate) fn new(film: &Film) -> Result<Self, Error> {
        film.check()?;
        let view = film.camera.view(&film.scene.drum)?;
        let circle = RingCircle::of(&film.scene, &view);
        Ok(Self { film: film.clone(), view, circle, standing: OnceLock::new() })
    }

    /// The resolved camera.
    #[must_use]
    pub fn view(&self) -> &View {
        &self.view
    }

    /// The circle of the ring's inner edge in every frame.
    #[must_use]
    pub fn circle(&self) -> RingCircle {
        self.circle
    }

    /// Films an analytic bed; frames of different `index` differ in texture and noise.
    ///
    /// # Errors
    /// Those of [`Bed::shape`] and [`Truth::of_bed`].
    pub fn bed_frame(&self, bed: &Bed, index: u64) -> Result<BedFrame, Error> {
        let film = &self.film;
        let shape = bed.shape()?;
        let truth = Truth::of_bed(&shape, &film.scene, &self.view)?;
        let texture = Texture { seed: hash(film.texture.seed, index as i64, 0), ..film.texture };
        let dressed = DressedBed { shape: &shape, texture: &texture, exposure: &film.exposure };
        let stage = Stage::new(&film.scene, &self.view, film.light.lamp(), Some(dressed));
        let canvas = stage.draw(film.edge_samples);
        Ok(BedFrame { image: self.develop(canvas, index), truth })
    }

    /// Share of each pixel that an analytic bed covers (8 x 8 points a pixel, hub ignored), and its truth.
    ///
    /// # Errors
    /// As [`Studio::bed_frame`].
    pub fn bed_coverage(&self, bed: &Bed) -> Result<(Coverage, Truth), Error> {
        let film = &self.film;
        let shape = bed.shape()?;
        let truth = Truth::of_bed(&shape, &film.scene, &self.view)?;
        let dressed =
            DressedBed { shape: &shape, texture: &film.texture, exposure: &film.exposure };
        let stage = Stage::new(&film.scene, &self.view, film.light.lamp(), Some(dressed));
        let canvas = stage.bed_coverage(8);
        let share = canvas.pixels().iter().map(|c| c[0]).collect();
        Ok((Coverage::new(self.view.width_px, self.view.height_px, share), truth))
    }

    /// Films one snapshot of spheres; frames of different `index` differ in noise.
    ///
    /// # Errors
    /// [`Error::BadSphere`] and [`Error::SphereAtCamera`].
    pub fn sphere_frame(&self, spheres: &[Sphere], index: u64) -> Result<SphereFrame, Error> {
        let canvas = self.sphere_canvas(spheres)?;
        Ok(SphereFrame { image: self.develop(canvas, index), circle: self.circle })
    }

    /// Films spheres while the shutter is open: the mean of the pictures of all moments, then one noise.
    ///
    /// # Errors
    /// [`Error::NoFrame`] without a moment, else as [`Studio::sphere_frame`].
    pub fn exposed_frame<S: AsRef<[Sphere]>>(
        &self,
        moments: impl IntoIterator<Item = S>,
        index: u64,
    ) -> Result<SphereFrame, Error> {
        let mut mean: Option<Canvas> = None;
        for (count, spheres) in moments.into_iter().enumerate() {
            let canvas = self.sphere_canvas(spheres.as_ref())?;
            match &mut mean {
                None => mean = Some(canvas),
                Some(mean) => mean.approach(&canvas, 1.0 / (count + 1) as f32),
            }
        }
        let canvas = mean.ok_or(Error::NoFrame { what: "at least one moment of the exposure" })?;
        Ok(SphereFrame { image: self.develop(canvas, index), circle: self.circle })
    }

    /// Share of each pixel that spheres cover, ring and hub ignored.
    ///
    /// # Errors
    /// As [`Studio::sphere_frame`].
    pub fn sphere_coverage(&self, spheres: &[Sphere]) -> Result<Coverage, Error> {
        let layer = self.layer(spheres)?;
        let share = layer.pixels.iter().map(|p| p[3]).collect();
        Ok(Coverage::new(self.view.width_px, self.view.height_px, share))
    }

    /// The empty drum.
    #[must_use]
    pub fn empty_frame(&self, index: u64) -> RgbImage {
        self.develop(self.composed(&[]), index)
    }

    /// A reference picture in the manner of EDEM: the opaque drum's circle in the particles' colour on the background.
    ///
    /// It is made with the camera's [`crate::Camera::reference`], free of shift and scale error, and without effects.
    ///
    /// # Errors
    /// Those of [`crate::Camera::view`].
    pub fn reference_circle(&self) -> Result<RgbImage, Error> {
        let film = &self.film;
        let view = film.camera.reference().view(&film.scene.drum)?;
        let scene = Scene {
            rear_wall: film.texture.color,
            tube: film.texture.color,
            ..Scene::bare(film.scene.drum, film.scene.background)
        };
        let stage = Stage::new(&scene, &view, film.light.lamp(), None);
        Ok(stage.draw(film.edge_samples).to_image())
    }

    fn layer(&self, spheres: &[Sphere]) -> Result<Layer, Error> {
        let film = &self.film;
        let texture = &film.texture;
        let front = self.view.distance_m;
        let color = |_: usize, s: &Sphere| {
            let grey = texture.grey(hash(texture.seed, s.body.into(), 2));
            scaled(s.color.unwrap_or(texture.color), grey)
        };
        let paint = Paint {
            lamp: film.light.lamp(),
            light: &film.light,
            color: &color,
            depths: (front, front + film.scene.drum.length_m),
            samples: film.edge_samples,
        };
        spheres::draw(&self.view, spheres, &paint)
    }

    fn sphere_canvas(&self, spheres: &[Sphere]) -> Result<Canvas, Error> {
        Ok(self.composed(&self.layer(spheres)?.pixels))
    }

    /// A layer of spheres (or none) between what lies behind and ring and hub.
    fn composed(&self, layer: &[[f32; 4]]) -> Canvas {
        let standing = self.standing.get_or_init(|| self.standing());
        let mut canvas = standing.behind.clone();
        let width = self.view.width_px as usize;
        canvas.for_rows(|row, pixels| {
            for (i, pixel) in (row as usize * width..).zip(pixels) {
                for over in [layer.get(i), standing.front.get(i)].into_iter().flatten() {
                    *pixel = laid_over(*pixel, over);
                }
            }
        });
        canvas
    }

    fn standing(&self) -> Standing {
        let film = &self.film;
        let bare = Scene {
            ring: Ring { visible: false, ..film.scene.ring },
            hub: Hub { visible: false, ..film.scene.hub },
            ..film.scene.clone()
        };
        let lamp = film.light.lamp();
        let behind = Stage::new(&bare, &self.view, lamp, None).draw(film.edge_samples);
        let front = Stage::new(&film.scene, &self.view, lamp, None).front(film.edge_samples);
        Standing { behind, front }
    }

    /// From light to picture: plate, lens, sensor.
    fn develop(&self, mut canvas: Canvas, index: u64) -> RgbImage {
        let film = &self.film;
        film.light.apply_gradient(&mut canvas, &self.view, self.circle.radius);
        film.powder.apply(&mut canvas, &film.scene, &self.view);
        film.glare.apply(&mut canvas, &film.scene, &self.view);
        film.defocus.apply(&mut canvas);
        film.vignetting.apply(&mut canvas);
        film.noise.apply(&mut canvas, index);
        canvas.to_image()
    }
}

/// A colour under a layer's pixel.
fn laid_over(under: Color, over: &[f32; 4]) -> Color {
    std::array::from_fn(|k| under[k] * (1.0 - over[3]) + over[k])
}
