//! The balance of a pass: the numbers of photon paths, of stored photons and of camera samples.
//!
//! A pass traces N photon paths and S camera samples per pixel. One of r paths paints a ribbon. The
//! pass stores the fraction q of the indirect photons on surfaces, and m times as many photons of
//! each path in media as the pilot measured. The variance V of a pixel and the work W of a pass are
//!
//! > V = `traced`/N + r `ribbons`/N + `surfaces`/(q N) + `media`/(m N) + `camera`/S,
//!
//! > W = `pass` + (`trace` + `paint`/r + q `store_on_surfaces` + m `store_in_media`) N
//! > + (`sample` + (q `gather_on_surfaces` + m `gather_in_media`) N) S,
//!
//! because the kernels of a camera sample contain more photons if a pass stores more. After n
//! passes, the variance is V/n and the work n W, so the error at equal time is least where V W is
//! least.

use super::camera_samples::SampleChoice;
use super::work::Work;
use crate::plan::{PHOTON_DOUBLINGS, PHOTON_HALVINGS};
use abbe_spectra::math::elementary::powf;
use std::ops::RangeInclusive;

/// The division of the work of a pass between photons and camera samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Balance {
    pub(super) photons: u64,
    /// The fraction of the indirect photons that the pass stores on surfaces.
    pub(super) stored_fraction: f64,
    /// The factor on the number of photons that a path stores in media.
    pub(super) medium_factor: f64,
    /// One of this many photons paints a ribbon.
    pub(super) photons_per_ribbon: u64,
    pub(super) camera_samples: u64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BalanceLimits {
    /// The number of photon paths, if the scene sets it, or the number of the plain division.
    pub(super) photons: u64,
    pub(super) photons_are_explicit: bool,
    /// The number of camera samples per pixel, if the scene sets it.
    pub(super) camera_samples: Option<u64>,
    /// The largest factor that has an effect on the number of photons that a path stores in media.
    pub(super) largest_medium_factor: f64,
}

/// The relative variance for one photon path, all stored, and one camera sample per pixel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Variances {
    /// The variance of the photons that are connected to the camera.
    pub(super) traced: f64,
    /// The variance of the ribbons, if each photon paints one.
    pub(super) ribbons: f64,
    pub(super) surfaces: f64,
    /// The variance of the photons that are stored in media.
    pub(super) media: f64,
    pub(super) camera: f64,
}

/// The photon paths, and the stored photons, may be halved this many times.
const HALVINGS: i32 = PHOTON_HALVINGS as i32;

/// The binary logarithm of the most camera samples per pixel.
const DOUBLINGS_OF_SAMPLES: i32 = 4;

/// The work of a pass is at most this multiple of the work of the plain division.
const LONGEST_PASS: f64 = 4.0;

/// A longer pass shows its picture later, so its error at equal time must be lower by this power of
/// the ratio of the work to the plain division.
const IMPATIENCE: f64 = 0.25;

/// Camera samples follow the noise only if they reduce the variance at equal time to this fraction.
const WORTHWHILE: f64 = 0.9;

/// Of the choices whose variance at equal time is at most this multiple of the least, that with the
/// least variance per pass is taken.
const TOLERANCE: f64 = 1.05;

impl BalanceLimits {
    /// The plain division, which is taken if there is nothing to choose.
    pub(super) fn plain(self) -> Balance {
        let Self { photons, camera_samples, .. } = self;
        Balance {
            photons,
            stored_fraction: 1.0,
            medium_factor: 1.0,
            photons_per_ribbon: 1,
            camera_samples: camera_samples.unwrap_or(1),
        }
    }

    pub(super) fn is_fixed(self) -> bool {
        self.photons_are_explicit && self.camera_samples.is_some()
    }

    /// Returns the least variance at equal time: the least product of all `variances`.
    pub(super) fn choose<const MEASURES: usize>(self, variances: [Variances; MEASURES], work: Work) -> Balance {
        let of_plain = self.plain().work(work);
        let variance = |choice: &Balance| choice.product_of(variances);
        let cost_of = |choice: &Balance| cost(variance(choice), choice.work(work) / of_plain, MEASURES);
        let has_ribbons = work.paint > 0.0;
        let choices = || self.choices(has_ribbons).filter(|choice| choice.work(work) <= LONGEST_PASS * of_plain);
        let least = choices().map(|choice| cost_of(&choice)).fold(f64::INFINITY, f64::min);
        let most = TOLERANCE.powi(MEASURES as i32) * least;
        choices()
            .filter(|choice| cost_of(choice) <= most)
            .min_by(|one, other| variance(one).total_cmp(&variance(other)))
            .unwrap_or(self.plain())
    }

