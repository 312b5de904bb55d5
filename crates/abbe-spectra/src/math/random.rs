//! Independent streams of random numbers, one for each path, seeded by a hash of its identity: its
//! [`Seed`], [`Purpose`], pass and number.
//!
//! Every random number of a render comes from this module, from [`super::sobol`] or from
//! [`super::kronecker`], so the picture depends neither on the number of threads nor on the order
//! of the work. A new use of random numbers needs a new purpose.

use rand::Rng;
use rand_pcg::Pcg32;

/// The largest `f64` below 1, and thus the largest value of a sampling argument `u` in [0, 1).
pub const ONE_MINUS_ULP: f64 = 1.0 - f64::EPSILON / 2.0;

/// The number of replicates, independent subsets of the passes: pass i belongs to replicate i mod
/// 8. The differences between them measure the noise.
pub const REPLICATES: usize = 8;

/// The seed of a render, or of the random numbers that one sample of a render needs. It comes from
/// the scene or from numbers of a stream, and no other code computes with it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seed(u64);

/// The purpose of a stream, which is independent of streams of other purposes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Photons of the free set, which have their own wavelengths.
    FreePhoton,
    /// Photons of the shared set, which have the shared wavelengths of the pass.
    SharedPhoton,
    /// Camera paths.
    Camera,
    /// Numbers that are drawn once per pass, such as the shared wavelengths.
    Pass,
    /// The shutter time of a pass.
    Moment,
    /// The virtual lights of the light maps of a pass.
    LightMap,
    /// Photons whose paths are shown to the user.
    ShownPhoton,
    /// Photons of the pilot's survey.
    SurveyPhoton,
    /// Photons with which the pilot learns the emission distributions.
    AimPhoton,
    /// Photons of the pilot's trial.
    TrialPhoton,
    /// Photons with which the pilot chooses the first radii of sensors.
    MeterPhoton,
    /// Camera paths of the pilot's survey.
    SurveyCamera,
    /// Camera paths of the pilot's trial.
    TrialCamera,
    /// Camera paths that make trials of lights.
    LightTrial,
    /// Camera paths that search for portals.
    PortalSearch,
    /// The choice of lines whose nearest points may be the centre of a portal. It counts the
    /// portals that are already found instead of passes.
    PortalFit,
    /// The start of a path at the sensor of a meter. The seed is that of a camera sample.
    Sensor,
    /// The random positions of ratio tracking. The seed is that of a sample.
    RatioTracking,
    /// The components of mixtures with panes that a shadow ray meets. The seed is that of a sample.
    Pane,
    /// The points of luminaires that glare.
    Glare,
}

/// The words from which the keys of a purpose are hashed.
struct Words {
    /// A word in ASCII, other than 0 where the second word does not separate the purpose.
    mask: u64,
    /// The second word, or `None` if the pass follows the seed.
    number: Option<u64>,
    /// The third word of pass 0.
    first_pass: u64,
}

impl Purpose {
    /// Returns the words of the purpose, which never change, because pictures depend on them. Two
    /// purposes may only have equal words if their seeds differ: ratio tracking has the words of
    /// camera paths, but its seeds are hashes.
    #[inline]
    const fn words(self) -> Words {
        let (mask, number, first_pass) = match self {
            Self::FreePhoton => (0, 1, 0),
            Self::SharedPhoton => (0, 2, 0),
            Self::Camera | Self::RatioTracking => (0, 3, 0),
            Self::Pass => (0, 4, 0),
            Self::SurveyPhoton => (0, 5, 0),
            Self::AimPhoton => (0, 5, 100),
            Self::TrialPhoton => (0, 5, 1 << 32),
            Self::MeterPhoton => (0, 5, 1 << 40),
            Self::Moment => (0, 6, 0),
            Self::LightMap => (0, 7, 0),
            Self::ShownPhoton => (0, 8, 0),
            Self::SurveyCamera => (0x0070_696c_6f74, 3, 0),
            Self::TrialCamera => (0x0074_7269_616c, 3, 0),
            Self::LightTrial => (0x6c69_6768_7473, 3, 0),
            Self::PortalSearch => (0x7769_6e64_6f77, 3, 0),
            Self::PortalFit => return Words { mask: 0x7769_6e64_6f77, number: None, first_pass: 0 },
            Self::Sensor => (0, 0x006d_6574_6572, 0),
            Self::Pane => (0, 0x7061_6e65, 0),
            Self::Glare => (0, 0x0067_6c61_7265, 0),
        };
        Words { mask, number: Some(number), first_pass }
    }
}

