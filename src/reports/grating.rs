//! The angles and the efficiencies of the orders of a diffraction grating.

use abbe_optics::bsdf::ScatterEvent;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::grating::{DiffractedOrder, Grating};
use abbe_spectra::math::elementary::{atan2, sin_cos};
use glam::DVec3;
use serde::Serialize;

/// The light on a grating, the medium behind it, and a slit and a round stop around it.
#[derive(Debug)]
pub struct GratingSetup {
    /// The number of grooves per mm.
    pub lines_per_mm: f64,
    /// The angle of incidence, from -90 to 90.
    pub angle_deg: f64,
    /// The angle of the plane of incidence to that across the grooves, 0 with a slit or stop.
    pub azimuth_deg: f64,
    /// The fraction of the light that is reflected, from 0 to 1. The rest is transmitted.
    pub reflectance: f64,
    pub behind: RefractiveIndex,
    /// The diameter of the stop across the light of each order.
    pub stop_mm: Option<f64>,
    pub slit_deg: Option<f64>,
}

/// An order. If the incidence is conical, `degrees` is the angle to the normal.
#[derive(Debug, Serialize)]
pub struct OrderReport {
    pub order: i32,
    /// `reflected` or `transmitted`.
    pub side: &'static str,
    /// The angle to the normal, with a sign if the incidence is not conical.
    pub degrees: f64,
    /// The angle around the normal. Left out if the orders lie in the plane of incidence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth_degrees: Option<f64>,
    /// The fraction of the incident power.
    pub efficiency: f64,
    /// The resolving power mN/1.22 of N grooves (Rayleigh's criterion). Left out without a stop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resolving_power: Option<f64>,
    /// The difference in nm of the wavelengths whose images of the slit are side by side. Left out
    /// without a slit, and for the order 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slit_nm: Option<f64>,
}

#[derive(Debug, Serialize)]
pub struct GratingReport {
    /// The orders on both sides, from the lowest to the highest number.
    pub orders: Vec<OrderReport>,
}

impl GratingReport {
    /// Computes the orders of a grating in light of a wavelength in nm.
    pub fn of(grating: &Grating, setup: &GratingSetup, nm: f64) -> Self {
        let GratingSetup { angle_deg, azimuth_deg, reflectance, ref behind, .. } = *setup;
        let ((sin, cos), (sin_azimuth, cos_azimuth)) =
            (sin_cos(angle_deg.to_radians()), sin_cos(azimuth_deg.to_radians()));
        let incident = DVec3::new(sin * cos_azimuth, sin * sin_azimuth, -cos);
        let sides = [
            ("reflected", ScatterEvent::Reflection, 1.0, reflectance),
            ("transmitted", ScatterEvent::Transmission, behind.n(nm), 1.0 - reflectance),
        ];
        let mut orders = Vec::new();
        for (side, event, index, fraction) in sides.into_iter().filter(|side| side.3 > 0.0) {
            for order in grating.orders(incident, event, [1.0, index], nm) {
                let (degrees, azimuth_degrees) = angles(&order, azimuth_deg != 0.0);
                orders.push(OrderReport {
                    order: order.order,
                    side,
                    degrees,
                    azimuth_degrees,
                    efficiency: fraction * order.efficiency,
                    resolving_power: setup.resolving_power(&order),
                    slit_nm: setup.slit_nm(&order),
                });
            }
        }
        Self { orders }
    }
}

impl GratingSetup {
    /// Returns the resolving power. The stop is across the light of the order, which therefore
    /// illuminates it through a longer part of the grating.
    fn resolving_power(&self, order: &DiffractedOrder) -> Option<f64> {
        let grooves = self.stop_mm? * self.lines_per_mm / order.direction.z.abs();
        Some(f64::from(order.order.abs()) * grooves / 1.22)
    }

    /// Returns the width of the image of the slit in nm.
    fn slit_nm(&self, order: &DiffractedOrder) -> Option<f64> {
        let per_nm = f64::from(order.order.abs()) * self.lines_per_mm * 1e-6;
        let cos_incidence = sin_cos(self.angle_deg.to_radians()).1;
        self.slit_deg.filter(|_| order.order != 0).map(|slit| slit.to_radians() * cos_incidence / per_nm)
    }
}

/// Returns the angles of an order in degrees.
fn angles(order: &DiffractedOrder, conical: bool) -> (f64, Option<f64>) {
    if conical {
        (order.polar_deg(), Some(atan2(order.direction.y, order.direction.x).to_degrees()))
    } else {
        (order.signed_deg(), None)
    }
}
