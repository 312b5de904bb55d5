//! Meters: their quantities, and the sensors that receive their light.
//!
//! A measurement has no picture. Its camera consists of the sensors of all meters
//! ([`Camera::of_sensors`](super::camera::Camera::of_sensors)), and each row of its film belongs to
//! one sensor. Paths start at the sensors, so direct light needs one shadow ray, and light from
//! surfaces needs one path.

mod placement;
mod quantity;
mod sensor;

pub use quantity::{Quantity, QuantityKind};
pub use sensor::{ReceivingSide, Response, Sensor, SensorPoint, SensorShape};

use glam::DVec3;
use serde::Serialize;

#[derive(Debug, Clone, PartialEq)]
pub struct Meter {
    pub name: String,
    pub quantity: Quantity,
    /// One for each sensor, in the order of the sensors.
    pub readings: Vec<MeterReading>,
    pub grid: Option<MeterGrid>,
    /// True if a measurement with a target error waits for the readings of this meter.
    pub decides_stop: bool,
}

/// The points in the middles of the cells of a parallelogram. Positions are in the unit of the
/// scene file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeterGrid {
    pub origin: [f64; 3],
    /// The edge along the first index, which changes fastest.
    pub u: [f64; 3],
    pub v: [f64; 3],
    /// Along `u` and along `v`.
    pub count: [u32; 2],
}

/// The data of a reading that do not depend on the measured light.
#[derive(Debug, Clone, PartialEq)]
pub struct MeterReading {
    /// In the world, in the unit of the scene file: for a surface, the middle of its bounding box.
    pub position: DVec3,
    /// The normal, the axis or the direction of view. `None` for a sphere and for a surface.
    pub normal: Option<DVec3>,
    /// From the mean radiance of the sensor to the reading, apart from the factor of the quantity:
    /// π for illuminance and all its relatives, 1 for luminance.
    pub factor: f64,
    /// For a surface, in m²: the flux is the mean illuminance times this area.
    pub area_m2: Option<f64>,
}
