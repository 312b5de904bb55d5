//! Plane waves in a crystal.

use super::indices::UniaxialIndices;
use abbe_spectra::math::complex::Complex;
use abbe_spectra::math::elementary::atan2;
use glam::DVec3;

/// One of the two waves of a direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrystalMode {
    /// The field is perpendicular to the optic axis and to the wave vector.
    Ordinary,
    /// The field lies in the plane of the optic axis and the wave vector.
    Extraordinary,
}

/// A plane wave in a crystal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrystalWave {
    /// The wave vector in units of ω/c.
    pub k: DVec3,
    /// The direction of the ray, along which power flows. A unit vector.
    pub ray: DVec3,
    /// The direction of the electric field. A unit vector, whose sign has no meaning.
    pub electric: DVec3,
}

impl CrystalWave {
    /// Returns the index of the wave, |k|.
    pub fn index(&self) -> f64 {
        self.k.length()
    }

    /// Returns the walk-off in radians: the angle between the wave vector and the ray.
    pub fn walk_off(&self) -> f64 {
        atan2(self.k.cross(self.ray).length(), self.k.dot(self.ray))
    }
}

/// A plane wave with a wave vector that may be complex: (real, real, complex).
#[derive(Debug, Clone, Copy)]
pub(super) struct ComplexWave {
    pub(super) k: [Complex; 3],
    pub(super) electric: [Complex; 3],
    pub(super) magnetic: [Complex; 3],
}

pub(super) fn cross(a: [Complex; 3], b: [Complex; 3]) -> [Complex; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the direction of s, z × k, which is +y at normal incidence.
pub(super) fn across(tangential: DVec3) -> DVec3 {
    DVec3::Z.cross(tangential).try_normalize().unwrap_or(DVec3::Y)
}

pub(super) fn complex(v: DVec3) -> [Complex; 3] {
    v.to_array().map(Complex::from)
}

impl ComplexWave {
    /// Creates the wave with an electric field of this direction and of the length 1.
    pub(super) fn new(k: [Complex; 3], electric: [Complex; 3]) -> Self {
        let length = electric.iter().map(|part| part.norm_squared()).sum::<f64>().sqrt();
        let electric = electric.map(|part| part * (1.0 / length));
        Self { k, electric, magnetic: cross(k, electric) }
    }

    /// Returns the flow of power along z, E × H*, in units of that of a field of 1 in the vacuum.
    pub(super) fn flow(&self) -> f64 {
        let [e, h] = [self.electric, self.magnetic];
        (e[0] * h[1].conjugate() - e[1] * h[0].conjugate()).re
    }
}

impl UniaxialIndices {
    /// Returns k_z of a wave with the tangential wave vector `tangential` (z = 0) whose power flows
    /// along +z if `upward`, and along −z otherwise. If it is complex, the wave decays in this
    /// direction. `axis` is a unit vector.
    pub(super) fn normal_component(&self, mode: CrystalMode, axis: DVec3, tangential: DVec3, upward: bool) -> Complex {
        let sign = if upward { 1.0 } else { -1.0 };
        let (o2, e2) = (self.ordinary * self.ordinary, self.extraordinary * self.extraordinary);
        let t2 = tangential.length_squared();
        match mode {
            CrystalMode::Ordinary => Complex::from(o2 - t2).sqrt() * sign,
            CrystalMode::Extraordinary => {
                // a·k_z² + 2b·k_z + c = 0, and the z component of the ray is a·k_z + b.
                let difference = 1.0 / o2 - 1.0 / e2;
                let along = tangential.dot(axis);
                let a = 1.0 / e2 + difference * axis.z * axis.z;
                let b = difference * along * axis.z;
                let c = difference * along * along + t2 / e2 - 1.0;
                (Complex::from(b * b - a * c).sqrt() * sign - Complex::from(b)) * (1.0 / a)
            }
        }
    }

    /// Returns the wave with a complex wave vector. A wave along the optic axis has no special
    /// plane; its ordinary field then lies along `across`, which is perpendicular to the axis.
    pub(super) fn complex_wave(&self, mode: CrystalMode, axis: DVec3, k: [Complex; 3], across: DVec3) -> ComplexWave {
        let c = complex(axis);
        let perpendicular = cross(k, c);
        let sine2: f64 = perpendicular.iter().map(|part| part.norm_squared()).sum();
        let along_axis = sine2 < 1e-20;
        let ordinary = if along_axis { complex(across) } else { perpendicular };
        let electric = match mode {
            CrystalMode::Ordinary => ordinary,
            CrystalMode::Extraordinary if along_axis => cross(k, ordinary),
            CrystalMode::Extraordinary => {
                // E is parallel to n_o² c − (k·c) k.
                let dot = k[0] * c[0] + k[1] * c[1] + k[2] * c[2];
                let o2 = self.ordinary * self.ordinary;
                std::array::from_fn(|i| c[i] * o2 - dot * k[i])
            }
        };
        ComplexWave::new(k, electric)
    }

    /// Returns the wave with a real wave vector `k`.
    pub(super) fn wave(&self, mode: CrystalMode, axis: DVec3, k: DVec3, across: DVec3) -> CrystalWave {
        let field = self.complex_wave(mode, axis, complex(k), across).electric;
        let ray = match mode {
            CrystalMode::Ordinary => k,
            CrystalMode::Extraordinary => {
                let (o2, e2) = (self.ordinary * self.ordinary, self.extraordinary * self.extraordinary);
                k / e2 + axis * ((1.0 / o2 - 1.0 / e2) * k.dot(axis))
            }
        };
        CrystalWave { k, ray: ray.normalize(), electric: DVec3::from_array(field.map(|part| part.re)) }
    }
}
