//! The random choices of the generator.

/// A PCG32 generator (O'Neill 2014) with choices that scenes need.
pub(crate) struct Pcg {
    state: u64,
}

impl Pcg {
    const FACTOR: u64 = 6_364_136_223_846_793_005;
    const INCREMENT: u64 = 1_442_695_040_888_963_407;

    /// Creates a generator. Different seeds give independent sequences.
    pub(crate) fn new(seed: u64) -> Self {
        let mut pcg = Self { state: seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) };
        (0..4).for_each(|_| _ = pcg.next());
        pcg
    }

    fn next(&mut self) -> u32 {
        let old = self.state;
        self.state = old.wrapping_mul(Self::FACTOR).wrapping_add(Self::INCREMENT);
        let shifted = (((old >> 18) ^ old) >> 27) as u32;
        shifted.rotate_right((old >> 59) as u32)
    }

    /// Returns a number from 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        f64::from(self.next()) / 4_294_967_296.0
    }

    /// Returns a number between two limits.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Returns a number between two positive limits, uniformly distributed on a logarithmic scale.
    pub(crate) fn log_between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.unit())
    }

    /// Returns true with this probability.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Returns a whole number below `count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Returns one of the items.
    pub(crate) fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.below(items.len())]
    }

    /// Returns a random direction.
    pub(crate) fn direction(&mut self) -> [f64; 3] {
        let (sin, cos) = (std::f64::consts::TAU * self.unit()).sin_cos();
        let z = self.between(-1.0, 1.0);
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    }
}
