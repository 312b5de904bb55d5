//! Energy compensation: the light that microfacets scatter more than once.
//!
//! The single-scattering model of rough surfaces loses the energy of light that hits a second
//! microfacet. A second, wide lobe returns it (Kulla & Conty, "Revisiting physically based shading
//! at Imageworks", 2017, after Kelemen & Szirmay-Kalos 2001). With the missing energy l(μ), the
//! lobe is the reciprocal l(μ_o)·l(μ_i)/(π·l̄).

use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::{Arc, OnceLock};

use glam::DVec3;

use super::angle_grid::{AngleGrid, GridPoint};
use super::facet::FacetResponse;
use super::facet_quadrature::{FacetKind, FacetQuadrature};
use super::film_moments::{CosineFit, FilmMoments, FilmSideMoments, MOMENTS, NODES};
use super::missing_energy::MissingEnergy;
use super::power::PowerFractions;
use super::sample::ScatterEvent;
use crate::fresnel;
use crate::microfacet::Ggx;
use abbe_spectra::math::elementary::{exp, exp_m1, ln, ln_1p, sin_cos};

/// There are tables for the relative indices exp(±(k·STEP)²), dense near index 1, where the
/// critical angle of total reflection changes fast.
const STEP: f64 = 0.0075;
/// The largest k. Its relative index is above 100, and its table is used beyond it.
const LAST: usize = 288;

/// Lowers the missing energy of facets with films by more than the error of the polynomials in
/// `film_moments.rs` for films of usual thickness, so that the surface does not gain energy.
const FIT_MARGIN: f64 = 0.996;

/// Films leave at least this fraction of the missing energy.
const LEAST_CHANGE: f64 = 0.1;

/// The missing energy of a rough dielectric of one roughness, at every relative index. A table is
/// computed when it is first used, from the roughness and the index alone.
#[derive(Debug, Clone)]
pub(super) struct DielectricCompensation(Arc<Tables>);

#[derive(Debug)]
struct Tables {
    facets: Ggx,
    quadrature: FacetQuadrature,
    grid: AngleGrid,
    sampling: LobeSampling,
    /// One table per relative index, from exp(−(LAST·STEP)²) to exp((LAST·STEP)²).
    by_index: Vec<OnceLock<MissingEnergy>>,
    /// The changes by thin films, at the relative indices above 1.
    film_moments: Vec<OnceLock<FilmMoments>>,
    fit: CosineFit,
}

/// Compares the microfacets, from which the tables follow.
impl PartialEq for DielectricCompensation {
    fn eq(&self, other: &Self) -> bool {
        self.0.facets == other.0.facets
    }
}

impl DielectricCompensation {
    pub(super) fn new(facets: Ggx) -> Self {
        Self(Arc::new(Tables {
            quadrature: FacetQuadrature::new(facets),
            grid: AngleGrid::new(&facets),
            sampling: LobeSampling::new(&facets),
            facets,
            by_index: (0..=2 * LAST).map(|_| OnceLock::new()).collect(),
            film_moments: (0..=LAST).map(|_| OnceLock::new()).collect(),
            fit: CosineFit::new(),
        }))
    }

