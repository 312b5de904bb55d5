use super::Scene;
use super::geometry::Ray;
use super::meter::{ReceivingSide, Response, Sensor, SensorPoint, SensorShape};

impl Scene {
    /// Returns a point of a sensor. `u` selects the point of a surface and its side.
    pub fn sensor_point(&self, sensor: &Sensor, u: [f64; 4]) -> SensorPoint {
        match sensor.shape {
            SensorShape::Point(position, response) => {
                SensorPoint { position, from: None, response, medium_stack: sensor.medium_stack }
            }
            SensorShape::Surface(object, side) => {
                let sample = self.geometry.sample_area(object, [u[0], u[1], u[2]]);
                let front = match side {
                    ReceivingSide::Front => true,
                    ReceivingSide::Back => false,
                    ReceivingSide::Both => u[3] < 0.5,
                };
                let normal = if front { sample.normal } else { -sample.normal };
                let ray = Ray { origin: sample.position, direction: normal };
                let medium_stack = self.medium_stack_on(ray, sample.surface);
                let (position, from) = (sample.position, Some(sample.surface));
                SensorPoint { position, from, response: Response::Plane(normal), medium_stack }
            }
        }
    }
}
