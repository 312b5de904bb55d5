//! Meters: their quantities, and the receptors that receive their light.
//!
//! A measurement has no picture. Its camera consists of the receptors of all meters
//! ([`Camera::of_sensors`](super::camera::Camera::of_receptors)), and each row of its film
//! belongs to one receptor. Paths start at the receptors, so direct light needs one shadow ray, and
//! light from surfaces needs one path.

mod placement;
mod quantity;
mod sensor;

pub use quantity::{Quantity, QuantityKind};
pub use sensor::{ReceivingSide, Response, Sensor, SensorPoint, SensorShape};

use glam::DVec3;
use serde::Serialize;

/// A meter.
#[derive(Debug, Clone, PartialEq)]
pub struct Meter {
    /// The name in reports.
    pub name: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The readings, one for each receptor, in the order of the receptors.
    pub readings: Vec<MeterReading>,
    /// The grid of the readings, if the meter is one.
    pub grid: Option<MeterGrid>,
    /// True if a measurement with a target error waits for the readings of this meter.
    pub decides_stop: bool,
}

/// The grid of a meter: points in the middles of the cells of a parallelogram. All positions are in
/// the unit of the scene file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeterGrid {
    /// A corner of the parallelogram.
    pub origin: [f64; 3],
    /// The edge along the first index, which changes fastest.
    pub u: [f64; 3],
    /// The edge along the second index.
    pub v: [f64; 3],
    /// The numbers of cells along `u` and along `v`.
    pub count: [u32; 2],
}

/// The data of a reading that do not depend on the measured light.
#[derive(Debug, Clone, PartialEq)]
pub struct MeterReading {
    /// The position in the world, in the unit of the scene file. For a surface, it is the middle of
    /// its bounding box.
    pub position: DVec3,
    /// The normal, the axis or the direction of view. `None` for a sphere and for a surface.
    pub normal: Option<DVec3>,
    /// The factor from the mean radiance of the receptor to the reading, apart from the factor of
    /// the quantity: π for illuminance and all its relatives, 1 for luminance.
    pub factor: f64,
    /// The area in m², if the receptor is a surface. The flux is the mean illuminance times this
    /// area.
    pub area_m2: Option<f64>,
}
