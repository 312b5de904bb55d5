use super::{PlacedShape, Shape};
use abbe_spectra::math::elementary::sin;
use std::f64::consts::PI;

impl Shape {
    /// The volume that the shape encloses in its local frame, in m³: 0 for flat shapes.
    pub fn volume_m3(&self) -> f64 {
        match self {
            Self::Sphere { radius } => 4.0 / 3.0 * PI * radius.powi(3),
            Self::Rectangle { .. } | Self::Disk { .. } => 0.0,
            Self::Box { size } => size.x * size.y * size.z,
            Self::Cylinder { radius, height } => PI * radius * radius * height,
            Self::Prism { side, length, apex_deg } => 0.5 * side * side * sin(apex_deg.to_radians()) * length,
            Self::Lens { radius1, radius2, thickness, diameter } => {
                // A cylinder between the rims plus one cap per surface, negative for a concave one.
                let rim = 0.5 * diameter;
                let sag = |radius: f64| {
                    if radius == 0.0 {
                        0.0
                    } else {
                        rim * rim / (radius + (radius * radius - rim * rim).max(0.0).sqrt().copysign(radius))
                    }
                };
                let cap = |sag: f64| PI / 6.0 * sag * (3.0 * rim * rim + sag * sag);
                let (front, back) = (sag(*radius1), sag(*radius2));
                PI * rim * rim * (thickness + back - front) + cap(front) - cap(back)
            }
            Self::Mesh(mesh) => mesh.signed_volume().abs(),
        }
    }
}

impl PlacedShape {
    /// The volume that the shape encloses in the world, in m³.
    pub fn volume_m3(&self) -> f64 {
        self.shape.volume_m3() * self.to_world.matrix3.determinant().abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a ball lens, a plane-parallel disk, a meniscus, a biconcave lens and a prism.
    #[test]
    fn lens_and_prism_volumes_match_closed_forms() {
        let lens = |radius1, radius2, thickness| Shape::Lens { radius1, radius2, thickness, diameter: 2.0 }.volume_m3();
        assert!((lens(1.0, -1.0, 2.0) - 4.0 / 3.0 * PI).abs() < 1e-12);
        assert!((lens(0.0, 0.0, 0.3) - 0.3 * PI).abs() < 1e-12);
        // The bulge of one surface equals the hollow of the other, which has the same radius.
        assert!((lens(3.0, 3.0, 0.3) - 0.3 * PI).abs() < 1e-12);
        // A cylinder of 2.5 m height minus two caps of 1 m sagitta, which together are a ball.
        assert!((lens(-1.0, 1.0, 0.5) - (2.5 * PI - 4.0 / 3.0 * PI)).abs() < 1e-12);
        let prism = Shape::Prism { side: 2.0, length: 3.0, apex_deg: 60.0 };
        assert!((prism.volume_m3() - 3.0 * 3.0_f64.sqrt()).abs() < 1e-12);
    }
}
