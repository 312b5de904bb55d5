//! The points of receptors in a scene.

use super::Scene;
use super::geometry::Ray;
use super::meter::{ReceivingSide, Receptor, ReceptorPoint, ReceptorShape, Response};

impl Scene {
    /// Returns a point of a receptor. `u` selects the point of a surface and its side.
    pub fn receptor_point(&self, receptor: &Receptor, u: [f64; 4]) -> ReceptorPoint {
        match receptor.shape {
            ReceptorShape::Point(position, response) => {
                ReceptorPoint { position, from: None, response, medium_stack: receptor.medium_stack }
            }
            ReceptorShape::Surface(object, side) => {
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
                ReceptorPoint { position, from, response: Response::Plane(normal), medium_stack }
            }
        }
    }
}