impl Seed {
    /// Returns the seed of a scene.
    pub const fn new(number: u64) -> Self {
        Self(number)
    }

    /// Returns the number of the seed.
    pub const fn number(self) -> u64 {
        self.0
    }

    /// Returns a seed from random numbers of a stream, which must differ from sample to sample.
    #[inline]
    pub fn of_numbers<const N: usize>(numbers: [f64; N]) -> Self {
        Self(hash64(numbers.map(f64::to_bits)))
    }

    /// Does the same as [`Self::of_numbers`], but also separates the pixels.
    #[inline]
    pub fn of_pixel<const N: usize>(pixel: u64, numbers: [f64; N]) -> Self {
        Self(numbers.iter().fold(StreamKey::of_word(pixel), |key, number| key.part(number.to_bits())).0)
    }

    /// Returns the seed of part `number` of what this seed is for.
    #[inline]
    pub fn part(self, number: u64) -> Self {
        Self(hash64([self.0, number]))
    }

    /// Returns the streams of a purpose.
    #[inline]
    pub fn streams(self, purpose: Purpose) -> Streams {
        let Words { mask, number, first_pass } = purpose.words();
        let seeded = StreamKey::of_word(self.0 ^ mask);
        Streams { key: number.map_or(seeded, |number| seeded.part(number)), first_pass }
    }
}

/// The streams of one purpose, in all passes.
#[derive(Debug, Clone, Copy)]
pub struct Streams {
    key: StreamKey,
    first_pass: u64,
}

impl Streams {
    /// Returns the key of a pass.
    #[inline]
    pub fn pass(self, pass: u64) -> StreamKey {
        self.key.part(self.first_pass + pass)
    }
}

/// The key of a stream or sequence: the hash of a seed, a purpose, a pass, and more numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StreamKey(u64);

impl StreamKey {
    #[inline]
    fn of_word(word: u64) -> Self {
        Self(hash64([word]))
    }

    /// Returns the key of a part, for example of a pixel in a pass.
    #[inline]
    pub fn part(self, number: u64) -> Self {
        Self(mix64(self.0 ^ number))
    }

    /// Returns the stream of a path.
    #[inline]
    pub fn path(self, path: u64) -> Stream {
        let Self(key) = self.part(path);
        // The state and the sequence of the generator are hashed separately, because consecutive
        // sequences with the same state are visibly correlated.
        Stream(Pcg32::new(key, mix64(key)))
    }

    /// Returns a key with independent numbers, for a second sequence of the same samples.
    #[inline]
    pub fn second_sequence(self) -> Self {
        const SECOND: u64 = 0x5eed;
        Self(hash64([self.0, SECOND]))
    }

    /// Returns a number in [0, 1) with 53 random bits.
    #[inline]
    pub fn uniform(self) -> f64 {
        unit_interval(self.0)
    }

    /// Returns one of `count` numbers from 0.
    #[inline]
    pub fn index(self, count: u64) -> u64 {
        self.0 % count
    }

    /// Returns the key as a hash: the shift of a sequence, or the scrambling of points.
    #[inline]
    pub fn hash(self) -> u64 {
        self.0
    }
}