    /// Returns the division of a pass with at most this work: the least variance at equal time
    /// among fewer photons and camera samples than the scene states, or the least work.
    pub(super) fn choose_within<const MEASURES: usize>(
        self,
        variances: [Variances; MEASURES],
        work: Work,
        most: f64,
    ) -> Balance {
        let cost_of = |choice: &Balance| choice.product_of(variances) * choice.work(work).powi(MEASURES as i32);
        let most_samples = self.camera_samples.unwrap_or(1 << DOUBLINGS_OF_SAMPLES).max(1);
        let divisions = || {
            let samples = (0..=most_samples.ilog2()).rev().map(|halvings| most_samples >> halvings);
            samples.flat_map(|samples| self.divisions(-HALVINGS..=0, samples, work.paint > 0.0))
        };
        let least_work = || divisions().min_by(|one, other| one.work(work).total_cmp(&other.work(work)));
        divisions()
            .filter(|choice| choice.work(work) <= most)
            .min_by(|one, other| cost_of(one).total_cmp(&cost_of(other)))
            .or_else(least_work)
            .unwrap_or(self.plain())
    }

    /// Returns all divisions within the limits.
    fn choices(self, has_ribbons: bool) -> impl Iterator<Item = Balance> {
        let of_photons = if self.photons_are_explicit { 0..=0 } else { -HALVINGS..=PHOTON_DOUBLINGS as i32 };
        let most_samples = if self.camera_samples.is_some() { 0 } else { DOUBLINGS_OF_SAMPLES };
        let samples = (0..=most_samples).map(move |of_samples| self.camera_samples.unwrap_or(1 << of_samples));
        samples.flat_map(move |samples| self.divisions(of_photons.clone(), samples, has_ribbons))
    }

    /// Returns the divisions with these numbers of photons, as powers of two, and of camera
    /// samples. A pass stores at most as many photons on surfaces as the plain division, and at
    /// least as many as if it traced the least number of paths and stored all photons.
    fn divisions(
        self,
        of_photons: RangeInclusive<i32>,
        camera_samples: u64,
        has_ribbons: bool,
    ) -> impl Iterator<Item = Balance> {
        let Self { photons, largest_medium_factor, .. } = self;
        let divisions = of_photons.flat_map(move |of_photons| {
            let of_stored = of_photons.max(0)..=of_photons + HALVINGS;
            of_stored.map(move |of_stored| (of_photons, 0.5_f64.powi(of_stored)))
        });
        divisions.flat_map(move |(of_photons, stored_fraction)| {
            let factors = (-HALVINGS - of_photons..=HALVINGS - of_photons).map(|of_media| 2_f64.powi(of_media));
            let effective = factors.filter(move |&factor| factor <= largest_medium_factor);
            let of_ribbons = if has_ribbons { 0..=HALVINGS } else { 0..=0 };
            effective.flat_map(move |medium_factor| {
                of_ribbons.clone().map(move |of_ribbons| Balance {
                    photons: ((photons as f64 * 2_f64.powi(of_photons)) as u64).max(1),
                    stored_fraction,
                    medium_factor,
                    photons_per_ribbon: 1 << of_ribbons,
                    camera_samples,
                })
            })
        })
    }
}

/// Returns the variance at equal time with [`IMPATIENCE`]. `variance` is the product of several
/// measures, and `work` is relative to the plain division.
fn cost(variance: f64, work: f64, measures: usize) -> f64 {
    variance * (work * powf(work.max(1.0), IMPATIENCE)).powi(measures as i32)
}

impl Balance {
    /// Returns the camera samples with the least variance at equal time for these photons: the
    /// least product of all measures in `variances`. It is the first choice unless another one
    /// gains something.
    pub(super) fn choose_samples(
        self,
        variances: [Variances; 3],
        work: Work,
        choices: &[SampleChoice],
    ) -> &SampleChoice {
        let first = &choices[0];
        let work_of = |choice: &SampleChoice| self.work_of_photons(work) + choice.work * self.work_of_samples(work);
        let cost_of = |choice: &SampleChoice| {
            let variances = variances.iter().zip(choice.variances);
            let variance = variances.map(|(one, of_samples)| self.variance_of_photons(one) + of_samples).product();
            cost(variance, work_of(choice) / work_of(first), 3)
        };
        let best = choices.iter().min_by(|one, other| cost_of(one).total_cmp(&cost_of(other))).unwrap_or(first);
        if cost_of(best) < WORTHWHILE.powi(3) * cost_of(first) { best } else { first }
    }