    /// Returns the lobe of light that arrives in the medium of index `n_i` at one of index `n_t`.
    pub(super) fn between(&self, n_i: f64, n_t: f64) -> MultipleScattering<'_> {
        let position = Position::between(n_i, n_t);
        let side = |upwards: bool| position.side(&self.0, upwards);
        self.lobe([side(n_t > n_i), side(n_t < n_i)], [n_i, n_t], [1.0; 2])
    }

    /// Returns the lobe at an interface between different indices whose facets have thin films.
    pub(super) fn between_films<'a>(&'a self, [n_i, n_t]: [f64; 2], films: &FilmMean) -> MultipleScattering<'a> {
        let tables = &self.0;
        let position = Position::between(n_i, n_t);
        let coefficients = films.coefficients;
        let (low, high) = (tables.moments(position.low), tables.moments(position.low + 1));
        let loss = position.mixed(dot(&low.transmitted, &coefficients), dot(&high.transmitted, &coefficients));
        let side = |upwards: bool, n: f64| {
            let of_side = |moments: &'a FilmMoments| if upwards { &moments.from_rare } else { &moments.from_dense };
            let squared = n_i.min(n_t) / n;
            let transmitted = -loss * squared * squared;
            let films = FilmChange { low: of_side(low), high: of_side(high), coefficients, transmitted };
            OneSide { films: Some(films), ..position.side(tables, upwards) }
        };
        let sides = [side(n_t > n_i, n_i), side(n_t < n_i, n_t)];
        let [rare, dense] = films.kept;
        let each = if n_i < n_t { [rare, dense] } else { [dense, rare] };
        let [here, there] = [0, 1].map(|side| kept_by_facets(each[side], sides[side].mean()));
        self.lobe(sides, [n_i, n_t], [here, (here * there).sqrt()])
    }

    /// Returns the mean properties of facets with films for light in media of two different
    /// indices.
    pub(super) fn film_mean(&self, [n_i, n_t]: [f64; 2], facets: [&impl FacetResponse; 2], absorbs: bool) -> FilmMean {
        let fit = &self.0.fit;
        let [rare, dense] = if n_i < n_t { facets } else { [facets[1], facets[0]] };
        let powers = fit.nodes.map(|cos| rare.powers(cos));
        let index = n_i.max(n_t) / n_i.min(n_t);
        let mut change = [0.0; NODES];
        for (node, change) in change.iter_mut().enumerate() {
            let PowerFractions { reflected, transmitted } = powers[node];
            let of_bare = 1.0 - fresnel::dielectric(fit.nodes[node], 1.0, index);
            *change = 1.0 - transmitted / (reflected + transmitted).max(f64::MIN_POSITIVE) / of_bare;
        }
        let either = |powers: PowerFractions| powers.reflected + powers.transmitted;
        let kept = if absorbs {
            [fit.mean(&powers.map(either)), fit.mean(&fit.nodes.map(|cos| either(dense.powers(cos))))]
        } else {
            [1.0; 2]
        };
        FilmMean { coefficients: fit.coefficients(&change), kept }
    }

    /// Returns the lobe between two sides, where `kept` is left of either part.
    fn lobe<'a>(
        &'a self,
        [here, there]: [OneSide<'a>; 2],
        [n_i, n_t]: [f64; 2],
        kept: [f64; 2],
    ) -> MultipleScattering<'a> {
        MultipleScattering {
            grid: &self.0.grid,
            sampling: self.0.sampling,
            transmitted: transmitted_fraction([&here, &there], [n_i, n_t]),
            here,
            there,
            kept,
        }
    }
}

/// The properties of facets with thin films that the lobe of multiple scattering needs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FilmMean {
    /// See `film_moments.rs`.
    coefficients: [f64; MOMENTS],
    /// The mean fractions left by the films for light in the medium of lower and higher index.
    kept: [f64; 2],
}

impl FilmMean {
    /// Interpolates between two wavelengths, with the weight `fraction` of `other`.
    pub(super) fn mixed(&self, other: &Self, fraction: f64) -> Self {
        let mix = |low: f64, high: f64| low + fraction * (high - low);
        Self {
            coefficients: std::array::from_fn(|i| mix(self.coefficients[i], other.coefficients[i])),
            kept: std::array::from_fn(|i| mix(self.kept[i], other.kept[i])),
        }
    }
}

/// Returns the fraction of the multiply scattered light that facets of mean missing energy
/// `missing` return if each event keeps the fraction `each`.
fn kept_by_facets(each: f64, missing: f64) -> f64 {
    // After the first two events, the fraction 1 − l̄ of the light leaves in each event.
    each * each * (1.0 - missing) / (1.0 - each * missing)
}

#[derive(Debug, Clone, Copy)]
struct Position {
    /// The number of the lower table on each side of index 1.
    low: usize,
    /// The weight of the next table, from 0 to 1.
    fraction: f64,
}

impl Position {
    fn between(n_i: f64, n_t: f64) -> Self {
        let position = (ln(n_i.max(n_t) / n_i.min(n_t)).sqrt() / STEP).min(LAST as f64);
        let low = (position as usize).min(LAST - 1);
        Self { low, fraction: position - low as f64 }
    }

    fn mixed(self, low: f64, high: f64) -> f64 {
        (1.0 - self.fraction) * low + self.fraction * high
    }

    /// Returns the tables of one side, for light to the higher index if `upwards`.
    fn side(self, tables: &Tables, upwards: bool) -> OneSide<'_> {
        let table = |k: usize| tables.table(if upwards { LAST + k } else { LAST - k });
        OneSide { low: table(self.low), high: table(self.low + 1), fraction: self.fraction, films: None }
    }
}

