use super::FieldLine;
use abbe_spectra::math::quadrature::gauss4;
use glam::DVec3;
use std::ops::ControlFlow;

/// A ball that fades near its surface: a smoothstep function of the squared distance from the
/// centre, which is a polynomial along every line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallField {
    pub value: f64,
    pub center: DVec3,
    pub radius: f64,
    /// The fraction of the radius over which the field fades.
    pub falloff: f64,
}

impl BallField {
    /// Where the fade begins.
    fn inner(&self) -> f64 {
        self.radius * (1.0 - self.falloff)
    }

    pub(super) fn at(&self, local: DVec3) -> f64 {
        self.value * fade((local - self.center).length_squared(), self.inner(), self.radius)
    }

    /// The value at the point of the line nearest to the centre.
    pub(super) fn majorant(&self, line: &FieldLine, interval: (f64, f64)) -> f64 {
        self.at(line.at(line.nearest_to(self.center).clamp(interval.0, interval.1)))
    }

    /// Visits up to three pieces: the fading shell, the inner part, and the shell again.
    pub(super) fn for_each_piece(
        &self,
        line: &FieldLine,
        interval: (f64, f64),
        mut visit: impl FnMut((f64, f64)) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let nearest = line.nearest_to(self.center);
        let Some(outer) = line.crossings(self.center, self.radius, nearest) else {
            return ControlFlow::Continue(());
        };
        let inner = line.crossings(self.center, self.inner(), nearest).unwrap_or((nearest, nearest));
        for (from, to) in [(outer.0, inner.0), inner, (inner.1, outer.1)] {
            let piece = (from.max(interval.0), to.min(interval.1));
            if piece.0 < piece.1 {
                visit(piece)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Integrates a piece exactly: along a line, the fade is a polynomial of degree 6.
    pub(super) fn integral(&self, line: &FieldLine, piece: (f64, f64)) -> f64 {
        gauss4(piece, |t| self.at(line.at(t)))
    }
}

/// Returns 1 inside, 0 outside, and a smoothstep of the squared distance in between.
pub(super) fn fade(distance_squared: f64, inner: f64, outer: f64) -> f64 {
    if distance_squared <= inner * inner {
        1.0
    } else if distance_squared >= outer * outer {
        0.0
    } else {
        let u = (outer * outer - distance_squared) / ((outer - inner) * (outer + inner));
        u * u * (3.0 - 2.0 * u)
    }
}