    /// Returns true if samples without noise would gain something in [`Self::choose_samples`].
    pub(super) fn has_noisy_samples(self, variances: [Variances; 3]) -> bool {
        let noisy: f64 = variances.iter().map(|&of_one| self.variance(of_one)).product();
        let exact: f64 = variances.iter().map(|of_one| self.variance_of_photons(of_one)).product();
        exact < WORTHWHILE.powi(3) * noisy
    }

    /// Returns the noise that a person sees in a picture, at equal time: the product of the
    /// variances of squares of 1, 2, 4, 8 and 16 pixels a side, times the fifth power of the work.
    /// Camera samples of different pixels are independent, so their variance falls with the number
    /// of pixels; the noise of photons is common to neighbours.
    pub(super) fn visible_noise(self, [of_pixels, _, of_squares]: [Variances; 3], work: Work) -> f64 {
        let in_squares = |of_one: Variances, pixels: f64| Variances { camera: of_one.camera / pixels, ..of_one };
        let variances = [
            of_pixels,
            in_squares(of_pixels, 4.0),
            of_squares,
            in_squares(of_squares, 4.0),
            in_squares(of_squares, 16.0),
        ];
        variances.iter().map(|&of_one| self.variance(of_one) * self.work(work)).product()
    }

    /// Returns the product of several measures of the variance.
    fn product_of<const MEASURES: usize>(self, variances: [Variances; MEASURES]) -> f64 {
        variances.map(|of_one| self.variance(of_one)).iter().product()
    }

    fn variance(self, of_one: Variances) -> f64 {
        self.variance_of_photons(&of_one) + of_one.camera / self.camera_samples as f64
    }

    fn variance_of_photons(self, of_one: &Variances) -> f64 {
        let stored = of_one.surfaces / self.stored_fraction + of_one.media / self.medium_factor;
        (of_one.traced + of_one.ribbons * self.photons_per_ribbon as f64 + stored) / self.photons as f64
    }

    pub(super) fn work(self, work: Work) -> f64 {
        self.work_of_photons(work) + self.work_of_samples(work) * self.camera_samples as f64
    }

    /// Returns the work of a pass without camera samples.
    fn work_of_photons(self, work: Work) -> f64 {
        let Work { pass, trace, paint, store_on_surfaces, store_in_media, .. } = work;
        let trace = trace + paint / self.photons_per_ribbon as f64;
        let stored = store_on_surfaces * self.stored_fraction + store_in_media * self.medium_factor;
        pass + (trace + stored) * self.photons as f64
    }

    /// Returns the work of one camera sample in every pixel.
    fn work_of_samples(self, work: Work) -> f64 {
        let Work { sample, gather_on_surfaces, gather_in_media, .. } = work;
        let gathered = gather_on_surfaces * self.stored_fraction + gather_in_media * self.medium_factor;
        sample + gathered * self.photons as f64
    }
}

#[cfg(test)]
mod tests {
    use super::super::camera_samples::{FilmNoise, ProbedPixel};
    use super::*;
    use crate::pass::CameraSamples;

    const FREE: BalanceLimits = BalanceLimits {
        photons: 200_000,
        photons_are_explicit: false,
        camera_samples: None,
        largest_medium_factor: 8.0,
    };

    /// The work of a small film, on which photons take most of the time.
    const SMALL_FILM: Work = Work {
        pass: 1e6,
        trace: 6_000.0,
        paint: 0.0,
        store_on_surfaces: 500.0,
        store_in_media: 0.0,
        sample: 2e7,
        gather_on_surfaces: 10.0,
        gather_in_media: 0.0,
    };

    const NO_NOISE: Variances = Variances { traced: 0.0, ribbons: 0.0, surfaces: 0.0, media: 0.0, camera: 0.0 };

    #[test]
    fn noisy_camera_samples_get_more_of_a_pass() {
        let noisy = Variances { traced: 1.0, surfaces: 100.0, camera: 1.0, ..NO_NOISE };
        let Balance { camera_samples, photons, .. } = FREE.choose([noisy], SMALL_FILM);
        assert_eq!((camera_samples, photons), (16, 25_000));
        let exact = Variances { camera: 0.0, ..noisy };
        assert_eq!(FREE.choose([exact], SMALL_FILM).camera_samples, 1);
    }

    /// If the noise comes from connections, a pass traces many photons but stores few.
    #[test]
    fn photons_that_only_add_work_are_not_stored() {
        let large_film = Work { sample: 3e9, gather_on_surfaces: 30_000.0, ..SMALL_FILM };
        let connected = Variances { traced: 3_000.0, surfaces: 100.0, ..NO_NOISE };
        let Balance { photons, stored_fraction, .. } = FREE.choose([connected], large_film);
        assert!(photons > 200_000, "{photons}");
        assert!(stored_fraction <= 0.25, "{stored_fraction}");
    }