impl Tables {
    fn table(&self, number: usize) -> &MissingEnergy {
        let kind = || FacetKind::Dielectric(relative_index(number));
        self.by_index[number].get_or_init(|| MissingEnergy::new(&self.quadrature, &self.grid, kind()))
    }

    /// At the relative index exp((k·STEP)²).
    fn moments(&self, k: usize) -> &FilmMoments {
        self.film_moments[k].get_or_init(|| FilmMoments::new(&self.quadrature, &self.grid, relative_index(LAST + k)))
    }
}

fn relative_index(number: usize) -> f64 {
    let k = number as f64 - LAST as f64;
    exp(k * STEP * (k * STEP).abs())
}

/// Returns the fraction x of the lobe that is transmitted, for light on the first of two sides with
/// these indices.
///
/// Reciprocity requires that n²·l̄·x has the same value Y on both sides. In each single scattering
/// event, the transmitted fraction is τ = T̄/(1 − l̄), where T̄ is the mean transmittance and n²·T̄
/// has the same value on both sides. The lobe follows τ on the side on which n²·l̄·τ is lower,
/// which gives Y. Compared with the random walk on microfacets of Heitz et al. 2016, the mean
/// transmittance of the interface then differs by less than 0.02.
fn transmitted_fraction([here, there]: [&OneSide<'_>; 2], [n_here, n_there]: [f64; 2]) -> f64 {
    let odds = |side: &OneSide<'_>| side.mean() / (1.0 - side.mean());
    let flux = |side: &OneSide<'_>, n: f64| n * n * side.transmitted();
    // The tabulated flux differs slightly between the sides, so both sides use the mean.
    let both = 0.5 * (flux(here, n_here) + flux(there, n_there)) * odds(here).min(odds(there));
    let largest = |side: &OneSide<'_>, n: f64| n * n * side.mean();
    let common = both.min(largest(here, n_here)).min(largest(there, n_there));
    common / largest(here, n_here)
}

/// The missing energy at a relative index between two tables.
#[derive(Debug, Clone, Copy)]
struct OneSide<'a> {
    low: &'a MissingEnergy,
    high: &'a MissingEnergy,
    /// Of `high`, from 0 to 1.
    fraction: f64,
    films: Option<FilmChange<'a>>,
}

#[derive(Debug, Clone, Copy)]
struct FilmChange<'a> {
    low: &'a FilmSideMoments,
    high: &'a FilmSideMoments,
    /// See `film_moments.rs`.
    coefficients: [f64; MOMENTS],
    /// The change of the mean transmittance of single scattering.
    transmitted: f64,
}

impl OneSide<'_> {
    fn mixed(&self, value: impl Fn(&MissingEnergy) -> f64) -> f64 {
        (1.0 - self.fraction) * value(self.low) + self.fraction * value(self.high)
    }

    fn with_films(&self, bare: f64, change: impl Fn(&FilmSideMoments, &[f64; MOMENTS]) -> f64) -> f64 {
        let Some(FilmChange { low, high, coefficients, .. }) = &self.films else { return bare };
        let change = (1.0 - self.fraction) * change(low, coefficients) + self.fraction * change(high, coefficients);
        // On nearly smooth surfaces, the sum may be negative, because the moments are not exact.
        (FIT_MARGIN * (bare + change)).clamp(LEAST_CHANGE * bare, 1.0)
    }

    fn at(&self, point: GridPoint) -> f64 {
        self.with_films(self.mixed(|table| table.at(point)), |moments, coefficients| moments.at(point, coefficients))
    }

    fn mean(&self) -> f64 {
        self.with_films(self.mixed(|table| table.mean), |moments, coefficients| dot(&moments.mean, coefficients))
    }

    fn transmitted(&self) -> f64 {
        let bare = self.mixed(|table| table.transmitted);
        self.films.as_ref().map_or(bare, |films| (bare + films.transmitted).max(0.0))
    }
}

fn dot(moments: &[f64; MOMENTS], coefficients: &[f64; MOMENTS]) -> f64 {
    moments.iter().zip(coefficients).map(|(moment, coefficient)| moment * coefficient).sum()
}

/// The lobe of multiply scattered light at a rough dielectric interface. All cosines are positive.
#[derive(Debug, Clone, Copy)]
pub(super) struct MultipleScattering<'a> {
    grid: &'a AngleGrid,
    sampling: LobeSampling,
    here: OneSide<'a>,
    there: OneSide<'a>,
    transmitted: f64,
    /// What absorbing films leave of the reflected and of the transmitted part.
    kept: [f64; 2],
}

