//! Translates the meters of the scene file to the sensors that take the place of the camera.

use super::context::Resolver;
use crate::{JsonPath, MeterFile, MeterGridFile};
use abbe_scene::builder::SceneBuilder;
use abbe_scene::camera::Camera;
use abbe_scene::meter::{Meter, MeterReading, ReceivingSide, Response, Sensor};
use abbe_scene::{Exposure, FilmSpec};
use abbe_spectra::colour::gamut::GamutMapping;
use abbe_spectra::colour::tone::ToneCurve;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::warp;
use abbe_spectra::spectrum::Observer;
use glam::DVec3;

/// A measurement has at least this number of rows, so that few readings keep many threads busy.
const LEAST_ROWS: usize = 32;

const MOST_READINGS: usize = 1_000_000;

type SensorWithReading = (Sensor, MeterReading);

impl Resolver<'_> {
    /// Resolves all meters. Returns the camera that consists of their sensors, and its film.
    pub(super) fn meters(&self, builder: &mut SceneBuilder) -> Result<(Camera, FilmSpec, Vec<Meter>)> {
        let root = JsonPath::Root;
        let (mut sensors, mut meters) = (Vec::new(), Vec::<Meter>::new());
        let meters_at = root.key("meters");
        for (i, file) in self.scene.meters.iter().enumerate() {
            let at = meters_at.index(i);
            if meters.iter().any(|meter| meter.name == file.name) {
                let what = format!("found the name \"{}\" twice", file.name);
                return Err(self.source.fault(&at.key("name"), what, "another name"));
            }
            let (of_meter, readings): (Vec<Sensor>, _) = self.sensors(&at, file, builder)?.into_iter().unzip();
            sensors.extend(of_meter);
            if sensors.len() > MOST_READINGS {
                let what = format!("found more than {MOST_READINGS} readings");
                return Err(self.source.fault(&at, what, "fewer points"));
            }
            let (name, quantity) = (file.name.clone(), file.quantity());
            let grid = file.grid.as_ref().map(MeterGridFile::grid);
            meters.push(Meter { name, quantity, readings, grid, decides_stop: true });
        }
        let rows = LEAST_ROWS.div_ceil(sensors.len()) as u32;
        let height = sensors.len() as u32 * rows;
        let spectral_bands = meters.iter().map(|meter| meter.quantity.kind().bands()).max().unwrap_or(0);
        let visual = meters.iter().all(|meter| meter.quantity.observer().name() == Observer::cie1931().name());
        // The wavelengths of light are sampled by the importance to this observer.
        let observer = if visual { Observer::cie1931() } else { Observer::radiometric() };
        let film = FilmSpec {
            spectral_bands,
            gamut: GamutMapping::Clip,
            tone: ToneCurve::Clip,
            exposure: Exposure::None,
            denoise: Some(false),
            ..FilmSpec::new(1, height, observer)
        };
        Ok((Camera::of_sensors(sensors.into(), rows), film, meters))
    }

    fn sensors(&self, at: &JsonPath, file: &MeterFile, builder: &SceneBuilder) -> Result<Vec<SensorWithReading>> {
        let MeterFile { name: _, quantity: _, points, grid, normal, surface, side, sphere, cylinder, spot } = file;
        let at_point = |point: [f64; 3], response: Response, normal: Option<DVec3>| {
            let sensor = Sensor::at(self.point(point, builder.centre()), response, builder.extent_m());
            let position = DVec3::from(point);
            (sensor, MeterReading { position, normal, factor: response.factor(), area_m2: None })
        };
        let up = |direction: &Option<[f64; 3]>| DVec3::from(direction.unwrap_or([0.0, 1.0, 0.0])).normalize();
        let plane = |point: &[f64; 3]| at_point(*point, Response::Plane(up(normal)), Some(up(normal)));
        if let Some(points) = points {
            return Ok(points.iter().map(plane).collect());
        }
        if let Some(grid) = grid {
            let [columns, rows] = grid.count.map(|count| count as usize);
            if columns * rows > MOST_READINGS {
                let expected = format!("at most {MOST_READINGS} points");
                let at = at.key("grid");
                return Err(self.source.fault(&at.key("count"), format!("found {} points", columns * rows), expected));
            }
            return Ok(grid.points().iter().map(plane).collect());
        }
        if let Some(name) = surface {
            let side = side.unwrap_or_default().side();
            return self.surface_sensor(&at.key("surface"), name, side, builder).map(|found| vec![found]);
        }
        if let Some(sphere) = sphere {
            return Ok(vec![at_point(sphere.at, Response::Sphere, None)]);
        }
        if let Some(cylinder) = cylinder {
            let axis = up(&cylinder.axis);
            return Ok(vec![at_point(cylinder.at, Response::Cylinder(axis), Some(axis))]);
        }
        let Some(spot) = spot else { return Ok(Vec::new()) };
        let axis = (DVec3::from(spot.to) - DVec3::from(spot.from)).normalize();
        let response = Response::Cone(axis, warp::one_minus_cos(0.5 * spot.angle.to_radians()));
        Ok(vec![at_point(spot.from, response, Some(axis))])
    }

    fn surface_sensor(
        &self,
        at: &JsonPath,
        name: &str,
        side: ReceivingSide,
        builder: &SceneBuilder,
    ) -> Result<SensorWithReading> {
        let names: Vec<&str> = builder.object_names().collect();
        let object = names.iter().position(|known| *known == name);
        let object = self.at(at, object.ok_or_else(|| Error::unknown_name("object", name, names)))?;
        let (object, area_m2) = (object as u32, builder.area_m2(object as u32));
        if area_m2 <= 0.0 {
            let what = format!("the object \"{name}\" has no surface");
            return Err(self.source.fault(at, what, "an object with a surface"));
        }
        let position = builder.middle_of(object) / self.metres;
        let sides = if side == ReceivingSide::Both { 2.0 } else { 1.0 };
        let factor = sides * Response::Plane(DVec3::Y).factor();
        // A random side receives each sample, so the sum of both sides is twice the mean.
        let reading = MeterReading { position, normal: None, factor, area_m2: Some(area_m2) };
        Ok((Sensor::on_object(object, side), reading))
    }
}
