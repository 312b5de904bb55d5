//! Orthonormal frames, which convert between world coordinates and the local axes of a surface.

use glam::DVec3;

/// A right-handed orthonormal frame whose third axis is the surface normal.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    s: DVec3,
    t: DVec3,
    n: DVec3,
}

impl Frame {
    /// Builds a frame around the unit vector `n`, continuous except at n.z = 0 (Duff et al. 2017).
    #[inline]
    pub fn new(n: DVec3) -> Self {
        let sign = 1.0_f64.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: DVec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// Returns the third axis.
    #[inline]
    pub fn normal(&self) -> DVec3 {
        self.n
    }

    /// Returns the components of a world vector along the axes of the frame.
    #[inline]
    pub fn to_local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Returns the world vector with the components `v` along the axes of the frame.
    #[inline]
    pub fn to_world(&self, v: DVec3) -> DVec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_invertible() {
        for n in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.6, 0.0, -0.8), DVec3::new(1e-9, 0.0, -1.0).normalize()] {
            let frame = Frame::new(n);
            let v = DVec3::new(0.3, -0.4, 0.5);
            assert!((frame.to_world(frame.to_local(v)) - v).length() < 1e-14);
            assert!((frame.s.cross(frame.t) - n).length() < 1e-14);
        }
    }
}