    #[test]
    fn the_choice_has_almost_the_least_variance_at_equal_time() {
        for traced in [0.0, 100.0, 10_000.0] {
            for camera in [1e-6, 1e-2, 1.0] {
                for gather_on_surfaces in [0.0, 3_000.0, 100_000.0] {
                    let variances = Variances { traced, surfaces: 500.0, camera, ..NO_NOISE };
                    let work = Work { gather_on_surfaces, ..SMALL_FILM };
                    let cost = |choice: Balance| choice.variance(variances) * choice.work(work);
                    let chosen = FREE.choose([variances], work);
                    assert!(chosen.work(work) <= LONGEST_PASS * FREE.plain().work(work));
                    let allowed = FREE.choices(false).filter(|choice| choice.work(work) <= chosen.work(work));
                    assert!(allowed.into_iter().all(|other| cost(chosen) <= 1.0501 * cost(other)));
                }
            }
        }
    }

    #[test]
    fn explicit_numbers_are_kept() {
        let variances = Variances { traced: 1.0, surfaces: 100.0, camera: 1.0, ..NO_NOISE };
        let explicit = BalanceLimits { photons: 77, photons_are_explicit: true, ..FREE };
        assert_eq!(explicit.choose([variances], SMALL_FILM).photons, 77);
        let samples = BalanceLimits { camera_samples: Some(3), ..FREE };
        assert_eq!(samples.choose([variances], SMALL_FILM).camera_samples, 3);
        assert!(BalanceLimits { camera_samples: Some(3), ..explicit }.is_fixed());
        assert!(!explicit.is_fixed() && !samples.is_fixed());
    }

    /// A time limit is a wish as well, so it comes before the numbers of the scene.
    #[test]
    fn a_limited_pass_has_at_most_the_work_or_the_least() {
        let variances = [Variances { traced: 1.0, surfaces: 100.0, camera: 1.0, ..NO_NOISE }];
        let explicit = BalanceLimits { photons_are_explicit: true, camera_samples: Some(6), ..FREE };
        let free = explicit.choose(variances, SMALL_FILM).work(SMALL_FILM);
        let within = |most: f64| explicit.choose_within(variances, SMALL_FILM, most);
        let half = within(0.5 * free);
        assert!(half.work(SMALL_FILM) <= 0.5 * free && half.work(SMALL_FILM) > 0.2 * free, "{half:?}");
        let least = within(0.0);
        assert_eq!((least.photons, least.camera_samples), (25_000, 1));
        assert!([0.2, 0.3, 0.7].iter().all(|part| within(part * free).work(SMALL_FILM) <= part * free));
    }

    /// Media store more photons of each path if they are noisy and cheap to gather.
    #[test]
    fn noisy_media_store_more_photons_of_each_path() {
        let work = Work { gather_in_media: 100.0, ..SMALL_FILM };
        let noisy = Variances { media: 1e5, camera: 0.01, ..NO_NOISE };
        assert_eq!(FREE.choose([noisy], work).medium_factor, 8.0);
        let all_stored = BalanceLimits { largest_medium_factor: 1.0, ..FREE };
        assert_eq!(all_stored.choose([noisy], work).medium_factor, 1.0);
        let exact = Variances { surfaces: 1e5, media: 0.0, ..noisy };
        assert!(FREE.choose([exact], work).medium_factor < 1.0);
    }

    #[test]
    fn a_black_picture_gets_some_division() {
        let Balance { photons, camera_samples, .. } = FREE.choose([Variances::default(); 2], SMALL_FILM);
        assert!(photons >= 25_000 && camera_samples >= 1);
    }

    /// Samples follow the noise rather than grow everywhere, unless photons cause it.
    #[test]
    fn samples_follow_the_noise_only_if_this_gains_something() {
        let probe = |&pixel: &usize| {
            // One pixel in eight is noisy.
            let bright = if pixel % 64 < 8 { (pixel * 7 % 5) as f64 } else { 0.0 };
            ProbedPixel { sample: [1.0 + bright; 3], splats: [0.0; 3], work: 1.0 }
        };
        let noise = FilmNoise::measure((64, 64), |pixels| pixels.iter().map(probe).collect()).unwrap();
        let choices = noise.choices(1);
        let choose = |of_photons: f64| {
            let variances = Variances { traced: of_photons, ..NO_NOISE };
            noise.samples(FREE.plain().choose_samples([variances; 3], SMALL_FILM, &choices))
        };
        let samples = choose(2e4);
        assert!(samples.of(4) > 2 * samples.of(40), "{} and {}", samples.of(4), samples.of(40));
        assert_eq!(choose(1e9), CameraSamples::Same(1));
    }
}
