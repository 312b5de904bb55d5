//! Thick plates with coated faces.

use super::airy::{PolarisedResponse, StackResponse};

/// The responses of the two faces of a thick plate, which lies in one medium.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoatedPlate {
    /// The front face, for light from outside.
    pub front: StackResponse,
    /// The front face, for light from inside the plate.
    pub front_inside: StackResponse,
    /// The back face, for light from inside the plate.
    pub back_inside: StackResponse,
    /// The internal transmittance of one passage through the plate, from 0 to 1.
    pub passage: f64,
}

/// The reflectance and the transmittance of a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlateResponse {
    /// R and T for s polarised light.
    pub s: [f64; 2],
    /// R and T for p polarised light.
    pub p: [f64; 2],
}

impl CoatedPlate {
    /// Returns the reflectance and the transmittance. The plate is thick, so the powers of the
    /// reflections between its faces add, separately for s and p.
    pub fn response(&self) -> PlateResponse {
        let one = |of: fn(&StackResponse) -> &PolarisedResponse| {
            let (front, inside, back) = (of(&self.front), of(&self.front_inside), of(&self.back_inside));
            let repeated = 1.0 - inside.reflectance * back.reflectance * self.passage * self.passage;
            if repeated <= 0.0 {
                return [1.0, 0.0];
            }
            let arriving = front.transmittance * self.passage / repeated;
            let reflected = front.reflectance + arriving * back.reflectance * self.passage * inside.transmittance;
            [reflected.min(1.0), arriving * back.transmittance]
        };
        PlateResponse { s: one(|face| &face.s), p: one(|face| &face.p) }
    }
}

impl PlateResponse {
    /// Returns R and T for unpolarised light.
    pub fn mean(&self) -> [f64; 2] {
        std::array::from_fn(|i| 0.5 * (self.s[i] + self.p[i]))
    }
}