impl MultipleScattering<'_> {
    /// Returns the albedo of the lobe at the cosine of `wo`, with which the sampling selects it.
    pub(super) fn albedo(&self, cos_o: f64) -> f64 {
        self.here.at(self.grid.locate(cos_o))
    }

    /// Returns the side to which the event leads, and its fraction of the lobe.
    fn far_side(&self, event: ScatterEvent) -> (&OneSide<'_>, f64) {
        match event {
            ScatterEvent::Reflection => (&self.here, 1.0 - self.transmitted),
            ScatterEvent::Transmission => (&self.there, self.transmitted),
        }
    }

    /// Returns the fraction of the lobe that absorption in films leaves.
    pub(super) fn kept(&self) -> f64 {
        (1.0 - self.transmitted) * self.kept[0] + self.transmitted * self.kept[1]
    }

    /// Evaluates the lobe in 1/sr for power.
    pub(super) fn eval(&self, cos_o: f64, cos_i: f64, event: ScatterEvent) -> f64 {
        let (side, fraction) = self.far_side(event);
        let kept = self.kept[usize::from(event == ScatterEvent::Transmission)];
        FRAC_1_PI * fraction * kept * self.albedo(cos_o) * side.at(self.grid.locate(cos_i)) / side.mean()
    }

    /// Samples an event and a direction with positive z for both events, from numbers in \[0, 1).
    pub(super) fn sample(&self, u: [f64; 3]) -> (DVec3, ScatterEvent) {
        let event = if u[2] < self.transmitted { ScatterEvent::Transmission } else { ScatterEvent::Reflection };
        (self.sampling.sample([u[0], u[1]]), event)
    }

    pub(super) fn pdf(&self, cos_i: f64, event: ScatterEvent) -> f64 {
        self.far_side(event).1 * self.sampling.pdf(cos_i)
    }
}

/// The lobe of multiply scattered light at a rough metal, without the losses in the metal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ConductorCompensation {
    grid: AngleGrid,
    sampling: LobeSampling,
    missing: MissingEnergy,
}

impl ConductorCompensation {
    pub(super) fn new(facets: &Ggx) -> Self {
        let grid = AngleGrid::new(facets);
        Self {
            missing: MissingEnergy::new(&FacetQuadrature::new(*facets), &grid, FacetKind::Mirror),
            sampling: LobeSampling::new(facets),
            grid,
        }
    }

    /// Returns the lobe's albedo at the cosine of `wo`, without losses, for its selection.
    pub(super) fn albedo(&self, cos_o: f64) -> f64 {
        self.missing.at(self.grid.locate(cos_o))
    }

    /// Returns the part of multiply scattered light that metal of a mean reflectance reflects.
    pub(super) fn reflected(&self, reflectance: f64) -> f64 {
        kept_by_facets(reflectance, self.missing.mean)
    }

    /// Evaluates the lobe in 1/sr, without the losses in the metal.
    pub(super) fn eval(&self, cos_o: f64, cos_i: f64) -> f64 {
        FRAC_1_PI * self.albedo(cos_o) * self.albedo(cos_i) / self.missing.mean
    }

    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        self.sampling.sample(u)
    }

    pub(super) fn pdf(&self, cos_i: f64) -> f64 {
        self.sampling.pdf(cos_i)
    }
}

/// Samples directions of the lobe with a pdf per unit of μ proportional to μ/(μ² + α²), which
/// nearly follows μ·l(μ), because the missing energy l(μ) falls like 1/(μ² + α²).
#[derive(Debug, Clone, Copy, PartialEq)]
struct LobeSampling {
    squared: f64,
    /// ln(1 + 1/α²), twice the integral of μ/(μ² + α²) from 0 to 1.
    norm: f64,
}

impl LobeSampling {
    fn new(facets: &Ggx) -> Self {
        let squared = facets.alpha() * facets.alpha();
        Self { squared, norm: ln_1p(squared.recip()) }
    }

    fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        // At u = 0 the direction would lie in the surface.
        let cos = (self.squared * exp_m1(self.norm * u.max(f64::EPSILON))).sqrt().min(1.0);
        let (sin_phi, cos_phi) = sin_cos(TAU * v);
        let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
        DVec3::new(sin * cos_phi, sin * sin_phi, cos)
    }

    fn pdf(&self, cos: f64) -> f64 {
        2.0 * cos / ((cos * cos + self.squared) * self.norm * TAU)
    }
}
