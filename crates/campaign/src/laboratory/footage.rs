//! Positions as a camera needs them, in a form that can be kept.
//!
//! Coordinates are held in single precision: 10 nm in a drum of 0.1 m, far below a pixel. Frames are
//! filmed from here whether they were just simulated or read back, so both give the same bits.

use drum_film::Sphere;
use drum_rig::Sampled;

use crate::CampaignError;

/// First bytes of a kept footage; the last one is the version.
const MAGIC: &[u8; 8] = b"TMBLFTG1";

/// What was sampled at one speed, as spheres in front of a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Footage {
    /// Speed of the schedule, rpm.
    pub speed_rpm: f64,
    /// Time from which the motion counts as steady less that at which the speed was taken up, s.
    pub approach_s: f64,
    /// Froude number.
    pub froude: f64,
    /// Spheres of one particle.
    pub per_body: u32,
    /// Radius of every sphere, m.
    pub radii: Vec<f32>,
    /// Frames, each of instants, each of the centres of all spheres, m.
    pub frames: Vec<Vec<Vec<[f32; 3]>>>,
}

impl Footage {
    /// The footage of what a drum has sampled at one speed.
    pub fn of(sampled: &Sampled) -> Self {
        let grains = &sampled.grains;
        let mut radii = Vec::new();
        let frames = sampled
            .frames
            .iter()
            .map(|frame| {
                let instants = frame.exposures.iter().map(|e| {
                    let balls: Vec<_> = e.balls(grains).collect();
                    if radii.is_empty() {
                        radii = balls.iter().map(|b| b.radius as f32).collect();
                    }
                    balls.iter().map(|b| b.centre.to_array().map(|c| c as f32)).collect()
                });
                instants.collect()
            })
            .collect();
        Self {
            speed_rpm: sampled.speed_rpm,
            approach_s: sampled.steady_from_s - sampled.turned_from_s,
            froude: sampled.froude,
            per_body: grains.spheres_per_particle().max(1) as u32,
            radii,
            frames,
        }
    }

    /// The footage of positions that another code wrote, a table `frame,x,y,z,radius` (m, drum axis z
    /// through the origin) as [`crate::export::positions`] makes it, one instant a frame.
    ///
    /// # Errors
    /// [`CampaignError::Dump`] for a table without frames, a cell that is no number, or frames with
    /// different spheres.
    ///
    /// ```
    /// let table = "frame,x,y,z,radius\n0,0,-0.04,0,0.003\n1,0.001,-0.04,0,0.003\n";
    /// let footage = campaign::Footage::of_positions(30.0, "positions.csv", table)?;
    /// assert_eq!((footage.frames.len(), footage.radii.len()), (2, 1));
    /// # Ok::<(), campaign::CampaignError>(())
    /// ```
    pub fn of_positions(speed_rpm: f64, file: &str, table: &str) -> Result<Self, CampaignError> {
        let fault = |line: usize, problem: String, expected: &'static str| CampaignError::Dump {
            file: file.to_owned(),
            line,
            problem,
            expected,
        };
        let mut radii: Vec<f32> = Vec::new();
        let mut frames: Vec<Vec<Vec<[f32; 3]>>> = Vec::new();
        let mut number = None;
        for (k, line) in table.lines().enumerate().skip(1) {
            let cells: Vec<f64> = line.split(',').filter_map(|c| c.trim().parse().ok()).collect();
            let &[frame, x, y, z, radius] = &cells[..] else {
                return Err(fault(k + 1, format!("`{line}`"), "five numbers frame,x,y,z,radius"));
            };
            if number != Some(frame) {
                number = Some(frame);
                frames.push(vec![Vec::new()]);
            }
            if frames.len() == 1 {
                radii.push(radius as f32);
            }
            if let Some(instant) = frames.last_mut().and_then(|f| f.first_mut()) {
                instant.push([x, y, z].map(|c| c as f32));
            }
        }
        let same = frames.iter().all(|f| f[0].len() == radii.len());
        if frames.is_empty() || !same {
            let problem = "no frames, or frames of different numbers of spheres".to_owned();
            return Err(fault(1, problem, "the same spheres in every frame"));
        }
        Ok(Self { speed_rpm, approach_s: 0.0, froude: 0.0, per_body: 1, radii, frames })
    }

    /// One frame as the film takes it.
    pub fn instants(&self, frame: usize) -> Vec<Vec<Sphere>> {
        let place = |(k, c): (usize, &[f32; 3])| {
            let center = drum_film::glam::DVec3::from_array(c.map(f64::from));
            let body = k as u32 / self.per_body;
            Sphere { body, ..Sphere::new(center, f64::from(self.radii[k])) }
        };
        self.frames[frame].iter().map(|i| i.iter().enumerate().map(place).collect()).collect()
    }
}