/// Mixes the bits of a 64-bit word (the finaliser of SplitMix64, Steele, Lea & Flood 2014).
#[inline]
pub(crate) fn mix64(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// Hashes several words in their order.
#[inline]
pub fn hash64<const N: usize>(words: [u64; N]) -> u64 {
    words.into_iter().fold(0x243f_6a88_85a3_08d3, |state, word| mix64(state ^ word))
}

/// Converts the upper 53 bits of a word to a number in [0, 1).
pub fn unit_interval(word: u64) -> f64 {
    (word >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
}

/// A stream of uniform random numbers for one path.
#[derive(Debug, Clone)]
pub struct Stream(Pcg32);

impl Stream {
    /// Returns the stream of path `path` in pass `pass`.
    #[inline]
    pub fn new(seed: Seed, purpose: Purpose, pass: u64, path: u64) -> Self {
        seed.streams(purpose).pass(pass).path(path)
    }

    /// Returns a number in [0, 1) with 32 random bits.
    pub fn uniform(&mut self) -> f64 {
        f64::from(self.0.next_u32()) * (1.0 / 4_294_967_296.0)
    }

    /// Returns two numbers in [0, 1).
    pub fn pair(&mut self) -> [f64; 2] {
        [self.uniform(), self.uniform()]
    }

    /// Returns three numbers in [0, 1).
    pub fn triple(&mut self) -> [f64; 3] {
        [self.uniform(), self.uniform(), self.uniform()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_streams_are_uncorrelated() {
        // The bound is four standard deviations of the correlation of n pairs, 1/√n.
        let n = 20_000_u64;
        for (purpose, step) in [(Purpose::Camera, 1), (Purpose::FreePhoton, 1 << 32)] {
            let mut sum = 0.0;
            for path in 0..n {
                let a = Stream::new(Seed::new(7), purpose, 3, path * step).uniform() - 0.5;
                let b = Stream::new(Seed::new(7), purpose, 3, (path + 1) * step).uniform() - 0.5;
                sum += a * b * 12.0;
            }
            assert!((sum / n as f64).abs() < 4.0 / (n as f64).sqrt(), "correlation {}", sum / n as f64);
        }
    }

    #[test]
    fn a_stream_depends_on_all_its_words() {
        let first = |seed, purpose, pass, path| Stream::new(Seed::new(seed), purpose, pass, path).uniform();
        let base = first(1, Purpose::Camera, 2, 3);
        assert_eq!(base, first(1, Purpose::Camera, 2, 3));
        for other in [
            first(2, Purpose::Camera, 2, 3),
            first(1, Purpose::SurveyPhoton, 2, 3),
            first(1, Purpose::Camera, 3, 3),
            first(1, Purpose::Camera, 2, 4),
        ] {
            assert_ne!(base, other);
        }
    }

    const ALL: [Purpose; 20] = [
        Purpose::FreePhoton,
        Purpose::SharedPhoton,
        Purpose::Camera,
        Purpose::Pass,
        Purpose::Moment,
        Purpose::LightMap,
        Purpose::ShownPhoton,
        Purpose::SurveyPhoton,
        Purpose::AimPhoton,
        Purpose::TrialPhoton,
        Purpose::MeterPhoton,
        Purpose::SurveyCamera,
        Purpose::TrialCamera,
        Purpose::LightTrial,
        Purpose::PortalSearch,
        Purpose::PortalFit,
        Purpose::Sensor,
        Purpose::RatioTracking,
        Purpose::Pane,
        Purpose::Glare,
    ];

    /// Passes of a render do not reach the first pass of another purpose of the same number. Only
    /// ratio tracking shares words with camera paths.
    #[test]
    fn purposes_have_different_streams() {
        for (i, one) in ALL.iter().enumerate() {
            for other in &ALL[..i] {
                let equal = (0..32).any(|pass| {
                    (0..32).any(|at| {
                        let key = |purpose: Purpose, pass| Seed::new(1).streams(purpose).pass(pass);
                        key(*one, pass) == key(*other, at)
                    })
                });
                let tracking = [*other, *one] == [Purpose::Camera, Purpose::RatioTracking];
                assert_eq!(equal, tracking, "{one:?} and {other:?}");
            }
        }
    }

    #[test]
    fn the_words_of_a_purpose_stay() {
        let key = |purpose: Purpose| Seed::new(7).streams(purpose).pass(3).part(5).hash();
        assert_eq!(key(Purpose::Camera), hash64([7, 3, 3, 5]));
        assert_eq!(key(Purpose::AimPhoton), hash64([7, 5, 103, 5]));
        assert_eq!(key(Purpose::SurveyCamera), hash64([7 ^ 0x0070_696c_6f74, 3, 3, 5]));
        assert_eq!(key(Purpose::PortalFit), hash64([7 ^ 0x7769_6e64_6f77, 3, 5]));
        let pixel = Seed::of_pixel(4, [0.5, 2.0]);
        assert_eq!(pixel.number(), hash64([4, 0.5_f64.to_bits(), 2.0_f64.to_bits()]));
    }
}
