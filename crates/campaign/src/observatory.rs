//! The camera and the reader of one rig.

use std::sync::OnceLock;

use drum_film::image::RgbImage;
use drum_film::{Drum, Film, Scene, Studio};
use drum_rig::{Options, Sampled};
use drum_vision::config::{CircleSource, Definition};
use drum_vision::drum::detect::{Drum as FoundDrum, detect_drum};
use drum_vision::series::{SeriesReport, summarise};
use drum_vision::{Context, Frame, VisionConfig, measure_frame};
use rig_schema::{Layer, Rig, Shape, namespace};

use crate::{CampaignError, Footage};

/// Size of the frames and fineness of the exposure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Resolution {
    /// Width of a frame, pixels; the height follows at 3:2.
    pub width_px: u32,
    /// Most instants that an exposure is made of.
    pub most_sub_frames: u32,
}

impl Default for Resolution {
    /// Half the width of the thesis's photographs: the reader works below a pixel.
    fn default() -> Self {
        Self { width_px: 968, most_sub_frames: 12 }
    }
}

/// What was seen at one speed.
#[derive(Debug, Clone)]
pub struct Observed {
    /// Speed of the schedule, rpm.
    pub speed_rpm: f64,
    /// Responses with their scatter, as photographs give them.
    pub report: SeriesReport,
    /// A few frames for people to look at.
    pub preview: Vec<RgbImage>,
}

/// Frames kept to look at.
const PREVIEW: usize = 6;

/// The camera and the reader of one rig.
pub struct Observatory {
    film: Film,
    studio: Studio,
    vision: VisionConfig,
    /// The drum as the reader finds it in the empty scene: camera and ring stand still, so that no frame shows another.
    found: OnceLock<Option<FoundDrum>>,
    resolution: Resolution,
    exposure_s: f64,
    radius_m: f64,
    diameter_m: f64,
    fastest_rpm: f64,
}

impl Observatory {
    /// Set up camera and reader with the rig's values of every camera and measuring parameter.
    ///
    /// # Errors
    /// A parameter that camera or reader refuses, a camera that does not see the drum.
    pub fn new(rig: &Rig, resolution: Resolution) -> Result<Self, CampaignError> {
        let drum = Drum { radius_m: rig.drum.radius_m, length_m: rig.drum.length_m };
        let mut film = Film { scene: Scene::about(drum), ..Film::default() };
        film.camera = film.camera.with_size(resolution.width_px, resolution.width_px * 2 / 3);
        let mut vision = VisionConfig::default();
        for p in namespace::iter() {
            let Some(value) = rig.settings.given(p.path) else { continue };
            match p.layer {
                // Exposure acts by the instants that are sampled, not by smearing one.
                Layer::Camera if p.path == "exposure.seconds" => {}
                Layer::Camera => film.set(p.path, value)?,
                Layer::Measurement => {
                    if !vision.measure.set(p.path, value) {
                        return Err(CampaignError::Parameter {
                            path: p.path,
                            value,
                            by: "the reader",
                        });
                    }
                }
                Layer::Physics => {}
            }
        }
        if rig.settings.given("camera.focal_length_mm").is_none() {
            film.camera = film.camera.close_up(rig.drum.radius_m);
        }
        let diameter_m = match rig.particles.shape {
            Shape::Sphere(s) => s.diameter_m,
            Shape::RingTablet(t) => 2.0 * (t.ring_radius_m + t.sphere_radius_m),
        };
        vision.rig.drum_radius_m = Some(rig.drum.radius_m);
        vision.rig.particle_diameter_m = Some(diameter_m);
        Ok(Self {
            studio: film.studio()?,
            film,
            vision,
            found: OnceLock::new(),
            resolution,
            exposure_s: rig.settings.value("exposure.seconds").unwrap_or(0.0),
            radius_m: rig.drum.radius_m,
            diameter_m,
            fastest_rpm: rig.run.speeds_rpm.iter().copied().fold(0.0, f64::max),
        })
    }