/// Several speeds as bytes with version and checksum.
pub(crate) fn pack(speeds: &[Footage]) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    let count = |bytes: &mut Vec<u8>, n: usize| bytes.extend((n as u64).to_le_bytes());
    count(&mut bytes, speeds.len());
    for f in speeds {
        for v in [f.speed_rpm, f.approach_s, f.froude] {
            bytes.extend(v.to_le_bytes());
        }
        count(&mut bytes, f.per_body as usize);
        count(&mut bytes, f.radii.len());
        f.radii.iter().for_each(|r| bytes.extend(r.to_le_bytes()));
        count(&mut bytes, f.frames.len());
        for frame in &f.frames {
            count(&mut bytes, frame.len());
            frame.iter().flatten().flatten().for_each(|c| bytes.extend(c.to_le_bytes()));
        }
    }
    let sum = blake3::hash(&bytes);
    bytes.extend(sum.as_bytes());
    bytes
}

/// Read what [`pack`] wrote.
pub(crate) fn unpack(bytes: &[u8], file: &str) -> Result<Vec<Footage>, CampaignError> {
    let broken = |what: &'static str| CampaignError::Kept { file: file.to_owned(), what };
    let split = bytes.len().checked_sub(32).ok_or_else(|| broken("is cut short"))?;
    let (body, sum) = bytes.split_at(split);
    if body.get(..8) != Some(MAGIC.as_slice()) {
        return Err(broken("is of another kind or version"));
    }
    if blake3::hash(body).as_bytes() != sum {
        return Err(broken("was altered: its checksum differs"));
    }
    let mut reader = Reader { rest: &body[8..] };
    let speeds = reader.speeds().ok_or_else(|| broken("is cut short"))?;
    if speeds.iter().any(|f| f.radii.is_empty() || f.per_body == 0) {
        return Err(broken("holds no spheres"));
    }
    Ok(speeds)
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (head, rest) = self.rest.split_first_chunk::<N>()?;
        self.rest = rest;
        Some(*head)
    }

    fn count(&mut self) -> Option<usize> {
        let n = u64::from_le_bytes(self.take()?) as usize;
        // Nothing is counted that the bytes left could not hold.
        (n <= self.rest.len()).then_some(n)
    }

    fn real(&mut self) -> Option<f64> {
        Some(f64::from_le_bytes(self.take()?))
    }

    fn single(&mut self) -> Option<f32> {
        Some(f32::from_le_bytes(self.take()?))
    }

    fn centre(&mut self) -> Option<[f32; 3]> {
        Some([self.single()?, self.single()?, self.single()?])
    }

    fn speeds(&mut self) -> Option<Vec<Footage>> {
        let speeds = self.count()?;
        (0..speeds).map(|_| self.footage()).collect()
    }

    fn footage(&mut self) -> Option<Footage> {
        let (speed_rpm, approach_s, froude) = (self.real()?, self.real()?, self.real()?);
        let per_body = self.count()? as u32;
        let spheres = self.count()?;
        let radii: Vec<f32> = (0..spheres).map(|_| self.single()).collect::<Option<_>>()?;
        let mut frames = Vec::new();
        for _ in 0..self.count()? {
            let instants = self.count()?;
            let frame = (0..instants)
                .map(|_| (0..spheres).map(|_| self.centre()).collect::<Option<Vec<_>>>())
                .collect::<Option<Vec<_>>>()?;
            frames.push(frame);
        }
        Some(Footage { speed_rpm, approach_s, froude, per_body, radii, frames })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> Vec<Footage> {
        vec![Footage {
            speed_rpm: 17.0,
            approach_s: 1.25,
            froude: 0.04,
            per_body: 1,
            radii: vec![0.003, 0.002],
            frames: vec![vec![vec![[0.01, -0.02, 0.0], [0.0, 0.1, 0.2]]]],
        }]
    }

    #[test]
    fn what_is_kept_comes_back() {
        assert_eq!(unpack(&pack(&some()), "a").unwrap(), some());
    }

    #[test]
    fn altered_or_cut_footage_is_refused() {
        let bytes = pack(&some());
        for k in [0, 9, 40, bytes.len() - 1] {
            let mut other = bytes.clone();
            other[k] ^= 1;
            assert!(matches!(unpack(&other, "a"), Err(CampaignError::Kept { .. })), "{k}");
        }
        for k in 0..bytes.len() {
            assert!(unpack(&bytes[..k], "a").is_err(), "{k}");
        }
    }
}
