//! Surfaces without symmetry of revolution: biconics, toroids, odd powers of the height,
//! polynomials in x and y, and Zernike polynomials. Automatic differentiation gives their slopes.

use std::ops::{Add, Mul, Sub};

use glam::{DVec2, DVec3};

use super::profile::{SurfaceProfile, TraceDirection, newton};

/// A surface z(x, y) whose vertex is at the origin. Lengths are in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Freeform {
    /// The surface of revolution that the terms change or extend.
    pub base: SurfaceProfile,
    /// What distinguishes the surface from its base.
    pub terms: FreeformTerms,
}

/// The terms of a [`Freeform`], in which coefficients are in mm and `radius_mm` is the unit of
/// length of x, y and the height.
#[derive(Debug, Clone, PartialEq)]
pub enum FreeformTerms {
    /// A conic with another curvature and conic constant along x than along y, those of the base.
    Biconic {
        /// Curvature along x in 1/mm.
        curvature_x_per_mm: f64,
        /// Conic constant along x.
        conic_x: f64,
    },
    /// The curve of the base in the yz plane, rotated about a line parallel to y.
    Toroid {
        /// Curvature along x in 1/mm, or 0 for a cylinder.
        curvature_x_per_mm: f64,
    },
    /// The base plus Σ aᵢ hⁱ, with i ≥ 1.
    Powers {
        /// The coefficients a₁, a₂, …
        coefficients: Box<[f64]>,
        /// Unit of the height h.
        radius_mm: f64,
    },
    /// The base plus the monomials x, y, x², xy, y², x³, …
    Polynomial {
        /// The coefficients in this order.
        coefficients: Box<[f64]>,
        /// Unit of x and y.
        radius_mm: f64,
    },
    /// The base plus Zernike polynomials, with angles from the x axis.
    Zernike {
        /// The coefficients of the polynomials 1, 2, …
        coefficients: Box<[ZernikeTerm]>,
        /// The radius of the unit circle.
        radius_mm: f64,
    },
}

impl FreeformTerms {
    /// Returns what the surface is called.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Biconic { .. } => "biconic surface",
            Self::Toroid { .. } => "toroid",
            Self::Powers { .. } => "odd asphere",
            Self::Polynomial { .. } => "polynomial surface",
            Self::Zernike { .. } => "Zernike surface",
        }
    }
}

/// A Zernike polynomial with its coefficient in mm, which contains the norm of the polynomial.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ZernikeTerm {
    n: u32,
    m: u32,
    is_sine: bool,
    coefficient_mm: f64,
}

/// The number of the polynomials in the fringe order.
pub(super) const FRINGE_TERMS: usize = 37;

impl ZernikeTerm {
    /// Creates the polynomial `j`, from 1 to 37, in the fringe order of the University of Arizona,
    /// which is not normalised.
    pub fn fringe(j: u32, coefficient_mm: f64) -> Self {
        if j as usize == FRINGE_TERMS {
            return Self { n: 12, m: 0, is_sine: false, coefficient_mm };
        }
        let group = (j - 1).isqrt();
        let place = j - 1 - group * group;
        let m = group - place / 2;
        Self { n: 2 * group - m, m, is_sine: place % 2 == 1, coefficient_mm }
    }

    /// Creates the polynomial `j`, from 1, in the order of Noll (1976), with a variance of 1.
    pub fn noll(j: u32, coefficient_mm: f64) -> Self {
        let n = (0..j).find(|n| (n + 1) * (n + 2) / 2 >= j).unwrap_or(0);
        let place = j - n * (n + 1) / 2;
        let m = if n.is_multiple_of(2) { 2 * (place / 2) } else { 2 * ((place - 1) / 2) + 1 };
        let norm = f64::from(if m == 0 { n + 1 } else { 2 * (n + 1) }).sqrt();
        Self { n, m, is_sine: m > 0 && j % 2 == 1, coefficient_mm: norm * coefficient_mm }
    }

    /// Returns the term at a point of the unit circle.
    fn at(&self, x: Dual, y: Dual) -> Dual {
        let square = x * x + y * y;
        let steps = (self.n - self.m) / 2;
        // Horner's rule in ρ², from the highest power; c is the coefficient of each.
        let factorial = |n: u32| (1..=n).map(f64::from).product::<f64>();
        let c = |s: u32| {
            let sign = if s.is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * factorial(self.n - s) / (factorial(s) * factorial((self.n + self.m) / 2 - s) * factorial(steps - s))
        };
        let radial = (0..=steps).fold(Dual::constant(0.0), |sum, s| sum * square + Dual::constant(c(s)));
        let (mut cosine, mut sine) = (Dual::constant(1.0), Dual::constant(0.0));
        for _ in 0..self.m {
            (cosine, sine) = (cosine * x - sine * y, cosine * y + sine * x);
        }
        radial * (if self.is_sine { sine } else { cosine }) * Dual::constant(self.coefficient_mm)
    }
}