    /// How positions must be sampled for this camera: an exposure is resolved so that nothing
    /// moves by more than half a particle between two instants at the drum's own speed, up to the
    /// resolution's limit.
    pub fn options(&self, threads: usize) -> Options {
        let way = self.fastest_rpm * std::f64::consts::TAU / 60.0 * self.radius_m * self.exposure_s;
        let wanted = (2.0 * way / self.diameter_m).ceil().max(1.0);
        let sub_frames = wanted.min(f64::from(self.resolution.most_sub_frames.max(1))) as u32;
        Options {
            threads,
            exposure_s: if sub_frames > 1 { self.exposure_s } else { 0.0 },
            sub_frames,
            ..Options::default()
        }
    }

    /// The film's settings.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Film one frame of what was sampled.
    ///
    /// # Errors
    /// [`CampaignError::Film`] if the frame cannot be drawn.
    pub fn frame(&self, footage: &Footage, index: usize) -> Result<RgbImage, CampaignError> {
        Ok(self.studio.exposed_frame(footage.instants(index), index as u64)?.image)
    }

    /// Film and measure everything that was sampled at one speed.
    ///
    /// # Errors
    /// [`CampaignError`] for frames that cannot be drawn; one that cannot be measured is in the
    /// report's `rejected`.
    pub fn observe(&self, sampled: &Sampled) -> Result<Observed, CampaignError> {
        self.observe_footage(&Footage::of(sampled))
    }

    /// Film and measure a footage.
    ///
    /// # Errors
    /// As [`Observatory::observe`].
    pub fn observe_footage(&self, footage: &Footage) -> Result<Observed, CampaignError> {
        let (mut reports, preview) = self.look(footage, &[self.vision.response.definition])?;
        let report = reports.remove(0);
        Ok(Observed { speed_rpm: footage.speed_rpm, report, preview })
    }

    /// The same film by each of two definitions of the angles: as photographs are read, and as
    /// pictures of EDEM are ([`Definition::Edem`]).
    ///
    /// # Errors
    /// As [`Observatory::observe`].
    pub fn observe_both(
        &self,
        sampled: &Sampled,
    ) -> Result<(Observed, SeriesReport), CampaignError> {
        let footage = Footage::of(sampled);
        let definitions = [self.vision.response.definition, Definition::Edem];
        let (mut reports, preview) = self.look(&footage, &definitions)?;
        let (report, edem) = (reports.remove(0), reports.remove(0));
        Ok((Observed { speed_rpm: footage.speed_rpm, report, preview }, edem))
    }

    /// The drum of every frame; `None` where the reader finds none in the empty scene.
    fn drum(&self) -> Option<&FoundDrum> {
        let find = || {
            let empty = frame_of(&self.studio.empty_frame(0)).ok()?;
            detect_drum(&empty, &self.vision.drum, None).ok()
        };
        self.found.get_or_init(find).as_ref()
    }

    fn look(
        &self,
        footage: &Footage,
        definitions: &[Definition],
    ) -> Result<(Vec<SeriesReport>, Vec<RgbImage>), CampaignError> {
        let context = Context { reference: self.drum(), region: None };
        let mut readers = Vec::new();
        for &definition in definitions {
            let mut vision = self.vision.clone();
            vision.rig.speed_rpm = Some(footage.speed_rpm);
            vision.response.definition = definition;
            if context.reference.is_some() {
                vision.drum.source = CircleSource::Reference { path: "the empty drum".into() };
            }
            readers.push((vision, Vec::new()));
        }
        let mut preview = Vec::new();
        let every = footage.frames.len().div_ceil(PREVIEW).max(1);
        for index in 0..footage.frames.len() {
            let picture = self.frame(footage, index)?;
            let frame = frame_of(&picture)?;
            for (vision, outcomes) in &mut readers {
                let found = measure_frame(&frame, vision, context);
                outcomes.push((format!("frame_{index:04}"), found));
            }
            if index % every == 0 {
                preview.push(picture);
            }
        }
        let reports = readers.into_iter().map(|(vision, found)| summarise(found, &vision));
        Ok((reports.collect(), preview))
    }
}

/// A picture as the reader takes it.
fn frame_of(picture: &RgbImage) -> Result<Frame, CampaignError> {
    let (width, height) = picture.dimensions();
    Frame::from_rgb(width as usize, height as usize, picture.as_raw().clone())
        .ok_or(CampaignError::Picture { width, height })
}
