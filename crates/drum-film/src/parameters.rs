//! The film's share of the one namespace of parameters: every declared path reads and sets one field.
//!
//! The rows are those of [`rig_schema::namespace::CAMERA`]. A parameter that is accepted is used: [`Film::set`] refuses an unknown path and names the nearest one.

use rig_schema::Parameter;

use crate::error::Error;
use crate::film::Film;

/// Every parameter of the film.
///
/// ```
/// let paths: Vec<_> = drum_film::parameters().map(|p| p.path).collect();
/// assert!(paths.contains(&"camera.roll_deg") && paths.contains(&"light.defocus_px"));
/// ```
pub fn parameters() -> impl Iterator<Item = &'static Parameter> + Clone {
    rig_schema::namespace::CAMERA.iter()
}

impl Film {
    /// Sets the parameter at a path, e.g. `camera.roll_deg`.
    ///
    /// ```
    /// let mut film = drum_film::Film::default();
    /// film.set("camera.roll_deg", 1.5)?;
    /// assert_eq!(film.camera.roll_deg, 1.5);
    /// let error = film.set("camera.rol_deg", 1.5).unwrap_err();
    /// assert!(error.to_string().contains("`camera.roll_deg`"));
    /// # Ok::<(), drum_film::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownParameter`] with the nearest known path, [`Error::OutsideDeclaredRange`].
    pub fn set(&mut self, path: &str, value: f64) -> Result<(), Error> {
        let (parameter, field) = self.field(path)?;
        if !parameter.accepts(value) {
            return Err(Error::OutsideDeclaredRange {
                path: parameter.path,
                value,
                unit: parameter.unit,
                low: parameter.range.0,
                high: parameter.range.1,
            });
        }
        *field = value;
        Ok(())
    }

    /// Reads the parameter at a path.
    ///
    /// # Errors
    /// [`Error::UnknownParameter`] with the nearest known path.
    pub fn get(&self, path: &str) -> Result<f64, Error> {
        self.clone().field(path).map(|(_, field)| *field)
    }

    fn field(&mut self, path: &str) -> Result<(&'static Parameter, &mut f64), Error> {
        let unknown = || Error::UnknownParameter { path: path.to_owned(), nearest: nearest(path) };
        let parameter = parameters().find(|p| p.path == path).ok_or_else(unknown)?;
        let field = match parameter.path {
            "camera.roll_deg" => &mut self.camera.roll_deg,
            "camera.pitch_deg" => &mut self.camera.pitch_deg,
            "camera.yaw_deg" => &mut self.camera.yaw_deg,
            "camera.distance_m" => &mut self.camera.distance_m,
            "camera.focal_length_mm" => &mut self.camera.focal_length_mm,
            "camera.scale" => &mut self.camera.scale,
            "camera.offset_x_pct" => &mut self.camera.offset_x_pct,
            "camera.offset_y_pct" => &mut self.camera.offset_y_pct,
            "camera.ring_standoff_m" => &mut self.scene.ring.standoff_m,
            "exposure.seconds" => &mut self.exposure.seconds,
            "light.glare" => &mut self.glare.strength,
            "light.powder" => &mut self.powder.opacity,
            "light.vignetting" => &mut self.vignetting.corner_loss,
            "light.noise" => &mut self.noise.read,
            "light.shot_noise" => &mut self.noise.shot,
            "light.gradient" => &mut self.light.gradient,
            "light.defocus_px" => &mut self.defocus.sigma_px,
            // A row that this crate does not act on is as good as unknown.
            _ => return Err(unknown()),
        };
        Ok((parameter, field))
    }
}

/// The known path most like `path`.
fn nearest(path: &str) -> &'static str {
    let likeness = |p: &&Parameter| strsim::normalized_damerau_levenshtein(path, p.path);
    parameters()
        .max_by(|a, b| likeness(a).total_cmp(&likeness(b)))
        .map_or("camera.roll_deg", |p| p.path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_declared_path_sets_its_own_field_and_starts_at_its_nominal_value() {
        let mut paths: Vec<&str> = parameters().map(|p| p.path).collect();
        for p in parameters() {
            let mut film = Film::default();
            assert_eq!(Some(film.get(p.path).unwrap()), p.nominal, "{}", p.path);
            let value = 0.5 * (p.range.1 + p.nominal.unwrap());
            film.set(p.path, value).unwrap();
            assert_ne!(film, Film::default(), "{}", p.path);
            assert_eq!(film.get(p.path).unwrap(), value, "{}", p.path);
            // No other path reads the same field.
            for q in parameters().filter(|q| q.path != p.path) {
                assert_eq!(film.get(q.path).unwrap(), q.nominal.unwrap(), "{} {}", p.path, q.path);
            }
            film.check().unwrap();
        }
        paths.sort_unstable();
        paths.dedup();
        assert_eq!(paths.len(), parameters().count());
    }

    #[test]
    fn values_outside_the_declared_range_are_refused_with_the_range() {
        let mut film = Film::default();
        let error = film.set("camera.pitch_deg", f64::NAN).unwrap_err();
        assert_eq!(
            error.to_string(),
            "camera.pitch_deg = NaN deg: expected a value from -20 to 20"
        );
        assert_eq!(film, Film::default());
    }

    #[test]
    fn an_unknown_path_is_refused_with_its_neighbour() {
        let error = Film::default().get("exposure.second").unwrap_err();
        assert!(
            error.to_string().ends_with("the nearest known one is `exposure.seconds`"),
            "{error}"
        );
    }
}