/// A number with its derivatives along x and y.
#[derive(Debug, Clone, Copy)]
struct Dual {
    value: f64,
    slope: DVec2,
}

impl Dual {
    fn constant(value: f64) -> Self {
        Self { value, slope: DVec2::ZERO }
    }

    /// The square root, whose slope at 0 counts as 0.
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        let slope = if value == 0.0 { DVec2::ZERO } else { self.slope / (2.0 * value) };
        Self { value, slope }
    }

    fn inverse(self) -> Self {
        Self { value: 1.0 / self.value, slope: -self.slope / (self.value * self.value) }
    }
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self { value: self.value * other.value, slope: self.slope * other.value + other.slope * self.value }
    }
}

impl Freeform {
    /// Returns the sag in mm at a point, or NaN where the surface does not extend.
    pub fn sag_mm(&self, place: DVec2) -> f64 {
        self.sag(place).value
    }

    /// Returns the unit normal towards +z at a point of the surface.
    pub fn normal(&self, point: DVec3) -> DVec3 {
        (-self.sag(point.truncate()).slope).extend(1.0).normalize()
    }

    /// Intersects the surface with a line, as [`SurfaceProfile::intersect`] does.
    pub fn intersect(&self, origin: DVec3, direction: DVec3, travel: TraceDirection) -> Option<DVec3> {
        let start = self.base.intersect(origin, direction, travel);
        let start = start.unwrap_or_else(|| origin - direction * (origin.z / direction.z));
        newton(start, direction, travel, |place| {
            let sag = self.sag(place);
            (sag.value, sag.slope)
        })
    }

    fn sag(&self, place: DVec2) -> Dual {
        let x = Dual { value: place.x, slope: DVec2::X };
        let y = Dual { value: place.y, slope: DVec2::Y };
        let height2 = x * x + y * y;
        match &self.terms {
            FreeformTerms::Biconic { curvature_x_per_mm: cx, conic_x } => {
                let (cy, conic_y) = (self.base.curvature_per_mm, self.base.conic);
                let (bend_x, bend_y) = (Dual::constant(*cx) * x * x, Dual::constant(cy) * y * y);
                let under =
                    Dual::constant((1.0 + conic_x) * cx) * bend_x + Dual::constant((1.0 + conic_y) * cy) * bend_y;
                let root = (Dual::constant(1.0) - under).sqrt();
                (bend_x + bend_y) * (Dual::constant(1.0) + root).inverse()
            }
            FreeformTerms::Toroid { curvature_x_per_mm } => {
                let curve = self.revolved(y * y);
                // The circle about the line has the curvature c / (1 − c·z) at this y.
                let c = Dual::constant(*curvature_x_per_mm);
                let c = c * (Dual::constant(1.0) - c * curve).inverse();
                let root = (Dual::constant(1.0) - c * c * x * x).sqrt();
                curve + c * x * x * (Dual::constant(1.0) + root).inverse()
            }
            FreeformTerms::Powers { coefficients, radius_mm } => {
                let h = height2.sqrt() * Dual::constant(1.0 / radius_mm);
                let terms = coefficients.iter().rev();
                self.revolved(height2) + h * terms.fold(Dual::constant(0.0), |sum, a| sum * h + Dual::constant(*a))
            }
            FreeformTerms::Polynomial { coefficients, radius_mm } => {
                let unit = Dual::constant(1.0 / radius_mm);
                let (x, y) = (x * unit, y * unit);
                let mut sum = self.revolved(height2);
                // The monomials of one degree, each of which follows from the one of the degree before.
                let mut row = vec![Dual::constant(1.0)];
                let mut rest = coefficients.iter();
                while rest.len() > 0 {
                    let last = row.last().copied().map(|last| last * y);
                    row = row.into_iter().map(|term| term * x).chain(last).collect();
                    sum = row.iter().zip(rest.by_ref()).fold(sum, |sum, (term, a)| sum + *term * Dual::constant(*a));
                }
                sum
            }
            FreeformTerms::Zernike { coefficients, radius_mm } => {
                let unit = Dual::constant(1.0 / radius_mm);
                let (x, y) = (x * unit, y * unit);
                coefficients.iter().fold(self.revolved(height2), |sum, term| sum + term.at(x, y))
            }
        }
    }

    /// The sag of the base at a squared height.
    fn revolved(&self, height2: Dual) -> Dual {
        let (value, slope) = self.base.sag_and_slope(height2.value);
        Dual { value, slope: slope * height2.slope }
    }
}
