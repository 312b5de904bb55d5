//! A field that decreases exponentially with the height above a plain or a planet.

use super::FieldLine;
use abbe_spectra::math::elementary::{exp, exp_m1};
use abbe_spectra::math::quadrature::gauss16;
use glam::DVec3;
use std::ops::ControlFlow;

/// The field is `value` times exp(−height/`scale_height`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Atmosphere {
    pub value: f64,
    /// The increase in height over which the field decreases by the factor 1/e.
    pub scale_height: f64,
    pub above: Ground,
}

/// The surface at height 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Ground {
    /// The plane at this y coordinate. Heights below the plane are negative.
    Plain(f64),
    /// A sphere, inside of which the height is 0.
    Planet(Planet),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Planet {
    pub center: DVec3,
    pub radius: f64,
}

/// The thickness of a shell in scale heights, for which Gauss quadrature with sixteen points has a
/// relative error below 10⁻¹⁴, even for a line that is tangent to a sphere of constant height.
const HEIGHTS_PER_PIECE: f64 = 8.0;

/// The largest number of pieces of a line on each side of its lowest point. Beyond them, the field
/// is less than e⁻⁴⁰ times the field at that point.
const MAX_PIECES: u32 = 5;

impl Atmosphere {
    fn height(&self, local: DVec3) -> f64 {
        match self.above {
            Ground::Plain(y) => local.y - y,
            Ground::Planet(planet) => ((local - planet.center).length() - planet.radius).max(0.0),
        }
    }

    pub(super) fn at(&self, local: DVec3) -> f64 {
        self.value * exp(-self.height(local) / self.scale_height)
    }

    /// The value at the lowest point of the line.
    pub(super) fn majorant(&self, line: &FieldLine, interval: (f64, f64)) -> f64 {
        match self.above {
            Ground::Plain(_) => self.at(line.at(interval.0)).max(self.at(line.at(interval.1))),
            Ground::Planet(planet) => self.at(line.at(line.nearest_to(planet.center).clamp(interval.0, interval.1))),
        }
    }

    pub(super) fn max(&self, bounds: (DVec3, DVec3)) -> f64 {
        match self.above {
            Ground::Plain(_) => self.at(bounds.0),
            Ground::Planet(planet) => self.at(planet.center.clamp(bounds.0, bounds.1)),
        }
    }

    /// Visits the pieces of a line: the whole line above a plain, or its parts inside the planet
    /// and inside spherical shells of equal thickness around it.
    pub(super) fn for_each_piece(
        &self,
        line: &FieldLine,
        interval: (f64, f64),
        mut visit: impl FnMut((f64, f64)) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let Ground::Planet(planet) = self.above else { return visit(interval) };
        let nearest = line.nearest_to(planet.center);
        let ground = line.crossings(planet.center, planet.radius, nearest).unwrap_or((nearest, nearest));
        let shells = |from: f64| self.shells(line, &planet, from);
        // The line goes down through the shells, through the planet, and up through the shells.
        if interval.0 < ground.0 {
            let lowest = interval.1.min(ground.0);
            let edges = shells(lowest);
            for pair in edges.windows(2).rev() {
                visit_within(interval, (2.0 * nearest - pair[1], 2.0 * nearest - pair[0]), &mut visit)?;
            }
        }
        visit_within(interval, ground, &mut visit)?;
        if interval.1 > ground.1 {
            let edges = shells(interval.0.max(ground.1));
            for pair in edges.windows(2) {
                visit_within(interval, (pair[0], pair[1]), &mut visit)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// The parameters at which the rising half of the line crosses the edges of the shells. The
    /// lowest shell begins at the height of the point `from`, on either half of the line.
    fn shells(&self, line: &FieldLine, planet: &Planet, from: f64) -> [f64; MAX_PIECES as usize + 1] {
        let nearest = line.nearest_to(planet.center);
        let closest = (line.at(nearest) - planet.center).length();
        let lowest = (line.at(from) - planet.center).length();
        let speed = line.direction.length();
        std::array::from_fn(|i| {
            if i == 0 {
                return nearest + (from - nearest).abs();
            }
            let radius = lowest + i as f64 * HEIGHTS_PER_PIECE * self.scale_height;
            nearest + ((radius - closest) * (radius + closest)).sqrt() / speed
        })
    }

    pub(super) fn integral(&self, line: &FieldLine, piece: (f64, f64)) -> f64 {
        match self.above {
            Ground::Plain(_) => {
                // The product of (1 − e⁻ˣ)/x, the value at the lower end, and the length.
                let x = (line.direction.y * (piece.1 - piece.0) / self.scale_height).abs();
                let fraction = if x == 0.0 { 1.0 } else { -exp_m1(-x) / x };
                self.majorant(line, piece) * (piece.1 - piece.0) * fraction
            }
            Ground::Planet(_) => gauss16(piece, |t| self.at(line.at(t))),
        }
    }
}

/// Visits the part of a piece that lies inside the interval.
fn visit_within(
    interval: (f64, f64),
    piece: (f64, f64),
    visit: &mut impl FnMut((f64, f64)) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let piece = (piece.0.max(interval.0), piece.1.min(interval.1));
    if piece.0 < piece.1 { visit(piece) } else { ControlFlow::Continue(()) }
}
